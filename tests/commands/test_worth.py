"""What a time is worth and what a label costs besides: intervals, noise floor, processor time, set-up, memory, pin."""

import json
import os
import re
import shutil
import time

import h5py
import numpy as np
import pytest
from editing import edited
from program import DONE, INPUT, ROOT, one_line, pipeline

from analysis.load import load
from analysis.tables import intervals

SMOKE = ROOT / "configs" / "smoke.toml"
STEPS = 300  # six blocks


def run(path, *settings):
    command = ["run", SMOKE, "-o", path, "--quiet", "--set", "timing.repeats=1"]
    for setting in settings:
        command += ["--set", setting]
    return pipeline(*command)


@pytest.fixture(scope="module")
def noisy(tmp_path_factory):
    """Long enough for intervals, with a noise floor."""
    path = tmp_path_factory.mktemp("worth") / "noisy.h5"
    made = run(path, f"steps={STEPS}", "timing.noise=true")
    assert made.returncode == DONE, made.stderr
    return path


def test_both_programs_compute_the_same_intervals(noisy):
    loaded = load(noisy)
    for label, row in loaded.summary.iterrows():
        mean = intervals.mean(loaded.step_times[label])
        np.testing.assert_allclose([row.time_mean_ns, row.time_mean_low_ns, row.time_mean_high_ns],
                                   [mean.value, mean.low, mean.high], rtol=1e-12)  # fmt: skip
        assert row.time_mean_low_ns <= row.time_mean_ns <= row.time_mean_high_ns


def test_the_noise_floor_is_the_ratio_of_the_first_label_with_itself(noisy):
    loaded = load(noisy)
    first = loaded.meta["algorithms"][0]
    with h5py.File(noisy) as file:
        assert file["noise"].attrs["label"] == first
        again = file["noise/time_ns"][()]
    assert (again > 0).all() and not np.array_equal(again, loaded.step_times[first])
    ratio = intervals.ratio(again, loaded.step_times[first])
    np.testing.assert_allclose([loaded.noise.value, loaded.noise.low, loaded.noise.high],
                               [ratio.value, ratio.low, ratio.high], rtol=1e-12)  # fmt: skip
    assert f"noise floor: {first} timed twice has a ratio of " in pipeline("show", noisy).stdout
    assert json.loads(pipeline("show", noisy, "--json").stdout)["noise"]["label"] == first


def test_noise_is_no_label_and_changes_no_digest(noisy, tmp_path):
    path = tmp_path / "quiet.h5"
    assert run(path, f"steps={STEPS}").returncode == DONE
    assert load(path).meta["algorithms"] == load(noisy).meta["algorithms"]
    digests = [json.loads(pipeline("show", one, "--json").stdout)["digests"] for one in (path, noisy)]
    assert digests[0] == digests[1]
    assert load(path).noise is None and "noise floor" not in pipeline("show", path).stdout


def test_every_label_has_its_set_up_and_memory(noisy):
    table = load(noisy).summary
    assert (table.setup_ns > 0).all()
    assert (table.memory_bytes > 0).all() and (table.memory_greatest_bytes >= table.memory_bytes).all()
    with h5py.File(noisy) as file:
        for label, row in table.iterrows():
            for name in ("setup_ns", "memory_bytes", "memory_greatest_bytes"):
                assert file["answers"][label].attrs[name] == row[name]
    shown = pipeline("show", noisy).stdout
    head = next(line for line in shown.splitlines() if line.startswith("algorithm "))
    assert "set-up" in head and "memory" in head and "95 % interval" in head


def test_memory_is_what_the_method_must_hold(noisy):
    """bounding_sphere keeps five doubles a body; what malloc adds is small."""
    bodies = len(load(noisy).meta["bodies"])
    held = load(noisy).summary.memory_bytes["bounding_sphere"]
    assert 5 * 8 * bodies <= held <= 5 * 8 * bodies + 6 * 64 + 256


def test_memory_is_about_the_same_in_another_run(noisy, tmp_path):
    assert run(tmp_path / "again.h5", f"steps={STEPS}").returncode == DONE
    for name in ("memory_bytes", "memory_greatest_bytes"):
        np.testing.assert_allclose(load(tmp_path / "again.h5").summary[name], load(noisy).summary[name], rtol=0.02)


def test_processor_time_stands_beside_wall_time(noisy):
    with h5py.File(noisy) as file:
        wall, processor = file["results/time_ns"][()], file["results/processor_ns"][()]
    assert (processor > 0).all()
    # A step that was not interrupted takes the processor as long as the wall; a clock costs less than 5 us.
    assert np.median(np.abs(processor - wall) / (wall + 5000)) < 0.2


def test_a_disturbed_run_and_a_mean_above_its_percentile_are_said(noisy, tmp_path):
    path = shutil.copy(noisy, tmp_path / "copy.h5")
    with edited(path) as file:
        first = list(file["algorithm"].asstr()).index("obb_sat")
        file["summary/processor_mean_ns"][first] = file["summary/time_mean_ns"][first] / 1.05
        file["summary/time_p95_ns"][first] = file["summary/time_mean_ns"][first] / 2
    shown = pipeline("show", path).stdout
    assert re.search(r"DISTURBED: the wall time is above the processor's own, of .*obb_sat by 5\.0 %", shown)
    assert re.search(r"the mean time lies above its 95th percentile, of .*obb_sat", shown)
    from analysis.report.report import doubtful_times

    words = " ".join(doubtful_times(load(path)))
    assert "obb_sat by 5 %" in words
    assert re.search(r"the mean time of .*obb_sat.* lies above its 95th percentile", words)


def test_a_pinned_run_says_which_processor_it_got(tmp_path):
    allowed = sorted(os.sched_getaffinity(0))
    made = pipeline("run", SMOKE, "-o", tmp_path / "r.h5", "--set", "steps=5", "--set", f"timing.pin={allowed[-1]}")
    assert made.returncode == DONE and f"timed on processor {allowed[-1]}\n" in made.stderr
    assert {a["pinned"] for a in load(tmp_path / "r.h5").meta["answers"].values()} == {allowed[-1]}
    assert f"timed on processor {allowed[-1]} alone" in made.stdout


def test_a_processor_that_is_not_there_is_refused_before_the_work(tmp_path):
    started = time.monotonic()
    made = run(tmp_path / "r.h5", "timing.pin=1000")
    assert made.returncode == INPUT and time.monotonic() - started < 5
    assert re.match(r"--set timing.pin=1000: 'timing.pin' must be a processor that this program may use \(\d.*\), "
                    r"not 1000; "
                    "or leave it out", one_line(made))  # fmt: skip
    assert pipeline("check", SMOKE, "--set", "timing.pin=1000").returncode == INPUT
    assert not list(tmp_path.iterdir())


def test_a_recorded_processor_that_is_not_here_is_said_and_not_used(noisy, tmp_path):
    path = shutil.copy(noisy, tmp_path / "copy.h5")
    with edited(path) as file:
        text = file["config"].attrs["effective"]
        file["config"].attrs["effective"] = text.replace("noise = true", "noise = true\npin = 1000")
    made = pipeline("detect", path, "--algorithm", "aabb@again")
    assert made.returncode == DONE, made.stderr
    assert "warning: there is no processor 1000 here" in made.stderr
    assert "pinned" not in load(path).meta["answers"]["again"]


def test_older_results_are_read_and_get_what_they_lack_when_timed_again(noisy, tmp_path):
    path = shutil.copy(noisy, tmp_path / "older.h5")
    with edited(path) as file:
        for name in ("time_mean_low_ns", "time_mean_high_ns", "processor_mean_ns", "setup_ns", "memory_bytes",
                     "memory_greatest_bytes"):  # fmt: skip
            del file[f"summary/{name}"]
        del file["results/processor_ns"], file["noise"]
        for answers in file["answers"].values():
            for name in ("setup_ns", "memory_bytes", "memory_greatest_bytes"):
                del answers.attrs[name]
    shown = pipeline("show", path)
    assert shown.returncode == DONE, shown.stderr
    assert "setup_ns" not in load(path).summary
    assert pipeline("detect", path, "--algorithm", "aabb@again", "--quiet").returncode == DONE
    table = load(path).summary
    assert table.setup_ns["again"] > 0 and np.isnan(table.setup_ns["obb_sat"])


def test_a_resumed_run_keeps_what_it_measured(tmp_path):
    """Costs and noise survive a stop: they are in the chunks."""
    import signal
    import subprocess

    from program import PIPELINE

    path = tmp_path / "r.h5"
    command = [PIPELINE, "run", str(SMOKE), "-o", str(path), "--quiet", "--set", "steps=300",
               "--set", "timing.repeats=40",
               "--set", "timing.noise=true"]  # fmt: skip
    first = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    part = tmp_path / "r.h5.part"
    while first.poll() is None and len(list(part.glob("answers-*"))) < 2:
        time.sleep(0.01)
    first.send_signal(signal.SIGINT)
    first.wait()
    if path.exists():
        pytest.skip("the run was over before it could be stopped")
    assert subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode == DONE
    with h5py.File(path) as file:
        assert (file["noise/time_ns"][()] > 0).all() and file["noise/time_ns"].shape == (300,)
        assert (file["summary/setup_ns"][()] > 0).all() and (file["summary/memory_bytes"][()] > 0).all()


def test_score_shows_costs_and_never_fails_by_them(noisy, tmp_path):
    base = tmp_path / "base.json"
    assert pipeline("score", noisy, "--against", base, "--write", "--times").returncode == DONE
    recorded = json.loads(base.read_text())["algorithms"]["obb_sat"]
    assert {"time_ratio", "setup_ratio", "memory_bytes"} <= set(recorded)
    text = json.loads(base.read_text())
    text["algorithms"]["obb_sat"]["memory_bytes"] /= 2
    base.write_text(json.dumps(text))
    scored = pipeline("score", noisy, "--against", base, "--times")
    assert scored.returncode == DONE, scored.stdout
    assert re.search(r"obb_sat: time .*, set-up x 1\.00, memory x 2\.00", scored.stdout)
    found = json.loads(pipeline("score", noisy, "--against", base, "--times", "--json").stdout)["times"]
    assert next(one for one in found if one["label"] == "obb_sat")["memory_factor"] == pytest.approx(2, rel=0.01)
