#!/usr/bin/env python3
"""The recorded answers of small motions of all scenes: compared by tests/commands/test_baselines.py, made by

    tests/baselines.py --write [NAME...]

NAME.toml in tests/baselines says what is moved, NAME.json what was answered (`pipeline score`). The motions are files
of tests/data, scripts or a CSV, so no simulation has a part in it and every machine must find the same. Every algorithm
of `pipeline list algorithms` is asked with its presets, except those of other people's libraries: their answers and
operations may change with the library's version.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "tests" / "baselines"
PIPELINE = os.environ.get("PIPELINE", str(ROOT / "build" / "pipeline"))


def names():
    """The scenes, sorted."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def algorithms():
    """The names of all algorithms of this project's own."""
    listed = subprocess.run([PIPELINE, "list", "algorithms", "--json"], check=True, capture_output=True, text=True)
    return [row["name"] for row in json.loads(listed.stdout) if not row["library"]]


def answer(name, out):
    """Runs NAME.toml with all algorithms into the file `out`."""
    text = (FOLDER / f"{name}.toml").read_text()
    text += "".join(f'\n[[algorithm]]\nname = "{algorithm}"\n' for algorithm in algorithms())
    # Beside the others, because paths are relative to the configuration.
    with tempfile.NamedTemporaryFile("w", dir=FOLDER, prefix=f".{name}-", suffix=".toml") as config:
        config.write(text)
        config.flush()
        subprocess.run([PIPELINE, "run", config.name, "-o", str(out), "--quiet"], check=True, stdout=subprocess.DEVNULL)


def score(name, result, *arguments):
    """`pipeline score` of a result against NAME.json."""
    command = [PIPELINE, "score", str(result), "--against", str(FOLDER / f"{name}.json"), *arguments]
    return subprocess.run(command, capture_output=True, text=True)


def main():
    parser = argparse.ArgumentParser(description="Compare recorded answers with this build's, or record them.")
    parser.add_argument("name", nargs="*", help="scenes; all when none is named")
    parser.add_argument("--write", action="store_true", help="record")
    arguments = parser.parse_args()
    if unknown := set(arguments.name) - set(names()):
        parser.error(f"no such scene: {', '.join(sorted(unknown))}; known: {', '.join(names())}")
    worst = 0
    for name in arguments.name or names():
        with tempfile.TemporaryDirectory() as folder:
            result = Path(folder) / f"{name}.h5"
            answer(name, result)
            scored = score(name, result, *(["--write"] if arguments.write else []))
        print(f"{name}\n{scored.stdout}{scored.stderr}", end="")
        worst = max(worst, scored.returncode)
    return worst


if __name__ == "__main__":
    sys.exit(main())
