"""The built program, run as its users run it."""
import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PIPELINE = os.environ.get("PIPELINE", str(ROOT / "build" / "pipeline"))
DONE, FAILED, USAGE, INPUT, FILE, INTERRUPTED = 0, 1, 2, 3, 4, 130  # exit codes


def pipeline(*arguments, **more):
    return subprocess.run([PIPELINE, *map(str, arguments)], text=True, capture_output=True, timeout=300, **more)


def one_line(run):
    """stderr as the single line that an error must be, but for the word that a shortened run leaves something out."""
    lines = [line for line in run.stderr.strip().splitlines() if " steps leave out " not in line]
    assert len(lines) == 1, run.stderr
    return lines[0]
