"""scripts/results: records of results, and one page over them."""

import json
import os
import re
import shutil
import subprocess

import numpy as np
import pandas as pd
import pytest
from program import DONE, PIPELINE, ROOT, pipeline

from analysis import results
from analysis.tables.intervals import Interval

UNREADABLE = 4


def run(*arguments):
    command = [ROOT / "scripts" / "results", *arguments, "--program", PIPELINE]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.fixture(scope="module")
def smoke(tmp_path_factory):
    path = tmp_path_factory.mktemp("results") / "smoke.h5"
    made = pipeline("run", ROOT / "configs" / "smoke.toml", "-o", path, "--quiet", "--set", "timing.repeats=1")
    assert made.returncode == DONE, made.stderr
    return path


def record(label="a", commit="1111111aaaa", mean=100.0, low=99.0, high=101.0, digest="d", machine="here", number=0,
           error=0.5, floor=None, libraries="{}", blocks=()):
    return {"title": "t", "question": ("m", "t"), "record": f"{number}", "date": f"2026-01-0{number + 1}",
            "machine": machine, "commit": commit, "build": "Release", "libraries": libraries, "label": label,
            "algorithm": label, "knobs": "{}", "digest": digest, "error": error, "mean": mean, "low": low, "high": high,
            "floor": floor, "blocks": np.array(blocks, float)}


def changes(*rows):
    return results.changes(pd.DataFrame(rows))


def test_a_record_is_kept_and_a_page_made(smoke, tmp_path):
    made = run(tmp_path / "kept", smoke)
    assert made.returncode == DONE, made.stderr
    path, page = made.stdout.splitlines()
    told = json.load(open(path))
    assert told["digest"] == json.loads(pipeline("show", smoke, "--json").stdout)["digest"]
    assert "which_one" not in told and told["file"] == "smoke.h5"
    one = told["algorithms"][0]
    assert sum(one["blocks_ns"]) == pytest.approx(one["time_mean_ns"] * told["steps"])
    text = open(page).read()
    assert "Errors are the same everywhere" in text and "No machine has results of two commits yet" in text
    assert not re.search(r"(src|href|url)\s*[=(]\s*[\"']?https?:", text)

    # The same result again changes nothing; another commit on another machine is said and drawn.
    before = open(page).read()
    assert run(tmp_path / "kept", smoke).returncode == DONE and open(page).read() == before
    for one in told["algorithms"]:
        build = "7654321 " + one["timed_on"]["build"].partition(" ")[2]
        one["timed_on"] |= {"build": build, "date": "2030-01-01T00:00:00Z"}
        one["blocks_ns"] = []
        one["time_mean_ns"] *= 3
        one["time_mean_low_ns"], one["time_mean_high_ns"] = one["time_mean_ns"] * .99, one["time_mean_ns"] * 1.01
    first = told["algorithms"][0]["label"]
    told["digests"]["/answers/" + first] = "0" * 32
    json.dump(told, open(path.replace(".json", "_later.json"), "w"))
    assert run(tmp_path / "kept").returncode == DONE
    text = open(page).read()
    assert f"The answers of {first} changed between commits" in text and f"{first} from" in text and "7654321" in text


def test_what_is_above_the_noise_is_told():
    quiet = Interval(1, .99, 1.01)
    found = changes(record(floor=quiet), record(commit="2222222", mean=120, low=118, high=122, number=1)).iloc[0]
    assert (found["from"], found["to"], found.time, found.answers) == ("1111111", "2222222", "slower", "same")
    assert found.ratio == pytest.approx(1.2) and found.low < 1.2 < found.high
    assert changes(record(floor=quiet), record(commit="2", mean=80, low=79, high=81, number=1)).time[0] == "faster"
    # Its interval holds 1; the noise floor of a file; runs of the same commit differ by more.
    assert changes(record(floor=quiet), record(commit="2", mean=101, low=95, high=107, number=1)).time[0] == ""
    noisy = Interval(1, .8, 1.1)
    assert changes(record(floor=noisy), record(commit="2", mean=120, low=118, high=122, number=1)).time[0] == ""
    twice = [record(), record(mean=125, low=124, high=126, number=1)]
    assert changes(*twice, record(commit="2", mean=150, low=149, high=151, number=2)).time[0] == ""
    assert changes(*twice, record(commit="2", mean=190, low=189, high=191, number=2)).time[0] == "slower"


def test_without_a_known_noise_no_change_is_claimed():
    table = pd.DataFrame([record(), record(commit="2", mean=120, low=118, high=122, number=1)])
    assert results.changes(table).time[0] == "?" and np.isnan(results.changes(table).noise[0])
    text = results.report(table)
    assert "differ, by 1.2 to 1.2 times; whether that means anything is not known" in text


def test_ratios_come_from_the_same_steps_where_they_can():
    """Steps differ by far more than the two commits: apart nothing can be told, together 5 %."""
    slow = [100, 200, 400, 800, 1600, 3200]
    unlike = dict(mean=1050, low=300, high=3000)
    before = record(**unlike, blocks=slow, floor=Interval(1, .99, 1.01))
    after = record(**unlike, commit="2", number=1, blocks=np.multiply(slow, 1.05))
    found = changes(before, after).iloc[0]
    assert found.time == "slower" and found.ratio == pytest.approx(1.05) and found.low > 1.04
    assert changes(before | {"blocks": np.zeros(0)}, after).time[0] == ""


def test_machines_and_builds_do_not_compare():
    assert changes(record(), record(commit="2", machine="there", mean=200, number=1)).empty
    assert changes(record(), record(commit="2", number=1) | {"build": "Debug"}).empty
    assert changes(record(), record(number=1, mean=200)).empty  # one commit


def test_changed_answers_and_libraries_are_told():
    found = changes(record(libraries='{"cgal": "5.5"}'),
                    record(commit="2", digest="e", error=.25, number=1,
                           libraries='{"cgal": "5.6", "fcl": "0.7"}')).iloc[0]
    assert (found.answers, found["error before"], found.error) == ("changed", .5, .25)
    assert found.libraries == "cgal 5.5 -> 5.6, fcl none -> 0.7"
    told = results.errors(pd.DataFrame([record(), record(commit="2222222", digest="e", error=.25, number=1)])).iloc[0]
    assert told["different answers"] == 2 and told["which"] == "d (0.5) by 1111111; e (0.25) by 2222222"


def test_another_library_is_no_noise_of_the_same_commit():
    """Twice as slow by a new library: said as that, and not what runs of the commit differ by."""
    old, new = '{"fcl": "0.7"}', '{"fcl": "0.8"}'
    quiet = Interval(1, .99, 1.01)
    rows = [record(libraries=old, floor=quiet), record(libraries=new, mean=200, low=198, high=202, number=1)]
    found = changes(*rows).iloc[0]
    assert (found["from"], found["to"], found.time) == ("1111111", "1111111", "slower")
    assert found.libraries == "fcl 0.7 -> 0.8"
    text = results.report(pd.DataFrame(rows))
    assert text.count("fcl 0.7 -&gt; 0.8") >= 2, "it is said, and named below its place in the figure"
    later = changes(*rows, record(commit="2", libraries=new, mean=210, low=208, high=212, number=2)).iloc[1]
    assert later.time == "?" and np.isnan(later.noise), "the two libraries are no two runs of one thing"


def test_methods_without_a_time_have_errors_only():
    table = pd.DataFrame([record(mean=np.nan, low=np.nan, high=np.nan),
                          record(commit="2", mean=np.nan, low=np.nan, high=np.nan, number=1, digest="e")])
    assert results.changes(table).time[0] == "" and results.changes(table).answers[0] == "changed"
    assert results.report(table)


def test_what_is_no_record_is_one_line(tmp_path, smoke):
    made = run(tmp_path / "none")
    assert made.returncode == UNREADABLE and "has no records" in made.stderr
    (tmp_path / "bad" / "host").mkdir(parents=True)
    for text in ("", "[]", "{}", '{"title": 1}', "\0"):
        (tmp_path / "bad" / "host" / "x.json").write_text(text)
        made = run(tmp_path / "bad")
        assert made.returncode == UNREADABLE and len(made.stderr.splitlines()) == 1, made.stderr
        assert "x.json: is no record of a result" in made.stderr
    broken = shutil.copy(smoke, tmp_path / "broken.h5")
    with open(broken, "r+b") as file:
        file.truncate(5000)
    made = run(tmp_path / "new", broken)
    assert made.returncode == UNREADABLE and not (tmp_path / "new").exists()


def test_the_action_s_script_works_as_it_stands(tmp_path):
    """What action.yml runs, in another repository's folder: result, report, records, a failed comparison."""
    action = (ROOT / "action.yml").read_text()
    assert "runner.temp" not in action, "in a container that is the host's folder, and nothing would be kept"
    step = action.split("id: run\n", 1)[1].split("run: |\n", 1)[1].split("\n    - name:")[0]
    shutil.copy(ROOT / "configs" / "smoke.toml", tmp_path)
    tree = tmp_path / "action"
    (tree / "build").mkdir(parents=True)
    (tree / "build" / "pipeline").symlink_to(os.path.abspath(PIPELINE))
    for part in ("scripts", "analysis"):
        (tree / part).symlink_to(ROOT / part)
    env = os.environ | {"GITHUB_ACTION_PATH": str(tree), "CONFIG": "smoke.toml",
                        "out": str(tmp_path / "temp" / "collision-benchmark"), "BASELINE": "", "RECORDS": "",
                        "GITHUB_OUTPUT": str(tmp_path / "output"), "GITHUB_STEP_SUMMARY": str(tmp_path / "summary")}
    command = ["bash", "-eo", "pipefail", "-c", step]
    done = subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True)
    assert done.returncode == DONE, done.stderr
    out = tmp_path / "temp" / "collision-benchmark"
    assert {"result.h5", "report.html", "summary.txt"} <= set(os.listdir(out)) and (out / "records/index.html").exists()
    assert "bounding_sphere" in (tmp_path / "summary").read_text()
    (tmp_path / "baseline.json").write_text("{}")
    shutil.rmtree(out)
    done = subprocess.run(command, cwd=tmp_path, env=env | {"BASELINE": "baseline.json"}, capture_output=True)
    assert done.returncode == UNREADABLE and (out / "report.html").exists()
