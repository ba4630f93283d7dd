"""analysis/load.py: the tables agree with one another on every configuration; no other file is read as a result."""

import shutil
import subprocess

import h5py
import numpy as np
import pytest
from editing import edited
from conftest import SCENES

from analysis.__main__ import main
from analysis.intact import check_attributes
from analysis.load import load

configs = pytest.mark.parametrize("config", SCENES, ids=lambda path: path.stem)


@configs
def test_counts_agree_per_step_and_in_total(small_file, config):
    run = load(small_file(config))
    steps, labels = run.meta["steps"], run.meta["algorithms"]
    table = run.per_step.set_index(["step", "algorithm"])
    counts = {
        name: table[name].to_numpy().reshape(steps, len(labels)).astype(int) for name in table.columns if name != "time"
    }
    contained = counts.get("contained_hit", 0)
    np.testing.assert_array_equal(counts["true_positive"] + counts["false_positive"] + contained, counts["hits"])
    truth = np.repeat(run.truth_hits.astype(int)[:, None], len(labels), axis=1)
    np.testing.assert_array_equal(counts["true_positive"] + counts["false_negative"], truth)
    assert (counts["rounding_miss"] <= counts["false_negative"]).all()

    summary = run.summary
    for name in ("hits", "true_positive", "false_positive", "false_negative", "operations"):
        np.testing.assert_array_equal(summary[name].astype(int), counts[name].sum(axis=0), err_msg=name)
    np.testing.assert_allclose(summary.time_mean_ns, counts["time_ns"].mean(axis=0))
    wrong = (summary.false_positive + summary.false_negative).astype(float)
    right = summary.true_positive.astype(float)
    np.testing.assert_allclose(
        summary.error, np.divide(wrong, wrong + right, out=np.zeros(len(labels)), where=wrong + right > 0)
    )


def test_the_configurations_tables_are_not_all_empty(small_file):
    assert sum(load(small_file(config)).truth_hits.sum() > 0 for config in SCENES) >= len(SCENES) - 1


@configs
def test_verdicts_per_pair_add_up_to_the_counts_per_step(small_file, config):
    """The counts are the program's, the verdicts are found here from the lists of pairs: each checks the other."""
    run = load(small_file(config))
    steps = run.meta["steps"]
    for label in run.meta["algorithms"][:12]:
        pairs = run.per_pair(label)
        mine = run.per_step[run.per_step.algorithm == label]
        assert not pairs.duplicated(["step", "a", "b"]).any()
        assert (pairs.a < pairs.b).all()
        for verdict in pairs.verdict.cat.categories:
            found = np.bincount(pairs.step[pairs.verdict == verdict], minlength=steps)
            counted = mine[verdict].to_numpy().astype(int) if verdict in mine else np.zeros(steps, int)
            np.testing.assert_array_equal(found, counted, err_msg=f"{label} {verdict}")


def test_contained_pairs_are_judged_as_the_configuration_says(pipeline, tmp_path):
    """A sphere in a box: nothing crosses, and obb_sat reports it."""
    config = tmp_path / "inside.toml"
    (tmp_path / "poses.csv").write_text("step,body,px,py,pz,qw,qx,qy,qz\n0,ball,0,0,0,1,0,0,0\n")
    for containment, verdict in (("ignore", "false_positive"), ("record", "contained_hit"), ("meet", "true_positive")):
        config.write_text(
            '[scene]\nkind = "replay"\nposes = "poses.csv"\n[truth]\ncontainment ='
            f' "{containment}"\n[[algorithm]]\nname = "obb_sat"\n[[scene.body]]\nname = "ball"\nshape ='
            ' "sphere"\nradius = 0.5\n[[scene.body]]\nname = "room"\nshape = "box"\nsize = [9, 9, 9]\nposition = [0,'
            " 0, 0]\nfixed = true\n"
        )
        path = tmp_path / f"{containment}.h5"
        subprocess.run(
            [pipeline, "run", str(config), "-o", str(path), "--quiet"], check=True, stdout=subprocess.DEVNULL
        )
        assert list(load(path).per_pair("obb_sat").verdict) == [verdict]


# ---- what is no result


@pytest.fixture
def refuse(capsys):
    """Both commands say one line that starts with the path, and end with 4."""

    def check(path, *words):
        for command in (["statements", str(path)], ["report", str(path), "-o", str(path) + ".html"]):
            assert main(command) == 4
            said = capsys.readouterr()
            lines = said.err.splitlines()
            assert len(lines) == 1 and said.out == "", said
            assert lines[0].startswith(f"{path}: ")
            assert all(word in lines[0] for word in words), lines[0]

    return check


def test_what_is_missing_empty_or_something_else_is_refused(tmp_path, refuse):
    refuse(tmp_path / "missing.h5", "no such file")
    refuse(tmp_path, "a folder")
    for content in (b"", b"step,body\n"):
        (tmp_path / "x.h5").write_bytes(content)
        refuse(tmp_path / "x.h5", "not an HDF5 file")
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["data"] = [1, 2, 3]
    refuse(tmp_path / "other.h5", "not a result")


def test_an_unfinished_run_is_named_as_such(tmp_path, refuse):
    part = tmp_path / "x.h5.part"
    part.mkdir()
    (part / "manifest.json").write_text("{}")
    refuse(part, "unfinished run")


def test_a_truncated_file_is_refused(result_file, tmp_path, refuse):
    content = result_file.read_bytes()
    (tmp_path / "cut.h5").write_bytes(content[: len(content) // 2])
    refuse(tmp_path / "cut.h5", "truncated")


@pytest.mark.parametrize("version", [3, 10**6, "1.0", -1])
def test_a_newer_or_odd_schema_is_refused_by_its_number(result_file, tmp_path, refuse, version):
    copy = shutil.copy(result_file, tmp_path / "copy.h5")
    with edited(copy) as changed:
        changed.attrs["schema_version"] = version
    refuse(copy, "schema version", str(version))


def test_damage_within_is_one_line_that_names_the_file(result_file, tmp_path, capsys):
    """Bytes of compressed data are overwritten: HDF5 finds it only when they are read."""
    copy = shutil.copy(result_file, tmp_path / "copy.h5")
    with h5py.File(copy) as file:
        chunk = file["results/time_ns"].id.get_chunk_info(0)
    with open(copy, "r+b") as file:
        file.seek(chunk.byte_offset)
        file.write(b"\xff" * chunk.size)
    assert main(["report", str(copy), "-o", str(tmp_path / "r.html")]) == 4
    said = capsys.readouterr().err
    assert said.startswith(f"{copy}: ") and said.count("\n") == 1, said
    assert not (tmp_path / "r.html").exists()


@pytest.mark.parametrize("name, value", [("transport", 1), ("reason", 0.5), ("threads", "two"), ("steps_done", "all"),
                                         ("files_sha256", "[]")])
def test_attributes_of_methods_of_others_have_the_types_that_the_pipeline_writes(name, value):
    check_attributes("/answers/mine", {"transport": "program", "threads": np.int64(1), "files_sha256": "{}"})
    with pytest.raises(ValueError, match=f"attribute {name} of /answers/mine: "):
        check_attributes("/answers/mine", {name: value})
