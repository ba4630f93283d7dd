"""What the tests in Python share: the built program and a result of it."""

import fcntl
import os
import pathlib
import subprocess
import sys
import tomllib

import pytest
from program import NO_PROGRAMS, ROOT

sys.path.insert(0, str(ROOT))  # for `analysis`


@pytest.fixture(scope="session")
def pipeline():
    """The path of the built program, from the environment variable PIPELINE."""
    path = os.environ.get("PIPELINE")
    if not path:
        pytest.fail("set PIPELINE to the built program, as scripts/test does")
    return path


@pytest.fixture(scope="session")
def result_file(request, tmp_path_factory):
    """A result of configs/smoke.toml; or the file that RESULT_FILE names."""
    if given := os.environ.get("RESULT_FILE"):
        return pathlib.Path(given)
    path = tmp_path_factory.mktemp("smoke") / "smoke.h5"
    command = [request.getfixturevalue("pipeline"), "run", str(ROOT / "configs" / "smoke.toml"), "-o", str(path)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return path


@pytest.fixture(scope="module")
def config(request, tmp_path_factory):
    """The CONFIG of the test's module as a file."""
    path = tmp_path_factory.mktemp("config") / "config.toml"
    path.write_text(request.module.CONFIG)
    return path


@pytest.fixture(scope="module")
def result(pipeline, config):
    """The result of `config`."""
    path = config.with_suffix(".h5")
    subprocess.run([pipeline, "run", config, "-o", path], check=True, stdout=subprocess.DEVNULL)
    return path


# Of the configurations with scenes: every one, few steps of the slow ones, and enough that something meets.
SCENES = [
    path
    for path in sorted((ROOT / "configs").glob("*.toml"))
    if "scene" in tomllib.loads(path.read_text(encoding="utf-8"))
]
STEPS = {"cup": 44, "heap": 44, "kostka": 100, "hriste": 400, "replay_example": None, "padani": 30, "smoke": 40}


@pytest.fixture(scope="session")
def small_file(pipeline, tmp_path_factory):
    """config -> the path of a small result of it, made once, also when several processes test."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent

    def small(config):
        path = folder / f"{config.stem}.h5"
        with open(folder / f"{config.stem}.making", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not path.exists():
                # front_heap has the scene of heap.
                steps = STEPS.get(config.stem, STEPS.get(config.stem.split("_")[-1], 4))
                command = [pipeline, "run", str(config), "-o", str(path), "--quiet", "--set", "timing.repeats=1"]
                subprocess.run(
                    command + (["--set", f"steps={steps}"] if steps else []), check=True, stdout=subprocess.DEVNULL,
                    env=NO_PROGRAMS,
                )
        return path

    return small
