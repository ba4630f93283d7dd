"""The scripts: they find the right python3, say what they take and build nothing, notice a build/ of other sources."""

import os
import re
import shutil
import stat
import subprocess

import pytest
from conftest import ROOT, SCENES
from program import DONE, FAILED

README = "".join(page.read_text(encoding="utf-8") for page in [ROOT / "README.md", *sorted(ROOT.glob("*/*.md"))])
# Commands of README and the pages in code blocks and between backticks that run Python.
COMMANDS = sorted(
    {
        re.split(r"  +", line)[0].strip()
        for line in re.findall(r"^ {4,}(scripts/.*)$", README, re.M) + re.findall(r"`(scripts/[^`]* [^`]*)`", README)
        if re.match(r"scripts/(python|analysis|report) [^|]*$", line) and "..." not in line
    }
)
SWEEP = """{"sweep": "%s", "title": "A sweep", "parameters": ["seed"], "points": [
    {"name": "seed=1", "parameters": {"seed": 1}, "status": "failed", "reason": "so it is"}]}"""
SMALLER = {"--step 65": "--step 9", "tests/baselines.py --write": f"{ROOT}/tests/baselines.py --help"}


def program(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("#!/bin/bash\n" + text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)


@pytest.fixture
def elsewhere(tmp_path):
    """A folder that is not the project's, and an environment in which `python3` is one without any library."""
    program(tmp_path / "bin" / "python3", "echo 'ModuleNotFoundError: numpy' >&2; exit 1\n")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment["PATH"] = f"{tmp_path / 'bin'}:{environment['PATH']}"
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    return folder, environment


def run(command, folder, environment):
    return subprocess.run(
        ["bash", "-c", command], cwd=folder, env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL
    )


def test_readme_has_commands_of_every_kind():
    for words in ("report", "analysis scene", "analysis statements", "analysis study", "python tests/baselines.py"):
        assert any(command.startswith(f"scripts/{words}") for command in COMMANDS), words
    assert "/usr/bin/python3" not in README and "python3 -m analysis" not in README


@pytest.mark.parametrize("command", COMMANDS)
def test_the_commands_of_readme_run_from_any_folder_whatever_python3_is_first(command, elsewhere, small_file, pipeline):
    folder, environment = elsewhere
    (folder / "results").mkdir()
    for name in re.findall(r"results/(\w+)\.h5", command):
        config, result = ROOT / "configs" / f"{name}.toml", folder / "results" / f"{name}.h5"
        if config in SCENES:
            shutil.copy(small_file(config), result)
        else:  # a study
            few = ["--set", "every=97", "--set", "budget.force_evaluations=2000"]
            subprocess.run([pipeline, "run", config, "-o", result, *few], check=True, capture_output=True)
    for name in re.findall(r"results/(\w+)(?= |$)", command):
        (folder / "results" / name).mkdir()
        (folder / "results" / name / "sweep.json").write_text(SWEEP % name)
    for long, short in SMALLER.items():
        command = command.replace(long, short)
    (folder / "csv.py").write_text("raise SystemExit('not the one of Python')\n")
    done = run(f"{ROOT}/{command}", folder, environment)
    assert done.returncode == DONE, done.stderr
    if " -o " in command:
        assert (folder / command.split(" -o ")[1]).is_file()


def test_load_works_in_the_scripts_python_from_any_folder(elsewhere, result_file):
    folder, environment = elsewhere
    words = f"from analysis.load import load; print(load('{result_file}').summary.index[0])"
    done = run(f'{ROOT}/scripts/python -c "{words}"', folder, environment)
    assert done.stdout.strip() == "bounding_sphere", done.stderr


def test_without_a_fit_python3_it_is_said(tmp_path):
    program(tmp_path / "scripts" / "python", (ROOT / "scripts" / "python").read_text().replace("/usr/bin/python3", ""))
    program(tmp_path / "bin" / "python3", "exit 1\n")
    done = run(f"{tmp_path}/scripts/python -c 0", tmp_path, os.environ | {"PATH": f"{tmp_path / 'bin'}:/usr/bin:/bin"})
    assert done.returncode == FAILED and "scripts/setup installs them" in done.stderr


@pytest.mark.parametrize("script", ["run", "setup", "install", "peers", "report", "sweep", "test", "bench", "arrows",
                                    "style", "fuzz", "tsan"])
def test_help_is_given_without_a_build_whatever_python3_is_first(script, tmp_path, elsewhere):
    shutil.copytree(ROOT / "scripts", tmp_path / "scripts")
    shutil.copytree(ROOT / "analysis", tmp_path / "analysis")
    done = run(f"{tmp_path}/scripts/{script} --help", *elsewhere)
    assert done.returncode == DONE, done.stderr
    assert f"scripts/{script}" in done.stdout or "scripts/analysis report" in done.stdout
    assert not (tmp_path / "build").exists()


# ---- scripts/setup and a build/ that came with its folder


@pytest.fixture
def checkout(tmp_path):
    """A folder with scripts/setup, whose cmake makes what setup looks at, and whose cmake and ninja only say where they
    were called."""
    bin = tmp_path / "bin"
    program(bin / "dpkg-query", "echo -n installed\n")
    program(bin / "ninja", 'echo "ninja in $PWD, sources $(sed -n s/^CMAKE_HOME_DIRECTORY:INTERNAL=//p '
                           'build/CMakeCache.txt)"\n')
    program(bin / "cmake", 'mkdir -p build/CMakeFiles; echo "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" > '
                           'build/CMakeCache.txt\n'
                           'touch build/build.ninja; echo "cmake" >> calls\n')  # fmt: skip
    shutil.copytree(ROOT / "scripts", tmp_path / "first" / "scripts")
    environment = os.environ | {"PATH": f"{bin}:{os.environ['PATH']}"}

    def setup(folder):
        done = run("scripts/setup pipeline", tmp_path / folder, environment)
        assert done.returncode == DONE, done.stderr
        return done

    return tmp_path, setup


def configured(folder):
    return (folder / "calls").read_text().count("cmake")


def test_setup_configures_once(checkout):
    root, setup = checkout
    setup("first")
    again = setup("first")
    assert configured(root / "first") == 1 and again.stderr == ""
    (root / "link").symlink_to(root / "first")  # the same folder by another name
    assert setup("link").stderr == "" and configured(root / "first") == 1


@pytest.mark.parametrize("how", ["copied", "moved"])
def test_a_build_folder_that_came_along_is_configured_anew_and_said(checkout, how):
    root, setup = checkout
    setup("first")
    (shutil.copytree if how == "copied" else shutil.move)(root / "first", root / "second")
    done = setup("second")
    assert f"was made from the sources in {root / 'first'}, not from these" in done.stderr
    assert f"sources {root / 'second'}" in done.stdout and "first" not in done.stdout
    assert configured(root / "second") == 2
    assert (root / "first").exists() == (how == "copied"), "nothing is made in the folder that was"
    assert setup("second").stderr == "" and configured(root / "second") == 2
