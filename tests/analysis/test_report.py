"""The report: what its figures say is so, its page stands alone, and of odd results it says what is odd."""

import os
import re
import shutil
import subprocess
import sys
import xml.dom.minidom
from types import SimpleNamespace

import matplotlib.image
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from editing import edited
from browser import browsing, open_page
from conftest import ROOT, SCENES

from analysis.figures import labels, thesis as thesis_figures
from analysis.figures.error import against, costs, kinds
from analysis.tables import pareto
from analysis.tables.intervals import Interval
from analysis.report import report as report_module
from analysis.__main__ import main
from analysis.figures.figure import PALETTE, Figure, Section, Table, figure, style, svg_of
from analysis.load import load
from analysis.report.page import page, shown
from analysis.report.report import report
from analysis.words import memory


@pytest.fixture(scope="module")
def made(result_file, tmp_path_factory):
    """The report of the small falling scene."""
    path = tmp_path_factory.mktemp("report") / "report.html"
    assert main(["report", str(result_file), "-o", str(path)]) == 0
    return path


@pytest.fixture
def copy(result_file, tmp_path):
    return shutil.copy(result_file, tmp_path / "copy.h5")


@pytest.fixture
def brief(monkeypatch):
    """Reports without the thesis's sections, for what does not concern them."""
    monkeypatch.setattr(thesis_figures, "sections", lambda runs: [])


def smoke(pipeline, path, *settings):
    command = [pipeline, "run", str(ROOT / "configs" / "smoke.toml"), "-o", str(path), "--quiet"]
    for setting in ("timing.repeats=1", *settings):
        command += ["--set", setting]
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # a failed integration ends with 1
    return path


# ---- the page


@pytest.mark.parametrize("width, phone", [(1200, False), (360, True)])
def test_the_page_opens_without_a_message_and_is_not_blank(made, tmp_path, width, phone):
    with browsing(made, width=width, phone=phone) as opened:
        assert opened.messages == []
        opened.click_on("#everything")
        assert opened.evaluate("document.documentElement.scrollWidth") == width  # nothing sticks out to the side
        opened.screenshot(tmp_path / "page.png", whole=False)
        drawn = opened.evaluate(
            "[...document.querySelectorAll('.picture svg')].map(s => s.getBoundingClientRect().width)"
        )
        assert len(drawn) >= 3 and all(size > 250 for size in drawn)
    image = matplotlib.image.imread(tmp_path / "page.png")
    assert image[..., :3].std() > 0.05


def test_text_in_pictures_is_readable_on_a_phone(tmp_path):
    parts = []
    for size in (7.5, 9):
        fig, ax = figure()
        ax.text(0, 0, "a cell", fontsize=size)
        parts.append(Figure("t", svg_of(fig), "c", pd.DataFrame({"x": [1]}), f"f{size * 10:.0f}"))
    (tmp_path / "page.html").write_text(page("t", [], [], [Section("s", parts)]), encoding="utf-8")
    with browsing(tmp_path / "page.html", width=390, phone=True) as opened:
        assert opened.evaluate("document.documentElement.scrollWidth") == 390
        for key, least, wide in (("f75", 9.4, 540), ("f90", 7.9, 380)):
            width = opened.evaluate(f"document.querySelector('#{key} svg').getBoundingClientRect().width")
            sizes = opened.evaluate(f"[...document.querySelectorAll('#{key} text')].map(t => "
                                    "parseFloat(getComputedStyle(t).fontSize))")
            assert min(sizes) * width / 432 >= least  # 432 points wide
            assert abs(width - wide) < 10  # what is large enough fits the screen, the other scrolls within itself
        scrolls = ("(e => [e.scrollWidth > e.clientWidth, getComputedStyle(e).overflowX])"
                   "(document.querySelector('#f75 .picture'))")
        assert opened.evaluate(scrolls) == [True, "auto"]


def without_scripts(path):
    return re.sub(r"<script>.*?</script>", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)


# Scripts hold names of XML namespaces, which look like addresses; that none is asked for the browser tells above.
def test_the_page_needs_nothing_else(made):
    text = without_scripts(made)
    assert not re.search(r"https?://|\bsrc=|@import|<link", text)
    assert set(re.findall(r"url\(([^)#]*)", text)) <= {""}


def test_identifiers_are_unique_and_links_lead_to_them(made):
    text = without_scripts(made)
    found = re.findall(r'\bid="([^"]+)"', text)
    assert len(found) == len(set(found))
    assert set(re.findall(r'href="#([^"]+)"', text)) | set(re.findall(r"url\(#([^)]+)\)", text)) <= set(found)


def test_figures_are_named_and_tables_have_heads(made):
    with browsing(made) as opened:
        named = "f.querySelector('h3 .finding').textContent === f.querySelector('[role=img]').ariaLabel"
        table = "f.querySelector('details table tbody tr')"
        assert opened.evaluate(f"[...document.querySelectorAll('figure')].every(f => {named} && {table})")
        assert opened.evaluate("[...document.querySelectorAll('thead th')].every(h => h.scope === 'col')")
        assert opened.evaluate("[...document.querySelectorAll('tbody tr')].every(r => r.cells[0].scope === 'row')")
        assert opened.evaluate("document.documentElement.lang") == "en"


def test_the_summary_is_that_of_the_file(made, result_file):
    with browsing(made) as opened:
        opened.click_on("#everything")
        rows = opened.evaluate("[...document.querySelector('#summary').parentElement.querySelectorAll('table tr')]"
                               ".map(r => [...r.cells].map(c => c.innerText))")
    heads, *rows = rows
    summary = load(result_file).summary
    assert [row[0] for row in rows] == list(summary.index)
    for head, column, scale in (
        ("error", "error", 1),
        ("FP", "false_positive", 1),
        ("mean time (µs)", "time_mean_ns", 1e3),
        ("FN", "false_negative", 1),
        ("Matthews", "matthews", 1),
    ):
        shown_there = [float(row[heads.index(head)].replace("\u202f", "").replace("–", "nan")) for row in rows]
        np.testing.assert_allclose(shown_there, summary[column].astype(float) / scale, rtol=6e-3, atol=6e-5)


def test_a_press_on_a_head_sorts_and_printing_opens_the_numbers(made):
    with browsing(made) as opened:
        opened.click_on("#everything")
        errors = (
            "[...document.querySelectorAll('#summary ~ .table tbody tr')].map(r => parseFloat(r.cells[1].innerText))"
        )
        for order in (1, -1):
            opened.click_on("#summary ~ .table th:nth-child(2) button")
            found = opened.evaluate(errors)
            assert found == sorted(found, reverse=order < 0)
        closed = "document.querySelectorAll('figure details:not([open])').length"
        assert opened.evaluate(closed) > 0
        opened.evaluate("dispatchEvent(new Event('beforeprint'))")
        assert opened.evaluate(closed) == 0


def test_the_same_file_gives_the_same_bytes(made, result_file):
    assert report([load(result_file)]) == made.read_text(encoding="utf-8")


def test_texts_of_a_file_are_shown_and_not_run(copy, tmp_path):
    evil = '<script>console.error("run")</script>&"' + "x" * 900
    with edited(copy) as file:
        file.attrs["title"] = evil
        file["answers/obb_sat"].attrs["operations_unit"] = evil
    assert main(["report", str(copy), "-o", str(tmp_path / "r.html")]) == 0
    with browsing(tmp_path / "r.html", width=360, phone=True) as opened:
        assert opened.messages == [] and opened.evaluate("document.documentElement.scrollWidth") == 360
    assert "&lt;script&gt;" in (tmp_path / "r.html").read_text(encoding="utf-8")


def test_numbers_are_shown_with_four_digits():
    values = (True, 7, 12345, 0.123456, float("nan"), float("inf"), None, 123456.7, "a<b")
    assert [shown(value) for value in values] == [
        "yes", "7", "12\u202f345", "0.1235", "–", "∞", "–", "123\u202f457", "a<b",
    ]


def test_figures_of_one_page_do_not_share_identifiers():
    def drawn(top):
        fig, axes = figure()
        axes.plot([0, 1], [0, top], **style("obb_sat"))
        return svg_of(fig)

    assert drawn(1) == drawn(1)
    table = pd.DataFrame({"x": [1]})
    parts = [Figure(f"{top}", drawn(top), "", table, f"k{top}") for top in (1, 2)] + [Table("t", table, "")]
    text = page("t", [], [], [Section("s", parts)])
    found = re.findall(r'\bid="([^"]+)"', text)
    assert len(found) == len(set(found)) and 'id="f' in text


def test_styles_are_stable_and_differ():
    names = [
        "obb_sat",
        "bounding_sphere",
        "rotated_aabb",
        "facet_distance",
        "obb_corners",
        "facet_vectors",
        "obb_triangles",
        "facet_triangles",
        "facet_rotations",
        "cannon_naive",
        "cannon_sap",
        "aabb",
        "my_method",
    ]
    looks = [(style(name)["color"], style(name)["marker"]) for name in names]
    assert len(set(looks)) == len(names) and {colour for colour, _ in looks} <= set(PALETTE.values())


# ---- the front, the lines and the names


@pytest.mark.parametrize("seed", range(20))
def test_the_front_is_what_nothing_dominates(seed):
    random = np.random.default_rng(seed)
    cost, error = random.integers(0, 8, (2, random.integers(1, 30)))  # ties happen
    found = pareto.front(cost, error)
    for i in range(len(cost)):
        beaten = any(
            cost[j] <= cost[i] and error[j] <= error[i] and (cost[j], error[j]) != (cost[i], error[i])
            for j in range(len(cost))
        )
        assert found[i] != beaten, f"seed {seed}: {cost} {error}"


def test_which_methods_are_of_a_library_is_told_by_the_file(result_file):
    run = load(result_file)
    label = run.meta["algorithms"][0]
    run.meta["answers"][label]["library"] = "FCL 0.7.0"
    told = pareto.scenes([run])[0].points
    assert list(told.label[told.library]) == [label]


def test_sweeps_join_labels_that_differ_in_one_number():
    knobs = [
        {"stride": 5, "strip": "a"},
        {"stride": 20, "strip": "a"},
        {"stride": 10, "strip": "a"},
        {"stride": 5, "strip": "b"},
        {"on": True},
    ]
    points = pd.DataFrame({"algorithm": ["f", "f", "f", "f", "g"], "knobs": knobs, "cost": [4, 1, 2, 3, 0]})
    assert pareto.sweeps(points) == [("f", "stride", [0, 2, 1])]
    points.loc[4, "algorithm"] = "f"


def closest(point, line):
    """How far a point is from the stretch x0 y0 x1 y1, by trying 1001 points of it."""
    at = np.linspace(line[:2], line[2:], 1001)
    return np.hypot(*(at - point).T).min()


@pytest.mark.parametrize(
    "seed, count, spread, long",
    [(0, 2, (90, 30), 110), (1, 12, (90, 30), 110), (2, 24, (90, 30), 110), (3, 24, (30, 15), 150),
     (4, 60, (90, 40), 110), (5, 60, (60, 60), 200)],
)
def test_labels_are_tied_to_their_marks_and_cover_nothing(seed, count, spread, long):
    random = np.random.default_rng(seed)
    one = random.normal((200, 150), spread, (count // 2, 2))  # and the same marks of a second file, a bit slower
    marks = np.vstack([one, one + random.uniform((1, 0), (12, 0), one.shape)]).clip((20, 20), (380, 280))
    sizes = np.column_stack([random.uniform(30, long, count), np.full(count, 9)])
    region = (0, 0, 420, 300)
    corners, leaders = labels.place(np.arange(count), sizes, region, marks, np.full(count, 4), [])
    put = ~np.isnan(corners[:, 0])
    assert put.sum() >= min(count, 15), f"seed {seed}"
    low, high = corners[put], corners[put] + sizes[put]
    assert (low >= 0).all() and (high <= region[2:]).all()
    covered = (low[:, None] < high[None]).all(axis=2) & (low[None] < high[:, None]).all(axis=2)
    assert not (covered & ~np.eye(put.sum(), dtype=bool)).any(), f"seed {seed}"
    assert not ((low[:, None] < marks[None] + 4) & (marks[None] - 4 < high[:, None])).all(axis=2).any(), f"seed {seed}"
    for label in np.flatnonzero(put):
        box = corners[label], corners[label] + sizes[label]
        far = np.hypot(*(marks - marks.clip(*box)).T)  # of every mark from this label
        strangers = np.hypot(*(marks - marks[label]).T) > 1.5
        if np.isnan(leaders[label]).any():
            assert far[label] < far[strangers].min(initial=np.inf), f"seed {seed}, label {label}"
            assert far[label] < 4 + 7
        else:
            start, end = leaders[label][:2], leaders[label][2:]
            assert np.hypot(*(start - marks[label])) == pytest.approx(4)
            assert np.hypot(*(end - end.clip(*box))) < 1e-9
            assert all(closest(mark, leaders[label]) > 4 for mark in marks[strangers]), f"seed {seed}, label {label}"


def test_names_of_two_files_side_by_side_are_tied_to_their_own_marks():
    names = ["facet_vectors", "facet_rotations", "facet_triangles", "obb_triangles", "obb_corners", "aabb", "exact"]
    rows = [
        {"label": f"{name} (k{file})", "algorithm": name, "time_mean_ns": 1e5 * (1 + 0.07 * i) * (1 + 0.03 * n),
         "error": 0.9 + 0.004 * i, "front": i == 0, "scope": "pair", "exact": False, "library": False, "knobs": {}}
        for i, name in enumerate(names) for n, file in enumerate("AB")
    ]
    points = pd.DataFrame(rows)
    fig, _, nameless = against._draw(points, "time_mean_ns")
    main = fig.axes[0]
    to_pixels = fig.transFigure.transform
    marks = main.transData.transform(points[["time_mean_ns", "error"]].to_numpy())
    texts = {text.get_text(): text.get_window_extent() for text in fig.texts}
    assert len(texts) >= 8 and set(texts) | set(nameless) == set(points.label)
    ties = [(to_pixels(np.column_stack(line.get_data())), line.get_color()) for line in fig.artists]
    for row, label in enumerate(points.label):
        if label not in texts:
            continue
        box = texts[label].min - 3, texts[label].max + 3  # a line may end at the edge of another font's letters
        far = np.hypot(*(marks - marks.clip(texts[label].min, texts[label].max)).T)
        mine = [colour for ends, colour in ties if (ends[1] == ends[1].clip(*box)).all()]
        if mine:
            assert mine == [style(points.algorithm[row])["color"]], label
            (start,) = [ends[0] for ends, _ in ties if (ends[1] == ends[1].clip(*box)).all()]
            assert np.argmin(np.hypot(*(marks - start).T)) == row, label
        else:
            assert np.argmin(far) == row, label
    plt.close(fig)


@pytest.mark.parametrize("line", [(115, 0, 115, 200), (107.5, 0, 107.5, 200)], ids=["through it", "at its edge"])
def test_a_label_goes_where_no_line_touches_it(line):
    free, _ = labels.place([0], [(40, 9)], (0, 0, 200, 200), [(100, 100)], [4], [])
    assert tuple(free[0]) == (108, 95.5)  # to the right, in the middle
    ((left, _),), _ = labels.place([0], [(40, 9)], (0, 0, 200, 200), [(100, 100)], [4], [line])
    assert not left - 1 < line[0] < left + 41


def points(rows):
    """label, error, ns -> what finding() asks of points."""
    table = pd.DataFrame(rows, columns=["label", "error", "time_mean_ns"])
    return table.assign(front=pareto.front(table.time_mean_ns, table.error))


@pytest.mark.parametrize("rows, words", [
    ([("a", 0.5, 1000.0)], "a errs 0.5 at 1 µs; it is alone, there is nothing to compare it with"),
    ([("a", 0.5, 1000.0), ("b", 0.7, 3000.0)],
     "a errs least, 0.5, and is also the fastest, 1 µs: no other is worth its cost here"),
    ([("a", 0.5, 1e3), ("b", 0.2, 3e3), ("c", 0.0, 2e6)],
     "c makes no error at 2 ms; nothing faster errs less than 0.2 (b, 3 µs); the fastest, a at 1 µs, errs 0.5"),
    ([("a", 0.0, 10.0), ("b", 0.0, 5.0)], "No algorithm errs on this scene; b is the fastest, 5 ns"),
    ([("a", 0.5, 1e3), ("b", 0.2, 3e3)], "b errs least, 0.2, at 3 µs; nothing faster errs less than 0.5 (a, 1 µs)"),
    ([], "No algorithm has a cost that could be drawn"),
])
def test_the_title_says_what_the_figure_shows(rows, words):
    assert against.finding(points(rows), "time_mean_ns") == words


# ---- figures of results


def figures(runs):
    found = pareto.scenes(runs)
    return [against.against(scene, scene.points, cost, "k") for scene in found for cost in against.COSTS]


@pytest.mark.parametrize("config", SCENES, ids=lambda path: path.stem)
def test_every_configuration_gives_figures_with_all_its_labels(small_file, config):
    """Of others with how they were asked. What costs nothing has no place on a logarithmic axis, and is named."""
    run = load(small_file(config))
    names = {label: label + pareto.how_asked(run.meta["answers"][label]) for label in run.meta["algorithms"]}
    for cost, drawn in zip(against.COSTS, figures([run])):
        free = {names[label] for label, row in run.summary.iterrows() if not row[cost] > 0}
        assert sorted(drawn.table.label) == sorted(set(names.values()) - free)
        for name in names.values():
            if name in free:
                assert name in drawn.caption
            else:  # under the pointer, when not beside the mark
                assert f"<title>{name}: error " in drawn.svg
        xml.dom.minidom.parseString(drawn.svg)


def test_few_labels_are_all_named_beside_their_marks(result_file):
    run = load(result_file)
    for drawn in figures([run]):
        named = re.findall(r"<text[^>]*>([^<]*)</text>", drawn.svg)
        assert set(run.meta["algorithms"]) <= set(named)


def test_long_labels_leave_room_to_the_bars_and_none_is_an_axis_of_its_own_size(result_file, monkeypatch):
    drawn = []
    monkeypatch.setattr(kinds, "svg_of", lambda fig, titles=None: drawn.append(fig) or "")
    scene, = pareto.scenes([load(result_file)])
    scene.points["label"] += "-with-a-name-of-sixty-four-characters-as-the-configuration-allows"
    scene.points["false_negative"] = 0
    kinds.kinds(scene, "k")
    drawn[0].draw_without_rendering()
    for axes in drawn[0].axes:
        assert axes.get_window_extent().width > 120  # of 432
        assert axes.xaxis.get_offset_text().get_text() == ""  # not "1e-9"


def test_an_algorithm_without_error_stands_in_the_strip(copy):
    assert "none is without error" in figures([load(copy)])[0].svg
    with edited(copy) as file:
        file["answers/obb_sat"].attrs["promise"] = "exact"
        for name in ("error", "false_positive", "false_negative"):
            values = file[f"summary/{name}"][()]
            values[list(file["algorithm"].asstr()).index("obb_sat")] = 0
            file[f"summary/{name}"][...] = values
    drawn = figures([load(copy)])[0]
    assert drawn.title.startswith("obb_sat makes no error at ")
    assert "none is without error" not in drawn.svg and "ring: promises exactness" in drawn.svg


def test_names_in_the_strip_stand_off_the_front(copy, tmp_path):
    with edited(copy) as file:
        for name in ("error", "false_positive", "false_negative"):
            file[f"summary/{name}"][...] = 0
        file["summary/time_mean_ns"][...] = 10.0 ** np.arange(3, 3 + len(file["algorithm"]))
    (tmp_path / "page.html").write_text(page("t", [], [], [Section("s", figures([load(copy)])[:1])]), encoding="utf-8")
    with browsing(tmp_path / "page.html") as opened:
        boxes = ("[...document.querySelectorAll('svg %s')].map(e => e.getBoundingClientRect())"
                 ".map(r => [r.top, r.bottom, r.width])")
        dashed = opened.evaluate(boxes % "path[style*=dasharray]")
        names = [box for box in opened.evaluate(boxes % "g[style*=paint-order] text")]
    front = next(bottom for top, bottom, width in dashed if width > 100)  # it ends level, at no error
    assert len(names) == len(load(copy).summary)
    first, *others = sorted(names, key=lambda box: abs((box[0] + box[1]) / 2 - front))
    for top, bottom, _ in others:  # the first stands before the line begins
        assert bottom < front or top > front


# ---- several files, machines, and what is odd


def test_files_of_one_motion_share_figures_and_equal_answers_count_once(result_file, copy):
    found = pareto.scenes([load(result_file), load(copy)])
    assert len(found) == 1 and list(found[0].points.label) == load(result_file).meta["algorithms"]


def test_another_machines_times_are_drawn_apart_and_it_is_said(result_file, copy, tmp_path, brief):
    with edited(copy) as file:
        file["answers/obb_sat"].attrs["processor"] = "Other processor"
    path = tmp_path / "r.html"
    assert main(["report", str(copy), "-o", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    assert "timed on 2 different machines or builds" in text and "Their times are drawn apart" in text
    assert "“pipeline detect FILE --force” times them anew" in text
    assert 'id="error-time-1-1"' in text and 'id="error-time-1-2"' in text
    apart = text[text.index('id="error-time-1-2"') :]
    assert apart[: apart.index("</figure>")].count("<title>") == 1  # obb_sat alone
    together = text[text.index('id="error-operations-1"') :]
    assert together[: together.index("</figure>")].count("<title>") == len(load(copy).meta["algorithms"])
    assert main(["report", str(result_file), str(copy), "-o", str(path)]) == 0
    assert "obb_sat (copy)" in path.read_text(encoding="utf-8")


def test_other_scenes_have_figures_of_their_own(small_file, tmp_path, brief):
    files = [str(small_file(config)) for config in SCENES if config.stem in ("hriste", "kostka")]
    assert main(["report", *files, "-o", str(tmp_path / "r.html")]) == 0
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert 'id="error-time-1-1"' in text and 'id="error-time-2-1"' in text and "do not compare" in text


def odd(path, tmp_path, *words):
    """A report of `path` is made, opens without a message, and says `words`."""
    output = tmp_path / "odd.html"
    assert main(["report", str(path), "-o", str(output)]) == 0
    text = output.read_text(encoding="utf-8")
    for word in words:
        assert word in text, word
    assert open_page(output) == []


def test_the_lead_counts_a_test_once_in_however_many_scenes(result_file, small_file):
    runs = [load(result_file), load(small_file(ROOT / "configs" / "hriste.toml"))]
    tests = {(answers["name"], answers["knobs"]) for run in runs for answers in run.meta["answers"].values()}
    assert report_module.lead(runs, pareto.scenes(runs))[0].startswith(f"How often {len(tests)} collision tests")
    assert len(tests) < sum(len(run.meta["algorithms"]) for run in runs)


def test_a_file_that_stands_beside_another_for_its_times_is_no_scene_more(monkeypatch):
    whole, beside = SimpleNamespace(), SimpleNamespace()
    monkeypatch.setattr(report_module.scenes, "companions", lambda runs: {"falling": beside})
    found = [SimpleNamespace(runs=[whole]), SimpleNamespace(runs=[beside]), SimpleNamespace(runs=[whole, beside])]
    assert report_module.own_scenes([whole, beside], found) == [found[0], found[2]]


def test_what_is_to_be_minded_of_several_files_is_said_once(result_file, tmp_path):
    runs = [load(shutil.copy(result_file, tmp_path / f"{name}.h5")) for name in ("one", "two")]
    for run in runs:
        run.meta["git_commit"] = "0123456789-dirty"
    told = report_module.warnings(runs, [])
    assert "one and two: made by a program whose sources differ from commit 0123456." in told
    assert len(told) == len(set(told))


def test_of_other_scenes_than_the_thesiss_no_verdicts_stand_there(small_file):
    run = load(small_file(ROOT / "configs" / "cup.toml"))
    assert report_module.verdict_sections([run], []) == []


def test_zero_hits_are_said(pipeline, tmp_path):
    config = tmp_path / "far.toml"
    (tmp_path / "poses.csv").write_text("step,body,px,py,pz,qw,qx,qy,qz\n" + "".join(
        f"{step},{body},{x},0,0,1,0,0,0\n" for step in range(3) for body, x in (("a", 0), ("b", 50))))
    balls = "".join(f'[[scene.body]]\nname = "{name}"\nshape = "sphere"\nradius = 0.5\n' for name in "ab")
    config.write_text(f'[scene]\nkind = "replay"\nposes = "poses.csv"\n{balls}')
    path = tmp_path / "far.h5"
    subprocess.run([pipeline, "run", str(config), "-o", str(path), "--quiet"], check=True, stdout=subprocess.DEVNULL)
    odd(path, tmp_path, "no two bodies ever meet", "No algorithm errs on this scene", "No pair meets")


def test_one_algorithm_is_said(pipeline, tmp_path):
    path = smoke(pipeline, tmp_path / "x.h5", "steps=20", "algorithm=[{name='obb_sat'}]")
    odd(path, tmp_path, "only one algorithm, obb_sat", "it is alone")


def test_a_failed_integration_is_said(pipeline, tmp_path):
    path = smoke(pipeline, tmp_path / "x.h5", "steps=30", "physics.step_budget=1")
    odd(path, tmp_path, "the integration failed at step", "nothing moves and nothing meets")


def test_a_result_without_algorithms_is_said(copy, tmp_path):
    with edited(copy) as file:
        for group in ("results", "summary", "answers", "algorithm"):
            del file[group]
    odd(copy, tmp_path, "no algorithm has answered", "There is nothing to draw")


@pytest.mark.parametrize(
    "group", ["physics", "results", "bodies", "meshes", "motion", "truth", "run", "summary", "config", "passes"]
)
def test_a_group_that_is_missing_is_no_obstacle(copy, tmp_path, group):
    with edited(copy) as file:
        if group in file:
            del file[group]
    said = {"results": "lacks /results", "motion": "lacks /motion", "truth": "has no truth",
            "summary": "the summary of the algorithms is missing", "run": "lacks /run"}
    assert main(["report", str(copy), "-o", str(tmp_path / "odd.html")]) == 0
    assert said.get(group, "") in (tmp_path / "odd.html").read_text(encoding="utf-8")


def test_what_makes_times_or_answers_doubtful_is_said(copy, tmp_path, brief):
    with edited(copy) as file:
        file.attrs["build_type"] = "Debug"
        file.attrs["git_commit"] = "0123456789-dirty"
        kept = file["summary/promise_kept"][()]
        kept[0] = 0
        file["summary/promise_kept"][...] = kept
        label = file["algorithm"].asstr()[0]
        file[f"answers/{label}"].attrs["processor"] = "Xeon, frequency governor powersave"
    odd(copy, tmp_path, "a debug build timed this", "the processor changed its frequency",
        f"broke their promise: {label}", "differ from commit 0123456")


# ---- the output


def test_a_name_that_is_no_utf8_is_drawn(copy, tmp_path, brief):
    strange = os.fsdecode(os.fsencode(tmp_path / "strange") + b"\xff.h5")
    shutil.copy(copy, strange)
    assert main(["report", strange, "-o", str(tmp_path / "r.html")]) == 0
    assert "strange?" in (tmp_path / "r.html").read_text(encoding="utf-8")


def test_only_pages_are_overwritten(made, result_file, tmp_path, capsys, brief):
    precious = tmp_path / "precious.txt"
    precious.write_text("mine")
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for output in (precious, pipe, tmp_path, tmp_path / "no" / "folder.html"):
        assert main(["report", str(result_file), "-o", str(output)]) == 4
        said = capsys.readouterr().err
        assert said.startswith(f"{output}: ") and said.count("\n") == 1, said
    assert precious.read_text() == "mine"
    assert pipe.is_fifo()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["pipe", "precious.txt"]
    assert main(["report", str(result_file), "-o", str(shutil.copy(made, tmp_path / "again.html"))]) == 0


def test_the_script_finds_its_python_from_any_folder(result_file, tmp_path):
    run = subprocess.run(
        [str(ROOT / "scripts" / "report"), str(result_file)], cwd=tmp_path, text=True, capture_output=True
    )
    assert run.returncode == 0 and run.stdout == "report.html\n" and run.stderr == "", run.stderr
    assert (tmp_path / "report.html").stat().st_size > 10000


# ---- README


def test_the_ten_lines_of_the_page_draw_its_picture(result_file, tmp_path):
    text = (ROOT / "analysis" / "README.md").read_text(encoding="utf-8")
    (code,) = [block for block in re.findall(r"```python\n(.*?)```", text, re.DOTALL) if "savefig" in block]
    assert len([line for line in code.splitlines() if line.strip()]) == 10
    (tmp_path / "results").mkdir()
    shutil.copy(result_file, tmp_path / "results" / "padani.h5")
    environment = os.environ | {"PYTHONPATH": str(ROOT), "MPLBACKEND": "agg"}
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=environment, check=True)
    drawn = (tmp_path / "error_against_time.svg").read_text(encoding="utf-8")
    (picture,) = re.findall(r"!\[[^]]*\]\((\S*error_against_time.svg)\)", text)
    for svg in (drawn, (ROOT / "analysis" / picture).read_text(encoding="utf-8")):
        for words in ("error = (FP + FN) / (TP + FP + FN)", *load(result_file).meta["algorithms"][:3]):
            assert f"<!-- {words} -->" in svg  # matplotlib names each text so


# ---- what a time is worth


def timed_points(*rows):
    """label, error, mean (ns), noise -> points with times of 600 steps whose noise is each label's own."""
    table = points([(label, error, float(mean)) for label, error, mean, _ in rows])
    random = np.random.default_rng(3)
    table["times"] = [mean * (1 + noise * random.uniform(-1, 1, 600)) for _, _, mean, noise in rows]
    return table.assign(machine="m", floor=None)


def test_the_title_says_as_fast_as_where_no_difference_can_be_told():
    drawn = timed_points(("a", 0.5, 1000, 0.1), ("b", 0.4, 1001, 0.1), ("c", 0.2, 3000, 0.1), ("d", 0.9, 1002, 0.1))
    title = against.finding(drawn, "time_mean_ns")
    assert title == ("c errs least, 0.2, at 3 µs; nothing faster errs less than 0.4 (b, 1 µs); the fastest, a at 1 µs,"
                     " errs 0.5; b and d are as fast as a")


def test_what_is_as_fast_is_not_called_faster():
    drawn = timed_points(("a", 0.5, 1000, 0.1), ("b", 0.2, 1001, 0.1))
    title = against.finding(drawn, "time_mean_ns")
    assert title == ("b errs least, 0.2, at 1 µs and is as fast as a, 1 µs, which errs 0.5: "
                     "no other is worth its cost here")
    drawn = timed_points(("a", 0.5, 1000, 0.01), ("b", 0.2, 1020, 0.01))
    assert "nothing faster errs less than 0.5 (a, 1 µs)" in against.finding(drawn, "time_mean_ns")
    drawn["floor"] = [Interval(1.0, 0.97, 1.01)] * 2
    assert "as fast as a" in against.finding(drawn, "time_mean_ns")


def test_times_of_other_machines_are_never_as_fast():
    drawn = timed_points(("a", 0.5, 1000, 0.1), ("b", 0.2, 1001, 0.1)).assign(machine=["m", "n"])
    assert not pareto.alike(drawn.iloc[0], drawn.iloc[1])


def test_set_up_and_memory_have_a_figure_beside_and_labels_of_which_nothing_is_known_are_said(result_file, copy):
    scene, = pareto.scenes([load(result_file)])
    drawn = costs.costs(scene, scene.points, "k")
    assert list(drawn.table.label) == list(scene.points.sort_values(["time_mean_ns", "error"]).label)
    setup = scene.points.set_index("label").setup_ns[drawn.table.label]
    np.testing.assert_allclose(drawn.table["set-up (µs)"] * 1e3, setup)
    greatest = scene.points.loc[scene.points.memory_greatest_bytes.idxmax(), "label"]
    assert f"{greatest} takes most memory" in drawn.title or f"{greatest} takes longest to set up" in drawn.title
    assert all(label in drawn.svg for label in scene.points.label)
    unknown = scene.points.assign(memory_bytes=scene.points.memory_bytes.mask(scene.points.label == "obb_sat"))
    assert "Nothing is known of the memory of obb_sat." in costs.costs(scene, unknown, "k").caption
    assert costs.costs(scene, scene.points.drop(columns="setup_ns"), "k") is None


def test_ticks_of_memory_are_round_in_its_own_units():
    ticks = [memory(tick) for tick in costs._binary((5e3, 2e7))]
    assert ticks == ["10 KiB", "100 KiB", "1 MiB", "10 MiB"]
    assert len(costs._binary((15, 20))) == 1


def test_intervals_are_bars_that_the_axis_holds(result_file, monkeypatch):
    scene, = pareto.scenes([load(result_file)])
    mean = scene.points.time_mean_ns
    points = scene.points.assign(time_mean_low_ns=mean / 3, time_mean_high_ns=mean * 3)
    points["front"] = True
    fig, titles, _ = against._draw(points.reset_index(drop=True), "time_mean_ns")
    low, high = fig.axes[0].get_xlim()
    assert low < points.time_mean_low_ns.min() and points.time_mean_high_ns.max() < high
    bars = [line.get_xdata() for axes in fig.axes[:2] for line in axes.lines if len(line.get_xdata()) == 2]
    for _, point in points.iterrows():
        assert any(np.allclose(bar, [point.time_mean_low_ns, point.time_mean_high_ns]) for bar in bars), point.label
        assert any(" to " in text for text in titles.values())
    plt.close(fig)
