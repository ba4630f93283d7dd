"""What methods test in place of meshes, as users meet it: the result's tables, export, files of their own, mistakes."""
import hashlib
import json
import os
import shutil

import h5py
import numpy as np
import pytest
from program import DONE, FILE, INPUT, one_line, pipeline

from analysis.load import load

CUBE = """v -{0} -{0} -{0}\nv {0} -{0} -{0}\nv {0} {0} -{0}\nv -{0} {0} -{0}
v -{0} -{0} {0}\nv {0} -{0} {0}\nv {0} {0} {0}\nv -{0} {0} {0}
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
"""

# A cube of 2 m comes down upon one that stands: at step s their faces are 4 - s m apart, from step 4 on they meet.
SCENE = """rate = 10
[scene]
kind = "replay"
poses = "poses.csv"
[[scene.body]]
name = "hero"
mesh = "hero.obj"
[[scene.body]]
name = "wall"
mesh = "wall.obj"
fixed = true
[timing]
repeats = 1
"""

METHODS = """
[[algorithm]]
name = "spheres"
[[algorithm]]
name = "capsule"
[[algorithm]]
name = "hulls"
[[algorithm]]
name = "exact"
"""

PROXY = """
[[algorithm]]
name = "proxy"
file = {hero = "hero_hull.obj", wall = "wall_hull.obj"}
"""


def folder(path, algorithms=METHODS + PROXY):
    for name, half in {"hero": 1, "wall": 1, "hero_hull": 1.6, "wall_hull": 0.9}.items():
        (path / f"{name}.obj").write_text(CUBE.format(half))
    rows = ["step,body,px,py,pz,qw,qx,qy,qz", "0,wall,0,0,0,1,0,0,0"]
    rows += [f"{step},hero,0,{6 - step},0,1,0,0,0" for step in range(7)]
    (path / "poses.csv").write_text("\n".join(rows) + "\n")
    config = path / "scene.toml"
    config.write_text(SCENE + algorithms)
    return config


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    path = tmp_path_factory.mktemp("proxies")
    output = path / "scene.h5"
    run = pipeline("run", folder(path), "-o", output, "--quiet")
    assert run.returncode == DONE, run.stderr
    return output


def first_hit(path, label):
    return int(load(path).pairs(label)["step"].min())


def test_table_and_groups_tell_the_same(ran):
    table = load(ran).proxies
    assert list(table["label"]) == ["spheres"] * 2 + ["capsule"] * 2 + ["hulls"] * 2 + ["proxy"] * 2
    assert list(table["mesh"]) == ["hero", "wall"] * 4
    assert list(table["kind"]) == ["balls"] * 2 + ["capsule"] * 2 + ["solids"] * 4
    with h5py.File(ran) as file:
        for row in table.itertuples():
            group = file[f"meshes/{row.mesh}/proxies/{row.label}"]
            assert group.attrs["kind"] == row.kind
            assert group.attrs["outside_share"] == row.outside_share
            assert group.attrs["outside_greatest"] == row.outside_greatest
        assert "exact" not in file["meshes/hero/proxies"]
        assert file["meshes/hero/proxies/hulls/vertices"].attrs["units"] == "m"


def test_wrappers_wrap_and_a_small_proxy_is_told(ran):
    table = load(ran).proxies.set_index(["label", "mesh"])
    for label in ("spheres", "capsule", "hulls"):
        assert (table.loc[label, "outside_share"] == 0).all() and (table.loc[label, "outside_greatest"] == 0).all()
    assert table.loc[("proxy", "hero"), "outside_share"] == 0
    # A corner at 1, 1, 1; the proxy's at 0.9, 0.9, 0.9.
    assert table.loc[("proxy", "wall"), "outside_share"] == 1
    greatest = table.loc[("proxy", "wall"), "outside_greatest"]
    assert 0.1 * 3**0.5 <= greatest <= 0.1 * 3**0.5 + 1e-12


def test_shapes_hold_the_mesh(ran):
    run = load(ran)
    with h5py.File(ran) as file:
        vertices = file["meshes/hero/vertices"][()]
    balls = run.proxy("spheres", "hero")["balls"]
    distance = np.linalg.norm(vertices[:, None] - balls[None, :, :3], axis=2)
    assert (distance <= balls[:, 3]).any(axis=1).all()
    (a, b), radius = run.proxy("capsule", "hero")["balls"][:, :3], run.proxy("capsule", "hero")["balls"][0, 3]
    along = np.clip((vertices - a) @ (b - a) / max((b - a) @ (b - a), 1e-300), 0, 1)
    assert (np.linalg.norm(vertices - (a + along[:, None] * (b - a)), axis=1) <= radius).all()
    hull = run.proxy("hulls", "hero")
    assert sorted(map(tuple, hull["vertices"])) == sorted(map(tuple, vertices))
    assert list(hull["solid_offset"]) == [0, 12] and hull["triangles"].shape == (12, 3)
    with pytest.raises(KeyError):
        run.proxy("exact", "hero")


def test_answers_are_those_of_the_proxies(ran):
    # The hero is at 6 - s m. The cubes touch at 2 m, the proxies at 1.6 + 0.9 = 2.5 m; eight balls of sqrt(3) / 2 m
    # about the octants' middles at 2 (0.5 + 0.866) = 2.73 m, capsules, balls of sqrt(3) m here, at 3.46 m.
    assert first_hit(ran, "exact") == 4 and first_hit(ran, "hulls") == 4 and first_hit(ran, "proxy") == 4
    assert first_hit(ran, "spheres") == 4 and first_hit(ran, "capsule") == 3


def test_files_stand_among_the_inputs(ran):
    with h5py.File(ran) as file:
        inputs = json.loads(file.attrs["inputs_sha256"])
        knobs = json.loads(file["answers/proxy"].attrs["knobs"])
    assert knobs == {"file": "hero=hero_hull.obj;wall=wall_hull.obj"}
    text = (ran.parent / "hero_hull.obj").read_bytes()
    assert inputs["hero_hull.obj"] == hashlib.sha256(text).hexdigest() and "wall_hull.obj" in inputs


def test_show_tells_who_sticks_out(ran):
    text = pipeline("show", ran).stdout
    assert "in place of meshes" in text and "1 of 2 meshes" not in text
    line = next(line for line in text.splitlines() if line.startswith("proxy ") and "meshes;" in line)
    assert "of 1 meshes; 100 % of wall" in line and "0.173 m (wall)" in line
    rows = json.loads(pipeline("show", ran, "--json").stdout)["proxies"]
    assert rows[0] == {"label": "spheres", "mesh": "hero", "kind": "balls", "parts": rows[0]["parts"],
                       "outside_share": 0, "outside_greatest": 0}


def test_detect_asks_again_without_the_files_and_ends_with_the_same_content(ran, tmp_path):
    copy = tmp_path / "again.h5"
    shutil.copy(ran, copy)
    run = pipeline("detect", copy, "--force", "--quiet")
    assert run.returncode == DONE, run.stderr
    with h5py.File(ran) as one, h5py.File(copy) as other:
        assert one.attrs["digest"] == other.attrs["digest"]


def test_detect_adds_what_a_run_would_have_had(ran, tmp_path):
    config = folder(tmp_path, METHODS)
    output = tmp_path / "later.h5"
    assert pipeline("run", config, "-o", output, "--quiet").returncode == DONE
    argument = "proxy:file=hero=hero_hull.obj;wall=wall_hull.obj"
    run = pipeline("detect", output, "--algorithm", argument, "--quiet", cwd=tmp_path)
    assert run.returncode == DONE, run.stderr
    with h5py.File(ran) as one, h5py.File(output) as other:
        assert one.attrs["digest"] == other.attrs["digest"]
        assert "hero_hull.obj" in json.loads(other.attrs["inputs_sha256"])


def test_a_result_without_such_methods_has_no_table(tmp_path):
    config = folder(tmp_path, '\n[[algorithm]]\nname = "exact"\n')
    output = tmp_path / "bare.h5"
    assert pipeline("run", config, "-o", output, "--quiet").returncode == DONE
    with h5py.File(output) as file:
        assert "proxies" not in file and "proxies" not in file["meshes/hero"]
    assert load(output).proxies is None


def test_export_writes_them_and_they_are_taken_back(ran, tmp_path):
    out = tmp_path / "out"
    run = pipeline("export", ran, "--csv", out)
    assert run.returncode == DONE, run.stderr
    for label in ("spheres", "capsule", "hulls", "proxy"):
        assert sorted(os.listdir(out / "proxies" / label)) == ["hero.obj", "wall.obj"]
        assert f"proxies/{label}/hero.obj" in run.stdout
    config = folder(tmp_path, METHODS + '\n[[algorithm]]\nname = "proxy"\nfile = {hero = "out/proxies/hulls/hero.obj", '
                      'wall = "out/proxies/hulls/wall.obj"}\n')
    output = tmp_path / "back.h5"
    again = pipeline("run", config, "-o", output, "--quiet")
    assert again.returncode == DONE, again.stderr
    # A hull and the solid from its file are the same.
    back, before = load(output).proxy("proxy", "hero"), load(ran).proxy("hulls", "hero")
    assert (back["vertices"] == before["vertices"]).all() and (back["triangles"] == before["triangles"]).all()
    assert load(output).pairs("proxy").equals(load(output).pairs("hulls"))


@pytest.mark.parametrize("table, said", [
    ('{hero = "open.obj", wall = "wall_hull.obj"}',
     "'algorithm.0.file.hero' must name closed surfaces, not \"open.obj\": it is open, the edge from ("),
    ('{hero = "hero_hull.obj"}', "no file is named for mesh 'wall'; add wall ="),
    ('{hero = "hero_hull.obj", wall = "wall_hull.obj", door = "wall_hull.obj"}',
     "a file is named for mesh 'door', which the scene has not; it has hero, wall"),
    ('{hero = "none.obj", wall = "wall_hull.obj"}', "must name a file that can be read, not \"none.obj\""),
    ('{hero = 3, wall = "wall_hull.obj"}', "'algorithm.0.file.hero' must be text"),
    ("3", "'algorithm.0.file' must name a file for each mesh"),
    ("{}", "'algorithm.0.file' must name a file for each mesh"),
    ('"hero"', "'algorithm.0.file' must name a file for each mesh"),
])
def test_mistakes_are_one_line_with_file_and_line(tmp_path, table, said):
    config = folder(tmp_path, f'[[algorithm]]\nname = "proxy"\nfile = {table}\n')
    (tmp_path / "open.obj").write_text(CUBE.format(1).rsplit("f ", 1)[0])
    line = config.read_text().splitlines().index(f"file = {table}") + 1
    for command in ("run", "check"):
        more = ("-o", tmp_path / "x.h5", "--quiet") if command == "run" else ()
        run = pipeline(command, config, *more)
        assert run.returncode == INPUT and run.stdout == ""
        assert one_line(run).startswith(f"{config}:{line}:") and said in one_line(run), one_line(run)
    assert not (tmp_path / "x.h5").exists()


def test_without_files_the_meshes_stand_for_themselves(tmp_path):
    config = folder(tmp_path, '[[algorithm]]\nname = "proxy"\n[[algorithm]]\nname = "exact"\n')
    output = tmp_path / "own.h5"
    assert pipeline("run", config, "-o", output, "--quiet").returncode == DONE
    run = load(output)
    assert run.pairs("proxy").equals(run.pairs("exact"))
    assert (run.proxies["outside_share"] == 0).all() and list(run.proxies["parts"]) == [1, 1]
    assert pipeline("detect", output, "--force", "--quiet").returncode == DONE


def test_a_mesh_file_that_is_broken_names_its_line(tmp_path):
    config = folder(tmp_path)
    (tmp_path / "hero_hull.obj").write_text("v 0 0 0\nv 1 0\n")
    run = pipeline("check", config)
    assert run.returncode == INPUT and "hero_hull.obj:2: " in one_line(run)


def test_a_damaged_proxy_is_noticed(ran, tmp_path):
    copy = tmp_path / "damaged.h5"
    shutil.copy(ran, copy)
    with h5py.File(copy, "r+") as file:
        file["meshes/hero/proxies/spheres/balls"][0, 3] += 1
    for more in ((), ("--unsealed",)):
        assert pipeline("show", copy, *more).returncode == FILE
    with pytest.raises(OSError):
        load(copy, unsealed=True)
