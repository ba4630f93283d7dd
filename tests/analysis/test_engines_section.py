"""The section "Engines": what it says of results made up here, by hand, and of a small result of the program."""

import json
from types import SimpleNamespace

import numpy as np
import pandas as pd
from conftest import ROOT
from program import DONE, PIPELINE, pipeline

from analysis.engines import answers as engines
from analysis.engines import section
from analysis.load import load

STEPS = 400


def made(rows, gaps=None, margin=0.1, contained=False):
    """A result: label -> dict of false_positive [(step, a, b)], false_negative (a count), time (ns), and what the file
    tells of it; `gaps`: (step, a, b) -> m."""
    random = np.random.default_rng(5)
    noise = 1 + 0.01 * random.standard_normal(STEPS)
    answers, summary, times, pairs = {}, {}, {}, {}
    for label, row in rows.items():
        told = {"name": label, "knobs": "{}", "host": "h", "processor": "p", "build": "b"} | row.get("told", {})
        answers[label] = told
        false = row.get("false_positive", [])
        rows_of_pairs = [(*pair, "false_positive") for pair in false]
        pairs[label] = pd.DataFrame(rows_of_pairs, columns=["step", "a", "b", "verdict"])
        summary[label] = {"false_positive": len(false), "false_negative": row.get("false_negative", 0), "error": 0.0,
                          "time_mean_ns": float(row["time"]), "time_mean_low_ns": 0.9 * row["time"],
                          "time_mean_high_ns": 1.1 * row["time"], "setup_ns": 1e6, "memory_bytes": 2048.0}
        if contained:
            summary[label]["contained_hit"] = row.get("contained_hit", 0)
        times[label] = row["time"] * noise
    table = None
    if gaps is not None:
        table = pd.DataFrame([(*pair, gap, gap) for pair, gap in gaps.items()],
                             columns=["step", "a", "b", "lower", "upper"])
        table.attrs["margin"] = margin
    return SimpleNamespace(
        path="x.h5", meta={"algorithms": list(rows), "answers": answers, "steps": STEPS, "title": "Made"},
        summary=pd.DataFrame.from_dict(summary, orient="index"), step_times=times, noise=None, gaps=table,
        per_pair=lambda label: pairs[label], extremes=None)


ASKED = {"transport": "library", "language": "C++", "tests": "surfaces of the meshes", "precision": "double"}
RUN = made({
    "exact": {"time": 100, "told": {"promise": "exact"}},
    "aabb": {"time": 1},
    "slow": {"time": 4000, "told": ASKED | {"library": "Slow 1.2"}},
    "quick": {"time": 1000, "told": ASKED | {"version": "3"}},
    "also": {"time": 1000, "told": ASKED},
    "box": {"time": 10, "told": ASKED | {"tests": "boxes", "language": "JavaScript (node)"}, "contained_hit": 4,
            "false_positive": [(0, 0, 1), (1, 0, 2), (2, 0, 2)]},
    "near": {"time": 2000, "told": ASKED | {"name": "slow", "knobs": '{"margin": 0.01}'},
             "false_positive": [(0, 0, 1)]},
    "near0": {"time": 2000, "told": ASKED | {"name": "slow", "knobs": '{"margin": 0.0}'}, "false_negative": 7},
}, gaps={(0, 0, 1): 0.015, (1, 0, 2): 0.05, (5, 1, 2): 0.09}, contained=True)


def test_engines_are_the_methods_of_others():
    assert engines.engines(RUN) == ["slow", "quick", "also", "box", "near", "near0"]
    assert engines.about(RUN, "quick")["version"] == "3" and engines.about(RUN, "slow")["library"] == "Slow"


def test_without_an_error_the_fastest_first():
    assert engines.without_error(engines.answers(RUN)) == ["quick", "also", "slow"]


def test_how_far_false_positives_are():
    assert engines.furthest(RUN, "box") == (0.05, 1)  # one of the three is farther than the margin
    assert engines.furthest(RUN, "near") == (0.015, 0)
    assert np.isnan(engines.furthest(RUN, "quick")[0]) and engines.furthest(RUN, "quick")[1] == 0
    assert np.isnan(engines.furthest(made({"box": {"time": 1, "told": ASKED}}), "box")).all()


def test_labels_that_differ_in_their_margin():
    assert engines.margins(engines.answers(RUN)) == [("near0", "near")]


def test_sentences_are_those_of_the_data():
    text = " ".join(section.points(RUN, "x").items)
    for sentence in (
        "6 labels of other people's engines answer: 5 by surfaces of the meshes; 1 by boxes.",
        "Never wrong are quick, also and slow.",
        "The fastest without an error is quick: 1 µs (900 ns to 1.1 µs) a step; also is as fast; slow takes 4 times",
        "This project's exact takes 100 ns (90 ns to 110 ns); quick takes 10 times",
        "reported by near (1, at most 0.015 m apart); box (3, 1 of them farther apart than 0.1 m).",
        "missed by near0 (7).",
        "Bodies wholly inside others are reported most by box, 4 times, and never by slow, quick, also, near and "
        "near0.",
        "slow with a margin of 0 m has 0 false positives and 7 misses; with 0.01 m 1 and 0.",
        "right or wrong: quick in C++ (1 µs) and box in JavaScript (10 ns).",
    ):
        assert sentence in text, (sentence, text)


def test_none_without_an_error_and_too_few():
    run = made({label: {"time": 1, "told": ASKED, "false_negative": count} for label, count in (("a", 3), ("b", 5))})
    assert section.right(engines.answers(run)) == "None is without an error; a errs least, in 3 pairs."
    assert section.fastest(run, engines.answers(run)) == []
    assert section.sections([made({"a": {"time": 1, "told": ASKED}})]) == []


def test_the_section_has_sentences_a_picture_and_a_table():
    (part,) = section.sections([RUN])
    points, picture, table = part.parts
    assert picture.title == "quick is the fastest of 3 engines without an error"
    assert list(table.frame["farthest (m)"]) == ["–", "–", "–", "> 0.1", "0.015", "–"]
    assert list(table.frame["precision"]) == ["double"] * 6


def extreme(cases):
    """(label, offset, gap, truth, reported, failed) -> a result of extremes of a metre, and of 1 km beside it."""
    table = pd.DataFrame(cases, columns=["algorithm", "offset", "gap", "truth", "reported", "failed"])
    table["pair"] = "box-box"
    wide = table.assign(pair="torus-torus", gap=50.0, truth=False, reported=True, failed=False)  # told apart
    table = pd.concat([table, wide], ignore_index=True)
    table = pd.concat([table.assign(scale=1.0), table.assign(scale=1e3, reported=~table["truth"])])
    told = {label: ASKED | {"name": label} for label in table["algorithm"].unique()}
    return SimpleNamespace(path="e.h5", extremes=table, meta={"algorithms": list(told), "answers": told, "title": "E"})


def test_where_engines_begin_to_err():
    run = extreme([
        ("a", 0.0, -1e-5, True, False, False), ("a", 0.0, -1e-7, True, False, False),
        ("a", 0.0, -1e-3, True, True, False),
        ("a", 0.0, -2.0, False, True, False),  # wholly inside
        ("a", 1e6, 0.1, False, True, False), ("a", 1e6, 0.5, False, False, False),
        ("b", 0.0, 0.0, True, True, False), ("b", 1e6, 0.0, True, False, True),
        ("c", 0.0, 0.0, True, True, False), ("c", 1e6, 1e-9, False, False, False),
    ])
    found = engines.begins(run)
    assert found.loc[("a", 0.0), "misses"] == 1e-5 and found.loc[("a", 0.0), "reports"] == 0
    assert found.loc[("a", 1e6), "misses"] == 0 and found.loc[("a", 1e6), "reports"] == 0.1
    assert np.isnan(found.loc[("b", 1e6), "misses"]) and found.loc[("b", 1e6), "failed"] == 1
    assert (found.loc[["a", "c"], "other_reports"] == 50).all() and (found.loc["c", "other_misses"] == 0).all()
    text = section.extremes_points(run, "x").items
    assert text == [
        "On boxes, spheres and capsules right at every gap and offset: c.",
        "At least ten times as wrong 1e+06 m from it in each coordinate as at the origin: a (1e-05 m near, 0.1 m far).",
        "Failed in all cases 1e+06 m from it in each coordinate: b.",
    ]


def test_of_a_result_of_the_program(tmp_path):
    """Two labels of a plug-in on recorded spheres; counts are those of its own summary, distances those of /truth."""
    library = PIPELINE.rsplit("/", 1)[0] + "/plugins/libbounding_spheres_c.so"
    config = (ROOT / "tests/baselines/falling.toml").read_text().split("\n[timing]")[0]
    config = config.replace("../data", str(ROOT / "tests" / "data"))
    rows = "".join(f'[[algorithm]]\nname = "bounding_spheres_c"\nlabel = "s{i}"\nscale = {i}\n' for i in (1, 2))
    (tmp_path / "c.toml").write_text(f"{config}\n[truth]\ngap = true\n[timing]\nrepeats = 1\n[[plugin]]\n"
                                     f"path = {json.dumps(library)}\n{rows}")
    done = pipeline("run", tmp_path / "c.toml", "-o", tmp_path / "c.h5", "--quiet")
    assert done.returncode == DONE, done.stderr
    run = load(tmp_path / "c.h5")
    table = engines.answers(run)
    assert list(table.index) == ["s1", "s2"] and (table["asked"] == "library").all()
    false = run.per_pair("s1").query("verdict == 'false_positive'")
    assert table["beyond"]["s1"] == len(false) - len(false.merge(run.gaps, on=["step", "a", "b"])) > 0
    assert 0 < table["gap"]["s1"] <= 0.1 + 1e-9
    (part,) = section.sections([run])
    assert part.parts[0].items[1].startswith("None is without an error; s1 errs least, in ")
