"""Sweeps: names, tables, what is repeated, and what is said when something is wrong."""

import csv
import itertools
import json
import os
import re
import shutil
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
from conftest import ROOT
from program import DONE, FAILED, FILE, INPUT, INTERRUPTED, PIPELINE, USAGE

from analysis.load import load, load_sweep
from analysis.sweep import plan
from analysis.sweep.__main__ import Job
from analysis.sweep.plan import Refused, point_name, points, read, toml, value_text

SMALL = """title = "Small"
config = "small.toml"
[set]
steps = 3
scene.jitter = 0.05
timing.repeats = 1
"""

needs_snakemake = pytest.mark.skipif(not shutil.which("snakemake"), reason="scripts/peers sweep installs Snakemake")


@pytest.fixture
def folder(tmp_path):
    shutil.copy(ROOT / "configs" / "smoke.toml", tmp_path / "small.toml")
    return tmp_path


def written(folder, text, name="s.toml"):
    (folder / name).write_text(text)
    return folder / name


def sweep(folder, *options, name="s.toml", environment=None):
    command = [ROOT / "scripts" / "sweep", folder / name, "-o", folder / "out", *options]
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=300,
                          env=os.environ | {"PIPELINE": PIPELINE} | (environment or {}))  # fmt: skip


def manifest(folder):
    return {point["name"]: point for point in json.loads((folder / "out" / "sweep.json").read_text())["points"]}


def starts(folder):
    return {name: point.get("began") for name, point in manifest(folder).items()}


def one_line(done):
    lines = done.stderr.strip().splitlines()
    assert len(lines) == 1, done.stderr
    return lines[0]


# ---- what a file says


def test_points_are_every_combination_the_last_fastest_and_named_by_their_parameters(folder):
    path = written(folder, SMALL + "[grid]\nscene.segments = [4, 6]\nphysics.stiffness = [1e8, 2.5e7]\n")
    path.write_text("seeds = [7, 9]\n" + path.read_text())
    found = points(read(path))
    assert [p.name for p in found][:3] == [
        "segments=4,stiffness=1e8,seed=7",
        "segments=4,stiffness=1e8,seed=9",
        "segments=4,stiffness=2.5e7,seed=7",
    ]
    assert len(found) == 8 == len({p.name for p in found})
    assert found[0].parameters == {"segments": 4, "stiffness": 1e8, "seed": 7}
    assert found[0].sets == {
        "steps": "3",
        "scene.jitter": "0.05",
        "timing.repeats": "1",
        "scene.segments": "4",
        "physics.stiffness": "100000000.0",
        "seed": "7",
    }


def test_a_name_is_the_shortest_end_of_its_key_that_is_its_own(folder):
    path = written(folder, SMALL + "[grid]\nscene.set.0.height = [4]\nscene.set.1.height = [5]\nscene.segments = [6]\n")
    assert points(read(path))[0].name == "0.height=4,1.height=5,segments=6"


def test_keys_that_change_together_are_one_parameter_and_configurations_another(folder):
    shutil.copy(folder / "small.toml", folder / "other.toml")
    text = SMALL.replace('"small.toml"', '["small.toml", "other.toml"]')
    path = written(folder, text + "[axis.size]\n10 = { scene.segments = 4, rate = 30 }\n20 = { scene.segments = 5 }\n")
    found = points(read(path))
    assert [p.name for p in found] == [f"config={c},size={n}" for c in ("small", "other") for n in (10, 20)]
    assert found[0].sets["scene.segments"] == "4" and found[0].sets["rate"] == "30" and "rate" not in found[1].sets
    assert found[2].config == str(folder / "other.toml") and found[1].parameters == {"config": "small", "size": 20}


@pytest.mark.parametrize("names, values", [
    (["10", "2"], [10, 2]), (["0.5", "1"], [0.5, 1]), (["low", "5"], ["low", "5"]),
    (["10", "010"], ["10", "010"]), (["1e1", "10"], ["1e1", "10"]), (["nan", "5"], ["nan", "5"])])  # fmt: skip
def test_values_of_an_axis_are_numbers_where_all_are_different_ones(folder, names, values):
    text = "".join(f'"{name}" = {{ rate = {30 + i} }}\n' for i, name in enumerate(names))
    found = points(read(written(folder, SMALL + "[axis.n]\n" + text)))
    assert [p.parameters["n"] for p in found] == values and len({p.name for p in found}) == len(names)


def test_different_parameters_never_get_one_name():
    values = [
        "a",
        "a/b",
        "a-b",
        "a b",
        "ü",
        "",
        "x" * 70,
        "x" * 71,
        [1, 2],
        [[1], 2],
        [1, [2]],
        "á",
        1,
        2.5,
        True,
        "line\nend",
        "..",
        "a,b=c",
    ]
    names = [point_name({"v": value}) for value in values]
    assert len(set(names)) == len(values)
    long = [point_name({f"parameter{n}": 1.5 + last * (n == 19) for n in range(20)}) for last in (0, 1)]
    assert long[0] != long[1]
    for name in names + long:
        assert re.fullmatch(r"[A-Za-z0-9_.+=,~-]+", name) and len(name) <= plan.MOST_NAME, name


@pytest.mark.parametrize("value, text", [
    (1e8, "1e8"), (0.001, "0.001"), (2.5e-7, "2.5e-7"), (100.0, "100"), (1 / 3, "0.3333333333333333"), (1e300, "1e300"),
    (123456789.5, "123456789.5"), ([6, 6.5], "6x6.5"), (True, "true"), (7, "7"),
])  # fmt: skip
def test_values_are_written_as_people_do_and_lose_nothing(value, text):
    assert value_text(value) == text
    if isinstance(value, float):
        assert float(text) == value


def test_values_reach_the_program_as_they_are():
    import tomllib

    for value in [1, 1e8, 'a "quoted" \\ text\n\x7f', [1, 2.5, "x"], True, {"a b": [1]}, 1e-300]:
        assert tomllib.loads(f"v = {toml(value)}")["v"] == value


@pytest.mark.parametrize("text, said", [
    ("", "missing key 'config'"),
    ("config = 'none.toml'", "there is no file none.toml"),
    ("config = 'small.toml'\nsed = 3", "unknown key 'sed'; did you mean 'seeds'?"),
    ("config = 'small.toml'\nseeds = [1, 1]", "'seeds' has 1 twice"),
    ("config = 'small.toml'\nseeds = [-1]", "'seeds' must be a list of whole numbers of at least 0"),
    ("config = 'small.toml'\nseeds = 0", "'seeds' must be"),
    ("config = 'small.toml'\nseeds = []", "'seeds' must be"),
    ("config = 'small.toml'\n[grid]\nsteps = 5", "'grid.steps' must be a list of values, not 5"),
    ("config = 'small.toml'\n[grid]\nsteps = [5, 5.0]", "'grid.steps' has 5 twice"),
    ("config = 'small.toml'\n[grid]\nsteps = []", "'grid.steps' must be a list"),
    ("config = 'small.toml'\n[grid]\nrate = [nan, 60]", "'grid.rate' must be finite, not nan"),
    ("config = 'small.toml'\n[grid]\nrate = [60, -inf]", "'grid.rate' must be finite, not -inf"),
    ("config = 'small.toml'\n[set]\nsteps = 5\n[grid]\nsteps = [5, 6]", "'grid.steps' sets steps, as 'set' does"),
    ("config = 'small.toml'\nseeds = 3\n[grid]\nseed = [5, 6]", "'seeds' sets seed, as 'grid.seed' does"),
    ("config = 'small.toml'\n[axis]\nn = 5", "'axis.n' must be a table of values"),
    ("config = 'small.toml'\noptions = ['--set', 'a=1']", "'options': --set is said by the sweep itself"),
    ("config = 'small.toml'\nthreads = 0", "'threads' must be 1 to 1024, not 0"),
    ("config = 'small.toml'\n[resources]\nmemory = 5", "unknown key 'resources.memory'; did you mean 'memory_mb'?"),
    ("config = 'small.toml'\n[resources]\nminutes = 0", "'resources.minutes' must be a number above 0"),
    ("config = 'small.toml'\nx = ", "is no TOML"),
    ("config = ['small.toml', 'small.toml']", "two files have one name"),
])  # fmt: skip
def test_what_is_wrong_in_the_file_is_said(folder, text, said):
    path = written(folder, text)
    with pytest.raises(Refused) as error:
        read(path)
    assert str(error.value).startswith(f"{path}: ") and said in str(error.value) and error.value.code == INPUT


def test_a_file_that_is_not_there_is_said(tmp_path):
    with pytest.raises(Refused, match="cannot be read"):
        read(tmp_path / "none.toml")


def test_a_million_points_are_counted_and_not_made(folder):
    path = written(folder, SMALL + f"[grid]\nscene.segments = {list(range(1000))}\nrate = {list(range(1, 1001))}\n")
    done = sweep(folder, name=path.name)
    assert done.returncode == INPUT and "would be 1,000,000 points (segments 1,000 x rate 1,000)" in one_line(done)
    assert "--yes" in done.stderr and not (folder / "out").exists()
    plan.refuse_if_many(read(path), yes=True)


def test_the_command_line(folder):
    path = written(folder, SMALL)
    assert sweep(folder, "--frobnicate").returncode == USAGE
    assert sweep(folder, "-j", "0").returncode == USAGE
    assert sweep(folder, "--partition", "x").returncode == USAGE
    done = sweep(folder, "--program", folder / "none")
    assert done.returncode == FAILED and "scripts/setup pipeline" in one_line(done)
    without = {"PATH": str(folder / "bin")}
    (folder / "bin").mkdir()
    for name in ("bash", "env", "dirname", "python3", "cat"):
        (folder / "bin" / name).symlink_to(shutil.which(name))
    done = sweep(folder, environment=without)
    assert done.returncode == FAILED and "scripts/peers sweep" in one_line(done)
    assert path.exists() and not (folder / "out").exists()


@pytest.mark.parametrize("path", sorted((ROOT / "configs" / "sweeps").glob("*.toml")), ids=lambda path: path.stem)
def test_every_point_of_the_sweeps_that_come_along_is_a_run(path, pipeline):
    sweep_ = read(path)
    found = points(sweep_)
    assert 1 < len(found) <= 64
    firsts = [
        list(group)[0]
        for _, group in itertools.groupby(found, lambda p: {k: v for k, v in p.parameters.items() if k != "seed"})
    ]
    for point in [*firsts[:1], *firsts[-1:], found[-1]]:  # the last one has the last seed
        sets = [word for key, value in (point.sets | {"steps": "2"}).items() for word in ("--set", f"{key}={value}")]
        done = subprocess.run([pipeline, "check", point.config, *sets, "--json"], capture_output=True, text=True)
        assert done.returncode == DONE, done.stderr
        if "bodies" in point.parameters:
            assert json.loads(done.stdout)["bodies"] == point.parameters["bodies"]


# ---- sweeps that run


@pytest.fixture(scope="module")
def swept(tmp_path_factory, pipeline):
    """A sweep of six points, one of them out of range, made once."""
    if not shutil.which("snakemake"):
        pytest.skip("scripts/peers sweep installs Snakemake")
    folder = tmp_path_factory.mktemp("swept")
    shutil.copy(ROOT / "configs" / "smoke.toml", folder / "small.toml")
    written(folder, "seeds = 2\n" + SMALL + "[grid]\nscene.segments = [4, 6, 0]\n")
    done = sweep(folder, "-j", "2")
    return folder, done


def test_a_point_that_fails_is_a_row_with_its_reason_and_the_others_run(swept):
    folder, done = swept
    assert done.returncode == FAILED
    assert done.stdout.splitlines()[0].startswith("6 points: 4 done, 2 not;")
    found = manifest(folder)
    assert list(found) == [f"segments={n},seed={s}" for n in (4, 6, 0) for s in (1, 2)]
    for name, point in found.items():
        if name.startswith("segments=0"):
            assert (
                point["status"] == "failed"
                and point["exit_code"] == INPUT
                and "'scene.segments' must be" in point["reason"]
            )
            assert f"{name}: failed: " in done.stderr
        else:
            assert (point["status"], point["reason"], point["exit_code"]) == ("done", "", 0)
            assert point["wall_time_s"] > 0 and point["host"] and re.fullmatch("[0-9a-f]{32}", point["digest"])
    with open(folder / "out" / "sweep.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4 * 3 + 2 and {row["point"] for row in rows} == set(found)
    assert [row["label"] for row in rows if row["segments"] == "0"] == ["", ""]


def test_every_file_is_that_of_the_plain_run(swept, pipeline, tmp_path):
    folder, _ = swept
    sets = ["steps=3", "scene.jitter=0.05", "timing.repeats=1", "scene.segments=6", "seed=2"]
    plain = tmp_path / "plain.h5"
    command = [
        pipeline,
        "run",
        folder / "small.toml",
        "-o",
        plain,
        "--quiet",
        *(word for s in sets for word in ("--set", s)),
    ]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    found = manifest(folder)
    assert load(plain).meta["digest"] == found["segments=6,seed=2"]["digest"]
    assert len({point["digest"] for point in found.values() if point.get("digest")}) == 4, "seeds change the result"


def test_the_frame_has_a_row_per_point_and_label_with_the_files_own_numbers(swept):
    folder, _ = swept
    table = load_sweep(folder / "out")
    assert table.attrs["parameters"] == ["segments", "seed"] and table.attrs["title"] == "Small"
    assert len(table) == 14 and table.segments.dtype == table.seed.dtype == np.int64
    for name, rows in table[table.label != ""].groupby("point"):
        summary = load(folder / "out" / "points" / f"{name}.h5").summary
        assert list(rows.label) == list(summary.index)
        for column in summary.columns:
            assert np.array_equal(rows[column], summary[column].astype(float), equal_nan=True), column
    bad = table[table.label == ""]
    assert bad.error.isna().all() and (bad.status == "failed").all() and (bad.reason != "").all()


def test_the_index_holds_copies_and_links_that_open(swept):
    folder, _ = swept
    table = load_sweep(folder / "out")
    with h5py.File(folder / "out" / "sweep.h5") as file:
        assert list(file["results"]) == sorted(table.point[table.label != ""].unique())
        assert file["results"].get("segments=4,seed=1", getlink=True).filename == "points/segments=4,seed=1.h5"
        assert file["results/segments=4,seed=1"].attrs["digest"] == manifest(folder)["segments=4,seed=1"]["digest"]
        assert np.array_equal(file["summary/error"][()], table.error.dropna())
        assert not file["summary/error"].is_virtual
        assert list(file["points/status"].asstr()) == ["done"] * 4 + ["failed"] * 2
        for path in ("points/wall_time_s", "summary/time_mean_ns", "points/parameter_segments"):
            assert file[path].attrs["units"] and file[path].attrs["long_name"]
    import xarray

    opened = xarray.open_dataset(folder / "out" / "sweep.h5", group="summary", engine="h5netcdf")
    assert opened.sizes == {"row": 12} and "error" in opened


@needs_snakemake
def test_one_configuration_is_shared_by_workers(folder, pipeline):
    done = sweep(folder, "--shards", "2", name="small.toml")
    assert done.returncode == DONE and "2 workers share the rest" in done.stderr, done.stderr
    (point,) = manifest(folder).values()
    subprocess.run([pipeline, "run", folder / "small.toml", "-o", folder / "plain.h5", "--quiet"], check=True,
                   capture_output=True)  # fmt: skip
    assert point["name"] == "small" and point["digest"] == load(folder / "plain.h5").meta["digest"]
    names = {path.name for path in (folder / "out" / "points").iterdir()}
    assert names == {"small.h5", "small.json", "small.log", "small.work-0.log", "small.work-1.log"}
    again = sweep(folder, "--shards", "2", name="small.toml")
    assert again.returncode == DONE and starts(folder) == {"small": point["began"]}


@needs_snakemake
def test_a_shared_point_whose_motion_cannot_be_made_is_a_row_with_its_reason(folder):
    """Nobody asks `check` where the sweep says what points take."""
    written(folder, SMALL + "[grid]\nscene.segments = [4, 0]\n[resources]\nmemory_mb = 100\nminutes = 1\n")
    done = sweep(folder, "--shards", "1")
    assert done.returncode == FAILED, done.stderr
    found = manifest(folder)
    assert found["segments=4"]["status"] == "done" and found["segments=0"]["status"] == "failed"
    assert "'scene.segments' must be" in found["segments=0"]["reason"] and found["segments=0"]["exit_code"] == INPUT


def test_a_folder_of_a_sweep_is_no_result(swept):
    with pytest.raises(ValueError, match="folder of a sweep; load_sweep reads it"):
        load(swept[0] / "out")
    with pytest.raises(ValueError, match="is not the folder of a sweep"):
        load_sweep(swept[0])
    with pytest.raises(FileNotFoundError):
        load_sweep(swept[0] / "none")


@pytest.fixture
def copied(swept, tmp_path):
    """The six points in a folder that a test may change."""
    shutil.copytree(swept[0], tmp_path / "again", copy_function=shutil.copy2)
    return tmp_path / "again"


def repeated(folder, *options):
    before = starts(folder)
    done = sweep(folder, *options)
    return {name for name, began in starts(folder).items() if began != before.get(name)}, done


def test_a_rerun_repeats_nothing_that_is_done(copied):
    again, done = repeated(copied)
    assert again == set() and "6 points: 4 done, 2 not; 2 of them in" in done.stdout and done.returncode == FAILED


def test_a_rerun_repeats_what_is_missing_and_ends_alike(copied):
    before = {name: point.get("digest") for name, point in manifest(copied).items()}
    (copied / "out" / "points" / "segments=4,seed=2.h5").unlink()
    again, _ = repeated(copied)
    assert again == {"segments=4,seed=2"}
    assert {name: point.get("digest") for name, point in manifest(copied).items()} == before


@pytest.mark.parametrize("what, why", [
    ("cut", {"segments=4,seed=2": "its result is missing or another"}),
    ("died", {"segments=4,seed=2": "died"}),
    ("stopped", {"segments=4,seed=2": "stopped"}),
    ("no state", {"segments=4,seed=2": "missing"}),
    ("damaged state", {"segments=4,seed=2": "missing"}),
    ("value", {"segments=5,seed=1": "missing", "segments=5,seed=2": "missing"}),
    ("set", {f"segments={n},seed={s}": "settings changed" for n in (4, 6) for s in (1, 2)}),
    ("options", {f"segments={n},seed={s}": "settings changed" for n in (4, 6) for s in (1, 2)}),
    ("configuration", {f"segments={n},seed={s}": "configuration changed" for n in (4, 6) for s in (1, 2)}),
    ("program", {f"segments={n},seed={s}": "program changed" for n in (4, 6) for s in (1, 2)}),
])  # fmt: skip
def test_what_is_missing_failed_or_changed_is_to_be_repeated(copied, what, why):
    result, state = (copied / "out" / "points" / f"segments=4,seed=2{ending}" for ending in (".h5", ".json"))
    text, program = (copied / "s.toml").read_text(), PIPELINE
    if what == "cut":
        result.write_bytes(result.read_bytes()[:-1])
    elif what in ("died", "stopped"):
        state.write_text(json.dumps(json.loads(state.read_text()) | {"status": {"died": "running"}.get(what, what)}))
    elif what == "no state":
        state.unlink()
    elif what == "damaged state":
        state.write_text("{")
    elif what == "value":
        text = text.replace("[4, 6, 0]", "[4, 6, 5]")
    elif what == "set":
        text = text.replace("steps = 3", "steps = 2")
    elif what == "options":
        text = 'options = ["--digests"]\n' + text
    elif what == "configuration":
        (copied / "small.toml").write_text((copied / "small.toml").read_text() + "\n")
    elif what == "program":
        program = copied / "program"
        program.write_text("another")
    found = Job(read(written(copied, text)), None, str(program), str(copied / "out"), "", None).again
    assert {name: reason for name, reason in found.items() if not name.startswith("segments=0")} == why
    assert what == "value" or {found["segments=0,seed=1"], found["segments=0,seed=2"]} == {"failed"}


def test_an_input_that_changed_is_a_reason_to_repeat(folder):
    from analysis.sweep.state import file_sha256, identity, why_again

    mesh, (point,) = folder / "hero.obj", points(read(written(folder, SMALL)))
    mesh.write_text("v 0 0 0\n")
    (folder / "out" / "points").mkdir(parents=True)
    result = folder / "out" / "points" / f"{point.name}.h5"
    result.write_bytes(b"result")
    now = identity(PIPELINE, point.config, point.sets, [])
    kept = {"status": "done", "identity": now, "inputs": {"hero.obj": file_sha256(mesh)}, "file_bytes": 6}
    result.with_suffix(".json").write_text(json.dumps(kept))
    assert why_again(folder / "out", point, now, [], {}) == ""
    mesh.write_text("v 0 0 1\n")
    assert why_again(folder / "out", point, now, [], {}) == "input hero.obj changed"
    mesh.unlink()
    assert why_again(folder / "out", point, now, [], {}) == "input hero.obj changed"


def test_a_dry_run_says_what_would_run_and_leaves_nothing(copied):
    (copied / "out" / "points" / "segments=4,seed=2.h5").unlink()
    before = {path: path.stat().st_mtime_ns for path in (copied / "out").rglob("*") if ".sweep" not in str(path)}
    done = sweep(copied, "--dry-run")
    lines = done.stdout.splitlines()
    assert done.returncode == DONE and lines[-1].startswith("6 points, 3 are done, 3 would run: ")
    assert re.match(r"segments=4,seed=2  its result is missing or another  \d+ MiB  .* s to .* s$", lines[1]), lines[1]
    assert "fails: --set scene.segments=0" in lines[2]
    assert {
        path: path.stat().st_mtime_ns for path in (copied / "out").rglob("*") if ".sweep" not in str(path)
    } == before
    shutil.rmtree(copied / "out")
    assert sweep(copied, "--dry-run").returncode == DONE and not (copied / "out").exists()


@needs_snakemake
def test_an_unknown_key_is_refused_before_anything_runs(folder):
    written(folder, SMALL + "[grid]\nscene.segmnts = [4, 6]\n")
    done = sweep(folder)
    assert done.returncode == INPUT
    assert (
        done.stderr.strip().splitlines()[-1]
        == f"{folder / 's.toml'}: scene.segmnts=4: unknown key 'scene.segmnts'; did you mean 'segments'?"
    )
    assert list((folder / "out" / "points").iterdir()) == []


def test_the_folder_of_another_sweep_is_refused(copied):
    written(copied, (copied / "s.toml").read_text(), "t.toml")
    done = sweep(copied, name="t.toml")
    assert (
        done.returncode == FILE
        and "holds the sweep 's' over segments, seed, this is 't' over segments, seed" in one_line(done)
    )
    written(
        copied, (copied / "s.toml").read_text().replace("scene.segments = [4", "rate = [30, 60]\nscene.segments = [4")
    )
    done = sweep(copied)
    assert done.returncode == FILE and "this is 's' over rate, segments, seed" in one_line(done)
    shutil.rmtree(copied / "out")
    (copied / "out").mkdir()
    (copied / "out" / "thesis.doc").write_text("")
    done = sweep(copied)
    assert done.returncode == FILE and "is not the folder of a sweep" in one_line(done)
    assert os.listdir(copied / "out") == ["thesis.doc"]


# The program behind a gate: `run` waits until a file is there.
GATED = """#!/bin/bash
if [ "$1" = run ]; then echo $$ >> {folder}/pids; until [ -e {folder}/gate ]; do sleep 0.1; done; fi
exec "{pipeline}" "$@"
"""


@pytest.fixture
def gated(folder):
    written(folder, "seeds = 2\n" + SMALL)
    (folder / "program").write_text(GATED.format(folder=folder, pipeline=PIPELINE))
    (folder / "program").chmod(0o755)
    command = [
        ROOT / "scripts" / "sweep",
        folder / "s.toml",
        "-o",
        folder / "out",
        "--program",
        folder / "program",
        "-j",
        "2",
    ]
    ignoring = ["bash", "-c", "trap '' INT; exec \"$@\"", "-"]  # as a script's & starts it
    command = [*ignoring, *map(str, command)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + 100
    while not (folder / "pids").exists() or len((folder / "pids").read_text().split()) < 2:
        assert time.monotonic() < end and process.poll() is None, process.communicate()
        time.sleep(0.1)
    yield folder, process
    (folder / "gate").touch()
    process.communicate(timeout=100)


@needs_snakemake
def test_two_sweeps_into_one_folder_at_once_are_refused(gated):
    folder, process = gated
    done = sweep(folder, "--program", folder / "program")
    assert done.returncode == FILE and f"another sweep (process {process.pid} on " in one_line(done)
    (folder / "gate").touch()
    assert process.wait(100) == DONE


@needs_snakemake
def test_ctrl_c_ends_the_points_and_the_same_command_goes_on(gated):
    folder, process = gated
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == INTERRUPTED and err.strip().splitlines()[-1] == "interrupted; the same command goes on"
    for pid in (folder / "pids").read_text().split():
        with pytest.raises(ProcessLookupError):
            os.kill(int(pid), 0)
    assert {point["status"] for point in manifest(folder).values()} == {"stopped"}
    assert all("stopped by SIGINT" in point["reason"] for point in manifest(folder).values())
    (folder / "gate").touch()
    assert sweep(folder, "--program", folder / "program", "-j", "2").returncode == DONE


@needs_snakemake
@pytest.mark.parametrize("by, status, code", [("SIGKILL", "failed", 137), ("SIGTERM", "stopped", 143)])
def test_a_point_that_is_killed_has_a_reason(gated, by, status, code):
    """A cluster's SIGTERM may reach the program before the process that waits for it."""
    folder, process = gated
    pids = (folder / "pids").read_text().split()
    os.kill(int(pids[0]), getattr(signal, by))
    (folder / "gate").touch()
    assert process.wait(100) == FAILED
    found = sorted(manifest(folder).values(), key=lambda point: point["status"])
    assert [point["status"] for point in found] == ["done", status]
    assert f" by {by} (" in found[1]["reason"] and found[1]["exit_code"] == code


@needs_snakemake
def test_a_full_disk_on_one_node_costs_its_point(folder):
    """The second seed's point meets a disk that takes 4 KiB."""
    written(folder, "seeds = 3\n" + SMALL)
    full = f'#!/bin/bash\nif [ "$1" = run ] && [[ "$*" = *seed=2* ]]; then ulimit -f 4; fi\nexec "{PIPELINE}" "$@"\n'
    (folder / "program").write_text(full)
    (folder / "program").chmod(0o755)
    done = sweep(folder, "--program", folder / "program", "-j", "2")
    found = manifest(folder)
    assert done.returncode == FAILED
    assert [found[f"seed={n}"]["status"] for n in (1, 2, 3)] == ["done", "failed", "done"]
    assert found["seed=2"]["exit_code"] == FILE and "File too large" in found["seed=2"]["reason"]


@needs_snakemake
def test_a_folder_that_cannot_be_written_is_one_line(folder):
    written(folder, SMALL)
    (folder / "file").write_text("")
    command = [ROOT / "scripts" / "sweep", folder / "s.toml", "-o", folder / "file" / "out"]
    done = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, env=os.environ | {"PIPELINE": PIPELINE}
    )
    assert done.returncode == FILE and str(folder / "file") in one_line(done)


@needs_snakemake
def test_options_and_threads_reach_every_run(folder):
    """The program says what it was called with; an option that it does not know fails the point with its words."""
    written(folder, 'threads = 3\noptions = ["--unknown"]\n' + SMALL + "[resources]\nmemory_mb = 500\nminutes = 5\n")
    (folder / "program").write_text(f'#!/bin/bash\necho "$@" >> {folder}/called\nexec "{PIPELINE}" "$@"\n')
    (folder / "program").chmod(0o755)
    done = sweep(folder, "--program", folder / "program")
    (called,) = (folder / "called").read_text().splitlines()  # [resources] takes the place of check
    assert called.startswith("run ") and "--threads 3 " in called and called.endswith(" --unknown")
    (point,) = manifest(folder).values()
    assert done.returncode == FAILED and point["exit_code"] == USAGE and "--unknown" in point["reason"]
