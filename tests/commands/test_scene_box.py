"""The box scene in the file: births, bodies at each step, scores; and that runs of it are never lost."""

import json
import signal

import h5py
import numpy as np
import pytest
import xarray

from program import ROOT, digest, pipeline, start, wait_for

KOSTKA = str(ROOT / "configs" / "kostka.toml")
PLATES = 6
# Twelve coarse spheres by step 55, pushed at step 50, of all algorithms.
SMALL = ["--set", "steps=60", "--set", "scene.segments=6", "--set", "timing.repeats=1"]


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    path = tmp_path_factory.mktemp("box") / "box.h5"
    done = pipeline("run", KOSTKA, "-o", path, *SMALL)
    assert done.returncode == 0, done.stderr
    return path


@pytest.fixture
def file(small):
    with h5py.File(small) as opened:
        yield opened


def test_births_follow_the_schedule(file):
    first = file["bodies/first_step"][:]
    assert list(first[:PLATES]) == [0] * PLATES
    assert list(first[PLATES:]) == [5 * i if 5 * i < 60 else -1 for i in range(80)]


def test_poses_are_nan_before_birth_and_never_after(file):
    first = file["bodies/first_step"][:]
    unborn = (first[None, :] == -1) | (np.arange(60)[:, None] < first[None, :])
    for name in ("position", "orientation"):
        values = file["motion"][name][:]
        assert (np.isnan(values) == unborn[:, :, None]).all(), name
    assert (file["bodies/born"][:] == (~unborn).sum(axis=1)).all()
    assert list(file["bodies/born"][[0, 4, 5, 59]]) == [7, 7, 8, 18]


def test_no_sphere_overlaps_another_at_birth_or_leaves(file):
    position = file["motion/position"][:, PLATES:]
    for sphere in range(12):
        step = 5 * sphere
        distance = np.linalg.norm(position[step] - position[step, sphere], axis=1)
        assert (distance[:sphere] >= 1 - 1e-12).all()
        assert np.abs(position[step, sphere]).max() <= 4.5
    assert np.nanmax(np.abs(position)) < 5


def test_spheres_rest_until_the_push_and_then_fly_apart(file):
    position = file["motion/position"][:, PLATES : PLATES + 11]
    assert np.abs(position[50] - position[45])[:10].max() < 1e-12
    speed = np.linalg.norm(position[51] - position[50], axis=1) * 60
    assert np.median(speed) == pytest.approx(5, rel=1e-6)
    ways = (position[51] - position[50]) * 60 / speed[:, None]
    cosine = ways @ ways.T
    assert np.median(cosine[np.triu_indices(11, 1)]) < 0.5


def test_scores_count_born_pairs_only(file):
    born = file["bodies/born"][:].astype(int)
    pairs = born * (born - 1) // 2 - PLATES * (PLATES - 1) // 2
    for column in ("hits", "true_positive", "false_positive", "false_negative", "operations"):
        assert column in file["results"]
    hits = file["results/hits"][:].astype(int)
    assert (file["results/true_positive"][:] + file["results/false_positive"][:] == hits).all()
    truth = file["truth/hits"][:].astype(int)
    assert (file["results/true_positive"][:] + file["results/false_negative"][:] == truth[:, None]).all()
    assert (hits <= pairs[:, None]).all()
    assert hits.sum() > 0
    first = file["bodies/first_step"][:]
    for label in file["algorithm"].asstr():
        offset, pair = file["answers"][label]["pair_offset"][:], file["answers"][label]["pair"][:]
        step = np.repeat(np.arange(60), np.diff(offset.astype(int)))
        assert ((first[pair] >= 0) & (first[pair] <= step[:, None])).all(), label


def test_xarray_opens_every_group(small):
    for group in ("bodies", "motion", "physics", "truth", "results", "summary"):
        with xarray.open_dataset(small, group=group, engine="h5netcdf") as dataset:
            assert dataset.sizes
    with xarray.open_dataset(small, group="bodies", engine="h5netcdf") as bodies:
        assert bodies["born"].dims == ("step",)
        assert bodies["first_step"].dims == ("body",)


def test_the_same_command_gives_the_same_digest(small, tmp_path):
    assert pipeline("run", KOSTKA, "-o", tmp_path / "again.h5", *SMALL, "--threads", 3).returncode == 0
    assert digest(tmp_path / "again.h5") == digest(small)


# Births at steps 49 and 50 and pushes at 50 and 100: around the boundaries of the chunks.
LONG = ["--set", "steps=160", "--set", "scene.segments=4", "--set", "timing.repeats=1", "--set", "scene.births.every=1",
        "--set", "scene.births.from=40", "--set", "scene.births.count=40"]


@pytest.fixture(scope="module")
def long_digest(tmp_path_factory):
    path = tmp_path_factory.mktemp("long") / "long.h5"
    assert pipeline("run", KOSTKA, "-o", path, *LONG).returncode == 0
    return digest(path)


@pytest.mark.parametrize("chunk", ["motion-0000000", "motion-0000050", "motion-0000100"])
def test_a_killed_run_resumes_with_the_same_digest(tmp_path, long_digest, chunk):
    path, part = tmp_path / "x.h5", tmp_path / "x.h5.part"
    process = start("run", KOSTKA, "-o", path, *LONG)
    wait_for(lambda: (part / chunk).exists() or process.poll() is not None)
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=60)
    assert pipeline("run", KOSTKA, "-o", path, *LONG).returncode == 0
    assert digest(path) == long_digest
    assert not part.exists()


def test_a_birth_without_a_place_is_one_line_and_leaves_nothing(tmp_path):
    crowd = ["--set", "steps=100", "--set", "scene.half_width=2", "--set", "scene.births.every=1"]
    pipeline("run", KOSTKA, *crowd, cwd=tmp_path)
    assert list(tmp_path.iterdir()) == []  # no folder results either
    done = pipeline("run", KOSTKA, "-o", tmp_path / "x.h5", *crowd)
    assert done.returncode == 3
    assert done.stdout == ""
    lines = done.stderr.strip().splitlines()
    assert len(lines) == 1
    for word in ("kostka.toml", "sphere_", "must be born at step", "lower scene.births.count"):
        assert word in lines[0]
    assert list(tmp_path.iterdir()) == []


def test_more_spheres_than_fit_are_refused_before_the_pipeline(tmp_path):
    done = pipeline("check", KOSTKA, "--set", "scene.births.count=1500", "--set", "scene.births.every=0")
    assert done.returncode == 3
    assert "no packing fills more than 0.74" in done.stderr


def test_a_sphere_that_leaves_fails_the_run_as_data(tmp_path):
    foam = ["--set", "steps=120", "--set", "scene.segments=4", "--set", "physics.stiffness=100"]
    path = tmp_path / "x.h5"
    done = pipeline("run", KOSTKA, "-o", path, *foam, "--set", "timing.repeats=1")
    assert done.returncode == 1
    with h5py.File(path) as file:
        status = file["physics"].attrs["status"]
        assert status.startswith("failed at step ") and "left the cube" in status
        step = int(status.split()[3].rstrip(":"))
        assert (file["bodies/born"][step:] == PLATES).all()
        assert file["bodies/born"][step - 1] > PLATES
    assert status in done.stderr


def test_check_says_that_no_gravity_acts():
    text = pipeline("check", KOSTKA).stdout
    assert "86 bodies" in text and "no gravity force" in text and "no damping" in text
    assert json.loads(pipeline("check", KOSTKA, "--json").stdout)["scene"] == "box"
