"""Which label should be taken: constructed scenes, of which it is known."""

import numpy as np
import pandas as pd
import pytest

from analysis.report import choice as told
from analysis.tables import choice
from analysis.tables.intervals import Interval
from analysis.tables.pareto import Scene

STEPS = 300  # six blocks of 50
WAVE = np.where(np.arange(STEPS) // 50 % 2, 1, -1)  # by blocks: what makes a mean uncertain


def row(label, time, error, missed=0, wave=0.0, machine="here", floor=None, knobs=None, algorithm=None):
    times = time * (1 + wave * WAVE)
    return {"label": label, "algorithm": algorithm or label, "knobs": knobs or {}, "machine": machine, "times": times,
            "floor": floor, "error": error, "false_negative": missed, "time_mean_ns": times.mean()}


def scene(title, *rows):
    return Scene(title, [], pd.DataFrame(list(rows)))


def labels(front):
    return [row.label for row, _ in front]


def test_the_front_has_no_label_that_another_beats_in_both():
    points = scene("s", row("slow", 5000, .6), row("exact", 4000, 0), row("balls", 1000, .5),
                   row("boxes", 2000, .05, 7), row("worse", 2500, .05, 7)).points
    assert labels(choice.front(points)) == ["balls", "boxes", "exact"]
    asked = {words: choice.fastest(points, *limits)[0].label for words, limits in choice.ALLOWED.items()}
    assert asked == {"error at most 0.1": "boxes", "error at most 0.01": "exact", "no error": "exact",
                     "no false negative": "balls"}


def test_equals_are_called_equals():
    points = scene("s", row("boxes", 1000, .3, wave=.05), row("better", 1010, .2, wave=-.05)).points
    assert labels(choice.front(points)) == ["better"]  # it errs less and is as fast
    best, as_fast = choice.fastest(points)
    assert best.label == "boxes" and as_fast == ["better"]
    surely = scene("s", row("boxes", 1000, .3, wave=.005), row("better", 1010, .2, wave=.005)).points
    assert labels(choice.front(surely)) == ["boxes", "better"]
    floor = Interval(1, .98, 1.02)
    noisy = scene("s", row("boxes", 1000, .3, floor=floor), row("better", 1010, .2, floor=floor)).points
    assert labels(choice.front(noisy)) == ["better"]


def test_only_times_of_one_machine_compare():
    points = scene("s", row("a", 1000, .3), row("b", 2000, .1), row("there", 10, 0, machine="there"),
                   row("untimed", np.nan, 0)).points
    assert labels(choice.front(points)) == ["a", "b"]
    assert choice.fastest(points, 0.0) is None
    text = told.sentences(points)
    assert text[0] == "By time: from 1 µs a step on a errs least, 0.3 and from 2 µs a step on b errs least, 0.1."
    assert text[1:] == ["With error at most 0.1: b is the fastest, 2 µs a step.",
                        "With error at most 0.01 or no error: none of 2 labels.",
                        "With no false negative: a is the fastest, 1 µs a step."]
    assert told.section([scene("s", row("alone", 10, 0))]) is None


def test_over_all_scenes_the_worst_error_and_the_geometric_mean_count():
    one = scene("one", row("exact", 1000, 0), row("a", 100, .05), row("b", 210, .04),
                row("here alone", 1, 0))
    two = scene("two", row("exact", 1000, 0), row("a", 400, .2), row("b", 210, .09))
    found = choice.together([one, two])
    assert found.reference == "exact" and list(found.frame.label) == ["a", "b", "exact"]
    a = found.frame.set_index("label").loc["a"]
    assert (a.worst_error, a["where"]) == (.2, "two")
    assert a.time == pytest.approx(np.sqrt(.1 * .4)) and a.slowest == pytest.approx(.4)
    assert choice.best(found, 0.1)[0].label == "b"
    first, as_fast, _ = choice.best(found, 0.5)
    assert first.label == "a" and as_fast == []  # half the time in one scene, twice as much in the other, less in all
    assert list(choice.front_together(found).label) == ["a", "b", "exact"]


def test_who_wins_by_one_scene_alone_is_said():
    usual = [row("exact", 1000, 0), row("a", 110, .01), row("b", 100, .01)]
    odd = [row("exact", 1000, 0), row("a", 10, .01), row("b", 100, .01)]
    scenes = [scene("one", *usual), scene("two", *usual), scene("odd", *odd)]
    first, as_fast, alone = choice.best(choice.together(scenes), 0.1)
    assert first.label == "a" and as_fast == [] and alone == ["odd"]
    assert "a is the fastest" in " ".join(told.together(choice.together(scenes))[0].items)
    assert "by one scene alone: without odd another is faster" in told.together(choice.together(scenes))[0].items[0]
    same = choice.best(choice.together([scene(str(i), *usual) for i in range(3)]), 0.1)
    assert same[0].label == "b" and same[2] == []


def test_settings_are_told_by_algorithm_and_knobs():
    one = scene("one", row("p5", 10, .1, knobs={"stride": 5}, algorithm="P"),
                row("p9", 20, .1, knobs={"stride": 9}, algorithm="P"))
    two = scene("two", row("other_name", 10, .1, knobs={"stride": 5}, algorithm="P"),
                row("p5", 20, .1, knobs={"stride": 7}, algorithm="P"))
    assert choice.together([one, two]) is None  # one setting alone is in both
    assert choice.together([one]) is None


def test_the_section_answers_for_all_scenes_and_for_each():
    one = scene("one", row("exact", 1000, 0), row("a", 100, .05))
    two = scene("two", row("exact", 1000, 0), row("a", 300, .05))
    section = told.section([one, two])
    assert section.title == "Which one should I take?"
    assert [part.title for part in section.parts[1:]] == ["Over all scenes", "Over all scenes", "one", "two"]
    assert set(section.parts[2].frame["label"]) == {"a", "exact"}
