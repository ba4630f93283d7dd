"""The page in a browser: one view at a time, what answers to the pointer, dark, files; and its parts without one."""

import json
import re

import pandas as pd
import pytest
from browser import browsing

from analysis.__main__ import main
from analysis.figures import knobs, nine
from analysis.figures.figure import know, style
from analysis.load import load
from analysis.report import report as report_module, vega
from analysis.tables import pareto, scenes
from conftest import ROOT

SHOWN = "[...document.querySelectorAll('.view')].filter(v => v.offsetHeight).map(v => v.id)"
MARKS = "[...document.querySelectorAll('#explorer-1 .drawn svg .mark-symbol path[aria-label]')]"
NAMES = f"{MARKS}.map(m => m.getAttribute('aria-label').split(/[\\n (]/)[0])"
DRAWN = "document.querySelector('#explorer-1').drawn.then(() => true)"


@pytest.fixture(scope="module")
def result(small_file):
    """A few steps of the thesis's falling scene: its nine, the engine's two, and others."""
    return small_file(ROOT / "configs" / "padani.toml")


@pytest.fixture(scope="module")
def made(result, tmp_path_factory):
    """The report of that, and its figures as files."""
    folder = tmp_path_factory.mktemp("page")
    arguments = ["report", str(result), "-o", str(folder / "r.html"), "--figures", str(folder / "figures")]
    assert main(arguments) == 0
    return folder


@pytest.fixture(scope="module")
def playground(small_file, tmp_path_factory):
    """The report of some steps of the playground, which has maps and long names."""
    path = tmp_path_factory.mktemp("page") / "hriste.html"
    assert main(["report", str(small_file(ROOT / "configs" / "hriste.toml")), "-o", str(path)]) == 0
    return path


@pytest.fixture(scope="module")
def opened(made):
    with browsing(made / "r.html", width=1400, height=1000) as page_:
        page_.evaluate("location.hash = '#explorer-1'")
        page_.settle()
        page_.evaluate(DRAWN)
        yield page_


def middle(page_, mark):
    """Where a mark is in the window, and it is scrolled there."""
    return page_.evaluate(f"(() => {{ const m = {mark}; m.scrollIntoView({{block: 'center'}}); const b = "
                          "m.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()")


def hover(page_, x, y):
    page_._call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    page_.settle()


def pick(page_, name, value):
    page_.evaluate(f"(() => {{ const s = document.querySelector('#explorer-1 [name={name}]'); s.value = '{value}'; "
                   "s.dispatchEvent(new Event('change')); })()")
    page_.evaluate(DRAWN)


def test_one_view_is_shown_and_a_link_shows_that_of_its_target(made):
    with browsing(made / "r.html") as page_:
        assert page_.evaluate(SHOWN) == ["view-overview"]
        page_.evaluate("location.hash = '#summary'")
        page_.settle()
        assert page_.evaluate(SHOWN) == ["view-falling-spheres"]
        page_.click_on(".side a[href='#what-was-run']")
        page_.settle()
        assert page_.evaluate(SHOWN) == ["view-about"]
        page_.click_on("#everything")
        assert page_.evaluate(SHOWN) == ["view-overview", "view-falling-spheres", "view-about"]
        assert page_.messages == []


def test_without_scripts_all_is_there(made):
    text = re.sub(r"<script>.*?</script>", "", (made / "r.html").read_text(encoding="utf-8"), flags=re.DOTALL)
    (made / "bare.html").write_text(text, encoding="utf-8")
    with browsing(made / "bare.html") as page_:
        assert len(page_.evaluate(SHOWN)) == 3
        assert page_.evaluate("document.querySelector('#error-time-1-1 svg').getBoundingClientRect().width") > 300
        assert page_.evaluate("document.querySelector('#explorer-1').offsetHeight") == 0  # nothing empty is shown


def test_the_explorer_draws_every_label_and_tells_it_to_the_pointer(opened, result):
    summary = load(result).summary
    assert sorted(opened.evaluate(NAMES)) == sorted(summary.index)
    x, y = middle(opened, f"{MARKS}.find(m => m.getAttribute('aria-label').startsWith('obb_sat'))")
    hover(opened, x, y)
    told = opened.evaluate("document.querySelector('.tip').hidden ? '' : document.querySelector('.tip').textContent")
    assert told.startswith("obb_sat (G)") and f"{summary.error['obb_sat']:.3g}" in told
    hover(opened, 5, 5)
    assert opened.evaluate("document.querySelector('.tip').hidden")
    assert opened.messages == []


def test_a_filter_a_legend_and_axes_change_what_is_drawn(opened):
    whole = set(opened.evaluate(NAMES))
    pick(opened, "only", "nine")
    assert set(opened.evaluate(NAMES)) == whole & set(nine.NINE) < whole
    pick(opened, "only", "promise:exact")
    assert set(opened.evaluate(NAMES)) == {name for name in whole if name.startswith("exact")}
    pick(opened, "only", "all")
    opened.click_on("#explorer-1 .legend [aria-label='hide obb_sat']")
    opened.evaluate(DRAWN)
    assert set(opened.evaluate(NAMES)) == whole - {"obb_sat"}
    opened.click_on("#explorer-1 .legend [aria-label='show obb_sat']")
    opened.evaluate(DRAWN)
    assert set(opened.evaluate(NAMES)) == whole
    title = "document.querySelector('#explorer-1 .drawn svg').textContent"
    assert "error, share of wrong answers, log" in opened.evaluate(title)
    pick(opened, "y", "recall")
    assert "recall, share of meeting pairs found" in opened.evaluate(title)
    pick(opened, "x", "operations")
    assert "kinds do not compare" in opened.evaluate(title)
    pick(opened, "x", "time_mean_ns")
    pick(opened, "y", "error")


def test_zooming_changes_the_axis_and_whole_restores_it(opened):
    axis = "document.querySelector('#explorer-1').view.scale('x').domain()"
    before = opened.evaluate(axis)
    opened.evaluate("[...document.querySelectorAll('#explorer-1 button')].find(b => b.textContent === '+').click()")
    opened.settle()
    after = opened.evaluate(axis)
    assert before[0] < after[0] < after[1] < before[1]
    opened.evaluate("[...document.querySelectorAll('#explorer-1 button')].find(b => b.textContent === 'whole').click()")
    opened.evaluate(DRAWN)
    assert opened.evaluate(axis) == before


def test_one_label_is_highlighted_over_figures_and_tables(opened):
    opened.evaluate("[...document.querySelectorAll('#explorer-1 .legend .pick')].find(b => b.textContent === "
                    "'obb_sat').click()")
    opened.settle()
    lit = "[...document.querySelectorAll('[data-of].on')]"
    places = opened.evaluate(f"[...new Set({lit}.map(e => e.closest('figure') ? e.closest('figure').id : e.tagName))]")
    assert {"TR", "LI", "error-time-1-1", "error-kinds-1", "precision-recall-1"} <= set(places)
    assert opened.evaluate(f"{lit}.every(e => e.dataset.of === 'obb_sat')")
    assert float(opened.evaluate("getComputedStyle(document.querySelector('#error-time-1-1 svg "
                                 "[data-of]:not(.on)')).opacity")) < 0.3
    assert float(opened.evaluate("getComputedStyle(document.querySelector('#error-time-1-1 svg "
                                 "[data-of].on')).opacity")) == 1
    opened.press("Escape")
    assert opened.evaluate("document.querySelectorAll('[data-of].on').length") == 0


def test_a_mark_leads_to_its_worst_step_in_the_3d_page(opened, result):
    table = load(result).per_step
    mine = table[table.algorithm == "bounding_sphere"]
    wrong = (mine.false_positive.astype(int) + mine.false_negative.astype(int)).to_numpy()
    x, y = middle(opened, f"{MARKS}.find(m => m.getAttribute('aria-label').startsWith('bounding_sphere'))")
    opened.click(x, y)
    link = opened.evaluate("document.querySelector('#explorer-1 .card a.worst').getAttribute('href')")
    assert link == f"padani_step{wrong.argmax()}.html#step={wrong.argmax()}&algorithm=bounding_sphere"
    assert f"--step {wrong.argmax()} --algorithm bounding_sphere" in opened.evaluate(
        "document.querySelector('#explorer-1 .card').textContent")
    opened.press("Escape")


def test_dark_is_dark_and_light_again(opened):
    colour = "getComputedStyle(document.body).backgroundColor"
    light = opened.evaluate(colour)
    opened.click_on("#dark")
    assert sum(map(int, re.findall(r"\d+", opened.evaluate(colour))[:3])) < 120 < sum(map(int, re.findall(r"\d+",
        light)[:3]))
    opened.evaluate(DRAWN)
    opened.click_on("#dark")
    assert opened.evaluate(colour) == light
    assert opened.messages == []


def test_figures_are_saved_by_their_buttons(opened):
    opened.evaluate("window.saved = []; HTMLAnchorElement.prototype.click = function () { saved.push([this.download, "
                    "this.href]); }")
    for kind in ("svg", "csv", "png"):
        opened.evaluate(f"document.querySelector('#error-time-1-1 [data-save={kind}]').click()")
    opened.evaluate("new Promise(done => { const wait = () => saved.length > 2 ? done() : setTimeout(wait, 20); "
                    "wait(); })")
    assert {name for name, _ in opened.evaluate("saved")} == {f"error-time-1-1.{kind}" for kind in ("svg", "csv",
        "png")}
    text = opened.evaluate("fetch(saved.find(s => s[0].endsWith('csv'))[1]).then(r => r.text())")
    assert text.splitlines()[0].startswith("label,error,mean time")
    size = opened.evaluate("fetch(saved.find(s => s[0].endsWith('png'))[1]).then(r => r.blob()).then(b => "
                           "createImageBitmap(b))"
                           ".then(i => i.width)")
    assert size > 800


def test_verdicts_are_filtered(made):
    with browsing(made / "r.html") as page_:
        page_.click_on(".filters [data-word=not]")
        shown = "[...document.querySelectorAll('.verdict')].filter(v => v.offsetHeight).map(v => v.classList[1])"
        assert set(page_.evaluate(shown)) == {"not"}


def test_a_link_to_a_verdict_unfolds_it(made):
    with browsing(made / "r.html") as page_:
        folds = "[...document.querySelectorAll('.verdict > details')]"
        assert not page_.evaluate(f"{folds}.some(d => d.open)")
        page_.evaluate("location.hash = '#statement-12'")
        page_.settle()
        assert page_.evaluate(f"{folds}.filter(d => d.open).map(d => d.parentElement.id)") == ["statement-12"]
        page_.click_on(".filters .unfold")
        assert page_.evaluate(f"{folds}.every(d => d.open)")
        assert page_.evaluate("[...document.querySelectorAll('.verdict')].every(v => v.offsetHeight)")


def test_the_summary_is_read_without_scrolling_at_1400_px(made, playground):
    table = "document.querySelector('[aria-labelledby^=summary] .scroll')"
    for path in (made / "r.html", playground):
        with browsing(path, width=1400, height=1000) as page_:
            page_.click_on("#everything")
            page_.settle()
            assert page_.evaluate(f"{table}.clientWidth") > 900
            assert page_.evaluate(f"{table}.scrollWidth - {table}.clientWidth") <= 0


def test_names_of_a_maps_rows_stay_in_sight(playground):
    with browsing(playground, width=420, height=900, phone=True) as page_:
        page_.click_on("#everything")
        page_.settle()
        picture = "document.querySelector('#map-obstacles .picture')"
        names = f"[...{picture}.querySelectorAll('.row')].map(n => n.getBoundingClientRect().x)"
        before = page_.evaluate(names)
        moved = page_.evaluate(f"({picture}.scrollLeft = 90, {picture}.scrollLeft)")
        assert moved == 90 and len(before) > 10
        page_.settle()
        assert page_.evaluate(names) == pytest.approx(before, abs=1)
        assert page_.messages == []


def test_a_phone_has_nothing_that_sticks_out(made):
    with browsing(made / "r.html", width=420, height=900, phone=True) as page_:
        page_.click_on("#everything")
        page_.settle()
        assert page_.evaluate("document.documentElement.scrollWidth") == 420
        assert page_.messages == []


def test_figures_are_written_as_files(made):
    names = {path.name for path in (made / "figures").iterdir()}
    keys = {name.partition(".")[0] for name in names}
    assert {"error-time-1-1", "figure-5-17", "precision-recall-1"} <= keys
    assert names == {f"{key}.{kind}" for key in keys for kind in ("svg", "png", "csv")}
    assert (made / "figures" / "figure-5-17.png").read_bytes().startswith(b"\x89PNG")
    svg = (made / "figures" / "figure-5-17.svg").read_text(encoding="utf-8")
    assert 'xmlns="http://www.w3.org/2000/svg"' in svg[:200]
    table = pd.read_csv(made / "figures" / "figure-5-17.csv")
    assert {"step", "time (ns)", "pairs reported", "truly meet"} == set(table.columns) and len(table) > 10
    with browsing(made / "figures" / "figure-5-17.svg") as page_:
        assert page_.messages == []


def test_figures_do_not_go_where_a_file_is(result_file, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["report", str(result_file), "-o", str(tmp_path / "r.html"), "--figures", str(tmp_path / "file")]) == 4
    assert capsys.readouterr().err == f"{tmp_path / 'file'}: exists and is no folder; --figures names one\n"


def test_without_vega_the_page_has_its_static_figures(result_file, tmp_path, monkeypatch):
    monkeypatch.setattr(vega, "FOLDER", tmp_path)
    assert vega.script() == ""
    (tmp_path / "r.html").write_text(report_module.report([load(result_file)]), encoding="utf-8")
    with browsing(tmp_path / "r.html") as page_:
        page_.click_on("#everything")
        assert page_.messages == []
        assert page_.evaluate("document.querySelector('#error-time-1-1 svg').getBoundingClientRect().width") > 300
        assert page_.evaluate("document.querySelector('#explorer-1').offsetHeight") == 0


# ---- looks


def test_no_two_labels_look_alike():
    labels = [(f"facet_triangles_{i}", "facet_triangles") for i in range(60)] + [("obb_sat", "obb_sat"), ("mine",
        "mine")]
    know(labels)
    looks = {label: style(algorithm, label) for label, algorithm in labels}
    assert len({(look["color"], look["marker"]) for look in looks.values()}) == len(labels)
    assert looks["obb_sat"] == style("obb_sat")
    assert looks["facet_triangles_0"]["color"] == style("facet_triangles")["color"]
    know([])
    assert style("facet_triangles", "facet_triangles_1") == style("facet_triangles")


# ---- knobs


def settings(*rows):
    """(knobs, error, ms) -> points as of pareto.Scene."""
    return pd.DataFrame([
        {"label": f"m{i}", "algorithm": "m", "knobs": knobs_, "error": error, "time_mean_ns": 1e6 * ms, "exact": False,
         "false_negative": 1, "false_positive": 1, "machine": "here", "scope": "pair", "promise": "none"}
        for i, (knobs_, error, ms) in enumerate(rows)
    ])


THREE = settings(({"stride": 20, "dense": False, "prefilter": "j"}, 0.9, 1), ({"stride": 10, "dense": False,
    "prefilter": "j"}, 0.8, 2),
                 ({"stride": 10, "dense": True, "prefilter": "j"}, 0.3, 9), ({"stride": 20, "dense": False,
                     "prefilter": "a"}, 0.7, 3))


def test_lines_join_settings_that_differ_in_one_knob_that_has_an_order():
    assert knobs.along(THREE) == [("stride", [1, 0]), ("dense", [1, 2])]  # a filter's name has none


def test_the_best_setting_is_named():
    exact = pd.DataFrame([{"label": "exact", "algorithm": "exact", "knobs": {}, "error": 0.0, "time_mean_ns": 1e5,
        "exact": True,
                           "false_negative": 0, "false_positive": 0, "machine": "here", "scope": "scene",
                               "promise": "exact"}])
    both = pd.concat([THREE, exact], ignore_index=True)
    scene = pareto.Scene("Made", [], both)
    figure = knobs.one(scene, "m", THREE, both, "k")
    assert figure.title == ("m: best is stride = 10, dense = true, prefilter = j: error 0.3 at 9 ms a step; exact "
                            "makes none at "
                            "100 µs")
    assert list(figure.table.label) == ["m2", "m3", "m1", "m0"]
    assert knobs.setting(THREE.knobs[2], knobs.usual(THREE)) in ("dense", "stride 10, dense")


def test_filters_and_methods_make_a_matrix():
    rows = settings(*[({"prefilter": name}, error, 1 + i) for i, (name, error) in enumerate((("a", 0.5), ("b", 0.2),
        ("none", 0.4)))])
    alone = settings(({}, 0.95, 0.1)).assign(label="a", algorithm="a")
    figure = knobs.matrix(pareto.Scene("Made", [], rows), pd.concat([rows, alone], ignore_index=True), "k")
    assert figure.title.startswith("Best pair: b before m, error 0.2 at 2000 µs")
    assert figure.table[["filter", "method"]].values.tolist() == [["b", "m"], ["none", "m"], ["a", "m"], ["a",
        "(filter alone)"]]


# ---- best of the nine


def test_the_best_of_the_nine_is_told_a_scene():
    table = pd.DataFrame({"error": [0.2, 0.5, 0.1], "time_mean_ns": [2e3, 1e3, 9e3], "false_negative": [3, 0, 0]},
                         index=["obb_corners", "bounding_sphere", "obb_sat"])
    (text,) = nine.told({"Made": table})
    assert text == ("Made: obb_sat errs least of the nine, 0.1 at 9 µs a step; of those that are faster obb_corners, "
                    "0.2 at 2 µs; "
                    "of those that miss nothing obb_sat, 0.1.")


# ---- scenes


def test_a_shortened_run_says_what_it_does_not_reach(result_file):
    run = load(result_file)
    config = '[scene]\nkind = "falling"\nradius = 1\n[[scene.set]]\nheight = 5\n[[scene.set]]\nheight = 75\n'
    for steps, said in ((200, True), (300, False)):
        object.__setattr__(run, "meta", run.meta | {"config_effective": config, "steps": steps, "rate": 60.0})
        assert bool(scenes.ends_early(run)) is said  # (75 - 2) m fall in 3.86 s, 232 steps
    box = '[scene]\nkind = "box"\n[scene.births]\ncount = 80\nfrom = 0\nevery = 5\n'
    for steps, said in ((395, True), (396, False)):
        object.__setattr__(run, "meta", run.meta | {"config_effective": box, "steps": steps})
        assert bool(scenes.ends_early(run)) is said


def test_other_bodies_than_spheres_are_no_scene_of_the_thesis(small_file):
    assert scenes.thesis_kind(load(small_file(ROOT / "configs" / "heap.toml"))) == ""
    assert scenes.thesis_kind(load(small_file(ROOT / "configs" / "padani.toml"))) == "falling"


def test_sections_name_their_view(made):
    data = re.search(r'data-points="([^"]+)"', (made / "r.html").read_text(encoding="utf-8"))[1]
    points = json.loads(data.replace("&#34;", '"').replace("&#39;", "'").replace("&amp;", "&"))["points"]
    assert all(point["colour"].startswith("#") and point["mark"] for point in points)
    assert {point["language"] for point in points} == {"C++"}


def test_the_recipe_of_the_readme_finds_the_pairs_by_hand(result):
    recipe = re.search(r"import h5py, numpy as "
                       r"np\n.*?(?=```)", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)[0]
    found = {}
    exec(recipe.replace("results/padani.h5", str(result)), found)
    truth = load(result).truth_pairs
    assert len(truth) and list(found["step"]) == list(truth.step)
    assert found["pair"].tolist() == truth[["a", "b"]].to_numpy().tolist()
