"""Figures 5.5 to 5.13 and 5.17 to 5.25 of the thesis, one by one: an algorithm's time, hits and bodies over the steps,
each on an axis of its own."""

import numpy as np
import pandas as pd
from matplotlib.ticker import MaxNLocator

from .drawing import (
    NotDrawn,
    binned,
    caption,
    comparable,
    correlation,
    digits,
    key as key_of,
    seconds,
    steps_of,
    stretch,
)
from .figure import Figure, figure, style, svg_of
from .steps import SEEN
from ..tables import thresholds as t
from ..tables.scenes import twins
from ..tables.sentences import FIGURES as CZECH
from ..words import duration

ORDER = "GHJKLPOIU"  # of the thesis's figures
FIRST = {"box": 5, "falling": 17}
ENGINE = {"box": ("5.1", "5.2", "5.3", "5.4"), "falling": ("5.14", "5.15", "", "5.16")}


def number_of(kind, letter):
    return f"5.{FIRST[kind] + ORDER.index(letter)}"


def anchor(number):
    return f"figure-{number.replace('.', '-')}"


def one(run, kind, letter, published=None):
    """The figure of one of the nine. published: another run of the scene, taken where that alone has the thesis's
    procedure. Raises NotDrawn when the file has it not as published, or not on this machine."""
    number = number_of(kind, letter)
    label = next((label for label in comparable(run) if key_of(run, label) == letter), None)
    if label is None:
        raise NotDrawn(f"the file has no {letter} of the thesis as published")
    if twins(run).get(label) == "" and published is not None:
        run = published
    steps, timed = steps_of(run), twins(run).get(label) or label
    time, hits = (values[:, steps.labels.index(name)] for values, name in ((steps.time_ns, timed), (steps.hits, label)))
    rows = [("time of a step", time / 1e9, np.median), ("pairs reported", hits, np.mean)]
    rows += [("bodies", steps.bodies, np.mean)] if steps.grows else []
    look = style(label, label)
    fig, axes = figure(len(rows), 1, height=1.25 * len(rows) + 0.5, sharex=True, squeeze=False)
    columns = {}
    for axis, (what, values, reduce) in zip(axes[:, 0], rows):
        middle, line = binned(values, reduce)
        axis.plot(middle, line, color=look["color"], linewidth=1.3, gid=f"of:{label}")
        if what == "pairs reported":
            _, truth = binned(steps.truth, np.mean)
            axis.fill_between(middle, truth, color="#DADADA", linewidth=0, zorder=0)
        axis.set_ylim(bottom=0, top=max(float(line.max()) * 1.1, 1e-9))
        axis.set_ylabel(what)
        axis.yaxis.set_major_locator(MaxNLocator(4))
        axis.margins(x=0.01)
        columns["step"], columns[{"time of a step": "time (ns)"}.get(what, what)] = middle, line * (
            1e9 if what == "time of a step" else 1)
    seconds(axes[0, 0].yaxis)
    axes[-1, 0].set_xlabel("step")
    fig.align_ylabels()
    columns["truly meet"] = binned(steps.truth, np.mean)[1]
    what = (
        f"Time for all pairs of a step, pairs reported (the grey area: pairs that truly "
        f"meet){' and bodies' if steps.grows else ''} "
        f"over the steps; n = {len(hits)} steps, {stretch(hits, 'the median or mean')}."
    )
    if timed != label:
        what += f" The time is that of {timed}, the thesis's procedure with the same answers."
    elif twins(run).get(label) == "":
        what += (' The time is not that of the thesis\'s procedure: with search = "indexed" points that surely are '
                 'not near are '
                 "left out, where the thesis compared all.")
    return Figure(_title(letter, label, steps, time, hits), svg_of(fig), caption(run, what, f"figure "
                                                                                            f"{number}", times=False),
                  pd.DataFrame(columns), anchor(number), number, CZECH[number], SEEN[kind][letter])


def _title(letter, label, steps, time, hits):
    low, high = np.percentile(time[steps.full], (5, 95))
    title = (
        f"{letter} {label} takes {duration(time.mean())} a step ({duration(low)} to {duration(high)} with "
        f"all bodies "
    )
    title += f"there) and reports {digits(hits.mean())} pairs"
    still = correlation(hits[steps.full], time[steps.full])
    if not np.isnan(still):
        title += f"; its time {'follows' if still >= t.FOLLOWS else 'does not follow'} its hits (r = {still:.2f})"
    if steps.grows and not np.isnan(bodies := correlation(steps.bodies, time)):
        title += f"{' and' if bodies >= t.FOLLOWS else ', and does not follow'} the bodies (r = {bodies:.2f})"
    return title
