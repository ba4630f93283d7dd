"""The report of a sweep: what it says of points is so, by hand-made sweeps whose answers are plain; few figures,
whatever the number of points."""

import json
import re
import shutil

import numpy as np
import pytest
from browser import browsing
from conftest import ROOT

from analysis.__main__ import main
from analysis.figures import sweep as figures
from analysis.figures.figure import Figure, Table
from analysis.load import load, load_sweep, sweep_frame
from analysis.tables import scenes, sweeps
from analysis.tables.statements import verdicts


def row(label, error, time_us, missed=1):
    return {"label": label, "algorithm": label, "knobs": "{}", "promise": "none", "scope": "pair",
            "operations_unit": "u", "hits": 10, "true_positive": 5, "false_positive": 5, "false_negative": missed,
            "error": error, "precision": 0.5, "recall": 0.5, "matthews": 0.1, "operations": 7,
            "time_mean_ns": time_us * 1e3, "time_median_ns": 1.0, "time_p95_ns": 2.0,
            "promise_kept": True}  # fmt: skip


def point(parameters, rows, **more):
    name = ",".join(f"{key}={value}" for key, value in parameters.items())
    return {"name": name, "parameters": parameters, "status": "done", "reason": "", "exit_code": 0, "host": "h",
            "processor": "P", "build": "0123456789 Release", "began": 0.0, "wall_time_s": 1.0, "digest": name,
            "steps": 3, "bodies": 5, "truth_hits": 9, "summary": rows} | more  # fmt: skip


def sweep(*points_, title="Hand-made"):
    return {"sweep": "made", "title": title, "parameters": list(points_[0]["parameters"]), "points": list(points_)}


def frame(*points_, folder="/nowhere"):
    table = sweep_frame(sweep(*points_))
    table.attrs["folder"] = folder
    return table


# `sure` errs less than `shaky` everywhere and less than `middle` at three of four points; `middle` is always quickest.
FOUR = [
    point(
        {"n": n, "seed": seed},
        [row("sure", sure, 30 * n), row("middle", middle, 10), row("shaky", 0.9, 20 + 10 * n, missed=0)],
    )
    for n, seed, sure, middle in ((1, 1, 0.1, 0.4), (1, 2, 0.3, 0.4), (4, 1, 0.2, 0.5), (4, 2, 0.6, 0.5))
]


def test_what_holds_at_every_point_and_what_at_some():
    facts = {fact.text: (fact.held, fact.of) for fact in sweeps.facts(frame(*FOUR))}
    assert facts["sure errs least"] == (3, 4) and facts["middle errs least"] == (1, 4)
    assert facts["middle is the quickest"] == facts["shaky misses no pair"] == facts["every promise is kept"] == (4, 4)
    assert facts["sure is on the front of error against time"] == (3, 4)
    assert "shaky errs least" not in facts and "sure is the quickest" not in facts
    held = [fact.held == fact.of for fact in sweeps.facts(frame(*FOUR))]
    assert held == sorted(held, reverse=True)


def test_equals_err_least_together():
    (fact,) = [
        f
        for f in sweeps.facts(frame(point({"seed": 1}, [row("a", 0, 1), row("b", 0, 2), row("c", 1, 3)])))
        if f.kind == "error"
    ]
    assert fact.text == "a and b err least"


def test_who_errs_less_than_whom():
    below, both = sweeps.order(frame(*FOUR), "error")
    assert below.loc["sure", "middle"] == 3 and below.loc["middle", "sure"] == 1 and below.loc["sure", "shaky"] == 4
    assert (both.to_numpy()[~np.eye(3, dtype=bool)] == 4).all()
    assert sweeps.undecided(frame(*FOUR), "error") == ([("sure", "middle", 3, 1, 4)], 3)
    equal = frame(point({"seed": 1}, [row("a", 0.5, 1), row("b", 0.5, 2)]))
    assert sweeps.order(equal, "error")[0].to_numpy().sum() == 0 and sweeps.undecided(equal, "error") == ([], 1)


def test_who_is_quicker_is_told_by_the_same_steps(monkeypatch):
    """`twin` has a smaller mean by 0.1 % than `one`, of steps whose times differ by ten times as much at random; the
    slow one is slower at every step."""
    draws = np.random.default_rng(1)
    one = 1e5 * draws.uniform(1, 30, 600)
    twin = one * draws.normal(1, 0.01, 600)
    twin *= 0.999 * one.sum() / twin.sum()
    times = {"one": one, "twin": twin, "slow": 1.05 * one}
    monkeypatch.setattr(sweeps, "_times", lambda folder, name: (times, None))
    rows = [row(label, 0.5, values.mean() / 1e3) for label, values in times.items()]
    below, both = sweeps.order(frame(point({"seed": 1}, rows)), "time_mean_ns")
    assert below.loc["twin", "one"] == below.loc["one", "twin"] == 0 and both.loc["one", "twin"] == 1
    assert below.loc["one", "slow"] == 1 and below.loc["slow", "one"] == 0
    # Nobody says that the order of `one` and `twin` is the same everywhere: it is told nowhere.
    table = frame(point({"seed": 1}, rows), point({"seed": 2}, rows))
    assert sweeps.untold(table, "time_mean_ns") == 1
    (part,) = figures.findings(table)
    assert ("Who is quicker is the same at every point for 2 of 3 pairs of labels, and not told at every point for 1."
            in part.items)  # fmt: skip
    monkeypatch.setattr(sweeps, "_times", lambda folder, name: ({}, None))  # a file that is gone: by the means
    below, _ = sweeps.order(frame(point({"seed": 1}, rows)), "time_mean_ns")
    assert below.loc["twin", "one"] == 1


def test_the_spread_over_seeds():
    spread = sweeps.spread(sweeps.answers(frame(*FOUR)), "error", ["n", "label"]).set_index(["n", "label"])
    assert tuple(spread.loc[(1, "sure")]) == pytest.approx((0.2, np.sqrt(0.02), 0.1, 0.3, 2))
    assert tuple(spread.loc[(4, "middle")]) == pytest.approx((0.5, 0, 0.5, 0.5, 2))


def test_the_findings_say_it_in_numbers():
    text = " ".join(figures.findings(frame(*FOUR))[0].items)
    assert "4 of 4 points are done." in text
    assert "At every point: middle is the quickest; every promise is kept." in text
    assert (
        "Who errs less is the same at every point for 2 of 3 pairs of labels; "
        "the least sure: sure than middle at 3 of 4." in text
    )
    assert (
        "From n 1 to 4 the error of sure changes most, 0.2 to 0.4; the time of sure grows most, 4-fold, "
        "that of middle least, 1-fold." in text
    )
    assert "0.283 for sure, the greatest (0.4, from 0.2 to 0.6) at n 4." in text  # sd of 0.2 and 0.6


def parts(table, kind):
    return [part for section in figures.sections(table) for part in section.parts if isinstance(part, kind)]


def test_there_are_as_many_figures_as_parameters_not_points():
    many = [point({"n": n, "m": m, "seed": seed}, [row("a", 0.1 * n, 1), row("b", 0.2, m)])
            for n in (1, 2, 3, 4) for m in (5, 6) for seed in range(8)]  # fmt: skip
    table = frame(*many)
    found = parts(table, Figure)
    # Error and time over n for both m, over m for all n, and one over the seeds.
    assert len(found) == 2 * 2 + 2 * 4 + 1
    assert len({figure.key for figure in found}) == len(found)
    only_seeds = frame(*[point({"seed": seed}, [row("a", 0.1, 1), row("b", 0.2, 2)]) for seed in range(8)])
    assert len(parts(only_seeds, Figure)) == 1


def test_a_curve_s_numbers_stand_below_it():
    error = next(figure for figure in parts(frame(*FOUR), Figure) if figure.key.startswith("sweep-n-error"))
    assert error.table.loc["sure", "n 1"] == pytest.approx(0.2) and error.table.loc["sure", "± at 4"] == pytest.approx(
        np.sqrt(0.08)
    )
    assert error.title == "sure errs least at every value of n; from 1 to 4 that of sure changes most, 0.2 to 0.4"
    time = next(figure for figure in parts(frame(*FOUR), Figure) if figure.key.startswith("sweep-n-time"))
    assert time.title == "middle is the quickest at every value of n; from 1 to 4 that of sure grows most, 4-fold"
    assert "means over 2 seeds" in error.caption


def test_texts_are_a_parameter_too():
    table = frame(
        *[
            point({"how": how}, [row("a", error, 1), row("b", 0.5, 2)])
            for how, error in (("coarse", 0.4), ("fine", 0.6))
        ]
    )
    (error, _) = parts(table, Figure)
    assert error.title.startswith("Which label errs least depends on how: a at coarse; b at fine")


def test_a_point_that_failed_is_said_and_not_drawn():
    half = row("sure", 0.999, 1)
    bad = point({"n": 2, "seed": 1}, [half], status="failed", reason="the integration failed at step 2", exit_code=1)
    none = point({"n": 3, "seed": 1}, [], status="died", reason="Slurm says NODE_FAIL", digest="")
    table = frame(*FOUR, bad, none)
    assert "n=2,seed=1: failed: the integration failed at step 2" in figures.warnings(table)
    assert sweeps.facts(table) == sweeps.facts(frame(*FOUR))
    assert all("n 2" not in figure.table.columns for figure in parts(table, Figure))
    (listing,) = [part for part in parts(table, Table) if part.title == "Every point"]
    assert list(listing.frame.reason[4:]) == ["the integration failed at step 2", "Slurm says NODE_FAIL"]


def test_without_any_answer_the_page_says_so(tmp_path):
    made = sweep(point({"seed": 1}, [], status="failed", reason="so it is", digest=""))
    (tmp_path / "sweep.json").write_text(json.dumps(made))
    assert main(["report", str(tmp_path), "-o", str(tmp_path / "page.html")]) == 0
    page = (tmp_path / "page.html").read_text()
    assert "No point has answers" in page and "seed=1: failed: so it is" in page and "<svg" not in page


def test_times_of_unlike_processors_are_drawn_apart_and_errors_together():
    nodes = [point({"n": n}, [row("a", 0.1 * n, 1), row("b", 0.2, 2)], processor=processor, host=f"{processor}{n}")
             for processor in "PQ" for n in (1, 2)]  # fmt: skip
    for number, entry in enumerate(nodes):
        entry["name"] += f",{number}"
    table = frame(*nodes)
    assert len([figure for figure in parts(table, Figure) if "time" in figure.key]) == 2
    assert len([figure for figure in parts(table, Figure) if "error" in figure.key]) == 1
    assert any("2 unlike processors" in line for line in figures.warnings(table))
    alike = frame(*[point({"n": n}, [row("a", 0.1, 1)], host=f"node{n}") for n in (1, 2)])
    assert not any("unlike" in line for line in figures.warnings(alike))


def test_points_side_by_side_are_said():
    def at(began, host):
        return point(
            {"seed": len(host) * 100 + began}, [row("a", 0.1, 1)], began=float(began), wall_time_s=10.0, host=host
        )

    assert sweeps.side_by_side(frame(at(0, "x"), at(5, "x"), at(30, "x"), at(0, "yy"), at(11, "yy"))) == {"x": 2}
    assert any(
        "2 points ran while another did on the same machine (x)" in line
        for line in figures.warnings(frame(at(0, "x"), at(5, "x")))
    )
    assert not any("ran while" in line for line in figures.warnings(frame(at(0, "x"), at(11, "x"))))


def test_seeds_that_draw_nothing_are_said():
    alike = [
        point({"n": n, "seed": seed}, [row("a", 0.1, 1)], digest=f"{n}{seed if n == 2 else ''}")
        for n in (1, 2)
        for seed in (1, 2)
    ]
    assert "Different seeds gave one and the same result at n 1: there they draw nothing." in figures.warnings(
        frame(*alike)
    )


# ---- with results


@pytest.fixture
def folder(small_file, tmp_path):
    """A sweep of two points whose result is one cube with all labels, and its summary."""
    (tmp_path / "swept" / "points").mkdir(parents=True)
    path = small_file(ROOT / "configs" / "kostka.toml")
    run = load(path)
    rows = [row(label, float(run.summary.error[label]), 1) for label in run.summary.index]
    for seed in (1, 2):
        shutil.copy(path, tmp_path / "swept" / "points" / f"seed={seed}.h5")
    made = sweep(*[point({"seed": seed}, rows) for seed in (1, 2)])
    (tmp_path / "swept" / "sweep.json").write_text(json.dumps(made))
    return tmp_path / "swept"


def test_the_thesis_s_statements_are_judged_at_every_point(folder):
    table, lost = sweeps.statements(load_sweep(folder))
    run = load(folder / "points" / "seed=1.h5")
    said = {
        f"{v.number}": v.verdict for v in verdicts({"box": scenes.timed(run)}) if v.verdict in ("confirmed", "refuted")
    }
    assert len(said) >= 2 and list(table["no."]) == list(said) and lost == []
    for found in table.itertuples():
        assert (found.confirmed, found.refuted) == ((2, 0) if said[found[1]] == "confirmed" else (0, 2))
    (folder / "points" / "seed=2.h5").write_bytes(b"damaged")
    table, lost = sweeps.statements(load_sweep(folder))
    assert (table.confirmed + table.refuted == 1).all() and len(lost) == 1 and lost[0].startswith("seed=2: ")


def test_the_page_is_one_for_the_folder_and_for_the_files_of_its_points(folder, tmp_path):
    pages = [tmp_path / "folder.html", tmp_path / "files.html", tmp_path / "one.html"]
    files = [str(folder / "points" / f"seed={seed}.h5") for seed in (1, 2)]
    for page, paths in zip(pages, ([str(folder)], files, files[:1])):
        assert main(["report", *paths, "-o", str(page)]) == 0
    texts = [page.read_text() for page in pages]
    assert texts[0] == texts[1] and "What holds at every point" in texts[0]
    assert "What holds at every point" not in texts[2]  # one result is a result
    assert texts[0].count("<figure") == 1
    with browsing(pages[0], width=1200) as opened:
        assert opened.messages == [] and opened.evaluate("document.documentElement.scrollWidth") == 1200


def test_a_sweep_beside_other_files_is_refused(folder, capsys):
    assert main(["report", str(folder), str(folder / "points" / "seed=1.h5"), "-o", str(folder / "page.html")]) == 4
    assert capsys.readouterr().err.strip() == f"{folder}: is the folder of a sweep; a report on it has no other files"


def test_what_is_damaged_is_one_line(folder, capsys):
    for text in (
        "{",
        "[]",
        '{"points": 3}',
        '{"sweep": "s", "title": "t", "parameters": ["n"], "points": [{"name": "x"}]}',
    ):
        (folder / "sweep.json").write_text(text)
        assert main(["report", str(folder), "-o", str(folder / "page.html")]) == 4
        lines = capsys.readouterr().err.strip().splitlines()
        assert len(lines) == 1 and re.match(rf"{re.escape(str(folder))}/sweep.json: is damaged", lines[0]), lines
