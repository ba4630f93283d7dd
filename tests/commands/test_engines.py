"""Engines from npm (algorithms/peers/web): what they answer, and what is said of one that is not there or cannot."""
import json
import re
import shutil

import h5py
import numpy as np
import pytest
from program import DONE, FAILED, INPUT, ROOT, pipeline

WEB = ROOT / "algorithms" / "peers" / "web"
NODE = shutil.which("node")
RECORDED = ROOT / "tests" / "data" / "engines.json"  # by label and scene: hits, wrong ones, digest
SCENES = ("falling", "playground")
MESHES = ("three_bvh", "rapier_trimesh", "ammo_gimpact")
SOLIDS = ("manifold",)
HULLS = ("mujoco_hull", "ammo_hull", "jolt_hull")
REST = ("babylon_obb", "babylon_aabb", "three_obb", "three_octree", "cannon_es_naive", "cannon_es_sap",
        "cannon_es_narrow", "oimo")
LABELS = (*MESHES, *SOLIDS, *HULLS, *REST)
NINE = ("obb_sat", "bounding_sphere", "rotated_aabb", "facet_distance", "obb_corners", "facet_vectors",
        "obb_triangles", "facet_triangles", "facet_rotations")
OWN = ("exact", "cannon_naive", "cannon_sap", *NINE)
NEEDS = {"three_bvh": "three-mesh-bvh", "rapier_trimesh": "@dimforge/rapier3d-compat", "manifold": "manifold-3d",
         "mujoco_hull": "@mujoco/mujoco", "jolt_hull": "jolt-physics", "oimo": "oimo"}

pytestmark = pytest.mark.skipif(not NODE, reason="no node here")


def package(label):
    starts = {"babylon": "@babylonjs/core", "three": "three", "cannon": "cannon-es", "ammo": "ammojs-typed"}
    return NEEDS.get(label) or next(name for start, name in starts.items() if label.startswith(start))


def installed(name):
    return (WEB / "node_modules" / name).is_dir()


def row(label, command, more=""):
    return (f'\n[[algorithm]]\nname = "program"\nlabel = "{label}"\ncommand = {json.dumps([str(w) for w in command])}\n'
            f"{more}\n")


def own(name):
    return f'\n[[algorithm]]\nname = "{name}"\n'


def answered(scene, folder, rows):
    """A small motion, answered by rows."""
    config = (ROOT / "tests" / "baselines" / f"{scene}.toml").read_text()
    config = config.replace("../data", str(ROOT / "tests" / "data")).replace("step = 0.5", "step = 1.0")
    config = re.split(r"\n\[truth|\n\[timing|\n\[\[algorithm", config)[0]
    config += '\n[truth]\ncontainment = "record"\n[timing]\nrepeats = 1\n'
    (folder / f"{scene}.toml").write_text(config + "".join(rows))
    path = folder / f"{scene}.h5"
    run = pipeline("run", folder / f"{scene}.toml", "-o", path, "--quiet")
    assert run.returncode == DONE, run.stderr
    return path


@pytest.fixture(scope="module")
def engines(tmp_path_factory):
    """Small motions answered by all that are installed."""
    folder = tmp_path_factory.mktemp("engines")
    there = [label for label in LABELS if installed(package(label))]
    rows = [*map(own, OWN), *(row(label, [NODE, WEB / f"{label}.mjs"]) for label in there)]
    return {scene: answered(scene, folder, rows) for scene in SCENES}


@pytest.fixture(scope="module")
def nine(tmp_path_factory):
    """The nine in both languages."""
    if not installed("@babylonjs/core"):
        pytest.skip("@babylonjs/core is not installed: scripts/peers web")
    folder = tmp_path_factory.mktemp("nine")
    rows = [*map(own, NINE), *(row(f"js_{name}", [NODE, WEB / "thesis.mjs"], f'algorithm = "{name}"') for name in NINE)]
    return answered("playground", folder, rows)


def pairs(path, label):
    """(step, a, b) of every reported pair; /truth's, and those of which one is inside the other."""
    with h5py.File(path) as file:
        group, prefix = (file["truth"], "contained_" if label == "contained" else "pair_")
        if label not in ("truth", "contained"):
            group, prefix = file["answers"][label], "pair_"
        offset, pair = group[f"{prefix}offset"][()], group["contained_pair" if "c" in prefix else "pair"][()]
    steps = np.repeat(np.arange(len(offset) - 1), np.diff(offset).astype(int))
    return {tuple(map(int, row)) for row in np.c_[steps, pair]}


def attributes(path, label):
    with h5py.File(path) as file:
        return dict(file["answers"][label].attrs)


def skip_without(label):
    if not installed(package(label)):
        pytest.skip(f"{package(label)} is not installed: scripts/peers web")


def told(path, label):
    said, truth, inside = pairs(path, label), pairs(path, "truth"), pairs(path, "contained")
    return {"hits": len(said), "false_positive": len(said - truth - inside), "false_negative": len(truth - said),
            "contained": len(said & inside), "digest": str(attributes(path, label)["digest"])}


@pytest.mark.parametrize("label", LABELS)
def test_an_engine_answers_as_recorded(engines, label):
    skip_without(label)
    recorded = json.loads(RECORDED.read_text())[label]
    assert {scene: told(engines[scene], label) for scene in SCENES} == recorded


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("label", (*MESHES, *SOLIDS))
def test_engines_of_meshes_invent_nothing_and_miss_only_what_just_touches(engines, scene, label):
    skip_without(label)
    said = told(engines[scene], label)
    assert said["false_positive"] == 0
    assert said["hits"] - said["contained"] > 5
    if label == "ammo_gimpact" and scene == "falling":  # balls that touch the plate in a point at step 0
        missed = pairs(engines[scene], "truth") - pairs(engines[scene], label)
        assert {step for step, _, _ in missed} <= {0}
    else:
        assert said["false_negative"] == 0
    assert (said["contained"] > 0) == (label in SOLIDS and scene == "playground"), "solids are met inside, surfaces not"


@pytest.mark.parametrize("label, like", [("three_obb", "obb_sat"), ("babylon_obb", "obb_sat"),
                                         ("cannon_es_naive", "cannon_naive")])
def test_boxes_and_balls_answer_as_ours(engines, label, like):
    skip_without(label)
    for scene in SCENES:
        one, other = pairs(engines[scene], label), pairs(engines[scene], like)
        assert len(other) > 5 and len(one & other) >= 0.999 * len(one | other)


def test_sweep_and_prune_hides_pairs_and_invents_none(engines):
    skip_without("cannon_es_sap")
    for scene in SCENES:
        assert pairs(engines[scene], "cannon_es_sap") <= pairs(engines[scene], "cannon_es_naive")


def test_our_sweep_and_prune_is_the_engine_s(engines):
    skip_without("cannon_es_sap")
    for scene in SCENES:
        assert pairs(engines[scene], "cannon_es_sap") == pairs(engines[scene], "cannon_sap")


def test_hulls_hold_their_meshes(engines):
    """Balls that MuJoCo's hulls have all vertices of; Jolt's have at most 256, and miss."""
    skip_without("mujoco_hull")
    skip_without("jolt_hull")
    truth = pairs(engines["falling"], "truth")
    assert truth <= pairs(engines["falling"], "mujoco_hull")
    found = truth & pairs(engines["falling"], "jolt_hull")
    assert 5 < len(found) < len(truth)


def test_mujoco_is_silent_where_two_bodies_have_one_centre_unless_its_older_routine_is_asked(tmp_path):
    skip_without("mujoco_hull")
    rows = [row(label, [NODE, WEB / "mujoco_hull.mjs"], more) for label, more in
            [("native", ""), ("older", "native = false")]]
    path = answered("playground", tmp_path, rows)
    with h5py.File(path) as file:
        place = file["motion/position"][()]
        at_centre = set(np.flatnonzero((place[:, 0] == place[:, 1]).all(axis=1)).tolist())
    meet = {pair for pair in pairs(path, "truth") if pair[0] in at_centre and pair[2] == 1}
    assert len(meet) > 1 and not meet & pairs(path, "native") and meet <= pairs(path, "older")
    assert pairs(path, "truth") <= pairs(path, "older")


@pytest.mark.parametrize("label", LABELS)
def test_an_engine_says_what_it_is(engines, label):
    skip_without(label)
    about = attributes(engines["falling"], label)
    wanted = json.loads((WEB / "package.json").read_text())["dependencies"][package(label)]
    assert about["name"] == label and about["version"].split(",")[0] == wanted
    assert about["licence"] in ("MIT", "Apache-2.0")
    assert re.match("single|double", about["precision"]) and len(about["tests"]) > 5
    assert about["language"].startswith("JavaScript, node ")
    assert (about["status"], about["threads"]) == ("complete", 1)
    assert f'label    = "{label}"' in (ROOT / "configs" / "engines.toml").read_text()


@pytest.mark.parametrize("name", NINE)
def test_the_nine_answer_alike_in_both_languages(nine, name):
    ours, theirs = pairs(nine, name), pairs(nine, f"js_{name}")
    assert len(ours) > 5 or name == "facet_rotations" and len(ours) > 0
    assert len(ours & theirs) >= 0.999 * len(ours | theirs)
    about = attributes(nine, f"js_{name}")
    assert (about["name"], about["precision"]) == (name, "single")


def test_the_lock_file_has_no_addresses():
    lock = json.loads((WEB / "package-lock.json").read_text())["packages"]
    assert all("resolved" not in entry for entry in lock.values())
    assert all(entry.get("integrity") for name, entry in lock.items() if name), "each is known by its content"
    assert lock[""]["dependencies"] == json.loads((WEB / "package.json").read_text())["dependencies"]


# ---- what is not there, or cannot: a folder as ours, with a package of our own making


@pytest.fixture
def odd(tmp_path):
    """A folder with the shared code, an installed package "odd" 1.0.0, and an engine by make(); and its command."""
    web = tmp_path / "algorithms" / "peers" / "web"
    shutil.copytree(ROOT / "algorithms" / "program", tmp_path / "algorithms" / "program")
    (web / "node_modules" / "odd").mkdir(parents=True)
    shutil.copy(WEB / "engine.mjs", web)
    (web / "package.json").write_text('{"type": "module", "dependencies": {"odd": "1.0.0"}}')
    (web / "node_modules" / "odd" / "package.json").write_text('{"name": "odd", "version": "1.0.0", "license": "MIT"}')

    def made(body):
        (web / "odd.mjs").write_text("import {engine} from './engine.mjs';\n"
                                     f"engine({{name: 'odd', packages: ['odd'], tests: 'nothing'}}, {body});\n")
        return [NODE, web / "odd.mjs"]

    return made, web


BALLS = """world => {  // balls about the middles: right about the bodies of the self-test
  const at = [];
  return {place: (i, pose, k) => at[i] = [pose[k], pose[k + 1], pose[k + 2]], meets: (a, b) => {
    if (LATER) throw new Error('out of luck');
    const reach = i => world.bodies[i].mesh.sphere || 1;
    return Math.hypot(...at[a].map((x, i) => x - at[b][i])) < reach(a) + reach(b);
  }};
}"""
SCENE = """
[scene]
kind = "replay"
poses = "poses.csv"
[[scene.body]]
name = "a"
shape = "box"
size = [1, 1, 1]
[[scene.body]]
name = "b"
shape = "box"
size = [1, 1, 1]
fixed = true
position = [0, 0, 0]
[timing]
repeats = 1
[[algorithm]]
name = "aabb"
"""


def asked(tmp_path, command, more="optional = true", label="odd"):
    (tmp_path / "poses.csv").write_text("step,body,px,py,pz,qw,qx,qy,qz\n0,a,0.5,0,0,1,0,0,0\n1,a,9,0,0,1,0,0,0\n")
    (tmp_path / "c.toml").write_text(SCENE + row(label, command, more))
    return pipeline("run", tmp_path / "c.toml", "-o", tmp_path / "c.h5", "--quiet", "--force")


def labels(tmp_path):
    with h5py.File(tmp_path / "c.h5") as file:
        return list(file["algorithm"].asstr()[()])


def left_out(run, tmp_path, why):
    assert run.returncode == DONE, run.stderr
    assert run.stderr == f"warning: algorithm 'odd' is left out: {why}\n"
    assert labels(tmp_path) == ["aabb"]
    with h5py.File(tmp_path / "c.h5") as file:
        assert "odd" not in file["config"].attrs["effective"], "what ran is told"
    check = pipeline("check", tmp_path / "c.toml")
    assert check.returncode == DONE and check.stderr == run.stderr


def test_a_missing_package_is_named_and_left_out(odd, tmp_path):
    made, web = odd
    shutil.rmtree(web / "node_modules")
    left_out(asked(tmp_path, made(BALLS.replace("LATER", "false"))), tmp_path,
             "it gives up: odd 1.0.0 is not installed; scripts/peers web installs it")


def test_another_version_is_named_and_left_out(odd, tmp_path):
    made, web = odd
    (web / "node_modules" / "odd" / "package.json").write_text('{"name": "odd", "version": "1.0.1", "license": "MIT"}')
    left_out(asked(tmp_path, made(BALLS.replace("LATER", "false"))), tmp_path,
             "it gives up: odd must be of version 1.0.0, not 1.0.1; scripts/peers web installs it")


def test_without_node_it_is_left_out(tmp_path):
    left_out(asked(tmp_path, ["no-such-node", "odd.mjs"]), tmp_path, "there is no program 'no-such-node' along PATH")


def test_what_is_not_optional_is_refused(odd, tmp_path):
    made, web = odd
    shutil.rmtree(web / "node_modules")
    run = asked(tmp_path, made(BALLS.replace("LATER", "false")), "")
    assert run.returncode == INPUT and "odd 1.0.0 is not installed" in run.stderr


@pytest.mark.parametrize("meets, said", [("false", "none"), ("true", "0-1 0-2 1-2")])
def test_a_silent_engine_fails_its_self_test(odd, tmp_path, meets, said):
    made, _ = odd
    run = asked(tmp_path, made("() => ({place() {}, meets: () => %s})" % meets), "")
    wanted = "0-1 meet" if meets == "false" else "none meet"
    assert run.returncode == INPUT
    assert f"self-test: of two balls and a cube {wanted}, it says {said}" in run.stderr


def test_a_stale_engine_fails_its_self_test(odd, tmp_path):
    """One that never hears of the second place of a body."""
    made, _ = odd
    body = BALLS.replace("LATER", "false").replace("at[i] =", "at[i] ??=")
    run = asked(tmp_path, made(body), "")
    assert run.returncode == INPUT and "self-test: of two balls and a cube 0-1 meet, it says none" in run.stderr


def test_an_engine_that_cannot_take_the_meshes_says_so_at_its_label(odd, tmp_path):
    made, _ = odd
    body = BALLS.replace("LATER", "false").replace(
        "const at = [];", "if (world.bodies.length < 3) throw new Error(`mesh '${world.meshes[0].name}' is too odd`);"
        "const at = [];")
    run = asked(tmp_path, made(body))
    assert run.returncode == FAILED
    about = attributes(tmp_path / "c.h5", "odd")
    assert (about["status"], about["steps_done"]) == ("failed", 0)
    assert about["reason"] == "it cannot take these bodies: mesh 'a' is too odd"
    assert attributes(tmp_path / "c.h5", "aabb")["promise"] == "conservative"


def test_manifold_says_which_mesh_is_open(tmp_path):
    skip_without("manifold")
    (tmp_path / "open.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n")
    (tmp_path / "poses.csv").write_text("step,body,px,py,pz,qw,qx,qy,qz\n0,a,0,0,0,1,0,0,0\n")
    scene = SCENE.replace('shape = "box"\nsize = [1, 1, 1]\n', 'mesh = "open.obj"\n', 1)
    (tmp_path / "c.toml").write_text(scene + row("manifold", [NODE, WEB / "manifold.mjs"]))
    run = pipeline("run", tmp_path / "c.toml", "-o", tmp_path / "c.h5", "--quiet")
    assert run.returncode == FAILED
    reason = attributes(tmp_path / "c.h5", "manifold")["reason"]
    assert re.search("cannot take these bodies: mesh 'a': .*manifold", reason, re.IGNORECASE)
