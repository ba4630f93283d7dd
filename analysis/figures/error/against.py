"""Error against time and against operations: the pictures that the project is for."""

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, NullLocator

from ...tables import pareto
from ...words import counted, duration, listed, number, verb
from .. import labels
from ..drawing import shortened
from ..figure import Figure, figure, style, svg_of

NAMED = 24  # more points than this: only the front, the ends of lines, exact methods and libraries are named
FEW = ("Of so many labels the front, ends of lines, exact methods and libraries are named; the pointer and the numbers"
       " below tell the others.")
HEIGHT = 4.7  # inches, without the legend
MARGIN = {"left": 46, "right": 10, "top": 8, "bottom": 40}  # points
STRIP = 34  # points: the height of the strip for no error
TEXT = 9
WIDEST = 10  # times its middle: farther an interval does not stretch the axis
LONGEST = 34  # letters of a name: half of the figure

COSTS = {
    "time_mean_ns": "mean time per step",
    "operations": "mean operations per step",
}


def against(scene, points, cost, key, apart=""):
    """The figure of `points` (some rows of scene.points) over `cost`, a key of COSTS.

    apart: a sentence that says why other points are not here. Points without a cost above 0 cannot stand on a
    logarithmic axis: the caption names them.
    """
    points = points.reset_index(drop=True)
    seen = np.isfinite(points[cost]) & (points[cost] > 0) & np.isfinite(points.error)
    left_out = list(points.label[~seen])
    points = points[seen].reset_index(drop=True)
    one_unit = cost != "operations" or points.unit.nunique() <= 1
    points["front"] = pareto.front(points[cost], points.error) if len(points) and one_unit else False
    fig, titles, nameless = _draw(points, cost)
    caption = " ".join(
        filter(None, [_caption(scene, points, cost), _asked(points, cost), apart, _left_out(left_out),
                      _without_name(nameless), FEW if len(points) > NAMED else ""])
    )
    return Figure(finding(points, cost), svg_of(fig, titles), caption, _table(points, cost, scene), key)


def finding(points, cost):
    """What the figure shows, as a sentence."""
    if cost == "operations" and points.unit.nunique() > 1:
        ends = points.loc[points[cost].idxmin()], points.loc[points[cost].idxmax()]
        each = [f"{number(end[cost])} a step ({end.label}: {end.unit})" for end in ends]
        return (
            f"Elementary tests are of {points.unit.nunique()} kinds, which do not compare: from {each[0]} "
            f"to {each[1]}"
        )
    show = duration if cost == "time_mean_ns" else lambda value: f"{number(value)} operations"
    cheapest = "fastest" if cost == "time_mean_ns" else "cheapest"
    if not len(points):
        return "No algorithm has a cost that could be drawn"
    worth = points[points.front].sort_values([cost, "error"]).reset_index(drop=True)
    best, first = worth.iloc[-1], worth.iloc[0]
    told = _told_apart(points, cost)
    equals = [other.label for _, other in points.iterrows() if other.label != first.label and not told(other, first)]
    equals = f"; {_few(equals)} {verb(equals, 'is', 'are')} as fast as {first.label}" if equals else ""
    right = "makes no error" if best.error == 0 else f"errs {number(best.error)}"
    if len(points) == 1:
        return f"{best.label} {right} at {show(best[cost])}; it is alone, there is nothing to compare it with"
    if (points.error == 0).all():
        return f"No algorithm errs on this scene; {first.label} is the {cheapest}, {show(first[cost])}{equals}"
    if len(worth) == 1 or first.error == best.error:
        least = "makes no error" if best.error == 0 else f"errs least, {number(best.error)},"
        words = (f"{first.label} {least} and is also the {cheapest}, {show(first[cost])}: no other is worth its cost "
                 "here")
        return words + equals
    faster = worth[[row.error > best.error and told(row, best) for _, row in worth.iterrows()]]
    least = "makes no error" if best.error == 0 else f"errs least, {number(best.error)},"
    if not len(faster):
        return (
            f"{best.label} {least} at {show(best[cost])} and is as fast as {first.label}, {show(first[cost])}, which "
            f"errs {number(first.error)}: no other is worth its cost here"
        )
    second = faster.iloc[-1]
    words = (
        f"{best.label} {least} at {show(best[cost])}; nothing {cheapest[:-3]}er errs less than {number(second.error)} "
    )
    words += f"({second.label}, {show(second[cost])})"
    if first.label != second.label:
        words += f"; the {cheapest}, {first.label} at {show(first[cost])}, errs {number(first.error)}"
    return words + equals


def _told_apart(points, cost):
    """(row, row) -> whether their costs differ: of times, whether their ratio tells a difference."""
    if cost != "time_mean_ns" or "times" not in points:
        return lambda one, other: True
    return lambda one, other: one.label == other.label or not pareto.alike(one, other)


def _few(names):
    return listed(names if len(names) < 4 else [*names[:2], f"{len(names) - 2} more"])


def _caption(scene, points, cost):
    run = scene.runs[0]
    units = (
        "Each algorithm's operations are elementary tests of its own kind (named below); they are the same on every"
        " machine."
    )
    what = ("Time is the mean over steps of the fastest repeat, one thread, preparation of bodies included."
            + _trust(points))
    machines = " ".join(f"Timed on {machine}." for machine in dict.fromkeys(points.machine)) if len(points) else ""
    configs = ", ".join(dict.fromkeys(f"{r.meta.get('config_sha256', '?')[:12]}" for r in scene.runs))
    commits = ", ".join(dict.fromkeys(r.meta.get("git_commit", "?")[:7] for r in scene.runs))
    hits = int(run.truth_hits.sum())
    reading = "Down and to the left is better; the dashed line is the Pareto front: nothing below it is cheaper."
    if len(points) and not points.front.any():
        reading = "Lower is better; what stands to the left of another has cost less only where both are of one kind."
    return (
        f"{scene.title}: {counted(len(points), 'label')}, {counted(run.meta['steps'], 'step')},"
        f" {counted(len(run.meta['bodies']), 'body', 'bodies')},"
        f" {number(hits)} pairs truly meet over all steps. {reading}"
        f" {what if cost == 'time_mean_ns' else units} Configuration {configs}, motion and truth of"
        f" commit {commits}. " + (machines if cost == "time_mean_ns" else "")
    ).strip()


def _trust(points):
    """What a caption says about how far times can be trusted."""
    if not _intervals(points).any():
        return ""
    floor = pareto.widest(*points.floor) if "floor" in points else None
    words = (
        " Bars are 95 % intervals of the mean, by a block bootstrap over steps like these; which of two labels is "
        "faster is told by their ratio over the same steps, in the table below."
    )
    if floor is not None:
        most = max(floor.high, 1 / floor.low)
        words += f" A label timed twice differed by up to {number(100 * (most - 1))} %: no less is called a difference."
    return words


def _intervals(points):
    """Which of the points have an interval of their mean time."""
    if not {"time_mean_low_ns", "time_mean_high_ns"} <= set(points):
        return pd.Series(False, index=points.index)
    return points.time_mean_low_ns.notna() & points.time_mean_high_ns.notna()


def _asked(points, cost):
    """How methods of others were asked: only so do their times stand beside others."""
    if cost != "time_mean_ns" or "asked" not in points:
        return ""
    others = points[points.asked != ""]
    each = "; ".join(f"{point.label}: {point.asked}" for point in others.itertuples())
    return f"Of others, the rest in process: {each}." if each else ""


def _left_out(names):
    return f"Not drawn, being without a cost above 0: {', '.join(names)}." if names else ""


def _without_name(names):
    return f"No room for the names of {', '.join(names)}: the pointer tells them." if names else ""


def _table(points, cost, scene):
    table = pd.DataFrame({"label": points.label, "error": points.error})
    if cost == "time_mean_ns":
        table["mean time (µs)"] = points[cost] / 1e3
        if _intervals(points).any():
            table["from"], table["to"] = points.time_mean_low_ns / 1e3, points.time_mean_high_ns / 1e3
        if "times" in points and len(points):
            fastest = points.loc[points[cost].idxmin()]
            ratios = [pareto.compared(point, fastest) for _, point in points.iterrows()]
            table["times the fastest"] = [ratio.value for ratio in ratios]
            table["at least"], table["at most"] = [ratio.low for ratio in ratios], [ratio.high for ratio in ratios]
            table["as fast as"] = [", ".join(_equals(points, point)) for _, point in points.iterrows()]
    else:
        table["operations per step"] = points[cost]
        table["unit"] = points.unit
    table["on the front"] = points.front
    table["algorithm"] = points.algorithm
    table["scope"] = points.scope
    table["promise"] = points.promise
    if len(scene.runs) > 1:
        table["file"] = points.file
    return table.sort_values(table.columns[2], ignore_index=True)


def _equals(points, point):
    """The labels that are as fast as one."""
    told = _told_apart(points, "time_mean_ns")
    return [other.label for _, other in points.iterrows() if other.label != point.label and not told(other, point)]


def _draw(points, cost):
    """The figure, what the pointer tells of its marks, and the labels whose names found no room."""
    crowded = len(points) > NAMED
    lines = pareto.sweeps(points) if len(points) else []
    legend = _legend(points, crowded, lines)
    rows = -(-len(legend) // 3)
    below = MARGIN["bottom"] + 13 * rows + 4
    fig, (main, strip) = figure(
        2, height=HEIGHT + 0.7 * crowded + 13 * rows / 72, sharex=True, constrained_layout=False
    )
    width, height = (size * 72 for size in fig.get_size_inches())
    left, right = MARGIN["left"] / width, 1 - MARGIN["right"] / width
    strip.set_position([left, below / height, right - left, STRIP / height])
    main.set_position(
        [left, (below + STRIP + 6) / height, right - left, (height - below - STRIP - 6 - MARGIN["top"]) / height]
    )
    _axes(main, strip, points, cost)

    titles, known = {}, _intervals(points)
    show = duration if cost == "time_mean_ns" else lambda value: f"{number(value)} operations"
    for row, point in points.iterrows():
        look = style(point.algorithm, point.label)
        axes, y = (strip, 0) if point.error == 0 else (main, point.error)
        size = 5 if crowded else 7
        if look["marker"] == "*":
            size += 3
        mark = {
            "color": look["color"],
            "marker": look["marker"],
            "markersize": size,
            "linestyle": "none",
            "clip_on": False,
        }
        mark |= {"markerfacecolor": "white" if point.scope == "scene" else look["color"], "zorder": 4}
        mark |= {"markeredgewidth": 1.5 if point.scope == "scene" else 0.4}
        mark |= {} if point.scope == "scene" else {"markeredgecolor": "white"}
        gid = f"of:{point.label}"
        titles[gid] = f"{point.label}: error {number(point.error)}, {show(point[cost])}"
        if cost == "time_mean_ns" and known[row]:
            ends = [point.time_mean_low_ns, point.time_mean_high_ns]
            titles[gid] += f" ({duration(ends[0])} to {duration(ends[1])})"
            ends = np.clip(ends, point[cost] / 1e3, point[cost] * 1e3)
            axes.plot(ends, [y, y], color=look["color"], linewidth=1, solid_capstyle="butt", alpha=0.7, zorder=3)
        axes.plot([point[cost]], [y], gid=gid, **mark)
        for marked, shape, wider in ((point.exact, "o", 6), (point.library, "s", 9)):
            if marked:
                ring = {
                    "marker": shape,
                    "markersize": size + wider,
                    "markerfacecolor": "none",
                    "markeredgecolor": "#333333",
                }
                axes.plot([point[cost]], [y], **ring, markeredgewidth=1, linestyle="none", clip_on=False, zorder=3)

    drawn = []
    for algorithm, _, rows in lines:
        drawn += _line(main, points, cost, algorithm, rows)
    drawn += _front(main, strip, points, cost)
    nameless = _name(fig, main, strip, points, cost, drawn, crowded, lines)
    if legend:
        fig.legend(
            handles=legend,
            loc="lower left",
            bbox_to_anchor=(0, 0),
            ncol=3,
            frameon=False,
            fontsize=TEXT,
            handletextpad=0.5,
            columnspacing=1.2,
            labelspacing=0.35,
            borderaxespad=0.3,
            handlelength=1.8,
        )
    return fig, titles, nameless


def _axes(main, strip, points, cost):
    main.set_xscale("log")
    main.set_yscale("log")
    errors, costs = points.error[points.error > 0] if len(points) else [], points[cost] if len(points) else []
    low, high = (min(errors), max(errors)) if len(errors) else (0.1, 1)
    room = max((high / low) ** 0.08, 1.04)
    main.set_ylim(low / room, min(high * room, 1.03) if high <= 1 else high * room)
    low, high = (min(costs), max(costs)) if len(costs) else (1, 10)
    if cost == "time_mean_ns" and (known := _intervals(points)).any():
        # An interval of which nothing is known but its middle reaches from 0 to infinity: it ends at the figure's edge.
        mine = points[known]
        low = min(low, np.maximum(mine.time_mean_low_ns, mine.time_mean_ns / WIDEST).min())
        high = max(high, np.minimum(mine.time_mean_high_ns, mine.time_mean_ns * WIDEST).max())
    room = max((high / low) ** 0.07, 1.25)
    main.set_xlim(low / room, high * room)
    for axis, limits, least, shown in (
        (main.yaxis, main.get_ylim(), 3, lambda v, _: f"{v:g}"),
        (strip.xaxis, main.get_xlim(), 3, lambda v, _: duration(v) if cost == "time_mean_ns" else _short(v)),
    ):
        axis.set_major_locator(log_ticks(limits, least))
        axis.set_major_formatter(shown)
        axis.set_minor_locator(NullLocator())
    main.tick_params(axis="x", length=0, labelbottom=False)
    main.spines["bottom"].set_visible(False)
    main.set_ylabel("error, share of wrong answers (log)", labelpad=2)
    broken = {"marker": [(-1, -0.5), (1, 0.5)], "markersize": 8, "linestyle": "none", "color": "#555555",
        "clip_on": False}
    main.plot([0], [0], transform=main.transAxes, **broken)  # the axis is broken: no logarithmic axis has a 0
    strip.plot([0], [1], transform=strip.transAxes, **broken)
    strip.set_ylim(-1, 1)
    strip.set_yticks([0], ["0"])
    strip.grid(axis="y", visible=False)
    strip.set_facecolor("#F1F6F1")
    strip.set_xlabel(COSTS[cost], labelpad=3)
    if not (len(points) and (points.error == 0).any()):
        strip.text(
            0.99,
            0.5,
            "none is without error",
            transform=strip.transAxes,
            ha="right",
            va="center",
            fontsize=TEXT,
            color="#555555",
        )


def _short(value):
    for unit, letter in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if value >= unit * 0.9995:
            return f"{value / unit:g}{letter}"
    return f"{value:g}"


def log_ticks(limits, least):
    """Ticks of a logarithmic axis: powers of ten; more of them until there are `least`."""
    low, high = limits
    decades = range(int(np.floor(np.log10(low))) - 1, int(np.ceil(np.log10(high))) + 1)
    for steps in ([1], [1, 3], [1, 2, 5], [1, 2, 3, 5, 7], list(range(1, 10)), [x / 10 for x in range(10, 100, 2)]):
        ticks = [step * 10.0**decade for decade in decades for step in steps if low <= step * 10.0**decade <= high]
        if len(ticks) >= least:
            break
    return FixedLocator(ticks)


def _line(axes, points, cost, algorithm, rows):
    """Draws a line through rows with an error; gives its segments in pixels."""
    rows = [row for row in rows if points.error[row] > 0]
    x, y = points[cost][rows].to_numpy(), points.error[rows].to_numpy()
    return _stroke(axes, x, y, color=style(algorithm)["color"], linestyle="-", linewidth=1.3, alpha=0.75, zorder=2)


def _stroke(axes, x, y, **look):
    """Draws a line; gives its segments (x0, y0, x1, y1) in pixels, for labels to keep away from."""
    axes.plot(x, y, **look)
    at = axes.transData.transform(np.column_stack([x, y])) if len(x) else []
    return [(*start, *end) for start, end in zip(at, at[1:])]


def _front(main, strip, points, cost):
    """Draws the staircase through the points of the front; gives its segments in pixels."""
    drawn = []
    worth = points[points.front].sort_values([cost, "error"], ascending=[True, False]) if len(points) else points
    look = {"color": "#333333", "linewidth": 1, "linestyle": (0, (4, 2)), "zorder": 1}
    above = worth[worth.error > 0] if len(worth) else worth
    end = main.get_xlim()[1]
    free = worth[worth.error == 0] if len(worth) else worth
    last = free[cost].min() if len(free) else end
    if len(above):
        x, y = above[cost].to_numpy(), above.error.to_numpy()
        x = [x[0], x[0], *np.repeat(x[1:], 2), last]
        y = [main.get_ylim()[1], *np.repeat(y[:-1], 2), y[-1], y[-1]]
        drawn += _stroke(main, x, y, **look)
    if len(free):
        top = above.error.min() if len(above) else main.get_ylim()[1]
        drawn += _stroke(main, [last, last], [main.get_ylim()[0], top], **look)
        drawn += _stroke(strip, [last, last, end], [1, 0, 0], **look)
    return drawn


def _name(fig, main, strip, points, cost, drawn, crowded, lines):
    """Puts names beside marks, tied by a line of the mark's colour where another mark could be meant; gives the labels
    that found no room."""
    named = set(points.index)
    if crowded:
        ends = [rows[end] for _, _, rows in lines for end in (0, -1)]
        named = set(points.index[points.front | points.exact | points.library]) | set(ends)
    if not named:
        return []
    places = [
        (strip if error == 0 else main).transData.transform((x, error)) for x, error in zip(points[cost], points.error)
    ]
    pixels = np.array(places)
    rows = sorted(named, key=lambda row: (not points.front[row], row))
    texts = shortened(points.label[rows], LONGEST)
    weights = ["bold" if points.front[row] else "normal" for row in rows]
    sizes = np.array([labels.size(texts[points.label[row]], TEXT, weight) for row, weight in zip(rows, weights)])
    box, under = main.get_window_extent(), strip.get_window_extent()
    region = (box.x0 + 2, under.y0 + 1, box.x1 + 6, box.y1 + 4)
    radii = (4.0 if crowded else 5.0) + 2.5 * points.exact.to_numpy() + 2.5 * points.library.to_numpy()
    corners, leaders = labels.place(rows, sizes, region, pixels, radii, drawn)
    to_figure = fig.transFigure.inverted()
    nameless = []
    for row, corner, line, weight in zip(rows, corners, leaders, weights):
        label = points.label[row]
        if np.isnan(corner).any():
            nameless.append(label)
            continue
        look = {"fontsize": TEXT, "fontweight": weight, "color": "#111111", "va": "bottom", "ha": "left"}
        fig.text(*to_figure.transform(corner), texts[label], **look, zorder=6, gid=f"halo:{label}")
        if not np.isnan(line).any():
            ends = to_figure.transform(line.reshape(2, 2))
            colour = style(points.algorithm[row], label)["color"]
            fig.add_artist(Line2D(*ends.T, color=colour, linewidth=0.7, zorder=5, gid=f"of:{label}"))
    return nameless


def _legend(points, crowded, lines):
    """What the marks mean, as far as they occur."""

    def entry(label, **look):
        return Line2D([], [], label=label, **({"linestyle": "none", "color": "#555555", "markersize": 6} | look))

    found = []
    if not len(points):
        return found
    if crowded:
        for algorithm in dict.fromkeys(points.algorithm):
            look = style(algorithm)
            found.append(entry(algorithm, **look | {"linestyle": "none"}))
    if (points.scope == "pair").any():
        found.append(entry("filled: visits every pair", marker="o"))
    if (points.scope == "scene").any():
        found.append(entry("hollow: whole scene", marker="o", markerfacecolor="white", markeredgewidth=1.5))
    if points.exact.any():
        found.append(
            entry(
                "ring: promises exactness", marker="o", markersize=8, markerfacecolor="none", markeredgecolor="#333333"
            )
        )
    if points.library.any():
        found.append(
            entry(
                "square: another library", marker="s", markersize=8, markerfacecolor="none", markeredgecolor="#333333"
            )
        )
    if points.front.any():
        found.append(entry("Pareto front (bold names)", linestyle=(0, (4, 2)), linewidth=1, color="#333333"))
    if lines:
        found.append(entry("one knob, all else equal", linestyle="-", linewidth=1.3))
    return found
