"""Which label should be taken: the least error for a time, the least time for an error; of one scene and of several.

Only labels that one machine and build timed are compared: in each scene those of the one that timed the most. Labels
are equals where no difference of their times can be told (pareto.alike). `pipeline show` says the same of one file
(pipeline/commands/choice.hpp).
"""

import itertools
import json
from dataclasses import dataclass

import numpy as np
import pandas as pd

from . import intervals, pareto
from .intervals import Interval

# What may be allowed, in words -> the most error, and whether pairs may be missed.
ALLOWED = {
    "error at most 0.1": (0.1, True),
    "error at most 0.01": (0.01, True),
    "no error": (0.0, True),
    "no false negative": (1.0, False),
}


def timed(points):
    """The rows of `points` (pareto.Scene) that compare, the fastest first."""
    known = points[points.time_mean_ns.notna() & points.error.notna() & (points.time_mean_ns > 0)]
    if known.empty:
        return known
    return known[known.machine == known.machine.mode().iloc[0]].sort_values("time_mean_ns", kind="stable")


def allowed(points, most_error, misses):
    keeps = points.error <= most_error
    return points[keeps if misses else keeps & (points.false_negative == 0)]


def front(points):
    """The labels that err least from their own mean time on: (row, labels that are as fast and err as much), the
    fastest first. One that errs less and is as fast makes those before it pointless."""
    points, worth = timed(points), []
    for _, row in points.iterrows():
        if worth and row.error >= worth[-1].error:
            continue
        while worth and pareto.alike(row, worth[-1]):
            worth.pop()
        worth.append(row)
    return [(row, equals(row, points[points.error == row.error])) for row in worth]


def equals(row, points):
    return [other.label for _, other in points.iterrows() if other.label != row.label and pareto.alike(other, row)]


def fastest(points, most_error=1.0, misses=True):
    """(row, labels that are as fast) of the fastest label that is allowed; None when there is none."""
    found = allowed(timed(points), most_error, misses)
    return None if found.empty else (found.iloc[0], equals(found.iloc[0], found))


# ---- Several scenes


@dataclass(frozen=True)
class Together:
    """Settings that answered in all of several scenes, and what they cost.

    frame: one row per setting (an algorithm and its knobs), the fastest first: label, worst_error and the scene where,
    false_negative over all scenes, time (its mean time over that of `reference`, the geometric mean over the scenes),
    low, high (of its 95 % interval), and slowest (the greatest of these ratios). rows: setting -> its rows of points,
    a scene each. titles: of the scenes.
    """

    titles: list
    reference: str
    frame: pd.DataFrame
    rows: dict


def together(scenes):
    """What the labels of several scenes come to; None when fewer than two settings answered in two or more."""
    tables = [_settings(timed(scene.points)) for scene in scenes]
    common = [key for key in tables[0] if all(key in table for table in tables)] if len(tables) > 1 else []
    if len(common) < 2:
        return None
    rows = {key: [table[key] for table in tables] for key in common}
    names = _names(common, rows)
    reference = next((key for key in common if key[0] == "exact"), common[0])
    lines = []
    for key in common:
        each = [pareto.compared(one, other) for one, other in zip(rows[key], rows[reference])]
        ratio = geometric(each)
        errors = [row.error for row in rows[key]]
        lines.append({
            "label": names[key], "worst_error": max(errors), "where": scenes[int(np.argmax(errors))].title,
            "false_negative": int(sum(row.false_negative for row in rows[key])), "time": ratio.value,
            "low": ratio.low, "high": ratio.high, "slowest": max(one.value for one in each), "setting": key,
        })
    frame = pd.DataFrame(lines).sort_values("time", kind="stable").reset_index(drop=True)
    return Together([scene.title for scene in scenes], names[reference], frame, rows)


def _settings(points):
    return {(row.algorithm, json.dumps(row.knobs, sort_keys=True)): row for _, row in points.iloc[::-1].iterrows()}


def _names(keys, rows):
    """The shortest label of each setting; one that several settings share gets its knobs."""
    names = {key: min((row.label for row in rows[key]), key=len) for key in keys}
    shared = pd.Series(names.values()).duplicated(keep=False)
    return {key: f"{name} {key[1]}" if again else name for (key, name), again in zip(names.items(), shared)}


def geometric(ratios):
    """The geometric mean of independent ratios, with its interval: deviations of logarithms add by squares."""
    value = float(np.exp(np.mean([np.log(ratio.value) for ratio in ratios])))
    if not all(ratio.known for ratio in ratios):
        return Interval(value)
    half = np.sqrt(sum(np.log(ratio.high / ratio.value) ** 2 for ratio in ratios)) / len(ratios)
    return Interval(value, float(value * np.exp(-half)), float(value * np.exp(half)))


def same_time(found, one, other, scenes=None):
    """Whether no difference of two settings' times can be told over the scenes (numbers; all)."""
    pairs = list(zip(found.rows[one], found.rows[other]))
    chosen = range(len(pairs)) if scenes is None else scenes
    return intervals.alike(geometric([pareto.compared(*pairs[scene]) for scene in chosen]))


def best(found, most_error=1.0, misses=True):
    """(row of found.frame, labels as fast, titles of scenes without which another one would be faster) of the fastest
    setting that is allowed in every scene; None when there is none."""
    keeps = found.frame[found.frame.worst_error <= most_error]
    keeps = keeps if misses else keeps[keeps.false_negative == 0]
    if keeps.empty:
        return None
    first, others = keeps.iloc[0], [row for _, row in keeps.iloc[1:].iterrows()]
    as_fast = [row.label for row in others if same_time(found, row.setting, first.setting)]
    return first, as_fast, _alone(found, keeps.setting, first.setting)


def _alone(found, keys, winner):
    """The scenes without any one of which another of `keys` is faster than the winner: it wins by them alone."""
    titles, count = [], len(found.titles)
    if count < 3:
        return titles
    for rest in itertools.combinations(range(count), count - 1):
        ratios = {key: geometric([pareto.compared(found.rows[key][s], found.rows[winner][s]) for s in rest])
                  for key in keys if key != winner}
        if any(ratio.value < 1 and not intervals.alike(ratio) for ratio in ratios.values()):
            titles += [found.titles[s] for s in range(count) if s not in rest]
    return titles


def front_together(found):
    """The rows of found.frame that no other beats in both worst error and time."""
    return found.frame[pareto.front(found.frame.time, found.frame.worst_error)]
