"""The thesis's statements, each judged on results: confirmed, refuted, or not testable and why.

Every judge takes the scenes and the labels that its statement names, and returns its clauses: each a number beside what
is needed of it; the statement holds when all do. What its words mean is in thresholds.py; nothing else decides. A
statement is judged on the algorithms as
published, under their own names; where a file has their careful form (label `<name>_careful`), that is judged too.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from . import causes, conclusions, intervals, thresholds as t
from .clauses import KEYS, NotTestable, clause, hold, told, yes
from .sentences import SENTENCES
from ..words import listed

CAREFUL = "_careful"
PUBLISHED = " published"


@dataclass(frozen=True)
class Verdict:
    """What the data say.

    variant: "" as published, "careful" for the careful form of the facet algorithms; verdict: "confirmed", "refuted" or
    "not testable: why"; clauses: what was measured and needed; text: the statement; cause: sentences that the data
    prove, "" for none; section, czech: where the thesis says it, and its words; see: anchors of the figures that show
    it.
    """

    number: int
    variant: str
    verdict: str
    clauses: list
    text: str
    cause: str = ""
    section: str = ""
    czech: str = ""
    see: tuple = ()

    @property
    def near(self):
        """Refuted, and every clause that fails is a near miss."""
        failed = [each for each in self.clauses if each.holds is False]
        return bool(failed) and all(each.near for each in failed)


@dataclass(frozen=True)
class Statement:
    """judge(*scenes, *labels) -> clauses, for the kinds of `scenes` and the labels of the `keys`, in order.

    times: it compares times of its algorithms, so each must be of the thesis's own procedure.
    """

    number: int
    text: str
    scenes: tuple
    keys: str
    judge: Callable
    times: bool = False


# Times and counts: the box and the falling scene.
#
# Of two times one is above the other when their ratio says so beyond its interval and the noise floor; where it does
# not, they are as fast as each other and decide nothing. A ratio that shall be in a range is in it by its value;
# outside of it decides only what is outside with its whole interval. Where times per step are not known, values alone
# decide.


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


# The playground. A pass touches when the exact contact exists. `first` is how far before it the first report comes,
# `last` how far before the exact last contact the last report: reporting too much is first > 0 and last < 0.


def targets(play, what, **wanted):
    """The names of the targets that are as wanted, such as kind="box", turn="none"."""
    chosen = np.ones(len(play.targets), dtype=bool)
    for column, value in wanted.items():
        chosen &= (play.targets[column] == value).to_numpy()
    if not chosen.any():
        raise NotTestable(f"the file has no {what}")
    return play.targets.index[chosen]


def passes(play, label, names=None):
    """The passes of an algorithm, through the named targets: (all, those that touch)."""
    mine = play.passes[play.passes.algorithm == label]
    if names is not None:
        mine = mine[mine.target.isin(names)]
    touching = mine[mine.truth_first.notna()]
    if touching.empty:
        raise NotTestable("no pass touches the targets that it is about")
    return mine, touching


def chosen_samples(play, label, flags, what):
    """Where `flags` hold: whether the algorithm reports. Booleans, N > 0."""
    if not flags.any():
        raise NotTestable(f"the file has no sample {what}")
    return play.reports[label].to_numpy()[flags.to_numpy()]


def contained(play):
    if play.samples.contained.isna().any():
        raise NotTestable('the file does not record contained pairs (containment = "record")')
    return play.samples.contained.astype(bool)


def neither(play):
    """Samples at which the hero neither touches nor is inside."""
    return ~play.samples.truth & ~contained(play)


def share(flags):
    return float(np.mean(np.asarray(flags, dtype=float)))


def targets_of(touching, wrong):
    """At which targets passes are `wrong`, the most first, four at most: "at slab_45 (2 of 3 passes)"."""
    counts = touching.target[wrong].value_counts(sort=False).sort_values(ascending=False, kind="stable")
    every = touching.target.value_counts()
    named = [f"{name} ({count} of {every[name]} passes)" for name, count in counts.items()]
    return "at " * bool(named) + ", ".join(named[:4]) + (f" and {len(named) - 4} more" if len(named) > 4 else "")


def early_share(touching):
    """The share of touching passes whose first report is visibly early."""
    return share(touching["first"] > t.EXACT_M)


def late(touching, limit=t.EXACT_M):
    """Which touching passes are first reported later than `limit` after contact, or never."""
    return ~(touching["first"] >= -limit)


def early_clauses(play, label, names=None, what=""):
    """What "is early" means: at least NOTICED of the touching passes are visibly early, and more than are late or never
    reported."""
    _, touching = passes(play, label, names)
    early, behind, one = early_share(touching), share(late(touching)), 1 / len(touching)
    on_time = touching["first"].abs() <= t.EXACT_M
    return [
        clause(f"share of passes visibly early{what}", early, ">=", t.NOTICED, one,
               f"on time {targets_of(touching, on_time)}" if on_time.any() else ""),
        clause(f"share late or blind{what}", behind, "<", early, one, targets_of(touching, late(touching))),
    ]


def never_late(play, label):
    """(13) No false negative, every touching pass reported from first to last contact, and each visibly before it."""
    _, touching = passes(play, label)
    whole = (touching["first"] >= -t.BISECTION_M) & (touching["last"] <= t.BISECTION_M)
    ahead = touching["first"] > t.EXACT_M
    return [
        clause("missed samples", int(play.false_negative[label]), "=", 0, 1),
        clause("passes cut or blind", int((~whole).sum()), "=", 0, 1, targets_of(touching, ~whole)),
        clause("share visibly early", share(ahead), "=", 1, 1 / len(touching), targets_of(touching, ~ahead)),
        told("least first report, m early", float(touching["first"].min())),
    ]


def exact_clauses(play, label, names, what=""):
    """Exact: every touching pass begins and ends within EXACT_M of the truth, and no other pass is ever reported."""
    mine, touching = passes(play, label, names)
    off = touching[["first", "last"]].abs().fillna(np.inf).max(axis=1)
    falsely = mine.truth_first.isna() & (mine.reported > 0)
    return [
        clause(f"most off, m{what}", float(off.max()), "<=", t.EXACT_M, where=targets_of(touching, off > t.EXACT_M)),
        clause(f"passes falsely reported{what}", int(falsely.sum()), "=", 0, 1, targets_of(mine, falsely)),
        told(f"passes that touch{what}", len(touching)),
    ]


def unturned_boxes(play):
    return targets(play, "unturned slab or cube", kind="box", turn="none")


def exact_on_boxes(play, label):
    """(14)"""
    return exact_clauses(play, label, unturned_boxes(play))


def middle_samples(play, label, names, what):
    """Of samples in the middle of the targets, touching nothing: at which the algorithm reports."""
    flags = play.samples.middle & play.samples.target.isin(names) & neither(play)
    return chosen_samples(play, label, flags, f"in {what}")


def filled(play, label, names, what):
    """The clause: reports NEARLY_ALL samples in the middle."""
    said = middle_samples(play, label, names, what)
    return clause(f"share of samples in {what}'s middle reported", share(said), ">=", t.NEARLY_ALL, 1 / len(said))


def sees_clauses(play, label, name, names):
    """Sees the empty middle: silent there (NEARLY_ALL), though it reports MOST passes that touch that target."""
    said = middle_samples(play, label, names, f"the {name}")
    _, touching = passes(play, label, names)
    reported = touching["first"].notna()
    limit = round(1 - t.NEARLY_ALL, 9)
    return [
        clause(f"share of samples in the {name}'s middle reported", share(said), "<=", limit, 1 / len(said)),
        clause(f"share of passes that touch the {name} reported", share(reported), ">", t.MOST, 1 / len(touching),
               targets_of(touching, ~reported)),
    ]


def sample_error(play, label, names):
    """(FP + FN) / (TP + FP + FN) over the samples at the targets, those with the hero inside left out; and how many
    they are."""
    chosen = (play.samples.target.isin(names) & ~contained(play)).to_numpy()
    truth, said = play.samples.truth.to_numpy()[chosen], play.reports[label].to_numpy()[chosen]
    if not (truth | said).any():
        raise NotTestable("the targets that it is about are neither touched nor reported")
    return float((truth != said).sum() / (truth | said).sum()), int((truth | said).sum())


def ring_filled_and_knot_poor(play, label):
    """(15) Reports NEARLY_ALL samples in the rings' middle; the error on the knot is above POOR_ERROR."""
    ring = filled(play, label, targets(play, "ring", kind="torus"), "the ring")
    error, samples = sample_error(play, label, targets(play, "knot", kind="torus_knot"))
    return [ring, clause("error on the knot", error, ">", t.POOR_ERROR, 1 / samples)]


def good_clauses(play, label, names, what=""):
    """Good: the median contact begins within SLIGHT_M of the truth; later than that, or never, are at most RARE."""
    _, touching = passes(play, label, names)
    off = touching["first"].abs().fillna(np.inf)
    behind = late(touching, t.SLIGHT_M)
    return [
        clause(f"median off, m{what}", float(off.median()), "<=", t.SLIGHT_M,
               where=targets_of(touching, off > t.SLIGHT_M)),
        clause(f"share late by more than {t.SLIGHT_M} m or blind{what}", share(behind), "<=", t.RARE, 1 / len(touching),
               targets_of(touching, behind)),
    ]


def exact_and_good_at_quarters(play, label):
    """(16) Exact on unturned boxes, good on boxes at multiples of 90 degrees: nearer angles are not in the scene."""
    quarters = targets(play, "slab at 90 degrees", kind="box", turn="quarter")
    return [*exact_on_boxes(play, label), *good_clauses(play, label, quarters, ", at 90 degrees")]


def too_early_or_blind(play, label):
    """(17) On boxes turned otherwise: MOST passes too early (TOO_EARLY_M) or blind (never, or SLIGHT_M late), and both
    occur."""
    _, touching = passes(play, label, targets(play, "slab at 45 degrees", kind="box", turn="other"))
    early, blind = touching["first"] > t.TOO_EARLY_M, late(touching, t.SLIGHT_M)
    one = 1 / len(touching)
    return [
        clause("share too early", share(early), ">", 0, one), clause("share blind", share(blind), ">", 0, one),
        clause("share of either", share(early | blind), ">", t.MOST, one, targets_of(touching, ~(early | blind))),
    ]


def sees_ring_and_knot(play, label):
    """(18)"""
    ring = sees_clauses(play, label, "ring", targets(play, "ring", kind="torus"))
    return [*ring, *sees_clauses(play, label, "knot", targets(play, "knot", kind="torus_knot"))]


def slightly_early(play, label):
    """(19) Is early, the median of the early passes by SLIGHT_M at most; too early are at most RARE."""
    _, touching = passes(play, label)
    ahead = touching["first"][touching["first"] > t.EXACT_M]
    far = touching["first"] > t.TOO_EARLY_M
    return [
        *early_clauses(play, label),
        clause("median of the early passes, m", float(ahead.median()), "<=", t.SLIGHT_M),
        clause("share too early", share(far), "<=", t.RARE, 1 / len(touching), targets_of(touching, far)),
    ]


def inside(play, label):
    """Of samples with the hero wholly inside: at which the algorithm reports."""
    return chosen_samples(play, label, contained(play), "with one body inside another")


def misses_inside(play, label):
    """(20) Silent at MOST samples with the hero inside."""
    silent = 1 - share(inside(play, label))
    return [clause("share of samples inside not reported", silent, ">", t.MOST, 1 / len(inside(play, label)))]


def contacts_with_gap(play, label):
    """(contacts in which it reports, those with a gap).

    A contact is an unbroken stretch of true samples at one target; a gap is a silence between two reports in it.
    """
    truth, target = play.samples.truth.to_numpy(), play.samples.target.to_numpy()
    changes = np.flatnonzero((truth[1:] != truth[:-1]) | (target[1:] != target[:-1])) + 1
    said = play.reports[label].to_numpy()
    contacts = gaps = 0
    for stretch in np.split(np.arange(len(truth)), changes):
        if truth[stretch].any():
            inner = np.flatnonzero(said[stretch])
            contacts += len(inner) > 0
            gaps += len(inner) > 0 and len(inner) < inner[-1] - inner[0] + 1
    return contacts, gaps


def flickers(play, label):
    """(21) More than RARE of the contacts in which it reports at all are broken by a silence."""
    changes = int(passes(play, label)[1].flicker.sum())
    contacts, gaps = contacts_with_gap(play, label)
    return [
        clause("contacts with a gap", int(gaps), ">", t.RARE * contacts, 1),
        told("contacts reported", contacts), told("changes of the answer in contact", changes),
    ]


def tunnels_most(play, label, *others):
    """(22) Silent at NEARLY_ALL samples with the hero through a slab; more false negatives than the other box
    methods."""
    said = chosen_samples(play, label, play.samples.through, "with the hero through a slab")
    missed = play.false_negative[list(others)]
    return [
        clause("share of samples through the slab not reported", 1 - share(said), ">=", t.NEARLY_ALL, 1 / len(said)),
        clause("missed samples", int(play.false_negative[label]), ">", int(missed.max()), 1, f"{missed.idxmax()} "
                                                                                             f"misses more"),
    ]


def early_on_turned(play, label):
    """(23) Targets turned by no multiple of 90 degrees."""
    return early_clauses(play, label, targets(play, "turned body", turn="other"))


def exact_slab_early_round(play, label):
    """(24) Exact on unturned slabs; early on spheres and on capsules."""
    found = exact_clauses(play, label, targets(play, "unturned slab", thin=True, turn="none"), ", slab")
    for kind in ("sphere", "capsule"):
        found += early_clauses(play, label, targets(play, kind, kind=kind), f", {kind}")
    return found


def late_or_blind_on_two_axes(play, label):
    """(25) On slabs turned about more than one axis, MOST touching passes are visibly late or never reported."""
    _, touching = passes(play, label, targets(play, "slab turned about two axes", thin=True, axes=2))
    blind, behind = touching["first"].isna(), touching["first"] < -t.EXACT_M
    either = blind | behind
    return [
        clause("share late or blind", share(either), ">", t.MOST, 1 / len(touching),
               f"neither {targets_of(touching, ~either)}"),
        told("share late", share(behind)), told("share blind", share(blind)),
    ]


def turned_ring_but_not_middle(play, label):
    """(26) Good on rings turned about one axis, yet reports NEARLY_ALL samples in the rings' middle."""
    turned = targets(play, "ring turned about one axis", kind="torus", axes=1)
    ring = filled(play, label, targets(play, "ring", kind="torus"), "the ring")
    return [*good_clauses(play, label, turned, ", turned ring"), ring]


def may_miss_inside(play, label):
    """(27) "May": at least one sample with the hero inside is not reported."""
    return [clause("share of samples inside reported", share(inside(play, label)), "<", 1,
                   1 / len(inside(play, label)))]


def sees_but_has_holes(play, label):
    """(28) Sees ring and knot; some touching pass is blind, SLIGHT_M late or broken by a gap; silent at MOST samples
    inside."""
    _, touching = passes(play, label)
    _, gaps = contacts_with_gap(play, label)
    blind = int(late(touching, t.SLIGHT_M).sum())
    return [
        *sees_ring_and_knot(play, label),
        clause("passes blind, and contacts with a gap", blind + int(gaps), ">", 0, 1),
        *misses_inside(play, label),
    ]


def practically_alike(play, one, other):
    """(29) At samples at which either reports, at most PRACTICALLY of the answers differ. How far contacts differ is a
    figure."""
    said = play.reports[[one, other]].to_numpy()
    either = said.any(axis=1)
    if not either.any():
        raise NotTestable("neither reports anything")
    differs = said[either, 0] != said[either, 1]
    first = [passes(play, label)[1]["first"].to_numpy() for label in (one, other)]
    same = (np.abs(first[0] - first[1]) <= t.SAME_M) | (np.isnan(first[0]) & np.isnan(first[1]))
    where = play.samples.target[either][differs].value_counts()
    where = "at " + ", ".join(f"{name} ({count} samples)" for name, count in where[:4].items())
    return [
        clause("share of answers that differ", share(differs), "<=", t.PRACTICALLY, 1 / len(differs), where),
        told("share of passes with the same first contact", share(same)),
    ]


BOTH = ("box", "falling")
PLAY = ("playground",)
STATEMENTS = [
    Statement(1, "Order of mean times in the box scene: H < G < J < O < L < I < P < U < K.", ("box",), "HGJOLIPUK",
              mean_order("HGJOLIPUK"), times=True),
    Statement(2, "Order of mean times in the falling scene: G < H < J < O < L < U < I < P < K.", ("falling",),
              "GHJOLUIPK", mean_order("GHJOLUIPK"), times=True),
    Statement(3, "Three groups {G,H,J} < {O,L} < {P,I,U} < K in both.", BOTH, "GHJOLPIUK", groups, times=True),
    Statement(4, "Every mean of the falling scene is above the same of the box scene.", BOTH, "GHJKLPOIU",
              falling_above_box, times=True),
    Statement(5, "K takes about 9 to 10 times the next slowest in the falling scene, 5 in the box scene.", BOTH,
              "KGHJLPOIU", slowest_by_far, times=True),
    Statement(6, "I and U are within 25 % of each other.", BOTH, "IU", alike_in_time, times=True),
    Statement(7, "The times of G, H, O, L do not follow the number of hits.", ("falling",), "GHOL", apart_from_hits),
    Statement(8, "Those of L and J grow with the square of the number of bodies.", ("box",), "LJ", grows_with_square),
    Statement(9, "H reports the most.", BOTH, "HGJKLPOIU", reports_most),
    Statement(10, "I reports the fewest in the falling scene.", ("falling",), "IGHJKLPOU", reports_fewest),
    Statement(11, "The curves of I and U nearly coincide.", ("falling",), "IU", curves_coincide),
    Statement(12, "G and L nearly coincide in the box scene.", ("box",), "GL", curves_coincide),
    Statement(13, "H never misses, and is always early.", PLAY, "H", never_late),
    Statement(14, "G is exact on the unturned slab and cube.", PLAY, "G", exact_on_boxes),
    Statement(15, "G reports the empty middle of the ring, and is poor on the knot.", PLAY, "G",
              ring_filled_and_knot_poor),
    Statement(16, "J is exact on the unturned slab and cube, and good near multiples of 90 degrees.", PLAY, "J",
              exact_and_good_at_quarters),
    Statement(17, "J at 45 degrees is too early or blind.", PLAY, "J", too_early_or_blind),
    Statement(18, "K sees the middle of the ring and the loops of the knot.", PLAY, "K", sees_ring_and_knot),
    Statement(19, "K is slightly early near contact.", PLAY, "K", slightly_early),
    Statement(20, "K misses a small body inside a big one.", PLAY, "K", misses_inside),
    Statement(21, "K flickers while in contact.", PLAY, "K", flickers),
    Statement(22, "L misses a long capsule through a thin slab, and misses most of the box methods.", PLAY, "LGJO",
              tunnels_most),
    Statement(23, "P is early on turned bodies.", PLAY, "P", early_on_turned),
    Statement(24, "O is exact on the slab, early on sphere and capsule.", PLAY, "O", exact_slab_early_round),
    Statement(25, "O is late or blind on slabs turned about two axes.", PLAY, "O", late_or_blind_on_two_axes),
    Statement(26, "O handles rings turned about one axis but not the empty middle.", PLAY, "O",
              turned_ring_but_not_middle),
    Statement(27, "O may miss a body inside another.", PLAY, "O", may_miss_inside),
    Statement(28, "I sees the ring's middle and the knot's loop, has blind places, and misses a body inside another.",
              PLAY, "I", sees_but_has_holes),
    Statement(29, "U answers practically as I does.", PLAY, "IU", practically_alike),
    *(Statement(*row[:5], times=bool(row[5:])) for row in conclusions.STATEMENTS),
]


def as_published(scene, kind, labels):
    """`scene` with the mean times of the thesis's procedures under `labels`. Raises NotTestable where one is not in the
    file."""
    mean, times = scene.summary.time_mean_ns.copy(), dict(scene.times)
    for label in labels:
        if label in scene.twins:
            twin = scene.twins[label]
            if not twin:
                raise NotTestable(
                    f'{label} of the {kind} file has search = "indexed", which answers alike in another time than the '
                    "thesis's procedure; add a label with search = exhaustive"
                )
            mean[label] = scene.summary.time_mean_ns[twin]
            if twin in times:
                times[label] = times[twin]
    return replace(scene, summary=scene.summary.assign(time_mean_ns=mean), times=times)


def judged(statement, scenes, careful=False):
    """The Verdict on a statement. scenes: kind -> Playground or Timed; kind + PUBLISHED -> a run of that scene in the
    thesis's procedures, for statements on times. careful: on the careful labels where there are
    any."""
    labels = [KEYS[key] for key in statement.keys]
    cause = ""
    try:
        found = []
        for kind in statement.scenes:
            if kind not in scenes:
                raise NotTestable(f"no file of a {kind} scene was given")
            timed = statement.times and kind != "playground"
            lacks = timed and any(scenes[kind].twins.get(label) == "" for label in labels)
            found.append(scenes.get(kind + PUBLISHED, scenes[kind]) if lacks else scenes[kind])
        if careful:
            labels = [label + CAREFUL if all(label + CAREFUL in s.labels for s in found) else label for label in labels]
        for scene, kind in zip(found, statement.scenes):
            if missing := [label for label in labels if label not in scene.labels]:
                raise NotTestable(f"the {kind} file has no answers of {', '.join(missing)}")
        if statement.times:
            found = [as_published(scene, kind, labels) if kind != "playground" else scene
                     for scene, kind in zip(found, statement.scenes)]
        clauses = statement.judge(*found, *labels)
        verdict = "confirmed" if hold(clauses) else "refuted"
        if verdict == "refuted":
            cause = causes.cause(statement, clauses, dict(zip(statement.scenes, found)), labels)
    except NotTestable as why:
        verdict, clauses = f"not testable: {why}", []
    section, czech, see = SENTENCES[statement.number]
    form = "careful" if careful else ""
    return Verdict(statement.number, form, verdict, clauses, statement.text, cause, section, czech, see)


def verdicts(scenes):
    """The verdicts on all statements, in order, one on the careful form after the one as published."""
    found = []
    for statement in STATEMENTS:
        found.append(judged(statement, scenes))
        careful = [KEYS[key] + CAREFUL for key in statement.keys]
        given = [scenes[kind] for kind in statement.scenes if kind in scenes]
        if len(given) == len(statement.scenes) and any(all(label in s.labels for s in given) for label in careful):
            found.append(judged(statement, scenes, careful=True))
    return found
