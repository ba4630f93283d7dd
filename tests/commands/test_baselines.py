"""Recorded motions answered again: every count, every operation and every digest is what tests/baselines says."""
import json
import shutil
import subprocess
import sys

import pytest

import baselines
from baselines import FOLDER, PIPELINE, ROOT


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Made when asked for: the result of a scene."""
    made = {}

    def of(name):
        if name not in made:
            made[name] = tmp_path_factory.mktemp("baselines") / f"{name}.h5"
            baselines.answer(name, made[name])
        return made[name]

    return of


@pytest.mark.parametrize("name", baselines.names())
def test_answers_are_those_of_the_baseline(results, name):
    scored = baselines.score(name, results(name))
    assert scored.returncode == 0, (
        f"{scored.stdout}{scored.stderr}"
        "If the change is meant, `scripts/python tests/baselines.py --write` records it; commit it together with its "
        "reason."
    )


def test_every_kind_of_scene_has_a_baseline():
    kinds = subprocess.run([PIPELINE, "list", "scenes", "--json"], capture_output=True, text=True, check=True)
    assert {row["name"] for row in json.loads(kinds.stdout)} <= set(baselines.names())


@pytest.mark.parametrize("name", baselines.names())
def test_every_own_algorithm_is_in_the_baseline(name):
    assert set(json.loads((FOLDER / f"{name}.json").read_text())["algorithms"]) == set(baselines.algorithms())


def test_baselines_are_worth_comparing():
    """Both answers, and wrong ones, in every scene; else nothing could change."""
    for name in baselines.names():
        baseline = json.loads((FOLDER / f"{name}.json").read_text())
        assert baseline["truth"]["hits"] > 0
        assert any(row["false_positive"] > 0 for row in baseline["algorithms"].values()), name


@pytest.mark.parametrize("change, line", [
    (lambda rows: rows["obb_sat"].update(false_positive=rows["obb_sat"]["false_positive"] - 2),
     "obb_sat: false_positive"),
    (lambda rows: rows["cannon_sap"].update(operations=7), "cannon_sap: operations 7 -> "),
    (lambda rows: rows.pop("aabb"), "aabb: new, not in the baseline"),
    (lambda rows: rows.update(older=rows["aabb"]), "older: missing, only in the baseline"),
])
def test_a_changed_answer_fails_the_comparison_and_is_named(results, tmp_path, change, line):
    baseline = json.loads((FOLDER / "replay.json").read_text())
    change(baseline["algorithms"])
    perturbed = tmp_path / "replay.json"
    perturbed.write_text(json.dumps(baseline))
    scored = subprocess.run([PIPELINE, "score", str(results("replay")), "--against", str(perturbed)],
                            capture_output=True, text=True)
    assert scored.returncode == 1
    assert scored.stdout.startswith(line), scored.stdout
    assert len(scored.stdout.splitlines()) == 1
    assert len(scored.stderr.splitlines()) == 1 and "--write" in scored.stderr


def test_the_command_that_records_and_compares(tmp_path):
    """As documented, on a copy: a changed baseline fails, --write mends it."""
    copy = tmp_path / "tests"
    (copy / "baselines").mkdir(parents=True)
    shutil.copy(ROOT / "tests" / "baselines.py", copy)
    shutil.copytree(ROOT / "tests" / "data", copy / "data")
    shutil.copy(FOLDER / "box.toml", copy / "baselines")
    original = (FOLDER / "box.json").read_text()
    kept = copy / "baselines" / "box.json"
    kept.write_text(original.replace('"steps": 4', '"steps": 5'))

    def command(*arguments):
        run = [sys.executable, str(copy / "baselines.py"), *arguments]
        return subprocess.run(run, capture_output=True, text=True, env={"PIPELINE": PIPELINE, "PATH": "/usr/bin:/bin"})

    failed = command("box")
    assert failed.returncode == 1 and "scene: steps 5 -> 4 (-1)" in failed.stdout, failed.stdout + failed.stderr
    assert command("--write").returncode == 0
    assert kept.read_text() == original
    assert command().returncode == 0
    assert command("bux").returncode == 2
