"""What `check` says of a run against what the run takes: memory, file and time."""
import json
import os
import pty
import re
import resource
import subprocess
import sys
from pathlib import Path

import pytest
from program import DONE, INPUT, NO_PROGRAMS, PIPELINE, ROOT, pipeline

CONFIGS = sorted(str(path) for path in (ROOT / "configs").glob("*.toml"))

# Cubes of a part drawn in millimetres: facet_distance takes its facets a square metre at its word.
CUBES = """
steps = 2
[scene]
kind = "playground"
step = 1000
[scene.hero]
shape = "box"
size = [{0}, {0}, {0}]
[[scene.obstacle]]
name = "cube"
shape = "box"
size = [{0}, {0}, {0}]
"""

# The peak of a process that is started by a small one: what a process was before it became another counts too.
PEAK = "import resource, subprocess, sys; code = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL).returncode; " \
       "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024); sys.exit(code)"


def measured(path, *arguments):
    run = subprocess.run([sys.executable, "-c", PEAK, PIPELINE, "run", *arguments, "-o", str(path), "--quiet"],
                         capture_output=True, text=True, timeout=300)
    assert run.returncode == DONE, run.stderr
    return int(run.stdout), path.stat().st_size


@pytest.mark.parametrize("arguments", [
    ["configs/smoke.toml"],
    ["configs/smoke.toml", "--set", "steps=2000"],
    ["configs/smoke.toml", "--set", "scene.set.0.above=[9,9,9]", "--set", "truth.gap=true"],
    ["configs/replay_example.toml"],
    ["configs/kostka.toml", "--set", "steps=200"],
    ["configs/hriste.toml", "--set", "steps=2000"],
    ["configs/padani.toml", "--set", "steps=40"],
    ["configs/padani_knobs.toml", "--set", "steps=5"],
    ["configs/padani.toml", "--set", "steps=2", "--set", "algorithm=[{name='facet_distance',facets_per_area=200}]"],
    ["configs/stiffness.toml", "--set", "every=40"],
    ["configs/heap.toml", "--set", "steps=150"],
    ["configs/cup.toml", "--set", "steps=200"],
    ["configs/large.toml", "--set", "scene.set.0.above=[30,5,30]", "--set", "timing.repeats=1"],
], ids=" ".join)
def test_memory_and_file_are_within_a_factor_of_a_half(tmp_path, arguments):
    arguments = [str(ROOT / arguments[0]), *arguments[1:]]
    plan = json.loads(pipeline("check", *arguments, "--json").stdout)
    memory, file = measured(tmp_path / "x.h5", *arguments)
    assert memory / 1.5 <= plan["memory_bytes"] <= 1.5 * memory, (plan["memory_bytes"] >> 20, memory >> 20)
    assert file / 1.5 <= plan["file_bytes"] <= 1.5 * file, (plan["file_bytes"], file)


def test_what_a_method_would_densify_is_said(tmp_path):
    config = tmp_path / "cubes.toml"
    config.write_text(CUBES.format(200) + "[[algorithm]]\nname = 'facet_distance'\n[[algorithm]]\nname = 'aabb'\n")
    plan = json.loads(pipeline("check", config, "--json").stdout)
    memory, _ = measured(tmp_path / "x.h5", str(config))
    assert memory / 1.5 <= plan["memory_bytes"] <= 1.5 * memory, (plan["memory_bytes"] >> 20, memory >> 20)
    by_label = {row["label"]: row["memory_bytes"] for row in plan["algorithms"]}
    assert by_label["facet_distance"] > 100 << 20 > 1 << 20 > by_label["aabb"]
    assert "facet_distance alone about" in pipeline("check", config).stdout


def test_out_of_memory_names_the_label(tmp_path):
    config = tmp_path / "cubes.toml"
    config.write_text(CUBES.format(600) + "[[algorithm]]\nname = 'aabb'\n[[algorithm]]\nname = 'facet_distance'\nlabel "
                                          "= 'greedy'\n")

    def little():
        resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))

    run = pipeline("run", config, "-o", tmp_path / "x.h5", "--quiet", "--threads", 1, preexec_fn=little)
    assert run.returncode == INPUT, run.stderr
    assert re.search(r"algorithm 'greedy': out of memory; it takes about \d\.\d GiB: sample fewer",
                     run.stderr.splitlines()[-1])


def test_too_much_for_this_machine_names_the_label_that_wants_it(tmp_path):
    config = tmp_path / "cubes.toml"
    many = "".join(f"[[algorithm]]\nname = 'facet_distance'\nlabel = 'k{i}'\n" for i in range(200))
    config.write_text(CUBES.format(640) + many)
    for command in (["run", config, "-o", tmp_path / "x.h5"], ["check", config]):
        run = pipeline(*command)
        assert run.returncode == INPUT and "of memory, this machine has" in run.stderr.splitlines()[-1]
    assert list(tmp_path.iterdir()) == [config]


@pytest.mark.parametrize("config", CONFIGS, ids=lambda path: Path(path).stem)
def test_check_is_quick_and_says_a_time(config):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = pipeline("check", config, "--json", env=NO_PROGRAMS)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert run.returncode == DONE, run.stderr
    least, most = json.loads(run.stdout)["seconds"]
    assert 0 < least < most
    assert after.ru_utime - before.ru_utime < 5
    said = pipeline("check", config, env=NO_PROGRAMS).stdout
    assert re.search(r"^takes +(about .* to .*|less than a second), .* of memory$", said, re.MULTILINE)


def test_a_run_shortened_before_its_events_says_so(tmp_path):
    config = str(ROOT / "configs" / "smoke.toml")
    said = pipeline("check", config, "--set", "steps=40").stderr
    assert re.search(r"40 steps leave out the landing of set 3, 4 spheres \(step \d+\): what remains is another scene",
                     said)
    assert pipeline("check", config).stderr == ""
    replay = str(ROOT / "configs" / "replay_example.toml")
    assert "10 steps leave out 1 of 4 births (step 10): " in pipeline("check", replay, "--set", "steps=10").stderr
    assert pipeline("check", replay, "--set", "steps=11").stderr == ""


def test_a_landing_is_foretold_within_two_steps(tmp_path):
    """Against the exact truth of the run itself."""
    h5py = pytest.importorskip("h5py")
    config = str(ROOT / "configs" / "smoke.toml")
    said = pipeline("check", config, "--set", "steps=1").stderr
    foretold = {int(number): int(step) for number, step in re.findall(r"set (\d), \d+ spheres? \(step (\d+)\)", said)}
    path = tmp_path / "x.h5"
    assert pipeline("run", config, "-o", path, "--quiet").returncode == DONE
    with h5py.File(path) as file:
        names = [name.decode() for name in file["body"][:]]
        offset, pairs = file["truth/pair_offset"][:], file["truth/pair"][:]
    for number, step in foretold.items():
        meets = [s for s in range(len(offset) - 1) for a, b in pairs[offset[s]:offset[s + 1]]
                 if {names[a].rsplit("_", 1)[0],
                     names[b].rsplit("_", 1)[0]} == {f"set{number}_lying", f"set{number}_above"}]
        assert abs(min(meets) - step) <= 2, (number, min(meets), step)
    assert set(foretold) == {1, 2, 3}


def test_the_time_left_is_of_the_whole_run(tmp_path):
    command = [PIPELINE, "run", str(ROOT / "configs" / "smoke.toml"), "-o", str(tmp_path / "x.h5"), "--set",
               "steps=3000"]
    process, terminal = pty.fork()
    if process == 0:
        os.execv(PIPELINE, command)
    said = b""
    while True:
        try:
            more = os.read(terminal, 65536)
        except OSError:
            break
        if not more:
            break
        said += more
    assert os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) == DONE
    text = said.decode()
    assert re.search(r"motion +\[.*left of the run", text) and re.search(r"store +\[.*100 %", text), text[-2000:]
    assert " 0 steps/s" not in text
