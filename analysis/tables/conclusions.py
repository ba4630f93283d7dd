"""The thesis's conclusions, statements (30) on: section 5.4 and chapter 6, judged as the others are.

What words mean is in thresholds.py. "Accurate" is the error of all answers of a scene; where the thesis judged accuracy
in general, all three scenes decide, where it tells of the playground that alone.
"""

import numpy as np

from . import thresholds as t
from .clauses import NotTestable, clause, told

BOTH = ("box", "falling")
PLAY = ("playground",)
ALL = ("box", "falling", "playground")
ENGINE = ("cannon_naive", "cannon_sap")


def errors(scene, labels):
    """label -> error over the whole scene."""
    known = scene.error
    if known is None:
        raise NotTestable("a file tells no errors")
    found = known[list(labels)].astype(float)
    if found.isna().any():
        raise NotTestable("a file tells no errors of some of them")
    return found


def means(scene, labels):
    return scene.summary.time_mean_ns[list(labels)].astype(float)


def faster(scene, one, others, what=""):
    """The clause: the mean time of `one` is below that of each of `others`. Raises NotTestable where the nearest of
    them
    cannot be told apart from it."""
    nearest = means(scene, others).idxmin()
    ratio = scene.ratio(nearest, one)
    if ratio.known and ratio.low <= 1 <= ratio.high:
        raise NotTestable(f"{one} and {nearest} differ by a factor of {ratio.low:.3g} to {ratio.high:.3g}, no "
                          f"difference")
    return clause(f"{what}{nearest} / {one}, mean times", ratio.value, ">", 1.0, where=f"{nearest} is faster")


def least_error(scene, one, others, what=""):
    error = errors(scene, [one, *others])
    next_ = error[list(others)].idxmin()
    return clause(f"{what}error of {one}", error[one], "<=", error[next_], where=f"{next_} errs less")


def most_error(scene, one, others, what=""):
    error = errors(scene, [one, *others])
    next_ = error[list(others)].idxmax()
    return clause(f"{what}error of {one}", error[one], ">=", error[next_], where=f"{next_} errs more")


def in_all(judge):
    """A clause of each scene: judge(scene, *labels, what)."""
    return lambda box, falling, play, *labels: [
        judge(scene, labels[0], labels[1:], f"{name}: ")
        for name, scene in (("box", box), ("falling", falling), ("playground", play))
    ]


def in_both(judge):
    return lambda box, falling, *labels: [
        judge(scene, labels[0], labels[1:], f"{name}: ") for name, scene in (("box", box), ("falling", falling))
    ]


def accurate(play, *labels):
    """(30), (56)"""
    return [clause(f"error of {label}", error, "<=", t.HIGH_ERROR) for label, error in errors(play, labels).items()]


def slowest(scene, one, others, what=""):
    """(32)"""
    next_ = means(scene, others).idxmax()
    ratio = scene.ratio(one, next_)
    if ratio.known and ratio.low <= 1 <= ratio.high:
        raise NotTestable(f"{one} and {next_} are as fast as each other")
    return clause(f"{what}{one} / {next_}, mean times", ratio.value, ">", 1.0, where=f"{next_} is slower")


def boxes_before_facets(box, falling, *labels):
    """(33) The slowest of G, L, O is faster than the fastest of P, I, U, K."""
    found = []
    for name, scene in (("box", box), ("falling", falling)):
        mine = means(scene, labels[:3]).idxmax()
        found.append(faster(scene, mine, labels[3:], f"{name}: "))
    return found


def quick_and_poor(box, falling, play, *labels):
    """(34) H and J are two of the three fastest of the nine, and poor on the playground."""
    found = []
    for name, scene in (("box", box), ("falling", falling)):
        rank = means(scene, labels).rank()
        found += [clause(f"{name}: place of {label} by time", int(rank[label]), "<=", 3, 1) for label in labels[:2]]
    error = errors(play, labels)
    return found + [clause(f"playground: error of {label}", error[label], ">", t.POOR_ERROR) for label in labels[:2]]


def best_filter(box, falling, one, *others):
    """(37) As a filter: it misses nothing; of those that miss nothing it passes the fewest on, and is the fastest."""
    found = []
    for name, scene in (("box", box), ("falling", falling)):
        missed = scene.summary.false_negative.astype(int)
        found.append(clause(f"{name}: missed by {one}", int(missed[one]), "=", 0, 1))
        safe = [label for label in others if missed[label] == 0]
        if safe:
            hits = scene.summary.hits.astype(int)
            next_ = hits[safe].idxmin()
            found.append(clause(f"{name}: pairs passed on by "
                                f"{one}", int(hits[one]), "<=", int(hits[next_]), where=f"{next_} passes fewer on"))
            found.append(faster(scene, one, safe, f"{name}: "))
        else:
            found.append(told(f"{name}: others that miss nothing", "none"))
    return found


def fails_at_large(falling, label):
    """(39) MOST of its false positives are with a large flat body."""
    evidence = falling.evidence
    if evidence is None or not evidence.thin.any():
        raise NotTestable("the file has no large flat body")
    false = evidence.false_positives(label)
    if not len(false):
        raise NotTestable(f"{label} has no false positive")
    flat = evidence.thin[false.a.to_numpy()] | evidence.thin[false.b.to_numpy()]
    return [clause("share of its false positives with a large flat body", float(flat.mean()), ">", t.MOST),
            told("false positives", len(false))]


def worse_when_turned(play, label):
    """(40) High accuracy on boxes that are not turned, poor on those turned otherwise than by quarters."""
    found = []
    for what, turn, sign, limit in (("unturned boxes", "none", "<=", t.HIGH_ERROR),
                                    ("turned boxes", "other", ">", t.POOR_ERROR)):
        names = play.targets.index[(play.targets.kind == "box") & (play.targets.turn == turn)]
        near = play.samples.target.isin(names).to_numpy()
        truth, said = play.samples.truth.to_numpy()[near], play.reports[label].to_numpy()[near]
        if not (truth | said).any():
            raise NotTestable(f"the file has no {what} that are touched or reported")
        found.append(clause(f"error on {what}", float((truth != said).sum() / (truth | said).sum()), sign, limit,
                            1 / int((truth | said).sum())))
    return found


def between(box, falling, one, *others):
    """(41) Slower than G and H, faster than O and L."""
    found = []
    for name, scene in (("box", box), ("falling", falling)):
        below = means(scene, others[:2]).idxmax()
        ratio = scene.ratio(one, below)
        found.append(clause(f"{name}: {one} / {below}, mean times", ratio.value, ">", 1.0))
        found.append(faster(scene, one, others[2:], f"{name}: "))
    return found


def worse_and_slower(box, falling, play, one, other):
    """(42) More error in every scene, more time in both that are timed."""
    found = []
    for name, scene in (("box", box), ("falling", falling), ("playground", play)):
        error = errors(scene, [one, other])
        found.append(clause(f"{name}: error of {one}", error[one], ">", error[other]))
    return found + [faster(scene, other, [one], f"{name}: ") for name, scene in (("box", box), ("falling", falling))]


def nearer_to(play, one, like, *unlike):
    """(43) Its error is nearer to that of `like` than to that of any of `unlike`."""
    error = errors(play, [one, like, *unlike])
    away = (error - error[one]).abs()
    nearest = away[list(unlike)].idxmin()
    return [clause(f"difference of the errors of {one} and "
                   f"{like}", away[like], "<", away[nearest], where=f"{nearest} is nearer")]


def beaten_most(box, falling, one, *others):
    """(44) More of the nine are both faster and more accurate than it than of any other."""
    found = []
    for name, scene in (("box", box), ("falling", falling)):
        labels = [one, *others]
        error, time = errors(scene, labels).to_numpy(), means(scene, labels).to_numpy()
        better = ((error[None] < error[:, None]) & (time[None] < time[:, None])).sum(axis=1)
        most = int(np.argmax(better[1:])) + 1
        found.append(clause(f"{name}: how many are faster and err less than {one}", int(better[0]), ">=",
                            int(better[most]), 1, f"more so of {labels[most]}"))
    return found


def nearly_as(play, one, other):
    """(46) Its error is at most NEARLY_AS greater."""
    error = errors(play, [one, other])
    return [clause(f"error of {one} less that of {other}", float(error[one] - error[other]), "<=", t.NEARLY_AS)]


def alike_twice(box, falling, play, one, other):
    """(48) Errors in the playground at most NEARLY_AS apart, times within WITHIN."""
    error = errors(play, [one, other])
    found = [clause(f"difference of the errors of {one} and {other}", float(abs(error[one] - error[other])), "<=",
                    t.NEARLY_AS)]
    for name, scene in (("box", box), ("falling", falling)):
        ratio = scene.ratio(one, other).value
        found.append(clause(f"{name}: slower / faster", max(ratio, 1 / ratio), "<=", 1 + t.WITHIN))
    return found


def most_successful(box, falling, play, *labels):
    """(49) Second to K at most in accuracy, of the nine, and no other is both faster and more accurate."""
    one, found = labels[0], []
    for name, scene in (("box", box), ("falling", falling), ("playground", play)):
        rank = int(errors(scene, labels).rank(method="min")[one])
        found.append(clause(f"{name}: place by error of nine", rank, "<=", 2, 1))
    for name, scene in (("box", box), ("falling", falling)):
        error, time = errors(scene, labels), means(scene, labels)
        better = [label for label in labels if error[label] < error[one] and time[label] < time[one]]
        found.append(clause(f"{name}: how many are faster and err less", len(better), "=", 0, 1, f"they are "
        f"{', '.join(better)}"))
    return found


def engine_of(scene):
    label = next((label for label in ENGINE if label in scene.labels), None)
    if label is None:
        raise NotTestable("a file has no answers of cannon_naive or cannon_sap")
    return label


def curve(scene, label, column):
    return scene.per_step[column][scene.per_step.algorithm == label].to_numpy(dtype=float)


def as_the_engine(box, *labels):
    """(50) The median over the nine of the correlation with the engine's curve, of hits and of times."""
    engine, found = engine_of(box), []
    for column, what in (("hits", "hits"), ("time_ns", "times")):
        theirs = curve(box, engine, column)
        ours = [curve(box, label, column) for label in labels]
        if not np.ptp(theirs) or not all(map(np.ptp, ours)):
            raise NotTestable(f"{what} do not vary")
        r = [float(np.corrcoef(values, theirs)[0, 1]) for values in ours]
        found.append(clause(f"median r of {what} with {engine}", float(np.median(r)), ">=", t.VERY_ALIKE))
    return found


def later_than(falling, *labels):
    """(51) The engine has more hits in the second half of the steps, MOST of the nine in the first."""
    engine = engine_of(falling)

    def late_share(label):
        hits = curve(falling, label, "hits")
        if not hits.sum():
            raise NotTestable(f"{label} reports nothing")
        return float(hits[len(hits) // 2 :].sum() / hits.sum())

    early = [label for label in labels if late_share(label) < 0.5]
    rest = [label for label in labels if label not in early]
    return [
        clause(f"share of {engine}'s hits in the second half", late_share(engine), ">", 0.5),
        clause("share of the nine with more hits in the first half", len(early) / len(labels), ">", t.MOST,
               1 / len(labels), f"more in the second: {', '.join(rest)}"),
    ]


def rises_alone(falling, *labels):
    """(52) The engine's time follows the step number, that of MOST of the nine does not."""
    engine = engine_of(falling)

    def rise(label):
        time = curve(falling, label, "time_ns")
        if not np.ptp(time):
            raise NotTestable("times do not vary")
        return float(np.corrcoef(time, np.arange(len(time)))[0, 1])

    steady = [label for label in labels if rise(label) < t.FOLLOWS]
    rest = [label for label in labels if label not in steady]
    return [
        clause(f"r of {engine}'s time with the step", rise(engine), ">=", t.FOLLOWS),
        clause("share of the nine whose time does not rise", len(steady) / len(labels), ">", t.MOST, 1 / len(labels),
               f"rising: {', '.join(rest)}"),
    ]


def more_false_than_true(box, falling, label):
    """(53)"""
    found = []
    for name, scene in (("box", box), ("falling", falling)):
        summary = scene.summary.loc[label]
        true = int(summary.true_positive)
        found.append(clause(f"{name}: false positives", int(summary.false_positive), ">", true, 1))
    return found


def counts_comparable(box, falling, one, other):
    """(54) The larger number of hits at most COMPARABLE times the smaller."""
    found = []
    for name, scene in (("box", box), ("falling", falling)):
        hits = scene.summary.hits[[one, other]].astype(float)
        if not hits.min():
            raise NotTestable("one of them reports nothing")
        found.append(clause(f"{name}: hits of {hits.idxmax()} / hits of {hits.idxmin()}", hits.max() / hits.min(), "<=",
                            t.COMPARABLE))
    return found


def markedly(scene, one, other, what=""):
    ratio = scene.ratio(other, one)
    if ratio.known and ratio.low <= t.MARKEDLY <= ratio.high:
        raise NotTestable(f"{what}{other} / {one} is {ratio.low:.3g} to {ratio.high:.3g}, which does not decide")
    return clause(f"{what}{other} / {one}, mean times", ratio.value, ">=", t.MARKEDLY)


def markedly_faster(box, falling, one, other):
    """(55)"""
    return [markedly(box, one, other, "box: "), markedly(falling, one, other, "falling: ")]


def facets_most_accurate(play, *labels):
    """(56) Each of the four errs less than every one of the five."""
    error = errors(play, labels)
    best = error[list(labels[4:])].idxmin()
    return [clause(f"error of {label}", error[label], "<", error[best], where=f"{best} errs "
                                                                              "less") for label in labels[:4]]


def faster_in_one(box, falling, one, other):
    """(57) Markedly faster in the falling scene, within WITHIN in the box scene."""
    ratio = box.ratio(other, one).value
    return [markedly(falling, one, other, "falling: "),
            clause("box: slower / faster", max(ratio, 1 / ratio), "<=", 1 + t.WITHIN)]


NINE = "KGHJLPOIU"
# number, text, scenes, keys, judge, and True where it compares times.
STATEMENTS = [
    (30, "K, I and U have high accuracy.", PLAY, "KIU", accurate),
    (31, "K is the most accurate of the nine.", ALL, NINE, in_all(least_error)),
    (32, "K is the slowest of the nine.", BOTH, NINE, in_both(slowest), True),
    (33, "The methods of oriented boxes, G, L and O, are faster than those of facets, P, I, U and K.", BOTH, "GLOPIUK",
     boxes_before_facets, True),
    (34, "H and J are fast and inaccurate.", ALL, "HJGKLPOIU", quick_and_poor, True),
    (35, "G is the most accurate of the methods of oriented boxes.", ALL, "GLO", in_all(least_error)),
    (36, "G is the fastest of the methods of oriented boxes.", BOTH, "GLO", in_both(faster), True),
    (37, "G is the best filter before slower methods.", BOTH, "G" + NINE.replace("G", ""), best_filter, True),
    (38, "H is the least accurate of the nine.", PLAY, "HGJKLPOIU",
     lambda play, one, *others: [most_error(play, one, others)]),
    (39, "H fails where a body is large and flat.", ("falling",), "H", fails_at_large),
    (40, "J loses its effect when boxes are turned.", PLAY, "J", worse_when_turned),
    (41, "J is a little slower than G and H, and faster than O and L.", BOTH, "JGHOL", between, True),
    (42, "L is a worse G: less accurate and slower.", ALL, "LG", worse_and_slower, True),
    (43, "P has the accuracy of J rather than of the other facet methods.", PLAY, "PJKIU", nearer_to),
    (44, "P is the least effective of the nine.", BOTH, "PGHJKLOIU", beaten_most, True),
    (45, "O is the least accurate of the methods of oriented boxes.", ALL, "OGL", in_all(most_error)),
    (46, "I is nearly as accurate as K.", PLAY, "IK", nearly_as),
    (47, "I is somewhat faster than K.", BOTH, "IK", in_both(faster), True),
    (48, "U is nearly as accurate as I, and about as fast.", ALL, "UI", alike_twice, True),
    (49, "U is the most successful of the nine.", ALL, "UGHJKLPOI", most_successful, True),
    (50, "In the box scene curves of hits and times are shaped as the engine's.", ("box",), NINE, as_the_engine),
    (51, "In the falling scene the engine has most hits towards the end, the nine towards the beginning.", ("falling",),
     NINE, later_than),
    (52, "In the falling scene the engine's time rises, that of the nine is steady or falls.", ("falling",), NINE,
     rises_alone),
    (53, "H reports far too much.", BOTH, "H", more_false_than_true),
    (54, "J and L report about as many pairs.", BOTH, "JL", counts_comparable),
    (55, "J is markedly faster than L.", BOTH, "JL", markedly_faster, True),
    (56, "Facets bring accuracy: K, P, I and U err less than all others.", PLAY, "KPIUGHJLO", facets_most_accurate),
    (57, "O is markedly faster than L in the falling scene, and about as fast in the box scene.", BOTH, "OL",
     faster_in_one, True),
]
