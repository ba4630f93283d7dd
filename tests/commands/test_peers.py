"""Other people's libraries that answer from plug-ins: what they answer on small motions, and what is said of one that
is not there, cannot be loaded, or cannot take a mesh."""

import json
import os
import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest
from program import DONE, INPUT, PIPELINE, ROOT, pipeline

RECORDED = ROOT / "tests" / "data" / "peers.json"  # by scene and label: version, hits, false ones, missed, digest
SURFACES = ("bullet_gimpact", "bullet_gimpact_double", "ode_trimesh", "simbody_mesh", "embree")
HULLS = ("bullet_hull", "bullet_hull_double", "ccd_mpr", "ccd_gjk")
LABELS = {name: f'name = "{name}"' for name in (*SURFACES, *HULLS)} | {
    "gimpact_default": 'name = "bullet_gimpact"\nmargin = 0.01',
    "gimpact_double_default": 'name = "bullet_gimpact_double"\nmargin = 0.01',
    "hull_default": 'name = "bullet_hull"\nmargin = 0.04',
}
SCENES = ("falling", "playground")


def answered(scene, out):
    """The small motion of a baseline, answered by every label whose library is here; with distances and containment."""
    config = (ROOT / "tests" / "baselines" / f"{scene}.toml").read_text()
    config = config.replace("../data", str(ROOT / "tests" / "data"))
    config = config.split("\n[truth]")[0].split("\n[timing]")[0].replace("step = 0.5", "step = 1.0")
    rows = "".join(f'\n[[algorithm]]\nlabel = "{label}"\noptional = true\n{text}\n' for label, text in LABELS.items())
    path = out.with_suffix(".toml")
    path.write_text(f'{config}\n[truth]\ngap = true\ncontainment = "record"\n[timing]\nrepeats = 1\n'
                    f'[[algorithm]]\nname = "aabb"\n{rows}')
    run = pipeline("run", path, "-o", out, "--quiet", "--force")
    assert run.returncode == DONE, run.stderr
    return out


def rows_of(path):
    """What is recorded of a result, by label."""
    with h5py.File(path) as file:
        labels = [label.decode() for label in file["algorithm"][:]]
        columns = ("hits", "false_positive", "false_negative", "contained_hit")
        counts = {name: file["summary"][name][:] for name in columns}
        return {label: {"version": file["answers"][label].attrs["version"]}
                | {name: int(values[i]) for name, values in counts.items()}
                | {"digest": file["answers"][label].attrs["digest"]}
                for i, label in enumerate(labels) if label in LABELS}


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    made = {}

    def result(scene):
        if scene not in made:
            made[scene] = answered(scene, tmp_path_factory.mktemp("peers") / f"{scene}.h5")
        return made[scene]

    return result


def need(label):
    """Skips where the library of a label is not built, and says what it needs."""
    name = LABELS[label].split('"')[1]
    for row in json.loads(pipeline("list", "algorithms", "--json").stdout):
        if row["name"] == name and "missing" in row:
            pytest.skip(f"{name} needs {row['missing']}")


def pairs_of(path, where):
    """(step, a, b) of every pair."""
    with h5py.File(path) as file:
        offset, pair = (file[where][name][:] for name in ("pair_offset", "pair"))
    steps = np.repeat(np.arange(len(offset) - 1), np.diff(offset).astype(int))
    return set(zip(steps.tolist(), *pair.T.tolist()))


def contained(path):
    with h5py.File(path) as file:
        offset, pair = (file["truth"][f"contained_{name}"][:] for name in ("offset", "pair"))
    steps = np.repeat(np.arange(len(offset) - 1), np.diff(offset).astype(int))
    return set(zip(steps.tolist(), *pair.T.tolist()))


def wrong(path, label):
    """(false positives, misses, hits on contained pairs)."""
    said, meet, inside = pairs_of(path, f"answers/{label}"), pairs_of(path, "truth"), contained(path)
    return said - meet - inside, meet - said, said & inside


def gaps(path):
    """(step, a, b) -> (lower, upper) of near pairs that do not meet, m."""
    with h5py.File(path) as file:
        offset, pair, lower, upper = (file["truth"][f"gap_{name}"][:] for name in ("offset", "pair", "lower", "upper"))
    steps = np.repeat(np.arange(len(offset) - 1), np.diff(offset).astype(int))
    return {(int(s), int(a), int(b)): (low, up) for s, (a, b), low, up in zip(steps, pair, lower, upper)}


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("label", LABELS)
def test_answers_are_those_recorded(results, label, scene):
    need(label)
    found, recorded = rows_of(results(scene))[label], json.loads(RECORDED.read_text())[scene][label]
    if found["version"] != recorded["version"]:
        pytest.skip(f"{label} is of version {found['version']}, recorded is that of {recorded['version']}")
    assert found == recorded


# Independent of the recorded answers: in the recorded motion spheres rest on the plate, 1e-4 m off touching at most.
@pytest.mark.parametrize("label", SURFACES)
def test_what_is_asked_by_surfaces_errs_where_bodies_touch_and_not_on_bodies_inside(results, label):
    need(label)
    false, missed, inside = wrong(results("falling"), label)
    assert not false and not inside
    with h5py.File(results("falling")) as file:
        names = [name.decode() for name in file["bodies/mesh"][:]]
        position = file["motion/position"][:]
    for step, a, b in missed:
        assert names[a] == "plate" and "lying" in names[b], (names[a], names[b])
        assert abs(abs(position[step, a, 1] - position[step, b, 1]) - 2) < 1e-4
    false, missed, inside = wrong(results("playground"), label)
    assert not false and not inside and len(missed) <= 1, missed


def test_embree_s_triangles_are_decided_exactly(results):
    need("embree")
    for scene in SCENES:
        assert wrong(results(scene), "embree") == (set(), set(), set())


@pytest.mark.parametrize("label, margin", [("gimpact_default", 0.01), ("gimpact_double_default", 0.01),
                                           ("hull_default", 0.04)])
def test_a_margin_reports_what_is_within_it_twice(results, label, margin):
    need(label)
    path = results("falling")  # convex bodies
    apart, (false, missed, _) = gaps(path), wrong(path, label)
    assert not missed and len(false) > 100
    for pair in false:
        assert pair in apart and apart[pair][0] <= 2 * margin + 1e-5, pair
    near = {pair for pair, (_, upper) in apart.items() if upper < margin}
    assert near and near <= false


@pytest.mark.parametrize("label", HULLS)
def test_hulls_report_bodies_inside_others(results, label):
    need(label)
    path = results("playground")
    false, missed, inside = wrong(path, label)
    assert inside == contained(path) and inside
    assert not missed and false  # the ring's middle, the knot's loops


def test_the_two_precisions_of_bullet_answer_in_one_run(results):
    need("bullet_gimpact"), need("bullet_gimpact_double")
    with h5py.File(results("falling")) as file:
        told = [dict(file["answers"][name].attrs) for name in ("bullet_gimpact", "bullet_gimpact_double")]
    assert [one["precision"] for one in told] == ["single", "double"]
    for one in told:
        assert one["tests"] == "surfaces of the meshes" and one["licence"] == "Zlib" and one["language"] == "C++"
        assert one["library"].startswith("Bullet 3") and one["memory_bytes"] > 10_000 and one["setup_ns"] > 0
        (file_name, digest), = json.loads(one["files_sha256"]).items()
        assert "/" not in file_name and len(digest) == 64


# ---- One that is not there


@pytest.fixture
def bare(tmp_path):
    """The program without the plug-ins beside it."""
    (tmp_path / "bin").mkdir()
    return shutil.copy(PIPELINE, tmp_path / "bin" / "pipeline")


def bare_run(program, *arguments):
    return subprocess.run([program, *map(str, arguments)], text=True, capture_output=True, timeout=60)


CONFIG = """
title = "two cubes"
[scene]
kind = "replay"
poses = "poses.csv"
[[scene.body]]
name = "a"
{shape}
[[scene.body]]
name = "b"
shape = "box"
size = [1, 1, 1]
[timing]
repeats = 1
[[algorithm]]
name = "aabb"
[[algorithm]]
name = "{name}"
{more}
"""


def config(folder, name, more="optional = true", shape='shape = "box"\nsize = [1, 1, 1]'):
    (folder / "poses.csv").write_text("step,body,px,py,pz,qw,qx,qy,qz\n0,a,0,0,0,1,0,0,0\n0,b,0.5,0.5,0.3,1,0,0,0\n")
    (folder / "c.toml").write_text(CONFIG.format(name=name, more=more, shape=shape))
    return folder / "c.toml"


def missing_of(program, name):
    rows = json.loads(bare_run(program, "list", "algorithms", "--json").stdout)
    return next(row for row in rows if row["name"] == name).get("missing", "")


@pytest.mark.parametrize("name", [*SURFACES, *HULLS])
def test_without_its_library_an_optional_label_is_left_out(bare, tmp_path, name):
    needs = missing_of(bare, name)
    assert "scripts/peers installs it (lib" in needs
    run = bare_run(bare, "run", config(tmp_path, name), "-o", tmp_path / "o.h5", "--quiet")
    assert run.returncode == DONE and f"algorithm '{name}' is left out: it needs {needs}" in run.stderr
    run = bare_run(bare, "run", config(tmp_path, name, ""), "-o", tmp_path / "p.h5", "--quiet")
    assert run.returncode == INPUT and len(run.stderr.splitlines()) == 1
    assert "must be an algorithm of this build" in run.stderr and needs in run.stderr


def test_a_plug_in_that_cannot_be_loaded_is_said_and_left_out(bare, tmp_path):
    folder = tmp_path / "bin" / "plugins"
    folder.mkdir()
    (folder / "libode_trimesh.so").write_text("no library\n")
    source = tmp_path / "needy.c"
    source.write_text("extern int nowhere(void);\nint collision_plugin(void) { return nowhere(); }\n")
    subprocess.run(["cc", "-shared", "-fPIC", source, "-o", folder / "libembree.so"], check=True)
    assert "is no shared library" in missing_of(bare, "ode_trimesh")
    assert "cannot be loaded" in missing_of(bare, "embree") and "nowhere" in missing_of(bare, "embree")
    run = bare_run(bare, "run", config(tmp_path, "embree"), "-o", tmp_path / "o.h5", "--quiet")
    assert run.returncode == DONE and "algorithm 'embree' is left out" in run.stderr and "nowhere" in run.stderr


def test_a_plug_in_is_found_where_it_is_installed(bare, tmp_path):
    need("ode_trimesh")
    folder = tmp_path / "lib" / "collision_benchmark"
    folder.mkdir(parents=True)
    shutil.copy(os.path.join(os.path.dirname(PIPELINE), "plugins", "libode_trimesh.so"), folder)
    run = bare_run(bare, "run", config(tmp_path, "ode_trimesh", ""), "-o", tmp_path / "o.h5", "--quiet")
    assert run.returncode == DONE, run.stderr
    with h5py.File(tmp_path / "o.h5") as file:
        assert file["summary/error"][1] == 0 and file["summary/true_positive"][1] == 1


def test_a_result_s_own_peers_answer_again(tmp_path):
    need("ode_trimesh")
    assert pipeline("run", config(tmp_path, "ode_trimesh"), "-o", tmp_path / "o.h5", "--quiet").returncode == DONE
    again = pipeline("detect", tmp_path / "o.h5", "--force", "--quiet")
    assert again.returncode == DONE and "left out" not in again.stderr
    more = pipeline("detect", tmp_path / "o.h5", "--algorithm", "ode_trimesh@once_more", "--quiet")
    assert more.returncode == DONE, more.stderr


def test_a_mesh_that_a_library_cannot_take_is_one_line_and_others_go_on(tmp_path):
    need("simbody_mesh")
    (tmp_path / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    path = config(tmp_path, "simbody_mesh", shape='mesh = "open.obj"')
    run = pipeline("run", path, "-o", tmp_path / "o.h5", "--quiet")
    assert run.returncode == DONE and "algorithm 'simbody_mesh' is left out" in run.stderr, run.stderr
    with h5py.File(tmp_path / "o.h5") as file:
        assert [label.decode() for label in file["algorithm"][:]] == ["aabb"]


def main():
    """test_peers.py --write: records what this build answers."""
    import pathlib
    import tempfile
    with tempfile.TemporaryDirectory() as folder:
        rows = {scene: rows_of(answered(scene, pathlib.Path(folder) / f"{scene}.h5")) for scene in SCENES}
    RECORDED.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__" and "--write" in sys.argv:
    main()
