"""Where the program `pipeline` is, and what it says."""
import os
import shutil
import subprocess

PACKAGE = os.path.dirname(os.path.abspath(__file__))


def default_program():
    """What PIPELINE names; else build/pipeline beside this folder, or bin/pipeline of the prefix that this package is
    installed in (lib/python3/dist-packages); else the first on the PATH. The first of these where there is none."""
    if os.environ.get("PIPELINE"):
        return os.environ["PIPELINE"]
    built = os.path.join(os.path.dirname(PACKAGE), "build", "pipeline")
    installed = os.path.normpath(os.path.join(os.path.realpath(PACKAGE), *[os.pardir] * 4, "bin", "pipeline"))
    there = [path for path in (built, installed) if os.access(path, os.X_OK)]
    return there[0] if there else shutil.which("pipeline") or built


class Refused(Exception):
    """What the user wrote cannot be done; the text is the line to print, code the exit code."""

    def __init__(self, text, code=3):
        super().__init__(text)
        self.code = code


def answered(program, *arguments):
    """The stdout of `program`. Raises Refused, in its last words, when it fails."""
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    if done.returncode:
        raise Refused(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"{arguments[0]} failed")
    return done.stdout
