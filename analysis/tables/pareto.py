"""Which algorithms are worth their cost: the labels of results as points of cost and error, their fronts and lines."""

import json
import os
from dataclasses import dataclass

import numpy as np
import pandas as pd

from . import intervals
from .intervals import Interval


@dataclass(frozen=True)
class Scene:
    """Results that ask the same question: motion and truth are the same bit for bit, so errors compare.

    points: one row per label: label (unique), algorithm, file, knobs (dict), scope, promise, unit (of operations),
    exact and library (bool), asked (how, of a method of others), machine (host, processor and build as one text: times
    compare only within one), times (per step, ns; empty when the file has none), floor (an Interval
    or None: the noise floor of its file), error,
    hits, true_positive, ..., time_mean_ns, time_median_ns, time_p95_ns, operations (per step), promise_kept.
    """

    title: str
    runs: list
    points: pd.DataFrame


def scenes(runs):
    """`runs` put together by what they ask, in the order of the first of each; those without answers are left out."""
    groups = {}
    for run in runs:
        if len(run.summary) and len(run.summary.columns):
            question = run.meta["motion"].get("digest", run.path), run.meta["truth"].get("digest", run.path)
            groups.setdefault(question, []).append(run)
    return [Scene(" / ".join(dict.fromkeys(map(title, group))), group, _points(group)) for group in groups.values()]


def title(run):
    return run.meta.get("title") or name(run)


def name(run):
    """The file's name without its folder and ending."""
    return os.path.splitext(os.path.basename(run.path))[0]


def how_asked(answers):
    """" (program, Python)" of a method of others: its times are drawn beside those of others only where this is
    said."""
    how = [answers.get("transport", ""), answers.get("language", "").partition(" ")[0].rstrip(",")]
    return f" ({', '.join(filter(None, how))})" if how[0] else ""


def machine(answers):
    """Where and with what an algorithm was timed: "processor on host, commit build compiler"."""
    commit, _, rest = answers.get("build", "").partition(" ")
    commit, dirty, _ = commit.partition("-")
    place = f"{answers.get('processor', '?')} on {answers.get('host', '?')}"
    return f"{place}, {commit[:7]}{dirty and '-dirty'} {rest}".strip()


def asked(answers):
    """How a method of others was asked and what it is written in: "imported, Fortran"; "" of one of the program."""
    return ", ".join(filter(None, (answers.get("transport"), answers.get("language"))))


def _points(runs):
    """The table of Scene. What several files tell of one label is the same when its answers' digests and machines are:
    then it is kept once, of the first file; else the label gets its file's name."""
    rows, seen = [], set()
    for run in runs:
        for label, row in run.summary.iterrows():
            answers = run.meta["answers"][label]
            identity = label, answers.get("digest"), machine(answers)
            if identity in seen:
                continue
            seen.add(identity)
            rows.append(
                {
                    "label": label + how_asked(answers),
                    "algorithm": answers.get("name", label),
                    "file": name(run),
                    "knobs": json_object(answers.get("knobs", "{}")),
                    "scope": answers.get("scope", "pair"),
                    "promise": answers.get("promise", "none"),
                    "unit": answers.get("operations_unit", ""),
                    "exact": answers.get("promise") == "exact",
                    "library": bool(answers.get("library")),
                    "machine": machine(answers),
                    "asked": asked(answers),
                    "times": np.zeros(0) if label in run.unlike else run.step_times.get(label, np.zeros(0)),
                    "floor": run.noise,
                }
                | row.to_dict()
                | {"operations": row["operations"] / max(run.meta["steps"], 1)}
            )
    table = pd.DataFrame(rows)
    again = table.duplicated("label", keep=False)
    table.loc[again, "label"] = table.label[again] + " (" + table.file[again] + ")"
    again = table.duplicated("label", keep=False)  # the same file twice on different machines
    table.loc[again, "label"] = table.label[again] + " #" + (table[again].groupby("label").cumcount() + 1).astype(str)
    return table


def compared(one, other):
    """The mean time of the row `one` of points over that of `other`, from the same steps, with its interval."""
    if len(one["times"]) != len(other["times"]) or not len(one["times"]):
        return Interval(one["time_mean_ns"] / other["time_mean_ns"])
    return intervals.ratio(one["times"], other["times"])


def alike(one, other):
    """Whether the row `one` of points is as fast as `other`: no difference of their times can be told."""
    if one["machine"] != other["machine"]:
        return False
    return intervals.alike(compared(one, other), widest(one["floor"], other["floor"]))


def widest(*floors):
    known = [floor for floor in floors if floor is not None and floor.known]
    return max(known, key=lambda floor: floor.high / floor.low, default=None)


def front(cost, error):
    """True where no other point is at most as costly and at most as wrong, and better in one of the two.

    cost, error: N numbers each, without NaN.
    """
    cost, error = np.asarray(cost, float), np.asarray(error, float)
    no_worse = (cost[None, :] <= cost[:, None]) & (error[None, :] <= error[:, None])
    better = (cost[None, :] < cost[:, None]) | (error[None, :] < error[:, None])
    return ~(no_worse & better).any(axis=1)


def sweeps(points):
    """Lines through the labels of one algorithm that differ in one number: (algorithm, knob, rows in the knob's order).

    rows: positions in `points`. A knob with one value only gives no line, labels with equal knobs count once.
    """
    found = []
    for algorithm, group in points.reset_index(drop=True).groupby("algorithm", sort=False):
        for knob in dict.fromkeys(knob for knobs in group.knobs for knob in knobs):
            lines = {}
            for row, knobs in group.knobs.items():
                value = knobs.get(knob)
                if isinstance(value, (int, float)) and not isinstance(value, bool):
                    rest = json.dumps({key: other for key, other in knobs.items() if key != knob}, sort_keys=True)
                    lines.setdefault(rest, {}).setdefault(value, row)
            found += [(algorithm, knob, [line[v] for v in sorted(line)]) for line in lines.values() if len(line) > 1]
    return found


def json_object(text):
    """What JSON of a file says; an empty dict where it says nothing."""
    try:
        return dict(json.loads(text))
    except (TypeError, ValueError):
        return {}
