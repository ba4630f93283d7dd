"""The report on studies: findings say what hand-made tables say, and change with them; no gap in a file stops it."""

import re
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle

from analysis.figures import extremes as extremes_figures
from analysis.figures.error import kinds
from analysis.figures.study import maps, motion, precision, sections
from analysis.report import findings, report
from analysis.tables import extremes, studies, study_tables
from analysis.figures.figure import PALETTE, Figure, Table

MERSON, EULER = "RungeKuttaMerson", "ExplicitEuler"


def case(integrator, sweep="drop", problem="drop", **more):
    """A row of /study that finished, `more` put over it."""
    row = {
        "sweep": sweep, "problem": problem, "integrator": integrator, "units": "SI", "status": "finished", "reason": "",
        "accuracy": 1e-3, "fixed_step": np.nan, "nominal_order": 4.0, "stiffness": 1e8, "dissipation": 0.1,
        "reached": 1.0,
        "error": np.nan, "energy_error": 1e-4, "momentum_drift": 0.0, "greatest_penetration": 0.1,
        "smallest_step": 1e-4,
        "preventing_step": np.nan, "steps": 100, "rejected_steps": 1, "force_evaluations": 500, "finished": True,
        "time_ns": 1000,
    } | more
    names = set(studies.PARAMETERS) - set(row)
    row |= dict.fromkeys(names, np.nan)
    return row | {"finished": row["status"] == "finished"}


def made(rows=None, **more):
    """A Run: a study of `rows`, or what `more` says."""
    meta = {
        "title": "Made", "steps": 0, "rate": np.nan, "bodies": [], "algorithms": [], "answers": {}, "schema_version": 1,
        "config_effective": "", "run": {}, "motion": {}, "truth": {},
    } | more.pop("meta", {})
    run = {
        "path": "made.h5", "meta": meta, "study": None if rows is None else pd.DataFrame(rows), "physics": None,
        "extremes": None, "failures": None, "summary": pd.DataFrame(), "per_step": pd.DataFrame(),
        "truth_hits": np.zeros(0, np.uint64), "passes": None, "failed": {}, "unlike": {},
    } | more
    out = SimpleNamespace(noise=None, **run)
    out.completed = lambda: out
    return out


def stiff(**changed):
    """Two integrators over three stiffnesses, the default of a second sweep in the middle; changed: by (who, Pa)."""
    rows = []
    for who, cost in ((MERSON, 500), (EULER, 100)):
        for value in (1e7, 1e8, 1e9):
            more = changed.get(f"{who}_{value:g}", {})
            rows.append(case(who, "over_stiffness", **{"stiffness": value, "force_evaluations": cost} | more))
        rows += [case(who, "over_dissipation", dissipation=value, force_evaluations=cost) for value in (0.0, 0.1)]
    return made(rows)


def said(run, *beside):
    return "\n".join(findings.study(run, [run, *beside]))


def scene(**physics):
    lines = "\n".join(f"{name} = {value!r}".replace("'", '"') for name, value in physics.items())
    return made(meta={"title": "Scene", "config_effective": f"[physics]\n{lines}\n"})


# ---- Studies ---------------------------------------------------------------------------------------------------------


def test_sweeps_are_told_apart_by_what_varies_in_them():
    rows = [case(MERSON, "s", stiffness=value) for value in (1e3, 1e4)]
    rows += [case(MERSON, "p", "pendulum", accuracy=10.0**-k, error=10.0**-k) for k in range(1, 5)]
    rows += [case(MERSON, "far", offset=value) for value in (0.0, 1e7)]
    over, worked, rest = study_tables.parts(pd.DataFrame(rows))
    assert [name for name, _ in over] == ["s"]
    assert [(name, len(mine)) for name, mine in worked] == [("pendulum", 4)]
    assert list(rest["sweep"]) == ["far", "far"]


def test_the_cheapest_for_a_precision_is_of_those_that_reach_it():
    def run(evaluations):
        rows = [case(MERSON, "p", "pendulum", accuracy=10.0**-k, error=10.0**-k, force_evaluations=100 * k)
                for k in range(1, 8)]
        rows += [case(EULER, "p", "pendulum", accuracy=10.0**-k, error=10.0**-k, force_evaluations=evaluations * k)
                 for k in range(1, 4)]
        return made(rows)

    cheap = study_tables.cheapest(run(50)).set_index("threshold")
    assert list(cheap["integrator"]) == [EULER, MERSON, ""]  # 1e-3, 1e-6; nobody reaches 1e-9
    assert cheap["cost"][1e-3] == 150 and cheap["runner_up"][1e-3] == MERSON and cheap["times"][1e-3] == 2
    assert list(study_tables.cheapest(run(200))["integrator"]) == [MERSON, MERSON, ""]
    assert ("For an error below 0.001 the fewest force evaluations are those of ExplicitEuler on pendulum "
            "(150)") in said(run(50))
    assert "No integrator brings the error below 1e-9 on any of 1 problem within" in said(run(50))


def test_a_fixed_step_that_costs_least_is_called_one_and_drawn():
    """In the first results with all integrators a fixed step was the only case below 1e-9, and no line showed it."""
    def run(cost):
        rows = [case(MERSON, "p", "pendulum", accuracy=10.0**-k, error=10.0**-k, force_evaluations=100 * k)
                for k in range(1, 8)]
        return made(rows + [case(MERSON, "p", "pendulum", accuracy=np.nan, fixed_step=1e-3, error=1e-8,
                                 force_evaluations=cost)])

    def hollow(run):
        return precision.precision_figure(run, "force_evaluations", "key").svg.count("stroke: #0072b2; "
                                                                                         "stroke-width: 1.3")

    cheap, dear = run(250), run(900)
    assert list(study_tables.cheapest(cheap)["apart"]) == [True, True, False]
    assert ("below 1e-6 the fewest force evaluations are those of RungeKuttaMerson on pendulum (fixed step) "
            "(250)") in said(cheap)
    assert list(study_tables.cheapest(dear)["apart"]) == [False, False, False] and "(fixed step)" not in said(dear)
    assert hollow(cheap) > 0 and hollow(dear) == 0


def test_cases_that_have_no_cost_are_counted_apart_from_the_crosses():
    rows = [case(MERSON, "p", "pendulum", accuracy=10.0**-k, error=10.0**-k) for k in range(1, 4)]
    rows += [case(MERSON, "p", "pendulum", accuracy=10.0**-k, status="evaluations", force_evaluations=cost)
             for k, cost in ((4, 9000), (5, 0))]
    caption = precision.precision_figure(made(rows), "force_evaluations", "key").caption
    assert "did not finish (1; 1 more ended before their first step)" in caption


def test_a_case_without_cost_is_not_the_cheapest():
    rows = [case(MERSON, "p", "pendulum", accuracy=10.0**-k, error=1e-7, force_evaluations=100 * (k - 1))
            for k in range(1, 5)]
    assert list(study_tables.cheapest(made(rows))["cost"][:2]) == [100, 100]


def test_a_case_that_failed_reaches_no_precision_and_stays_in_the_numbers():
    rows = [case(MERSON, "p", "pendulum", accuracy=10.0**-k, error=1e-4, status="time" if k == 3 else "finished")
            for k in range(1, 4)]
    table = study_tables.work_precision(made(rows))
    assert table["error"].isna().sum() == 1 and list(table["status"]) == ["finished", "finished", "time"]


def test_of_those_that_hold_and_cost_at_most_twice_the_cheapest_the_most_accurate_is_recommended():
    table = study_tables.recommendation(stiff()).set_index("integrator")
    assert table["cheapest"][EULER] and table["recommended"][EULER]  # 500 is more than twice 100
    near = stiff(**{f"{EULER}_{value:g}": {"force_evaluations": 400, "energy_error": 5e-3}
                    for value in (1e7, 1e8, 1e9)})
    table = study_tables.recommendation(near).set_index("integrator")
    assert table["cheapest"][EULER] and table["recommended"][MERSON]
    assert f"Recommended near 1e+08 Pa: {MERSON} at accuracy 0.001" in said(near)


@pytest.mark.parametrize("wrong", [{"energy_error": 0.02}, {"energy_error": -0.02}, {"status": "energy"},
                                   {"energy_error": np.nan}])
def test_who_fails_once_near_the_scenes_stiffness_is_not_recommended(wrong):
    table = study_tables.recommendation(stiff(**{f"{EULER}_1e+09": wrong}))
    assert list(table[table["recommended"]]["integrator"]) == [MERSON]


def test_nothing_is_recommended_when_nobody_holds_or_nobody_has_all_cases():
    bad = {f"{who}_1e+08": {"status": "not_finite"} for who in (MERSON, EULER)}
    assert "Nothing is recommended near 1e+08 Pa: of 3 cases nobody holds in all of them." in said(stiff(**bad))
    rows = stiff().study
    sparse = rows[~((rows.sweep == "over_stiffness")
                    & (rows.stiffness == np.where(rows.integrator == MERSON, 1e7, 1e9)))]
    assert "nobody has all of them" in said(made(sparse))


def test_a_scene_beside_follows_the_recommendation_or_not():
    run = stiff()
    follows = scene(integrator=EULER, accuracy=1e-3, stiffness=1e8)
    other = scene(integrator=MERSON, accuracy=1e-3, stiffness=1e8)
    unknown = scene(integrator=MERSON, accuracy=1e-5, stiffness=1e8)
    assert f"“Scene” ({EULER} at accuracy 0.001, 1e+08 Pa) follows the recommendation." in said(run, follows)
    assert ("does not follow the recommendation, ExplicitEuler at accuracy 0.001: its own holds too and "
            "needs 5 times") in said(run, other)
    assert "the study has no cases of its own setting" in said(run, unknown)


def test_what_holds_and_what_fails_is_said_with_its_cause():
    assert (f"(over_stiffness) {MERSON} and {EULER} keep the energy within 1 % over stiffness 1e7 to 1e9 "
            "Pa") in said(stiff())
    failed = said(stiff(**{f"{EULER}_1e+09": {"status": "energy"}}))
    assert f"(over_stiffness) {MERSON} keeps the energy" in failed
    assert f"{EULER} does not finish at stiffness 1e9 Pa: energy grew beyond the bound." in failed
    assert "1 of 10 cases did not finish: energy grew beyond the bound (1)." in failed
    silent = said(stiff(**{f"{EULER}_1e+09": {"energy_error": 4.0}}))
    assert f"{EULER} gains 4 times the problem's energy and finishes all the same at stiffness 1e9 Pa." in silent
    assert "All 10 cases finished." in silent


def test_who_lacks_a_value_is_not_said_to_hold_everywhere():
    rows = stiff().study
    lacking = rows[(rows["integrator"] == MERSON) | (rows["stiffness"] != 1e7)]
    assert f"(over_stiffness) {MERSON} keeps the energy within 1 % over stiffness 1e7 to 1e9 Pa" in said(made(lacking))


def test_an_order_that_falls_short_is_said_and_one_that_is_on_no_line_is_left_out():
    def run(errors, problem):
        return [case(MERSON, problem, problem, accuracy=np.nan, fixed_step=0.1 / 2**k, error=error)
                for k, error in enumerate(errors)]

    full, short = ([1e-2 / factor**k for k in range(4)] for factor in (16, 4))
    erratic = [1e-2, 9e-3 / 2, 1e-6, 8e-7]
    told = said(made(run(full, "pendulum") + run(short, "bounce") + run(erratic, "top")))
    assert (f"{MERSON} converges with order 2.00 to 4.00 on 2 problems; nominal is 4, which it falls short "
            "of on bounce.") in told
    assert f"{MERSON} converges with order 4.00 on 1 problem; nominal is 4." in said(made(run(full, "pendulum")))
    figure = precision.order_figure(made(run(full, "pendulum") + run(short, "bounce") + run(erratic, "top")), "key")
    assert figure.title == (f"1 of 2 fitted orders are within 0.3 of the nominal ones; farthest is {MERSON} on "
                            "bounce, 2.00 for 4")
    rows = precision.orders_table(made(run(full, "pendulum") + run(erratic, "top"))).frame
    assert rows["pendulum"].iloc[0] == "4.00 ± 0.00" and rows["top"].iloc[0].startswith("erratic (")


def test_a_failure_is_a_letter_in_the_map_and_a_row_of_its_numbers():
    figure = maps.map_figure(stiff(**{f"{EULER}_1e+09": {"status": "tunnelled"}}), "over_stiffness", "key")
    assert ">W<" in figure.svg and "went through the plate" in figure.svg
    assert list(figure.table["status"]).count("tunnelled") == 1
    assert "ExplicitEuler does not finish everywhere" in figure.title


@pytest.mark.parametrize("value, text", [
    (0, "0"), (4e-4, "0"), (-0.0123, "−1.2"), (0.126, "+13"), (12.5, "+1e3"), (0.0098, "+1.0"), (-0.0104, "−1.04"),
    (0.1002, "+10.02"), (0.0997, "+10"), (1.004, "+100.4"), (np.inf, "∞"), (np.nan, "–"),
])
def test_shares_of_energy_are_shown_in_percent_and_few_characters(value, text):
    assert maps.percent(value) == text


def test_the_greatest_step_that_stops_a_ball_is_said_or_that_there_is_none():
    def run(step):
        return made([
            case(MERSON, "plate", "thin_plate", greatest_step=length, speed=5000.0, thickness=0.2, preventing_step=step,
                 status=status)
            for length, status in ((1e-2, "tunnelled"), (1e-5, "finished"))
        ])

    assert "5000 m/s against a plate of 0.2 m and 1e+08 Pa is stopped by steps of at most 0.0003 s" in said(run(3e-4))
    assert "no step was found that stops it" in said(run(np.nan))
    table = study_tables.tunnelling(run(3e-4))
    assert table["went_through"][0] == [1e-2] and table["stopped"][0] == [1e-5]


def test_who_takes_a_fixed_step_is_not_said_to_take_the_greatest_allowed():
    """SemiExplicitEuler went through the plate "with steps of 1e-05 s": its own were of 0.001 s."""
    own = {"accuracy": np.nan, "fixed_step": 1e-3, "status": "tunnelled", "preventing_step": 2e-4}
    run = made([
        case(who, "plate", "thin_plate", greatest_step=length, speed=5000.0, thickness=0.2, **more)
        for who, more in (("SemiExplicitEuler", own), (MERSON, {"preventing_step": 9e-4})) for length in (1e-2, 1e-5)
    ])
    table = study_tables.tunnelling(run).set_index("integrator")
    assert table["went_through"]["SemiExplicitEuler"] == [1e-3] and table["stopped"][MERSON] == [1e-2, 1e-5]
    told = said(run)
    assert ("greatest step 1e-05\u00a0s): goes wrong with 1 of 2 integrators: went through the plate with "
            "SemiExplicitEuler (its step is 0.001 s)") in told
    assert ("greatest step 0.01\u00a0s): goes wrong with 1 of 2 integrators: went through the plate with "
            "SemiExplicitEuler.") in told
    caption = motion.extremes_figure(run, "key").caption
    assert "SemiExplicitEuler takes its own step of 0.001 s" in caption and "RungeKuttaMerson takes" not in caption


def test_one_case_is_told_in_the_singular():
    run = made([case(MERSON)])
    assert said(run) == f"The only case finished.\nDrop: goes well with {MERSON} (finished, energy within 10 %)."
    assert "1 case of 1 integrator" in report.report([run]) and "(1 row)" in report.report([run])


def test_an_empty_study_and_one_where_all_fails_are_reported():
    empty = made([case(MERSON)])
    empty.study = empty.study.iloc[:0]
    assert said(empty) == "The study has no cases."
    rows = [case(MERSON, "p", "pendulum", accuracy=10.0**-k, status="not run", energy_error=np.nan)
            for k in range(1, 5)]
    for run in (empty, made(rows)):
        page = report.report([run])
        assert "Traceback" not in page and "Findings" in page
    assert "4 of 4 cases did not finish" in page
    assert precision.precision_figure(made(rows), "time_s",
                                          "key") == "Error against cost: not drawn, no case of pendulum has an error."


# ---- Extremes of the answers -----------------------------------------------------------------------------------------

CLASSES = [("-1e-3", -1e-3, True), ("-1 ulp", -2e-16, True), ("0 ulp", 0.0, True), ("+1 ulp", 2e-16, False),
           ("+1e-3", 1e-3, False)]


def answered(report_=lambda label, name, meets: meets, failed=(), swapped=None):
    """A run of extremes of two algorithms; report_: (label, class, truth) -> what is reported."""
    labels, rows = ["one", "two"], []
    for step, (name, gap, meets) in enumerate(CLASSES):
        for label in labels:
            hit = report_(label, name, meets)
            rows.append({
                "step": step, "algorithm": label, "pair": "box-box", "gap_class": name, "gap": gap, "scale": 1.0,
                "offset": 0.0,
                "truth": meets, "truth_moved": meets, "near_touching": "ulp" in name, "reported": hit,
                "swapped": hit != (label == swapped), "moved": hit, "failed": label in failed,
                "refused": label in failed,
            })
    table = pd.DataFrame(rows)
    table["algorithm"] = pd.Categorical(table["algorithm"], labels)
    meta = {"algorithms": labels, "steps": len(CLASSES), "rate": 60.0,
            "answers": {label: {"name": label} for label in labels}}
    return made(extremes=table, failures=["too dense" if label in failed else "" for label in labels], meta=meta)


def test_gaps_stand_from_deep_inside_over_ulps_to_far_apart():
    table = extremes_figures.gap_shares(answered())
    shuffled = table.sample(frac=1, random_state=1)
    assert [name for name, _ in extremes_figures.gap_classes(shuffled)] == [name for name, _, _ in CLASSES]


def test_errors_near_touching_are_counted_apart():
    rounding = answered(lambda label, name, meets: meets ^ (label == "two" and name == "+1 ulp"))
    figure = extremes_figures.gap_figure(rounding, "key")
    assert figure.title == "Beyond rounding of touching one and two are never wrong"
    told = findings.answers(rounding)
    assert "one and two are never wrong in 2 cases farther than 1000 ulps from touching." in told
    assert "Wrong within 1000 ulps of touching: two 33.33 % (0 missed, 1 false positive)." in told


def test_decades_within_rounding_of_touching_are_in_no_bar_and_are_counted():
    run = answered(lambda label, name, meets: meets and name != "-1e-3")
    both = run.extremes[run.extremes["gap_class"] == "-1e-3"].assign(near_touching=True, step=5)
    run.extremes = pd.concat([run.extremes, both.assign(reported=True)], ignore_index=True)
    drawn = extremes_figures.drawn_classes(extremes_figures.gap_shares(run))
    assert drawn[(drawn["gap_class"] == "-1e-3")]["missed"].to_list() == [1.0, 1.0]  # the two labels, far from touching
    assert len(drawn) == 2 * len(CLASSES)
    assert "4 cases, counted apart; 1 of them are decades" in extremes_figures.gap_figure(run, "key").caption


def test_what_is_missed_and_falsely_reported_far_from_touching_changes_the_finding():
    missing = answered(lambda label, name, meets: meets and label == "one")
    assert extremes_figures.gap_figure(missing, "key").title == "Beyond rounding of touching one is never wrong"
    assert ("Wrong farther than 1000 ulps from touching: two 50.00 % (1 missed, 0 "
            "false positives).") in findings.answers(missing)
    inventing = answered(lambda label, name, meets: True)
    assert "one and two have false positives but miss nothing" in extremes_figures.gap_figure(inventing, "key").title


def test_offsets_are_compared_by_cases_that_are_alike_in_everything_else():
    """Far offsets have no small scales: what errs at great scales alone seemed to err by the offset."""
    run = answered(lambda label, name, meets: meets)
    parts = []
    for offset, scale in ((0.0, 1.0), (0.0, 1e-9), (1e9, 1.0)):
        wrong = (run.extremes["algorithm"] == "two") & (scale == 1.0)
        parts.append(run.extremes.assign(offset=offset, scale=scale, reported=run.extremes["truth"] ^ wrong))
    run.extremes = pd.concat(parts, ignore_index=True)

    def drawn(word, make):
        return extremes_figures.by_figure(run, word, "m", make, "key")

    figure = drawn("offset", extremes.error_by_offset)
    assert figure.title == "The offset hardly matters: no algorithm's error differs by more than 0 over it"
    assert "over the 4 cases of each algorithm" in figure.caption and set(figure.table["cases"]) == {2, 3}
    # Of all cases it seems to: FP, FN and a TP at 0.
    assert set(extremes.error_by_offset(run).loc["two", False]["error"]) == {2 / 3, 1.0}
    figure = drawn("scale", extremes.error_by_scale)
    assert figure.title.startswith("two depends most on the scale: error 0 at scale 1e-9 m, 1 at scale 1 m")
    run.extremes = pd.concat(parts[1:], ignore_index=True)
    assert drawn("offset", extremes.error_by_offset).title == ("No case is there at every offset, so errors by "
                                                               "offset do not compare")


def test_misses_and_false_positives_have_one_colour_each_in_all_figures(monkeypatch):
    def bars(module, draw):
        drawn = []
        monkeypatch.setattr(module, "svg_of", lambda fig, titles=None: drawn.append(fig) or "")
        draw()
        found = [bar for ax in drawn[0].axes for bar in ax.patches if isinstance(bar, Rectangle)]
        return {to_hex(bar.get_facecolor()).upper() for bar in found if bar.get_height() * bar.get_width() > 0}

    points = pd.DataFrame({"label": ["a"], "error": [0.6], "time_mean_ns": [1.0], "hits": [3], "false_negative": [3],
                           "false_positive": [3]})
    for missed, invented in ((1, 0), (0, 1)):
        wrong = answered(lambda label, name, meets: meets and not missed or bool(invented))
        shown = points.assign(false_negative=3 * missed, false_positive=3 * invented)
        scene_ = SimpleNamespace(points=shown, title="t", runs=[made(truth_hits=np.array([6]))])
        colour = PALETTE["vermilion" if missed else "blue"]  # as false negatives and false positives in the viewer
        assert bars(extremes_figures, lambda: extremes_figures.gap_figure(wrong, "key")) == {colour}
        assert bars(kinds, lambda: kinds.kinds(scene_, "key")) == {colour}


def test_labels_that_look_alike_when_shortened_keep_their_own_numbers():
    run = answered(lambda label, name, meets: meets if label == "one" else not meets)
    names = {"one": "facet_triangles_stride_5_densified", "two": "facet_triangles_stride_9_densified"}
    run.extremes["algorithm"] = run.extremes["algorithm"].cat.rename_categories(names)
    run.meta["algorithms"] = list(names.values())
    for word, unit, make in (("scale", "m", extremes.error_by_scale), ("shape", "", extremes.error_by_shape)):
        cells = re.findall(r">(0|100)</text>", extremes_figures.by_figure(run, word, unit, make, "key").svg)
        assert sorted(cells) == ["0", "100"]


def test_extremes_of_which_no_case_is_answered_are_drawn_and_said():
    run = answered(failed=["one", "two"])
    assert extremes_figures.gap_figure(run, "key").title == "one and two fail in all cases beyond rounding of touching"
    told = findings.answers(run)
    assert not any("never wrong" in text or "changes" in text for text in told)
    assert "two fails in 5 of 5 cases; first: too dense." in told
    assert extremes_figures.instability_table(run).title == ("No algorithm answers any case; one and two fail in 10 "
                                                             "cases")


def test_what_failed_is_left_out_of_shares_and_it_is_said():
    run = answered(lambda label, name, meets: label == "two")
    run.extremes.loc[(run.extremes["algorithm"] == "two") & (run.extremes["gap_class"] == "-1e-3"), "failed"] = True
    assert "two 100.00 % of the 1 it answers (0 missed, 1 false positive)" in "\n".join(findings.answers(run))
    lines = report.warnings([run], [])
    assert ("made: two failed in 1 of 5 cases; the summary, and errors against time and operations, count "
            "them as reporting nothing.") in lines
    assert not any("one failed" in line for line in lines)


def test_answers_that_change_and_algorithms_that_fail_are_named():
    steady, shaky, failing = (findings.answers(run) for run in (answered(), answered(swapped="two"),
                                                                answered(failed=["two"])))
    assert "No answer changes with the order of the pair, of 2 algorithms." in steady
    assert "No algorithm refuses a pair or throws." in steady
    assert "Answers that change with the order of the pair: two 5 of 5." in shaky
    assert "two fails in 5 of 5 cases; first: too dense." in failing


def test_an_answer_that_moves_with_the_truth_is_no_contradiction():
    run = answered()
    table = run.extremes
    both = (table["gap_class"] == "0 ulp") & (table["algorithm"] == "one")
    table.loc[both, ["moved", "truth_moved"]] = ~table.loc[both, ["moved", "truth_moved"]]
    table.loc[(table["gap_class"] == "+1e-3") & (table["algorithm"] == "two"), "moved"] = True
    shaky = extremes.instability(run)
    assert shaky["moved"].to_dict() == {("one", False): 0, ("one", True): 0, ("two", False): 1, ("two", True): 0}
    assert shaky["truth_moved"].sum() == 1


# ---- Drift ---------------------------------------------------------------------------------------------------------


def drifting(energy, **physics):
    table = pd.DataFrame({"energy": np.asarray(energy, float), "greatest_penetration": np.zeros(len(energy))})
    table.attrs["status"] = "complete"
    run = scene(integrator=MERSON, **physics)
    run.meta |= {"steps": len(energy), "rate": 1.0}
    run.physics, run.bodies = table, pd.DataFrame({"first_step": [0, 0]})
    return run


def test_energy_is_judged_only_where_nothing_gives_or_takes_it():
    lossy = findings.drift(drifting([10, 9, 8], dissipation=0.1))
    assert not any("energy" in text for text in lossy)
    good, bad = (findings.drift(drifting(energy, dissipation=0.0)) for energy in ([0, 10, 10.05], [0, 10, 10.5]))
    assert any("off by 0.5 % at most and by +0.5 % at the end, within 1 %." in text for text in good)
    assert any("off by 5 % at most and by +5 % at the end, more than 1 %." in text for text in bad)
    born = drifting([10, 10.5], dissipation=0.0)
    born.bodies["first_step"] = [0, 1]
    assert not any("energy" in text for text in findings.drift(born))


LOSSES = ["dissipation", "static_friction", "dynamic_friction", "viscous_friction", "linear_damping", "angular_damping"]


@pytest.mark.parametrize("name", LOSSES)
def test_one_loss_is_enough_for_energy_to_be_no_error(name):
    assert study_tables.lossless(drifting([10, 9], **dict.fromkeys(LOSSES, 0.0)))
    assert not study_tables.lossless(drifting([10, 9], **dict.fromkeys(LOSSES, 0.0) | {name: 0.1}))


@pytest.mark.parametrize("push, steady", [
    ("speed = 5.0\nfrom = 0\nevery = 2", True), ("speed = 5.0\nfrom = 0\nevery = 1", False),
    ("speed = 5.0\nfrom = 1\nevery = 2", False), ("speed = 0.0\nfrom = 1\nevery = 1", True),
])
def test_only_a_push_at_the_start_leaves_the_energy_alone(push, steady):
    run = drifting([10, 9], dissipation=0.0)
    run.meta["config_effective"] += f"\n[scene.push]\n{push}\n"
    assert study_tables.lossless(run) == steady


def test_an_integration_that_stopped_says_how_far_it_came():
    run = drifting([10, np.nan, np.nan], dissipation=0.0)
    run.physics.attrs["status"] = "failed at step 1: energy"
    assert findings.drift(run) == ["The integration failed at step 1: energy; 1 of 3 steps were reached."]


def test_who_escaped_before_an_integration_stopped_is_counted_and_the_time_is_that_of_the_motion():
    run = drifting([10, 9, np.nan, np.nan], dissipation=0.1)
    run.physics.attrs["status"] = "failed at step 2: energy"
    run.bodies = pd.DataFrame({"first_step": 0, "fixed": [True, False, False, False], "size": [np.ones(3)] * 4})
    position = np.zeros((4, 4, 3))
    position[1, 1:] = (0, -5, 0), (9, 0, 0), (-11, 0, 0)  # below; near enough; farther than ten sizes
    position[2:, 1:] = np.nan
    run.motion = position, np.zeros((4, 4, 4))
    run.physics["greatest_penetration"] = [0.0, 0.25, np.nan, np.nan]
    for name in ("integrator_steps", "rejected_steps", "force_evaluations", "time_ns"):
        run.physics[name] = 1
    told = findings.drift(run)
    assert "Over 1 s bodies sink into each other by 0.25 m at most, at 1 s." in told
    assert "2 bodies escaped (ended below everything fixed, or ten times its size away) over 1 s." in told
    assert studies.drift(run).seconds == 1 and studies.drift(run).escaped == 2
    for nothing in (0.0, np.nan):  # nothing is there yet, or the integration failed at once
        run.physics["energy"] = nothing
        assert np.isnan(studies.drift(run).energy_first) and np.isnan(studies.drift(run).energy_fall)
    run.physics["energy"] = [10, 9, np.nan, np.nan]
    run.physics["greatest_penetration"] = 0.0
    assert "Over 1 s no body sinks into another." in findings.drift(run)


# ---- The page ------------------------------------------------------------------------------------------------------


def test_every_part_of_a_study_and_of_extremes_is_drawn():
    rows = stiff().study.to_dict("records")
    rows += [case(MERSON, "p", "pendulum", accuracy=np.nan, fixed_step=10.0**-k, error=10.0 ** (-4 * k + 2))
             for k in range(1, 4)]
    rows += [case(EULER, "far", offset=value, status="exception") for value in (0.0, 1e7)]
    found = [*sections.sections([made(rows)]), *extremes_figures.sections([answered()])]
    parts = [part for section in found for part in section.parts]
    assert not [part for part in parts if isinstance(part, str) and "not drawn" in part]
    assert sum(isinstance(part, Figure) for part in parts) == 10
    assert sum(isinstance(part, Table) for part in parts) == 3
    keys = [part.key for part in parts if isinstance(part, Figure)]
    assert len(keys) == len(set(keys))


def test_a_study_alone_has_findings_first_and_no_section_about_answers():
    page = report.report([stiff()])
    heads = [line.partition(">")[2].partition("<")[0] for line in page.split("<h2 id=")[1:]]
    assert heads[0] == "Findings" and "Error against time" not in heads
    assert "lacks /" not in page and "no algorithm has answered" not in page and "10 cases of 2 integrators" in page
    assert page == report.report([stiff()])
