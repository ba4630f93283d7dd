"""What integrators look like, and why a case did not finish."""

from ...words import listed
from ..figure import PALETTE, style

# The families have colours, their members markers and lines; the same in every figure.
INTEGRATORS = {
    "RungeKuttaMerson": ("blue", "o", "-"),
    "RungeKutta3": ("vermilion", "s", "-"),
    "RungeKutta2": ("orange", "^", "-"),
    "RungeKuttaFeldberg": ("sky", "D", "-"),
    "Verlet": ("green", "v", "-"),
    "SemiExplicitEuler": ("grey", "P", "--"),
    "SemiExplicitEuler2": ("grey", "X", "-"),
    "ExplicitEuler": ("black", "<", ":"),
    "CPodesBDF": ("purple", "h", "-"),
    "CPodesAdams": ("purple", "p", "--"),
}

# Why a case did not finish: a letter in the cell, and what it means.
FAILED = {
    "energy": ("E", "energy grew beyond the bound"),
    "not_finite": ("N", "not a number"),
    "exception": ("X", "exception"),
    "aborted": ("A", "aborted"),
    "evaluations": ("B", "budget of force evaluations spent"),
    "time": ("T", "time budget spent"),
    "tunnelled": ("W", "went through the plate"),
}
OTHERWISE = ("?", "did not finish otherwise")


def causes(lost):
    """Why the cases `lost` did not finish, and how many for each reason."""
    return listed(f"{'not run' if status == 'not run' else (FAILED.get(status) or OTHERWISE)[1]} ({count})"
                  for status, count in lost["status"].value_counts().items())


def look(name):
    picked = INTEGRATORS.get(name)
    if not picked:
        return style(name)
    return {"color": PALETTE[picked[0]], "marker": picked[1], "linestyle": picked[2]}
