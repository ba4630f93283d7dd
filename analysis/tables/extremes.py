"""The extremes of the answers: where algorithms err, fail or contradict themselves, by gap, offset, scale and shape.

Functions from a Run of a scene of extremes to tables. Cases near touching, whose truth changes within 1000 ulps, are
rows of their own: methods that round elsewhere are not charged with our convention. Cases in which an algorithm failed
(it refused the bodies, or threw) are counted and are no part of its error.
"""

import numpy as np
import pandas as pd

KEY = ["algorithm", "near_touching"]


def error_by_gap(run):
    """Error by class of gap, from deep inside each other to far apart.

    Rows: algorithm, near_touching (bool), gap_class; classes of ulps first by value among the parts of the scale, as
    their median gap in scales orders them. Columns: gap (that median, in scales: negative beyond touching), cases,
    failed, true_positive, false_positive, false_negative, error and wrong, the share of wrong answers (both NaN where
    all failed; where nothing meets, one false positive makes an error of 1, so look at `wrong` there).
    """
    cases = answered(run)
    order = cases.assign(gap=cases["gap"] / cases["scale"]).groupby("gap_class", observed=True)["gap"].median()
    table = counted(cases, "gap_class").reset_index()
    table.insert(3, "gap", table["gap_class"].map(order).astype(float))
    algorithms = list(run.meta["algorithms"])
    table["algorithm"] = pd.Categorical(table["algorithm"], algorithms, ordered=True)
    return table.sort_values([*KEY, "gap"]).set_index([*KEY, "gap_class"])


def error_by_offset(run, like=False):
    """Error by offset (m). Rows: algorithm, near_touching, offset. Columns as error_by_gap, without gap.

    like: whether only of alike() cases; of all of them, great offsets have great scales, and do not compare.
    """
    return counted(alike(answered(run), "offset") if like else answered(run), "offset")


def error_by_scale(run, like=False):
    """Error by scale (m). Rows: algorithm, near_touching, scale. Columns and `like` as error_by_offset."""
    return counted(alike(answered(run), "scale") if like else answered(run), "scale")


def error_by_shape(run):
    """Error by pair of shapes. Rows: algorithm, near_touching, pair. Columns as error_by_gap, without gap."""
    return counted(answered(run), "pair")


def instability(run):
    """Answers that should not change and do.

    Rows: algorithm, near_touching. Columns: cases (those that did not fail), swapped (the answer changes with the order
    of the pair), moved (it changes when both bodies are moved by an exactly representable step, although the truth does
    not), truth_moved (the truth itself changes so: rounding of the world vertices), failed, failure (what the algorithm
    said first; empty: it never failed).
    """
    cases = answered(run)
    well = ~cases["failed"]
    table = pd.DataFrame({
        "cases": well,
        "swapped": well & (cases["swapped"] != cases["reported"]),
        "moved": well & (cases["moved"] != cases["reported"]) & (cases["truth_moved"] == cases["truth"]),
        "truth_moved": well & (cases["truth_moved"] != cases["truth"]),
        "failed": cases["failed"],
    })
    table = table.groupby([cases[key] for key in KEY], observed=True, sort=False).sum().sort_index()
    reason = dict(zip(run.meta["algorithms"], run.failures))
    return table.assign(failure=[reason[label] for label in table.index.get_level_values("algorithm")])


def alike(cases, key):
    """Those of `cases` whose pair, class of gap, offset and scale, as far as they are not `key`, are there at every
    value of `key`: what differs between its values is then its doing. None where nothing is there at all of them."""
    others = [name for name in ("pair", "gap_class", "offset", "scale", "near_touching") if name != key]
    return cases[cases.groupby(others, observed=True)[key].transform("nunique") == cases[key].nunique()]


def answered(run):
    """One row per case and algorithm. Raises ValueError when the run is not of a scene of extremes."""
    table = run.extremes
    if table is None:
        raise ValueError(f"{run.path}: is not of a scene of extremes (it has no group /extremes)")
    return table


def counted(cases, key):
    """Cases, failures, right and wrong answers and the error, by algorithm, near_touching and `key`."""
    well = ~cases["failed"]
    hit, meets = well & cases["reported"], cases["truth"]
    table = pd.DataFrame({
        "cases": np.ones(len(cases), np.int64),
        "failed": cases["failed"],
        "true_positive": hit & meets,
        "false_positive": hit & ~meets,
        "false_negative": well & ~hit & meets,
    })
    table = table.groupby([cases[name] for name in [*KEY, key]], observed=True).sum()
    wrong = table["false_positive"] + table["false_negative"]
    error = (wrong / (wrong + table["true_positive"])).where(wrong > 0, 0.0)
    well = table["cases"] - table["failed"]
    return table.assign(error=error.where(well > 0), wrong=wrong / well.where(well > 0))
