"""Replayed scenes and containment as their users meet them: other people's meshes, motion and mistakes."""
import json
import shutil
import subprocess

import h5py
import numpy as np
import pytest
from program import DONE, FILE, INPUT, PIPELINE, ROOT, one_line, pipeline

from analysis.load import load

EXAMPLE = ROOT / "configs" / "replay_example.toml"


@pytest.fixture(scope="module")
def example(tmp_path_factory):
    path = tmp_path_factory.mktemp("example") / "example.h5"
    run = pipeline("run", EXAMPLE, "-o", path)
    assert run.returncode == DONE, run.stderr
    assert run.stderr == ""
    return path


@pytest.fixture
def copy(tmp_path):
    """The example, free to be changed."""
    shutil.copy(EXAMPLE, tmp_path)
    shutil.copytree(ROOT / "configs" / "replay_example", tmp_path / "replay_example")
    return tmp_path / "replay_example.toml"


# ---- the example


def test_example_holds_the_files_motion_and_no_physics(example):
    csv = np.genfromtxt(ROOT / "configs/replay_example/poses.csv", delimiter=",", names=True, dtype=None, encoding=None)
    with h5py.File(example) as file:
        assert "physics" not in file
        names = list(file["body"].asstr()[()])
        assert names == ["hero", "drone", "box", "gate"]
        assert file["step"].shape == (csv["step"].max() + 1,)
        assert file["time"].attrs["rate"] == 30
        for row in csv:
            body = names.index(row["body"])
            steps = slice(None) if row["body"] == "gate" else row["step"]
            position = file["motion/position"][steps, body]
            assert (position == [row["px"], row["py"], row["pz"]]).all()
        quaternions = file["motion/orientation"][:, 0]
        assert np.abs(np.linalg.norm(quaternions, axis=1) - 1).max() < 1e-15
        assert list(file["bodies/first_step"]) == [0, 10, 0, 0]
        assert np.isnan(file["motion/position"][:10, 1]).all()
        assert list(file["bodies/chosen"]) == [1, 1, 0, 0]
        assert list(file["bodies/fixed"]) == [0, 0, 1, 1]
        assert json.loads(file["meshes/hero"].attrs["shape"])["file"] == "replay_example/hero.obj"
        assert file["meshes/hero/vertices"].shape == (5, 3)
        # The square became a fan from its first corner.
        assert file["meshes/hero/triangles"][-2:].tolist() == [[1, 4, 3], [1, 3, 2]]
        inputs = json.loads(file.attrs["inputs_sha256"])
        assert set(inputs) == {"replay_example/hero.obj", "replay_example/poses.csv"}
        for name, digest in inputs.items():
            found = subprocess.run(["sha256sum", ROOT / "configs" / name], capture_output=True, text=True).stdout
            assert found.split()[0] == digest


def pairs(file, group, prefix=""):
    """One set of pairs per step."""
    offset, pair = file[f"{group}/{prefix or 'pair_'}offset"][()], file[f"{group}/{prefix}pair"][()]
    return [set(map(tuple, pair[a:b])) for a, b in zip(offset[:-1].astype(int), offset[1:].astype(int))]


def test_contained_pairs_are_listed_and_counted_apart(example):
    with h5py.File(example) as file:
        assert file["truth"].attrs["containment"] == "record"
        truth, inside = pairs(file, "truth"), pairs(file, "truth", "contained_")
        assert [len(step) for step in truth] == list(file["truth/hits"])
        assert all(not (a & b) for a, b in zip(truth, inside))
        # The hero's points are within 0.9 m of it, the box is 2.5 m long: inside around z = 0, outside at the start.
        assert (0, 2) in inside[20] and (0, 2) not in inside[0] and (0, 2) in truth[9]
        counted = 0
        for a, label in enumerate(file["algorithm"].asstr()):
            for step, hits in enumerate(pairs(file, f"answers/{label}")):
                column = {name: int(file[f"results/{name}"][step, a]) for name in
                          ("hits", "true_positive", "false_positive", "false_negative", "contained_hit")}
                assert column["hits"] == column["true_positive"] + column["false_positive"] + column["contained_hit"]
                assert column["contained_hit"] == len(hits & inside[step])
                assert column["false_positive"] == len(hits - truth[step] - inside[step])
                assert column["false_negative"] == len(truth[step] - hits)
                counted += column["contained_hit"]
            assert file["summary/contained_hit"][a] == file["results/contained_hit"][:, a].sum()
        assert counted > 0


def test_meet_scores_by_the_union_and_ignore_leaves_containment_out(example, tmp_path):
    for containment in ("meet", "ignore"):
        path = tmp_path / f"{containment}.h5"
        run = pipeline("run", EXAMPLE, "-o", path, "--set", f"truth.containment={containment}")
        assert run.returncode in (DONE, 1), run.stderr
        with h5py.File(path) as file, h5py.File(example) as recorded:
            truth, inside = pairs(recorded, "truth"), pairs(recorded, "truth", "contained_")
            assert pairs(file, "truth") == truth
            assert "contained_hit" not in file["results"] and "contained_hit" not in file["summary"]
            if containment == "ignore":
                assert "contained_pair" not in file["truth"]
                inside = [set() for _ in truth]
            else:
                assert pairs(file, "truth", "contained_") == inside
            assert list(file["truth/hits"]) == [len(a | b) for a, b in zip(truth, inside)]
            for a, label in enumerate(file["algorithm"].asstr()):
                for step, hits in enumerate(pairs(file, f"answers/{label}")):
                    scoring = truth[step] | inside[step]
                    assert file["results/true_positive"][step, a] == len(hits & scoring)
                    assert file["results/false_positive"][step, a] == len(hits - scoring)
                    assert file["results/false_negative"][step, a] == len(scoring - hits)


def test_load_gives_contained_pairs(example, result_file):
    run = load(example)
    with h5py.File(example) as file:
        assert run.contained_pairs[["a", "b"]].to_numpy().tolist() == file["truth/contained_pair"][()].tolist()
        assert list(run.summary["contained_hit"]) == list(file["summary/contained_hit"])
    assert load(result_file).contained_pairs is None


def test_show_and_detect_know_contained_hits(example, tmp_path):
    path = shutil.copy(example, tmp_path / "copy.h5")
    run = pipeline("detect", path, "--algorithm", "obb_sat@again", "--json")
    assert run.returncode == DONE, run.stderr
    rows = {row["label"]: row for row in json.loads(run.stdout)["algorithms"]}
    assert rows["again"]["contained_hit"] == rows["obb_sat"]["contained_hit"] > 0
    assert "contained hits" in pipeline("show", path).stdout


def test_detect_needs_the_result_only(copy, tmp_path):
    path = tmp_path / "x.h5"
    assert pipeline("run", copy, "-o", path).returncode == DONE
    shutil.rmtree(tmp_path / "replay_example")
    run = pipeline("detect", path, "--force")
    assert run.returncode == DONE, run.stderr
    assert pipeline("show", path, "--json").returncode == DONE


# ---- the motion of an earlier result


def test_motion_of_an_earlier_result_is_replayed_bit_for_bit(result_file, tmp_path):
    config = tmp_path / "again.toml"
    text = f'[scene]\nkind = "replay"\nmotion = "{result_file}"\n'
    with h5py.File(result_file) as file:
        labels = list(file["algorithm"].asstr()[()])
        for label in labels:
            knobs = json.loads(file["answers"][label].attrs["knobs"])
            text += f'[[algorithm]]\nname = "{file["answers"][label].attrs["name"]}"\nlabel = "{label}"\n'
            text += "".join(f"{key} = {json.dumps(value)}\n" for key, value in knobs.items())
    config.write_text(text)
    path = tmp_path / "again.h5"
    run = pipeline("run", config, "-o", path)
    assert run.returncode == DONE, run.stderr
    with h5py.File(result_file) as old, h5py.File(path) as new:
        assert "physics" not in new
        assert new["time"].attrs["rate"] == old["time"].attrs["rate"]
        for group in ["motion", "truth", *(f"answers/{label}" for label in labels)]:
            assert new[group].attrs["digest"] == old[group].attrs["digest"]
        assert (new["motion/position"][()].tobytes()) == old["motion/position"][()].tobytes()
        assert list(json.loads(new.attrs["inputs_sha256"])) == [str(result_file)]
        bodies = old["body"].asstr()[()]

    # Fewer steps and fewer pairs, but not more steps.
    few = tmp_path / "few.h5"
    config.write_text(text.replace("[scene]\n", f'steps = 60\n[scene]\nonly = ["{bodies[0]}"]\n'))
    assert pipeline("run", config, "-o", few).returncode == DONE
    with h5py.File(few) as file, h5py.File(path) as whole:
        assert pairs(file, "truth") == [{pair for pair in step if 0 in pair} for step in pairs(whole, "truth")[:60]]
    config.write_text("steps = 1000\n" + text)
    run = pipeline("run", config, "-o", tmp_path / "more.h5")
    assert run.returncode == INPUT and "'steps' must be at most" in one_line(run)


def test_motion_must_be_a_result(tmp_path):
    (tmp_path / "x.toml").write_text('[scene]\nkind = "replay"\nmotion = "x.h5"\n')
    (tmp_path / "x.h5").write_text("no result")
    run = pipeline("run", "x.toml", cwd=tmp_path)
    assert run.returncode == FILE and "x.h5: is not an HDF5 file" in one_line(run)


# ---- what users get wrong


def change(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


HOSTILE = {
    "missing mesh": ("replay_example.toml", '"replay_example/hero.obj"', '"none.obj"', "replay_example.toml:18:9: "),
    "NaN in a mesh": ("replay_example/hero.obj", "v 0.5 ", "v nan ", "hero.obj:3: "),
    "index out of range": ("replay_example/hero.obj", "f 1 3 4", "f 1 3 6", "hero.obj:8: index 6 "),
    "gap": ("replay_example/poses.csv", "\n7,hero", "\n8,hero", "poses.csv:10: step 8 comes after step 6"),
    "disappears": ("replay_example/poses.csv", "\n12,drone,", "\n12,dr,", "poses.csv:18: there is no body"),
    "duplicate": ("replay_example/poses.csv", "\n11,drone", "\n11,hero", 'poses.csv:16: a second row of body "hero"'),
    "unknown body": ("replay_example/poses.csv", "3,hero", "3,herro", 'poses.csv:6: there is no body "herro"'),
    "columns": ("replay_example/poses.csv", "0,gate,0,0,", "0,gate,0,", "poses.csv:2: must have 9 columns, not 8"),
    "order": ("replay_example/poses.csv", "\n5,hero", "\n3,hero", "poses.csv:8: step 3 comes after step 4"),
    "norm": ("replay_example/poses.csv", "2.2,1,0,0,0", "2.2,1.01,0,0,0", "poses.csv:2: the quaternion"),
    "no number": ("replay_example/poses.csv", "0,gate,0,", "0,gate,zero,", "poses.csv:2: px must be a number"),
    "more steps": ("replay_example.toml", "rate  = 30", "steps = 999\nrate = 30", "replay_example.toml:9:9: 'steps'"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_bad_input_is_one_line_with_its_place_and_nothing_is_written(copy, name):
    file, old, new, place = HOSTILE[name]
    change(copy.parent / file, old, new)
    before = sorted(copy.parent.rglob("*"))
    for command in ("check", "run"):
        run = pipeline(command, copy.name, cwd=copy.parent)
        assert run.returncode == INPUT
        assert place in one_line(run)
        assert run.stdout == ""
    assert sorted(copy.parent.rglob("*")) == before


def test_open_and_degenerate_meshes_are_used_and_said(copy, tmp_path):
    change(tmp_path / "replay_example" / "hero.obj", "f 2 5 4 3\n", "f 1 1 2\n")
    run = pipeline("run", copy, "-o", tmp_path / "x.h5", "--set", "truth.containment=ignore")
    assert run.returncode == DONE
    lines = run.stderr.splitlines()
    assert len(lines) == 2 and "hero.obj: the surface is open" in lines[0] and "no area" in lines[1]


def test_no_run_replaces_a_file_that_it_reads(copy, tmp_path):
    for output in (copy, tmp_path / "replay_example" / "hero.obj", tmp_path / "replay_example" / "poses.csv"):
        before = output.read_bytes()
        run = pipeline("run", copy, "-o", output, "--force")
        assert run.returncode == FILE and "is read by this run" in one_line(run)
        assert output.read_bytes() == before


def test_changed_input_does_not_resume_an_old_part(copy, tmp_path):
    path, part = tmp_path / "x.h5", tmp_path / "x.h5.part"
    # A thousand repeats, so that there is time to kill the run before it is done.
    run = subprocess.Popen([PIPELINE, "run", str(copy), "-o", str(path), "--set", "timing.repeats=1000"])
    while run.poll() is None and not (part / "truth-0000000").exists():
        pass
    run.kill()
    run.wait()
    if not part.exists():
        pytest.skip("the run was quicker than the signal")
    change(tmp_path / "replay_example" / "poses.csv", "0,gate,0,", "0,gate,0.5,")
    run = pipeline("run", copy, "-o", path, "--set", "timing.repeats=1000")
    assert run.returncode == FILE and "other input files" in one_line(run)
    assert pipeline("run", copy, "-o", path, "--force").returncode == DONE


def test_two_million_triangles_are_work(tmp_path):
    """A grid of 1000 x 1000 squares as binary PLY, over which a box flies."""
    n = 1000
    x, y = np.meshgrid(np.arange(n + 1) * 0.01, np.arange(n + 1) * 0.01)
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1).astype("<f4")
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)[None, :]).ravel()
    faces = np.zeros(n * n, dtype=[("count", "u1"), ("index", "<i4", 4)])
    faces["count"] = 4
    faces["index"] = np.stack([corner, corner + 1, corner + n + 2, corner + n + 1], axis=1)
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float "
            "y\n"
            f"property float z\nelement face {n * n}\nproperty list uchar int vertex_indices\nend_header\n")
    (tmp_path / "grid.ply").write_bytes(head.encode() + vertices.tobytes() + faces.tobytes())
    (tmp_path / "poses.csv").write_text("step,body,px,py,pz,qw,qx,qy,qz\n"
                                        "0,box,5,5,0.4,1,0,0,0\n1,box,5,5,0.6,1,0,0,0\n")
    (tmp_path / "x.toml").write_text(
        '[scene]\nkind = "replay"\nposes = "poses.csv"\n[[scene.body]]\nname = "box"\nshape = "box"\nsize = [1, 1, 1]\n'
        '[[scene.body]]\nname = "grid"\nmesh = "grid.ply"\nfixed = true\nposition = [0, 0, 0]\n'
        '[timing]\nrepeats = 1\n[[algorithm]]\nname = "obb_sat"\n')
    run = pipeline("run", "x.toml", "-o", "x.h5", cwd=tmp_path)
    assert run.returncode == DONE, run.stderr
    with h5py.File(tmp_path / "x.h5") as file:
        assert file["meshes/grid/triangles"].shape == (2 * n * n, 3)
        assert list(file["truth/hits"]) == [1, 0]
