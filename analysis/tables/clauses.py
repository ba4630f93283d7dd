"""What a statement of the thesis is judged by: clauses, each a number that was measured beside what is needed of it."""

from dataclasses import dataclass

import numpy as np

from . import thresholds as t

KEYS = {  # the thesis's letters, as in its applications
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


class NotTestable(Exception):
    """The data cannot decide a statement; the text says what is missing."""


@dataclass(frozen=True)
class Clause:
    """what: what was measured; measured: the number, or text; needed: "> 0.333", or "" of what only explains; holds:
    None
    of the latter; near: it fails and is a near miss (thresholds.NEAR); where: at what it fails, in words."""

    what: str
    measured: object
    needed: str = ""
    holds: bool | None = None
    near: bool = False
    where: str = ""


SIGNS = {"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal, "=": np.equal}
SPELLED = {"<=": "≤", ">=": "≥"}


def clause(what, measured, sign, limit, one=0.0, where=""):
    """`measured` must be `sign` ("<", ..., "in" for a range) `limit`. one: what a single pass or sample is worth."""
    if sign == "in":
        low, high = limit
        holds = low <= measured <= high
        needed, ends = f"{shown(float(low))} to {shown(float(high))}", (low, high)
    else:
        holds = bool(SIGNS[sign](measured, limit))
        needed, ends = f"{SPELLED.get(sign, sign)} {shown(limit)}", (limit,)
    away = min(abs(measured - end) - max(t.NEAR * abs(end), one) for end in ends)
    near = not holds and bool(away <= 1e-9)
    return Clause(what, measured, needed, bool(holds), near, "" if holds else where)


def told(what, measured):
    """A clause that only explains."""
    return Clause(what, measured)


def yes(what, holds, measured, needed, where=""):
    """A clause in words."""
    return Clause(what, measured, needed, bool(holds), False, "" if holds else where)


def hold(clauses):
    return all(each.holds is not False for each in clauses)


def shown(value):
    """A figure: three digits, whole numbers in full."""
    if not isinstance(value, (float, np.floating)):
        return str(value)
    return f"{value:.0f}" if 1000 <= abs(value) < 1e15 else f"{value:.3g}"
