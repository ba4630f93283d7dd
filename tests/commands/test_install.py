"""The program as installed: found by its own place, read-only, with blanks in paths, without a tree."""
import os
import re
import shutil
import subprocess
import tomllib

import h5py
import pytest
from program import DONE, INPUT, PIPELINE, ROOT, pipeline

PYTHON = "/usr/bin/python3"
CLEAN = {"PATH": "/usr/bin:/bin", "HOME": "/nonexistent", "LC_ALL": "C.UTF-8", "MPLCONFIGDIR": "/tmp",
         "PYTHONDONTWRITEBYTECODE": "1"}


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    """Installed, moved to where nobody configured it, and read-only."""
    if not (ROOT / "build" / "cmake_install.cmake").is_file():
        pytest.skip("the program was built elsewhere")
    first = tmp_path_factory.mktemp("first") / "p"
    done = subprocess.run(["cmake", "--install", ROOT / "build", "--prefix", first], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    moved = tmp_path_factory.mktemp("second") / "a prefix"
    shutil.move(first, moved)
    subprocess.run(["chmod", "-R", "a-w", moved], check=True)
    yield moved
    subprocess.run(["chmod", "-R", "u+w", moved], check=True)


def installed(prefix, command, *arguments, cwd):
    return subprocess.run([prefix / "bin" / command, *map(str, arguments)], cwd=cwd, env=CLEAN, capture_output=True,
                          text=True, timeout=300)


@pytest.fixture(scope="module")
def result(prefix, tmp_path_factory):
    folder = tmp_path_factory.mktemp("any folder")
    run = installed(prefix, "pipeline", "run", "smoke", "--quiet", "--set", "timing.repeats=1", cwd=folder)
    assert run.returncode == DONE, run.stderr
    return folder / "results" / "smoke.h5"


def test_a_configuration_is_known_by_its_name(prefix, result):
    with h5py.File(result) as file:
        text = (ROOT / "configs" / "smoke.toml").read_text()
        assert file["config"].asstr()[()] == text
    # With files beside it, and only where no file of the user has that name.
    checked = installed(prefix, "pipeline", "check", "replay_example.toml", cwd=result.parent)
    assert checked.returncode == DONE, checked.stderr
    own = result.parent / "smoke"
    own.write_text("no = 1\n")
    refused = installed(prefix, "pipeline", "check", "smoke", cwd=result.parent)
    assert refused.returncode == INPUT and refused.stderr.startswith("smoke:1:1: unknown key 'no'")
    own.unlink()
    assert installed(prefix, "pipeline", "check", "none_such", cwd=result.parent).returncode == INPUT


def test_nothing_of_the_tree_is_named(prefix):
    tree = str(ROOT).encode()
    for path in prefix.rglob("*"):
        if path.is_file() and (path.suffix in {".cmake", ".pc", ".py", ".1", ""} or path.name == "pipeline"):
            assert tree not in path.read_bytes(), path


def test_results_are_read_by_the_installed_python(prefix, result):
    code = ("import sys; sys.path.insert(0, sys.argv[1]); from collision_analysis.load import load; "
            "run = load(sys.argv[2]); print(len(run.summary), 'analysis' in sys.modules)")
    packages = prefix / "lib/python3/dist-packages"
    done = subprocess.run([PYTHON, "-c", code, packages, result], cwd="/", env=CLEAN, capture_output=True, text=True)
    with h5py.File(result) as file:
        assert done.stdout.split() == [str(len(file["algorithm"])), "False"], done.stderr
    by_name = subprocess.run([PYTHON, "-m", "collision_analysis", "--help"], cwd="/", capture_output=True, text=True,
                             env={**CLEAN, "PYTHONPATH": str(packages)})
    assert by_name.returncode == DONE, by_name.stderr
    in_tree = subprocess.run([PYTHON, "-m", "analysis", "--help"], cwd=ROOT, env=CLEAN, capture_output=True, text=True)
    assert in_tree.returncode == DONE, in_tree.stderr


def test_a_report_is_made_by_the_installed_scripts(prefix, result):
    done = installed(prefix, "collision-analysis", "report", result, "-o", "page.html", cwd=result.parent)
    assert done.returncode == DONE, done.stderr
    assert "<svg" in (result.parent / "page.html").read_text()
    kept = installed(prefix, "collision-analysis", "results", "records", result, cwd=result.parent)
    assert kept.returncode == DONE, kept.stderr  # which asks the installed program
    assert (result.parent / "records" / "index.html").is_file()


def test_places_are_those_of_the_prefix(prefix):
    said = installed(prefix, "pipeline", "describe", "places", cwd="/").stdout
    places = dict(re.split(r"\s{2,}", line, maxsplit=1) for line in said.splitlines())
    share = prefix / "share" / "collision_benchmark"
    assert places == {"configs": f"{share}/configs", "adapters": f"{share}/algorithms/program",
                      "examples": f"{share}/algorithms/plugin", "engines": f"{share}/algorithms/peers/web"}
    assert (share / "algorithms/program/collision_program.py").is_file()


def test_a_plugin_is_built_with_the_installed_header(prefix, tmp_path):
    if shutil.which("cc") is None or shutil.which("pkg-config") is None:
        pytest.skip("no C compiler or pkg-config here")
    source = ROOT / "algorithms/plugin/bounding_spheres.c"
    flags = subprocess.run(["pkg-config", "--cflags", "collision_benchmark"], capture_output=True, text=True,
                           check=True, env={**os.environ, "PKG_CONFIG_PATH": str(prefix / "share/pkgconfig")}).stdout
    assert f"{prefix}/".replace(" ", "\\ ") in flags or str(prefix) in flags
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.25)\nproject(mine C)\nfind_package(collision_benchmark 0.1 REQUIRED)\n"
        f"add_library(mine MODULE {source})\ntarget_link_libraries(mine collision_benchmark::plugin m)\n")
    configure = ["cmake", "-S", ".", "-B", "b", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}"]
    for command in (configure, ["ninja", "-C", "b"]):
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
    listed = installed(prefix, "pipeline", "list", "algorithms", "--plugin", tmp_path / "b/libmine.so", cwd=tmp_path)
    assert listed.returncode == DONE and "spheres" in listed.stdout, listed.stderr


def commit_said(tree, out):
    done = subprocess.run(["cmake", f"-DSOURCE={tree}", f"-DOUTPUT={out}", "-DVERSION=1", "-P",
                           tree / "pipeline/build_info.cmake"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return re.search(r'BUILD_GIT_COMMIT "(.*)"', out.read_text())[1]


def test_an_archive_knows_its_commit_and_no_other(tmp_path):
    if not (ROOT / ".git").exists():
        pytest.skip("this tree is no repository")
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b", "-C"]
    head = subprocess.run([*git, ROOT, "rev-parse", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()
    assert commit_said(ROOT, tmp_path / "own").removesuffix("-dirty") == head
    # Within a repository of somebody else.
    subprocess.run([*git, tmp_path, "init", "-q"], check=True)
    subprocess.run([*git, tmp_path, "commit", "-q", "--allow-empty", "-m", "theirs"], check=True)
    copy = tmp_path / "a copy"
    copy.mkdir()
    archive = subprocess.run([*git, ROOT, "archive", "HEAD", "pipeline/build_info.cmake", ".gitattributes"], check=True,
                             capture_output=True).stdout
    subprocess.run(["tar", "-x", "-C", copy], input=archive, check=True)
    assert commit_said(copy, tmp_path / "archived") == f"{head}-archived"
    shutil.copy(ROOT / "pipeline/build_info.cmake", copy / "pipeline")  # copied as it is, without .git
    assert commit_said(copy, tmp_path / "copied") == "unknown"


# ---- the manual page and completion


def help_of(*words):
    return pipeline(*words, "--help").stdout


def commands():
    return [line.split()[0] for line in help_of().split("Subcommands:")[1].splitlines() if line.startswith("  ")
            and not line.startswith("   ")]


def test_the_manual_page_has_every_command_and_option(tmp_path):
    page = tmp_path / "pipeline.1"
    page.write_text(pipeline("describe", "man").stdout)
    text = page.read_text().replace("\\-", "-")
    assert len(commands()) >= 10
    for command in commands():
        assert f".SS {command}\n" in text
        for option in set(re.findall(r"--[a-z][a-z-]+", help_of(command))):
            assert option in text, (command, option)
    if shutil.which("man") and shutil.which("groff"):
        said = subprocess.run(["groff", "-man", "-ww", "-Tutf8", "-z", page], capture_output=True, text=True)
        assert said.stderr == ""


def completed(line, tmp_path):
    """What bash offers for the last word of `line`."""
    script = tmp_path / "completion"
    script.write_text(pipeline("describe", "bash").stdout)
    words = line.split(" ")
    quoted = " ".join(f"'{word}'" for word in words)
    code = (f'compopt() {{ :; }}; . "{script}"; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _pipeline; '
            'printf "%s\\n" "${COMPREPLY[@]}"')
    env = {**os.environ, "PATH": f"{os.path.dirname(PIPELINE)}:{os.environ['PATH']}"}
    done = subprocess.run(["bash", "-c", code], cwd=tmp_path, env=env, capture_output=True, text=True)
    assert done.stderr == ""
    return done.stdout.split()


def test_bash_completes_commands_options_names_and_labels(tmp_path, result_file):
    assert set(completed("pipeline ", tmp_path)) >= set(commands())
    assert completed("pipeline ver", tmp_path) == ["verify"]
    assert completed("pipeline run --qu", tmp_path) == ["--quiet"]
    assert "padani" in completed("pipeline run pad", tmp_path)
    assert "padani" in completed("pipeline check --set a=1 pad", tmp_path)
    assert completed("pipeline detect x.h5 --algorithm obb_s", tmp_path) == ["obb_sat"]
    assert "integrators" in completed("pipeline list int", tmp_path)
    (tmp_path / "data.h5").write_text("")
    assert completed("pipeline show da", tmp_path) == ["data.h5"]
    with h5py.File(result_file) as file:
        labels = list(file["algorithm"].asstr()[()])
    assert pipeline("describe", "labels", result_file).stdout.split() == labels


def test_zsh_completion_is_well_formed(tmp_path):
    text = pipeline("describe", "zsh").stdout
    assert text.startswith("#compdef pipeline\n")
    for command in commands():
        assert f"    {command})" in text
    if shutil.which("zsh") is None:
        pytest.skip("zsh is not here to parse it")
    (tmp_path / "_pipeline").write_text(text)
    assert subprocess.run(["zsh", "-n", tmp_path / "_pipeline"], capture_output=True, text=True).stderr == ""


# ---- the Python package


def test_pyproject_names_every_folder_of_the_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    folders = {path.parent for path in (ROOT / "analysis").rglob("__init__.py")}
    expected = {".".join(["collision_analysis", *path.relative_to(ROOT / "analysis").parts]) for path in folders}
    assert set(project["tool"]["setuptools"]["packages"]) == expected
    version = re.search(r"project\(collision_benchmark VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]
    assert project["project"]["version"] == version
    data = project["tool"]["setuptools"]["package-data"]
    for path in (ROOT / "analysis").rglob("*"):
        if path.is_file() and path.suffix not in {".py", ".pyc", ".md", ".svg", ".png"}:
            package = ".".join(["collision_analysis", *path.parent.relative_to(ROOT / "analysis").parts])
            assert any(path.match(pattern) for pattern in data.get(package, [])), path


def test_the_package_names_itself_by_no_name():
    for path in (ROOT / "analysis").rglob("*.py"):
        wrong = re.search(r"^ *(from|import) analysis\b.*", path.read_text(), re.M)
        assert wrong is None, f"{path}: {wrong[0]}: it has another name where it is installed; from . import"
