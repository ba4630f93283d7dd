"""Answers from elsewhere: exported, answered by a script, imported; and all that a list of answers can have wrong."""

import json
import pathlib
import re
import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest
from editing import seal
from program import DONE, FAILED, FILE, INPUT, ROOT, USAGE, one_line, pipeline

from analysis.load import load

PAGE = (ROOT / "algorithms" / "README.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """A result of few bodies, one of which comes late, with one label."""
    path = tmp_path_factory.mktemp("import") / "smoke.h5"
    run = pipeline("run", ROOT / "configs" / "smoke.toml", "-o", path, "--quiet", "--set", "timing.repeats=1")
    assert run.returncode == DONE, run.stderr
    return path


@pytest.fixture(scope="module")
def script():
    """The ten lines of the page."""
    found = re.search(r"From elsewhere.*?```python\n(.*?)```", PAGE, re.DOTALL)
    assert found and len(found[1].splitlines()) <= 10
    return found[1]


@pytest.fixture
def copy(original, tmp_path):
    return pathlib.Path(shutil.copy(original, tmp_path / "smoke.h5"))


def exported(path, folder):
    run = pipeline("export", path, "--csv", folder)
    assert run.returncode == DONE, run.stderr
    return run.stdout.split()


def digest(path, label):
    return json.loads(pipeline("show", path, "--json").stdout)["digests"][f"/answers/{label}"]


def column(path, label):
    run = load(path)
    return run.summary.loc[label]


def some_answers(path, label="obb_sat"):
    """What a label of the file reports, as rows step, a, b of names."""
    run = load(path)
    names = run.meta["bodies"]
    return [(row.step, names[row.a], names[row.b]) for row in run.pairs(label).itertuples()]


def write(path, rows, head="step,a,b"):
    path.write_text("\n".join([head, *(",".join(map(str, row)) for row in rows)]) + "\n", encoding="utf-8")
    return path


def test_the_page_s_script_answers_as_the_same_method_inside(original, copy, script, tmp_path):
    """Export, ten lines of Python, import: digest for digest what `bounding_sphere` says inside."""
    exported(original, tmp_path / "out")
    subprocess.run([sys.executable, "-c", script], cwd=tmp_path, check=True)
    run = pipeline("import", copy, tmp_path / "answers.csv", "--label", "mine")
    assert run.returncode == DONE, run.stderr
    inside = tmp_path / "inside.h5"
    shutil.copy(original, inside)
    assert pipeline("detect", inside, "--algorithm", "bounding_sphere@mine", "--quiet").returncode == DONE
    assert digest(copy, "mine") == digest(inside, "mine")
    for name in ("hits", "true_positive", "false_positive", "false_negative", "error", "precision", "recall",
                 "matthews"):
        assert column(copy, "mine")[name] == column(inside, "mine")[name], name


def test_every_file_of_an_export_is_named_and_reads_back(original, tmp_path):
    made = exported(original, tmp_path / "out")
    assert {str(path.relative_to(tmp_path / "out")) for path in (tmp_path / "out").rglob("*") if path.is_file()} == {
        str(pathlib.Path(one).relative_to(tmp_path / "out")) for one in made
    }
    with h5py.File(original) as file:
        rows = np.genfromtxt(tmp_path / "out" / "poses.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
        names = list(file["body"].asstr())
        for row in rows[::97]:
            body = names.index(row["body"])
            place = file["motion/position"][row["step"], body]
            np.testing.assert_array_equal([row[c] for c in ("px", "py", "pz")], place)
            np.testing.assert_array_equal([row[c] for c in ("qw", "qx", "qy", "qz")],
                                          file["motion/orientation"][row["step"], body])  # fmt: skip
        for name, mesh in file["meshes"].items():
            lines = (tmp_path / "out" / "meshes" / f"{name}.obj").read_text().split("\n")
            vertices = [[float(x) for x in line.split()[1:]] for line in lines if line.startswith("v ")]
            np.testing.assert_array_equal(vertices, mesh["vertices"])


def test_an_export_refuses_a_folder_with_anything_in_it(original, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine.txt").write_text("mine")
    run = pipeline("export", original, "--csv", tmp_path / "out")
    assert run.returncode == FILE and "is not empty; --force replaces an earlier export" in one_line(run)
    assert pipeline("export", original, "--csv", tmp_path / "out", "--force").returncode == DONE
    assert (tmp_path / "out" / "mine.txt").read_text() == "mine"


@pytest.mark.parametrize("options, words", [
    ([], "--vtk or --csv is required"),
    (["--csv", "x", "--vtk", "y"], "excludes"),
    (["--csv", "x", "--steps", "1:2"], "--steps: is of --vtk"),
    (["--csv", ""], "must name a folder"),
])  # fmt: skip
def test_an_export_is_of_one_kind(original, tmp_path, options, words):
    run = pipeline("export", original, *options, cwd=tmp_path)
    assert run.returncode == USAGE and words in one_line(run)
    assert not list(tmp_path.iterdir())


def test_without_times_there_are_errors_and_no_time(copy, tmp_path):
    write(tmp_path / "a.csv", some_answers(copy))
    run = pipeline("import", copy, tmp_path / "a.csv", "--label", "mine")
    assert run.returncode == DONE, run.stderr
    row, twin = column(copy, "mine"), column(copy, "obb_sat")
    assert row.error == twin.error and row.hits == twin.hits
    for name in row.index:
        assert not name.endswith(("_ns", "_bytes")) or np.isnan(row[name]), name
    known = load(copy).meta["answers"]["mine"]
    assert known["transport"] == "imported" and known["name"] == "mine" and known["status"] == "complete"
    shown = next(line for line in run.stdout.splitlines() if line.startswith("mine "))
    assert " - " in shown
    assert json.loads(pipeline("show", copy, "--json").stdout)["algorithms"][-1]["time_mean_ns"] is None


def test_times_become_those_of_the_label(copy, tmp_path):
    steps = load(copy).meta["steps"]
    write(tmp_path / "a.csv", some_answers(copy))
    write(tmp_path / "t.csv", [(step, 1000 + step) for step in reversed(range(steps))], "step,ns")
    run = pipeline("import", copy, tmp_path / "a.csv", "--label", "mine", "--times", tmp_path / "t.csv")
    assert run.returncode == DONE, run.stderr
    np.testing.assert_array_equal(load(copy).step_times["mine"], 1000 + np.arange(steps))
    assert column(copy, "mine").time_mean_ns == 1000 + (steps - 1) / 2
    with h5py.File(copy) as file:
        files = json.loads(file["answers/mine"].attrs["files_sha256"])
    assert set(files) == {"a.csv", "t.csv"} and all(len(value) == 64 for value in files.values())


def test_times_are_this_machine_s_only_when_the_language_is_said(copy, tmp_path):
    steps = load(copy).meta["steps"]
    write(tmp_path / "a.csv", some_answers(copy))
    write(tmp_path / "t.csv", [(step, 500_000) for step in range(steps)], "step,ns")
    command = ["import", copy, tmp_path / "a.csv", "--times", tmp_path / "t.csv", "--label"]
    assert pipeline(*command, "apart").returncode == DONE
    assert pipeline(*command, "beside", "--language", "Fortran").returncode == DONE
    answers = load(copy).meta["answers"]
    assert answers["beside"]["host"] == answers["obb_sat"]["host"] and answers["beside"]["language"] == "Fortran"
    assert answers["apart"]["host"] == "elsewhere"


def test_promise_and_scope_are_the_user_s_word_and_judged(copy, tmp_path):
    write(tmp_path / "a.csv", [])
    run = pipeline("import", copy, tmp_path / "a.csv", "--label", "silent", "--promise", "conservative",
                   "--scope", "scene")
    assert run.returncode == FAILED and "silent breaks its promise (conservative)" in run.stderr
    assert load(copy).meta["answers"]["silent"]["scope"] == "scene" and not column(copy, "silent").promise_kept


def test_a_label_that_exists_is_refused_without_force(copy, tmp_path):
    write(tmp_path / "a.csv", [])
    before = copy.read_bytes()
    run = pipeline("import", copy, tmp_path / "a.csv", "--label", "obb_sat")
    assert run.returncode == FILE
    assert ("has answers labelled 'obb_sat' already; --force replaces them, or give another label with --label"
            in one_line(run))
    assert copy.read_bytes() == before
    assert pipeline("import", copy, tmp_path / "a.csv", "--label", "obb_sat", "--force").returncode == DONE
    assert column(copy, "obb_sat").hits == 0


BAD = {
    "a step too many": ("120,sphere_0,plate", "step 120 is beyond the last of the result, 119"),
    "an unknown name": ("5,nobody,0", 'there is no body "nobody" in the result'),
    "a missing column": ("5,0", "must have 3 columns, not 2"),
    "a body with itself": ("5,1,1", "with itself; name two bodies"),
    "a number too great": ("5,0,99", 'there is no body "99" in the result'),
    "quotes that are not closed": ('5,"0,1', "there is no body"),
}


@pytest.mark.parametrize("row, words", BAD.values(), ids=BAD)
def test_bad_answers_are_one_line_with_their_place_and_change_nothing(copy, tmp_path, row, words):
    (tmp_path / "a.csv").write_text(f"step,a,b\n{row}\n")
    before, stood = copy.read_bytes(), sorted(tmp_path.iterdir())
    run = pipeline("import", copy, tmp_path / "a.csv", "--label", "mine")
    assert run.returncode == INPUT and run.stdout == ""
    assert one_line(run).startswith(f"{tmp_path / 'a.csv'}:2: ") and words in one_line(run)
    assert copy.read_bytes() == before and sorted(tmp_path.iterdir()) == stood


@pytest.mark.parametrize("content, words", [
    ("", ":1: is empty; it must begin with step,a,b"),
    ("step,a\n", ":1: must be step,a,b"),
    (None, "name a CSV of answers"),
])  # fmt: skip
def test_files_that_are_none_are_refused(copy, tmp_path, content, words):
    if content is not None:
        (tmp_path / "a.csv").write_text(content)
    run = pipeline("import", copy, tmp_path / "a.csv", "--label", "mine")
    assert run.returncode == INPUT and words in one_line(run)


def test_bad_times_and_labels_are_refused(copy, tmp_path):
    write(tmp_path / "a.csv", [])
    write(tmp_path / "t.csv", [(0, 5)], "step,ns")
    before = copy.read_bytes()
    run = pipeline("import", copy, tmp_path / "a.csv", "--label", "mine", "--times", tmp_path / "t.csv")
    assert run.returncode == INPUT and "step 1 has no time" in one_line(run)
    run = pipeline("import", copy, tmp_path / "a.csv", "--label", "my label")
    assert run.returncode == INPUT and "--label: 'my label' must be 1 to 64 characters" in one_line(run)
    assert pipeline("import", copy, tmp_path / "a.csv").returncode == USAGE
    assert copy.read_bytes() == before


def test_byte_order_mark_and_crlf_are_read(copy, tmp_path):
    rows = some_answers(copy)
    text = "\r\n".join(["step,a,b", *(f'{step},"{b}","{a}"' for step, a, b in rows)])
    (tmp_path / "a.csv").write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert pipeline("import", copy, tmp_path / "a.csv", "--label", "mine").returncode == DONE
    assert column(copy, "mine").hits == len(rows)


def test_other_commands_and_pages_take_the_result(copy, tmp_path):
    write(tmp_path / "a.csv", some_answers(copy))
    assert pipeline("import", copy, tmp_path / "a.csv", "--label", "mine").returncode == DONE
    base = tmp_path / "base.json"
    assert pipeline("score", copy, "--against", base, "--write", "--times").returncode == DONE
    run = pipeline("score", copy, "--against", base, "--times")
    assert run.returncode == DONE and "mine: time" not in run.stdout and "obb_sat: time" in run.stdout
    assert pipeline("verify", copy, "--pairs", 100, "--quiet").returncode == DONE
    assert pipeline("export", copy, "--vtk", tmp_path / "vtk", "--steps", "0:1", "--quiet").returncode == DONE
    assert pipeline("detect", copy, "--algorithm", "aabb@more", "--quiet").returncode == DONE
    assert "mine" in load(copy).meta["algorithms"]
    for command in (["report"], ["scene", "--algorithm", "mine"]):
        page = tmp_path / f"{command[0]}.html"
        run = subprocess.run([sys.executable, "-m", "analysis", command[0], str(copy), *command[1:], "-o", str(page)],
                             cwd=ROOT, capture_output=True, text=True)  # fmt: skip
        assert run.returncode == DONE, run.stderr
        assert "mine" in page.read_text(encoding="utf-8")
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    timed = report[report.index('id="error-time-1-1"') :]
    assert "<title>mine:" not in timed[: timed.index("</figure>")]


def test_an_unsealed_result_is_refused_unless_asked(copy, tmp_path):
    write(tmp_path / "a.csv", [])
    with h5py.File(copy, "r+") as file:
        file.attrs["title"] = "changed"
    assert pipeline("import", copy, tmp_path / "a.csv", "--label", "mine").returncode == FILE
    seal(copy)
    assert pipeline("import", copy, tmp_path / "a.csv", "--label", "mine").returncode == DONE
