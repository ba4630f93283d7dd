"""The built program, run as its users run it."""
import json
import os
import subprocess
import time
from pathlib import Path

import h5py
import pytest

ROOT = Path(__file__).resolve().parent.parent
PIPELINE = os.environ.get("PIPELINE", str(ROOT / "build" / "pipeline"))
DONE, FAILED, USAGE, INPUT, FILE, INTERRUPTED = 0, 1, 2, 3, 4, 130  # exit codes


# Programs of others are not found: their labels, where optional, are left out.
NO_PROGRAMS = {**os.environ, "PATH": "/nowhere"}


def pipeline(*arguments, **more):
    return subprocess.run([PIPELINE, *map(str, arguments)], text=True, capture_output=True, timeout=300, **more)


def start(*arguments, **more):
    """The same, not waited for."""
    more = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | more
    return subprocess.Popen([PIPELINE, *map(str, arguments)], text=True, **more)


def wait_for(condition, run=None, seconds=60):
    """Until the condition holds; fails when it does not in time, or before `run` has ended."""
    end = time.monotonic() + seconds
    while time.monotonic() < end and (run is None or run.poll() is None):
        if condition():
            return
        time.sleep(0.002)
    assert condition(), "it did not come to it"


def digest(path):
    with h5py.File(path) as file:
        return file.attrs["digest"]


def skip_without(name):
    """Skips a test whose algorithm is of a library that this build is without, and says what it needs."""
    for row in json.loads(pipeline("list", "algorithms", "--json").stdout):
        if row["name"] == name and "missing" in row:
            pytest.skip(f"{name} needs {row['missing']}")


def one_line(run):
    """stderr as the single line that an error must be, but for the words that a shortened run leaves something out, or
    a build something that its configuration allows it to."""
    said = " steps leave out ", " is left out: it needs "
    lines = [line for line in run.stderr.strip().splitlines() if not any(words in line for words in said)]
    assert len(lines) == 1, run.stderr
    return lines[0]
