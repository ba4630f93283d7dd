"""`pipeline work`: many fill one run, in any order and whatever becomes of them, with the digests of a run alone."""

import json
import os
import random
import resource
import shutil
import signal
import subprocess
import time

import h5py
import pytest
from program import DONE, FAILED, FILE, INPUT, INTERRUPTED, PIPELINE, ROOT, digest, pipeline, start, wait_for

from analysis.figures.drawing import steps_of
from analysis.load import load
from analysis.report import report
from analysis.tables import pareto

SMOKE = str(ROOT / "configs" / "smoke.toml")
LONG = ["--set", "steps=300", "--set", "timing.repeats=150"]  # six chunks of truth and of answers
CHUNKS = 6
LEASE = 1.0  # s, short enough to wait for


def worker(part, *more, lease=LEASE, **how):
    return start("work", part, "--json", "--lease", lease, *more, **how)


def ended(process, code=DONE):
    """What a worker says that it did."""
    out, error = process.communicate(timeout=120)
    assert process.returncode == code, error
    return json.loads(out) if code == DONE else error.strip().splitlines()[-1]


def stop(process):
    """Until it stands still: the signal is sent, not taken, when its call is back."""
    process.send_signal(signal.SIGSTOP)
    os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)


def chunks(part, stage):
    return sorted(path.name for path in part.glob(f"{stage}-*") if path.suffix != ".claim")


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The digest of a run that nobody helps."""
    path = tmp_path_factory.mktemp("alone") / "x.h5"
    assert pipeline("run", SMOKE, "-o", path, *LONG).returncode == DONE
    return digest(path)


@pytest.fixture(scope="module")
def moved(tmp_path_factory):
    """A FILE.part with its motion alone."""
    path = tmp_path_factory.mktemp("moved") / "x.h5"
    run = pipeline("run", SMOKE, "-o", path, *LONG, "--motion-only")
    assert run.returncode == DONE, run.stderr
    assert not path.exists() and "300 of 300 steps" in run.stdout
    return path.with_name("x.h5.part")


@pytest.fixture
def part(moved, tmp_path):
    return shutil.copytree(moved, tmp_path / "x.h5.part")


def assembled(part, *more):
    """Finishes the run; its digest."""
    path = part.with_suffix("")
    run = pipeline("run", SMOKE, "-o", path, *LONG, *more)
    assert run.returncode == DONE, run.stderr
    assert not part.exists()
    assert [entry.name for entry in part.parent.iterdir()] == [path.name]
    return digest(path)


def made_only(part, *wanted, **how):
    """Has a worker make these chunks of answers alone: whoever makes the others is somewhere else."""
    names = [f"answers-{first:07}" for first in wanted]
    claims = [part / f"answers-{first:07}.claim" for first in range(0, 300, 50) if first not in wanted]
    for claim in claims:
        claim.write_text(json.dumps({"host": "elsewhere", "lease_s": 3600}))
    more = how.pop("more", [])
    one = worker(part, *more, **how)
    wait_for(lambda: all((part / name).exists() for name in names))
    one.send_signal(signal.SIGTERM)
    one.communicate()
    for claim in claims:
        claim.unlink()


# ---- The same as alone


@pytest.mark.parametrize("count", [1, 2, 3])
def test_workers_make_what_one_run_makes(part, alone, count):
    said = [ended(one) for one in [worker(part) for _ in range(count)]]
    for kind in ("truth_chunks", "answer_chunks"):
        assert sum(one[kind] for one in said) == CHUNKS, said  # each once
    assert len(chunks(part, "answers")) == CHUNKS
    assert not list(part.glob("*.claim")) and not list(part.glob(".*"))
    shown = json.loads(pipeline("show", part, "--json").stdout)
    assert shown["truth_steps"] == shown["answered_steps"] == 300 and shown["held"] == []
    assert assembled(part) == alone


def test_a_run_and_workers_share_the_chunks(tmp_path, alone):
    """Workers may come while the motion is made: they wait for it."""
    path, part = tmp_path / "x.h5", tmp_path / "x.h5.part"
    run = start("run", SMOKE, "-o", path, *LONG)
    wait_for(lambda: (part / "configuration-0000000").exists())
    helpers = [worker(part), worker(part)]
    _, error = run.communicate(timeout=120)
    assert run.returncode == DONE, error
    for one in helpers:
        ended(one)
    assert digest(path) == alone and [entry.name for entry in tmp_path.iterdir()] == ["x.h5"]


def test_workers_killed_at_random_cost_their_chunk_only(part, alone):
    seed = random.randrange(2**32)
    print("seed", seed)
    moments, kept = random.Random(seed), set()
    for _ in range(4):
        pair = [worker(part), worker(part)]
        time.sleep(moments.uniform(0.05, 0.8))
        for one in pair:
            one.kill()
        for one in pair:
            one.communicate()
        now = {path.name for path in part.iterdir() if path.suffix != ".claim" and not path.name.startswith(".")}
        assert kept <= now, "nothing finished is lost"
        kept = now
    if moments.random() < 0.5:
        ended(worker(part))
    assert assembled(part) == alone


def test_the_run_killed_beside_its_workers_is_resumed(tmp_path, alone):
    path, part = tmp_path / "x.h5", tmp_path / "x.h5.part"
    run = start("run", SMOKE, "-o", path, *LONG)
    wait_for(lambda: len(chunks(part, "motion")) == CHUNKS)
    helper = worker(part)
    wait_for(lambda: chunks(part, "truth"))
    run.kill()
    run.communicate()
    if not path.exists():
        ended(helper)
        assert assembled(part) == alone


def test_a_worker_stopped_beyond_its_lease_loses_its_chunk_and_nothing_else(part, alone):
    stopped = worker(part)
    wait_for(lambda: list(part.glob("*.claim")))
    stop(stopped)
    claims = {path.name for path in part.glob("*.claim")}
    try:
        other = ended(worker(part))  # waits for the lease, then takes over
    finally:
        stopped.send_signal(signal.SIGCONT)
    late = ended(stopped)
    if claims:  # it was stopped within a chunk
        assert other["truth_chunks"] + late["truth_chunks"] >= CHUNKS
    assert assembled(part) == alone


def test_a_worker_stopped_while_the_run_ends_without_it(part, alone):
    stopped = worker(part)
    wait_for(lambda: chunks(part, "answers") and list(part.glob("*.claim")))
    stop(stopped)
    try:
        path = part.with_suffix("")
        run = pipeline("run", SMOKE, "-o", path, *LONG)
        assert run.returncode == DONE and digest(path) == alone
    finally:
        stopped.send_signal(signal.SIGCONT)
    said = ended(stopped)
    assert said["assembled"]
    assert [entry.name for entry in part.parent.iterdir()] == [path.name]


def test_a_worker_is_interrupted_and_gives_its_chunk_back(part, alone):
    one = worker(part, lease=3600)
    wait_for(lambda: list(part.glob("*.claim")))
    one.send_signal(signal.SIGTERM)
    assert "interrupted" in ended(one, INTERRUPTED)
    assert not list(part.glob("*.claim"))
    assert assembled(part) == alone


SCENES = {
    "playground": ["hriste.toml", "--set", "steps=120"],
    "replay": ["replay_example.toml"],
    "contained": ["smoke.toml", "--set", "steps=120", "--set", "truth.containment=record", "--set", "truth.gap=true"],
    "noise": ["smoke.toml", "--set", "steps=120", "--set", "timing.noise=true", "--set", "timing.pin=0"],
}


@pytest.mark.parametrize("name", SCENES)
def test_every_kind_of_scene_can_be_shared(tmp_path, name):
    config, *sets = SCENES[name]
    config = ROOT / "configs" / config
    run = pipeline("run", config, "-o", tmp_path / "alone.h5", *sets)
    assert run.returncode in (DONE, FAILED), run.stderr  # a promise may be broken in what is left of a scene
    made = pipeline("run", config, "-o", tmp_path / "x.h5", *sets, "--motion-only")
    assert made.returncode == DONE, made.stderr
    said = ended(worker(tmp_path / "x.h5.part"))
    assert said["answer_chunks"] > 0
    again = pipeline("run", config, "-o", tmp_path / "x.h5", *sets)
    assert again.returncode == run.returncode
    assert digest(tmp_path / "x.h5") == digest(tmp_path / "alone.h5")


def test_cases_of_extremes_can_be_shared(tmp_path):
    config = ROOT / "tests" / "baselines" / "extremes.toml"
    assert pipeline("run", config, "-o", tmp_path / "alone.h5").returncode in (DONE, FAILED)
    assert pipeline("run", config, "-o", tmp_path / "x.h5", "--motion-only").returncode == DONE
    said = [ended(one) for one in (worker(tmp_path / "x.h5.part"), worker(tmp_path / "x.h5.part"))]
    assert sum(one["answer_chunks"] for one in said) > 1
    assert pipeline("run", config, "-o", tmp_path / "x.h5").returncode in (DONE, FAILED)
    assert digest(tmp_path / "x.h5") == digest(tmp_path / "alone.h5")


# An integration that fails is data: workers know its rest as the run does.
def test_a_motion_that_failed_is_shared_too(tmp_path):
    sets = ["--set", "steps=300", "--set", "physics.step_budget=2"]
    run = pipeline("run", SMOKE, "-o", tmp_path / "alone.h5", *sets)
    assert run.returncode == FAILED and "failed at step" in run.stderr
    assert pipeline("run", SMOKE, "-o", tmp_path / "x.h5", *sets, "--motion-only").returncode == DONE
    assert ended(worker(tmp_path / "x.h5.part"))["answer_chunks"] == CHUNKS
    assert pipeline("run", SMOKE, "-o", tmp_path / "x.h5", *sets).returncode == FAILED
    assert digest(tmp_path / "x.h5") == digest(tmp_path / "alone.h5")


# ---- What is wrong is said


def refused(part, code, *more, **how):
    run = pipeline("work", part, *more, **how)
    assert run.returncode == code, (run.stdout, run.stderr)
    return run.stderr.strip().splitlines()[-1]


def test_a_part_of_something_else_is_told(part, tmp_path):
    before = sorted(path.name for path in part.iterdir())
    assert "another configuration" in refused(part, FILE, "--config", SMOKE)  # without its --set
    assert pipeline("work", part, "--set", "steps=300").returncode == 2  # of which configuration?
    other = tmp_path / "other"
    shutil.copy(PIPELINE, other)
    with open(other, "ab") as file:
        file.write(b"\0")  # another build
    run = subprocess.run([other, "work", part], capture_output=True, text=True)
    assert run.returncode == FILE and "another build" in run.stderr
    (tmp_path / "empty.part").mkdir()
    assert "no readable manifest" in refused(tmp_path / "empty.part", FILE)
    assert "cannot be opened" in refused(tmp_path / "none.h5.part", FILE)
    assert sorted(path.name for path in part.iterdir()) == before
    study = tmp_path / "study.h5.part"
    run = start("run", ROOT / "configs" / "stiffness.toml", "-o", tmp_path / "study.h5")
    wait_for(lambda: (study / "manifest.json").exists())
    run.kill()
    run.communicate()
    assert "no chunks to share" in refused(study, FILE)


def test_a_motion_that_nobody_makes_is_told_and_one_that_is_made_is_waited_for(tmp_path, alone):
    path, part = tmp_path / "x.h5", tmp_path / "x.h5.part"
    run = start("run", SMOKE, "-o", path, *LONG)
    wait_for(lambda: chunks(part, "motion"))
    run.kill()
    run.communicate()
    if len(chunks(part, "motion")) < CHUNKS:
        assert "no run is making it" in refused(part, FILE)
        assert chunks(part, "truth"), "what can be done is done"
    run = start("run", SMOKE, "-o", path, *LONG, "--motion-only")
    ended(worker(part))
    assert run.wait(60) == DONE
    assert len(chunks(part, "answers")) == CHUNKS and assembled(part) == alone


def test_a_finished_run_needs_nobody(part, alone):
    ended(worker(part))
    assert ended(worker(part)) == {"file": str(part), "truth_chunks": 0, "answer_chunks": 0, "assembled": False}
    assert assembled(part) == alone
    assert ended(worker(part))["assembled"]


def test_a_part_that_vanishes_is_told(part):
    one = worker(part)
    wait_for(lambda: list(part.glob("*.claim")))
    stop(one)
    os.rename(part, part.with_name("elsewhere"))
    shutil.rmtree(part.with_name("elsewhere"))
    one.send_signal(signal.SIGCONT)
    assert "is gone, and there is no" in ended(one, FILE)


def test_a_run_begun_anew_in_its_place_is_told(part):
    one = worker(part)
    wait_for(lambda: list(part.glob("*.claim")))
    stop(one)
    run = pipeline("run", SMOKE, "-o", part.with_suffix(""), "--set", "steps=299", "--motion-only", "--force")
    assert run.returncode == DONE, run.stderr
    one.send_signal(signal.SIGCONT)
    assert "another run's by now" in ended(one, FILE)
    assert pipeline("run", SMOKE, "-o", part.with_suffix(""), "--set", "steps=299").returncode == DONE


def test_a_full_disk_of_one_worker_costs_its_chunk_only(part, alone):
    """A limit on the size of files stands for it: the same errors come from the same calls."""
    # A claim fits, a chunk does not.
    small = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1200, 1200))  # noqa: E731
    error = ended(worker(part, preexec_fn=small), FILE)
    assert "cannot be written" in error and "-00000" in error
    assert not list(part.glob("*.claim")) and not list(part.glob(".*"))
    ended(worker(part))
    assert assembled(part) == alone


def test_a_damaged_chunk_is_made_again(part, alone):
    ended(worker(part))
    for name in ("truth-0000100", "answers-0000050"):
        with open(part / name, "r+b") as file:
            file.seek(40)
            file.write(b"!!!!")
    said = ended(worker(part))
    assert (said["truth_chunks"], said["answer_chunks"]) == (1, 1)
    assert assembled(part) == alone


def test_more_than_the_motion_is_not_made_of_a_study(tmp_path):
    run = pipeline("run", ROOT / "configs" / "stiffness.toml", "-o", tmp_path / "x.h5", "--motion-only")
    assert run.returncode == INPUT and "has no motion" in run.stderr
    assert list(tmp_path.iterdir()) == []


# ---- Methods of others

WRONG = ROOT / "tests" / "support" / "wrong_program.py"
OTHERS = """steps = 120
[scene]
kind = "replay"
poses = "poses.csv"
[[scene.body]]
name = "a"
shape = "box"
size = [1, 1, 1]
[[scene.body]]
name = "wall"
shape = "box"
size = [1, 2, 3]
fixed = true
position = [0, 0, 0]
[timing]
repeats = 1
[[algorithm]]
name = "exact"
[[algorithm]]
name = "program"
command = ["/usr/bin/python3", "{program}"]
label = "mine"
{more}
"""


def others(folder, program, more=""):
    rows = ["step,body,px,py,pz,qw,qx,qy,qz"] + [f"{s},a,{(s % 30) / 10},0,0,1,0,0,0" for s in range(120)]
    (folder / "poses.csv").write_text("\n".join(rows) + "\n")
    config = folder / "others.toml"
    config.write_text(OTHERS.format(program=program, more=more))
    return config


PROGRAM = """import sys
sys.path.insert(0, {adapters!r})
import collision_program


def answer(step):
    if {fails} and 60 <= step.number < 100:
        raise ValueError("no such luck")
    at = step.positions
    return [(a, b) for a, b in step.pairs() if abs(at[a][0] - at[b][0]) < 1]


collision_program.serve(lambda hello: answer, name="spans", version="1")
"""


def program(folder, fails=False):
    path = folder / "mine.py"
    path.write_text(PROGRAM.format(adapters=str(ROOT / "algorithms" / "program"), fails=fails))
    return path


def test_no_part_starts_a_program_by_itself(tmp_path):
    """As `detect` of a file: a folder that somebody shares starts nothing; its configuration, given by hand, does."""
    config = others(tmp_path, program(tmp_path))
    run = pipeline("run", config, "-o", tmp_path / "alone.h5")
    assert run.returncode == DONE, run.stderr
    assert pipeline("run", config, "-o", tmp_path / "x.h5", "--motion-only").returncode == DONE
    part = tmp_path / "x.h5.part"
    said = refused(part, INPUT)
    assert "'mine'" in said and "--config" in said
    assert not chunks(part, "truth")
    pair = [worker(part, "--config", config), worker(part, "--config", config)]
    assert sum(ended(one)["answer_chunks"] for one in pair) == 3
    assert pipeline("run", config, "-o", tmp_path / "x.h5").returncode == DONE
    assert digest(tmp_path / "x.h5") == digest(tmp_path / "alone.h5")
    assert load(tmp_path / "x.h5").meta["answers"]["mine"]["steps_done"] == 120


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_a_method_that_fails_has_failed_in_every_order(tmp_path, order):
    """Once it has failed it answers nothing more. A worker that does not know it yet asks it again: in vain."""
    config = others(tmp_path, program(tmp_path, fails=True))
    run = pipeline("run", config, "-o", tmp_path / "alone.h5")
    assert run.returncode == FAILED and "failed after 60 of 120 steps" in run.stderr
    assert pipeline("run", config, "-o", tmp_path / "x.h5", "--motion-only").returncode == DONE
    part = tmp_path / "x.h5.part"
    for chunk in order:
        made_only(part, 50 * chunk, more=["--config", config])
    run = pipeline("run", config, "-o", tmp_path / "x.h5")
    assert run.returncode == FAILED and "failed after 60 of 120 steps" in run.stderr
    assert digest(tmp_path / "x.h5") == digest(tmp_path / "alone.h5")


# ---- Times of several machines

SHIM = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static const char* led(const char* path) {
  const char* mine = getenv("CPUINFO");
  return mine && strcmp(path, "/proc/cpuinfo") == 0 ? mine : path;
}
FILE* fopen(const char* path, const char* mode) {
  return ((FILE * (*)(const char*, const char*)) dlsym(RTLD_NEXT, "fopen"))(led(path), mode);
}
FILE* fopen64(const char* path, const char* mode) {
  return ((FILE * (*)(const char*, const char*)) dlsym(RTLD_NEXT, "fopen64"))(led(path), mode);
}
int gethostname(char* name, size_t size) {
  strncpy(name, getenv("HOST"), size);
  return 0;
}
"""


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    """machine(host, processor): the environment in which a program takes this machine for that one."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if not compiler:
        pytest.skip("no C compiler: a machine cannot be made to look like another")
    folder = tmp_path_factory.mktemp("machines")
    (folder / "shim.c").write_text(SHIM)
    subprocess.run([compiler, "-shared", "-fPIC", "-o", folder / "shim.so", folder / "shim.c", "-ldl"], check=True)

    def of(host, processor):
        info = folder / f"{host}.txt"
        info.write_text(f"processor\t: 0\nmodel name\t: {processor}\n")
        return os.environ | {"LD_PRELOAD": str(folder / "shim.so"), "HOST": host, "CPUINFO": str(info)}

    return of


@pytest.fixture(scope="module")
def unlike(moved, machine, tmp_path_factory, alone):
    """A run whose chunks two unlike machines made."""
    part = shutil.copytree(moved, tmp_path_factory.mktemp("unlike") / "x.h5.part")
    made_only(part, 0, 50, env=machine("n1", "Slow 1000"))
    ended(worker(part, env=machine("n2", "Quick 9000")))
    assert assembled(part) == alone, "who made it is no part of the digest"
    return part.with_suffix("")


def test_every_chunk_has_its_host_and_processor(unlike):
    with h5py.File(unlike) as file:
        group = file["machines"]
        names = list(group["host"].asstr())
        assert set(zip(names, group["processor"].asstr())) == {("n1", "Slow 1000"), ("n2", "Quick 9000")}
        assert list(group["chunk"]) == [0, 50, 100, 150, 200, 250]
        by = [[names[machine] for machine in row] for row in group["answers"]]
        assert group["answers"].shape == (CHUNKS, len(file["algorithm"]))
        assert by[0][0] == "n1" and by[-1][0] == "n2" and all(len(set(row)) == 1 for row in by)
        assert names[group["truth"][0]] == "n1"


def test_times_of_unlike_processors_are_said_and_are_no_time_of_the_run(unlike, tmp_path):
    shown = pipeline("show", unlike).stdout
    assert "2 machines worked on it: n1 (Slow 1000); n2 (Quick 9000)" in shown
    assert "aabb was TIMED ON UNLIKE PROCESSORS" in shown or "bounding_sphere was TIMED ON UNLIKE" in shown
    assert "Slow 1000 (n1)" in shown
    told = json.loads(pipeline("show", unlike, "--json").stdout)
    run = load(unlike)
    for row in told["algorithms"]:
        groups = {one["processor"]: one for one in row["unlike_processors"]}
        assert sum(one["steps"] for one in groups.values()) == 300
        times = run.step_times[row["label"]]
        slow = int(groups["Slow 1000"]["steps"])
        assert groups["Slow 1000"]["time_mean_ns"] == pytest.approx(times[:slow].mean())
        assert row["time_mean_ns"] is None
    assert run.summary.time_mean_ns.isna().all() and not run.summary.error.isna().any()
    for more in (["--write"], []):
        score = pipeline("score", unlike, "--against", tmp_path / "b.json", "--times", *more)
        assert score.returncode == DONE and "timed on unlike processors" in score.stdout, score.stderr


def test_the_report_says_so_and_draws_no_such_time(unlike):
    page = report.report([load(unlike)])
    assert "timed on unlike processors (Slow 1000; Quick 9000): all algorithms" in page
    points = pareto.scenes([load(unlike)])[0].points
    assert points.time_mean_ns.isna().all() and not any(len(times) for times in points.times)
    assert (steps_of(load(unlike)).time_ns == 0).all()


def test_like_processors_of_several_hosts_are_one(moved, machine, tmp_path):
    part = shutil.copytree(moved, tmp_path / "x.h5.part")
    made_only(part, 0, 150, env=machine("n1", "Same"))
    ended(worker(part, env=machine("n2", "Same")))
    assembled(part)
    shown = pipeline("show", part.with_suffix("")).stdout
    assert "2 machines worked on it: n1 (Same); n2 (Same)" in shown and "UNLIKE" not in shown
    assert load(part.with_suffix("")).summary.time_mean_ns.notna().all()


def test_what_is_added_later_has_the_time_of_its_own_machine(unlike, tmp_path):
    path = shutil.copy(unlike, tmp_path / "x.h5")
    run = pipeline("detect", path, "--algorithm", "aabb@again", "--quiet")
    assert run.returncode == DONE, run.stderr
    summary = load(path).summary.time_mean_ns
    assert summary["again"] > 0 and summary.drop("again").isna().all()
    with h5py.File(path) as file:
        assert len(file["machines/host"]) == 3 and len(set(file["machines/answers"][:, -1])) == 1


def test_a_lease_of_another_host_is_waited_for(part, machine, alone):
    """Of another host nothing is known but its lease."""
    one = worker(part, env=machine("n1", "Any"), lease=2)
    wait_for(lambda: list(part.glob("*.claim")))
    one.kill()
    one.communicate()
    left = list(part.glob("*.claim"))
    began = time.monotonic()
    other = worker(part, env=machine("n2", "Any"))
    ended(other)
    assert left and time.monotonic() - began > 0.5 and not any(claim.exists() for claim in left)
    assert assembled(part) == alone
