"""A robot from URDF and a trajectory of its joints, scored end to end; and what its files get wrong."""
import json
import os
import shutil
import xml.etree.ElementTree as xml

import h5py
import numpy as np
import pytest
from program import DONE, INPUT, ROOT, one_line, pipeline

EXAMPLE = ROOT / "configs" / "arm_example.toml"


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.h5"
    run = pipeline("run", EXAMPLE, "--set", "timing.repeats=1", "-o", path)
    assert run.returncode == DONE, run.stderr
    return path


@pytest.fixture
def copy(tmp_path):
    """The example, free to be changed."""
    shutil.copy(EXAMPLE, tmp_path)
    shutil.copytree(ROOT / "configs" / "arm_example", tmp_path / "arm_example")
    return tmp_path / "arm_example.toml"


# ---- forward kinematics by products of matrices, as URDF defines them


def about(axis, angle):
    axis = np.array(axis, float) / np.linalg.norm(axis)
    cross = np.cross(np.eye(3), axis)  # cross @ v is axis x v
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def transform(turn=np.eye(3), shift=(0, 0, 0)):
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = turn, shift
    return out


def origin(element):
    element = element.find("origin")
    numbers = {key: [float(x) for x in (element.get(key) if element is not None else None or "0 0 0").split()]
               if element is not None and element.get(key) else [0, 0, 0] for key in ("xyz", "rpy")}
    r, p, y = numbers["rpy"]
    return transform(about([0, 0, 1], y) @ about([0, 1, 0], p) @ about([1, 0, 0], r), numbers["xyz"])


def places(urdf, values):
    """Where each link is, for values of the joints by name."""
    joints = {joint.find("child").get("link"): joint for joint in xml.parse(urdf).getroot().findall("joint")}

    def place(link):
        if link not in joints:
            return np.eye(4)
        joint = joints[link]
        axis = [float(x) for x in joint.find("axis").get("xyz").split()]
        value = values[joint.get("name")]
        slides = joint.get("type") == "prismatic"
        moved = transform(shift=value * np.array(axis)) if slides else transform(about(axis, value))
        return place(joint.find("parent").get("link")) @ origin(joint) @ moved

    return {link.get("name"): place(link.get("name")) for link in xml.parse(urdf).getroot().findall("link")}


def turned(q):
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def test_links_are_where_products_of_matrices_put_them(arm):
    table = np.genfromtxt(ROOT / "configs/arm_example/joints.csv", delimiter=",", skip_header=1)
    names = ["turn", "lift", "elbow", "roll", "bend", "reach"]
    with h5py.File(arm) as file:
        bodies = list(file["body"].asstr()[()])
        assert file["step"].shape == (len(table),)
        assert file["time"].attrs["rate"] == pytest.approx(30, rel=1e-4)  # times have four decimals
        for step in (0, 17, 90, 180):
            values = dict(zip(names, table[step, 1:]))
            values["reach"] /= 1000  # the column is in mm
            for link, expected in places(ROOT / "configs/arm_example/arm.urdf", values).items():
                b = bodies.index(f"arm.{link}")
                assert file["motion/position"][step, b] == pytest.approx(expected[:3, 3], abs=1e-14)
                assert turned(file["motion/orientation"][step, b]) == pytest.approx(expected[:3, :3], abs=1e-14)


def test_the_arm_is_scored_end_to_end(arm):
    with h5py.File(arm) as file:
        bodies = list(file["body"].asstr()[()])
        links = ["base", "shoulder", "upper_arm", "forearm", "wrist", "palm", "tip"]
        assert bodies == ["table", "post"] + [f"arm.{link}" for link in links]
        assert list(file["bodies/fixed"]) == [1, 1, 1, 0, 0, 0, 0, 0, 0]
        offset, pair = file["truth/pair_offset"][()].astype(int), file["truth/pair"][()]
        met = {tuple(p) for p in pair}
        post = bodies.index("post")
        assert any(post in p for p in met), "the arm meets the post"
        assert (bodies.index("table"), bodies.index("arm.base")) not in met, "both are fixed, though they touch"
        assert offset[-1] == len(pair) > 100
        summary = {label: file["summary/error"][i] for i, label in enumerate(file["algorithm"].asstr()[()])}
        assert len(summary) == 9 and all(0 < error < 1 for error in summary.values()), summary
        # Two collisions of the forearm are one body: a box and a cylinder of 32 sides.
        assert len(file["meshes/arm.forearm/triangles"]) == 12 + (32 * 2 + 2 * 30)
        tip = file["meshes/arm.tip/vertices"][()]
        assert tip.max(0) - tip.min(0) == pytest.approx([0.1, 0.06, 0.04])
        assert json.loads(file["meshes/arm.tip"].attrs["shape"]) == {"file": "arm_example/arm.urdf", "link": "tip"}
        assert set(json.loads(file.attrs["inputs_sha256"])) == {
            "arm_example/arm.urdf", "arm_example/joints.csv", "arm_example/wedge.obj"}
    shown = pipeline("check", EXAMPLE)
    assert "read        " in shown.stdout and "joints turn, lift, elbow, roll, bend, reach [mm]" in shown.stdout
    assert "arm.base: 124 facets, closed" in shown.stdout and "fixed" in shown.stdout
    verified = pipeline("verify", arm, "--steps", "0:20")
    assert verified.returncode == DONE, verified.stderr


def test_the_root_stands_where_the_configuration_has_it(copy, arm):
    text = copy.read_text().replace("position = [0, 0, 0]  ", "orientation = [0, 1, 0, 0]\nposition = [1, 2, 3]  ")
    copy.write_text(text)
    path = copy.parent / "moved.h5"
    assert pipeline("run", copy, "--set", "steps=3", "-o", path).returncode == DONE
    with h5py.File(arm) as old, h5py.File(path) as new:
        before, after = old["motion/position"][2, 2:], new["motion/position"][2, 2:]
        assert after == pytest.approx(before * [1, -1, -1] + [1, 2, 3], abs=1e-14)


def test_a_joint_that_follows_another(copy):
    urdf = copy.parent / "arm_example/arm.urdf"
    urdf.write_text(urdf.read_text().replace('<axis xyz="1 0 0"/>\n    <limit lower="0" upper="0.1"',
                                             '<axis xyz="1 0 0"/>\n    <mimic joint="lift" multiplier="0.1" '
                                             'offset="0.02"/>\n    <limit lower="0" upper="0.1"'))
    joints = copy.parent / "arm_example/joints.csv"
    rows = [line.rsplit(",", 1)[0] for line in joints.read_text().splitlines()]
    joints.write_text("\n".join(rows) + "\n")
    path = copy.parent / "x.h5"
    run = pipeline("run", copy, "--set", "steps=30", "-o", path)
    assert run.returncode == DONE, run.stderr
    row = [float(x) for x in rows[30].split(",")]
    values = dict(zip(["turn", "lift", "elbow", "roll", "bend"], row[1:]))
    expected = places(urdf, {**values, "reach": 0.1 * values["lift"] + 0.02})["tip"]
    with h5py.File(path) as file:
        assert file["motion/position"][29, 8] == pytest.approx(expected[:3, 3], abs=1e-14)


# ---- what users get wrong


URDF, JOINTS = "arm_example/arm.urdf", "arm_example/joints.csv"
BROKEN = {
    "truncated": (URDF, "</robot>", "", "arm.urdf:"),
    "no robot": (URDF, '<robot name="arm">', "<sdf>", "arm.urdf:"),
    "a circle": (URDF, '<parent link="base"/>', '<parent link="tip"/>', "hangs on itself: the joints make a circle"),
    "two parents": (URDF, '<child link="tip"/>', '<child link="wrist"/>',
                    'link "wrist" hangs on two joints, "roll" and "reach"'),
    "two roots": (URDF, '<link name="base">', '<link name="lost"/><link name="base">',
                  'links "lost" and "base" both hang on nothing'),
    "two links of one name": (URDF, '<link name="palm">', '<link name="tip">', 'a second link is named "tip"'),
    "two joints of one name": (URDF, '<joint name="bend"', '<joint name="roll"', 'a second joint is named "roll"'),
    "no such link": (URDF, '<child link="palm"/>', '<child link="plam"/>', 'there is no link "plam"'),
    "a missing mesh": (URDF, "wedge.obj", "wegde.obj", 'no folder "arm_example" above the file has it'),
    "a missing mesh beside": (URDF, "package://arm_example/wedge.obj", "wegde.obj",
                              "must name a file that can be read"),
    "mirrored": (URDF, 'scale="0.001 0.001', 'scale="0.001 -0.001', "'scale' of <mesh> must be three numbers above 0"),
    "no number": (URDF, 'radius="0.12"', 'radius="wide"', "arm.urdf:7: 'radius' of <cylinder> must be 1 number"),
    "too few numbers": (URDF, 'size="0.1 0.06 0.5"', 'size="0.1 0.06"', "'size' of <box> must be 3 numbers"),
    "flat": (URDF, 'size="0.1 0.06 0.5"', 'size="0.1 0.06 0"', "must be three numbers above 0"),
    "no axis": (URDF, '<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>', "the axis must not be 0"),
    "limits the wrong way": (URDF, 'lower="0" upper="0.1"', 'lower="0.1" upper="0"',
                             "'lower' of <limit> is above 'upper'"),
    "another shape": (URDF, "<sphere", "<capsule", "<capsule> is no shape of URDF"),
    "another joint": (URDF, 'type="continuous"', 'type="ball"', "must be revolute, continuous, prismatic or fixed"),
    "xacro": (URDF, '<link name="base">', '<xacro:include filename="x"/><link name="base">',
              "is xacro; expand it first"),
    "a joint without a column": (JOINTS, "elbow", "elbo", 'joints.csv:1: joint "elbow" has no column; did you mean'),
    "two columns of a joint": (JOINTS, "roll", "turn", 'two columns are of joint "turn"'),
    "a wrong unit": (JOINTS, "reach [mm]", "reach [deg]", 'the unit of "reach [deg]" must be m, cm or mm'),
    "no time": (JOINTS, "time,", "tiem,", "has neither a column 'step' nor 'time'"),
    "time goes back": (JOINTS, "\n0.1000,", "\n0.0100,",
                       "joints.csv:5: time 0.01 comes after 0.0667; times must increase"),
    "two rows of a time": (JOINTS, "\n0.1000,", "\n0.0667,", "joints.csv:5: a second row of the same step"),
    "no value": (JOINTS, "\n0.1000,0.14634,", "\n0.1000,,", "joints.csv:5: turn must be a number"),
    "a row too short": (JOINTS, "\n0.1000,0.14634,", "\n0.1000,", "joints.csv:5: must have 7 columns, not 6"),
}


@pytest.mark.parametrize("what", BROKEN)
def test_broken_files_are_refused_in_one_line(what, copy):
    name, old, new, message = BROKEN[what]
    path = copy.parent / name
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    before = sorted(os.listdir(copy.parent))
    run = pipeline("run", copy.name, "-o", "out.h5", cwd=copy.parent)
    assert run.returncode == INPUT, run.stderr
    assert message in one_line(run) and name in one_line(run)
    assert sorted(os.listdir(copy.parent)) == before


def test_what_is_wrong_with_the_keys_is_said(copy):
    text = copy.read_text()
    cases = {
        text.replace("joints   =", "#"): "has joints that move; give their values, 'joints', a CSV file",
        text.replace("urdf     =", "#"): "missing key 'scene.robot.0.urdf'",
        text.replace('name     = "arm"', 'name = "a b"'): "'scene.robot.0.name' must be 1 to 64 characters",
        text.replace('name     = "arm"  ', "") .replace('"table"', '"palm"'): "another body is named \"palm\"",
        text.replace("position = [0, 0, 0]  ", "orientation = [1, 1, 0, 0]"): "of length 1 within 1e-6",
    }
    for changed, message in cases.items():
        assert changed != text
        copy.write_text(changed)
        run = pipeline("check", copy)
        assert run.returncode == INPUT and message in one_line(run), run.stderr


def test_joints_beyond_their_limits_are_said(copy):
    joints = copy.parent / JOINTS
    joints.write_text(joints.read_text().replace("\n0.1000,0.14634,", "\n0.1000,3.5,"))
    run = pipeline("check", copy)
    assert run.returncode == DONE
    assert "joint 'turn' is beyond its limits in 1 of 181 rows, the first at line 5" in run.stderr
