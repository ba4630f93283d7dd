"""Files of other people as users meet them: polygons, what is left out, what is no file, what is too large."""
import os
import resource
import stat

import h5py
import pytest
from program import DONE, INPUT, one_line, pipeline

HEADER = "step,body,px,py,pz,qw,qx,qy,qz\n"
L = [(4, 0), (4, 1), (1, 1), (1, 4), (0, 4), (0, 0)]


def scene(folder, mesh, poses, more=""):
    (folder / "poses.csv").write_text(HEADER + poses)
    (folder / "c.toml").write_text(
        f'[scene]\nkind = "replay"\nposes = "poses.csv"\n{more}[[scene.body]]\nname = "a"\nmesh = "{mesh}"\n'
        '[[scene.body]]\nname = "b"\nshape = "box"\nsize = [0.4, 0.4, 0.4]\n'
        '[timing]\nrepeats = 1\n[[algorithm]]\nname = "exact"\n')
    return folder / "c.toml"


# The L has area 7 and its notch is empty: a fan from (4, 0) covered the notch, and a box there met it.
@pytest.mark.parametrize("first", range(6))
@pytest.mark.parametrize("backwards", [False, True])
def test_a_box_in_the_notch_of_an_l_does_not_meet_it(tmp_path, first, backwards):
    corners = L[first:] + L[:first]
    corners = corners[::-1] if backwards else corners
    (tmp_path / "l.obj").write_text("".join(f"v {x} {y} 0\n" for x, y in corners) + "f 1 2 3 4 5 6\n")
    # In the notch; across the inner corner; on the thin arm; beside it.
    places = [(1.6, 1.6), (1.1, 1.1), (3.5, 0.5), (3.5, 1.3)]
    rows = "".join(f"{s},a,0,0,0,1,0,0,0\n{s},b,{x},{y},0,1,0,0,0\n" for s, (x, y) in enumerate(places))
    run = pipeline("run", scene(tmp_path, "l.obj", rows), "-o", tmp_path / "r.h5")
    assert run.returncode == DONE, run.stderr
    with h5py.File(tmp_path / "r.h5") as file:
        assert list(file["truth/hits"]) == [0, 1, 1, 0]
    run = pipeline("verify", tmp_path / "r.h5", "--all")
    assert run.returncode == DONE, run.stderr


def test_what_is_left_out_is_one_line(tmp_path):
    (tmp_path / "a.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nf 1 2\nl 1 2\nl 2 3\nf 3\n")
    config = scene(tmp_path, "a.obj", "0,a,0,0,0,1,0,0,0\n0,b,0,0,0,1,0,0,0\n")
    for command in (("check",), ("run", "-o", tmp_path / "r.h5")):
        run = pipeline(command[0], config, *command[1:])
        assert run.returncode == DONE
        assert one_line(run).endswith("a.obj: 2 faces of fewer than 3 corners left out (the first at line 9); "
                                      "2 lines, points or curves left out (the first at line 10)")


# ---- what is no file

KINDS = {"device": "/dev/zero", "folder": ".", "pipe": "fifo"}


@pytest.mark.parametrize("linked", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_only_regular_files_are_read(tmp_path, kind, linked):
    """By its name, before a byte is read: a pipe that nobody writes to would be waited for, /dev/zero never ends."""
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    name = KINDS[kind]
    if linked:
        (tmp_path / "link.obj").symlink_to(name)
        name = "link.obj"
    config = scene(tmp_path, "a.obj", "0,a,0,0,0,1,0,0,0\n")
    text = config.read_text()
    why = f"is a {kind}, not a regular file"
    for key, old in (("scene.body.0.mesh", '"a.obj"'), ("scene.poses", '"poses.csv"')):
        config.write_text(text.replace(old, f'"{name}"'))
        run = pipeline("check", "c.toml", cwd=tmp_path)
        assert run.returncode == INPUT
        assert f"'{key}' must name a file that can be read, not \"{name}\": {name}: {why}" in one_line(run)
    run = pipeline("check", name, cwd=tmp_path)
    assert run.returncode == INPUT and one_line(run) == f"{name}: the configuration {why}; name a TOML file"


def test_a_file_beyond_the_memory_is_refused_with_its_size(tmp_path):
    size = 2**42
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if memory > size:
        pytest.skip("this machine could read it")
    config = scene(tmp_path, "a.obj", "0,a,0,0,0,1,0,0,0\n")
    (tmp_path / "a.obj").touch()
    try:
        os.truncate(tmp_path / "a.obj", size)  # a hole, on no disk
    except OSError:
        pytest.skip("the file system has no such files")
    run = pipeline("check", config)
    assert run.returncode == INPUT
    assert f"a.obj: has {size} bytes; such a file has at most {memory // 2}" in one_line(run)


def test_a_pipe_into_the_standard_input_is_no_configuration(tmp_path):
    run = pipeline("check", "/dev/stdin", input="seed = 1\n")
    assert run.returncode == INPUT and "/dev/stdin: the configuration is a pipe" in one_line(run)
    assert stat.S_ISCHR(os.stat("/dev/zero").st_mode)  # what the tests above call a device


# ---- what is too large


def test_steps_times_bodies_are_refused_before_they_are_made(tmp_path):
    """One body moves for 2 million steps beside 5000 that stand: 50 MB of CSV, 560 GB of poses."""
    steps, bodies = 2_000_000, 5000
    row = ",a,0,0,0,1,0,0,0\n"
    (tmp_path / "poses.csv").write_text(HEADER + "".join(f"{step}{row}" for step in range(steps)))
    text = ('[scene]\nkind = "replay"\nposes = "poses.csv"\n'
            '[[scene.body]]\nname = "a"\nshape = "box"\nsize = [1, 1, 1]\n')
    text += "".join(f'[[scene.body]]\nname = "w{b}"\nshape = "box"\nsize = [1, 1, 1]\nfixed = true\n'
                    f"position = [{b}, 5, 0]\n" for b in range(bodies))
    (tmp_path / "c.toml").write_text(text)

    def little():
        resource.setrlimit(resource.RLIMIT_AS, (2**31, 2**31))

    for command in ("check", "run"):
        run = pipeline(command, "c.toml", cwd=tmp_path, preexec_fn=little)
        assert run.returncode == INPUT
        assert one_line(run).startswith("the run needs about ") and "of memory" in one_line(run)


# ---- the order of quaternions


def test_a_motion_that_begins_with_half_turns_is_asked_about(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
    rows = "0,a,0,0,0,0,0,0,1\n0,b,0,0,0,0,0,0,1\n1,a,0,0,0,0,0,0,1\n1,b,0,0,0,0,0,0,1\n"  # x, y, z, w
    config = scene(tmp_path, "a.obj", rows)
    asked = one_line(pipeline("check", config))
    assert "poses.csv: the first quaternion of every body has qw = 0" in asked
    assert "end with qx,qy,qz,qw" in asked and "scene.half_turns = true" in asked
    run = pipeline("run", config, "-o", tmp_path / "asked.h5")
    assert run.returncode == DONE and "qw = 0" in run.stderr

    # Meant: the same motion, said no more, and the result knows that it was confirmed.
    run = pipeline("run", config, "-o", tmp_path / "meant.h5", "--set", "scene.half_turns=true")
    assert run.returncode == DONE and run.stderr == ""
    with h5py.File(tmp_path / "asked.h5") as asked_file, h5py.File(tmp_path / "meant.h5") as file:
        assert file["motion"].attrs["digest"] == asked_file["motion"].attrs["digest"]
        assert "half_turns = true" in file["config"].attrs["effective"]
        assert "half_turns" not in asked_file["config"].attrs["effective"]

    # Not meant: the header says the order.
    scene(tmp_path, "a.obj", rows)
    csv = tmp_path / "poses.csv"
    csv.write_text(csv.read_text().replace("qw,qx,qy,qz", "qx,qy,qz,qw"))
    run = pipeline("run", config, "-o", tmp_path / "ordered.h5")
    assert run.returncode == DONE and run.stderr == ""
    with h5py.File(tmp_path / "ordered.h5") as file:
        assert (file["motion/orientation"][()] == [1, 0, 0, 0]).all()
