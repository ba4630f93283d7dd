"""What the tests in Python share: the built program and a result of it."""

import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
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
