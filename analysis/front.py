"""scripts/front: which settings of which methods are worth asking on a scene, found from coarse to fine.

The scene of CONFIG is run once; of its steps a few, spread evenly, are replayed. Every method of this build is asked
about them with its presets, with each knob at a few values, and behind each fast filter; then what lies near the front
of error and time is asked again with values in between, several knobs together. What is near the front at last, and
every method with its presets, becomes FRONT.toml: CONFIG with these [[algorithm]]s. `pipeline run FRONT.toml` then
measures them on all steps.

Exit codes as the pipeline's.
"""

import argparse
import csv
import json
import math
import os
import re
import sys
import tempfile

import h5py
import numpy as np

from .files import replaced
from .load import load
from .output import complain, say
from .program import Refused, answered, default_program
from .tables import pareto

FACTORS = (0.25, 0.5, 2, 4)  # of a knob's preset, the first time
FILTERS = ("none", "aabb", "bounding_sphere", "obb_sat", "cannon_naive")  # fast ones
LEAVE_OUT = {"containment", "search"}  # the question itself; the same answers by another way
NEAR = 2.0  # times the time of the fastest that errs no more: nearer is asked again, and kept
UNASKED = {"proxy"}  # it needs files
PEERS = {"fcl_bvh"}  # what a build may lack
WORTH = 60  # settings asked again at most, the nearest first


def main(arguments=None):
    chosen = parsed(arguments)
    try:
        with tempfile.TemporaryDirectory(prefix="front") as folder:
            kept = search(chosen, folder)
        text = configuration(open(chosen.config, encoding="utf-8-sig").read(), kept, chosen)
        with replaced(chosen.output) as part:
            with open(part, "x", encoding="utf-8") as file:
                file.write(text)
    except Refused as error:
        complain(f"scripts/front: {error}")
        return error.code
    except OSError as error:
        complain(f"{error.filename}: {error.strerror}" if error.filename else error)
        return 4
    say(f"{chosen.output}: {len(kept)} labels")
    return 0


def parsed(arguments):
    parser = argparse.ArgumentParser(prog="scripts/front", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("config", metavar="CONFIG", help="the scene that is asked about")
    parser.add_argument("-o", "--output", metavar="FRONT.toml", required=True, help="the configuration that is made")
    parser.add_argument("--steps", type=int, default=60, help="how many are replayed (60)")
    parser.add_argument("--keep", type=int, default=40, help="labels in FRONT.toml beside the presets, at most (40)")
    parser.add_argument("--program", default=default_program(), help="the built program (default: %(default)s)")
    return parser.parse_args(arguments)


def search(chosen, folder):
    """The settings worth asking: [(label, algorithm, knobs)], presets first."""
    table = [row for row in json.loads(answered(chosen.program, "list", "algorithms", "--json"))
             if row["name"] not in UNASKED and (not row["library"] or row["name"] in PEERS)]
    scene = replay(chosen, folder)
    asked = {}
    first = coarse(table)
    points = answers(chosen, folder, scene, first, asked)
    for _ in range(2):
        near = nearest(points, asked, WORTH)
        between = finer(table, [asked[label] for label in near], asked)
        if not between:
            break
        points = answers(chosen, folder, scene, between, asked)
    presets = [(row["name"], row["name"], {}) for row in table if row["name"] in asked]
    known = {key(name, knobs) for _, name, knobs in presets}
    worth = [(label, *asked[label]) for label in nearest(points, asked, chosen.keep)]
    return presets + [setting for setting in worth if key(*setting[1:]) not in known]


def replay(chosen, folder):
    """Some steps of the scene as a replay: the text of its configuration, without algorithms."""
    say(f"{chosen.config}: the motion, of which {chosen.steps} steps are replayed")
    whole = os.path.join(folder, "whole.h5")
    settings = ["--set", "timing.repeats=1"]
    answered(chosen.program, "run", chosen.config, "-o", whole, "--quiet", *settings)
    answered(chosen.program, "export", whole, "--csv", os.path.join(folder, "csv"))
    with h5py.File(whole) as file:
        steps = len(file["step"])
        containment = file["truth"].attrs.get("containment", "ignore")
        if "cases" in file:
            raise Refused(f"{chosen.config}: extremes are no motion; ask about a scene")
    spread = np.unique(np.linspace(0, steps - 1, chosen.steps).round())
    taken = {int(step): number for number, step in enumerate(spread)}
    with open(os.path.join(folder, "csv", "poses.csv")) as source, open(os.path.join(folder, "poses.csv"), "w") as file:
        rows = csv.DictReader(source)
        out = csv.DictWriter(file, rows.fieldnames, lineterminator="\n")
        out.writeheader()
        out.writerows(row | {"step": taken[int(row["step"])]} for row in rows if int(row["step"]) in taken)
    lines = ["[scene]", 'kind = "replay"', 'poses = "poses.csv"']
    with open(os.path.join(folder, "csv", "bodies.csv")) as file:
        bodies = list(csv.DictReader(file))
    only = [body["body"] for body in bodies if body["chosen"] == "1"]
    if len(only) < len(bodies):
        lines.append(f"only = {json.dumps(only)}")
    for body in bodies:
        lines += ["[[scene.body]]", f'name = "{body["body"]}"', f'mesh = "csv/meshes/{body["mesh"]}.obj"']
        lines += ["fixed = true"] if body["fixed"] == "1" else []
    return "\n".join([*lines, "[truth]", f'containment = "{containment}"', "[timing]", "repeats = 2", ""])


def coarse(table):
    """Every method with its presets, each knob at a few values, and behind each fast filter."""
    settings = []
    for row in table:
        settings.append((row["name"], {}))
        for knob in row["knobs"]:
            settings += [(row["name"], {knob["name"]: value}) for value in values(knob) if value != knob["preset"]]
    return settings


def values(knob):
    if knob["name"] in LEAVE_OUT:
        return []
    if knob["type"] == "boolean":
        return [True, False]
    if "choices" in knob:
        filters = {"prefilter", "then"} & {knob["name"]}
        return [choice for choice in knob["choices"] if not filters or choice in FILTERS]
    if knob["type"] not in ("real", "integer"):
        return []
    return allowed(knob, [knob["preset"] * factor for factor in FACTORS])


def allowed(knob, numbers):
    """Those of the numbers that the knob takes, as it takes them."""
    divided = re.fullmatch(r"divide (\d+)", knob.get("rule", ""))
    found = []
    for number in numbers:
        value = int(round(number)) if knob["type"] == "integer" else float(f"{number:.3g}")
        if divided:
            whole = float(divided[1])
            value = min((whole / n for n in range(1, int(whole) + 1)), key=lambda one: abs(math.log(one / number)))
            value = float(f"{value:.15g}")
        inside = knob.get("least", value) <= value <= knob.get("most", value)
        if inside and (value > 0 or "greater than 0" not in knob.get("rule", "")) and value not in found:
            found.append(value)
    return found


def key(name, knobs):
    return name, json.dumps(knobs, sort_keys=True)


def label_of(name, knobs):
    """facet_vectors_stride_5: unique, readable, and what a label may be; a filter comes first, as in f+method."""
    rest = dict(knobs)
    front = rest.pop("prefilter", None)
    text = "_".join([name, *(f"{knob}_{str(value).lower()}" for knob, value in sorted(rest.items()))])
    return f"{front}+{text}" if front else text


def answers(chosen, folder, scene, settings, asked):
    """Asks about settings, at most a hundred and fifty a file; the points of all that were ever asked."""
    for start in range(0, len(settings), 150):
        batch = {label_of(*setting)[:64]: setting for setting in settings[start:start + 150]}
        path = os.path.join(folder, f"round_{len(asked)}")
        with open(path + ".toml", "w") as file:
            file.write(scene + "".join(map(block, ((label, *setting) for label, setting in batch.items()))))
        os.replace(path + ".toml", os.path.join(folder, "round.toml"))
        answered(chosen.program, "run", os.path.join(folder, "round.toml"), "-o", path + ".h5", "--quiet")
        asked.update(batch)
        say(f"{len(asked)} settings asked")
    runs = [load(os.path.join(folder, name)) for name in sorted(os.listdir(folder)) if name.startswith("round_")]
    points = pareto.scenes(runs)[0].points
    return points[points.time_mean_ns.notna()].drop_duplicates("label").set_index("label")


def block(setting):
    """A row of the configuration. Optional: another build may lack what this one has."""
    label, name, knobs = setting
    lines = ["[[algorithm]]", f'name = "{name}"'] + ([f'label = "{label}"'] if label != name else [])
    lines += ["optional = true"] if name in PEERS else []
    return "\n".join(lines + [f"{knob} = {json.dumps(value)}" for knob, value in knobs.items()]) + "\n\n"


def nearest(points, asked, most):
    """The labels nearest to the front of what is neither exact nor a library (who errs nowhere hides all that is
    slower): by how many times as much time they take as the fastest that errs no more. Of labels with the same answers
    the fastest two."""
    ranked, same = [], {}
    points = points[~points.exact & ~points.library]
    for label, row in points.sort_values("time_mean_ns").iterrows():
        if label not in asked:
            continue
        alike = row.algorithm, row.hits, row.false_positive, row.false_negative
        same[alike] = same.get(alike, 0) + 1
        best = points.time_mean_ns[points.error <= row.error].min()
        if same[alike] <= 2 and row.time_mean_ns <= NEAR * best:
            ranked.append((row.time_mean_ns / best, label))
    return [label for _, label in sorted(ranked)[:most]]


def finer(table, settings, asked):
    """Values between those asked, and two changed knobs together, near `settings`."""
    rows = {row["name"]: row for row in table}
    known = {key(*setting) for setting in asked.values()}
    found = []
    changed = {}
    for name, knobs in settings:
        for knob, value in knobs.items():
            changed.setdefault(name, set()).add((knob, value))
    for name, knobs in settings:
        for knob in rows[name]["knobs"]:
            number = knob["type"] in ("real", "integer") and "choices" not in knob
            value = knobs.get(knob["name"], knob["preset"])
            near = allowed(knob, [value / math.sqrt(2), value * math.sqrt(2)]) if number and value else []
            found += [(name, knobs | {knob["name"]: one}) for one in near if knob["name"] not in LEAVE_OUT]
        found += [(name, knobs | {knob: value}) for knob, value in changed.get(name, ()) if knob not in knobs]
    unique = {}
    for name, knobs in found:
        presets = {knob["name"]: knob["preset"] for knob in rows[name]["knobs"]}
        knobs = {knob: value for knob, value in knobs.items() if value != presets[knob]}
        if key(name, knobs) not in known:
            unique[key(name, knobs)] = name, knobs
    return list(unique.values())


def configuration(text, kept, chosen):
    """CONFIG with other algorithms. Its own [[algorithm]]s, and the comments before them, go."""
    out, lines, inside = [], text.splitlines(), False
    for line in lines:
        if line.strip().startswith("["):
            inside = line.strip().startswith("[[algorithm]]")
            while inside and out and (not out[-1].strip() or out[-1].startswith("#")):
                out.pop()
            if not inside and out and out[-1].strip() and not out[-1].startswith("#"):
                out.append("")
        if not inside:
            out.append(line)
    head = (f"# Which settings lie near the front of error and time, found by scripts/front"
            f" {os.path.basename(chosen.config)}"
            f" --steps {chosen.steps}:\n# every method with its presets, then those near the front.\n\n")
    while out and out[0].startswith("#"):
        out.pop(0)
    return head + "\n".join(out).strip() + "\n\n" + "".join(map(block, kept)).rstrip() + "\n"


if __name__ == "__main__":
    sys.exit(main())
