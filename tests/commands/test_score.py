"""`pipeline score`: what a baseline holds, what is compared, and what is refused."""
import json
import re
import shutil

import h5py
import pytest
from program import DONE, FAILED, FILE, ROOT, USAGE, one_line, pipeline

BOX = ROOT / "tests" / "data" / "box.h5"


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    path = tmp_path_factory.mktemp("score") / "box.h5"
    shutil.copy(BOX, path)
    more = [f"--algorithm={name}" for name in ("bounding_sphere", "obb_sat", "obb_triangles")]
    assert pipeline("detect", path, *more, "--quiet").returncode == DONE
    return path


@pytest.fixture
def baseline(result, tmp_path):
    path = tmp_path / "box.json"
    assert pipeline("score", result, "--against", path, "--write").returncode == DONE
    return path


def changed(path, change):
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))
    return path


def test_a_baseline_holds_what_the_file_holds(result, baseline):
    recorded = json.loads(baseline.read_text())
    with h5py.File(result) as file:
        assert recorded["motion"] == file["motion"].attrs["digest"]
        assert recorded["truth"]["digest"] == file["truth"].attrs["digest"]
        assert recorded["truth"]["hits"] == int(file["truth/hits"][:].sum())
        labels = list(file["algorithm"].asstr())
        assert sorted(recorded["algorithms"]) == sorted(labels)
        for a, label in enumerate(labels):
            row = recorded["algorithms"][label]
            for name in ("hits", "true_positive", "false_positive", "false_negative", "operations"):
                assert row[name] == file["summary"][name][a]
            assert row["rounding_miss"] == int(file["results/rounding_miss"][:, a].sum())
            assert row["answers"] == file["answers"][label].attrs["digest"]


def test_two_results_are_compared_directly(result, baseline, tmp_path):
    other = shutil.copy(result, tmp_path / "other.h5")
    same = pipeline("score", result, "--against", other)
    assert same.returncode == DONE and f"same as {other}: " in same.stdout
    assert pipeline("detect", other, "--algorithm", "aabb@one_more", "--quiet").returncode == DONE
    unlike = pipeline("score", result, "--against", other)
    assert unlike.returncode == FAILED and "one_more: missing, only in the baseline" in unlike.stdout
    assert one_line(unlike) == f"{result}: differs from {other}"  # and nothing can be recorded in a result
    # As by way of a baseline.
    (tmp_path / "by_way.json").unlink(missing_ok=True)
    assert pipeline("score", other, "--against", tmp_path / "by_way.json", "--write").returncode == DONE
    assert pipeline("score", result, "--against", tmp_path / "by_way.json").stdout == unlike.stdout
    before = other.read_bytes()
    assert pipeline("score", result, "--against", other, "--write").returncode == FILE
    assert other.read_bytes() == before
    (tmp_path / "cut.h5").write_bytes(before[:5000])
    cut = pipeline("score", result, "--against", tmp_path / "cut.h5")
    assert cut.returncode == FILE and "cut.h5" in one_line(cut)


def test_a_baseline_reads_well_in_a_diff(result, baseline):
    text = baseline.read_text()
    assert text == json.dumps(json.loads(text), indent=2, sort_keys=True, ensure_ascii=False) + "\n"
    assert "_ns" not in text and "time" not in text and str(ROOT) not in text
    again = baseline.with_name("again.json")
    assert pipeline("score", result, "--against", again, "--write").returncode == DONE
    assert again.read_text() == text


def test_the_same_is_said(result, baseline):
    run = pipeline("score", result, "--against", baseline)
    assert run.returncode == DONE and run.stderr == "" and run.stdout.startswith("same as ")
    told = json.loads(pipeline("score", result, "--against", baseline, "--json").stdout)
    assert told["same"] and not told["written"] and told["changes"] == [] and told["algorithms"] == 4


def test_what_changed_and_by_how_much(result, baseline):
    def change(content):
        content["algorithms"]["obb_sat"]["false_positive"] += 3
        content["algorithms"]["obb_sat"]["operations"] -= 10
        content["algorithms"]["aabb"]["answers"] = "0" * 32
        content["truth"]["hits"] -= 1
        content["motion"] = "f" * 32
        del content["algorithms"]["bounding_sphere"]
        content["algorithms"]["older"] = content["algorithms"]["aabb"]

    recorded = json.loads(baseline.read_text())
    run = pipeline("score", result, "--against", changed(baseline, change))
    assert run.returncode == FAILED
    lines = run.stdout.splitlines()
    fp, operations = (recorded["algorithms"]["obb_sat"][name] for name in ("false_positive", "operations"))
    assert f"motion: digest ffffffff -> {recorded['motion'][:8]}" in lines
    assert f"truth: hits {recorded['truth']['hits'] - 1} -> {recorded['truth']['hits']} (+1)" in lines
    assert (f"obb_sat: false_positive {fp + 3} -> {fp} (-3), "
            f"operations {operations - 10} -> {operations} (+10)") in lines
    assert f"aabb: answers 00000000 -> {recorded['algorithms']['aabb']['answers'][:8]}" in lines
    assert "bounding_sphere: new, not in the baseline" in lines
    assert "older: missing, only in the baseline" in lines
    assert len(lines) == 6
    assert "--write" in one_line(run)
    told = json.loads(pipeline("score", result, "--against", baseline, "--json").stdout)
    assert told["new"] == ["bounding_sphere"] and told["missing"] == ["older"] and not told["same"]
    assert {"of": "truth", "key": "hits", "before": str(recorded["truth"]["hits"] - 1),
            "now": str(recorded["truth"]["hits"]), "by": 1} in told["changes"]


def test_write_replaces_and_says_what_changed(result, baseline):
    text = baseline.read_text()
    changed(baseline, lambda content: content.update(steps=99))
    run = pipeline("score", result, "--against", baseline, "--write")
    assert run.returncode == DONE
    assert "scene: steps 99 -> 4 (-95)" in run.stdout and "recorded" in run.stdout
    assert baseline.read_text() == text
    stamp = baseline.stat().st_mtime_ns
    assert pipeline("score", result, "--against", baseline, "--write").stdout.startswith("same as ")
    assert baseline.stat().st_mtime_ns == stamp
    assert [path.name for path in baseline.parent.iterdir()] == [baseline.name]


def test_a_changed_result_is_found(baseline, result, tmp_path):
    """Not a changed baseline but changed answers: another algorithm under the same label."""
    other = shutil.copy(result, tmp_path / "other.h5")
    assert pipeline("detect", other, "--algorithm", "rotated_aabb@obb_sat", "--force", "--quiet").returncode == DONE
    run = pipeline("score", other, "--against", baseline)
    assert run.returncode == FAILED and "obb_sat: " in run.stdout
    assert "name obb_sat -> rotated_aabb" in run.stdout and "operations " in run.stdout


# ---- times


def test_times_are_ratios_within_the_run(result, baseline):
    assert "time_ratio" not in baseline.read_text()
    run = pipeline("score", result, "--against", baseline, "--times")
    assert run.returncode == FILE and "--write --times" in one_line(run)
    assert pipeline("score", result, "--against", baseline, "--write", "--times").returncode == DONE
    rows = json.loads(baseline.read_text())["algorithms"]
    with h5py.File(result) as file:
        means = dict(zip(file["algorithm"].asstr(), file["summary/time_mean_ns"][:]))
    values = sorted(means.values())
    median = (values[1] + values[2]) / 2
    for label, row in rows.items():
        assert row["time_ratio"] == pytest.approx(means[label] / median, rel=0.01)
    run = pipeline("score", result, "--against", baseline, "--times", "--tolerance", "1.05")
    assert run.returncode == DONE and len(re.findall(r"x 1\.00\)", run.stdout)) == 4
    # Not looked at unless asked for.
    assert pipeline("score", result, "--against", baseline).stdout.startswith("same as ")


def test_times_fail_only_beyond_a_tolerance_that_was_asked_for(result, baseline):
    assert pipeline("score", result, "--against", baseline, "--write", "--times").returncode == DONE

    def slower(content):
        content["algorithms"]["aabb"]["time_ratio"] /= 100

    changed(baseline, slower)
    run = pipeline("score", result, "--against", baseline, "--times")
    assert run.returncode == DONE and "aabb: time" in run.stdout
    run = pipeline("score", result, "--against", baseline, "--times", "--tolerance", "20", "--json")
    assert run.returncode == FAILED
    assert "aabb" in json.loads(run.stdout)["beyond_tolerance"]


# ---- grammar and files


@pytest.mark.parametrize("arguments", [
    [], ["--against"], ["--tolerance", "2"], ["--times", "--tolerance", "0.5"], ["--times", "--tolerance", "nan"],
])
def test_wrong_arguments(result, baseline, arguments):
    against = ["--against", baseline] if "--tolerance" in arguments else []
    run = pipeline("score", result, *against, *arguments)
    assert run.returncode == USAGE
    one_line(run)


@pytest.mark.parametrize("text, word", [
    ("", "JSON"),
    ("{", "JSON"),
    ("[]", "no baseline"),
    ("{}", "no baseline"),
    ('{"kind": 3}', "no baseline"),
    (b"\xff\xfe\x00", "JSON"),
    pytest.param("[" * 100_000, "JSON", id="deep"),
])
def test_files_that_are_no_baselines(result, tmp_path, text, word):
    path = tmp_path / "b.json"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    content = path.read_bytes()
    for write in ([], ["--write"]):
        run = pipeline("score", result, "--against", path, *write)
        assert run.returncode == FILE and run.stdout == ""
        assert word in one_line(run)
        assert path.read_bytes() == content


@pytest.mark.parametrize("change, word", [
    (lambda c: c.update(schema_version=2), "schema 2"),
    (lambda c: c.update(schema_version="1"), "schema"),
    (lambda c: c.pop("schema_version"), "schema"),
    (lambda c: c.update(steps="4"), "steps"),
    (lambda c: c.pop("motion"), "motion"),
    (lambda c: c.update(truth=[]), "truth"),
    (lambda c: c["truth"].update(hits=-1), "truth.hits"),
    (lambda c: c.update(algorithms=[]), "algorithms"),
    (lambda c: c["algorithms"].update(aabb=3), "aabb"),
    (lambda c: c["algorithms"]["aabb"].update(hits=1.5), "aabb.hits"),
    (lambda c: c["algorithms"]["aabb"].update(answers=None), "aabb.answers"),
    (lambda c: c["algorithms"]["aabb"].pop("operations"), "operations"),
    (lambda c: c["algorithms"]["aabb"].update(time_ratio=0), "aabb.time_ratio"),
])
def test_baselines_of_another_form(result, baseline, change, word):
    run = pipeline("score", result, "--against", changed(baseline, change))
    assert run.returncode == FILE and run.stdout == ""
    assert word in one_line(run)


def test_files_that_are_not_there(result, baseline, tmp_path):
    run = pipeline("score", result, "--against", tmp_path / "none.json")
    assert run.returncode == FILE and "--write" in one_line(run)
    assert pipeline("score", result, "--against", tmp_path).returncode == FILE
    (tmp_path / "x.h5.part").mkdir()
    run = pipeline("score", tmp_path / "x.h5.part", "--against", baseline)
    assert run.returncode == FILE and "unfinished run" in one_line(run)
    for file in (tmp_path / "none.h5", baseline):
        run = pipeline("score", file, "--against", baseline)
        assert run.returncode == FILE
        one_line(run)
    run = pipeline("score", result, "--against", "/dev/null/x.json", "--write")
    assert run.returncode == FILE
    one_line(run)
