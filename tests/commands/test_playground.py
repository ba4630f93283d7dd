"""A scripted scene: no integration, and how early or late algorithms report its passes."""

import json
import subprocess

import h5py
import numpy as np
import pytest
import xarray

from analysis.load import load

CONFIG = """
title = "A ball and two obstacles"

[scene]
kind = "playground"

[scene.hero]
shape = "sphere"
radius = 1
segments = 6

[[scene.obstacle]]
name = "cube"
shape = "box"
size = [2, 2, 2]

[[scene.obstacle]]
name = "ring"
shape = "torus"
diameter = 6
thickness = 1

[[scene.path]]
axis = "y"

[[scene.path]]
name = "up"
from = [0.5, -4, 0]
to = [0.5, 4, 0]
targets = ["cube"]

[[algorithm]]
name = "bounding_sphere"

[[algorithm]]
name = "obb_sat"
"""
PASS_COLUMNS = {
    "target", "path", "orientation", "offset", "first_step", "samples", "truth_first", "truth_last", "truth_hits",
}  # fmt: skip
ANSWER_COLUMNS = {"first", "last", "flicker", "hits"}


def test_nothing_is_integrated(pipeline, config, result):
    with h5py.File(result) as file:
        assert "physics" not in file
        assert list(file["bodies/chosen"]) == [1, 0, 0]
    said = subprocess.run([pipeline, "check", config], check=True, capture_output=True, text=True).stdout
    assert "no integrator is built and no /physics written" in said
    assert "2 pairs a step" in said
    assert "passes      3" in said
    assert load(result).physics is None


def test_passes_open_alone_with_their_dimensions(result):
    with xarray.open_dataset(result, group="passes", engine="h5netcdf") as passes:
        assert set(passes.data_vars) == PASS_COLUMNS | ANSWER_COLUMNS
        for name in PASS_COLUMNS:
            assert passes[name].dims == ("pass",)
        for name in ANSWER_COLUMNS:
            assert passes[name].dims == ("pass", "algorithm")
        for name in passes.data_vars:
            assert passes[name].attrs["long_name"]
        for name in ("offset", "truth_first", "truth_last", "first", "last"):
            assert passes[name].attrs["units"] == "m"
        assert list(passes["algorithm"].values) == ["bounding_sphere", "obb_sat"]
        assert list(passes["target"].values) == ["cube", "cube", "ring"]
        assert list(passes["path"].values) == ["y", "up", "y"]


def test_positions_are_those_of_geometry(result):
    table = load(result).passes
    assert len(table) == 6
    up = table[(table["path"] == "up") & (table["algorithm"] == "bounding_sphere")].iloc[0]
    assert up.truth_first == pytest.approx(2, abs=1e-9)  # from y = -4: the ball's pole meets the face at y = -2
    assert up.truth_last == pytest.approx(6, abs=1e-9)
    early = np.sqrt((2 * np.sqrt(3)) ** 2 - 0.5**2) - 2  # spheres of radius root 3, 0.5 m aside
    assert up["first"] == pytest.approx(early, abs=2e-6)
    assert up["last"] == pytest.approx(-early, abs=2e-6)
    assert up.offset == 0.5

    ring = table[table["target"] == "ring"]
    assert ring["truth_first"].isna().all() and ring["first"].isna().all()
    assert (ring["truth_hits"] == 0).all() and (ring["reported"] > 0).all()  # both see no hole


def test_samples_of_a_pass_are_its_steps(result):
    run = load(result)
    table = run.passes[run.passes["algorithm"] == "obb_sat"]
    truth = run.truth_pairs
    for row in table.itertuples():
        steps = truth["step"].between(row.first_step, row.first_step + row.samples - 1)
        assert steps.sum() == row.truth_hits
    assert table["samples"].sum() == run.meta["steps"]


def test_show_tells_early_from_late(pipeline, result):
    text = subprocess.run([pipeline, "show", result], check=True, capture_output=True, text=True).stdout
    assert "first report" in text and "missed + false positives" in text
    shown = subprocess.run([pipeline, "show", result, "--json"], check=True, capture_output=True, text=True).stdout
    rows = {(row["target"], row["algorithm"]): row for row in json.loads(shown)["passes"]}
    assert rows["cube", "bounding_sphere"]["first_median"] > 1
    assert rows["cube", "bounding_sphere"]["passes"] == rows["cube", "bounding_sphere"]["met"] == 2
    assert rows["ring", "obb_sat"]["false_positives"] == 1
    assert rows["ring", "obb_sat"]["first_median"] is None


def test_detect_adds_a_column(pipeline, result, tmp_path):
    copy = tmp_path / "copy.h5"
    copy.write_bytes(result.read_bytes())
    command = [pipeline, "detect", copy, "--algorithm", "facet_distance:max_distance=0.5@half"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    before, after = load(result).passes, load(copy).passes
    old = after[after["algorithm"] != "half"]
    np.testing.assert_array_equal(old["first"], before["first"])
    half = after[after["algorithm"] == "half"]
    assert len(half) == 3
    assert half[half["target"] == "ring"]["reported"].item() == 0  # sees the hole
    assert (half[half["target"] == "cube"]["reported"] > 0).all()


def test_more_steps_than_the_paths_have_are_refused(pipeline, config, tmp_path):
    command = [pipeline, "run", config, "-o", tmp_path / "x.h5", "--set", "steps=100000"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 3
    assert done.stderr.startswith("--set steps=100000: 'steps' must be an integer between 1 and ")
    assert done.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())
