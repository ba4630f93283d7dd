"""The thesis's statements (1) to (29), each judged on results: confirmed, refuted, or not testable and why.

Every judge takes the scenes and the labels that its statement names, and returns whether the statement holds and its
figures. What its words mean is in thresholds.py; nothing else decides. A statement is judged on the algorithms as
published, under their own names; where a file has their careful form (label `<name>_careful`), that is judged too.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from analysis.tables import intervals, thresholds as t

KEYS = {
    "G": "obb_sat",
    "H": "bounding_sphere",
    "J": "rotated_aabb",
    "K": "facet_distance",
    "L": "obb_corners",
    "P": "facet_vectors",
    "O": "obb_triangles",
    "I": "facet_triangles",
    "U": "facet_rotations",
}
CAREFUL = "_careful"


class NotTestable(Exception):
    """The data cannot decide a statement; the text says what is missing."""


@dataclass(frozen=True)
class Verdict:
    """What the data say: verdict ("confirmed", "refuted" or "not testable: why") and figures (name -> number)."""

    number: int
    variant: str  # "" as published, "careful" for the careful form of the facet algorithms
    verdict: str
    figures: dict
    text: str


@dataclass(frozen=True)
class Statement:
    """judge(*scenes, *labels) -> (holds, figures), for the kinds of `scenes` and the labels of the `keys`, in order.

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
        figures = {"found": " < ".join(found), "misplaced": sum(a != b for a, b in zip(found, order))}
        pairs = list(zip(labels, labels[1:]))
        ratios = [(f"{below} and {slower}", scene.ratio(slower, below), scene.noise) for below, slower in pairs]
        return ordered(ratios, "as fast as each other"), figures

    return judge


def groups(box, falling, *labels):
    """Every mean of {G,H,J} below every one of {O,L}, those below {P,I,U}, those below K; in both scenes."""
    sizes = np.cumsum([0, 3, 2, 3, 1])
    ratios, figures = [], {}
    for name, scene in (("box", box), ("falling", falling)):
        mean = scene.summary.time_mean_ns[list(labels)]
        parts = [mean[a:b] for a, b in zip(sizes, sizes[1:])]
        for i, (below, slower) in enumerate(zip(parts, parts[1:])):
            ends = slower.idxmin(), below.idxmax()
            ratios.append((f"{ends[1]} and {ends[0]}", scene.ratio(*ends), scene.noise))
            figures[f"{name} step {i + 1}"] = float(slower.min() / below.max())
    return ordered(ratios, "as fast as each other"), figures


def falling_above_box(box, falling, *labels):
    if not box.host or box.host != falling.host:
        raise NotTestable("the two scenes were timed on different machines")
    ratio = falling.summary.time_mean_ns[list(labels)] / box.summary.time_mean_ns[list(labels)]
    figures = {"least ratio": float(ratio.min()), "greatest ratio": float(ratio.max())}
    ratios = [(f"{label} in both", intervals.apart(falling.mean(label), box.mean(label)), None) for label in labels]
    return ordered(ratios, "as fast in one scene as in the other"), figures


def slowest_by_far(box, falling, slowest, *others):
    """K by the next slowest: 9 to 10 in the falling scene, 5 in the box scene, each within ABOUT."""
    ratios = []
    for name, scene, least, most in (("box", box, 5, 5), ("falling", falling, 9, 10)):
        ratio = scene.ratio(slowest, scene.summary.time_mean_ns[list(others)].idxmax())
        ratios.append((f"{name} ratio", ratio, least * (1 - t.ABOUT), most * (1 + t.ABOUT)))
    return ranged(ratios), {name: ratio.value for name, ratio, _, _ in ratios}


def alike_in_time(box, falling, one, other):
    """The slower at most 1 + WITHIN times the faster, in both scenes."""
    ratios = [
        (f"{name} ratio", scene.ratio(one, other), 1 / (1 + t.WITHIN), 1 + t.WITHIN)
        for name, scene in (("box", box), ("falling", falling))
    ]
    return ranged(ratios), {name: max(ratio.value, 1 / ratio.value) for name, ratio, _, _ in ratios}


def apart_from_hits(falling, *labels):
    """Pearson's correlation of time and hits over the steps is below FOLLOWS. In the box scene both follow the
    bodies."""
    figures = {}
    for label in labels:
        rows = falling.per_step[falling.per_step.algorithm == label]
        figures[f"r {label}"] = float(rows.time_ns.corr(rows.hits.astype(float)))
    if np.isnan(list(figures.values())).any():
        raise NotTestable("times or hits do not vary")
    return max(figures.values()) < t.FOLLOWS, figures


def grows_with_square(box, *labels):
    """The exponent of time against number of bodies, fitted to the logarithms of the medians, is in SQUARE."""
    figures = {}
    for label in labels:
        rows = box.per_step[box.per_step.algorithm == label]
        median = rows.time_ns.groupby(box.bodies[rows.step.to_numpy()]).median()
        median = median[median.index >= t.SQUARE_FROM]
        if len(median) < 3 or median.index.max() < 2 * median.index.min():
            raise NotTestable("the number of bodies does not double")
        figures[f"exponent {label}"] = float(np.polyfit(np.log(median.index), np.log(median), 1)[0])
    return all(t.SQUARE[0] <= exponent <= t.SQUARE[1] for exponent in figures.values()), figures


def reports_most(box, falling, most, *others):
    """More hits than any other, over all steps, in both scenes."""
    figures = {}
    for name, scene in (("box", box), ("falling", falling)):
        hits = scene.summary.hits.astype(float)
        figures |= {f"{name} hits {most}": hits[most], f"{name} hits next": hits[list(others)].max()}
    return all(figures[f"{name} hits {most}"] > figures[f"{name} hits next"] for name in ("box", "falling")), figures


def reports_fewest(falling, fewest, *others):
    """Fewer hits than any other, over all steps."""
    hits = falling.summary.hits.astype(float)
    figures = {f"hits {fewest}": hits[fewest], "hits next": hits[list(others)].min()}
    return bool(figures[f"hits {fewest}"] < figures["hits next"]), figures


def curves_coincide(scene, one, other):
    """The mean distance of the curves of hits is at most COINCIDE of their mean height."""
    hits = [scene.per_step.hits[scene.per_step.algorithm == label].to_numpy(dtype=float) for label in (one, other)]
    if not np.sum(hits):
        raise NotTestable("neither reports anything")
    distance = float(np.abs(hits[0] - hits[1]).mean() / np.mean(hits))
    return distance <= t.COINCIDE, {"distance": distance, f"hits {one}": hits[0].sum(), f"hits {other}": hits[1].sum()}


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


def early_share(touching):
    """The share of touching passes whose first report is visibly early."""
    return share(touching["first"] > t.EXACT_M)


def late_share(touching, limit=t.EXACT_M):
    """The share of touching passes first reported later than `limit` after contact, or never."""
    return share(~(touching["first"] >= -limit))


def early_figures(play, label, names=None, what=""):
    """What "is early" means: at least NOTICED of the touching passes are visibly early, and more than are late or never
    reported."""
    _, touching = passes(play, label, names)
    early, late = early_share(touching), late_share(touching)
    return early >= t.NOTICED and early > late, {f"early{what}": early, f"late or blind{what}": late}


def never_late(play, label):
    """(13) No false negative, every touching pass reported from first to last contact, and each visibly before it."""
    _, touching = passes(play, label)
    missed = int(play.false_negative[label])
    whole = (touching["first"] >= -t.BISECTION_M) & (touching["last"] <= t.BISECTION_M)
    early = early_share(touching)
    figures = {"missed samples": missed, "cut or blind passes": int((~whole).sum()), "early": early}
    figures["least first m"] = float(touching["first"].min())
    return missed == 0 and bool(whole.all()) and early == 1, figures


def exact_figures(play, label, names):
    """Exact: every touching pass begins and ends within EXACT_M of the truth, and no other pass is ever reported."""
    mine, touching = passes(play, label, names)
    worst = float(touching[["first", "last"]].abs().fillna(np.inf).to_numpy().max())
    falsely = int((mine.reported[mine.truth_first.isna()] > 0).sum())
    figures = {"touching": len(touching), "worst m": worst, "false positives": falsely}
    return worst <= t.EXACT_M and falsely == 0, figures


def unturned_boxes(play):
    return targets(play, "unturned slab or cube", kind="box", turn="none")


def exact_on_boxes(play, label):
    """(14)"""
    return exact_figures(play, label, unturned_boxes(play))


def middle_share(play, label, names, what):
    """The share of samples in the middle of the targets, touching nothing, at which the algorithm reports."""
    flags = play.samples.middle & play.samples.target.isin(names) & neither(play)
    return share(chosen_samples(play, label, flags, f"in {what}"))


def sees_figures(play, label, name, names):
    """Sees the empty middle: silent there (NEARLY_ALL), though it reports MOST passes that touch that target."""
    middle = middle_share(play, label, names, f"the {name}")
    _, touching = passes(play, label, names)
    reported = share(touching["first"].notna())
    figures = {f"reports the {name}'s middle": middle, f"reports the touched {name}": reported}
    return middle <= 1 - t.NEARLY_ALL and reported > t.MOST, figures


def sample_error(play, label, names):
    """(FP + FN) / (TP + FP + FN) over the samples at the targets, those with the hero inside left out."""
    chosen = (play.samples.target.isin(names) & ~contained(play)).to_numpy()
    truth, said = play.samples.truth.to_numpy()[chosen], play.reports[label].to_numpy()[chosen]
    if not (truth | said).any():
        raise NotTestable("the targets that it is about are neither touched nor reported")
    return float((truth != said).sum() / (truth | said).sum())


def ring_filled_and_knot_poor(play, label):
    """(15) Reports NEARLY_ALL samples in the rings' middle; the error on the knot is above POOR_ERROR."""
    ring = middle_share(play, label, targets(play, "ring", kind="torus"), "the ring")
    error = sample_error(play, label, targets(play, "knot", kind="torus_knot"))
    figures = {"reports the ring's middle": ring, "error on the knot": error}
    return ring >= t.NEARLY_ALL and error > t.POOR_ERROR, figures


def good_figures(play, label, names):
    """Good: the median contact begins within SLIGHT_M of the truth; later than that, or never, are at most RARE."""
    _, touching = passes(play, label, names)
    median = float(touching["first"].abs().fillna(np.inf).median())
    late = late_share(touching, t.SLIGHT_M)
    return median <= t.SLIGHT_M and late <= t.RARE, {"median off m": median, "late or blind": late}


def exact_and_good_at_quarters(play, label):
    """(16) Exact on unturned boxes, good on boxes at multiples of 90 degrees: nearer angles are not in the scene."""
    exact, figures = exact_on_boxes(play, label)
    good, more = good_figures(play, label, targets(play, "slab at 90 degrees", kind="box", turn="quarter"))
    return exact and good, figures | {f"at 90: {name}": value for name, value in more.items()}


def too_early_or_blind(play, label):
    """(17) On boxes turned otherwise: MOST passes too early (TOO_EARLY_M) or blind (never, or SLIGHT_M late), and both
    occur."""
    _, touching = passes(play, label, targets(play, "slab at 45 degrees", kind="box", turn="other"))
    early, blind = share(touching["first"] > t.TOO_EARLY_M), late_share(touching, t.SLIGHT_M)
    return early > 0 and blind > 0 and early + blind > t.MOST, {"too early": early, "blind": blind}


def sees_ring_and_knot(play, label):
    """(18)"""
    ring, figures = sees_figures(play, label, "ring", targets(play, "ring", kind="torus"))
    knot, more = sees_figures(play, label, "knot", targets(play, "knot", kind="torus_knot"))
    return ring and knot, figures | more


def slightly_early(play, label):
    """(19) Is early, the median of the early passes by SLIGHT_M at most; too early are at most RARE."""
    early, figures = early_figures(play, label)
    _, touching = passes(play, label)
    ahead = touching["first"][touching["first"] > t.EXACT_M]
    far = share(touching["first"] > t.TOO_EARLY_M)
    figures |= {"median of the early m": float(ahead.median()), "too early": far}
    return early and figures["median of the early m"] <= t.SLIGHT_M and far <= t.RARE, figures


def inside_share(play, label):
    """The share of samples with the hero wholly inside at which the algorithm reports."""
    return share(chosen_samples(play, label, contained(play), "with one body inside another"))


def misses_inside(play, label):
    """(20) Silent at MOST samples with the hero inside."""
    reported = inside_share(play, label)
    return 1 - reported > t.MOST, {"reports inside": reported}


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
    return gaps > t.RARE * contacts, {"contacts reported": contacts, "with a gap": gaps, "changes in contact": changes}


def tunnels_most(play, label, *others):
    """(22) Silent at NEARLY_ALL samples with the hero through a slab; more false negatives than the other box
    methods."""
    silent = 1 - share(chosen_samples(play, label, play.samples.through, "with the hero through a slab"))
    missed, next_most = int(play.false_negative[label]), int(play.false_negative[list(others)].max())
    figures = {"silent through the slab": silent, "missed": missed, "next most missed": next_most}
    return silent >= t.NEARLY_ALL and missed > next_most, figures


def early_on_turned(play, label):
    """(23) Targets turned by no multiple of 90 degrees."""
    return early_figures(play, label, targets(play, "turned body", turn="other"))


def exact_slab_early_round(play, label):
    """(24) Exact on unturned slabs; early on spheres and on capsules."""
    holds, figures = exact_figures(play, label, targets(play, "unturned slab", thin=True, turn="none"))
    for kind in ("sphere", "capsule"):
        early, more = early_figures(play, label, targets(play, kind, kind=kind), f", {kind}")
        holds, figures = holds and early, figures | more
    return holds, figures


def late_or_blind_on_two_axes(play, label):
    """(25) On slabs turned about more than one axis, MOST touching passes are visibly late or never reported."""
    _, touching = passes(play, label, targets(play, "slab turned about two axes", thin=True, axes=2))
    blind, late = share(touching["first"].isna()), share(touching["first"] < -t.EXACT_M)
    return blind + late > t.MOST, {"late": late, "blind": blind}


def turned_ring_but_not_middle(play, label):
    """(26) Good on rings turned about one axis, yet reports NEARLY_ALL samples in the rings' middle."""
    good, figures = good_figures(play, label, targets(play, "ring turned about one axis", kind="torus", axes=1))
    middle = middle_share(play, label, targets(play, "ring", kind="torus"), "the ring")
    return good and middle >= t.NEARLY_ALL, figures | {"reports the ring's middle": middle}


def may_miss_inside(play, label):
    """(27) "May": at least one sample with the hero inside is not reported."""
    reported = inside_share(play, label)
    return reported < 1, {"reports inside": reported}


def sees_but_has_holes(play, label):
    """(28) Sees ring and knot; some touching pass is blind, SLIGHT_M late or broken by a gap; silent at MOST samples
    inside."""
    sees, figures = sees_ring_and_knot(play, label)
    _, touching = passes(play, label)
    _, gaps = contacts_with_gap(play, label)
    blind = int((~(touching["first"] >= -t.SLIGHT_M)).sum())
    misses, more = misses_inside(play, label)
    holds = sees and (blind > 0 or gaps > 0) and misses
    return holds, figures | {"blind passes": blind, "contacts with a gap": gaps} | more


def practically_alike(play, one, other):
    """(29) At samples at which either reports, at most PRACTICALLY of the answers differ. How far contacts differ is a
    figure."""
    said = play.reports[[one, other]].to_numpy()
    either = said.any(axis=1)
    if not either.any():
        raise NotTestable("neither reports anything")
    differs = share(said[either, 0] != said[either, 1])
    first = [passes(play, label)[1]["first"].to_numpy() for label in (one, other)]
    same = (np.abs(first[0] - first[1]) <= t.SAME_M) | (np.isnan(first[0]) & np.isnan(first[1]))
    return differs <= t.PRACTICALLY, {"different answers": differs, "same first contact": share(same)}


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
    """The Verdict on a statement. scenes: kind -> Playground or Timed. careful: on the careful labels where there are
    any."""
    labels = [KEYS[key] for key in statement.keys]
    try:
        found = []
        for kind in statement.scenes:
            if kind not in scenes:
                raise NotTestable(f"no file of a {kind} scene was given")
            found.append(scenes[kind])
        if careful:
            labels = [label + CAREFUL if all(label + CAREFUL in s.labels for s in found) else label for label in labels]
        for scene, kind in zip(found, statement.scenes):
            if missing := [label for label in labels if label not in scene.labels]:
                raise NotTestable(f"the {kind} file has no answers of {', '.join(missing)}")
        if statement.times:
            found = [as_published(scene, kind, labels) for scene, kind in zip(found, statement.scenes)]
        holds, figures = statement.judge(*found, *labels)
        verdict = "confirmed" if holds else "refuted"
    except NotTestable as why:
        verdict, figures = f"not testable: {why}", {}
    return Verdict(statement.number, "careful" if careful else "", verdict, figures, statement.text)


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


def shown(value):
    """A figure: three digits, whole numbers in full."""
    if not isinstance(value, float):
        return str(value)
    return f"{value:.0f}" if 1000 <= abs(value) < 1e15 else f"{value:.3g}"
