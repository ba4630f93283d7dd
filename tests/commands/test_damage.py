"""Damaged and hostile results: what every reader makes of them. The long form: tests/damage.py."""
import json
import os
import random
import shutil
import time
import warnings

import h5py
import numpy as np
import pytest
from damage import Readers, cases
from editing import edited, seal
from program import DONE, FILE, ROOT, one_line, pipeline

from analysis.__main__ import main
from analysis.load import load

BOX = ROOT / "tests" / "data" / "box.h5"


def test_damage_is_never_another_number_a_signal_or_endless(tmp_path):
    seed = random.randrange(2**32)
    print("seed", seed)
    readers, path = Readers(str(BOX)), tmp_path / "damaged.h5"
    tried = faults = 0
    for what, damaged, holds in cases(BOX.read_bytes(), seed, flips=150, resealed=60, every=10):
        path.write_bytes(damaged)
        for name, fault in (("show", readers.fault_of_show), ("load", readers.fault_of_load)):
            if found := fault(str(path), holds):
                faults += 1
                print(f"{what}: {name} {found}")
        tried += 1
    assert tried > 200 and faults == 0


@pytest.fixture
def hostile(tmp_path):
    """change -> the path of a copy of BOX that was changed so and sealed; its digests are as they were."""

    def make(change):
        path = shutil.copy(BOX, tmp_path / "hostile.h5")
        with edited(path, digests=False) as file:
            change(file)
        return str(path)

    return make


def refused(path, *words):
    """Both readers refuse it in one line that names it and, all of them, the cause; soon. The lines."""
    start = time.monotonic()
    run = pipeline("show", path)
    with pytest.raises((OSError, ValueError)) as error:
        load(path)
    assert time.monotonic() - start < 30
    assert run.returncode == FILE
    lines = one_line(run), str(error.value)
    for line in lines:
        assert line.startswith(f"{path}: ") and "\n" not in line
        for word in words:
            assert word in line, line
    return lines


@pytest.mark.parametrize("group", ["/", "motion", "truth", "answers/aabb"])
def test_every_groups_digest_is_compared(hostile, group):
    refused(hostile(lambda file: file[group].attrs.__setitem__("digest", "0" * 32)), "does not have its digest")


def test_times_attributes_and_configuration_are_under_the_seal(tmp_path):
    """Each was changed without a word before; HDF5 finds nothing in it."""
    changes = {
        "time": lambda file: file["summary/time_mean_ns"].__setitem__(0, 1.0),
        "promise": lambda file: file["answers/aabb"].attrs.modify("promise", "none"),
        "host": lambda file: file["run"].attrs.modify("host", "elsewhere"),
        "configuration": lambda file: file["config"].attrs.modify("effective", "steps = 1"),
    }
    for name, change in changes.items():
        path = shutil.copy(BOX, tmp_path / "x.h5")
        with h5py.File(path, "r+") as file:
            change(file)
        refused(str(path), "was changed or damaged since it was written")
        score = ["score", path, "--against", tmp_path / "b.json", "--write"]
        for command in (["verify", path], ["detect", path], score, ["export", path, "--vtk", tmp_path / "vtk"]):
            run = pipeline(*command)
            assert run.returncode == FILE and "--unsealed" in one_line(run), (name, command)
    assert not (tmp_path / "b.json").exists() and not (tmp_path / "vtk").exists()


@pytest.mark.parametrize("shape", ["a.obj", "[]", '{"kind": ', '{"radius": NaN}', '{"a": ' * 40 + "1" + "}" * 40])
def test_a_shape_that_is_no_object_is_refused_unsealed_too(tmp_path, shape):
    path = shutil.copy(BOX, tmp_path / "x.h5")
    with h5py.File(path, "r+") as file:
        file["meshes"][next(iter(file["meshes"]))].attrs.modify("shape", shape)
    run = pipeline("show", path, "--unsealed")
    assert run.returncode == FILE and "is no JSON object" in one_line(run)
    with pytest.raises(OSError, match="is no JSON object"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        load(path, unsealed=True)


def test_own_datasets_are_read_when_asked_for_and_it_is_said(tmp_path):
    path = shutil.copy(BOX, tmp_path / "mine.h5")
    with h5py.File(path, "r+") as file:
        file["mine/notes"] = np.arange(3)
    refused(str(path), "its seal is missing")
    for command in (["show"], ["verify"], ["score", "--against", tmp_path / "b.json", "--write"]):
        run = pipeline(command[0], path, *command[1:], "--unsealed")
        assert run.returncode == DONE and "vouched for by nobody" in one_line(run)
    with pytest.warns(UserWarning, match="vouched for by nobody"):
        run = load(path, unsealed=True)
    assert run.meta["digest"] == load(BOX).meta["digest"]
    with h5py.File(path, "r+") as file:
        file["truth/pair"][0] = file["truth/pair"][0][::-1]
    assert pipeline("show", path, "--unsealed").returncode == FILE
    with pytest.raises((OSError, ValueError), match="digest"):
        load(path, unsealed=True)


def test_detect_does_not_vouch_for_what_was_read_unsealed(tmp_path):
    path = shutil.copy(BOX, tmp_path / "x.h5")
    with h5py.File(path, "r+") as file:
        file["summary/time_mean_ns"][...] = 1
    run = pipeline("detect", path, "--unsealed", "--algorithm", "aabb@again", "--quiet")
    assert run.returncode == DONE and "vouched for by nobody" in one_line(run)
    refused(str(path), "its seal is missing")
    assert pipeline("show", path, "--unsealed").returncode == DONE


def test_detect_refuses_to_lose_what_others_added(tmp_path):
    path = shutil.copy(BOX, tmp_path / "x.h5")
    with h5py.File(path, "r+") as file:
        file["mine/notes"] = "kept"
    before = path.read_bytes()
    run = pipeline("detect", path, "--unsealed", "--algorithm", "aabb@again", "--quiet")
    assert run.returncode == FILE and "holds 'mine', which is not this program's and would be lost" in run.stderr
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_detect_seals_what_it_writes(tmp_path):
    path = shutil.copy(BOX, tmp_path / "x.h5")
    assert pipeline("detect", path, "--algorithm", "aabb@again", "--quiet").returncode == DONE
    assert "is not sealed" not in pipeline("show", path).stderr and "again" in load(path).summary.index


def test_a_result_of_an_older_program_is_read_and_said(tmp_path):
    path = shutil.copy(BOX, tmp_path / "older.h5")
    with h5py.File(path, "r+") as file:
        del file.attrs["sealed"]
    run = pipeline("show", path)
    assert run.returncode == DONE and "is not sealed, as results of older programs" in one_line(run)
    with pytest.warns(UserWarning, match="is not sealed"):
        assert load(path).meta["digest"] == load(BOX).meta["digest"]


def test_a_result_that_is_replaced_while_its_tables_are_read_is_not_mixed(tmp_path):
    path = shutil.copy(BOX, tmp_path / "x.h5")
    run = load(path)
    shutil.copy(ROOT / "tests" / "data" / "falling.h5", path)
    with pytest.raises(OSError, match="changed or replaced since it was loaded"):
        run.summary


# ---- made on purpose, and sealed


def test_links_are_not_followed(hostile, tmp_path):
    os.mkfifo(tmp_path / "fifo")  # whoever opens it waits for ever

    def link(to):
        def change(file):
            del file["motion"]
            file["motion"] = to

        return change

    refused(hostile(link(h5py.ExternalLink(str(tmp_path / "fifo"), "/motion"))), "/motion: is a link to another file")
    refused(hostile(link(h5py.SoftLink("/motion"))), "/motion: is a soft link")
    refused(hostile(lambda file: file.create_group("/".join(["d"] * 100))), "is nested too deep")


def test_values_elsewhere_are_not_read(hostile, tmp_path):
    def external(file):
        shape = file["truth/time_ns"].shape
        del file["truth/time_ns"]
        file.create_dataset("truth/time_ns", shape, "<i8", external=[("/etc/passwd", 0, 8 * shape[0])])

    def virtual(file):
        shape = file["truth/time_ns"].shape
        del file["truth/time_ns"]
        layout = h5py.VirtualLayout(shape, "<i8")
        layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "x", shape)
        file.create_virtual_dataset("truth/time_ns", layout)

    for change in (external, virtual):
        refused(hostile(change), "/truth/time_ns: its values are in another file")


def test_a_size_without_storage_takes_no_memory(hostile):
    """2^29 steps in a file of 170 KB took 4.1 GB."""
    refused(hostile(lambda file: file["step"].resize((2**29,))), "/step: has 536870912 entries, at most 10000000")
    refused(hostile(lambda file: file["truth/pair"].resize((2**29, 2))), "/truth/pair: ", "bytes are stored")


def test_a_hundred_thousand_meshes_are_refused_by_their_number(hostile):
    def change(file):
        meshes = file["meshes"]
        mesh = meshes[next(iter(meshes))]
        for i in range(100_000):
            meshes[f"m{i}"] = mesh

    refused(hostile(change), "/meshes: has 10000", "entries")


@pytest.mark.parametrize(
    "place, name, value",
    [("answers/aabb", "knobs", "{"), ("answers/aabb", "knobs", "[" * 100_000), ("answers/aabb", "promise", 1),
     ("/", "inputs_sha256", "7"), ("/", "title", 1.5), ("run", "wall_time_s", "long")],
)  # fmt: skip
def test_an_attribute_of_another_kind_is_named(hostile, place, name, value):
    def change(file):
        del file[place].attrs[name]
        file[place].attrs[name] = value

    refused(hostile(change), f"attribute {name} of /{place.strip('/')}", "")


def test_a_configuration_that_is_none_is_damage(hostile):
    path = hostile(lambda file: file["config"].attrs.modify("effective", "steps = "))
    for command in (["show", path, "--json"], ["detect", path]):
        run = pipeline(*command)
        assert run.returncode == FILE and one_line(run).startswith(path) and run.stdout == ""


def test_a_heap_that_the_library_loops_in_ends(tmp_path):
    """A zeroed block of its global heap made `show` loop for ever: in HDF5 1.10.8, before any digest is compared."""
    content = BOX.read_bytes()
    at = content.index(b"GCOL") + 16
    path = tmp_path / "loop.h5"
    path.write_bytes(content[:at] + bytes(4096 - 16) + content[at + 4096 - 16 :])
    refused(str(path), "its seal does not hold")
    with open(path, "r+b") as file:
        file.truncate(content.rindex(b"\ncollision benchmark"))
    seal(path)
    refused(str(path), "is damaged")


def test_nothing_but_a_regular_file_is_opened(tmp_path):
    os.mkfifo(tmp_path / "fifo")
    for path in (tmp_path / "fifo", "/dev/zero"):
        refused(str(path), "not a regular file")
        run = pipeline("score", BOX, "--against", path)
        assert run.returncode == FILE and "not a regular file" in one_line(run)
    run = pipeline("score", BOX, "--against", tmp_path)
    assert run.returncode == FILE and "is a folder" in one_line(run)


def test_a_baseline_nested_without_end_is_refused(tmp_path):
    (tmp_path / "deep.json").write_text('{"a":' * 100_000)
    run = pipeline("score", BOX, "--against", tmp_path / "deep.json")
    assert run.returncode == FILE and "nested too deep" in one_line(run)


def test_a_manifest_of_millions_is_shown_at_once(tmp_path):
    part = tmp_path / "x.h5.part"
    part.mkdir()
    (part / "manifest.json").write_text('{"kind": "collision benchmark checkpoint", "title": "t", "steps": 10000000, '
                                        '"study": true}')
    start = time.monotonic()
    run = pipeline("show", part)
    assert run.returncode == DONE and "0 of 10000000 cases" in run.stdout and time.monotonic() - start < 3


# ---- what is shown of it


EVIL = "\x1b]0;owned\x07\x1b[2J\x9b31m\x7f"


def test_no_text_of_a_file_reaches_the_terminal_as_a_command(hostile, capfd):
    def change(file):
        file.attrs["title"] = EVIL
        file["run"].attrs["host"] = EVIL
        file["answers/aabb"].attrs["thesis_key"] = EVIL

    path = hostile(change)
    for command in (["show", path], ["show", path, "--json"], ["verify", path], ["verify", path, "--json"]):
        run = pipeline(*command)
        assert run.returncode == DONE
        controls = {c for c in run.stdout + run.stderr if (ord(c) < 32 and c != "\n") or 127 <= ord(c) < 160}
        assert controls == set(), command
    assert json.loads(pipeline("show", path, "--json").stdout)["title"] == EVIL
    capfd.readouterr()
    main(["statements", path])
    out, err = capfd.readouterr()
    assert not any(c in out + err for c in "\x1b\x07\x9b\x7f")


def test_json_stays_valid_for_texts_that_are_no_unicode(hostile):
    def change(file):
        file.attrs.create("title", b"a\xff\xc3b", dtype=h5py.string_dtype())

    run = pipeline("show", hostile(change), "--json")
    assert run.returncode == DONE and json.loads(run.stdout)["title"] == "a\ufffd\ufffdb"
