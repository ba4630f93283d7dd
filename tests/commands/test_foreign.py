"""Methods in programs of others: what they answer, what they cost, and every way in which they go wrong."""
import json
import os
import shutil
import signal
import struct
import subprocess
import time

import h5py
import numpy as np
import pytest
from program import DONE, FAILED, INPUT, INTERRUPTED, PIPELINE, ROOT, one_line, pipeline

from analysis.load import load

ADAPTERS = ROOT / "algorithms" / "program"
WRONG = ROOT / "tests" / "support" / "wrong_program.py"
PYTHON = "/usr/bin/python3"

# Four bodies: 0 and 1 move, 1 is born at step 6, 2 and 3 are fixed.
SCENE = """
title = "Others"
{top}
[scene]
kind = "replay"
poses = "poses.csv"
[[scene.body]]
name = "a"
shape = "box"
size = [1, 1, 1]
[[scene.body]]
name = "late"
shape = "sphere"
radius = 0.5
segments = 4
[[scene.body]]
name = "wall"
shape = "box"
size = [1, 2, 3]
fixed = true
position = [0, 0, 0]
[[scene.body]]
name = "ring"
shape = "torus"
diameter = 2
thickness = 0.4
segments = 4
fixed = true
position = [3, 0, 0]
orientation = [0.6, 0.8, 0, 0]
[timing]
repeats = 2
[[algorithm]]
name = "aabb"
"""
STEPS = 12


def algorithm(command, label, more=""):
    return f'[[algorithm]]\nname = "program"\ncommand = {json.dumps(command)}\nlabel = "{label}"\n{more}\n'


def wrong(how, more="step_budget = 20.0"):
    return algorithm([PYTHON, str(WRONG), how], how, more)


def scene(folder, algorithms="", top=""):
    rows = ["step,body,px,py,pz,qw,qx,qy,qz"]
    for step in range(STEPS):
        angle = 0.2 * step
        rows.append(f"{step},a,{1.9 - 0.25 * step},{0.1 * step},0.3,{np.cos(angle)},{np.sin(angle)},0,0")
        if step >= 6:
            rows.append(f"{step},late,{3 - 0.3 * step},0.2,0,1,0,0,0")
    (folder / "poses.csv").write_text("\n".join(rows) + "\n")
    config = folder / "others.toml"
    config.write_text(SCENE.format(top=top) + algorithms)
    return config


def attributes(path, label):
    with h5py.File(path) as file:
        return dict(file["answers"][label].attrs)


# ---- well


@pytest.fixture(scope="module")
def well(tmp_path_factory):
    """World boxes inside, in Python and in JavaScript."""
    folder = tmp_path_factory.mktemp("well")
    node = shutil.which("node")
    rows = algorithm([PYTHON, str(ADAPTERS / "world_boxes.py")], "python", "reach = 2.5\nname_of_it = \"x\"")
    if node:
        rows += algorithm([node, str(ADAPTERS / "world_boxes.mjs")], "node")
    path = folder / "well.h5"
    run = pipeline("run", scene(folder, rows), "-o", path)
    assert run.returncode == DONE, run.stderr
    return path


def assert_same_answers(path, label, other):
    with h5py.File(path) as file:
        one, two = file["answers"][label], file["answers"][other]
        assert len(two["pair"]) > 5, "something is to be found"
        for name in ("pair_offset", "pair"):
            assert np.array_equal(one[name][()], two[name][()])


def languages():
    return ["python", pytest.param("node", marks=pytest.mark.skipif(not shutil.which("node"), reason="no node here"))]


@pytest.mark.parametrize("label", languages())
def test_a_program_answers_as_the_same_method_inside(well, label):
    assert_same_answers(well, label, "aabb")
    summary = load(well).summary
    assert summary.error[label] == summary.error["aabb"]


@pytest.mark.parametrize("label", languages())
def test_what_a_program_says_stands_at_its_answers(well, label):
    about = attributes(well, label)
    assert about["name"] == "world_boxes" and about["version"] == "1"
    assert about["language"].startswith({"python": "Python 3", "node": "JavaScript, node "}[label])
    assert (about["transport"], about["status"], about["reason"]) == ("program", "complete", "")
    assert (about["steps_done"], about["threads"], about["precision"]) == (STEPS, 1, "double")
    assert (about["promise"], about["scope"], about["operations_unit"]) == ("none", "pair", "")
    file = ADAPTERS / {"python": "world_boxes.py", "node": "world_boxes.mjs"}[label]
    hashes = json.loads(about["files_sha256"])
    assert hashes[str(file)] == subprocess.run(["sha256sum", file], capture_output=True, text=True).stdout.split()[0]
    with h5py.File(well) as h5:
        assert json.loads(h5.attrs["inputs_sha256"])[str(file)] == hashes[str(file)]


def test_its_own_time_lies_within_the_exchange(well):
    with h5py.File(well) as file:
        labels = list(file["algorithm"].asstr()[()])
        exchange, own, prepare = (file["results"][name][()] for name in ("exchange_ns", "time_ns", "prepare_ns"))
    for label in set(labels) & {"python", "node"}:
        a = labels.index(label)
        assert (own[:, a] > 0).all() and (own[:, a] <= exchange[:, a]).all()
        assert (prepare[:, a] > 0).all() and (prepare[:, a] <= own[:, a]).all()
    assert (exchange[:, labels.index("aabb")] == 0).all()


def test_knobs_are_handed_on_and_kept(well, tmp_path):
    assert json.loads(attributes(well, "python")["knobs"]) == {"reach": 2.5, "name_of_it": "x"}
    program = tmp_path / "knobs.py"
    program.write_text(
        f"import sys; sys.path.insert(0, {str(ADAPTERS)!r})\n"
        "from collision_program import serve\n"
        "def setup(run):\n"
        "    raise ValueError(f\"{run['label']} {run['knobs']} {[b['fixed'] for b in run['bodies']]}\")\n"
        "serve(setup, name='knobs')\n")
    config = scene(tmp_path, algorithm([PYTHON, "knobs.py"], "told", "reach = 2.0\ncount = 3\nfast = true\nkind = 'x'"))
    said = one_line(pipeline("check", config))
    assert "told {'count': 3, 'fast': True, 'kind': 'x', 'reach': 2.0} [False, False, True, True]" in said


def test_files_without_programs_have_no_exchange(tmp_path):
    path = tmp_path / "none.h5"
    assert pipeline("run", scene(tmp_path), "-o", path).returncode == DONE
    with h5py.File(path) as file:
        assert "exchange_ns" not in file["results"]
        assert "transport" not in file["answers/aabb"].attrs


def test_it_counts_remembers_and_forgets(tmp_path):
    """A method that says when it was told to remember and forget, by what it counts."""
    program = tmp_path / "memory.py"
    program.write_text(
        f"import sys; sys.path.insert(0, {str(ADAPTERS)!r})\n"
        "from collision_program import serve\n"
        "def setup(run):\n"
        "    state = {'kept': 0, 'wiped': 0}\n"
        "    def add(key): state[key] += 1\n"
        "    return {'answer': lambda step: [], 'count': lambda step: (100 * state['wiped'] + state['kept'], []),\n"
        "            'remember': lambda: add('kept'), 'forget': lambda: add('wiped')}\n"
        "serve(setup, name='memory', operations_unit='calls', promise='none', scope='scene', precision='single')\n")
    path = tmp_path / "memory.h5"
    run = pipeline("run", scene(tmp_path, algorithm([PYTHON, "memory.py"], "memory")), "-o", path)
    assert run.returncode == DONE, run.stderr
    with h5py.File(path) as file:
        counted = file["results/operations"][:, 1]
    # Wiped after the warm-up and at the start of the chunk; what a step teaches is kept after it.
    assert list(counted) == [200 + step for step in range(STEPS)]
    about = attributes(path, "memory")
    assert (about["scope"], about["precision"], about["operations_unit"]) == ("scene", "single", "calls")


def test_detect_adds_a_program_from_the_current_folder(well, tmp_path):
    path = tmp_path / "copy.h5"
    shutil.copy(well, path)
    shutil.copytree(ADAPTERS, tmp_path / "mine")
    command = "program:command=/usr/bin/python3 mine/world_boxes.py,reach=3@added"
    run = pipeline("detect", path, "--algorithm", command, cwd=tmp_path)
    assert run.returncode == DONE, run.stderr
    about = attributes(path, "added")
    assert json.loads(about["knobs"]) == {"reach": 3}
    assert about["command"] == "/usr/bin/python3 mine/world_boxes.py"
    assert_same_answers(path, "added", "aabb")


def test_check_says_what_it_is(tmp_path):
    config = scene(tmp_path, algorithm([PYTHON, str(ADAPTERS / "world_boxes.py")], "boxes", "time_budget = 100.0"))
    run = pipeline("check", config)
    assert run.returncode == DONE, run.stderr
    assert f"a program: {PYTHON} {ADAPTERS}/world_boxes.py; world_boxes 1, Python 3" in run.stdout
    assert "at most 60 s a step, 100 s in all" in run.stdout
    json_run = json.loads(pipeline("check", config, "--json").stdout)
    assert json_run["foreign"]["boxes"]["says"]["name"] == "world_boxes"


# ---- wrong

FAULTS = {
    "throw": "it gives up: ValueError: no such luck (",
    "abort": "it aborted; it said: about to abort",
    "crash": "it crashed by signal 11",
    "killed": "it was killed by signal 9",
    "end": "it ended with code 0",
    "leak": "it gives up: MemoryError",
    "hang": "no answer within 0.5 s",
    "slow": "more than 1.5 s in all",
    "unsure": "it answers otherwise when it is asked again",
    "unknown": "it reports the pair 0, 99: there is no body 99, only 0 to 3",
    "order": "it reports the pair 2, 0: the smaller number must come first",
    "self": "it reports the pair 2, 2: a body with itself",
    "unborn": "it reports the pair 0, 1: body 1 is not there yet",
    "unasked": "it reports the pair 2, 3, which was not asked about",
    "twice": "it reports the pair 0, 2 twice",
    "many": "its frame HITS says that it has 8024 bytes; at most 40 are possible here",
    "nan": "its time is nan ns",
    "negative": "its time is -1.0 ns",
    "long": "its time is 1e18 ns, longer than the exchange",
    "noise": 'its stdout holds "Babylon.js v6.49.0 - WebGL2" where a frame HITS must begin; only frames belong there',
    "half": "it ended with code 0 after ",
    "half_hang": "no answer within 0.5 s, only ",
    "huge": "its frame HITS says that it has 4294967295 bytes; at most 40 are possible here",
    "close": "it closed its stdout",
    "garbage": "where a frame HITS must begin",
    "again": "it sent more than it was asked for",
}
BUDGETS = {
    "hang": "step_budget = 0.5",
    "half_hang": "step_budget = 0.5",
    "slow": "time_budget = 1.5",
    "leak": "memory_budget = 100",
}


@pytest.fixture(scope="module")
def faults(tmp_path_factory):
    """One run with everything that goes wrong, and one that is well in its midst."""
    folder = tmp_path_factory.mktemp("faults")
    rows = [wrong(how, BUDGETS.get(how, "step_budget = 20.0")) for how in FAULTS]
    rows.insert(len(rows) // 2, wrong("print"))
    path = folder / "faults.h5"
    run = pipeline("run", scene(folder, "".join(rows)), "-o", path)
    return path, run


@pytest.mark.parametrize("how", FAULTS)
def test_what_goes_wrong_is_data(faults, how):
    path, run = faults
    about = attributes(path, how)
    assert about["status"] == "failed"
    assert about["reason"].startswith(FAULTS[how]) or FAULTS[how] in about["reason"], about["reason"]
    done = about["steps_done"]
    assert done == 4 or (how in ("slow", "again") and 3 <= done <= 8)
    assert f"{how} failed after {done} of {STEPS} steps: " in run.stderr
    with h5py.File(path) as file:
        a = list(file["algorithm"].asstr()[()]).index(how)
        offset = file["answers"][how]["pair_offset"][()]
        assert (offset[done:] == offset[done]).all(), "no answers after it"
        assert (file["results/time_ns"][:done, a] > 0).all() and (file["results/time_ns"][done:, a] == 0).all()
        for name in ("error", "precision", "recall", "matthews", "time_mean_ns", "time_median_ns", "time_p95_ns"):
            assert np.isnan(file["summary"][name][a]), name
        right = file["results/true_positive"][:done, a].sum()
        assert file["summary/true_positive"][a] == right


def test_it_ends_with_code_1_and_everything_else_is_intact(faults, tmp_path):
    path, run = faults
    assert run.returncode == FAILED
    assert attributes(path, "print")["status"] == "complete"
    alone = tmp_path / "alone.h5"
    assert pipeline("run", scene(tmp_path, wrong("print")), "-o", alone).returncode == DONE
    with h5py.File(path) as with_them, h5py.File(alone) as without:
        for group in ("motion", "truth", "answers/aabb", "answers/print"):
            assert with_them[group].attrs["digest"] == without[group].attrs["digest"]


def test_show_score_and_load_say_so(faults, tmp_path):
    path, _ = faults
    shown = pipeline("show", path)
    assert shown.returncode == DONE
    assert "    failed after 4 of 12 steps, whose sums these are: it gives up: ValueError: no such luck" in shown.stdout
    rows = {row["label"]: row for row in json.loads(pipeline("show", path, "--json").stdout)["algorithms"]}
    row = rows["throw"]
    assert row["foreign"]["status"] == "failed" and row["foreign"]["steps_done"] == 4
    assert row["error"] is None
    baseline = tmp_path / "baseline.json"
    assert pipeline("score", path, "--against", baseline, "--write", "--times").returncode == DONE
    assert json.loads(baseline.read_text())["algorithms"]["throw"]["status"] == "failed"
    assert pipeline("score", path, "--against", baseline, "--times").returncode == DONE
    text = baseline.read_text().replace('"failed"', '"complete"', 1)
    baseline.write_text(text)
    assert "status complete -> failed" in pipeline("score", path, "--against", baseline).stdout
    run = load(path)
    assert np.isnan(run.summary.error["throw"]) and run.failed["throw"][1] == 4
    whole = run.completed()
    assert list(whole.summary.index) == ["aabb", "print"] and list(whole.meta["answers"]) == ["aabb", "print"]
    assert whole.per_step.algorithm.cat.categories.tolist() == ["aabb", "print"]
    assert (whole.per_step.time_ns > 0).all()
    assert whole.summary.equals(run.summary.loc[["aabb", "print"]])


def test_verify_and_export_take_such_a_file(faults, tmp_path):
    assert pipeline("verify", faults[0]).returncode == DONE
    assert pipeline("export", faults[0], "--vtk", tmp_path / "vtk").returncode == DONE


@pytest.mark.parametrize("how, said", [
    ("at_once", "does not say hello: it ended with code 7; it said: cannot find the engine"),
    ("banner", 'its stdout holds "Welcome to the engine" where a frame HELO must begin'),
    ("promise", "its hello: 'promise' must be \"none\", \"conservative\" or \"exact\""),
    ("deaf", "does not say hello: more than 0.5 s in all"),
])
def test_one_that_does_not_say_hello_is_refused_before_the_run(how, said, tmp_path):
    config = scene(tmp_path, wrong(how, "time_budget = 0.5" if how == "deaf" else ""))
    run = pipeline("run", config, "-o", tmp_path / "no.h5")
    assert run.returncode == INPUT
    line = one_line(run)
    assert line.startswith(f"algorithm '{how}': program \"{PYTHON} {WRONG} {how}\"") and said in line
    assert sorted(p.name for p in tmp_path.iterdir()) == ["others.toml", "poses.csv"], "nothing half written"


@pytest.mark.parametrize("command, said", [
    (["no_such_program_here"], "there is no program 'no_such_program_here' along PATH; give its path"),
    (["./no_such"], "there is no program './no_such' that can be executed"),
    (["./poses.csv"], "there is no program './poses.csv' that can be executed"),
    ([], "must be a program and its words"),
    ([""], "must be a program and its words"),
])
def test_a_command_that_does_not_exist_is_one_line(command, said, tmp_path):
    run = pipeline("run", scene(tmp_path, algorithm(command, "none")), "-o", tmp_path / "no.h5")
    assert run.returncode == INPUT
    assert said in one_line(run)
    assert not (tmp_path / "no.h5").exists()


@pytest.mark.parametrize("more, said", [
    ("step_budget = 0", "'algorithm.1.step_budget' must be a finite number above 0, not 0"),
    ("memory_budget = 1", "'algorithm.1.memory_budget' must be"),
    ("reach = [1, 2]", "'algorithm.1.reach' must be handed on to a program as a number, a text or a flag"),
    ("reach = inf", "'algorithm.1.reach' must be finite"),
    ("label = \"a b\"", "'algorithm.1.label' must be 1 to 64 characters"),
])
def test_keys_have_their_rules(more, said, tmp_path):
    text = algorithm([PYTHON, "x.py"], "x", more)
    if "label" in more:
        text = text.replace('label = "x"\n', "")
    run = pipeline("check", scene(tmp_path, text))
    assert run.returncode == INPUT and said in one_line(run), run.stderr


def test_text_files_that_are_no_programs_are_refused(tmp_path):
    file = tmp_path / "text"
    file.write_text("no program\n")
    file.chmod(0o755)
    run = pipeline("run", scene(tmp_path, algorithm(["./text"], "text")), "-o", tmp_path / "no.h5")
    assert run.returncode == INPUT
    assert "cannot be started (Exec format error)" in one_line(run)


# ---- other scenes


PLAYGROUND = """
[scene]
kind = "playground"
hero = {shape = "box", size = [1, 1, 1]}
[[scene.obstacle]]
name = "a"
shape = "box"
size = [2, 1, 1]
[[scene.obstacle]]
name = "b"
shape = "sphere"
radius = 1
segments = 6
[[scene.path]]
axis = "x"
[timing]
repeats = 1
[[algorithm]]
name = "aabb"
"""
EXTREMES = """
[scene]
kind = "extremes"
pairs = ["box-box"]
scales = [1.0]
offsets = [0.0]
[timing]
repeats = 1
[[algorithm]]
name = "aabb"
"""


def small(folder, name, text, program):
    (folder / "program.py").write_text(f"import sys; sys.path.insert(0, {str(ADAPTERS)!r})\n" + program)
    config = folder / f"{name}.toml"
    boxes = algorithm([PYTHON, str(ADAPTERS / "world_boxes.py")], "boxes")
    config.write_text(text + boxes + (algorithm([PYTHON, "program.py"], "bad") if program else ""))
    return config


def test_passes_are_asked_of_programs_too(tmp_path):
    """Between the samples the other one fails: a question about one pair."""
    program = (
        "from collision_program import serve\n"
        "def answer(step):\n"
        "    if len(list(step.pairs())) == 1: raise ValueError('one pair')\n"
        "    at = step.positions\n"
        "    return [(a, b) for a, b in step.pairs() if sum((p - q) ** 2 for p, q in zip(at[a], at[b])) < 2]\n"
        "serve(lambda run: answer, name='bad')\n")
    path = tmp_path / "passes.h5"
    run = pipeline("run", small(tmp_path, "passes", PLAYGROUND, program), "-o", path)
    assert run.returncode == FAILED, run.stderr
    with h5py.File(path) as file:
        labels = list(file["algorithm"].asstr()[()])
        inside, boxes, bad = (labels.index(label) for label in ("aabb", "boxes", "bad"))
        for name in ("first", "last", "flicker", "hits"):
            values = file["passes"][name][()]
            assert np.array_equal(values[:, inside], values[:, boxes], equal_nan=True)
        assert np.isfinite(file["passes/first"][:, boxes]).any()
        assert np.isnan(file["passes/first"][:, bad]).all() and (file["passes/hits"][:, bad] == 0).all()
    about = attributes(path, "bad")
    assert about["reason"].startswith("between the samples of a pass: it gives up: ValueError: one pair")
    assert attributes(path, "boxes")["status"] == "complete"


def test_extremes_are_asked_of_programs_too(tmp_path):
    """Each set of cases is a run of its own, in both orders of the bodies and both places."""
    path = tmp_path / "extremes.h5"
    assert pipeline("run", small(tmp_path, "extremes", EXTREMES, ""), "-o", path).returncode == DONE
    with h5py.File(path) as file:
        position = file["motion/position"][()]
    far = np.sort(np.linalg.norm(position[:, 0] - position[:, 1], axis=1))
    jump = np.argmax(np.diff(far))
    program = (
        "from collision_program import serve\n"
        "def answer(step):\n"
        "    a, b = step.positions\n"
        f"    if sum((p - q) ** 2 for p, q in zip(a, b)) > {(0.5 * (far[jump] + far[jump + 1])) ** 2}:\n"
        "        raise ValueError('too far')\n"
        "    return list(step.pairs())\n"
        "serve(lambda run: answer, name='bad')\n")
    run = pipeline("run", small(tmp_path, "extremes", EXTREMES, program), "-o", path, "--force")
    with h5py.File(path) as file:
        labels = list(file["algorithm"].asstr()[()])
        inside, boxes, bad = (labels.index(label) for label in ("aabb", "boxes", "bad"))
        for name in ("reported", "swapped", "moved", "failed"):
            values = file["extremes"][name][()]
            assert np.array_equal(values[:, inside], values[:, boxes]), name
        assert file["extremes/reported"][:, boxes].any()
        failed = file["extremes/failed"][:, bad]
        assert 0 < (failed == 2).sum() < len(failed), "some cases only"
        steps = len(failed)
    about = attributes(path, "bad")
    assert run.returncode == FAILED and "bad failed after" in run.stderr
    assert about["status"] == "failed" and about["reason"].startswith("it gives up: ValueError: too far")
    assert about["steps_done"] == (failed == 0).sum() < steps
    assert (attributes(path, "boxes")["status"], attributes(path, "boxes")["steps_done"]) == ("complete", steps)


# ---- ends


def processes(word):
    """Processes that have it in their command line, those waiting to be buried left out."""
    out = []
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{entry}/cmdline", "rb") as line, open(f"/proc/{entry}/stat") as stat:
                if entry.isdigit() and word.encode() in line.read() and stat.read().rsplit(")", 1)[1].split()[0] != "Z":
                    out.append(int(entry))
        except OSError:
            pass
    return out


@pytest.mark.parametrize("by", [signal.SIGINT, signal.SIGKILL])
def test_no_child_is_left_and_the_same_command_goes_on(by, tmp_path):
    """Stopped while a program sleeps at step 52 the first time; then run again."""
    program = tmp_path / f"sleeper_{by.name}.py"
    program.write_text(
        f"import os, sys, time; sys.path.insert(0, {str(ADAPTERS)!r})\n"
        "from collision_program import serve\n"
        "def setup(run):\n"
        "    def answer(step):\n"
        "        if step.number == 52 and not os.path.exists('woken'):\n"
        "            open('asleep', 'w').close()\n"
        "            time.sleep(1000)\n"
        "        if step.number == 55: raise ValueError('at 55')\n"
        "        return list(step.pairs())[:1]\n"
        "    return answer\n"
        "serve(setup, name='sleeper')\n")
    config = scene(tmp_path, algorithm([PYTHON, program.name], "sleeper"))
    rows = ["step,body,px,py,pz,qw,qx,qy,qz"]
    for step in range(60):
        rows += [f"{step},a,{1.5 - 0.05 * step},0,0.3,1,0,0,0", f"{step},late,{2 - 0.05 * step},0,0,1,0,0,0"]
    (tmp_path / "poses.csv").write_text("\n".join(rows) + "\n")
    path, whole = tmp_path / "killed.h5", tmp_path / "whole.h5"
    run = subprocess.Popen([PIPELINE, "run", config, "-o", path], stderr=subprocess.PIPE)
    for _ in range(600):
        if (tmp_path / "asleep").exists():
            break
        time.sleep(0.05)
    assert processes(program.name), "it is there"
    run.send_signal(by)
    run.wait()
    run.stderr.close()
    assert run.returncode == (INTERRUPTED if by == signal.SIGINT else -signal.SIGKILL)
    for _ in range(100):
        if not processes(program.name):
            break
        time.sleep(0.02)
    assert not processes(program.name)
    (tmp_path / "woken").touch()
    again = pipeline("run", config, "-o", path)
    assert again.returncode == FAILED and "resuming" in again.stderr
    assert pipeline("run", config, "-o", whole).returncode == FAILED
    for label in ("sleeper", "aabb"):
        assert attributes(path, label)["digest"] == attributes(whole, label)["digest"]
    with h5py.File(path) as one, h5py.File(whole) as other:
        assert one.attrs["digest"] == other.attrs["digest"]
    for key in ("status", "reason", "steps_done", "name", "language"):
        assert attributes(path, "sleeper")[key] == attributes(whole, "sleeper")[key]
    assert attributes(path, "sleeper")["steps_done"] == 55


def test_what_a_program_started_ends_with_it(tmp_path):
    mark = f"grandchild_{os.getpid()}"
    program = tmp_path / "starts.py"
    program.write_text(
        f"import subprocess, sys; sys.path.insert(0, {str(ADAPTERS)!r})\n"
        "from collision_program import serve\n"
        f"subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(1000)', {mark!r}])\n"
        "serve(lambda run: lambda step: [], name='starts')\n")
    run = pipeline("run", scene(tmp_path, algorithm([PYTHON, "starts.py"], "starts")), "-o", tmp_path / "s.h5")
    assert run.returncode == DONE, run.stderr
    time.sleep(0.05)
    assert not processes(mark)


# ---- the recorded conversation


def conversation():
    """Frames of algorithms/program/conversation.txt, in order: (direction, kind, content)."""
    frames = []
    for line in (ADAPTERS / "conversation.txt").read_text().splitlines():
        line = line.split("#")[0]
        if line.startswith((">", "<")):
            frames.append([line[0], ""])
        if line.strip():
            frames[-1][1] += line[1:]
    frames = [(way, bytes.fromhex(text)) for way, text in frames]
    for _, data in frames:
        assert struct.unpack("<I", data[8:12])[0] == len(data) - 12
    numbers = [struct.unpack("<I", data[4:8])[0] for _, data in frames]
    assert numbers == [i // 2 for i in range(len(frames))], "each answer has the number of its question"
    return [(way, data[:4].decode(), data[12:]) for way, data in frames]


@pytest.mark.parametrize("program", ["conversation.py", "conversation.mjs"])
def test_adapters_hold_the_recorded_conversation(program):
    """Byte for byte, but for times and for what the hello says of the language."""
    if program.endswith("mjs") and not shutil.which("node"):
        pytest.skip("no node here")
    command = [PYTHON if program.endswith("py") else "node", ROOT / "tests" / "support" / program]
    child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    for i, (way, kind, content) in enumerate(conversation()):
        if way == ">":
            child.stdin.write(kind.encode() + struct.pack("<II", i // 2, len(content)) + content)
            child.stdin.flush()
            continue
        said_kind, number, length = struct.unpack("<4sII", child.stdout.read(12))
        assert (said_kind.decode(), number) == (kind, i // 2)
        said = child.stdout.read(length)
        if kind == "HELO":
            said, content = json.loads(said), json.loads(content)
            for hello in (said, content):
                assert hello.pop("setup_ns") >= 0 and hello.pop("language")
            assert said == content
        elif kind == "HITS":
            time_ns, prepare_ns = struct.unpack("<2d", said[:16])
            assert 0 <= prepare_ns <= time_ns
            assert said[16:] == content[16:]
        elif kind == "FAIL":
            assert content.decode() in said.decode()
        else:
            assert said == content
    child.stdin.close()
    assert child.stdout.read() == b""
    assert child.wait() == 0


# ---- the page


def block(page, mark):
    """The code after <!-- mark -->, without its fence and indentation."""
    lines = page.split(f"<!-- {mark} -->\n", 1)[1].splitlines()
    while not lines[0].strip():
        lines.pop(0)
    indent = len(lines[0]) - len(lines[0].lstrip())
    if lines[0].strip().startswith("```"):
        lines = lines[1:lines.index(" " * indent + "```", 1)]
    else:
        less = (i for i, line in enumerate(lines) if line.strip() and len(line) - len(line.lstrip()) < indent)
        lines = lines[:next(less, len(lines))]
    return "\n".join(line[indent:] for line in lines) + "\n"


def test_the_method_of_the_page_works_as_written(well, tmp_path):
    page = (ROOT / "algorithms" / "README.md").read_text(encoding="utf-8")
    (tmp_path / "results").mkdir()
    shutil.copy(well, tmp_path / "results" / "padani.h5")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "pipeline").symlink_to(os.path.abspath(PIPELINE))
    env = os.environ | {"TREE": str(ROOT), "PATH": f"{tmp_path}/bin:/usr/bin:/bin"}
    subprocess.run(block(page, "copy"), shell=True, check=True, cwd=tmp_path, env=env)
    (tmp_path / "mine.py").write_text(block(page, "mine.py"))
    detect = block(page, "ask program").splitlines()[0]
    subprocess.run(detect, shell=True, check=True, cwd=tmp_path, env=env, capture_output=True)
    with h5py.File(tmp_path / "results" / "padani.h5") as file:
        position = file["motion/position"][()]
        for label, reach in (("mine", 2.0), ("near", 1.9)):
            expected = [(s, a, b) for s in range(STEPS) for a in range(4) for b in range(a + 1, 4)
                        if (a, b) != (2, 3) and np.linalg.norm(position[s, a] - position[s, b]) < reach]
            offset, pair = file["answers"][label]["pair_offset"][()], file["answers"][label]["pair"][()]
            found = [(s, *pair[i]) for s in range(STEPS) for i in range(int(offset[s]), int(offset[s + 1]))]
            assert found == expected
        assert len(file["answers/near/pair"]) < len(file["answers/mine/pair"])


def test_a_result_starts_no_program_by_itself(well, tmp_path):
    path = tmp_path / "copy.h5"
    shutil.copy(well, path)
    run = pipeline("detect", path, "--force")
    assert run.returncode == DONE
    assert "algorithm 'python' is left out: it needs its program, which no result starts by itself" in run.stderr
    assert attributes(path, "python")["date"] == attributes(well, "python")["date"]


def test_adapters_are_short():
    for name in ("collision_program.py", "collision_program.mjs"):
        assert len((ADAPTERS / name).read_text().splitlines()) <= 80


def test_the_report_tells_who_failed_and_leaves_them_out(faults):
    from analysis.report import report
    from analysis.tables import pareto

    run = load(faults[0])
    lines = report.failures([run])
    assert len(lines) == len(FAULTS)
    assert lines[0].startswith("faults: throw failed after 4 of 12 steps: it gives up: ValueError: no such luck")
    table = report.foreign([run]).parts[0].frame
    assert list(table["label"]) == [label for label in run.meta["algorithms"] if label != "aabb"]
    assert (table["asked as"] == "program").all() and table["status"].value_counts()["failed"] == len(FAULTS)
    assert table.set_index("label")["exchange (µs)"].notna().sum() == 1, "of the one that came to its end"
    assert list(pareto.scenes([run.completed()])[0].points.label) == ["aabb", "print (program, Python)"]
