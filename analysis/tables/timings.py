"""Judges of the thesis's statements on times and counts: the box and the falling scene.

Of two times one is above the other when their ratio says so beyond its interval and the noise floor; where it does
not, they are as fast as each other and decide nothing. A ratio that shall be in a range is in it by its value;
outside of it decides only what is outside with its whole interval. Where times per step are not known, values alone
decide.
"""

import numpy as np

from ..words import listed
from . import intervals, thresholds as t
from .clauses import KEYS, NotTestable, clause, told, yes


def above(ratio, floor=None):
    """1 for a ratio above 1, -1 for one below, 0 where no difference can be told."""
    return 0 if intervals.alike(ratio, floor) else int(np.sign(ratio.value - 1))


def ordered(ratios, what):
    """Whether all of `ratios`, (name, Interval, noise floor or None), are above 1. Raises NotTestable when none is
    below but not all can be told."""
    signs = [above(ratio, floor) for _, ratio, floor in ratios]
    unsure = [(name, ratio) for (name, ratio, _), sign in zip(ratios, signs) if sign == 0 and ratio.known]
    if min(signs) >= 0 and unsure:
        name, ratio = unsure[0]
        raise NotTestable(f"{what}: {name} differ by a factor of {ratio.low:.3g} to {ratio.high:.3g}, no difference")
    return min(signs) > 0


def ranged(ratios):
    """Whether all of `ratios`, (name, Interval, low, high), are in their ranges. Raises NotTestable when none is wholly
    outside but not all are in."""
    outside = [(name, ratio, low, high) for name, ratio, low, high in ratios if not low <= ratio.value <= high]
    unsure = [(name, ratio) for name, ratio, low, high in outside if ratio.low <= high and low <= ratio.high]
    if unsure and len(unsure) == len(outside):
        name, ratio = unsure[0]
        raise NotTestable(f"{name} is {ratio.low:.3g} to {ratio.high:.3g}, which does not decide")
    return not outside


def mean_order(order):
    """The means are in the order of the labels, slowest last."""

    def judge(scene, *labels):
        mean = scene.summary.time_mean_ns[list(labels)].to_numpy()
        found = [order[i] for i in np.argsort(mean, kind="stable")]
        pairs = [(f"{b} / {a}", slower, below) for a, b, below, slower in zip(order, order[1:], labels, labels[1:])]
        ratios = [(name, scene.ratio(slower, below), scene.noise) for name, slower, below in pairs]
        ordered([(name.replace(" / ", " and "), *rest) for name, *rest in ratios], "as fast as each other")
        failed = [clause(name, ratio.value, ">", 1.0) for name, ratio, _ in ratios if not ratio.value > 1]
        return [
            yes("order", not failed, " < ".join(found), " < ".join(order)),
            *failed,
            told("misplaced", sum(a != b for a, b in zip(found, order))),
        ]

    return judge


def groups(box, falling, *labels):
    """Every mean of {G,H,J} below every one of {O,L}, those below {P,I,U}, those below K; in both scenes."""
    sizes = np.cumsum([0, 3, 2, 3, 1])
    letters = {label: key for key, label in KEYS.items()} | dict(zip(labels, "GHJOLPIUK"))
    ratios, found = [], []
    for name, scene in (("box", box), ("falling", falling)):
        mean = scene.summary.time_mean_ns[list(labels)]
        parts = [mean[a:b] for a, b in zip(sizes, sizes[1:])]
        for below, slower in zip(parts, parts[1:]):
            ends = slower.idxmin(), below.idxmax()
            ratios.append((f"{ends[1]} and {ends[0]}", scene.ratio(*ends), scene.noise))
            what = (
                f"{name}: fastest of {{{','.join(letters[x] for x in slower.index)}}}, {letters[ends[0]]}, / slowest "
                f"of "
            )
            what += f"{{{','.join(letters[x] for x in below.index)}}}, {letters[ends[1]]}"
            found.append(clause(what, float(slower.min() / below.max()), ">", 1.0))
    ordered(ratios, "as fast as each other")
    return found


def falling_above_box(box, falling, *labels):
    if not box.host or box.host != falling.host:
        raise NotTestable("the two scenes were timed on different machines")
    ratio = falling.summary.time_mean_ns[list(labels)] / box.summary.time_mean_ns[list(labels)]
    ratios = [(f"{label} in both", intervals.apart(falling.mean(label), box.mean(label)), None) for label in labels]
    ordered(ratios, "as fast in one scene as in the other")
    under = [label for label in labels if not ratio[label] > 1]
    return [
        clause(f"least ratio, {ratio.idxmin()}", float(ratio.min()), ">", 1.0, where=f"not so of "
        f"{listed(under)}" if under else ""),
        told(f"greatest ratio, {ratio.idxmax()}", float(ratio.max())),
    ]


def slowest_by_far(box, falling, slowest, *others):
    """K by the next slowest: 9 to 10 in the falling scene, 5 in the box scene, each within ABOUT."""
    ratios, found = [], []
    for name, scene, least, most in (("box", box, 5, 5), ("falling", falling, 9, 10)):
        next_ = scene.summary.time_mean_ns[list(others)].idxmax()
        ratio = scene.ratio(slowest, next_)
        limits = least * (1 - t.ABOUT), most * (1 + t.ABOUT)
        ratios.append((f"{name} ratio", ratio, *limits))
        found.append(clause(f"{name} ratio, to {next_}", ratio.value, "in", limits))
    ranged(ratios)
    return found


def alike_in_time(box, falling, one, other):
    """The slower at most 1 + WITHIN times the faster, in both scenes."""
    ratios = [
        (f"{name} ratio", scene.ratio(one, other), 1 / (1 + t.WITHIN), 1 + t.WITHIN)
        for name, scene in (("box", box), ("falling", falling))
    ]
    ranged(ratios)
    return [clause(name, max(ratio.value, 1 / ratio.value), "<=", 1 + t.WITHIN) for name, ratio, _, _ in ratios]


def apart_from_hits(falling, *labels):
    """Pearson's correlation of time and hits over the steps is below FOLLOWS. In the box scene both follow the
    bodies."""
    found = []
    for label in labels:
        rows = falling.per_step[falling.per_step.algorithm == label]
        r = float(rows.time_ns.corr(rows.hits.astype(float)))
        if np.isnan(r):
            raise NotTestable("times or hits do not vary")
        found.append(clause(f"r {label}", r, "<", t.FOLLOWS))
    return found


def grows_with_square(box, *labels):
    """The exponent of time against number of bodies, fitted to the logarithms of the medians, is in SQUARE."""
    found = []
    for label in labels:
        rows = box.per_step[box.per_step.algorithm == label]
        median = rows.time_ns.groupby(box.bodies[rows.step.to_numpy()]).median()
        median = median[median.index >= t.SQUARE_FROM]
        if len(median) < 3 or median.index.max() < 2 * median.index.min():
            raise NotTestable("the number of bodies does not double")
        exponent = float(np.polyfit(np.log(median.index), np.log(median), 1)[0])
        found.append(clause(f"exponent {label}", exponent, "in", t.SQUARE))
    return found


def reports_most(box, falling, most, *others):
    """More hits than any other, over all steps, in both scenes."""
    found = []
    for name, scene in (("box", box), ("falling", falling)):
        hits = scene.summary.hits.astype(float)
        next_ = hits[list(others)].idxmax()
        found.append(clause(f"{name}: hits of {most}", hits[most], ">", hits[next_], where=f"{next_} reports more"))
    return found


def reports_fewest(falling, fewest, *others):
    """Fewer hits than any other, over all steps."""
    hits = falling.summary.hits.astype(float)
    next_ = hits[list(others)].idxmin()
    return [clause(f"hits of {fewest}", hits[fewest], "<", hits[next_], where=f"{next_} reports fewer")]


def curves_coincide(scene, one, other):
    """The mean distance of the curves of hits is at most COINCIDE of their mean height."""
    hits = [scene.per_step.hits[scene.per_step.algorithm == label].to_numpy(dtype=float) for label in (one, other)]
    if not np.sum(hits):
        raise NotTestable("neither reports anything")
    distance = float(np.abs(hits[0] - hits[1]).mean() / np.mean(hits))
    return [
        clause("mean distance of the curves / mean height", distance, "<=", t.COINCIDE),
        told(f"hits {one}", hits[0].sum()), told(f"hits {other}", hits[1].sum()),
    ]
