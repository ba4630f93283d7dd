"""Where the program `pipeline` is."""
import os
import shutil

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
