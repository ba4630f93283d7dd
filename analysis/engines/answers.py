"""Engines and other people's libraries: what each takes bodies for, how it errs, by how many metres, and what it costs.

Functions from a Run to tables. A method is somebody else's when its file says so: it names a library, or how it was
asked. In a scene of extremes the place where each begins to err, near the origin and far from it.
"""

import numpy as np
import pandas as pd

from ..tables import extremes, pareto

NOT_SAID = "not said"
# Of a scene of extremes the pairs of shapes that every engine is made for: convex, with a volume, none in another.
PLAIN = ("box-box", "sphere-box", "sphere-sphere", "box-capsule", "sphere-capsule", "capsule-capsule")
# Of libraries that answer in the program's own process a file has the version alone.
IN_PROCESS = {"fcl_bvh": ("surfaces of the meshes", "C++", "double", "BSD-3-Clause")}


def is_engine(answers):
    return bool(answers.get("transport") or answers.get("library"))


def engines(run):
    """The labels of somebody else's methods, in the file's order."""
    return [label for label in run.meta["algorithms"] if is_engine(run.meta["answers"][label])]


def about(run, label):
    """What a file tells of a method of others: name, version, what it tests, language, arithmetic (the
    precision in which it decides), licence, how it was asked, knobs."""
    told = run.meta["answers"][label]
    tests, language, arithmetic, licence = IN_PROCESS.get(told.get("name", label), ("",) * 4)
    library, _, version = told.get("library", "").rpartition(" ")
    return {
        "algorithm": told.get("name", label),
        "library": library or told.get("name", label),
        "version": told.get("version") or version,
        "tests": told.get("tests") or tests or NOT_SAID,
        "language": told.get("language") or language,
        "arithmetic": told.get("precision") or arithmetic,
        "licence": told.get("licence") or licence,
        "asked": told.get("transport") or "in process",
        "knobs": pareto.json_object(told.get("knobs", "{}")),
    }


def answers(run):
    """One row per method of others that answered to the end, indexed by label.

    Columns: those of about(); error, false_positive, false_negative, contained_hit (where recorded); gap (m): the
    greatest distance of a pair that it reports falsely, as far as distances are recorded (NaN: none), and beyond: how
    many such pairs are farther apart than that; time_mean_ns, time_mean_low_ns, time_mean_high_ns, setup_ns,
    memory_bytes; and what pareto.compared() needs: times, machine, floor.
    """
    rows = {}
    for label in engines(run):
        told = run.summary.loc[label].to_dict()
        rows[label] = about(run, label) | told | dict(zip(("gap", "beyond"), furthest(run, label))) | {
            "times": run.step_times.get(label, np.zeros(0)),
            "machine": pareto.machine(run.meta["answers"][label]),
            "floor": run.noise,
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("label")


def furthest(run, label):
    """(the greatest distance of a false positive in m, how many are farther apart than distances are recorded).

    (NaN, NaN) when the file has no distances; (NaN, 0) without false positives.
    """
    if run.gaps is None:
        return np.nan, np.nan
    said = run.per_pair(label)
    false = said.loc[said["verdict"] == "false_positive", ["step", "a", "b"]]
    known = false.merge(run.gaps, on=["step", "a", "b"])
    return (float(known["upper"].max()) if len(known) else np.nan), len(false) - len(known)


def without_error(table):
    """The labels of answers() that were never wrong, the fastest first."""
    right = table[(table["false_positive"] == 0) & (table["false_negative"] == 0)]
    return list(right.sort_values("time_mean_ns").index)


def margins(table):
    """Pairs of labels of one method that differ in its margin alone: (label of the smaller, of the greater)."""
    found = []
    for _, mine in table.groupby("algorithm", sort=False):
        rows = [(label, dict(knobs)) for label, knobs in mine["knobs"].items() if "margin" in knobs]
        rows.sort(key=lambda row: row[1]["margin"])
        for (one, knobs), (other, more) in zip(rows, rows[1:]):
            if knobs["margin"] < more["margin"] and knobs | {"margin": 0} == more | {"margin": 0}:
                found.append((one, other))
    return found


def begins(run):
    """Where each method of others begins to err in a scene of extremes, by offset: rows (label, offset in m).

    Of bodies of about a metre (the scale that is there nearest to it). Columns: cases and failed; misses (m): the
    greatest depth of a pair of PLAIN shapes that meets and is not reported; reports (m): the greatest gap of one that
    is reported and does not meet; other_misses and other_reports: the same of all other pairs of shapes. 0 where it
    never errs so, NaN where it failed in all cases. A body wholly inside another, or beyond it, is no part: there no
    surfaces meet, and what to say is a matter of taste.
    """
    cases = extremes.answered(run)
    scales = cases["scale"].unique()
    cases = cases[cases["scale"] == scales[np.argmin(np.abs(np.log10(scales)))]]
    rows = {}
    for label in engines(run):
        mine = cases[cases["algorithm"] == label]
        for offset, some in mine.groupby("offset"):
            well = some[~some["failed"]]
            plain = well["pair"].isin(PLAIN)
            rows[label, offset] = {"cases": len(some), "failed": int(some["failed"].sum())}
            for start, kind in (("", well[plain]), ("other_", well[~plain])):
                missed = kind.loc[kind["truth"] & ~kind["reported"] & (kind["gap"] <= 0), "gap"]
                false = kind.loc[~kind["truth"] & kind["reported"] & (kind["gap"] > 0), "gap"]
                rows[label, offset] |= {
                    f"{start}misses": abs(missed.min()) if len(missed) else 0.0 if len(kind) else np.nan,
                    f"{start}reports": false.max() if len(false) else 0.0 if len(kind) else np.nan,
                }
    table = pd.DataFrame.from_dict(rows, orient="index")
    table.index = pd.MultiIndex.from_tuples(table.index, names=["label", "offset"])
    return table
