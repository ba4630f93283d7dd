"""Containment as its users meet it: meshes whose corners are a hair apart, open ones, hollow ones."""
import itertools
import json
from math import sqrt

import h5py
import numpy as np
import pytest
from program import DONE, INPUT, ROOT, one_line, pipeline

from analysis.load import load

AXES = [[(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)], [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)],
        [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], [(0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)],
        [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)], [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]]  # fmt: skip


def cube(size=1.0, low=(0, 0, 0), hair=0.0):
    """The facets of a cube, three corners each; the very first corner is moved along z by `hair`."""
    facets = []
    for face in AXES:
        corners = [[least + size * x for least, x in zip(low, corner)] for corner in face]
        facets += [[corners[0], corners[1], corners[2]], [list(corners[0]), list(corners[2]), corners[3]]]
    facets[0][0] = [*facets[0][0][:2], facets[0][0][2] + hair]
    return facets


def stl(facets):
    """Text STL, every number so that it reads back as itself."""
    lines = ["solid c"]
    for facet in facets:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex " + " ".join(map(repr, p)) for p in facet)]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid c", ""])


@pytest.fixture
def scene(tmp_path):
    """Writes a scene of resting STL meshes and runs it; all positions are 0."""

    def run(meshes, *arguments, containment="record"):
        text = '[scene]\nkind = "replay"\nposes = "poses.csv"\n'
        rows = "step,body,px,py,pz,qw,qx,qy,qz\n"
        for name, facets in meshes.items():
            (tmp_path / f"{name}.stl").write_text(stl(facets))
            text += f'[[scene.body]]\nname = "{name}"\nmesh = "{name}.stl"\n'
            rows += f"0,{name},0,0,0,1,0,0,0\n"
        text += f'[truth]\ncontainment = "{containment}"\n'
        text += '[[algorithm]]\nname = "exact"\ncontainment = true\n[[algorithm]]\nname = "obb_sat"\n'
        (tmp_path / "poses.csv").write_text(rows)
        (tmp_path / "scene.toml").write_text(text)
        path = tmp_path / "scene.h5"
        return pipeline("run", tmp_path / "scene.toml", "-o", path, "--force", "--quiet", *arguments), path

    return run


def inside(path):
    """(inner, outer) by their names."""
    run = load(path)
    names, pairs = run.meta["bodies"], run.contained_pairs
    return {(names[p.inside], names[p.a + p.b - p.inside]) for p in pairs.itertuples()}


PIN = cube(0.02, (0.49, 0.49, 0.49))


# 2.7e-16 was seen in a public STL file, 1e-34 in others; the sizes are from molecules to orbits.
@pytest.mark.parametrize("size", [1e-12, 1.0, 1e12])
@pytest.mark.parametrize("hair", [1e-34, 2.7e-16, 1e-9, 9e-7])
def test_corners_a_hair_apart_are_one_for_containment(scene, size, hair):
    pin = [[[size * x for x in p] for p in facet] for facet in PIN]
    run, path = scene({"cube": cube(size, hair=hair * size), "pin": pin})
    assert run.returncode == DONE and run.stderr == "", run.stderr
    assert inside(path) == {("pin", "cube")}
    with h5py.File(path) as file:
        assert file["truth"].attrs["closed_within"] == 2.0**-20
        assert file["meshes/cube"].attrs["closed_within"] == hair * size
        assert file["meshes/pin"].attrs["closed_within"] == 0
        assert file["meshes/cube/vertices"][0, 2] == hair * size, "vertices stay as they are read"
        assert list(file["truth/contained_inside"]) == [1]
    checked = json.loads(pipeline("verify", path, "--all", "--json").stdout)
    assert checked["contained"] == {"pairs": 1, "checked": 1} and checked["difference"] is None
    assert json.loads(pipeline("show", path, "--json").stdout)["contained_inside"] == {"pin": 1}


def test_a_hair_wider_than_the_width_is_named_with_its_edge(scene):
    meshes = {"cube": cube(hair=2e-6), "pin": PIN}
    run, path = scene(meshes)
    assert run.returncode == DONE
    line = one_line(run)
    assert line.startswith("warning: ")
    assert "cube.stl: the surface is open, the edge from (0, 0, 2e-06) to (0, 0, 1)" in line
    assert "within 9.54e-07 m taken as one" in line and line.endswith("nothing can be inside it")
    assert inside(path) == set()
    with h5py.File(path) as file:
        assert np.isnan(file["meshes/cube"].attrs["closed_within"])
    # A wider width closes it, none at all opens the finest hair.
    run, path = scene(meshes, "--set", "truth.closed_within=3e-6")
    assert run.stderr == "" and inside(path) == {("pin", "cube")}
    run, path = scene({"cube": cube(hair=2.7e-16), "pin": PIN}, "--set", "truth.closed_within=0")
    assert "coordinates are equal" in one_line(run) and inside(path) == set()
    assert pipeline("verify", path, "--all").returncode == DONE


@pytest.mark.parametrize("containment", ["record", "meet"])
def test_an_open_body_refuses_only_the_pairs_that_need_it(scene, containment):
    """A room holds a cup without a side and a pin in the cup's hollow: only the room can hold anything."""
    meshes = {"cup": cube()[:-2], "pin": PIN, "room": cube(8, (-4, -4, -4))}
    run, path = scene(meshes, containment=containment)
    assert run.returncode in (DONE, 1)  # obb_sat's boxes may miss what is contained
    assert "cup.stl: the surface is open" in run.stderr.splitlines()[0] and run.stderr.count("is open") == 1
    assert inside(path) == {("cup", "room"), ("pin", "room")}
    assert pipeline("verify", path, "--all").returncode == DONE
    if containment == "meet":
        assert load(path).summary.loc["exact", "error"] == 0


def test_where_every_mesh_is_open_containment_is_refused(scene):
    run, path = scene({"cup": cube()[:-2], "bowl": cube(2)[1:]})
    assert run.returncode == INPUT and not path.exists()
    line = one_line(run)
    for text in ("scene.toml:6:8: 'scene.body.0.mesh' of body 'cup': mesh 'cup' is open, the edge from (", "9.54e-07",
                 "close one"):
        assert text in line


@pytest.mark.parametrize(("more", "said"), [
    (cube(), "12 facets stand where another stands already"),
    (cube(1, (0.5, 0.5, 0.5)), "2 of its 2 shells touch or cross another"),
    (cube(0.5, (0.25, 0.25, 0.25)), "1 shell lies inside another that faces the same way"),
    ([facet[::-1] for facet in cube(0.5, (0.25, 0.25, 0.25))], None),  # a cavity
    (cube(1, (5, 5, 5)), None),
])  # fmt: skip
def test_what_parity_makes_hollow_is_said(scene, more, said):
    run, path = scene({"cube": cube() + more, "pin": PIN})
    assert run.returncode == DONE
    if said:
        assert one_line(run).endswith(f"cube.stl: {said}; what lies in two shells counts as outside")
    else:
        assert run.stderr == ""
    assert pipeline("verify", path, "--all").returncode == DONE
    unasked = scene({"cube": cube() + more, "pin": PIN}, containment="ignore")[0]
    assert "shell" not in unasked.stderr and "facet" not in unasked.stderr


def matthews(tp, fp, fn, tn):
    return (tp * tn - fp * fn) / (sqrt(tp + fp) * sqrt(tp + fn) * sqrt(tn + fp) * sqrt(tn + fn))


def test_a_recorded_contained_pair_is_no_true_negative_whether_reported_or_not(tmp_path):
    """Matthews' coefficient once more, from the lists of pairs and the poses alone."""
    path = tmp_path / "example.h5"
    assert pipeline("run", ROOT / "configs/replay_example.toml", "-o", path, "--quiet").returncode == DONE
    run = load(path)
    position, fixed = run.motion[0], run.bodies.fixed.to_numpy()
    with h5py.File(path) as file:
        chosen = file["bodies/chosen"][()]
    there = ~np.isnan(position[:, :, 0])
    asked = {(step, a, b) for step in range(len(there)) for a, b in itertools.combinations(range(len(fixed)), 2)
             if there[step, a] and there[step, b] and not (fixed[a] and fixed[b]) and (chosen[a] or chosen[b])}
    rows = lambda table: set(map(tuple, table[["step", "a", "b"]].to_numpy().tolist()))  # noqa: E731
    judged = asked - rows(run.contained_pairs)
    assert len(judged) < len(asked)
    seen = 0
    for label in run.summary.index:
        real, reported = rows(run.truth_pairs), rows(run.pairs(label))
        seen += not rows(run.contained_pairs) <= reported
        counts = len(real & reported), len((reported - real) & judged), len(real - reported)
        expected = matthews(*counts, len(judged) - sum(counts))
        assert run.summary.matthews[label] == pytest.approx(expected, rel=1e-12, nan_ok=True), label
    assert seen > 0, "no algorithm leaves a contained pair unreported: nothing was tested"
