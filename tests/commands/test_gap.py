"""Certified distances of near pairs: there only when asked for, the same however the run was done."""

import json
import pathlib
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
import xarray

from analysis.load import load

SMOKE = pathlib.Path(__file__).resolve().parent.parent.parent / "configs" / "smoke.toml"
GAP = ["--set", "truth.gap=true", "--set", "truth.gap_margin=0.3"]


@pytest.fixture(scope="module")
def plain(pipeline, tmp_path_factory):
    path = tmp_path_factory.mktemp("plain") / "plain.h5"
    subprocess.run([pipeline, "run", SMOKE, "-o", path], check=True, stdout=subprocess.DEVNULL)
    return path


@pytest.fixture(scope="module")
def result(pipeline, tmp_path_factory):
    path = tmp_path_factory.mktemp("gap") / "gap.h5"
    subprocess.run([pipeline, "run", SMOKE, "-o", path, *GAP], check=True, stdout=subprocess.DEVNULL)
    return path


def test_nothing_is_there_unless_asked_for(plain):
    with h5py.File(plain) as file:
        assert not [name for name in list(file["truth"]) + list(file["truth"].attrs) if "gap" in name]
    assert load(plain).gaps is None


def test_everything_else_keeps_its_bits(plain, result):
    with h5py.File(plain) as one, h5py.File(result) as other:
        for group in ["motion"] + [f"answers/{label}" for label in one["answers"]]:
            assert one[group].attrs["digest"] == other[group].attrs["digest"]
        for name in ("hits", "pair", "pair_offset"):
            np.testing.assert_array_equal(one["truth"][name], other["truth"][name])


def test_bounds_open_alone_with_their_dimensions(result):
    with xarray.open_dataset(result, group="truth", engine="h5netcdf") as truth:
        assert truth["gap_pair"].dims == ("gap_entry", "side")
        for name in ("gap_lower", "gap_upper"):
            assert truth[name].dims == ("gap_entry",) and truth[name].attrs["units"] == "m"
        assert truth.attrs["gap_margin"] == 0.3


def test_gaps_are_of_near_pairs_that_do_not_meet(result):
    run = load(result)
    gaps = run.gaps
    assert gaps.attrs["margin"] == 0.3
    assert len(gaps) > 100
    assert (gaps["lower"] >= 0).all() and (gaps["lower"] <= gaps["upper"]).all()
    assert (gaps["lower"] <= 0.3).all() and (gaps["upper"] - gaps["lower"] < 1e-11).all()
    meeting = set(run.truth_pairs.itertuples(index=False, name=None))
    assert not meeting & set(gaps[["step", "a", "b"]].itertuples(index=False, name=None))
    # Spheres of radius 1: their meshes are inscribed, hence the distance is at least that of the spheres.
    position = run.motion[0]
    spheres = gaps[gaps["a"] > 0]
    centres = position[spheres["step"], spheres["a"]] - position[spheres["step"], spheres["b"]]
    away = np.linalg.norm(centres, axis=1) - 2
    assert (spheres["upper"] >= away - 1e-12).all() and (spheres["lower"] <= away + 0.1).all()


def test_any_number_of_threads_and_a_kill_give_the_same_digest(pipeline, result, tmp_path):
    wanted = load(result).meta["digest"]
    one = tmp_path / "one.h5"
    command = [pipeline, "run", SMOKE, "-o", one, *GAP, "--threads", "1"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    assert load(one).meta["digest"] == wanted
    killed = tmp_path / "killed.h5"
    command[4] = killed
    first = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while first.poll() is None and not (tmp_path / "killed.h5.part" / "truth-0000000").exists():
        time.sleep(0.001)
    first.send_signal(signal.SIGKILL)
    first.wait()
    if not killed.exists():
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    assert load(killed).meta["digest"] == wanted


def test_detect_keeps_them(pipeline, result, tmp_path):
    copy = tmp_path / "copy.h5"
    copy.write_bytes(result.read_bytes())
    subprocess.run([pipeline, "detect", copy, "--algorithm", "aabb"], check=True, stdout=subprocess.DEVNULL)
    before, after = load(result), load(copy)
    assert "aabb" in after.meta["algorithms"]
    assert before.gaps.equals(after.gaps)
    with h5py.File(result) as one, h5py.File(copy) as other:
        assert one["truth"].attrs["digest"] == other["truth"].attrs["digest"]


def test_check_and_show_say_it(pipeline, result):
    def said(*arguments):
        return subprocess.run([pipeline, *arguments], check=True, capture_output=True, text=True).stdout

    assert "pairs within 0.3 m" in said("check", SMOKE, *GAP)
    assert json.loads(said("check", SMOKE, "--json", *GAP))["gap_margin"] == 0.3
    assert "gap_margin" not in json.loads(said("check", SMOKE, "--json"))
    assert "no distance is computed" in said("check", SMOKE)
    assert f"{len(load(result).gaps)} distances of pairs within 0.3 m" in said("show", result)
