"""What methods cost besides their time per step: set-up and memory."""

import numpy as np
import pandas as pd
from matplotlib.ticker import FixedLocator, NullLocator

from ...words import counted, duration, memory
from ..drawing import shortened
from ..figure import Figure, figure, style, svg_of
from .against import LONGEST, NAMED, log_ticks


def costs(scene, points, key):
    """The figure of what `points` cost besides time per step: set-up and memory. None when no file says."""
    points = points.reset_index(drop=True)
    if not {"setup_ns",
            "memory_bytes"} <= set(points) or not points[["setup_ns", "memory_bytes"]].notna().any(axis=None):
        return None
    points = points.sort_values(["time_mean_ns", "error"], ignore_index=True)
    table = pd.DataFrame({
        "label": points.label,
        "set-up (µs)": points.setup_ns / 1e3,
        "memory after set-up (KiB)": points.memory_bytes / 1024,
        "memory at the most (KiB)": points.memory_greatest_bytes / 1024,
        "mean time (µs)": points.time_mean_ns / 1e3,
        "error": points.error,
    })
    drawn = points.iloc[:NAMED]
    rest = "" if len(drawn) == len(points) else f" The {NAMED} fastest of {len(points)} are drawn, all are below."
    unknown = list(points.label[points.memory_bytes.isna()])
    unknown = f" Nothing is known of the memory of {', '.join(unknown)}." if unknown else ""
    caption = (
        f"{scene.title}: {counted(len(points), 'label')}, the fastest per step first. Set-up is made once a run and no "
        "part of the time per step: hierarchies, hulls, points. Memory is heap as malloc counts it, to about a percent:"
        f" filled after set-up, hollow the most at any time.{rest}{unknown}"
    )
    fig, (left, right) = figure(1, 2, height=0.85 + 0.2 * max(len(drawn), 3), sharey=True)
    rows = np.arange(len(drawn))[::-1]
    for row, (_, point) in zip(rows, drawn.iterrows()):
        look = style(point.algorithm, point.label) | {"linestyle": "none", "gid": f"of:{point.label}"}
        left.plot([point.setup_ns], [row], **look)
        right.plot([point.memory_bytes, point.memory_greatest_bytes], [row, row], color=look["color"], linewidth=0.8)
        right.plot([point.memory_greatest_bytes], [row], **look, markerfacecolor="white", markeredgewidth=1.2)
        right.plot([point.memory_bytes], [row], **look)
    for axes, values, words, shown_as in (
        (left, [drawn.setup_ns], "set-up", duration),
        (right, [drawn.memory_bytes, drawn.memory_greatest_bytes], "memory", memory),
    ):
        axes.set_xlabel(words)
        axes.tick_params(axis="y", length=0)
        values = np.concatenate([value.to_numpy(dtype=float) for value in values])
        values = values[np.isfinite(values) & (values > 0)]
        if not len(values):
            continue
        axes.set_xscale("log")
        room = max((values.max() / values.min()) ** 0.1, 1.5)
        limits = values.min() / room, values.max() * room
        axes.set_xlim(limits)
        # At most four ticks: their names are long. Of memory such as 100 KiB, 1 MiB.
        ticks = log_ticks(limits, 2).locs if shown_as is duration else _binary(limits)
        axes.xaxis.set_major_locator(FixedLocator(ticks[:: max(1, -(-len(ticks) // 4))]))
        axes.xaxis.set_major_formatter(lambda value, _, shown_as=shown_as: shown_as(value))
        axes.xaxis.set_minor_locator(NullLocator())
    left.set_yticks(rows, shortened(drawn.label, LONGEST).values())
    left.set_ylim(-0.6, len(drawn) - 0.4)
    return Figure(_costs_finding(points), svg_of(fig), caption, table, key)


def _binary(limits):
    """1, 10 and 100 of B, KiB, MiB and GiB within limits; their middle where there is none."""
    ticks = [unit * times for unit in (1, 1 << 10, 1 << 20, 1 << 30) for times in (1, 10, 100)]
    return [tick for tick in ticks if limits[0] <= tick <= limits[1]] or [float(np.sqrt(limits[0] * limits[1]))]


def _costs_finding(points):
    longest, largest = (points.label[points[column].idxmax()] if points[column].notna().any() else ""
                        for column in ("setup_ns", "memory_greatest_bytes"))
    words = f"{longest} takes longest to set up, {duration(points.setup_ns.max())}" if longest else ""
    if not largest:
        return words
    most = f"most memory, {memory(points.memory_greatest_bytes.max())}"
    return f"{words}, and {most}" if longest == largest else f"{words}{'; ' if words else ''}{largest} takes {most}"
