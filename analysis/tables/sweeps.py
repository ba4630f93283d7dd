"""What the points of a sweep say together: the frame of load_sweep -> spreads over seeds, curves over parameters, and
which findings hold at every point."""

import itertools
import os
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pandas as pd

from ..load import load
from . import intervals, pareto, scenes
from .statements import verdicts
from ..words import listed, verb

OF_STATEMENTS = ("box", "falling", "playground")


@dataclass(frozen=True)
class Fact:
    """What is so at some points. text: a sentence without its end; held, of: at how many of how many points."""

    kind: str
    text: str
    held: int
    of: int


def points(table):
    """One row per point: its parameters, status, reason and whatever else does not depend on a label."""
    return table.drop_duplicates("point").reset_index(drop=True)


def answers(table):
    """The rows of points that are done and have an answer: a label, an error and a time. A run that failed half-way
    answers other steps than the others."""
    if not {"error", "time_mean_ns"} <= set(table.columns):
        return table.iloc[:0].assign(error=np.nan, time_mean_ns=np.nan)
    return table[(table.status == "done") & (table.label != "") & table.error.notna()].reset_index(drop=True)


def axes(table):
    """The parameters over which curves are drawn: what takes several values, but seeds and the configuration."""
    return [name for name in table.attrs["parameters"] if name not in ("seed", "config") and table[name].nunique() > 1]


def settings(table, without=()):
    """[(text, rows)]: the rows by all parameters but the seed and those of `without`, in the order of the sweep; the
    text is "" where there is only one."""
    names = [
        name
        for name in table.attrs["parameters"]
        if name != "seed" and name not in without and table[name].nunique() > 1
    ]
    if not names:
        return [("", table)]
    found = []
    for values, rows in table.groupby(names if len(names) > 1 else names[0], sort=False):
        rows.attrs, values = table.attrs, values if len(names) > 1 else [values]
        found.append(
            (
                ", ".join(
                    f"{name} {text(value)}" if name != "config" else str(value) for name, value in zip(names, values)
                ),
                rows,
            )
        )
    return found


def text(value):
    if isinstance(value, (float, np.floating)):
        return f"{value:g}".replace("e+0", "e").replace("e+", "e").replace("e-0", "e-")
    return str(value)


def machine(rows):
    """Per row, what its times depend on: processor and build. Nodes of one kind are one."""
    return rows.processor + ", " + rows.build.str.replace(r"^(\w{7})\w*", r"\1", regex=True)


def side_by_side(table):
    """host -> how many of its points ran while another did, of hosts where any did: their times disturb each other."""
    found = {}
    for host, rows in points(table).dropna(subset=["began", "wall_time_s"]).groupby("host", sort=False):
        start, end = rows.began.to_numpy(), (rows.began + rows.wall_time_s).to_numpy()
        overlap = (start[:, None] < end) & (start < end[:, None])
        if count := int((overlap.sum(axis=1) > 1).sum()):
            found[host] = count
    return found


def spread(rows, column, by):
    """Per combination of `by`: mean, sd (of a draw; NaN of one), least, most, count of `column`, in the rows' order."""
    found = rows.groupby(by, sort=False)[column].agg(["mean", "std", "min", "max", "count"])
    return found.rename(columns={"std": "sd", "min": "least", "max": "most"}).reset_index()


# ---- What holds at every point


def facts(table):
    """The Facts of the points that have answers, those that hold everywhere first, in a fixed order."""
    found = {}
    rows = answers(table)
    by_point = [part for _, part in rows.groupby("point", sort=False)]
    for part in by_point:
        for kind, text_ in told(part):
            found[kind, text_] = found.get((kind, text_), 0) + 1
    every = [Fact(kind, text_, held, len(by_point)) for (kind, text_), held in found.items()]
    kinds = ["error", "time", "front", "right", "misses", "promise"]
    return sorted(every, key=lambda fact: (fact.held < fact.of, kinds.index(fact.kind), -fact.held, fact.text))


def told(rows):
    """What one point says: (kind, sentence without its end)."""
    least, quickest = rows.error.min(), rows.time_mean_ns.min()
    best = list(rows.label[rows.error == least])
    found = [("error", f"{listed(best)} {verb(best, 'errs', 'err')} least")]
    found += [("time", f"{label} is the quickest") for label in rows.label[rows.time_mean_ns == quickest]]
    front = pareto.front(rows.time_mean_ns.fillna(np.inf), rows.error)
    found += [("front", f"{label} is on the front of error against time") for label in rows.label[front]]
    found += [("right", f"{label} makes no error") for label in rows.label[rows.error == 0]]
    found += [
        ("misses", f"{label} misses no pair") for label in rows.label[(rows.false_negative == 0) & (rows.error > 0)]
    ]
    if "promise_kept" in rows and (rows.promise_kept == 1).all():
        found.append(("promise", "every promise is kept"))
    return found


def order(table, column):
    """Label by label: at how many points the row's `column` is below the column's, and of how many points that have
    both. Two frames of counts. Of times it is below where that can be told: by the interval of their ratio over the
    same steps, where the point's file has one, else by their means."""
    wide = answers(table).pivot_table(index="point", columns="label", values=column, sort=False)
    labels = list(wide.columns)
    below, both = pd.DataFrame(0, labels, labels), pd.DataFrame(0, labels, labels)
    for point, row in wide.iterrows():
        times, floor = _times(table.attrs.get("folder"), point) if column == "time_mean_ns" else ({}, None)
        for a, b in itertools.combinations([label for label in labels if not np.isnan(row[label])], 2):
            both.loc[a, b] += 1
            both.loc[b, a] += 1
            if a in times and b in times and intervals.alike(intervals.ratio(times[a], times[b]), floor):
                continue
            below.loc[a, b] += int(row[a] < row[b])
            below.loc[b, a] += int(row[b] < row[a])
    return below, both


@lru_cache(maxsize=4096)
def _times(folder, point):
    """label -> time per step of a point's result, and its noise floor; nothing where it cannot be read."""
    try:
        run = load(os.path.join(folder, "points", point + ".h5"))
    except (OSError, KeyError, ValueError, RuntimeError, TypeError):
        return {}, None
    return {label: times for label, times in run.step_times.items() if label not in run.unlike}, run.noise


def undecided(table, column):
    """The pairs of labels whose order changes from point to point: [(a, b, a below b, b below a, of)], the more often
    below first; and how many pairs there are."""
    below, both = order(table, column)
    pairs = list(itertools.combinations(below.index, 2))
    found = []
    for a, b in pairs:
        one, other = int(below.loc[a, b]), int(below.loc[b, a])
        if one and other:
            found.append(
                (a, b, one, other, int(both.loc[a, b])) if one >= other else (b, a, other, one, int(both.loc[a, b]))
            )
    return found, len(pairs)


def untold(table, column):
    """How many pairs of labels have an order that is not told at every point, and is nowhere the other way round."""
    below, both = order(table, column)
    return sum(
        min(below.loc[a, b], below.loc[b, a]) == 0 and max(below.loc[a, b], below.loc[b, a]) < max(1, both.loc[a, b])
        for a, b in itertools.combinations(below.index, 2)
    )


def statements(table):
    """The thesis's statements at every point: one row per statement and variant that some point can judge; confirmed,
    refuted: at how many points; where it is not the same everywhere, the points that refute it. Points that differ by
    their configuration alone, a cube and a falling scene, are judged together. Second: what could not be read."""
    rows, lost = {}, []
    done = points(table)[lambda t: t.status == "done"]
    names = [name for name in table.attrs["parameters"] if name != "config"]
    groups = (
        [group for _, group in done.groupby(names if len(names) > 1 else names[0], sort=False)] if names else [done]
    )
    for group in groups:
        found = {}
        for name in group.point:
            try:
                run = load(os.path.join(table.attrs["folder"], "points", name + ".h5"))
                kind = scenes.thesis_kind(run)
                if kind in OF_STATEMENTS and kind not in found:
                    found[kind] = scenes.playground(run) if kind == "playground" else scenes.timed(run)
            except (OSError, KeyError, ValueError, RuntimeError) as error:
                lost.append(f"{name}: {' '.join(str(error).split())}")
        for verdict in verdicts(found) if found else []:
            row = rows.setdefault(
                (verdict.number, verdict.variant),
                {"statement": verdict.text, "confirmed": 0, "refuted": 0, "refuted at": []},
            )
            if verdict.verdict in ("confirmed", "refuted"):
                row[verdict.verdict] += 1
                row["refuted at"] += list(group.point[:1]) * (verdict.verdict == "refuted")
    kept = {key: row for key, row in rows.items() if row["confirmed"] + row["refuted"]}
    table = pd.DataFrame(
        [
            {"no.": f"{number} {variant}".strip(), "statement": row["statement"], "confirmed": row["confirmed"],
             "refuted": row["refuted"],
             "refuted at": "; ".join(row["refuted at"]) if row["confirmed"] else "everywhere"}
            for (number, variant), row in kept.items()
        ],
        columns=["no.", "statement", "confirmed", "refuted", "refuted at"],
    )
    return table, lost
