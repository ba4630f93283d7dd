"""A scene of extremes as its users meet it: the group /extremes, its tables, what `show` and `verify` say."""

import json
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
import xarray

from analysis.tables import extremes
from analysis.load import load

CONFIG = """
title = "A few extremes"

[scene]
kind = "extremes"
pairs = ["box-box", "needle-box", "box-nested_box", "coplanar_sheets"]
scales = [1e-9, 1, 1e6]
offsets = [0, 1e3]

[timing]
repeats = 1

[[algorithm]]
name = "bounding_sphere"

[[algorithm]]
name = "facet_distance"

[[algorithm]]
name = "obb_sat"
"""
CASE_COLUMNS = {
    "pair", "gap_class", "gap", "ulp", "scale", "offset", "gap_ulps", "orientation_stream", "truth", "truth_moved",
    "near_touching",
}  # fmt: skip
ANSWER_COLUMNS = {"reported", "swapped", "moved", "failed"}


def said(pipeline, *arguments):
    return subprocess.run([pipeline, *arguments], check=True, capture_output=True, text=True).stdout


def test_cases_open_alone_with_their_dimensions(result):
    with xarray.open_dataset(result, group="extremes", engine="h5netcdf") as cases:
        assert set(cases.data_vars) == CASE_COLUMNS | ANSWER_COLUMNS | {"failure"}
        for name in CASE_COLUMNS:
            assert cases[name].dims == ("step",)
        for name in ANSWER_COLUMNS:
            assert cases[name].dims == ("step", "algorithm")
        assert cases["failure"].dims == ("algorithm",)
        for name in cases.data_vars:
            assert cases[name].attrs["long_name"]
        for name in ("gap", "ulp", "scale", "offset"):
            assert cases[name].attrs["units"] == "m"


def test_the_oracle_finds_no_difference(pipeline, result):
    found = json.loads(said(pipeline, "verify", result, "--all", "--quiet", "--json"))
    assert found["difference"] is None


def test_cases_agree_with_truth_and_answers(result):
    run = load(result)
    cases = run.extremes
    assert len(cases) == run.meta["steps"] * 3
    meeting = set(run.truth_pairs["step"])
    assert (cases["truth"] == cases["step"].isin(meeting)).all()
    for label in run.meta["algorithms"]:
        mine = cases[cases["algorithm"] == label]
        assert set(mine["step"][mine["reported"]]) == set(run.pairs(label)["step"])
    touching = cases[cases["gap_ulps"] == 0]
    assert touching["truth"].all() and touching["near_touching"].all()
    assert not cases[cases["gap_ulps"] == 1]["truth"].any()


def test_tables_add_up(result):
    run = load(result)
    for table in (
        extremes.error_by_gap(run),
        extremes.error_by_offset(run),
        extremes.error_by_scale(run),
        extremes.error_by_shape(run),
    ):
        total = table.groupby("algorithm", observed=True)[["cases", "failed"]].sum()
        assert (total["cases"] == run.meta["steps"]).all()
        wrong = table["false_positive"] + table["false_negative"]
        answered = table["cases"] - table["failed"]
        known = answered > 0
        np.testing.assert_allclose(table["wrong"][known], (wrong / answered)[known])
        assert table["error"][~known].isna().all() and table["error"][known].between(0, 1).all()
    by_scale = extremes.error_by_scale(run)
    # 8 facets per m^2 of boxes of a million metres are too many: refused, not answered.
    assert (by_scale.loc["facet_distance"].xs(1e6, level="scale").eval("cases == failed")).all()
    assert (by_scale.loc["facet_distance"].xs(1.0, level="scale")["failed"] == 0).all()
    # Where all is nearer than 0.25 m its prefilter alone decides; nothing that meets is beyond it.
    assert by_scale.loc["obb_sat", "failed"].sum() == 0


def test_gaps_are_in_order_and_near_touching_is_apart(result):
    table = extremes.error_by_gap(load(result))
    clear = table.loc["obb_sat", False]
    assert clear["gap"].is_monotonic_increasing
    assert not [name for name in clear.index if name.endswith("ulp")]
    near = table.loc["obb_sat", True]
    assert {"0 ulp", "+1 ulp", "-1 ulp", "+10 ulp", "-10 ulp", "+1000 ulp", "-1000 ulp"} <= set(near.index)
    # An oriented box of a box is the box: nothing wrong clear of touching.
    boxes = extremes.error_by_shape(load(result)).loc["obb_sat", False].loc["box-box"]
    assert boxes["error"] == 0 and boxes["true_positive"] > 20


def test_instability_says_why_an_algorithm_failed(result):
    table = extremes.instability(load(result))
    assert "denser" in table.loc[("facet_distance", False), "failure"]
    assert table.loc[("bounding_sphere", False), "failure"] == ""
    assert (table.loc["bounding_sphere", "swapped"] == 0).all()
    cases = table.groupby("algorithm", observed=True)[["cases", "failed"]].sum().sum(axis=1)
    assert (cases == load(result).meta["steps"]).all()


def test_other_scenes_have_no_extremes(result_file):
    run = load(result_file)
    assert run.extremes is None and run.failures is None
    with pytest.raises(ValueError, match="is not of a scene of extremes"):
        extremes.error_by_gap(run)


def test_show_and_check_say_it(pipeline, config, result):
    text = said(pipeline, "show", result)
    assert "error clear" in text and "swap changes" in text and "facet_distance failed first: mesh" in text
    rows = json.loads(said(pipeline, "show", result, "--json"))["extremes"]
    assert sum(row["cases"] for row in rows if row["algorithm"] == "obb_sat") == load(result).meta["steps"]
    assert "sets of gaps" in said(pipeline, "check", config)


def test_detect_adds_a_column(pipeline, result, tmp_path):
    copy = tmp_path / "copy.h5"
    copy.write_bytes(result.read_bytes())
    said(pipeline, "detect", copy, "--algorithm", "aabb", "--algorithm", "facet_distance:densify=false@plain")
    before, after = load(result), load(copy)
    old = after.extremes[after.extremes["algorithm"].isin(before.meta["algorithms"])]
    assert (old["reported"].to_numpy() == before.extremes["reported"].to_numpy()).all()
    assert not after.extremes[after.extremes["algorithm"] == "plain"]["failed"].any()
    with h5py.File(result) as one, h5py.File(copy) as other:
        for name in CASE_COLUMNS:
            assert (one["extremes"][name][()] == other["extremes"][name][()]).all()


def test_a_killed_run_ends_with_the_same_digest(pipeline, config, result, tmp_path):
    path = tmp_path / "x.h5"
    command = [pipeline, "run", config, "-o", path, "--threads", "1"]
    for chunk in ("truth-0000100", "answers-0000100"):
        run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while run.poll() is None and not (tmp_path / "x.h5.part" / chunk).exists():
            time.sleep(0.001)
        run.send_signal(signal.SIGKILL)
        run.wait()
    if not path.exists():
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    assert load(path).meta["digest"] == load(result).meta["digest"]


def test_offsets_beyond_every_scale_are_refused(pipeline, config, tmp_path):
    command = [pipeline, "run", config, "-o", tmp_path / "x.h5", "--set", "scene.scales=[1e-9]"]
    done = subprocess.run([*command, "--set", "scene.offsets=[1e6]"], capture_output=True, text=True)
    assert done.returncode == 3 and "2^40" in done.stderr and done.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())
