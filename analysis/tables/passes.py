"""Judges of the thesis's statements on the playground.

A pass touches when the exact contact exists. `first` is how far before it the first report comes, `last` how far before
the exact last contact the last report: reporting too much is first > 0 and last < 0.
"""

import numpy as np

from . import thresholds as t
from .clauses import NotTestable, clause, told


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
