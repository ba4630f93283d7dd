"""Methods in shared libraries: header, examples and table, their answers, and every way in which they go wrong."""

import json
import os
import re
import shutil
import subprocess

import h5py
import pytest
from program import DONE, FAILED, FILE, INPUT, ROOT, USAGE, one_line, pipeline

HEADER = ROOT / "algorithms"
README = (ROOT / "algorithms" / "README.md").read_text(encoding="utf-8")
EXAMPLES = {"c": "bounding_spheres_c", "cpp": "bounding_spheres_cpp", "rs": "bounding_spheres_rust"}
COMPILERS = {"c": "cc", "cpp": "c++", "rs": "rustc"}

# A row of cubes that slide through each other; the last is born at step 5.
CONFIG = """
title = "plug-ins"
{plugins}
[scene]
kind = "replay"
poses = "poses.csv"
{bodies}
[timing]
repeats = 2
[[algorithm]]
name = "bounding_sphere"
{algorithms}
"""


def compiled(source, target, *flags):
    """The shared library `target`."""
    standard = ["-std=c99"] if source.suffix == ".c" else ["-std=c++17"]
    command = [COMPILERS[source.suffix[1:]], *standard, "-O1", "-fPIC", "-shared", "-I", HEADER, *flags]
    subprocess.run([*command, source, "-o", target], check=True)
    return target


def bad_table(folder, *flags):
    return compiled(ROOT / "tests/support/bad_table.c", folder / "libbad.so", *flags)


def configured(folder, plugins=(), algorithms=(), name="config.toml", steps=8):
    path = folder / name
    tables = "\n".join(f'[[plugin]]\npath = "{plugin}"' for plugin in plugins)
    rows = "\n".join("[[algorithm]]\n" + text for text in algorithms)
    bodies = "\n".join(f'[[scene.body]]\nname = "cube_{body}"\nshape = "box"\nsize = [1, 1, 1]' for body in range(5))
    path.write_text(CONFIG.format(plugins=tables, algorithms=rows, bodies=bodies))
    poses = [(step, body) for step in range(steps) for body in range(5) if body < 4 or step >= 5]
    lines = [f"{step},cube_{body},{1.2 * body - 0.01 * step * body},0,0,1,0,0,0" for step, body in poses]
    (folder / "poses.csv").write_text("\n".join(["step,body,px,py,pz,qw,qx,qy,qz", *lines]) + "\n")
    return path


@pytest.fixture(scope="session")
def spheres(tmp_path_factory):
    return compiled(HEADER / "plugin/bounding_spheres.c", tmp_path_factory.mktemp("c") / "libspheres.so", "-lm")


@pytest.fixture(scope="session")
def odd(tmp_path_factory):
    return compiled(ROOT / "tests/support/odd_plugin.cpp", tmp_path_factory.mktemp("odd") / "libodd.so")


# ---- The header and the examples -------------------------------------------------------------------------------------


@pytest.mark.parametrize("compiler", ["cc", "gcc", "clang", "c++", "g++", "clang++"])
def test_the_header_is_clean(compiler, tmp_path):
    if not shutil.which(compiler):
        pytest.skip(f"no {compiler} here")
    plus = compiler.endswith("++")
    source = tmp_path / ("only.cpp" if plus else "only.c")
    source.write_text('#include "plugin.h"\nint nothing;\n')
    for standard in ["c++11", "c++17", "c++20"] if plus else ["c99", "c11"]:
        command = [compiler, f"-std={standard}", "-pedantic", "-Wall", "-Wextra", "-Werror", "-I", HEADER, "-c", source]
        done = subprocess.run([*command, "-o", tmp_path / "only.o"], capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, ""), standard


def test_the_header_needs_no_other_than_the_standards():
    text = (HEADER / "plugin.h").read_text()
    assert re.findall(r"#include (\S+)", text) == ["<stddef.h>", "<stdint.h>"]


@pytest.mark.parametrize("language", EXAMPLES)
def test_examples_are_built_as_they_say_and_listed(language, tmp_path):
    """By the command in the comment at their beginning, word for word."""
    if not shutil.which(COMPILERS[language]):
        pytest.skip(f"no {COMPILERS[language]} here: this example is not built")
    text = (HEADER / "plugin" / f"bounding_spheres.{language}").read_text()
    block = re.search(r"^(?: \*|//) {5}\S.*\n(?:(?: \*|//) {9}.*\n)?", text, re.MULTILINE)[0]
    command = re.sub(r"^(?: \*|//) +", " ", block, flags=re.MULTILINE).replace("\n", " ")
    (tmp_path / "algorithms").symlink_to(HEADER)
    subprocess.run(command, shell=True, check=True, cwd=tmp_path)
    name = EXAMPLES[language]
    run = pipeline("list", "algorithms", "--json", "--plugin", tmp_path / f"lib{name}.so")
    assert run.returncode == DONE, run.stderr
    row, = [row for row in json.loads(run.stdout) if row["name"] == name]
    assert (row["promise"], row["scope"], row["operations_unit"]) == ("conservative", "pair", "distances")
    knob = {"name": "scale", "type": "real", "preset": 1.0, "unit": "1", "least": 1.0, "most": 1000.0}
    assert knob.items() <= row["knobs"][0].items()
    text = pipeline("list", "algorithms", "--plugin", tmp_path / f"lib{name}.so").stdout
    assert f"{name}: balls of the half diagonal" in text and "scale = 1.0  (real: 1 to 1000)" in text


def test_own_rows_are_listed_as_without_plugins(spheres):
    own = json.loads(pipeline("list", "algorithms", "--json").stdout)
    with_plugin = json.loads(pipeline("list", "algorithms", "--json", "--plugin", spheres).stdout)
    assert [row for row in with_plugin if row["name"] != "bounding_spheres_c"] == own and len(with_plugin) > len(own)


# ---- Answers ---------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def answered(spheres, tmp_path_factory):
    """A run with the library named in its configuration, by a path relative to it."""
    folder = tmp_path_factory.mktemp("answered")
    shutil.copy(spheres, folder / "libspheres.so")
    once = 'name = "bounding_spheres_c"'
    config = configured(folder, ["libspheres.so"], [once, once + '\nlabel = "twice"\nscale = 2'])
    run = pipeline("run", config, "-o", folder / "out.h5", "--quiet", cwd=folder.parent)
    assert run.returncode == DONE, run.stderr
    return folder / "out.h5"


def test_answers_are_those_of_the_built_in_method(answered):
    with h5py.File(answered) as file:
        own, mine, twice = (file["answers"][label] for label in ["bounding_sphere", "bounding_spheres_c", "twice"])
        for name in ["pair", "pair_offset"]:
            assert (mine[name][...] == own[name][...]).all()
        assert len(twice["pair"]) > len(mine["pair"]) > 0
        assert mine.attrs["status"] == "complete" and mine.attrs["transport"] == "library"
        assert mine.attrs["precision"] == "double" and mine.attrs["promise"] == "conservative"
        assert json.loads(twice.attrs["knobs"]) == {"scale": 2.0}
        operations = file["results/operations"][...]
        assert (operations[:, 0] == operations[:, 1]).all() and operations.any()
        assert (file["results/time_ns"][:, 1] > 0).all()


def test_heap_is_counted_as_of_own_methods(answered):
    """What both keep for each body, and what the pipeline adds: names, meshes, the list of hits."""
    with h5py.File(answered) as file:
        own, mine = (file["answers"][label].attrs for label in ["bounding_sphere", "bounding_spheres_c"])
        for name in ["memory_bytes", "memory_greatest_bytes"]:
            assert own[name] / 2 <= mine[name] < own[name] + 64 * 1024, name
        assert mine["memory_greatest_bytes"] >= mine["memory_bytes"]
        row = list(file["algorithm"].asstr()[()]).index("bounding_spheres_c")
        assert file["summary/memory_greatest_bytes"][row] == mine["memory_greatest_bytes"]
    shown = re.search(r"^bounding_spheres_c .*", pipeline("show", answered).stdout, re.MULTILINE)[0]
    assert "KiB" in shown


def test_the_hash_of_the_library_stands_in_the_file(answered, spheres):
    digest = subprocess.run(["sha256sum", spheres], capture_output=True, text=True, check=True).stdout.split()[0]
    with h5py.File(answered) as file:
        assert json.loads(file.attrs["inputs_sha256"])["libspheres.so"] == digest
        assert json.loads(file["answers/bounding_spheres_c"].attrs["files_sha256"]) == {"libspheres.so": digest}


def test_detect_adds_a_method_of_a_library(spheres, tmp_path):
    config = configured(tmp_path)
    file = tmp_path / "out.h5"
    assert pipeline("run", config, "-o", file, "--quiet").returncode == DONE
    before = json.loads(pipeline("show", file, "--json").stdout)
    run = pipeline("detect", file, "--plugin", spheres, "--algorithm", "bounding_spheres_c:scale=1.5@wide", "--quiet")
    assert run.returncode == DONE, run.stderr
    with h5py.File(file) as result:
        assert json.loads(result["answers/wide"].attrs["knobs"]) == {"scale": 1.5}
        assert list(json.loads(result["answers/wide"].attrs["files_sha256"])) == [str(spheres)]
        assert str(spheres) in json.loads(result.attrs["inputs_sha256"])
    after = json.loads(pipeline("show", file, "--json").stdout)  # without the library
    assert before["digests"]["/truth"] == after["digests"]["/truth"]


def test_a_file_starts_no_library_by_itself(answered, spheres, tmp_path):
    file = tmp_path / "copy.h5"
    shutil.copy(answered, file)
    run = pipeline("detect", file, "--force", "--quiet")
    assert run.returncode == DONE
    for label, line in zip(["bounding_spheres_c", "twice"], run.stderr.strip().splitlines(), strict=True):
        assert f"algorithm '{label}' is left out: it needs its library" in line
        assert "give it with --plugin (libspheres.so)" in line
    again = pipeline("detect", file, "--force", "--quiet", "--plugin", spheres)
    assert again.returncode == DONE, again.stderr
    with h5py.File(answered) as one, h5py.File(file) as other:
        assert one.attrs["digest"] == other.attrs["digest"]


def test_check_counts_a_method_of_a_library(spheres, tmp_path):
    run = pipeline("check", configured(tmp_path, [spheres], ['name = "bounding_spheres_c"']))
    assert run.returncode == DONE, run.stderr
    assert "bounding_spheres_c" in run.stdout


def test_plugin_options_serve_a_configuration(spheres, tmp_path):
    config = configured(tmp_path, [], ['name = "bounding_spheres_c"'])
    refused = pipeline("check", config)
    assert refused.returncode == INPUT and "bounding_spheres_c" in one_line(refused)
    assert pipeline("check", config, "--plugin", spheres).returncode == DONE
    file = tmp_path / "out.h5"
    run = pipeline("run", config, "--plugin", spheres, "-o", file, "--quiet")
    assert run.returncode == DONE, run.stderr
    with h5py.File(file) as result:
        assert set(json.loads(result.attrs["inputs_sha256"])) == {str(spheres), "poses.csv"}


def test_an_unfinished_run_is_not_resumed_with_another_library(spheres, tmp_path):
    library = tmp_path / "libspheres.so"
    shutil.copy(spheres, library)
    config = configured(tmp_path, ["libspheres.so"], ['name = "bounding_spheres_c"'], steps=5000)
    file = tmp_path / "out.h5"
    command = [os.environ["PIPELINE"], "run", config, "-o", file, "--quiet"]
    run = subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    while run.poll() is None and not list(tmp_path.glob("out.h5.part/truth*")):
        pass
    run.kill()
    run.wait()
    assert (tmp_path / "out.h5.part").is_dir(), "it was too quick to be killed"
    with open(library, "ab") as out:
        out.write(b"more")
    refused = pipeline("run", config, "-o", file, "--quiet")
    assert refused.returncode == FILE
    assert "other input files" in one_line(refused)


def test_the_methods_of_the_readme_work_as_written(tmp_path):
    """Its file and commands, word for word, from an empty folder; on a small motion."""
    code = re.search(r"<!-- mine.c -->\n   ```c\n(.*?)   ```\n", README, re.DOTALL)[1]
    (tmp_path / "mine.c").write_text(re.sub("^   ", "", code, flags=re.MULTILINE))
    (tmp_path / "results").mkdir()
    assert pipeline("run", configured(tmp_path), "-o", tmp_path / "results/padani.h5", "--quiet").returncode == DONE
    folder = tmp_path / "path"
    folder.mkdir()
    (folder / "pipeline").symlink_to(os.environ["PIPELINE"])
    surroundings = {**os.environ, "TREE": str(ROOT), "PATH": f"{folder}:{os.environ['PATH']}"}
    for name in ["build", "ask"]:
        block = re.search(rf"<!-- {name} -->\n((?:       .*\n)+)", README)[1]
        lines = [line.strip() for line in block.splitlines() if "scripts/report" not in line]
        command = ["sh", "-ec", "\n".join(lines)]
        done = subprocess.run(command, cwd=tmp_path, env=surroundings, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "results/padani.h5") as result:
        assert json.loads(result["answers/near"].attrs["knobs"]) == {"reach": 1.9}
        assert result["answers/mine"].attrs["status"] == "complete"


# ---- Tables that break a rule ----------------------------------------------------------------------------------------

BAD_TABLES = {
    "an old version": (["-DABI=0"], "has ABI version 0, must have 1; build it with the plugin.h of this version"),
    "a version from the future": (["-DABI=2"], "has ABI version 2, must have 1; build it with"),
    "no symbol": (["-DOTHER_SYMBOL=collision_plug"], "exports no function collision_plugin; write one"),
    "a NULL table": (["-DGIVES=NULL"], r"collision_plugin\(\) gives NULL; it must give a table"),
    "a NULL row": (["-DNULL_ROW"], "row 2 is NULL; each must be a row"),
    "no rows": (["-DROWS=0"], "row_count must be 1 to 1000, not 0"),
    "an own name": (['-DNAME="aabb"'], "has a row 'aabb', a name that another method has; rename it"),
    "the name of programs": (['-DNAME="program"'], "has a row 'program', a name that another method has; rename it"),
    "twice a name": (['-DSECOND_NAME="plain"'], "two rows are named 'plain'; rename one"),
    "a blank in a name": (
        ['-DNAME="a b"'],
        "row 1: name must be 1 to 64 characters of A-Z a-z 0-9 _ . [+] -, not 'a b'; rename it",
    ),
    "a NULL name": (["-DNAME=NULL"], "row 1: name is NULL; it must be a text"),
    "a promise beyond all": (["-DPROMISE=3"], "row 'plain': promise must be 0 to 2, not 3"),
    "no answer": (["-DANSWER=NULL"], "row 'plain': answer is NULL; it must be a function"),
    "a preset out of range": (
        ['-DKNOB=.name = "far", .unit = "m", .what = "", .type = COLLISION_REAL, .preset = {.real = 3}, .most = 2'],
        "row 'plain': knob 'far': the preset must be between 0 and 2",
    ),
    "a knob called label": (
        ['-DKNOB=.name = "label", .unit = "m", .what = "", .type = COLLISION_REAL'],
        "knob 'label': the name is taken by every algorithm; rename it",
    ),
    "a knob called step_budget": (
        ['-DKNOB=.name = "step_budget", .unit = "m", .what = "", .type = COLLISION_REAL'],
        "knob 'step_budget': the name is taken by every algorithm; rename it",
    ),
    "a knob of no type": (
        ['-DKNOB=.name = "far", .unit = "m", .what = "", .type = 9'],
        "knob 'far': type must be 0 to 3, not 9",
    ),
    "choices of none": (
        ['-DKNOB=.name = "far", .unit = "1", .what = "", .type = COLLISION_CHOICE'],
        "knob 'far': choices is NULL; it must list what is allowed, and end with NULL",
    ),
    "a constructor that aborts": (["-DCONSTRUCTOR=abort()"], "its table cannot be read: aborted"),
    "a constructor that crashes": (["-DCONSTRUCTOR=raise(SIGSEGV)"], "its table cannot be read: crashed by signal 11"),
    "a constructor that ends the process": (["-DCONSTRUCTOR=_exit(0)"], "its table cannot be read"),
    "a constructor that writes to every file": (
        ['-DCONSTRUCTOR=for (int file = 1; file < 9; ++file) if (write(file, "noise", 5)) continue'],
        "its table cannot be read; it must leave files alone that it did not open",
    ),
    "an unknown function": (
        ["-DCONSTRUCTOR=extern void nowhere(void); nowhere()"],
        "cannot be loaded .*nowhere.*; build it",
    ),
}


@pytest.mark.parametrize("case", BAD_TABLES)
def test_a_bad_table_is_one_line(case, tmp_path):
    flags, message = BAD_TABLES[case]
    library = bad_table(tmp_path, *flags)
    run = pipeline("list", "algorithms", "--plugin", library)
    assert (run.returncode, run.stdout) == (INPUT, "")
    line = one_line(run)
    assert line.startswith(f"--plugin: plugin '{library}': ")
    assert re.search(message, line), line


def test_the_right_table_is_right(tmp_path):
    run = pipeline("list", "algorithms", "--plugin", bad_table(tmp_path))
    assert run.returncode == DONE, run.stderr
    assert "plain_2: reports nothing" in run.stdout


def other_processor(path):
    path.write_bytes(path.read_bytes()[:18] + b"\xb7\x00" + path.read_bytes()[20:])


def thirty_two_bits(path):
    content = path.read_bytes()
    path.write_bytes(content[:4] + b"\x01" + content[5:18] + b"\x03\x00" + content[20:])


BAD_FILES = {
    "a text": (lambda path: path.write_text("no library\n" * 9), "is no shared library; build one"),
    "nothing": (lambda path: path.write_bytes(b""), "is no shared library; build one"),
    "half of one": (
        lambda path: path.write_bytes(path.read_bytes()[:3000]),
        "cannot be loaded|its table cannot be read",
    ),
    "for another processor": (other_processor, "is for aarch64, must be for x86-64; build it for this processor"),
    "for 32 bits": (thirty_two_bits, "is for i386, must be for x86-64; build it for this processor"),
    "a program": (lambda path: shutil.copy("/bin/true", path), "cannot be loaded|is no shared library"),
    "an object file": (
        lambda path: compiled(ROOT / "tests/support/bad_table.c", path, "-c", "-no-pie"),
        "is no shared library; link it with -shared",
    ),
    "missing": (lambda path: path.unlink(), "cannot be read .*; name a shared library"),
    "a folder": (lambda path: (path.unlink(), path.mkdir()), "; name a shared library"),
}


@pytest.mark.parametrize("case", BAD_FILES)
def test_what_is_no_library_is_one_line(case, tmp_path, spheres):
    path = tmp_path / "libmine.so"
    shutil.copy(spheres, path)
    make, message = BAD_FILES[case]
    make(path)
    config = configured(tmp_path, ["libmine.so"])
    output = tmp_path / "o.h5"
    for command in [("list", "algorithms", "--plugin", path), ("check", config), ("run", config, "-o", output)]:
        run = pipeline(*command)
        assert (run.returncode, run.stdout) == (INPUT, "")
        assert re.search(message, one_line(run)), run.stderr
    assert one_line(run).startswith(f"{config}:4:8: plugin 'libmine.so': ")
    assert not list(tmp_path.glob("o.h5*")), "nothing half written"


def test_a_library_that_needs_another_is_one_line(tmp_path):
    compiled(ROOT / "tests/support/bad_table.c", tmp_path / "libneeded.so", "-DOTHER_SYMBOL=needed")
    library = bad_table(tmp_path, "-L", tmp_path, "-Wl,--no-as-needed", "-lneeded")
    run = pipeline("list", "algorithms", "--plugin", library)
    assert run.returncode == INPUT
    message = r"cannot be loaded \(libneeded.so: .*; build it for this machine, with all that it needs"
    assert re.search(message, one_line(run))


def test_two_libraries_may_not_share_a_name(spheres, tmp_path):
    shutil.copy(spheres, tmp_path / "libother.so")
    run = pipeline("list", "algorithms", "--plugin", spheres, "--plugin", tmp_path / "libother.so")
    assert run.returncode == INPUT
    assert "has a row 'bounding_spheres_c', a name that another method has; rename it" in one_line(run)
    assert pipeline("list", "algorithms", "--plugin", spheres, "--plugin", spheres).returncode == DONE


def test_plugin_is_an_option_of_those_that_ask_methods():
    assert pipeline("show", "x.h5", "--plugin", "x.so").returncode == USAGE
    assert pipeline("list", "algorithms", "--plugin").returncode == USAGE


KEYS = {
    '[[plugin]]\npth = "x.so"': "unknown key 'plugin.*pth'",
    "[[plugin]]": "missing key 'plugin.*path'",
    "[[plugin]]\npath = 3": "'plugin.0.path' must be text, not 3",
    '[plugin]\npath = "x.so"': "plugin",
}


@pytest.mark.parametrize("text", KEYS)
def test_keys_of_a_plugin_have_rules(text, tmp_path):
    config = configured(tmp_path)
    config.write_text(config.read_text().replace("[scene]", text + "\n[scene]"))
    run = pipeline("check", config)
    assert run.returncode == INPUT
    assert re.search(KEYS[text], one_line(run)), run.stderr


# ---- Knobs by the row's rules, in the words of own methods -----------------------------------------------------------

KNOBS = {
    "integer=101": "'integer' must be between 1 and 100, not 101",
    "integer=1.5": "'integer' must be an integer, not 1.5",
    "real=-1": "'real' must be at least 0, not -1",
    "choice=slo": "'choice' must be one of fast, slow, not \"slo\"; did you mean 'slow'",
    "flag=2": "'flag' must be true or false, not 2",
    "reel=1": "unknown key 'reel'; did you mean 'real'",
}


@pytest.mark.parametrize("setting", KNOBS)
def test_knobs_are_validated_by_the_rows_rules(setting, odd, tmp_path):
    file = tmp_path / "any.h5"
    run = pipeline("detect", file, "--plugin", odd, "--algorithm", "odd_teller:" + setting)
    assert run.returncode == INPUT
    assert KNOBS[setting] in one_line(run)


def test_a_library_is_no_prefilter(spheres, tmp_path):
    config = configured(tmp_path, [spheres], ['name = "obb_triangles"\nprefilter = "bounding_spheres_c"'])
    run = pipeline("check", config)
    assert run.returncode == INPUT
    assert re.search("'algorithm.1.prefilter' must be one of none, .*bounding_spheres_c.*", one_line(run))
    assert "a method of a library answers in a process of its own" in one_line(run)


def test_a_method_that_refuses_its_bodies_is_told_before_the_run(odd, tmp_path):
    config = configured(tmp_path, [odd], ['name = "odd_teller"'])
    run = pipeline("run", config, "-o", tmp_path / "o.h5", "--quiet")
    assert run.returncode == INPUT
    assert "algorithm 'odd_teller': " in one_line(run) and "create failed: flag 1, integer 20" in one_line(run)
    assert not list(tmp_path.glob("o.h5*"))


# ---- Methods that go wrong -------------------------------------------------------------------------------------------

# From the third step on. What is stored as the reason.
FAULTS = {
    "odd_throws": "count let an exception out: thrown on purpose",
    "odd_throws_a_number": "count let an exception out: not a std::exception",
    "odd_fails": "count failed: no more strength",
    "odd_fails_silently": "count failed: it gives no reason",
    "odd_aborts": "aborted.*Assertion `sense > 0' failed",
    "odd_crashes": "signal 11",
    "odd_exits": "it ended with code 0",
    "odd_hangs": "no answer within 1.0 s",
    "odd_leaks": "it aborted",
    "odd_unknown": "pair 0, 4000000: there is no body 4000000",
    "odd_twice": r"it reports the pair \d+, \d+ twice",
    "odd_itself": "it reports the pair 1, 1: a body with itself",
    "odd_backwards": "the smaller number must come first",
    "odd_unborn": r"body \d+ is not there yet",
    "odd_overruns": "pairs in a buffer of",
}
GOOD = ["odd_prints", "odd_good", "odd_uncounted"]


@pytest.fixture(scope="module")
def faults(odd, tmp_path_factory):
    folder = tmp_path_factory.mktemp("faults")
    rows = [f'name = "{name}"\nstep_budget = {1.0 if name == "odd_hangs" else 30.0}\nmemory_budget = 300'
            for name in [*FAULTS, *GOOD]]
    config = configured(folder, [odd], rows)
    run = pipeline("run", config, "-o", folder / "out.h5", "--quiet")
    assert run.returncode == FAILED, run.stderr
    alone = pipeline("run", configured(folder, name="alone.toml"), "-o", folder / "alone.h5", "--quiet")
    assert alone.returncode == DONE
    return run, folder / "out.h5", folder / "alone.h5"


@pytest.mark.parametrize("name", FAULTS)
def test_what_goes_wrong_is_data(name, faults):
    run, file, _ = faults
    with h5py.File(file) as result:
        answers = result["answers"][name]
        assert answers.attrs["status"] == "failed"
        assert answers.attrs["reason"] and re.search(FAULTS[name], answers.attrs["reason"]), answers.attrs["reason"]
        assert answers.attrs["steps_done"] == 2
        assert answers["pair_offset"][2] > 0, "steps before it are kept"
        assert answers["pair_offset"][2] == answers["pair_offset"][-1], "of those after it nothing is known"
    assert name in run.stderr


def test_what_one_that_leaked_held_is_known(faults):
    """64 MiB at a time, of a budget of 300."""
    _, file, _ = faults
    with h5py.File(file) as result:
        assert 64 <= result["answers/odd_leaks"].attrs["memory_greatest_bytes"] / 2**20 <= 300


@pytest.mark.parametrize("name", GOOD)
def test_what_only_looks_odd_is_answered(name, faults):
    _, file, _ = faults
    with h5py.File(file) as result:
        assert result["answers"][name].attrs["status"] == "complete"
        assert result["answers"][name].attrs["version"] == "odd 1"
        steps, pairs = len(result["step"]), result["answers"][name]["pair"]
        assert result["answers"][name].attrs["steps_done"] == steps and len(pairs) > 0
    assert "noise" not in faults[0].stdout


def test_everything_else_is_as_without_them(faults):
    _, file, alone = faults
    with h5py.File(file) as one, h5py.File(alone) as other:
        for group in ["motion", "truth", "answers/bounding_sphere"]:
            assert one[group].attrs["digest"] == other[group].attrs["digest"], group
