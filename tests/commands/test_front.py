"""scripts/front: settings that lie near the front, as a configuration that runs."""

import math
import subprocess

import pandas as pd
from program import DONE, INPUT, PIPELINE, ROOT, pipeline

from analysis import front


def points(**rows):
    columns = ["algorithm", "time_mean_ns", "error", "hits", "exact", "library"]
    table = pd.DataFrame.from_dict(rows, orient="index", columns=columns)
    return table.assign(false_positive=table.hits, false_negative=0)


def test_a_configuration_comes_out_that_runs(tmp_path):
    path = tmp_path / "front.toml"
    run = subprocess.run([ROOT / "scripts" / "front", ROOT / "configs" / "smoke.toml", "-o", path, "--steps", "4",
                          "--keep", "10", "--program", PIPELINE], capture_output=True, text=True)
    assert run.returncode == DONE, run.stderr
    text = path.read_text()
    assert text.count("[[algorithm]]") >= 15 and 'name = "facet_rotations"' in text and 'name = "exact"' in text
    checked = pipeline("check", path)
    assert checked.returncode == DONE, checked.stderr


def test_what_is_wrong_is_one_line(tmp_path):
    for config in ("[scene]\nkind = 'no such'\n", "no TOML"):
        path = tmp_path / "bad.toml"
        path.write_text(config)
        run = subprocess.run([ROOT / "scripts" / "front", path, "-o", tmp_path / "out.toml", "--program", PIPELINE],
                             capture_output=True, text=True)
        assert run.returncode == INPUT and len(run.stderr.strip().splitlines()) == 1, run.stderr
        assert not (tmp_path / "out.toml").exists()


def test_near_the_front_is_what_takes_little_more_than_the_fastest_that_errs_no_more():
    found = points(a=("A", 100, .5, 9, False, False), b=("B", 150, .5, 8, False, False),
                   c=("C", 210, .5, 7, False, False),
                   d=("D", 1000, .1, 6, False, False), exact=("exact", 120, 0, 5, True, False))
    asked = dict.fromkeys(found.index)
    assert front.nearest(found, asked, 9) == ["a", "d", "b"]  # c takes 2.1 times as long as a
    assert front.nearest(found, asked, 1) == ["a"]
    same = points(**{name: ("A", 100 + i, .5, 9, False, False) for i, name in enumerate("abcd")})
    assert front.nearest(same, dict.fromkeys(same.index), 9) == ["a", "b"]  # the same answers


def test_values_are_such_as_the_knob_takes():
    angle = {"name": "angle_step", "type": "real", "preset": 10.0, "least": 1.0, "most": 180.0, "rule": "divide 180"}
    found = front.values(angle)
    assert found and all(math.isclose(180 / value, round(180 / value)) for value in found)
    stride = {"name": "stride", "type": "integer", "preset": 2, "least": 1.0, "most": 9.0}
    assert front.values(stride) == [1, 4, 8]
    assert front.values({"name": "search", "type": "text", "preset": "indexed", "choices": ["indexed", "x"]}) == []


def test_between_are_values_not_asked_yet_and_knobs_together():
    knobs = [{"name": "x", "type": "real", "preset": 1.0, "least": 0.0, "most": 9.0},
             {"name": "y", "type": "boolean", "preset": False}]
    asked = {"p": ("m", {}), "x2": ("m", {"x": 2.0}), "y": ("m", {"y": True})}
    found = front.finer([{"name": "m", "knobs": knobs}], list(asked.values()), asked)
    assert ("m", {"x": 2.0, "y": True}) in found and ("m", {"x": 1.41}) in found and ("m", {"x": 2.83}) in found
    assert not [setting for setting in found if setting in asked.values()]


def test_other_algorithms_take_the_place_of_the_configuration_s_own():
    class chosen:
        config, steps = "some/padani.toml", 60

    text = "# About.\n\ntitle = \"t\"\n\n# Asked:\n[[algorithm]]\nname = \"aabb\"\n\n[timing]\nrepeats = 3\n"
    made = front.configuration(text, [("spheres_count_2", "spheres", {"count": 2})], chosen)
    assert 'title = "t"\n\n[timing]\nrepeats = 3\n' in made and "aabb" not in made and "About" not in made
    assert made.endswith('[[algorithm]]\nname = "spheres"\nlabel = "spheres_count_2"\ncount = 2\n')
