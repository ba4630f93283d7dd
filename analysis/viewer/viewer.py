"""A look at a step: one HTML page with the bodies in 3D, right and wrong answers coloured and listed.

The page holds everything: three.js (Debian's libjs-three: one apt package, no second registry, no bundler), our
scripts, the meshes once each, the poses of a window of steps, and the wrong answers of all algorithms in it. It asks
the network for nothing; its Content-Security-Policy forbids that.
"""

import base64
import json
import pathlib
import shlex

import numpy as np

from ..load import load
from ..output import refuse, say, templates, write

HERE = pathlib.Path(__file__).parent
THREE_JS = [
    pathlib.Path("/usr/share/javascript/three/three.min.js"),
    pathlib.Path("/usr/share/javascript/three/examples/js/controls/OrbitControls.js"),
]
SCRIPTS = ("vectors", "decode", "measure", "shapes", "sees", "picture", "viewer")  # beside this file, in this order
AROUND = 60  # steps shown on either side when no window is asked for: two seconds of the thesis's scenes in all
USUAL_BYTES = 8 << 20  # such a window becomes shorter rather than larger than this
MOST_BYTES = 64 << 20  # a window that is asked for is refused above: phones fail to open larger pages
BIG = 4  # a fixed body that many times as large as the median moving one (plate, wall) is drawn see-through


class Unfit(Exception):
    """What stands in the page's way: one line, and the exit code of it (3: a value does not fit the file)."""

    code = 3


class Uninstalled(Unfit):
    code = 1


def add_command(commands):
    """Adds the command `scene` to the subparsers of scripts/analysis."""
    command = commands.add_parser("scene", help="a page that shows the bodies of a step in 3D, wrong answers coloured")
    command.add_argument("file", help="a result")
    command.add_argument("--step", type=int, help="opens there; without it where the algorithm errs most")
    command.add_argument("--algorithm", metavar="LABEL", help="opens with its answers; without it the file's first")
    command.add_argument("--steps", type=_window, metavar="A:B",
                         help=f"holds the steps A to B - 1; without it {AROUND} on either side of --step")
    command.add_argument("-o", "--output", metavar="PAGE", help="without it <name of the result>_step<K>.html here")
    command.set_defaults(act=lambda chosen: say(write_page(chosen)))


def _window(text):
    """A:B as a slice; either may be left out. ValueError becomes argparse's error."""
    first, colon, end = text.partition(":")
    if not colon or not all(part == "" or part.isdecimal() for part in (first, end)):
        raise ValueError(text)
    return slice(int(first) if first else None, int(end) if end else None)


_window.__name__ = "range A:B of steps"  # argparse names it in its error


def write_page(chosen):
    """Writes the page that the parsed arguments of `scene` ask for, whole or not at all. Returns its path.

    Raises what step_page raises, naming the file, and OSError when the page cannot be written.
    """
    if chosen.output:
        refuse(chosen.output)  # before the work
    try:
        page, step = step_page(chosen.file, chosen.step, chosen.algorithm, chosen.steps, chosen.unsealed)
    except (OSError, KeyError, ValueError, RuntimeError) as error:  # h5py does not name the file
        text = str(error.args[0] if error.args else error)
        raise OSError(text if text.startswith(chosen.file) else f"{chosen.file}: is damaged ({text})") from error
    path = chosen.output or f"{pathlib.Path(chosen.file).stem}_step{step}.html"
    write(path, page)
    return path


def step_page(path, step=None, label=None, window=None, unsealed=False):
    """The page as text, and the step that it opens at.

    step: None for the step at which the algorithm has the most wrong answers; label: None for the first algorithm;
    window: slice of steps, None for AROUND on either side of step. Raises OSError or ValueError when the file is not a
    result, Unfit when a value does not fit it, Uninstalled when three.js is not there.
    """
    run = load(path, unsealed).completed()
    steps, labels = run.meta["steps"], run.meta["algorithms"]
    if not steps or not run.meta["bodies"]:
        raise Unfit(f"{path}: has no {'bodies' if steps else 'steps'}; there is nothing to show")
    if label is not None and label not in labels:
        raise Unfit(f"--algorithm {label}: is not in {path}; there are {', '.join(labels) or 'none'}")
    wrong = _wrong_per_step(run)
    label = label or (labels[0] if labels else None)
    if step is None:
        step = _default_step(wrong, label, window, steps)
    if not 0 <= step < steps:
        raise Unfit(f"--step {step}: {path} has the steps 0 to {steps - 1}")
    if window is None:
        around = AROUND
        while True:
            first, end = max(0, step - around), min(steps, step + around + 1)
            if (size := _window_bytes(run, first, end)) <= USUAL_BYTES or around == 0:
                break
            around = around * 4 // 5
    else:
        first, end, _ = window.indices(steps)
        if (window.stop or 0) > steps or first >= end:
            raise Unfit(f"--steps {_colon(window)}: is no range of steps A to B - 1; {path} has 0 to {steps - 1}")
        if not first <= step < end:
            raise Unfit(f"--step {step}: is not among --steps {first}:{end}")
        size = _window_bytes(run, first, end)
    with run.opened() as file:
        for mesh in file["meshes"].values():
            size += 24 * mesh["vertices"].shape[0] + 12 * mesh["triangles"].shape[0]
    if size > MOST_BYTES:
        raise Unfit(f"{path}: meshes and steps {first}:{end} would make a page of {size / 2**20:.0f} MiB, at most "
                    f"{MOST_BYTES >> 20} are possible; fewer --steps make it smaller")
    shown = path if not pathlib.Path(path).is_absolute() else pathlib.Path(path).name  # the page may go to others
    data = _page_data(run, first, end) | {"step": step, "chosen": label, "whole": _whole(wrong, first, end),
                                          "command": f"scripts/analysis scene {shlex.quote(str(shown))}"}
    return _filled(data, f"{run.meta.get('title') or pathlib.Path(path).name}, step {step}"), step


def _colon(window):
    return f"{'' if window.start is None else window.start}:{'' if window.stop is None else window.stop}"


def _wrong_per_step(run):
    """label -> (false positives, false negatives) per step, as counted by the run."""
    with run.opened() as file:
        if "results" not in file:
            return {}
        counts = [file["results"][name][()] for name in ("false_positive", "false_negative")]
    return {label: (counts[0][:, a], counts[1][:, a]) for a, label in enumerate(run.meta["algorithms"])}


def _default_step(wrong, label, window, steps):
    """The first step of the window with the most wrong answers of the algorithm."""
    inside = range(steps)[window or slice(None)]
    if label not in wrong or not len(inside):
        return inside.start if len(inside) else 0
    return inside.start + int(np.argmax((wrong[label][0] + wrong[label][1])[inside.start : inside.stop]))


def _whole(wrong, first, end):
    """label -> of the false positives and the false negatives of the whole run: how many, the first step with one, the
    step with the most, and the nearest before and behind the window; None where there is none."""
    found = {}
    for label, counts in wrong.items():
        found[label] = kinds = {}
        for kind, count in zip(("fp", "fn"), counts):
            at = np.flatnonzero(count)
            kinds[kind] = {
                "total": int(count.sum()),
                "first": _end_of(at, 0),
                "most": int(np.argmax(count)) if len(at) else None,
                "many": int(count.max(initial=0)),
                "before": _end_of(at[at < first], -1),
                "behind": _end_of(at[at >= end], 0),
            }
    return found


def _end_of(steps, end):
    return int(steps[end]) if len(steps) else None


def _window_bytes(run, first, end):
    """Bytes of the window's poses and pairs before base64, seven doubles a pose and at most four bytes a pair's end."""
    with run.opened() as file:
        pairs = int(np.diff(file["truth/pair_offset"][()][[first, end]].astype(np.int64))[0])
        for label in run.meta["algorithms"]:
            pairs += int(np.diff(file[f"answers/{label}/pair_offset"][()][[first, end]].astype(np.int64))[0])
    return (end - first) * len(run.meta["bodies"]) * 56 + 8 * pairs


def _page_data(run, first, end):
    """What viewer.js draws and what sees.js computes with: poses and vertices are the file's doubles. `unit` metres are
    drawn as 1; `centre` is the scene's middle, that of a mesh the middle of its box, both in metres."""
    with run.opened() as file:
        position = file["motion/position"][first:end]
        orientation = file["motion/orientation"][first:end]
        truth = _pair_sets(file["truth"], first, end)
        containment = file["truth"].attrs.get("containment", "ignore")
        contained = [set()] * (end - first)
        if "contained_pair" in file["truth"]:
            contained = _pair_sets(file["truth"], first, end, "contained_offset", "contained_pair")
        answers = {name: _pair_sets(file[f"answers/{name}"], first, end) for name in run.meta["algorithms"]}
        mesh_of = list(file["bodies/mesh"].asstr()[()])
        asked = file["bodies/chosen"][()] if "chosen" in file["bodies"] else np.ones(len(mesh_of))
        names = sorted(set(mesh_of))
        meshes = [_mesh(name, file[f"meshes/{name}"]) for name in names]
    if containment == "meet":
        truth = [by_surface | inside for by_surface, inside in zip(truth, contained)]
    table = run.bodies
    radius = np.array([np.linalg.norm(size) / 2 for size in table["size"]])
    moving = radius[~table["fixed"].to_numpy()]
    big = table["fixed"].to_numpy() & (radius > BIG * (np.median(moving) if len(moving) else np.inf))
    number = [names.index(mesh) for mesh in mesh_of]
    local = np.array([meshes[n]["centre"] for n in number])
    at = turned(orientation, local) + position
    born = at[np.isfinite(at).all(axis=-1)]
    centre = np.median(born, axis=0) if len(born) else np.zeros(3)
    unit = _unit([np.abs(mesh["vertices"] - mesh["centre"]).max() for mesh in meshes],
                 np.abs(born - centre).max(initial=0))
    for mesh in meshes:
        mesh["centre"] = mesh["centre"].tolist()
        mesh["vertices"] = _base64(mesh["vertices"].astype("<f8"))
    wide = len(mesh_of) > 0xFFFF
    kinds = {}
    for label, reported in answers.items():
        apart = contained if containment == "record" else [set()] * (end - first)
        kinds[label] = {
            "fp": _packed([r - t - c for r, t, c in zip(reported, truth, apart)], wide),
            "fn": _packed([t - r for r, t in zip(reported, truth)], wide),
            "inside": _packed([r & c for r, c in zip(reported, apart)], wide),
        }
    about = ("name", "knobs", "promise", "scope")
    return {
        "file": pathlib.Path(run.path).name,
        "title": str(run.meta.get("title", "")),
        "digest": str(run.meta.get("digest", "")),
        "commit": str(run.meta.get("git_commit", "")),
        "first": first,
        "count": end - first,
        "steps": run.meta["steps"],
        "rate": run.meta["rate"],
        "centre": centre.tolist(),
        "unit": unit,
        "containment": str(containment),
        "meshes": meshes,
        "bodies": [
            {"name": name, "mesh": number[b], "fixed": bool(row.fixed), "big": bool(big[b]),
             "born": int(row.first_step), "asked": bool(asked[b])}
            for b, (name, row) in enumerate(table.iterrows())
        ],
        "position": _base64(position.astype("<f8")),
        "orientation": _base64(orientation.astype("<f8")),
        "wide": wide,
        "truth": _packed(truth, wide),
        "contained": _packed(contained, wide),
        "algorithms": [
            {"label": label} | {key: str(run.meta["answers"][label].get(key, "")) for key in about} | kinds[label]
            for label in answers
        ],
    }


def _unit(sizes, far):
    """The length in metres that is drawn as 1, a power of two, so that the division rounds nothing.

    Graphics cards reckon in single precision, and a normal is the product of two edges whose length is squared: below
    some 1e-8 that is 0 and the surface black, above 1e11 infinite. So the least size and the greatest length lie as
    far below 1 as above; where they are too far apart, what is small is given up, never what is large.
    sizes: of meshes, half their greatest side; far: how far from the scene's middle bodies are.
    """
    sizes = [float(size) for size in sizes if size > 0]
    most = max([*sizes, float(far)])
    if most == 0:
        return 1.0
    between = (np.log2(min(sizes, default=most)) + np.log2(most)) / 2
    return float(2.0 ** np.round(max(between, np.log2(most) - 30)))


def turned(quaternion, vector):
    """Vectors (..., 3) turned by unit quaternions (..., 4) w x y z, in doubles."""
    axis, w = quaternion[..., 1:], quaternion[..., :1]
    across = 2 * np.cross(axis, vector)
    return vector + w * across + np.cross(axis, across)


def _mesh(name, group):
    vertices, triangles = group["vertices"][()], group["triangles"][()]
    shape = json.loads(group.attrs.get("shape", "{}"))
    return {
        "name": name,
        "centre": (vertices.min(axis=0) + vertices.max(axis=0)) / 2,
        "vertices": vertices,
        "triangles": _base64(triangles.astype("<u4")),
        "ball": shape["radius"] if shape.get("kind") == "sphere" else 0,
        "proxies": {label: _proxy(proxy) for label, proxy in group.get("proxies", {}).items()},
    }


def _proxy(group):
    """What stands for a mesh in a method: balls (centre and radius) or vertices and triangles, metres, mesh frame; and
    how well it wraps the mesh."""
    kinds = {"balls": "<f8", "vertices": "<f8", "triangles": "<u4"}
    about = {"kind": str(group.attrs.get("kind", "balls"))}
    for name in ("outside_share", "outside_greatest"):
        if np.isfinite(value := float(group.attrs.get(name, np.nan))):
            about[name] = value
    return about | {name: _base64(group[name][()].astype(kind)) for name, kind in kinds.items() if name in group}


def _pair_sets(group, first, end, offset="pair_offset", pair="pair"):
    """Per step of the window, the set of pairs (a, b)."""
    offset = group[offset][first : end + 1].astype(np.int64)
    pairs = [(int(a), int(b)) for a, b in group[pair][offset[0] : offset[-1]]]
    return [set(pairs[a - offset[0] : b - offset[0]]) for a, b in zip(offset[:-1], offset[1:])]


def _packed(sets, wide):
    """Pairs of steps as base64: offsets (Uint32) and sorted ends (Uint16, Uint32 where a number needs it)."""
    offset = np.cumsum([0] + [len(pairs) for pairs in sets])
    pair = np.array([pair for pairs in sets for pair in sorted(pairs)]).reshape(-1, 2)
    return {"offset": _base64(offset.astype("<u4")), "pair": _base64(pair.astype("<u4" if wide else "<u2"))}


def _base64(array):
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()


def _filled(data, title):
    """The page: viewer.html with the title, the data, three.js and our scripts."""
    for path in THREE_JS:
        if not path.is_file():
            raise Uninstalled(f"{path}: is missing; scripts/setup installs it (Debian's libjs-three)")
    scripts = [*THREE_JS, *(HERE / f"{name}.js" for name in SCRIPTS)]
    return templates(HERE).get_template("viewer.html").render(
        title=title,
        data=json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
        scripts=[_script(path.read_text(encoding="utf-8")) for path in scripts],
    )


def _script(text):
    if "</script" in text.lower():
        raise Uninstalled("three.js: holds '</script', which would end the page's script; another version is needed")
    return text
