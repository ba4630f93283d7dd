"""Numbers, counts and lists as words of a sentence."""

import numpy as np


def number(value):
    """Three digits; more of them in full, with narrow spaces from five on."""
    if not np.isfinite(value):
        return "–"
    if abs(value) >= 999.5:
        return f"{value:,.0f}".replace(",", "\u202f" if abs(value) >= 9999.5 else "")
    return f"{value:.3g}"


def duration(ns):
    """A time with its unit."""
    if not np.isfinite(ns):
        return "–"
    unit, name = next(((u, n) for u, n in ((1e9, "s"), (1e6, "ms"), (1e3, "µs")) if abs(ns) >= u * 0.9995), (1, "ns"))
    return f"{number(ns / unit)} {name}"


def memory(size):
    """Bytes with their unit."""
    if not np.isfinite(size):
        return "–"
    for unit, name in ((1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")):
        if size >= unit:
            return f"{number(size / unit)} {name}"
    return f"{number(size)} B"


def plural(count, one, many=""):
    """The noun for that many: case, cases."""
    return one if count == 1 else many or one + "s"


def verb(count, one, many):
    """The verb for that many, or for the names of a list: fails, fail."""
    return one if (count if np.isscalar(count) else len(count)) == 1 else many


def counted(count, one, many=""):
    """1 case, 2 cases."""
    return f"{number(count)} {plural(count, one, many)}"


def listed(names):
    """a; a and b; a, b and c."""
    names = list(names)
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
