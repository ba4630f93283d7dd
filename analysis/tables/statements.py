"""The thesis's statements, each judged on results: confirmed, refuted, or not testable and why.

Every judge (timings.py, passes.py, conclusions.py) takes the scenes and the labels that its statement names, and gives
its clauses: each a number beside what is needed of it; the statement holds when all do. What its words mean is in
thresholds.py; nothing else decides. A statement is judged on the algorithms as published, under their own names; where
a file has their careful form (label `<name>_careful`), that is judged too.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from . import causes, conclusions, passes, timings
from .clauses import KEYS, NotTestable, hold
from .sentences import SENTENCES

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


BOTH = ("box", "falling")
PLAY = ("playground",)
STATEMENTS = [
    Statement(1, "Order of mean times in the box scene: H < G < J < O < L < I < P < U < K.", ("box",), "HGJOLIPUK",
              timings.mean_order("HGJOLIPUK"), times=True),
    Statement(2, "Order of mean times in the falling scene: G < H < J < O < L < U < I < P < K.", ("falling",),
              "GHJOLUIPK", timings.mean_order("GHJOLUIPK"), times=True),
    Statement(3, "Three groups {G,H,J} < {O,L} < {P,I,U} < K in both.", BOTH, "GHJOLPIUK", timings.groups, times=True),
    Statement(4, "Every mean of the falling scene is above the same of the box scene.", BOTH, "GHJKLPOIU",
              timings.falling_above_box, times=True),
    Statement(5, "K takes about 9 to 10 times the next slowest in the falling scene, 5 in the box scene.", BOTH,
              "KGHJLPOIU", timings.slowest_by_far, times=True),
    Statement(6, "I and U are within 25 % of each other.", BOTH, "IU", timings.alike_in_time, times=True),
    Statement(7, "The times of G, H, O, L do not follow the number of hits.", ("falling",), "GHOL",
              timings.apart_from_hits),
    Statement(8, "Those of L and J grow with the square of the number of bodies.", ("box",), "LJ",
              timings.grows_with_square),
    Statement(9, "H reports the most.", BOTH, "HGJKLPOIU", timings.reports_most),
    Statement(10, "I reports the fewest in the falling scene.", ("falling",), "IGHJKLPOU", timings.reports_fewest),
    Statement(11, "The curves of I and U nearly coincide.", ("falling",), "IU", timings.curves_coincide),
    Statement(12, "G and L nearly coincide in the box scene.", ("box",), "GL", timings.curves_coincide),
    Statement(13, "H never misses, and is always early.", PLAY, "H", passes.never_late),
    Statement(14, "G is exact on the unturned slab and cube.", PLAY, "G", passes.exact_on_boxes),
    Statement(15, "G reports the empty middle of the ring, and is poor on the knot.", PLAY, "G",
              passes.ring_filled_and_knot_poor),
    Statement(16, "J is exact on the unturned slab and cube, and good near multiples of 90 degrees.", PLAY, "J",
              passes.exact_and_good_at_quarters),
    Statement(17, "J at 45 degrees is too early or blind.", PLAY, "J", passes.too_early_or_blind),
    Statement(18, "K sees the middle of the ring and the loops of the knot.", PLAY, "K", passes.sees_ring_and_knot),
    Statement(19, "K is slightly early near contact.", PLAY, "K", passes.slightly_early),
    Statement(20, "K misses a small body inside a big one.", PLAY, "K", passes.misses_inside),
    Statement(21, "K flickers while in contact.", PLAY, "K", passes.flickers),
    Statement(22, "L misses a long capsule through a thin slab, and misses most of the box methods.", PLAY, "LGJO",
              passes.tunnels_most),
    Statement(23, "P is early on turned bodies.", PLAY, "P", passes.early_on_turned),
    Statement(24, "O is exact on the slab, early on sphere and capsule.", PLAY, "O", passes.exact_slab_early_round),
    Statement(25, "O is late or blind on slabs turned about two axes.", PLAY, "O", passes.late_or_blind_on_two_axes),
    Statement(26, "O handles rings turned about one axis but not the empty middle.", PLAY, "O",
              passes.turned_ring_but_not_middle),
    Statement(27, "O may miss a body inside another.", PLAY, "O", passes.may_miss_inside),
    Statement(28, "I sees the ring's middle and the knot's loop, has blind places, and misses a body inside another.",
              PLAY, "I", passes.sees_but_has_holes),
    Statement(29, "U answers practically as I does.", PLAY, "IU", passes.practically_alike),
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
