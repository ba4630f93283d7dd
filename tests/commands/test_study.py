"""Studies of the integrators: the file, resuming, refusals; and what the analysis makes of cases."""
import json
import os
import signal
import subprocess
import sys
import time
import tomllib

import h5py
import numpy as np
import pandas as pd
import pytest
from editing import edited
import xarray

from conftest import ROOT
from test_cli import DONE, FILE, INPUT, INTERRUPTED, PIPELINE, digest, one_line, pipeline

from analysis.tables import studies, study_tables
from analysis.load import load

CONFIG = """
title = "Small"
study = "integration"
budget.force_evaluations = 20000

[[sweep]]
problem = "pendulum"
integrator = ["RungeKutta3", "Verlet", "CPodesBDF"]
accuracy = [1e-3, 1e-6]
fixed_step = [0.02, 0.01, 0.005, 0.0025]

[[sweep]]
problem = "drop"
integrator = ["ExplicitEuler", "RungeKutta3"]
stiffness = [1e6, 1e8, 1e12]
duration = 1.5
"""


def analysis(*arguments):
    return subprocess.run([sys.executable, "-m", "analysis", *map(str, arguments)], cwd=ROOT, text=True,
                          capture_output=True)  # fmt: skip


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "small.toml"
    path.write_text(CONFIG)
    return path


@pytest.fixture(scope="module")
def result(config):
    path = config.parent / "small.h5"
    run = pipeline("run", config, "-o", path)
    assert run.returncode == DONE and run.stderr == "", run.stderr
    return path


def test_a_file_has_the_study_and_nothing_that_is_not_needed(result):
    with h5py.File(result) as file:
        assert set(file) == {"config", "study", "run"}
        study = file["study"]
        assert "digest" not in study.attrs
        for name, data in study.items():
            assert data.shape == (3 * 2 + 2 * 4 + 2 * 3,), name
            assert data.attrs["units"] and data.attrs["long_name"], name
            if name != "case":
                assert data.dims[0][0].name == "/study/case", name
    with xarray.open_dataset(result, group="study", engine="h5netcdf") as opened:
        assert opened.sizes == {"case": 20}
        assert list(opened.case.values) == list(range(20))


def test_runs_and_process_counts_give_the_same_digest_but_other_times(config, result, tmp_path):
    assert pipeline("run", config, "-o", tmp_path / "x.h5", "--threads", "1").returncode == DONE
    assert digest(tmp_path / "x.h5") == digest(result)
    assert not load(tmp_path / "x.h5").study.time_ns.equals(load(result).study.time_ns)


def test_show_and_check_speak_of_cases(config, result):
    text = pipeline("show", result).stdout
    for word in ("Small", "20 cases", "pendulum", "Verlet", "least error", digest(result)):
        assert word in text
    shown = json.loads(pipeline("show", result, "--json").stdout)
    assert shown["cases"] == 20 and shown["digest"] == digest(result)
    assert sum(sweep["cases"] for sweep in shown["sweeps"]) == 20
    assert json.loads(pipeline("check", config, "--json").stdout)["cases"] == 20
    assert "20, each in a process of its own" in pipeline("check", config).stdout
    assert json.loads(pipeline("check", config, "--json", "--set", "every=7").stdout)["cases"] == 3


def test_an_interrupted_study_leaves_no_process_and_is_resumed(tmp_path):
    config = tmp_path / "slow.toml"
    config.write_text('study = "integration"\n[budget]\nforce_evaluations = 100000000\n[[sweep]]\nproblem = '
                      '"pendulum"\n'
                      'integrator = ["RungeKutta2"]\nfixed_step = [1e-1, 1e-2, 1e-7]\n')  # fmt: skip
    part = tmp_path / "slow.h5.part"
    run = subprocess.Popen([PIPELINE, "run", config, "-o", tmp_path / "slow.h5", "--threads", "1"], text=True,
                           stderr=subprocess.PIPE, start_new_session=True)  # fmt: skip
    children = f"/proc/{run.pid}/task/{run.pid}/children"
    deadline = time.time() + 60
    while not (part / "case-0000001").exists() and time.time() < deadline:
        time.sleep(0.02)
    child = ""
    while not child and time.time() < deadline:
        with open(children) as file:
            child = file.read().strip()
    run.send_signal(signal.SIGINT)
    assert run.wait(30) == INTERRUPTED and run.stderr.read().startswith("interrupted; the same command resumes")
    assert not subprocess.run(["ps", "-p", child, "-o", "stat="], capture_output=True, text=True).stdout.strip()
    assert "2 of 3 cases" in pipeline("show", part).stdout
    status = json.loads(pipeline("show", part, "--json").stdout)
    assert (status["cases"], status["finished_cases"], status["complete"]) == (3, 2, False)
    kept = (part / "case-0000001").stat().st_mtime_ns
    again = subprocess.Popen([PIPELINE, "run", config, "-o", tmp_path / "slow.h5"], stderr=subprocess.PIPE, text=True)
    assert "resuming" in again.stderr.readline()
    again.send_signal(signal.SIGINT)
    assert again.wait(30) == INTERRUPTED
    assert (part / "case-0000001").stat().st_mtime_ns == kept


def test_no_more_processes_run_than_processors(tmp_path):
    """With 64 at a time and as many files allowed the pipes ran out; on two cores wall time could decide a case."""
    processors = len(os.sched_getaffinity(0))
    config = tmp_path / "slow.toml"
    steps = [1e-7 * (1 + i) for i in range(processors + 3)]
    config.write_text('study = "integration"\n[budget]\nforce_evaluations = 100000000\n[[sweep]]\nproblem = '
                      '"pendulum"\n'
                      f'integrator = ["RungeKutta2"]\nfixed_step = {steps}\n')  # fmt: skip
    run = subprocess.Popen([PIPELINE, "run", config, "-o", tmp_path / "slow.h5", "--threads", "1024"],
                           stderr=subprocess.DEVNULL)  # fmt: skip
    most, deadline = 0, time.time() + 60
    while time.time() < deadline:
        with open(f"/proc/{run.pid}/task/{run.pid}/children") as file:
            now = len(file.read().split())
        if now >= processors and most < processors:
            deadline = time.time() + 0.2
        most = max(most, now)
    run.send_signal(signal.SIGINT)
    assert run.wait(30) == INTERRUPTED
    assert most == processors


def test_the_rest_of_a_study_is_run_when_resumed(config, result, tmp_path):
    """Chunks of a finished study are gone, so one is made by stopping it in the middle."""
    out = tmp_path / "x.h5"
    run = subprocess.Popen([PIPELINE, "run", config, "-o", out, "--threads", "1"], stderr=subprocess.DEVNULL)
    while run.poll() is None and not (tmp_path / "x.h5.part" / "case-0000004").exists():
        time.sleep(0.005)
    run.kill()
    run.wait()
    if not out.exists():
        assert pipeline("run", config, "-o", out).returncode == DONE
    assert digest(out) == digest(result)
    assert not (tmp_path / "x.h5.part").exists()


@pytest.mark.parametrize("value", ["0", "-1", "nan"])
@pytest.mark.parametrize("key", ["mass", "inertia"])
def test_mass_and_inertia_without_sense_are_refused(tmp_path, key, value):
    config = tmp_path / "x.toml"
    config.write_text(f'study = "integration"\n[[sweep]]\nproblem = "drop"\n{key} = {value}\n')
    for command in (["check"], ["run", "-o", tmp_path / "x.h5"]):
        run = pipeline(command[0], config, *command[1:])
        assert run.returncode == INPUT
        assert "x.toml:4:" in one_line(run) and f"'sweep.0.{key}' must be a number above 0" in one_line(run)
    assert not (tmp_path / "x.h5").exists()


def test_what_asks_for_poses_refuses_a_study(result, tmp_path):
    for command in (["detect"], ["verify"], ["score", "--against", tmp_path / "x.json", "--write"],
                    ["export", "--vtk", tmp_path / "x"]):  # fmt: skip
        run = pipeline(command[0], result, *command[1:])
        assert run.returncode == FILE and "study" in one_line(run), command
    assert list(tmp_path.iterdir()) == []
    run = analysis("statements", result)
    assert run.returncode == FILE and "study" in run.stderr


def test_a_damaged_study_is_refused(result, tmp_path):
    copy = tmp_path / "x.h5"
    copy.write_bytes(result.read_bytes())
    with edited(copy, digests=False) as file:
        file["study/error"][3] = 0.5
    run = pipeline("show", copy)
    assert run.returncode == FILE and "damaged" in one_line(run)


def test_a_study_that_lacks_a_column_is_one_line_with_its_place(result, tmp_path):
    copy = tmp_path / "x.h5"
    copy.write_bytes(result.read_bytes())
    with edited(copy) as file:
        del file["study/energy_error"]
    run = analysis("study", copy)
    assert run.returncode == FILE and one_line(run).startswith(f"{copy}: is damaged") and "energy_error" in run.stderr


# ---- what the analysis makes of it


def test_the_table_has_the_cases(result):
    table = load(result).study
    assert len(table) == 20 and table.finished.dtype == bool
    assert table.problem.value_counts().to_dict() == {"pendulum": 14, "drop": 6}
    assert table.stiffness.isna().sum() == 14
    assert (table.status[table.finished] == "finished").all() and (table.reason[table.finished] == "").all()


def test_fixed_steps_show_the_textbook_orders(result):
    orders = studies.orders(load(result))
    assert orders.order["pendulum", "RungeKutta3", "fixed_step"] == pytest.approx(3, abs=0.1)
    assert orders.order["pendulum", "Verlet", "fixed_step"] == pytest.approx(2, abs=0.1)
    assert np.isnan(orders.order["pendulum", "RungeKutta3", "accuracy"])  # two points make no line


class Fake:
    path = "fake.h5"

    def __init__(self, rows):
        self.study = pd.DataFrame(rows)


def cases(errors, by="fixed_step"):
    steps = [0.1 / 2**i for i in range(len(errors))]
    other = "accuracy" if by == "fixed_step" else "fixed_step"
    return Fake([{"sweep": "s", "integrator": "i", by: step, other: np.nan, "error": error, "finished": True,
                  "reached": 1.0, "steps": 1 / step, "nominal_order": 2.0} for step, error in zip(steps, errors)])


def test_an_order_is_fitted_between_the_coarse_and_the_rounded():
    law = [0.3 * 4.0**-i for i in range(8)]
    for by in ("fixed_step", "accuracy"):
        fitted = studies.orders(cases([2.0, 5.0] + law[2:6] + [1e-13, 2e-13], by)).iloc[0]
        assert fitted.order == pytest.approx(2, abs=1e-9) and fitted.points == 4 and fitted.spread < 1e-9
    # What is greater than a tenth is no part of the line, though there be only three points without it.
    fitted = studies.orders(cases([2.0, 0.5] + law[2:5] + [1e-13])).iloc[0]
    assert fitted.order == pytest.approx(2, abs=1e-9) and fitted.points == 3
    # The finest four count.
    fitted = studies.orders(cases([0.09, 0.06] + law[2:6])).iloc[0]
    assert fitted.order == pytest.approx(2, abs=1e-9) and fitted.points == 4
    # What rises again after three points is rounding, and no part of the line.
    fitted = studies.orders(cases([0.05, 0.0125, 0.003125, 0.004, 0.005])).iloc[0]
    assert fitted.order == pytest.approx(2) and fitted.points == 3


def test_drift_is_that_of_the_energy_and_the_lost(tmp_path):
    path = tmp_path / "smoke.h5"
    assert pipeline("run", ROOT / "configs/smoke.toml", "-o", path, "--set", "steps=40").returncode == DONE
    run = load(path)
    found = studies.drift(run)
    energy = run.physics.energy
    assert found.energy_last_relative == pytest.approx(energy.iloc[-1] / energy.iloc[0] - 1)
    assert found.energy_rise < 1e-3 and found.escaped == 0 and found.seconds == pytest.approx(39 / 60)
    assert 0 <= found.quaternion_drift < 1e-2
    assert found.steps == run.physics.integrator_steps.sum()


def test_the_program_prints_what_applies(result):
    run = analysis("study", result)
    assert run.returncode == DONE, run.stderr
    for word in ("orders", "RungeKutta3", "drop, by stiffness", "1e+12"):
        assert word in run.stdout
    assert "recommended" not in run.stdout  # no other factor tells the scenes' stiffness
    assert analysis("study", __file__).returncode == FILE


def test_what_is_printed_recommends_as_the_report_does(config, tmp_path):
    """Cases against a plate are none of stability, and a study of nothing but one case is not printed as nothing."""
    more = tmp_path / "more.toml"
    more.write_text(config.read_text() + '''
[[sweep]]
name = "losses"
problem = "drop"
integrator = ["ExplicitEuler", "RungeKutta3"]
dissipation = [0, 0.1]
duration = 1.5

[[sweep]]
problem = "thin_plate"
integrator = ["RungeKutta3"]
stiffness = [1e8, 1e12]
greatest_step = [1e-2, 1e-3]
''')
    assert pipeline("run", more, "-o", tmp_path / "more.h5").returncode == DONE
    table = study_tables.recommendation(load(tmp_path / "more.h5"))
    best = table.integrator[table.recommended].to_list()
    printed = analysis("study", tmp_path / "more.h5").stdout
    _, _, near = printed.partition("near 1e+08 Pa\n")
    assert len(best) == 1 and [line.split()[0] for line in near.splitlines() if line.endswith("True")] == best
    assert "thin_plate" not in printed and "28 cases of 4 integrators: 2" in printed
    assert pipeline("run", config, "-o", tmp_path / "one.h5", "--set", "every=100").returncode == DONE
    assert analysis("study", tmp_path / "one.h5").stdout == "1 cases of 1 integrators: 1 finished\n"


def test_small_numbers_of_a_drift_are_printed_and_not_rounded_to_nothing(tmp_path):
    path = tmp_path / "smoke.h5"
    assert pipeline("run", ROOT / "configs/smoke.toml", "-o", path, "--set", "steps=20").returncode == DONE
    with edited(path) as file:
        file["physics"].attrs["quaternion_drift"] = 1.25e-13
        file["physics"].attrs["status"] = "failed at step 17: more than 100000 steps in one sample at t = 0.3 s"
    lines = dict(line.split(maxsplit=1) for line in analysis("study", path).stdout.splitlines())
    assert lines["quaternion_drift"] == "1.25e-13" and lines["status"].endswith("at t = 0.3 s")


# ---- what the configurations of scenes rest on


@pytest.mark.parametrize("name", ["padani", "kostka"])
def test_the_integrator_of_padani_and_kostka_is_sound_at_their_material(tmp_path, name):
    physics = tomllib.loads((ROOT / "configs" / f"{name}.toml").read_text())["physics"]
    dissipation = physics.get("dissipation", 0.1)
    config = tmp_path / "x.toml"
    config.write_text('study = "integration"\n' + "".join(
        f'[[sweep]]\nproblem = "{problem}"\nintegrator = ["{physics["integrator"]}"]\naccuracy = '
        f'{physics["accuracy"]}\n'
        f'stiffness = {physics["stiffness"]}\ndissipation = [0, {dissipation}]\n' for problem in ("drop", "stack")
    ))  # fmt: skip
    assert pipeline("run", config, "-o", tmp_path / "x.h5").returncode == DONE
    table = load(tmp_path / "x.h5").study
    assert len(table) == 4 and table.finished.all()
    assert table.energy_error.abs().max() <= studies.SOUND
