"""Bodies of many contact spheres: heaps of any closed meshes, what is refused, what is stored."""
import re
import shutil
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
from program import DONE, INPUT, PIPELINE, ROOT, one_line, pipeline

HEAP, CUP = ROOT / "configs" / "heap.toml", ROOT / "configs" / "cup.toml"
QUICK = ["--set", "algorithm=[{name='aabb'},{name='exact'}]", "--set", "timing.repeats=1"]
# 27 bodies that land at once.
SMALL = [*QUICK, "--set", "scene.set.0.above=[3,3,3]", "--set", "scene.set.0.spacing=2.4", "--set",
         "scene.set.0.height=2"]
CUBE = "".join(f"v {x} {y} {z}\n" for z in (0, 1) for y in (0, 1) for x in (0, 1))
FACES = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"


def digests(path):
    return dict(reversed(line.split()[1:]) for line in pipeline("show", path, "--digests").stdout.splitlines()
                if line.startswith("digest"))


@pytest.fixture(scope="module")
def heap(tmp_path_factory):
    path = tmp_path_factory.mktemp("heap") / "heap.h5"
    run = pipeline("run", HEAP, "-o", path, *SMALL, "--set", "steps=110", "--threads", 1)
    assert run.returncode == DONE, run.stderr
    return path


def test_a_heap_verifies_and_every_kind_meets_others(heap):
    run = pipeline("verify", heap, "--all")
    assert run.returncode == DONE and "agrees about all of them" in run.stdout, run.stdout + run.stderr
    with h5py.File(heap) as file:
        assert file["physics"].attrs["status"] == "complete"
        kinds = file["bodies/mesh"].asstr()[()]
        met = {kinds[b] for b in file["truth/pair"][()].ravel()}
        assert {kind for kind in kinds if not kind.startswith("kerb_")} <= met
        assert {"plate", "box", "capsule", "torus", "torus_knot", "notched_l", "sphere"} < set(kinds)


def test_nothing_sinks_through_the_plate_or_flies_away(heap):
    with h5py.File(heap) as file:
        position = file["motion/position"][()][:, 1:]
        assert position[:, :, 1].min() > 0.1
        assert np.abs(position[-1]).max() < 20
        energy = file["physics/energy"][()]
        assert energy[-1] < 0.5 * energy[0]
        assert (np.diff(energy) < 1e-3 * energy[0]).all()


def test_the_file_tells_its_spheres(heap):
    with h5py.File(heap) as file:
        for name, mesh in file["meshes"].items():
            many = name not in ("plate", "sphere") and not name.startswith("kerb_")
            assert ("contact_spheres" in mesh) == many == ("contact_deviation" in mesh.attrs), name
            if not many:
                continue
            spheres, vertices = mesh["contact_spheres"][()], mesh["vertices"][()]
            assert 1 < len(spheres) <= 64
            low, high = vertices.min(axis=0), vertices.max(axis=0)
            centre, radius = spheres[:, :3], spheres[:, 3:]
            assert (centre - radius >= low - 1e-12).all() and (centre + radius <= high + 1e-12).all()
            apart = np.linalg.norm(vertices[:, None] - centre[None], axis=2) - radius.T
            assert 0 <= apart.min()
            assert apart.min(axis=1).max() <= mesh.attrs["contact_deviation"] < 0.25 * max(high - low)


def test_detect_keeps_the_spheres(heap, tmp_path):
    copy = tmp_path / "copy.h5"
    shutil.copy(heap, copy)
    assert pipeline("detect", copy, "--algorithm", "bounding_sphere").returncode == DONE
    with h5py.File(heap) as before, h5py.File(copy) as after:
        for name in ("box", "torus"):
            mesh, same = before["meshes"][name], after["meshes"][name]
            assert (mesh["contact_spheres"][()] == same["contact_spheres"][()]).all()
            assert mesh.attrs["contact_deviation"] == same.attrs["contact_deviation"]


def test_two_threads_and_a_kill_change_nothing(heap, tmp_path):
    path = tmp_path / "x.h5"
    command = ["run", str(HEAP), "-o", str(path), *SMALL, "--set", "steps=110", "--threads", "2"]
    run = subprocess.Popen([PIPELINE, *command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    end = time.monotonic() + 120
    while time.monotonic() < end and run.poll() is None and not (tmp_path / "x.h5.part" / "motion-0000050").exists():
        time.sleep(0.002)
    run.send_signal(signal.SIGKILL)
    run.wait()
    assert not path.exists(), "it should have been killed while it ran"
    again = pipeline(*command)
    assert again.returncode == DONE and "resuming" in again.stderr
    assert digests(path) == digests(heap)


def test_the_seed_turns_them(tmp_path):
    at = []
    for seed in (1, 2):
        path = tmp_path / f"{seed}.h5"
        assert pipeline("run", HEAP, "-o", path, *SMALL, "--set", "steps=1", "--set", f"seed={seed}").returncode == DONE
        with h5py.File(path) as file:
            at.append((file["motion/position"][()], file["motion/orientation"][()]))
    assert (at[0][0] == at[1][0]).all() and (at[0][1][:, 5:] != at[1][1][:, 5:]).any(axis=2).all()


def test_a_bowl_keeps_what_falls_into_it(tmp_path):
    path = tmp_path / "cup.h5"
    run = pipeline("run", CUP, "-o", path, *QUICK, "--set", "scene.set.0.above=[3,2,3]", "--set", "steps=120",
                   "--set", "scene.set.0.corner=[-1.15,-1.15]")
    assert run.returncode == DONE, run.stderr
    with h5py.File(path) as file:
        assert file["body"].asstr()[1] == "bowl" and file["bodies/fixed"][1]
        place = file["motion/position"][-1, 2:]
        # Inside the ball of 4 m about (0, 5, 0), whose lower part is the bowl.
        assert (np.linalg.norm(place - [0, 5, 0], axis=1) < 4).all() and (place[:, 1] < 4).all()


def scene(folder, mesh, more=""):
    (folder / "c.toml").write_text(
        '[scene]\nkind = "falling"\n[[scene.set]]\nlying = [0, 0]\nabove = [1, 1, 1]\n' + more +
        f'shapes = [{{ mesh = "{mesh}" }}]\n[[algorithm]]\nname = "aabb"\n')
    return folder / "c.toml"


@pytest.mark.parametrize("faces,what", [
    (FACES[:-len("f 2 4 8 6\n")],
     r"the surface is open, the edge from \(1, 1, 0\) to \(1, 0, 0\) belongs to 1 facet, .*; "
                                  "close it, or raise truth.closed_within"),
    (FACES.replace("f 2 4 8 6", "f 6 8 4 2"), "its facets face both ways; turn those that face inward"),
    ("f 1 2 4 3\nf 7 8 6 5\nf 5 6 2 1\nf 4 8 7 3\nf 3 7 5 1\nf 6 8 4 2\n", "its facets face inward; turn them all"),
    ("f 1 3 4 2\nf 1 2 4 3\n", "it has no volume; give it some thickness"),
], ids=["open", "both ways", "inward", "flat"])
def test_what_is_no_solid_is_one_line(tmp_path, faces, what):
    (tmp_path / "m.obj").write_text(CUBE + faces)
    config = scene(tmp_path, "m.obj")
    for command in (["check", config], ["run", config, "-o", tmp_path / "x.h5"]):
        run = pipeline(*command)
        assert run.returncode == INPUT
        assert re.fullmatch(r".*c\.toml:6:\d+: 'scene\.set\.0\.shapes\.0\.mesh' must be a solid body, "
                            rf"not \"m\.obj\": {what}",
                            one_line(run)), run.stderr
    assert not (tmp_path / "x.h5").exists()


def test_spheres_that_find_no_place_are_one_line(tmp_path):
    (tmp_path / "m.obj").write_text(re.sub(r"v (\S+) (\S+) 1\n", r"v \1 \2 0.001\n", CUBE) + FACES)
    run = pipeline("check", scene(tmp_path, "m.obj"), "--set", "scene.contact_spheres=4")
    assert run.returncode == INPUT
    assert re.search(r"not \"m\.obj\": \d+ contact spheres inside it leave its surface up to \S+ m away, "
                     r"more than a quarter of its size; raise contact_spheres, or make it thicker$", one_line(run))


def test_a_mesh_that_is_not_there_is_one_line(tmp_path):
    run = pipeline("check", scene(tmp_path, "none.obj"))
    assert run.returncode == INPUT and "'scene.set.0.shapes.0.mesh' must name a file that can be read" in one_line(run)


@pytest.mark.parametrize("setting,what", [
    ("scene.contact_spheres=0", "'scene.contact_spheres' must be an integer between 1 and 10000, not 0"),
    ("scene.set.0.shapes=[]", "'scene.set.0.shapes' must hold at least one shape, not []"),
    ("scene.set.0.shapes=[{shape='cone'}]", "'scene.set.0.shapes.0.shape' must be "),
    ("scene.set.0.shapes=[{}]", "missing key 'scene.set.0.shapes.0.shape'"),
    ("scene.set.0.shapes=[{shape='box',size=[1,1,1],densty=3}]", "did you mean 'density'?"),
    ("scene.obstacle=[{shape='box',size=[1,1,1]}]", "missing key 'scene.obstacle.0.name'"),
    ("scene.obstacle=[{name='plate',shape='box',size=[1,1,1]}]", "'scene.obstacle.0.name' must be the only one of its "
                                                                 "name"),
])
def test_wrong_keys_are_one_line(setting, what):
    run = pipeline("check", HEAP, "--set", setting)
    assert run.returncode == INPUT and what in one_line(run), run.stderr


def test_too_many_contact_spheres_are_refused_with_the_estimate(tmp_path):
    more = ["--set", "scene.set.0.above=[80,100,80]", "--set", "scene.contact_spheres=10000", "--set", "steps=1",
            "--set", "scene.set.0.shapes=[{shape='torus',diameter=2,thickness=0.5}]", *QUICK]
    for command in (["check", HEAP], ["run", HEAP, "-o", tmp_path / "x.h5"]):
        before = time.monotonic()
        run = pipeline(*command, *more)
        assert run.returncode == INPUT
        assert re.search(r"the run needs about \d+\.\d [GT]iB of memory, this machine has .*"
                         r"contact_spheres make it smaller",
                         one_line(run)), run.stderr
        assert time.monotonic() - before < 20, "before spheres are placed"
    assert list(tmp_path.iterdir()) == []
