"""`pipeline export`: the VTP files hold the truth's own doubles and the counts of the run; errors, interruption.

The files are read here by Python's XML parser. That VTK reads them as well was checked with Debian's python3-vtk9
(analysis/README.md), which is too heavy to be installed for a test.
"""

import base64
import os
import resource
import signal
import subprocess
import time
import xml.etree.ElementTree as ET
import zlib

import h5py
import numpy as np
import pytest
from conftest import ROOT
from program import one_line

from analysis.load import load

DONE, USAGE, INPUT, FILE, INTERRUPTED = 0, 2, 3, 4, 130
TYPES = {"Float64": "<f8", "UInt32": "<u4", "UInt64": "<u8", "Int64": "<i8", "String": "u1"}


def export(pipeline, *arguments, **more):
    command = [pipeline, "export", *map(str, arguments)]
    return subprocess.run(command, text=True, capture_output=True, timeout=100, **more)


def arrays(path):
    """name -> values of every array of a VTP: base64 of the header, then of the blocks, as VTK describes it."""
    root = ET.parse(path).getroot()
    assert root.attrib["compressor"] == "vtkZLibDataCompressor" and root.attrib["header_type"] == "UInt64"
    data = root.find("AppendedData").text.strip().removeprefix("_")
    found = {}
    for element in [*root.iter("DataArray"), *root.iter("Array")]:
        rest = data[int(element.attrib["offset"]) :]
        blocks = np.frombuffer(base64.b64decode(rest[:32])[:8], "<u8")[0]
        size = 8 * (3 + int(blocks))
        length = 4 * ((size + 2) // 3)
        header = np.frombuffer(base64.b64decode(rest[:length])[:size], "<u8").astype(int)
        total = int(header[3:].sum())
        packed = base64.b64decode(rest[length : length + 4 * ((total + 2) // 3)])
        ends = np.cumsum([0, *header[3:]])
        plain = b"".join(zlib.decompress(packed[a:b]) for a, b in zip(ends, ends[1:]))
        found[element.attrib["Name"]] = np.frombuffer(plain, TYPES[element.attrib["type"]])
    piece = root.find("PolyData/Piece").attrib
    assert 3 * int(piece["NumberOfPoints"]) == len(found["Points"])
    assert int(piece["NumberOfPolys"]) == len(found["offsets"]) == len(found["body"])
    return found


def world(file, body, step):
    """World vertices ((r0 x + r1 y) + r2 z) + t in doubles: README's definition of the truth, written once more."""
    w, x, y, z = file["motion/orientation"][step, body]
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]  # fmt: skip
    v = file["meshes"][file["bodies/mesh"].asstr()[body]]["vertices"][()].T
    t = file["motion/position"][step, body]
    return np.stack([((r[0] * v[0] + r[1] * v[1]) + r[2] * v[2]) + t[i] for i, r in enumerate(rows)], axis=1)


@pytest.fixture(scope="module")
def births(pipeline, tmp_path_factory):
    """A result with bodies that are born on the way: the cube, with its first births soon."""
    path = tmp_path_factory.mktemp("births") / "cube & co.h5"
    command = [pipeline, "run", str(ROOT / "configs" / "kostka.toml"), "-o", str(path), "--set", "steps=40", "--quiet"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return path


def test_points_are_the_doubles_of_the_truth(pipeline, births, tmp_path):
    assert export(pipeline, births, "--vtk", tmp_path / "out", "--steps", "30:32").returncode == DONE
    with h5py.File(births) as file:
        for step in (30, 31):
            found = arrays(tmp_path / "out" / f"cube___co_{step:06}.vtp")
            born = np.flatnonzero(np.isfinite(file["motion/position"][step]).all(axis=1))
            assert 0 < len(born) < file["body"].shape[0], "some are not born yet"
            expected = np.concatenate([world(file, body, step) for body in born])
            assert (found["Points"].view(np.uint64) == expected.ravel().view(np.uint64)).all()
            assert sorted(set(found["body"])) == list(born)
            assert found["TimeValue"] == step / file["time"].attrs["rate"] and found["step"] == step
            assert bytes(found["name"]).decode().split("\0")[:-1] == list(file["body"].asstr()[()])


def test_triangles_are_the_meshes_own(pipeline, births, tmp_path):
    export(pipeline, births, "--vtk", tmp_path / "out", "--steps", "39:40")
    found = arrays(tmp_path / "out" / "cube___co_000039.vtp")
    corners = found["connectivity"].reshape(-1, 3)
    assert (found["offsets"] == 3 * np.arange(1, len(corners) + 1)).all()
    base = 0
    with h5py.File(births) as file:
        for body in sorted(set(found["body"])):
            mesh = file["meshes"][file["bodies/mesh"].asstr()[body]]
            assert (corners[found["body"] == body] == mesh["triangles"][()].astype(np.int64) + base).all()
            base += len(mesh["vertices"])


def test_counts_are_those_of_the_run(pipeline, result_file, tmp_path):
    run = load(result_file)
    step = int(run.per_step.groupby("step").false_positive.sum().idxmax())
    assert export(pipeline, result_file, "--vtk", tmp_path / "out", "--steps", f"{step}:{step + 1}").returncode == DONE
    found = arrays(next((tmp_path / "out").glob("*.vtp")))
    _, first = np.unique(found["body"], return_index=True)  # a triangle of each body
    truth = run.truth_pairs.query("step == @step")
    meets = np.bincount(np.concatenate([truth.a, truth.b]), minlength=len(run.meta["bodies"]))
    assert (found["truth_hits"][first] == meets).all()
    counts = run.per_step.query("step == @step").set_index("algorithm")
    assert counts.false_positive.sum() > 0
    for label, row in counts.iterrows():
        for kind in ("false_positive", "false_negative"):
            assert found[f"{kind}_{label}"][first].sum() == 2 * row[kind], (kind, label)  # two bodies a pair
            pairs = run.per_pair(label).query("step == @step and verdict == @kind")[["a", "b"]]
            assert len(pairs) == row[kind]
            # Who with whom; an array that would be empty is left out.
            kept = found.get(f"{kind}_pairs_{label}")
            assert kept is None if pairs.empty else (kept.reshape(-1, 2) == pairs.to_numpy()).all(), (kind, label)
    assert (found["truth_pairs"].reshape(-1, 2) == truth[["a", "b"]].to_numpy()).all()


def test_index_names_every_step_with_its_time(pipeline, result_file, tmp_path):
    run = export(pipeline, result_file, "--vtk", tmp_path / "out", "--steps", "2:5")
    index = tmp_path / "out" / f"{result_file.stem}.pvd"
    assert run.stdout.splitlines()[-1] == str(index) and "3 steps, about" in run.stdout
    quiet = export(pipeline, result_file, "--vtk", tmp_path / "out", "--steps", "2:5", "--force", "--quiet")
    assert (quiet.stdout, quiet.stderr) == (f"{index}\n", "")  # the result stays
    rows = [row.attrib for row in ET.parse(index).iter("DataSet")]
    rate = load(result_file).meta["rate"]
    assert [float(row["timestep"]) for row in rows] == [step / rate for step in (2, 3, 4)]
    assert {row["file"] for row in rows} | {index.name} == set(os.listdir(tmp_path / "out"))


def test_without_steps_all_are_written(pipeline, result_file, tmp_path):
    assert export(pipeline, result_file, "--vtk", tmp_path / "out").returncode == DONE
    assert len(list((tmp_path / "out").glob("*.vtp"))) == load(result_file).meta["steps"]


def test_a_folder_in_use_is_refused_without_force(pipeline, result_file, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "other.pvd").write_text("mine")
    refused = export(pipeline, result_file, "--vtk", tmp_path, "--steps", ":2")
    assert refused.returncode == FILE and "--force" in one_line(refused)
    assert len(os.listdir(tmp_path)) == 2
    assert export(pipeline, result_file, "--vtk", tmp_path, "--steps", ":3", "--force").returncode == DONE
    assert export(pipeline, result_file, "--vtk", tmp_path, "--steps", ":1", "--force").returncode == DONE
    assert len(list(tmp_path.glob("*.vtp"))) == 1, "steps of the earlier export are gone"
    assert (tmp_path / "notes.txt").read_text() == (tmp_path / "other.pvd").read_text() == "mine"
    in_the_way = tmp_path / f"{result_file.stem}_000007.vtp" / "full"
    in_the_way.mkdir(parents=True)
    run = export(pipeline, result_file, "--vtk", tmp_path, "--steps", ":1", "--force")
    assert run.returncode == FILE and str(in_the_way.parent) in one_line(run)


@pytest.mark.parametrize("steps, code, word", [
    ("5", USAGE, "A:B"), ("a:b", USAGE, "A:B"), ("1:2:3", USAGE, "A:B"), ("-1:3", USAGE, "A:B"),
    ("1.5:3", USAGE, "A:B"), ("5:5", INPUT, "is empty"), ("9:3", INPUT, "is empty"),
    (":100000", INPUT, "has the steps 0:"),
    ("0:99999999999999999999999", USAGE, "A:B"),
])  # fmt: skip
def test_a_bad_range_of_steps_is_told(pipeline, result_file, tmp_path, steps, code, word):
    run = export(pipeline, result_file, "--vtk", tmp_path / "out", f"--steps={steps}")
    assert run.returncode == code and word in one_line(run)
    assert not (tmp_path / "out").exists()


def test_bad_files_and_folders_are_told(pipeline, result_file, tmp_path):
    text = tmp_path / "text.h5"
    text.write_text("no result")
    for arguments in ([text, "--vtk", tmp_path / "out"], [tmp_path / "none.h5", "--vtk", tmp_path / "out"],
                      [result_file, "--vtk", text], [result_file, "--vtk", text / "below"]):  # fmt: skip
        run = export(pipeline, *arguments)
        assert run.returncode == FILE and one_line(run), arguments
    assert os.listdir(tmp_path) == ["text.h5"]
    assert export(pipeline, result_file).returncode == USAGE
    assert export(pipeline, result_file, "--vtk", "").returncode == USAGE


def test_a_full_disk_leaves_nothing(pipeline, result_file, tmp_path):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

    run = export(pipeline, result_file, "--vtk", tmp_path / "out", preexec_fn=limit)
    assert run.returncode == FILE and "out" in one_line(run)
    assert os.listdir(tmp_path) == []


def test_interrupted_it_leaves_nothing(pipeline, result_file, tmp_path):
    process = subprocess.Popen([pipeline, "export", str(result_file), "--vtk", str(tmp_path / "out")],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)  # fmt: skip
    end = time.monotonic() + 30
    while not list((tmp_path / "out").glob("*.vtp")) and time.monotonic() < end:
        time.sleep(0.001)
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=30)
    assert process.returncode == INTERRUPTED and len(told.splitlines()) == 1
    assert os.listdir(tmp_path) == []
