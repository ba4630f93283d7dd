"""`pipeline verify`: agrees with true files, finds what was changed in others, and says what it did."""
import json
import shutil

import h5py
import numpy as np
import pytest
from program import DONE, FAILED, FILE, INPUT, ROOT, USAGE, one_line, pipeline

from editing import edited

CLASSES = ("meet", "contained", "boxes_touch")


def verified(*arguments, code=DONE):
    run = pipeline("verify", *arguments, "--json")
    assert run.returncode == code, run.stderr
    return json.loads(run.stdout)


@pytest.fixture(scope="module")
def example(tmp_path_factory):
    """Bodies born later, fixed ones, chosen ones, and some inside others."""
    path = tmp_path_factory.mktemp("verify") / "example.h5"
    assert pipeline("run", ROOT / "configs" / "replay_example.toml", "-o", path, "--quiet").returncode == DONE
    return path


@pytest.fixture
def changed(tmp_path):
    """A function: a copy of a result in which something was changed, with the digests of what it then holds."""

    def make(source, change):
        path = tmp_path / "changed.h5"
        shutil.copy(source, path)
        with edited(path) as file:
            change(file)
        return path

    return make


FALLING, BOX = ROOT / "tests" / "data" / "falling.h5", ROOT / "tests" / "data" / "box.h5"


def pairs_at(file, step, prefix=""):
    offset = file["truth"][(prefix or "pair_") + "offset"]
    return slice(int(offset[step]), int(offset[step + 1]))


def replace_pair(step, index, new, prefix=""):
    """Another pair instead of the one at `index` of the step; the step's list stays sorted."""

    def change(file):
        dataset, at = file["truth"][prefix + "pair"], pairs_at(file, step, prefix)
        rows = [tuple(row) for row in dataset[at]]
        assert new not in rows
        rows[index] = new
        dataset[at] = np.array(sorted(rows), dtype="u4")

    return change


# ---- true files


def test_agrees_about_every_pair_of_recorded_motions(example):
    for path in (BOX, example):
        found = verified(path, "--all")
        assert found["difference"] is None
        with h5py.File(path) as file:
            assert found["meet"] == {"pairs": len(file["truth/pair"]), "checked": len(file["truth/pair"])}
            born, fixed = file["bodies/born"][:], int(file["bodies/fixed"][:].sum())
        assert all(found[name]["pairs"] == found[name]["checked"] for name in CLASSES)
        assert found["pairs"] == sum(found[name]["pairs"] for name in CLASSES) + found["boxes_apart"]["pairs"]
        if path == BOX:  # in the other only pairs with chosen bodies count
            assert found["pairs"] == int((born * (born - 1) // 2 - fixed * (fixed - 1) // 2).sum())
        assert found["boxes_touch"]["pairs"] > 0 and found["boxes_apart"]["pairs"] > 0


def test_a_sample_has_as_many_pairs_as_asked_for_of_every_class(example):
    found = verified(FALLING, "--pairs", 500)
    assert found["checked"] == 500
    assert found["meet"]["checked"] == found["boxes_touch"]["checked"] == 250
    # What a class lacks goes to the others: there are 3 near misses only.
    found = verified(example, "--pairs", 30)
    assert found["boxes_touch"]["pairs"] == 3
    assert [found[name]["checked"] for name in CLASSES] == [14, 13, 3]
    found = verified(example, "--pairs", 10**15)
    assert all(found[name]["checked"] == found[name]["pairs"] for name in CLASSES)


def test_threads_change_nothing(example):
    for path, rest in ((FALLING, ["--pairs", 300]), (example, ["--all"])):
        assert verified(path, *rest, "--threads", 1) == verified(path, *rest, "--threads", 4)


def test_steps_choose_a_range():
    whole, parts = verified(FALLING, "--all"), [verified(FALLING, "--all", "--steps", part) for part in (":3", "3:")]
    assert whole["steps"] == [0, 8] and [part["steps"] for part in parts] == [[0, 3], [3, 8]]
    for name in CLASSES:
        assert whole[name]["pairs"] == sum(part[name]["pairs"] for part in parts)
    assert whole["pairs"] == sum(part["pairs"] for part in parts)


def test_says_what_was_checked(example):
    run = pipeline("verify", example)
    assert run.returncode == DONE and run.stderr == ""
    for word in ("listed as meeting", "listed as contained", "boxes touch", "proved apart", "pairs checked", "agrees"):
        assert word in run.stdout
    assert "contained" not in pipeline("verify", BOX).stdout


def test_no_pairs_at_all(tmp_path):
    config = tmp_path / "lonely.toml"
    config.write_text('[scene]\nkind = "replay"\nposes = "p.csv"\n[[scene.body]]\nname = "one"\nshape = "box"\n'
                      'size = [1, 1, 1]\n[timing]\nrepeats = 1\n[[algorithm]]\nname = "aabb"\n')
    (tmp_path / "p.csv").write_text("step,body,px,py,pz,qw,qx,qy,qz\n0,one,0,0,0,1,0,0,0\n")
    assert pipeline("run", config, "-o", tmp_path / "x.h5").returncode == DONE
    found = verified(tmp_path / "x.h5")
    assert found["pairs"] == found["checked"] == 0 and found["difference"] is None


# ---- changed files


def test_a_pair_changed_without_its_digest_is_damage(tmp_path):
    path = shutil.copy(BOX, tmp_path / "x.h5")
    with edited(path, digests=False) as file:
        file["truth/pair"][0] = file["truth/pair"][0] + [0, 1]
    run = pipeline("verify", path)
    assert run.returncode == FILE and "digest" in one_line(run)


def near_miss(step):
    """A pair whose boxes touch and that does not meet, found by what the file's own `aabb` reported."""
    with h5py.File(FALLING) as file:
        offset = file["answers/aabb/pair_offset"]
        reported = {tuple(row) for row in file["answers/aabb/pair"][offset[step]:offset[step + 1]].tolist()}
        true = {tuple(row) for row in file["truth/pair"][pairs_at(file, step)].tolist()}
    return sorted(reported - true), sorted(true)


def test_the_first_difference_is_found_and_named_with_any_number_of_threads(changed):
    wrong, true = near_miss(5)
    path = changed(FALLING, replace_pair(5, len(true) // 2, wrong[0]))
    lost = true[len(true) // 2]
    first, truth, oracle = min((wrong[0], "meet", "apart"), (lost, "apart", "meet"))
    for threads in (1, 3):
        found = verified(path, "--all", "--threads", threads, code=FAILED)
        assert found["difference"]["step"] == 5 and tuple(found["difference"]["pair"]) == first
        assert (found["difference"]["truth"], found["difference"]["oracle"]) == (truth, oracle)
    assert verified(path, "--all", "--threads", 1, code=FAILED) == verified(path, "--all", "--threads", 3, code=FAILED)
    line = one_line(pipeline("verify", path, "--all"))
    with h5py.File(FALLING) as file:
        names = [file["body"].asstr()[body] for body in first]
    for word in ("step 5", *names, f"truth says {truth}", f"oracle says {oracle}"):
        assert word in line, line
    # Elsewhere the file is as it was.
    assert verified(path, "--all", "--steps", ":5")["difference"] is None
    assert verified(path, "--all", "--steps", "6:")["difference"] is None


def test_a_listed_pair_that_is_far_apart_is_found_by_any_sample(changed):
    _, true = near_miss(7)
    far = next((0, b) for b in range(1, 275) if (0, b) not in true)
    path = changed(FALLING, replace_pair(7, 0, far))
    found = verified(path, "--pairs", 1, code=FAILED)
    assert found["difference"] is not None and found["difference"]["step"] == 7


def test_a_false_containment_is_found(changed, example):
    with h5py.File(example) as file:
        steps = np.flatnonzero(np.diff(file["truth/contained_offset"][:]))
        step = int(steps[len(steps) // 2])
        listed = [tuple(row) for row in file["truth/contained_pair"][pairs_at(file, step, "contained_")].tolist()]
        meeting = [tuple(row) for row in file["truth/pair"][pairs_at(file, step)].tolist()]
    other = next((a, b) for a in range(2) for b in range(a + 1, 4) if (a, b) not in listed + meeting)
    path = changed(example, replace_pair(step, 0, other, "contained_"))
    found = verified(path, "--all", code=FAILED)["difference"]
    assert found["step"] == step and any(said.startswith("contained") for said in (found["truth"], found["oracle"]))


def test_a_listed_pair_of_fixed_bodies_is_none(changed, example):
    with h5py.File(example) as file:
        step = int(np.flatnonzero(np.diff(file["truth/pair_offset"][:]))[0])
        fixed = tuple(np.flatnonzero(file["bodies/fixed"][:]).tolist())
    path = changed(example, replace_pair(step, 0, fixed))
    found = verified(path, "--all", code=FAILED)["difference"]
    assert found["step"] == step
    assert tuple(found["pair"]) != fixed or found["oracle"] == "no pair that counts"


def test_a_moved_body_is_found(changed):
    def move(file):
        position = file["motion/position"]
        body = int(file["truth/pair"][pairs_at(file, 6)][0][1])
        position[6, body] = position[6, body] + [0, 1000, 0]

    found = verified(changed(FALLING, move), "--all", code=FAILED)["difference"]
    assert found["step"] == 6 and found["truth"] == "meet" and found["oracle"] == "apart"


def test_motion_that_is_no_number_takes_part_in_no_pair(changed):
    def unborn(file):
        file["motion/position"][6, int(file["truth/pair"][pairs_at(file, 6)][0][1])] = np.nan
        file["bodies/born"][6] -= 1

    found = verified(changed(FALLING, unborn), "--pairs", 10, code=FAILED)["difference"]
    assert found["step"] == 6 and found["oracle"] == "no pair that counts"


def test_endless_motion_is_said_and_nothing_is_decided(changed):
    def away(file):
        file["motion/position"][3, 17] = [np.inf, 0, 0]

    path = changed(FALLING, away)
    run = pipeline("verify", path)
    assert run.returncode == FAILED and run.stdout == ""
    line = one_line(run)
    with h5py.File(path) as file:
        assert "step 3" in line and file["body"].asstr()[17] in line and "not finite" in line
    assert verified(path, "--steps", "4:")["difference"] is None


# ---- grammar and files


@pytest.mark.parametrize("steps", ["5", "a:b", "-1:3", "1:2:3", "1.0:2", " 1:2", "0:99999999999999999999999"])
def test_steps_of_another_form(steps):
    run = pipeline("verify", BOX, f"--steps={steps}")
    assert run.returncode == USAGE and "A:B" in one_line(run)


@pytest.mark.parametrize("steps", ["0:5", "4:", "2:2", "3:1", "7:9"])
def test_steps_that_are_not_there(steps):
    run = pipeline("verify", BOX, "--steps", steps)
    line = one_line(run)
    assert run.returncode == INPUT and "0:4" in line and steps in line


@pytest.mark.parametrize("arguments", [["--pairs", "0"], ["--pairs", "-3"], ["--pairs", "x"], ["--pairs", "1.5"],
                                       ["--pairs", "5", "--all"], ["--threads", "-1"], []])
def test_wrong_arguments(arguments):
    run = pipeline("verify", *([BOX] if arguments else []), *arguments)
    assert run.returncode == USAGE
    one_line(run)


def test_files_that_cannot_be_verified(tmp_path):
    (tmp_path / "run.h5.part").mkdir()
    (tmp_path / "text.h5").write_text("not HDF5")
    (tmp_path / "cut.h5").write_bytes(BOX.read_bytes()[:100_000])
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    for name, word in (("run.h5.part", "unfinished run"), ("text.h5", "not an HDF5 file"), ("cut.h5", "truncated"),
                       ("other.h5", "another program"), ("missing.h5", "cannot be read"), (".", "folder")):
        run = pipeline("verify", tmp_path / name)
        assert run.returncode == FILE and run.stdout == "", name
        assert word in one_line(run), name
