"""The program as its users meet it: commands, exit codes, one-line errors, resuming."""
import json
import os
import re
import resource
import shutil
import signal
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from editing import edited
from program import (
    DONE, FAILED, FILE, INPUT, INTERRUPTED, NO_PROGRAMS, PIPELINE, ROOT,
    USAGE, digest, one_line, pipeline, start, wait_for,
)

SMOKE = str(ROOT / "configs" / "smoke.toml")


@pytest.fixture(scope="module")
def smoke(tmp_path_factory):
    path = tmp_path_factory.mktemp("smoke") / "smoke.h5"
    run = pipeline("run", SMOKE, "-o", path)
    assert run.returncode == DONE, run.stderr
    return path


# ---- run, show, check, list


def test_run_writes_under_results_by_default(tmp_path):
    run = pipeline("run", SMOKE, "--set", "steps=3", cwd=tmp_path)
    assert run.returncode == DONE, run.stderr
    assert (tmp_path / "results" / "smoke.h5").is_file()
    assert not (tmp_path / "results" / "smoke.h5.part").exists()
    assert "results/smoke.h5" in run.stdout


def test_two_runs_and_thread_counts_give_the_same_digest(smoke, tmp_path):
    for threads in (1, 3):
        again = tmp_path / f"again{threads}.h5"
        assert pipeline("run", SMOKE, "-o", again, "--threads", threads).returncode == DONE
        assert digest(again) == digest(smoke)


def test_another_question_gives_another_digest(smoke, tmp_path):
    other = tmp_path / "other.h5"
    assert pipeline("run", SMOKE, "-o", other, "--set", "scene.shift=0.2").returncode == DONE
    assert digest(other) != digest(smoke)


def test_json_is_one_valid_document(smoke, tmp_path):
    run = pipeline("run", SMOKE, "-o", tmp_path / "x.h5", "--json", "--quiet", "--set", "steps=5")
    assert json.loads(run.stdout)["steps"] == 5
    shown = json.loads(pipeline("show", smoke, "--json").stdout)
    assert shown["digest"] == digest(smoke)
    with h5py.File(smoke) as file:
        for a, row in enumerate(shown["algorithms"]):
            assert row["false_positive"] == file["summary/false_positive"][a]
            assert row["error"] == file["summary/error"][a]


def test_show_prints_error_counts_time_and_digest(smoke):
    text = pipeline("show", smoke).stdout
    for word in ("error", "false positive", "false negative", "mean time", "bounding_sphere", digest(smoke)):
        assert word in text


def test_check_says_what_would_run_and_writes_nothing(tmp_path):
    run = pipeline("check", SMOKE, cwd=tmp_path)
    assert run.returncode == DONE
    for word in ("18 bodies", "bounding_sphere", "RungeKuttaMerson", "memory"):
        assert word in run.stdout
    assert list(tmp_path.iterdir()) == []
    assert json.loads(pipeline("check", SMOKE, "--json").stdout)["bodies"] == 18


@pytest.mark.parametrize("what", ["algorithms", "scenes", "shapes", "integrators", "problems", "keys", "datasets"])
def test_list_names_what_configurations_can_name(what):
    names = [row["name"] for row in json.loads(pipeline("list", what, "--json").stdout)]
    assert names
    text = pipeline("list", what).stdout
    assert all(name in text for name in names)


def test_version_and_help_everywhere():
    version = pipeline("--version")
    assert version.returncode == DONE and version.stdout.startswith("0.")
    for command in ([], ["run"], ["check"], ["list"], ["show"], ["export"], ["detect"], ["verify"], ["score"]):
        run = pipeline(*command, "--help")
        assert run.returncode == DONE and "--help" in run.stdout


def test_nothing_but_errors_on_stderr_when_it_is_no_terminal(tmp_path):
    assert pipeline("run", SMOKE, "-o", tmp_path / "x.h5").stderr == ""


@pytest.mark.parametrize("config", sorted((ROOT / "configs").glob("*.toml")), ids=lambda path: path.stem)
def test_every_configuration_runs(tmp_path, config):
    """The first three steps of each, every algorithm of it included but programs of others (tests/commands/
    test_engines.py); of a study a few cases."""
    assert pipeline("check", config, env=NO_PROGRAMS).returncode == DONE
    if "\nstudy = " in config.read_text():
        few = ["--set", "every=97", "--set", "budget.force_evaluations=2000"]
        run = pipeline("run", config, "-o", tmp_path / "x.h5", *few, "--json")
        assert run.returncode == DONE, run.stderr
        assert 3 <= json.loads(run.stdout)["cases"] < 20
        return
    run = pipeline("run", config, "-o", tmp_path / "x.h5", "--set", "steps=3", "--set", "timing.repeats=1", "--json",
                   env=NO_PROGRAMS)
    assert run.returncode == DONE, run.stderr
    shown = json.loads(run.stdout)
    assert shown["steps"] == 3
    assert all(row["promise_kept"] for row in shown["algorithms"])


# ---- detect


def test_detect_adds_an_algorithm_and_keeps_motion_and_truth(smoke, tmp_path):
    copy = tmp_path / "copy.h5"
    shutil.copy(smoke, copy)
    before = json.loads(pipeline("show", copy, "--json").stdout)
    run = pipeline("detect", copy, "--algorithm", "obb_sat@again", "--json")
    assert run.returncode == DONE, run.stderr
    after = json.loads(run.stdout)
    for group in ("/motion", "/truth", "/answers/obb_sat"):
        assert after["digests"][group] == before["digests"][group]
    assert after["digests"]["/answers/again"]
    assert after["digest"] != before["digest"]
    rows = {row["label"]: row for row in after["algorithms"]}
    assert rows["again"]["false_positive"] == rows["obb_sat"]["false_positive"]
    assert rows["again"]["operations"] == rows["obb_sat"]["operations"]


def test_detect_says_that_a_run_is_unfinished(tmp_path):
    part = tmp_path / "x.h5.part"
    part.mkdir()
    run = pipeline("detect", part, "--algorithm", "aabb")
    assert run.returncode == FILE and "finish it with the same `pipeline run`" in one_line(run)


def test_detect_refuses_a_label_that_exists_unless_forced(smoke, tmp_path):
    copy = tmp_path / "copy.h5"
    shutil.copy(smoke, copy)
    content = copy.read_bytes()
    run = pipeline("detect", copy, "--algorithm", "obb_sat")
    assert run.returncode == FILE and "--force" in one_line(run)
    assert copy.read_bytes() == content
    assert pipeline("detect", copy, "--algorithm", "obb_sat", "--force").returncode == DONE
    assert digest(copy) == digest(smoke)


def test_detect_repeats_the_files_own_algorithms(smoke, tmp_path):
    copy = tmp_path / "copy.h5"
    shutil.copy(smoke, copy)
    assert pipeline("detect", copy, "--force").returncode == DONE
    assert digest(copy) == digest(smoke)


@pytest.mark.parametrize("argument, words", [
    ("obb_satt", ["obb_satt", "obb_sat"]),
    ("obb_sat:stride=3", ["stride"]),
    ("obb_sat@a b", ["a b"]),
])
def test_detect_refuses_wrong_algorithms(smoke, argument, words):
    run = pipeline("detect", smoke, "--algorithm", argument)
    assert run.returncode == INPUT
    line = one_line(run)
    assert all(word in line for word in words), line


# ---- a run is never lost


# Longer than smoke, so that there is time to be killed in: eight chunks of 50 steps in each stage.
LONG = ["--set", "steps=400", "--set", "timing.repeats=5"]


@pytest.fixture(scope="module")
def long_digest(tmp_path_factory):
    path = tmp_path_factory.mktemp("long") / "long.h5"
    assert pipeline("run", SMOKE, "-o", path, *LONG).returncode == DONE
    return digest(path)


@pytest.mark.parametrize("kill", [signal.SIGKILL, signal.SIGINT])
@pytest.mark.parametrize("chunk", ["motion-0000000", "motion-0000200", "truth-0000100", "answers-0000150"])
def test_a_killed_run_resumes_and_ends_with_the_same_digest(tmp_path, long_digest, kill, chunk):
    path = tmp_path / "x.h5"
    part = tmp_path / "x.h5.part"
    run = start("run", SMOKE, "-o", path, *LONG)
    wait_for(lambda: (part / chunk).exists() or run.poll() is not None)
    run.send_signal(kill)
    run.communicate(timeout=60)
    if run.returncode != DONE:  # it may have been quicker than the signal
        assert run.returncode == (INTERRUPTED if kill == signal.SIGINT else -signal.SIGKILL)
        assert not path.exists()
        shown = pipeline("show", part)
        assert shown.returncode == DONE and "unfinished" in shown.stdout
        kept = (part / chunk).stat().st_mtime_ns
        again = start("run", SMOKE, "-o", path, *LONG)
        wait_for(lambda: path.exists() or again.poll() is not None)
        assert again.wait(timeout=120) == DONE
        assert kept
    assert digest(path) == long_digest
    assert not part.exists()


def test_a_run_killed_again_and_again_ends_with_the_same_digest(tmp_path, long_digest):
    path = tmp_path / "x.h5"
    kills = 0
    for delay in (0.05, 0.1, 0.2, 0.3, 0.4, 0.5):
        run = start("run", SMOKE, "-o", path, *LONG)
        try:
            run.communicate(timeout=delay)
        except subprocess.TimeoutExpired:
            run.kill()
            run.communicate()
            kills += 1
    if not path.exists():
        assert pipeline("run", SMOKE, "-o", path, *LONG).returncode == DONE
    assert kills > 0
    assert digest(path) == long_digest


def test_a_second_writer_is_refused(tmp_path):
    path = tmp_path / "x.h5"
    first = start("run", SMOKE, "-o", path, "--set", "steps=2000")
    wait_for(lambda: (tmp_path / "x.h5.part" / "manifest.json").exists())
    second = pipeline("run", SMOKE, "-o", path, "--set", "steps=2000")
    assert second.returncode == FILE and "another run" in one_line(second)
    first.kill()
    first.communicate()


def test_a_part_of_another_configuration_is_refused_unless_forced(tmp_path):
    path = tmp_path / "x.h5"
    first = start("run", SMOKE, "-o", path, "--set", "steps=2000")
    wait_for(lambda: (tmp_path / "x.h5.part" / "motion-0000000").exists())
    first.kill()
    first.communicate()
    other = pipeline("run", SMOKE, "-o", path, "--set", "steps=10")
    assert other.returncode == FILE and "another configuration" in one_line(other)
    assert pipeline("run", SMOKE, "-o", path, "--set", "steps=10", "--force").returncode == DONE


def test_a_damaged_chunk_is_computed_again(tmp_path, long_digest):
    path = tmp_path / "x.h5"
    part = tmp_path / "x.h5.part"
    run = start("run", SMOKE, "-o", path, *LONG)
    wait_for(lambda: (part / "truth-0000100").exists())
    run.kill()
    run.communicate()
    with open(part / "truth-0000100", "r+b") as chunk:
        chunk.seek(-1, os.SEEK_END)
        last = chunk.read(1)
        chunk.seek(-1, os.SEEK_END)
        chunk.write(bytes([last[0] ^ 1]))
    again = pipeline("run", SMOKE, "-o", path, *LONG)
    assert again.returncode == DONE and "damaged" in again.stderr
    assert digest(path) == long_digest


# ---- what goes wrong


@pytest.mark.parametrize("setting, words", [
    ("steps=-1", ["--set steps=-1", "steps"]),
    ("steps=0", ["steps"]),
    ("steps=\"ten\"", ["steps", "integer"]),
    ("scene.segments=1000000000", ["segments"]),
    ("physics.accuracy=0", ["accuracy"]),
    ("physics.accuracy=nan", ["accuracy"]),
    ("physics.integrator=RungeKuta3", ["RungeKutta3"]),
    ("physics.stifness=1", ["stifness", "stiffness"]),
    ("nonsense.key=1", ["nonsense"]),
    ("algorithm.0.name=obb_satt", ["obb_satt", "obb_sat"]),
    ("algorithm.0.knob=1", ["knob"]),
    ("steps=", ["steps"]),
])
def test_wrong_values_are_one_line_and_code_3(tmp_path, setting, words):
    run = pipeline("run", SMOKE, "--set", setting, "-o", tmp_path / "x.h5")
    assert run.returncode == INPUT, run.stderr
    line = one_line(run)
    assert all(word in line for word in words), line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text, place, words", [
    ("steps = -1\n[scene]\nkind = \"falling\"\n", ":1:", ["steps"]),
    ("stepz = 5\n[scene]\nkind = \"falling\"\n", ":1:", ["stepz", "steps"]),
    ("[scene]\nkind = \"faling\"\n", ":2:", ["falling"]),
    ("[scene]\nkind = \"falling\"\nsegments = [\n", ":", []),
    ("steps = 1", "", ["scene"]),
    ("[scene]\nkind = \"falling\"\n[[algorithm]]\nname = \"nothing\"\n", ":4:", ["nothing"]),
    ("[scene]\nkind = \"falling\"\n[[algorithm]]\nname = \"obb_sat\"\n[[algorithm]]\nname = \"obb_sat\"\n", ":",
     ["obb_sat"]),
])
def test_wrong_configurations_name_file_line_and_rule(tmp_path, text, place, words):
    config = tmp_path / "wrong.toml"
    config.write_text(text)
    for command in (["run", config, "-o", tmp_path / "x.h5"], ["check", config]):
        run = pipeline(*command)
        assert run.returncode == INPUT, run.stderr
        line = one_line(run)
        assert line.startswith(str(config) + place), line
        assert all(word in line for word in words), line
    assert [p.name for p in tmp_path.iterdir()] == ["wrong.toml"]


def test_a_missing_or_unreadable_configuration_is_code_3(tmp_path):
    for path in (tmp_path / "missing.toml", tmp_path):
        run = pipeline("run", path)
        assert run.returncode == INPUT and str(path) in one_line(run)


@pytest.mark.parametrize("arguments", [
    [], ["fly"], ["run"], ["run", SMOKE, "--bogus"], ["run", SMOKE, "--threads", "many"], ["list", "cakes"], ["show"],
    ["run", SMOKE, "--set", "steps"],
])
def test_wrong_grammar_is_code_2(arguments):
    run = pipeline(*arguments)
    assert run.returncode == USAGE
    assert run.stdout == "" and run.stderr != ""


@pytest.mark.parametrize("arguments, command", [
    ([], "pipeline"), (["run"], "pipeline run"), (["run", SMOKE, "--bogus"], "pipeline run"), (["--bogus"], "pipeline"),
    (["run", SMOKE, "--threads", "many"], "pipeline run"), (["list", "cakes"], "pipeline list"),
    (["show"], "pipeline show"),
    (["show", "a", "b"], "pipeline show"), (["verify", "a", "--all", "--pairs", "3"], "pipeline verify"),
    (["score", "a", "--against", "b", "--tolerance", "2"], "pipeline score"), (["export", "a"], "pipeline export"),
    (["detect"], "pipeline detect"), (["check", SMOKE, "run"], "pipeline check"),
])
def test_wrong_grammar_names_the_help_of_the_command_meant(arguments, command):
    run = pipeline(*arguments)
    assert run.returncode == USAGE and run.stderr.rstrip().endswith(f"; see {command} --help"), run.stderr


def test_words_that_are_not_expected_are_named_in_their_order_with_the_rule():
    run = pipeline("detect", "a.h5", "--algorithm", "aabb", "obb_sat", "obb_corners")
    assert run.returncode == USAGE
    assert one_line(run) == (
        "obb_sat obb_corners: not expected here; --algorithm takes one value, and is repeated for more; "
        "see pipeline detect --help"
    )
    run = pipeline("run", SMOKE, "--set", "steps=3", "rate=60")
    assert one_line(run).startswith("rate=60: not expected here; --set takes one value, and is repeated for more; ")
    assert one_line(pipeline("show", "a", "b", "c")) == "b c: not expected here; see pipeline show --help"
    for command in ("run", "check", "detect"):
        assert "..." not in re.sub(r"value,\.\.\.", "", pipeline(command, "--help").stdout), "one value, not several"


def test_digests_of_groups_are_behind_an_option(smoke, tmp_path):
    copy = tmp_path / "copy.h5"
    shutil.copy(smoke, copy)
    every = set(json.loads(pipeline("show", copy, "--json").stdout)["digests"])
    assert {"/", "/motion", "/answers/obb_sat"} < every
    for arguments in (["show", copy], ["detect", copy, "--force", "--quiet"],
                      ["run", SMOKE, "-o", tmp_path / "x.h5", "--quiet"]):
        run = pipeline(*arguments)
        assert re.findall(r"^digest +\w{32}  (.*)$", run.stdout, re.M) == ["/"], run.stdout
        assert "bounding_sphere" in run.stdout and run.stderr == ""  # --quiet leaves the result
    for arguments in (["show", copy, "--digests"], ["detect", copy, "--force", "--digests"]):
        assert set(re.findall(r"^digest +\w{32}  (.*)$", pipeline(*arguments).stdout, re.M)) == every


# ---- seed


def motion_of(path):
    return json.loads(pipeline("show", path, "--json").stdout)["digests"]["/motion"]


def test_a_seed_gives_other_runs_with_jitter_and_is_refused_without(smoke, tmp_path):
    run = pipeline("run", SMOKE, "-o", tmp_path / "x.h5", "--set", "seed=2")
    assert run.returncode == INPUT
    assert one_line(run) == ("--set seed=2: 'seed' must be left out, not 2: nothing is drawn at random in this falling "
                             "scene; remove it, or set scene.jitter above 0, or turned = true in a set")
    assert list(tmp_path.iterdir()) == []
    motion = {}
    for name, sets in {"a": ["seed=1"], "b": ["seed=2"], "again": ["seed=2"]}.items():
        run = pipeline("run", SMOKE, "-o", tmp_path / name, "--set", "scene.jitter=0.01", "--set", *sets)
        assert run.returncode == DONE and run.stderr == "", run.stderr
        motion[name] = motion_of(tmp_path / name)
    assert motion["a"] != motion["b"] == motion["again"]


@pytest.mark.parametrize("name, what", [("hriste", "playground"), ("replay_example", "replay"), ("padani", "falling")])
def test_an_idle_seed_is_refused_in_every_scene_that_draws_nothing_and_noted_where_it_is_the_preset(name, what):
    config = ROOT / "configs" / f"{name}.toml"
    run = pipeline("check", config, "--set", "seed=3")
    assert run.returncode == INPUT and f"nothing is drawn at random in this {what} scene; remove it" in one_line(run)
    run = pipeline("check", config, "--set", "seed=1")
    assert run.returncode == DONE and "'seed' changes nothing: " in run.stderr, run.stderr
    assert "seed" not in pipeline("check", config).stderr


@pytest.mark.parametrize("name", ["kostka", "extremes"])
def test_where_something_is_drawn_any_seed_is_right(name):
    run = pipeline("check", ROOT / "configs" / f"{name}.toml", "--set", "seed=3")
    assert run.returncode == DONE and "seed" not in run.stderr


def test_a_study_knows_no_seed():
    run = pipeline("check", ROOT / "configs" / "integrators.toml", "--set", "seed=1")
    assert run.returncode == INPUT and "unknown key 'seed'" in one_line(run)


# Files made before the rule have any seed in their effective configuration, which their own algorithms are read from.
def test_detect_still_reads_a_file_with_an_idle_seed(smoke, tmp_path):
    copy = tmp_path / "copy.h5"
    shutil.copy(smoke, copy)
    with edited(copy) as file:
        attributes = file["config"].attrs
        attributes["effective"] = attributes["effective"].replace("seed = 1", "seed = 7")
    assert pipeline("detect", copy, "--force").returncode == DONE


def test_an_unknown_subcommand_is_named():
    assert one_line(pipeline("fly", SMOKE)) == "fly: is no subcommand; see pipeline --help"


def test_an_existing_output_is_kept_unless_forced(tmp_path):
    path = tmp_path / "x.h5"
    path.write_text("precious")
    run = pipeline("run", SMOKE, "-o", path, "--set", "steps=3")
    assert run.returncode == FILE and "--force" in one_line(run)
    assert path.read_text() == "precious"
    assert pipeline("run", SMOKE, "-o", path, "--set", "steps=3", "--force").returncode == DONE
    assert pipeline("show", path).returncode == DONE


def test_an_output_that_cannot_be_written_is_code_4(tmp_path):
    (tmp_path / "file").write_text("")
    for path in ("/proc/nothing/x.h5", tmp_path / "file" / "x.h5", tmp_path):
        run = pipeline("run", SMOKE, "-o", path)
        assert run.returncode == FILE, run.stderr
        one_line(run)


def test_a_full_disk_is_code_4_and_keeps_what_was_committed(tmp_path, long_digest):
    path = tmp_path / "x.h5"

    def tiny_files():  # a limit on the size of files is the full disk that needs no mount
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (30000, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))

    run = pipeline("run", SMOKE, "-o", path, *LONG, preexec_fn=tiny_files)
    assert run.returncode == FILE, run.stderr
    one_line(run)
    assert not path.exists()
    assert pipeline("run", SMOKE, "-o", path, *LONG).returncode == DONE
    assert digest(path) == long_digest


def test_a_full_stdout_is_not_success(smoke):
    with open("/dev/full", "w") as full:
        run = subprocess.run([PIPELINE, "show", str(smoke)], stdout=full, stderr=subprocess.PIPE, text=True)
    assert run.returncode == FILE


def test_more_than_this_machine_can_hold_is_refused_before_the_run(tmp_path):
    run = pipeline("run", SMOKE, "-o", tmp_path / "x.h5", "--set", "steps=10000000", "--set",
                   "scene.set.0.above=[60,60,60]")
    assert run.returncode == INPUT and "memory" in one_line(run)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"not HDF5 at all", None])
def test_show_refuses_what_is_not_a_result(tmp_path, smoke, content):
    path = tmp_path / "x.h5"
    path.write_bytes(smoke.read_bytes()[:5000] if content is None else content)
    for command in ("show", "detect"):
        run = pipeline(command, path)
        assert run.returncode == FILE
        assert str(path) in one_line(run)


def test_show_refuses_foreign_and_newer_files(tmp_path, smoke):
    foreign = tmp_path / "foreign.h5"
    with h5py.File(foreign, "w") as file:
        file["x"] = np.arange(3)
    run = pipeline("show", foreign)
    assert run.returncode == FILE
    one_line(run)
    newer = tmp_path / "newer.h5"
    shutil.copy(smoke, newer)
    with edited(newer) as file:
        file.attrs["schema_version"] = np.int64(10**6)
    run = pipeline("show", newer)
    assert run.returncode == FILE and "1000000" in one_line(run)
    assert pipeline("show", tmp_path / "missing.h5").returncode == FILE


# ---- a motion that fails ends as data


def test_a_failed_integration_is_written_and_said(tmp_path):
    path = tmp_path / "x.h5"
    run = pipeline("run", SMOKE, "-o", path, "--set", "physics.step_budget=1")
    assert run.returncode == FAILED
    assert "failed at step" in run.stderr
    with h5py.File(path) as file:
        assert "failed at step" in file["physics"].attrs["status"]
        moving = file["bodies/fixed"][:] == 0
        position = file["motion/position"][:]
        assert np.isnan(position[-1, moving]).all()
        assert np.isfinite(position[:, ~moving]).all()
        assert np.isfinite(position[0]).all()
        assert file["truth/pair_offset"][-1] == file["truth/pair_offset"][-2]  # nothing can meet any more
    assert pipeline("show", path).returncode == DONE


def test_knobs_that_do_not_fit_the_meshes_are_refused_before_the_run(tmp_path, smoke):
    density = "facets_per_area=1e9"
    run = pipeline("run", SMOKE, "-o", tmp_path / "x.h5", "--set", "algorithm=[{name='facet_distance', %s}]" % density)
    assert run.returncode == INPUT and "facet_distance" in one_line(run) and "denser" in run.stderr
    assert list(tmp_path.iterdir()) == []
    run = pipeline("detect", smoke, "--algorithm", "facet_distance:" + density)
    assert run.returncode == INPUT and "denser" in one_line(run)


# ---- found by a review on 2026-11-22


def test_an_output_that_appears_during_the_run_is_not_overwritten(tmp_path):
    path = tmp_path / "x.h5"
    run = start("run", SMOKE, "-o", path, *LONG)
    wait_for(lambda: (tmp_path / "x.h5.part" / "motion-0000000").exists())
    path.write_text("precious")
    _, error = run.communicate(timeout=120)
    assert run.returncode == FILE and "exists by now" in error
    assert path.read_text() == "precious"


def test_outputs_that_can_never_be_written_are_refused_before_the_run(tmp_path):
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    for output in ("/dev/null", f"{tmp_path}/folder/", tmp_path / ("n" * 300 + ".h5"), tmp_path / "dangling"):
        run = pipeline("run", SMOKE, "-o", output)
        assert run.returncode == FILE, (output, run.stderr)
        one_line(run)
    assert pipeline("run", SMOKE, "-o", "/dev/null", "--force").returncode == FILE
    assert pipeline("run", SMOKE, "-o", "").returncode == USAGE
    assert not Path("/dev/null.part").exists()
    assert [p.name for p in tmp_path.iterdir() if p.name != "dangling" and any(p.iterdir())] == []


def test_two_writers_of_one_file_do_not_lose_answers(tmp_path, smoke):
    path = tmp_path / "x.h5"
    shutil.copy(smoke, path)
    runs = [start("detect", path, "--algorithm", "facet_distance:prefilter=none@" + label) for label in ("one", "two")]
    for run in runs:
        run.communicate(timeout=120)
    done = [label for label, run in zip(("one", "two"), runs) if run.returncode == DONE]
    assert done and all(run.returncode in (DONE, FILE) for run in runs)
    with h5py.File(path) as file:
        assert all(label in file["answers"] for label in done)
    assert [p.name for p in tmp_path.iterdir()] == ["x.h5"]


def test_what_a_kill_left_behind_is_cleared_away(tmp_path, long_digest):
    path = tmp_path / "x.h5"
    run = start("run", SMOKE, "-o", path, *LONG)
    wait_for(lambda: (tmp_path / "x.h5.part" / "truth-0000000").exists())
    run.kill()
    run.communicate()
    assert pipeline("run", SMOKE, "-o", path, *LONG).returncode == DONE
    assert digest(path) == long_digest
    assert [p.name for p in tmp_path.iterdir()] == ["x.h5"]


def test_detect_keeps_a_link_a_link(tmp_path, smoke):
    shutil.copy(smoke, tmp_path / "real.h5")
    (tmp_path / "link.h5").symlink_to("real.h5")
    assert pipeline("detect", tmp_path / "link.h5", "--algorithm", "aabb").returncode == DONE
    assert (tmp_path / "link.h5").is_symlink()
    with h5py.File(tmp_path / "real.h5") as file:
        assert "aabb" in file["answers"]


def test_a_limit_on_files_is_code_4_not_a_signal(tmp_path):
    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (20000, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))

    run = pipeline("run", SMOKE, "-o", tmp_path / "x.h5", *LONG, preexec_fn=limited)
    assert run.returncode == FILE
    one_line(run)


def test_odd_names_give_one_line_and_valid_json(tmp_path):
    assert "\n" not in pipeline("show", tmp_path / "a\nb.h5").stderr.strip()
    odd = os.fsencode(tmp_path) + b"/\xff.h5"
    run = subprocess.run([os.fsencode(PIPELINE), b"run", os.fsencode(SMOKE), b"-o", odd, b"--set", b"steps=3",
                          b"--json"],
                         capture_output=True)
    assert run.returncode == DONE
    json.loads(run.stdout)


def test_check_refuses_what_run_refuses(tmp_path):
    run = pipeline("check", SMOKE, "--set", "algorithm=[{name='facet_distance', facets_per_area=1e9}]")
    assert run.returncode == INPUT and "denser" in one_line(run)


def test_wrong_grammar_is_one_line():
    one_line(pipeline("fly"))
    one_line(pipeline("run", SMOKE, "--bogus"))
