"""The thesis's figures: their titles say what hand-made data say, and nothing that a file lacks stops a report."""

import re
import shutil
import xml.etree.ElementTree
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from editing import edited
from matplotlib.colors import to_rgb
from matplotlib.text import Text

from analysis.figures import drawing, thesis_tables
from analysis.figures import engine as engine_figures
from analysis.figures import playground as playground_map
from analysis.figures import steps as step_figures
from analysis.figures import thesis as thesis_figures
from analysis.figures.drawing import NotDrawn
from analysis.figures.figure import Figure, Verdicts, figure, style
from analysis.load import load
from analysis.tables.clauses import KEYS

LETTERS = {name: letter for letter, name in KEYS.items()}


def made(time, hits=None, truth=0, born=None, physics=None, passes=None, kind="box", status="complete", **meta):
    """A Run from columns: time {label: ns per step}, hits {label: ...}, truth (pairs that meet, a number or per step),
    born (first step of each body), physics (columns), passes (a table as Run.passes)."""
    labels = list(time)
    steps = len(next(iter(time.values()))) if labels else 0
    hits = hits or {label: np.zeros(steps) for label in labels}
    table = {
        "time_ns": np.array([time[label] for label in labels], dtype=float).T.ravel(),
        "hits": np.array([hits[label] for label in labels], dtype=float).T.ravel(),
        "true_positive": np.zeros(steps * len(labels)),
        "false_negative": np.repeat(np.broadcast_to(truth, steps), len(labels)),
    }
    if physics is not None:
        physics = pd.DataFrame({"energy": np.ones(steps), "contact_time_ns": np.zeros(steps)} | physics)
        physics.attrs["status"] = status
    answers = {
        label: {"name": label, "thesis_key": LETTERS.get(label, ""), "host": "h", "processor": "p", "build": "b"}
        for label in labels
    }
    return SimpleNamespace(
        path=meta.pop("path", "made.h5"),
        meta={
            "steps": steps, "algorithms": labels, "answers": answers, "title": "Made", "motion": {}, "bodies": [],
            "config_effective": f'[scene]\nkind = "{kind}"\n', "run": {"host": "h", "processor": "p"},
        } | meta,
        per_step=pd.DataFrame(table),
        bodies=pd.DataFrame({"first_step": born if born is not None else [0, 0, 0]}),
        physics=physics,
        passes=passes,
        unlike={},
    )


def ramp(*values):
    return np.array(values, dtype=float)


# Rank correlation. By hand: of the ranks (1 2 3 4 5) and (2 1 4 3 5) the squared differences sum to 4, so Spearman is
# 1 - 6 * 4 / (5 * 24) = 0.8; of 10 pairs 2 are discordant, so Kendall is (8 - 2) / 10 = 0.6.


def test_spearman_and_kendall_are_those_counted_by_hand():
    x, y = [10, 20, 30, 40, 50], [7, 1, 90, 8, 1000]
    assert thesis_tables.spearman(x, y) == pytest.approx(0.8)
    assert thesis_tables.kendall(x, y) == pytest.approx(0.6)


def test_reversed_order_has_rank_correlation_minus_one():
    assert thesis_tables.spearman([1, 2, 3], [3, 2, 1]) == pytest.approx(-1)
    assert thesis_tables.kendall([1, 2, 3], [3, 2, 1]) == pytest.approx(-1)


# Ranks (1, 2.5, 2.5) and (1, 2, 3): Pearson's of them is 1.5 / sqrt(1.5 * 2) = 0.866; of the pairs two are concordant
# and one is tied on one side: tau-b is 2 / sqrt(2 * 3) = 0.816.
def test_ties_get_their_mean_rank():
    assert thesis_tables.spearman([1, 2, 2], [1, 2, 3]) == pytest.approx(3**0.5 / 2)
    assert thesis_tables.kendall([1, 2, 2], [1, 2, 3]) == pytest.approx(2 / 6**0.5)


def test_rank_correlation_of_ties_alone_is_unknown():
    assert np.isnan(thesis_tables.spearman([1, 1], [1, 2]))
    assert np.isnan(thesis_tables.kendall([1, 1], [1, 2]))


# Table 5.1 has H 0.1526, G 0.1963, J 0.9886 ms; here G is fastest: the squared differences of ranks sum to 2, so
# Spearman is 1 - 6 * 2 / (3 * 8) = 0.5 and Kendall 1/3. H takes 0.001526 ms here, a hundredth.
def test_mean_times_stand_beside_table_5_1_with_rank_correlation_and_ratio():
    run = made({"bounding_sphere": [1526, 1526], "obb_sat": [1000, 1000], "rotated_aabb": [3000, 5000]})
    figure = thesis_tables.means_figure(run, "box", "k")
    assert "rank correlation 0.50 (Spearman; Kendall 0.33; n = 3)" in figure.title
    assert list(figure.table.index) == ["bounding_sphere", "obb_sat", "rotated_aabb"]
    assert figure.table["thesis / C++"].tolist() == pytest.approx([100, 196.3, 247.15])
    assert figure.table["rank here"].tolist() == [2, 1, 3]
    assert "took 100 to 247 times as long" in figure.title
    assert "Two machines on one axis" in figure.caption


def test_falling_scene_is_compared_with_table_5_2():
    run = made({"bounding_sphere": [1000, 1000], "obb_sat": [900, 900]})
    table = thesis_tables.means_table(run, "falling")
    assert table["thesis ms"].to_dict() == {"obb_sat": 5.3706, "bounding_sphere": 7.2476}


def test_thesis_means_are_those_of_its_tables_in_their_order():
    box = sorted(thesis_tables.THESIS_MS, key=lambda letter: thesis_tables.THESIS_MS[letter][0])
    falling = sorted(thesis_tables.THESIS_MS, key=lambda letter: thesis_tables.THESIS_MS[letter][1])
    assert ("".join(box), "".join(falling)) == ("HGJOLIPUK", "GHJOLUIPK")  # statements (1) and (2)


def test_labels_with_other_knobs_are_not_the_thesis_s_algorithms():
    run = made({"obb_sat": [1, 1], "facet_vectors_stride_5": [1, 1]})
    run.meta["answers"]["facet_vectors_stride_5"] |= {"name": "facet_vectors", "thesis_key": "P"}
    with pytest.raises(NotDrawn, match="has 1 of the thesis's nine"):
        thesis_tables.means_table(run, "box")


# K with search = "indexed" compares fewer points than the thesis did: 4 us here against 80.7932 ms there is no ratio of
# two languages. H 0.1526 ms and G 0.1963 ms take 100 and 196.3 times as long as here.
def indexed(**more):
    time = {"bounding_sphere": [1526, 1526], "obb_sat": [1000, 1000], "facet_distance": [4000, 4000]} | more
    run = made(time)
    run.meta["answers"]["facet_distance"]["knobs"] = '{"densify":true,"search":"indexed"}'
    return run


def test_another_procedure_than_the_thesis_s_has_no_ratio_and_no_place():
    figure = thesis_tables.means_figure(indexed(), "box", "k")
    assert "n = 2)" in figure.title and "took 100 to 196 times as long" in figure.title
    assert "facet_distance" not in figure.title
    row = figure.table.loc["facet_distance"]
    assert row.timed == "other procedure" and row["same procedure ms"] == pytest.approx(0.004)
    assert row[["thesis / C++", "rank in the thesis", "rank here"]].isna().all()
    assert figure.svg.count("other procedure") == 1  # beside the mark
    assert "best evaluation" in figure.svg
    assert "K (facet_distance) is timed in another procedure" in figure.caption


def test_the_thesis_s_procedure_is_taken_from_whatever_label_has_it():
    run = indexed(slow=[807932, 807932], other=[1, 1])
    for label, knobs in (("slow", '"densify":true'), ("other", '"densify":false')):
        run.meta["answers"][label] |= {"name": "facet_distance", "knobs": f'{{{knobs},"search":"exhaustive"}}'}
    figure = thesis_tables.means_figure(run, "box", "k")
    row = figure.table.loc["facet_distance"]
    assert (row.timed, row["thesis / C++"], row["rank here"]) == ("slow", pytest.approx(100), 3)
    assert "other procedure" not in figure.svg


# The best evaluation is the fastest label of the same answers, whatever it is called; a foreign one is none of ours.
def test_the_best_evaluation_has_the_same_answers():
    run = indexed(slow=[807932, 807932], other=[1, 1], script=[2, 2])
    run.meta["answers"]["slow"] |= {"name": "facet_distance", "knobs": '{"densify":true,"search":"exhaustive"}'}
    for label in ("slow", "facet_distance", "script"):
        run.meta["answers"][label]["digest"] = "same"
    run.meta["answers"]["script"]["transport"] = "program"
    figure = thesis_tables.means_figure(run, "box", "k")
    row = figure.table.loc["facet_distance"]
    assert (row["best evaluation"], row["best ms"]) == ("facet_distance", pytest.approx(0.004))
    assert "facet_distance answers as slow does, in 1/202 of its time" in figure.caption


# A program in JavaScript is the thesis's algorithm by its name or by a knob; 300 steps, each 3 times as long as here.
@pytest.mark.parametrize("told", [{"name": "obb_sat"}, {"name": "thesis", "knobs": '{"algorithm": "obb_sat"}'}])
def test_javascript_of_this_machine_has_a_paired_ratio_with_its_interval(told):
    ours = 1000 + np.arange(300) % 7
    run = made({"bounding_sphere": ours, "obb_sat": ours, "js": 3 * ours})
    run.meta["answers"]["js"] |= told | {"language": "JavaScript (node 18)", "transport": "program"}
    table = thesis_tables.means_table(run, "box")
    row = table.loc["obb_sat"]
    assert row[["JS / C++", "JS / C++ from", "JS / C++ to"]].tolist() == pytest.approx([3, 3, 3])
    assert row["JavaScript ms"] == pytest.approx(3 * ours.mean() / 1e6)
    assert np.isnan(table.loc["bounding_sphere", "JavaScript ms"])
    figure = thesis_tables.means_figure(run, "box", "k")
    assert "JavaScript on this machine takes 3 to 3 times as long" in figure.title
    run.meta["answers"]["js"]["language"] = "Python"
    assert "JavaScript ms" not in thesis_tables.means_table(run, "box")


def test_the_thesis_s_procedure_may_stand_in_another_file_of_the_scene():
    other = indexed(slow=[807932, 807932])
    other.meta["answers"]["slow"] |= {"name": "facet_distance", "knobs": '{"densify":true,"search":"exhaustive"}'}
    figure = thesis_tables.means_figure(indexed(), "box", "k", other)
    row = figure.table.loc["facet_distance"]
    assert (row.timed, row["thesis / C++"]) == ("slow (2 steps)", pytest.approx(100))
    assert "facet_distance as published: of 2 steps of the same seconds" in figure.caption


def test_captions_of_times_name_another_procedure_and_those_of_hits_do_not():
    assert "compared all" in step_figures.time_per_step(indexed(), "box", "k").caption
    assert "compared all" not in step_figures.hits_per_step(indexed(), "box", "k").caption


# Names.


@pytest.mark.parametrize("most", [8, 18, 22, 34])
def test_different_names_are_never_shortened_to_one(most):
    stems = ("cannon_naive+", "bounding_sphere+", "")
    methods = ("facet_triangles", "obb_triangles", "facet_distance", "a", "b")
    ends = ("", "_stride_5", "_stride_9_densified", "_stride_8_densified")
    names = [stem + method + end for stem in stems for method in methods for end in ends]
    texts = drawing.shortened(names, most)
    assert list(texts) == names and len(set(texts.values())) == len(names)
    for name, text in texts.items():
        head, _, tail = text.partition("…")
        assert text == name or (name.startswith(head) and name.endswith(tail) and head and tail)
    assert {name: text for name, text in texts.items() if len(name) <= most}.items() <= dict(zip(names, names)).items()


def test_heads_of_panels_hold_whole_names_in_two_lines():
    labels = ["obb_sat", "bounding_sphere+facet_rotations", "bounding_sphere+facet_triangles", "x" * 60]
    run = made({label: [1, 1] for label in labels})
    heads = drawing.heads(run, labels)
    assert list(heads.values())[:3] == ["G obb_sat", "bounding_sphere+\nfacet_rotations",
                                        "bounding_sphere+\nfacet_triangles"]
    assert all(len(line) <= 24 for head in heads.values() for line in head.split("\n"))


def test_names_that_need_more_room_to_differ_get_it():
    alike = ["a" * 20 + middle + "z" * 20 for middle in ("xoooy", "uooow")]
    assert max(map(len, drawing.shortened(alike, 10).values())) == 23  # 21 on one side to differ
    assert drawing.shortened(["short", "short"], 3) == {"short": "s…t"}  # one name, not two


def test_names_at_the_ends_of_lines_are_tied_to_them():
    names = [*KEYS.values(), "aabb", "exact", "fcl_bvh"]
    heights = {name: 1000 + 3 * i for i, name in enumerate(names)}  # all lines end within a few points
    fig, axes = figure()
    axes.set(xlim=(0, 1), ylim=(0, 10000))
    drawing.label_ends(axes, [(y, name, style(name)) for name, y in heights.items()])
    fig.draw_without_rendering()
    assert [text.get_text() for text in axes.texts] == names
    for text in axes.texts:
        colour = to_rgb(style(text.get_text())["color"])
        assert text.arrow_patch.get_edgecolor()[:3] == colour == to_rgb(text.get_color())
        assert text.xy == pytest.approx((1, heights[text.get_text()] / 10000))
    low = [Text.get_window_extent(text).y0 for text in axes.texts]
    assert np.diff(low).min() > 10  # in the order of the lines, so no two ties cross
    assert [mark.get_marker() for mark in axes.lines] == [style(name)["marker"] for name in names]


# Time and hits.


def test_title_says_whose_time_follows_hits():
    hits = {label: ramp(0, 1, 2, 3) for label in ("obb_sat", "bounding_sphere", "rotated_aabb", "obb_corners")}
    time = {
        "obb_sat": ramp(10, 20, 30, 40),  # r = 1
        "bounding_sphere": ramp(10, 20, 20, 10),  # r = 0
        "rotated_aabb": ramp(40, 30, 20, 10),  # r = -1
        "obb_corners": ramp(7, 7, 7, 7),
    }
    figure = step_figures.curves_together(made(time, hits), "falling", "k")
    assert figure.title == (
        "Time follows hits for G (r = 1.00); it does not for H (|r| < 0.5); it falls as hits rise for J (r = -1.00); "
        "it cannot be told for L, where one of them does not vary"
    )
    assert figure.table["r, all steps"].to_dict()["bounding_sphere"] == pytest.approx(0)
    assert "figures 5.17 to 5.25" in figure.caption


def test_title_begins_rightly_when_no_time_follows_hits():
    title = step_figures.follows_title(["G", "H"], [0.1, np.nan])
    assert title.startswith("Time does not follow hits for G (|r| < 0.5); it cannot be told for H")
    assert step_figures.follows_title(["G"], [np.nan]).startswith("Whether time follows hits cannot be told for G")


# Time and hits both follow the bodies while these appear; afterwards time is flat.
def test_correlation_is_taken_while_all_bodies_are_there():
    time, hits = ramp(1, 2, 3, 4, 5, 5, 5.5, 5.5), ramp(1, 2, 3, 4, 5, 9, 5, 9)
    run = made({"obb_sat": time}, {"obb_sat": hits}, born=[0, 1, 2, 3, 4])
    table = step_figures.curves_together(run, "box", "k").table
    assert table["r, all steps"]["obb_sat"] > 0.8
    assert table["r, all bodies there"]["obb_sat"] == pytest.approx(0, abs=1e-12)


def test_cost_of_a_hit_is_the_slope():
    hits = {"obb_sat": ramp(0, 1, 2, 3), "obb_corners": ramp(0, 1, 2, 3)}
    run = made({"obb_sat": ramp(100, 150, 200, 250), "obb_corners": ramp(9, 9, 9, 9)}, hits)
    figure = step_figures.time_against_hits(run, "falling", "k")
    assert figure.title == "Where time follows hits, one hit more costs 50 ns (obb_sat)"
    assert figure.table["ns per hit"]["obb_sat"] == pytest.approx(50)


def test_slowest_and_fastest_are_named_with_their_ratio():
    run = made({"obb_sat": ramp(1000, 3000), "bounding_sphere": ramp(500, 500)})
    title = step_figures.time_per_step(run, "box", "k").title
    assert title.startswith("obb_sat takes 2 µs per step, 4 times as long as bounding_sphere")
    assert "those of bounding_sphere least (1 times)" in title


def test_most_and_fewest_hits_are_given_in_pairs_that_meet():
    hits = {"bounding_sphere": ramp(6, 6), "facet_triangles": ramp(1, 0)}
    figure = step_figures.hits_per_step(made({label: [1, 1] for label in hits}, hits, truth=2), "box", "k")
    assert figure.title == (
        "bounding_sphere reports the most pairs, 3 times those that meet; facet_triangles the fewest, 0.25 times"
    )
    assert figure.table.loc["(truly meet)", "hits"] == 4


def test_zero_hits_are_said():
    figure = step_figures.hits_per_step(made({"obb_sat": [1, 1]}, truth=0), "box", "k")
    assert figure.title == "No algorithm reports anything; 0 pairs meet"


def test_exponent_of_a_square_law_is_two():
    born = np.arange(40)
    bodies = born + 1
    run = made({"obb_corners": 3.0 * bodies**2, "obb_sat": 5.0 * bodies}, born=born)
    figure = step_figures.time_against_bodies(run, "box", "k")
    assert figure.table.exponent.to_dict() == pytest.approx({"obb_corners": 2, "obb_sat": 1})
    assert figure.title == (
        "Time grows with the number of bodies to the power 1.00 (obb_sat) to 2.00 (obb_corners); with its square: L"
    )


def test_bodies_that_do_not_change_are_a_reason():
    with pytest.raises(NotDrawn, match="number of bodies, 3, does not change"):
        step_figures.time_against_bodies(made({"obb_sat": [1, 1]}), "box", "k")


# Of 20 labels the figure draws 12: the ones as published, then one more of each algorithm.
def test_of_many_labels_the_published_ones_are_drawn_first():
    run = made({f"knob_{i}": [1, 2] for i in range(19)} | {"obb_sat": [1, 2]})
    for i in range(19):
        run.meta["answers"][f"knob_{i}"]["name"] = "facet_vectors"
    drawn = drawing.chosen(run)
    assert len(drawn) == 12 and "obb_sat" in drawn
    figure = step_figures.time_per_step(run, "box", "k")
    assert len(figure.table) == 20 and "Of 20 labels 12 are drawn" in figure.caption


def test_times_of_another_machine_are_not_drawn_and_that_is_said():
    run = made({"obb_sat": [1, 2], "bounding_sphere": [1, 2], "rotated_aabb": [90, 90], "cannon_sap": [1, 1]})
    assert "NOT DRAWN" not in step_figures.time_per_step(run, "box", "k").caption
    run.meta["answers"]["rotated_aabb"]["processor"] = "another"
    figure = step_figures.time_per_step(run, "box", "k")
    assert "NOT DRAWN, FOR TIMED ON ANOTHER MACHINE OR BUILD: rotated_aabb." in figure.caption
    assert "rotated_aabb" not in words(figure) and "rotated_aabb" not in figure.title
    assert "rotated_aabb" not in thesis_tables.means_table(run, "box").index
    assert "rotated_aabb" in words(step_figures.hits_per_step(run, "box", "k"))


# C++ beside JavaScript: 4 ms over 1 ms and 9 ms over 3 ms at every step, 4 and 3 times with an interval of no width.


def in_both_languages(steps=250, **pairs):
    time = {"bounding_sphere": 1e6, "obb_sat": 3e6, "js_bounding_sphere": 4e6, "js_obb_sat": 9e6}
    run = made({label: np.full(steps, ns) for label, ns in time.items()}, kind="falling")
    for name in ("bounding_sphere", "obb_sat"):
        run.meta["answers"][f"js_{name}"] |= {"name": name, "thesis_key": "", "transport": "program",
                                              "language": "JavaScript, node 18"}
    said = {label: [(0, 0, 1), (3, 1, 2)] for label in time} | pairs
    run.pairs = lambda label: pd.DataFrame(said[label], columns=["step", "a", "b"])
    return run


def test_both_languages_stand_beside_the_thesis_s_times():
    figure = thesis_tables.languages_figure(in_both_languages(), "falling", "k")
    assert list(figure.table.index) == ["obb_sat", "bounding_sphere"]
    row = figure.table.loc["bounding_sphere"]
    assert (row.key, row["C++ ms"], row["JavaScript ms"], row["thesis ms"]) == ("H", 1, 4, 7.2476)
    assert (row["JS / C++"], row.low, row.high, row["same answers"]) == pytest.approx((4, 4, 4, 1))
    assert "takes 3 (obb_sat) to 4 times (bounding_sphere) as long as C++" in figure.title
    assert figure.title.endswith("both answer alike on every pair") and "table 5.2" in figure.caption
    assert "4× (4 to 4)" in words(figure)


def test_answers_that_differ_between_languages_are_told():
    run = in_both_languages(js_obb_sat=[(0, 0, 1), (3, 0, 2), (3, 1, 2)])
    figure = thesis_tables.languages_figure(run, "falling", "k")
    assert figure.table["same answers"].to_dict() == pytest.approx({"obb_sat": 2 / 3, "bounding_sphere": 1})
    assert figure.title.endswith("at least 66.67 % of the answers are the same")


def test_few_steps_have_a_ratio_of_languages_without_interval():
    table = thesis_tables.languages_table(in_both_languages(steps=20), "playground")
    assert table["JS / C++"].to_dict() == {"obb_sat": 3, "bounding_sphere": 4}
    assert table[["low", "high", "thesis ms"]].isna().all(axis=None)


def test_only_the_same_procedure_on_the_same_machine_is_compared_between_languages():
    run = in_both_languages()
    run.meta["answers"]["js_obb_sat"]["host"] = "elsewhere"
    assert thesis_tables.in_javascript(run) == [("bounding_sphere", "js_bounding_sphere")]
    fast = indexed(js=[9000, 9000])
    fast.meta["answers"]["js"] |= {"name": "facet_distance", "thesis_key": "", "transport": "program",
                                   "language": "JavaScript, node 18"}
    assert thesis_tables.in_javascript(fast) == []
    with pytest.raises(NotDrawn, match="none of the thesis's nine in both languages"):
        thesis_tables.languages_table(fast, "box")


# Collision and physics.


def engine(time, hits, physics, contacts):
    return made({"cannon_naive": time}, {"cannon_naive": hits}, physics={"time_ns": physics, "contacts": contacts})


def test_calmer_collision_time_agrees_with_the_thesis():
    calm, lively = 10 + np.arange(40) % 2, 1000 * (1 + np.arange(40) % 10)
    contacts = np.ones(40)
    figure = engine_figures.parts_of_a_step(engine(calm, contacts, lively, contacts), "box", "k")
    assert figure.title.startswith("Collision time (cannon_naive) varies less than physics time, as in the thesis")
    assert all(f">{part}<" in figure.svg for part in ("collision", "physics", "total"))  # an axis of its own each
    assert "figure 5.1 of" in figure.caption
    figure = engine_figures.parts_of_a_step(engine(lively, contacts, calm, contacts), "box", "k")
    assert "varies no less than physics time, unlike in the thesis" in figure.title
    assert figure.table.loc["total", "mean ns"] == pytest.approx((calm + lively)[1:].mean())


def test_physics_that_follow_contacts_agree_with_the_thesis():
    rising, wave = np.arange(40.0), np.arange(40.0) % 2
    figure = engine_figures.against_collisions(engine(100 + wave, rising, 100 + rising, rising), "falling", "k")
    assert figure.title.startswith("Physics time follows the contacts more closely")
    assert "as in the thesis (r = 1.00 against" in figure.title
    figure = engine_figures.against_collisions(engine(100 + rising, rising, 100 + wave, rising), "falling", "k")
    assert "no more closely" in figure.title and "unlike in the thesis" in figure.title


# 100 steps at 100 ns, a hit each in all but the first 20 steps, where every other step has ten.
def test_time_per_collision_settles_after_its_start():
    hits = np.ones(100)
    hits[:20:2] = 10
    run = engine(np.full(100, 100.0), hits, np.full(100, 1e6), np.ones(100))
    figure = engine_figures.per_collision(run, "box", "k")
    assert figure.title == (
        "Time per collision (cannon_naive, median 100 ns) settles after the first fifth of the steps, as in the "
        "thesis: its 95th percentile is 10 times the 5th there and 1 times afterwards; a contact costs the physics 1 ms"
    )
    run = engine(np.full(100, 100.0), hits[::-1], np.full(100, 1e6), np.zeros(100))
    assert "does not settle" in engine_figures.per_collision(run, "box", "k").title


def test_time_per_collision_needs_one():
    run = engine(np.ones(10), np.zeros(10), np.ones(10), np.zeros(10))
    with pytest.raises(NotDrawn, match="no step with a collision"):
        engine_figures.per_collision(run, "box", "k")


def test_physics_timed_elsewhere_are_said():
    run = engine(np.full(10, 5.0), np.ones(10), np.arange(10.0), np.ones(10))
    assert "ANOTHER MACHINE" not in engine_figures.parts_of_a_step(run, "box", "k").caption
    run.meta["run"]["host"] = "elsewhere"
    assert "PHYSICS WERE TIMED ON ANOTHER MACHINE (elsewhere" in engine_figures.parts_of_a_step(run, "box", "k").caption


# An integration that fails at step 3 of 6: what comes after it is no data.
def test_steps_after_a_failed_integration_are_left_out():
    energy = [1, 1, 1, np.nan, np.nan, np.nan]
    physics = {"time_ns": np.ones(6), "contacts": np.ones(6), "energy": energy}
    run = made({"obb_sat": [10, 10, 10, 99, 99, 99]}, physics=physics, status="failed at step 3: why")
    figure = step_figures.time_per_step(run, "box", "k")
    assert figure.table["greatest ns"]["obb_sat"] == 10
    assert "The integration failed at step 3: why; the 3 steps before it are drawn" in figure.caption
    assert any("not judged, the integration failed at step 3" in part for part in texts(thesis_figures.sections([run])))


# The playground.


def passes_table(*rows):
    """Rows (label, target, touches, first or None, reported, flicker), a pass each, along x through the middle."""
    columns = ["algorithm", "target", "touches", "first", "reported", "flicker"]
    table = pd.DataFrame(rows, columns=columns)
    table["first"] = table["first"].astype(float)
    table["last"] = -table["first"]
    table["truth_first"] = np.where(table.touches, 2.0, np.nan)
    table["number"], table["path"], table["orientation"], table["offset"] = np.arange(len(table)), "x", "along", 0.0
    return table


PASSES = passes_table(
    ("obb_sat", "slab", True, 0.0, 5, 0),
    ("obb_sat", "slab", True, 0.2, 5, 0),
    ("obb_sat", "ring", False, None, 3, 0),  # a false positive
    ("facet_triangles", "slab", True, None, 0, 0),  # missed
    ("facet_triangles", "slab", True, -0.5, 2, 4),
    ("facet_triangles", "ring", False, None, 0, 0),  # rightly silent
    ("bounding_sphere", "slab", True, 2.0, 9, 0),
    ("bounding_sphere", "slab", True, 3.0, 9, 0),
    ("bounding_sphere", "ring", False, None, 0, 0),
)


def playground(passes):
    labels = list(dict.fromkeys(passes.algorithm))
    return made({label: [1, 1] for label in labels}, passes=passes, kind="playground")


def test_misses_and_false_alarms_are_counted_apart():
    cells = playground_map.outcomes(PASSES, ["target"])
    assert cells.loc[("facet_triangles", "slab"), ["touching", "missed", "false positives"]].tolist() == [2, 1, 0]
    assert cells.loc[("obb_sat", "ring"), ["touching", "missed", "false positives"]].tolist() == [0, 0, 1]
    assert cells.loc[("facet_triangles", "ring"), ["touching", "missed", "false positives"]].tolist() == [0, 0, 0]
    assert cells["first m"]["obb_sat", "slab"] == pytest.approx(0.1)
    assert cells["first m"]["facet_triangles", "slab"] == pytest.approx(-0.5)
    assert np.isnan(cells["first m"]["obb_sat", "ring"])


def test_map_names_the_earliest_the_blindest_and_the_one_with_most_false_positives():
    figure = playground_map.contact_map(playground(PASSES), "playground", "k")
    assert figure.title == (
        "bounding_sphere is earliest (median +2.50 m); facet_triangles misses most (1 of 2 passes that meet); obb_sat "
        "has the most false positives (1 of 1 passes that do not meet); neither miss nor false positive: "
        "bounding_sphere"
    )
    written = words(figure)
    for text in ("+0.10", "−0.50", "+2.5", "m1", "f1", "–"):
        assert text in written, text


def test_cell_that_is_never_reported_says_so():
    passes = passes_table(("obb_sat", "slab", True, None, 0, 0), ("obb_sat", "slab", True, None, 0, 0))
    assert {"never", "m2"} <= words(playground_map.contact_map(playground(passes), "playground", "k"))


def test_flicker_names_the_worst():
    figure = playground_map.flicker_map(playground(PASSES), "playground", "k")
    assert figure.title == (
        "facet_triangles flickers most, 4 changes within 2 passes that meet; 2 of 3 algorithms never change their "
        "answer within a contact"
    )
    still = playground_map.flicker_map(playground(PASSES.assign(flicker=0)), "playground", "k")
    assert still.title == "No algorithm's answer changes within a contact"


def test_passes_that_meet_nothing_are_said():
    passes = passes_table(("obb_sat", "slab", False, None, 0, 0))
    for name, make in playground_map.FIGURES:
        assert make(playground(passes), "playground", "k").title.startswith("No pass"), name


def test_kinds_of_pass_are_compared_by_what_is_missed():
    passes = PASSES.copy()
    passes.loc[4, "offset"] = 1.7  # facet_triangles' late pass goes beside the middle; its missed one through it
    figure = playground_map.kind_map(playground(passes), "playground", "k")
    # Through the middle five passes meet and one is missed, beside it one meets; by path six meet.
    assert figure.title == (
        "Passes of the kind “along, middle” are missed most, 20% over all algorithms; “along, off centre” least, 0%"
    )


def test_metres_that_round_to_nothing_have_no_sign():
    values = (-3e-7, 0.004, -0.05, 1.249, -12)
    assert [playground_map.metres(value) for value in values] == ["0", "0", "−0.05", "+1.2", "−12"]


# Statements.


def test_verdicts_are_counted_in_the_title(monkeypatch):
    from analysis.tables.clauses import Clause
    from analysis.tables.statements import Verdict

    failed, close = Clause("ratio", 2.0, "> 3", False), Clause("ratio", 2.9, "> 3", False, near=True)
    found = [
        Verdict(1, "", "confirmed", [], "one"),
        Verdict(2, "", "refuted", [failed, close], "two"),
        Verdict(2, "careful", "confirmed", [], "two"),
        Verdict(3, "", "refuted", [close], "three"),
        Verdict(4, "", "not testable: no file", [], "four"),
    ]
    monkeypatch.setattr(thesis_tables, "verdicts", lambda scenes: found)
    part = thesis_tables.statements_part({})
    assert part.title == (
        "Of the thesis's 4 statements the data confirm 1 and refute 2, 1 of them by a near miss; 1 cannot be tested. "
        "Of 1 "
        "judged again on the careful form the data confirm 1 and refute 0"
    )
    assert part.found == found


def test_statements_about_one_or_two_algorithms_name_them():
    assert thesis_tables.spelled("K flickers while in contact.") == "K (facet_distance) flickers while in contact."
    assert thesis_tables.spelled("U answers practically as I does.") == (
        "U (facet_rotations) answers practically as I (facet_triangles) does."
    )
    assert thesis_tables.spelled("Order: H < G < J.") == "Order: H < G < J."


# Sections of any mix of files.


def texts(sections):
    return [part for section in sections for part in section.parts if isinstance(part, str)]


def figures(sections):
    return [part for section in sections for part in section.parts if isinstance(part, Figure)]


def words(figure):
    found = xml.etree.ElementTree.fromstring(figure.svg.replace("&nbsp;", " "))
    lines = [" ".join(node.itertext()).strip() for node in found.iter("text")]
    return set(lines) | {word for line in lines for word in line.split()}


def test_no_file_leaves_all_statements_untested():
    (section,) = thesis_figures.sections([])
    title = section.parts[0].title
    assert title == "Of the thesis's 57 statements the data confirm 0 and refute 0; 57 cannot be tested"
    assert sum(text.startswith("No file of a ") for text in texts([section])) == 3


def test_of_two_files_of_one_motion_the_more_published_is_drawn():
    fewer = made({"obb_sat": [1, 2]}, path="fewer.h5", motion={"digest": "same"})
    more = made({"obb_sat": [1, 2], "bounding_sphere": [1, 2]}, path="more.h5", motion={"digest": "same"})
    found = thesis_figures.sections([fewer, more])
    assert len(found) == 2
    assert any("fewer has the same motion" in text and "drawn from more" in text for text in texts(found))
    assert all("bounding_sphere" in figure.table.index for figure in figures(found) if not figure.number)


def test_a_study_without_a_scene_is_named():
    run = made({}, kind="", path="integrators.h5", config_effective="study = 'integration'")
    found = texts(thesis_figures.sections([run]))
    assert any(text.startswith("integrators has neither a scene nor algorithms") for text in found)


HOSTILE = {
    "one step": made({"obb_sat": [1]}),
    "times of zero": made({"obb_sat": [0, 0], "obb_corners": [0, 0]}, {"obb_sat": [1, 2], "obb_corners": [0, 0]}),
    "equal times": made({"obb_sat": [5, 5], "bounding_sphere": [5, 5], "cannon_sap": [5, 5]}),
    "one algorithm": made({"obb_sat": [1, 2, 3]}, {"obb_sat": [1, 2, 3]}, truth=1),
    "no body": made({"obb_sat": [1, 2]}, born=[]),
    "no body is born": made({"obb_sat": [1, 2]}, born=[-1, -1]),
    "a body is born late": made({"obb_sat": [1, 2, 3]}, born=[1, 2]),
    "failed at once": made(
        {"cannon_naive": [1, 2]},
        physics={"time_ns": [0, 0], "contacts": [0, 0], "energy": [np.nan, np.nan]},
        status="failed at step 0: NaN",
    ),
    "nothing was timed": engine(np.zeros(9), np.zeros(9), np.ones(9), np.zeros(9)),
    "a long label": made({"l" * 64: [1, 2], "obb_sat": [1, 2]}),
    "markup in a title": made({"obb_sat": [1, 2]}, title="<b>&"),
    "a broken configuration": made({"obb_sat": [1, 2]}, config_effective="= no TOML"),
    "no passes": made({"obb_sat": [1, 2]}, kind="playground"),
    "a pass of nothing": playground(passes_table(("obb_sat", "slab", False, None, 0, 0))),
    "no algorithm": made({}, kind="falling"),
    "replay": made({"obb_sat": [1, 2]}, kind="replay"),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("run", HOSTILE.values(), ids=HOSTILE)
def test_what_cannot_be_drawn_is_said_and_nothing_raises(run):
    found = thesis_figures.sections([run])
    assert isinstance(found[-1].parts[0], Verdicts)
    for one in figures(found):
        assert "nan" not in words(one)
        assert one.title and "nan" not in one.title and one.caption.count("n = ") == 1, one.title
    for text in texts(found):
        assert re.search(r"[.]$", text) and "\n" not in text


def test_keys_are_unique_when_files_have_one_name():
    runs = [made({"obb_sat": [1, 2]}, path=f"{folder}/a.h5") for folder in "xy"]
    keys = [figure.key for figure in figures(thesis_figures.sections(runs))]
    assert len(keys) == len(set(keys)) > 2


def test_same_data_give_the_same_picture():
    hits = {"obb_sat": [1, 2, 3], "bounding_sphere": [1, 3, 2]}
    run = made({"obb_sat": [1, 2, 5], "bounding_sphere": [3, 2, 1]}, hits)
    once, again = (step_figures.time_against_hits(run, "box", "k") for _ in range(2))
    assert once.svg == again.svg


@pytest.fixture(scope="session")
def smoke(result_file):
    return load(result_file)


def test_smoke_run_is_drawn(smoke):
    found = thesis_figures.sections([smoke])
    assert len(figures(found)) >= 5
    assert all("Answers figures 5.17 to 5.25" in figure.caption for figure in figures(found)[:3])


@pytest.mark.parametrize(
    "groups, why",
    [
        (["results"], "no /results"),
        (["bodies", "meshes"], "not drawn"),
        (["physics", "truth", "summary", "motion", "run"], ""),
    ],
)
def test_missing_groups_are_said_and_nothing_raises(result_file, tmp_path, groups, why):
    path = tmp_path / "cut.h5"
    shutil.copy(result_file, path)
    with edited(path) as file:
        for group in groups:
            del file[group]
    found = thesis_figures.sections([load(path)])
    assert isinstance(found[-1].parts[0], Verdicts)
    assert bool(figures(found)) == (not why)
    assert any(why in text for text in texts(found))
