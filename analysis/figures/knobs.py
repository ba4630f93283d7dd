"""What knobs do: a figure per algorithm of error against time over its settings, and a matrix of filter and method."""

import json

import numpy as np
import pandas as pd

from . import labels
from .drawing import guarded, log_seconds, shortened
from .figure import PALETTE, Figure, Section, figure, style, svg_of
from ..tables import pareto
from ..words import counted, duration, listed, number

LEAST = 3  # settings of an algorithm that make a figure
NAMED = 26  # settings whose names stand in the figure
LINES = ["vermilion", "blue", "moss", "purple", "orange", "indigo", "teal", "brown"]


def sections(found):
    """Per scene that has several settings of an algorithm."""
    sections_ = []
    for index, scene in enumerate(found, 1):
        parts = []
        machines = scene.points.machine.value_counts()
        points = scene.points[scene.points.machine == machines.index[0]] if len(machines) else scene.points
        points = points[np.isfinite(points.error) & np.isfinite(points.time_mean_ns) & (points.time_mean_ns > 0)]
        for algorithm, mine in points.groupby("algorithm", sort=False):
            if len(mine) >= LEAST and varied(mine):
                parts.append(guarded(f"Knobs of {algorithm}", one, scene, algorithm, mine.reset_index(drop=True),
                    points,
                                     f"knobs-{index}-{algorithm}"))
        if len(combinations(points)) >= LEAST:
            parts.append(guarded("Filter and method", matrix, scene, points, f"filters-{index}"))
        if parts:
            sections_.append(Section("Knobs and combinations", parts, scene.title))
    return sections_


def varied(points):
    """The knobs that take several values, in their order."""
    names = dict.fromkeys(name for knobs in points.knobs for name in knobs)
    return [name for name in names if len({json.dumps(knobs.get(name)) for knobs in points.knobs}) > 1]


def along(points):
    """Lines of rows that differ in one knob alone, a number or yes and no: (knob, rows in the knob's order). Texts
    have no
    order."""
    found = []
    for knob in varied(points):
        if not all(isinstance(knobs.get(knob), (int, float)) for knobs in points.knobs):
            continue
        groups = {}
        for row, knobs in points.knobs.items():
            rest = json.dumps({name: value for name, value in knobs.items() if name != knob}, sort_keys=True)
            groups.setdefault(rest, {}).setdefault(knobs[knob], row)
        found += [(knob, [group[value] for value in sorted(group)]) for group in groups.values() if len(group) > 1]
    return found


def usual(points):
    """The settings from which the others differ least: those of most labels, knob by knob."""
    base = {}
    for knob in varied(points):
        values = pd.Series([json.dumps(knobs.get(knob)) for knobs in points.knobs])
        base[knob] = json.loads(values.mode().iloc[0] if len(values.mode()) == 1 else values.iloc[0])
    return base


def setting(knobs, base):
    """"stride 5, densify" of knobs that are not as `base`; "usual" of none."""
    words = []
    for name, value in base.items():
        if (mine := knobs.get(name)) != value:
            words.append(name if mine is True else f"no {name}" if mine is False else f"{name} {mine}")
    return ", ".join(words) or "usual"


def best_sentence(points, best):
    varied_ = varied(points)
    chosen = ", ".join(f"{name} = {json.dumps(points.knobs[best].get(name))}" for name in varied_).replace('"', "")
    return f"{chosen}: error {number(points.error[best])} at {duration(points.time_mean_ns[best])} a step"


def exact_of(points):
    """The quickest label that promises exactness and makes no error, or None."""
    right = points[points.exact & (points.error == 0)]
    return right.loc[right.time_mean_ns.idxmin()] if len(right) else None


def one(scene, algorithm, points, others, key):
    """Error against time of the settings of one algorithm."""
    best = int(points.error.idxmin())
    even = points[points.error == points.error[best]]
    best = int(even.time_mean_ns.idxmin())
    exact, base, lines = exact_of(others), usual(points), along(points)
    front = pareto.front(points.time_mean_ns, points.error)
    fig, axes = figure(height=4.4)
    knobs = varied(points)
    colours = {knob: PALETTE[LINES[i % len(LINES)]] for i, knob in enumerate(knobs)}
    handles = {}
    for knob, rows in lines:
        (handles[knob],) = axes.plot(points.time_mean_ns[rows] / 1e9, points.error[rows], color=colours[knob],
            linewidth=1.2,
                                     alpha=0.8, zorder=2, label=f"along {knob}")
    titles = {}
    for row, point in points.iterrows():
        look, gid = style(point.algorithm, point.label), f"of:{point.label}"
        titles[gid] = (f"{point.label}: {setting(point.knobs, base)}; error {number(point.error)}, "
                       f"{duration(point.time_mean_ns)}, {number(point.false_negative)} missed")
        axes.plot([point.time_mean_ns / 1e9], [point.error], marker=look["marker"], color=look["color"],
            linestyle="none",
                  markersize=9 if row == best else 6, gid=gid, zorder=4)
    if exact is not None:
        axes.axvline(exact.time_mean_ns / 1e9, color=PALETTE["black"], linestyle=(0, (4, 2)), linewidth=1)
        axes.text(exact.time_mean_ns / 1e9, 0.02, f" {exact.label}: no "
                                                  "error", fontsize=9, transform=axes.get_xaxis_transform(),
                  gid=f"halo:{exact.label}")
    log_seconds(axes, "x")
    low, high = axes.get_xlim()
    axes.set_xlim(low / 1.3, high * 1.3)
    axes.set_ylim(0, min(1.03, max(points.error) * 1.12 + 0.02))
    axes.set_xlabel("mean time per step (log)")
    axes.set_ylabel("error, share of wrong answers")
    if handles:
        axes.legend(handles=list(handles.values()), loc="upper center", bbox_to_anchor=(0.5, 1.14), ncol=4, fontsize=9,
                    frameon=False)
    drawn = [row for row in points.index if len(points) <= NAMED or front[row] or row == best]
    name_marks(fig, axes, points, drawn, [setting(points.knobs[row], base) for row in drawn])
    text = ", ".join(f"{name} {json.dumps(value)}" for name, value in base.items()).replace('"', "")
    title = f"{algorithm}: best is {best_sentence(points, best)}"
    if exact is not None:
        title += f"; {exact.label} makes none at {duration(exact.time_mean_ns)}"
    table = pd.DataFrame({"label": points.label}
                         | {name: [str(knobs.get(name)) for knobs in points.knobs] for name in knobs}
                         | {"error": points.error, "false negatives": points.false_negative.astype("int64"),
                            "false positives": points.false_positive.astype("int64"),
                            "mean time (µs)": points.time_mean_ns / 1e3, "on the front": front})
    caption = (
        f"{scene.title}: {counted(len(points), 'setting')} of {algorithm}; lines join settings that differ in one knob "
        f"alone; names say in what a setting differs from the usual ({text}). The dashed line is the price of no error."
    )
    return Figure(title, svg_of(fig, titles), caption, table.sort_values("error", ignore_index=True), key)


def name_marks(fig, axes, points, rows, texts):
    """Names beside marks, tied as in the figure of all labels."""
    fig.draw_without_rendering()
    box = axes.get_window_extent()
    marks = axes.transData.transform(np.column_stack([points.time_mean_ns / 1e9, points.error]))
    short = list(shortened(texts, 40).values()) if len(set(texts)) == len(texts) else texts
    sizes = np.array([labels.size(text, 8.5) for text in short]).reshape(-1, 2)
    put, leaders = labels.place(rows, sizes, (box.x0, box.y0 + 12, box.x1, box.y1), marks, np.full(len(marks), 4.5), [])
    back = fig.transFigure.inverted()
    for row, text, corner, line in zip(rows, short, put, leaders):
        if np.isnan(corner).any():
            continue
        label = points.label[row]
        fig.text(*back.transform(corner), text, fontsize=8.5, va="bottom", ha="left", gid=f"halo:{label}")
        if not np.isnan(line).any():
            fig.add_artist(_tie(back.transform(line.reshape(2, 2)), style(points.algorithm[row], label)["color"],
                label))


def _tie(ends, colour, label):
    from matplotlib.lines import Line2D

    return Line2D(*ends.T, color=colour, linewidth=0.7, gid=f"of:{label}")


# ---- Filter and method


def combinations(points):
    """Rows (filter, method, row of points): of each method with a prefilter its labels that differ in nothing else
    from its
    usual settings; of several the first."""
    found = {}
    for algorithm, mine in points.groupby("algorithm", sort=False):
        mine = mine[[("prefilter" in knobs) for knobs in mine.knobs]]
        rests = pd.Series({row: json.dumps({name: value for name, value in knobs.items() if name != "prefilter"},
                                           sort_keys=True) for row, knobs in mine.knobs.items()}, dtype=object)
        if mine.empty or rests.value_counts().iloc[0] < 2:
            continue
        usual_ = rests.value_counts().index[0]
        for row in rests.index[rests == usual_]:
            found.setdefault((points.knobs[row]["prefilter"], algorithm), row)
    return found


def matrix(scene, points, key):
    """Error and time of every filter before every method."""
    points = points.drop_duplicates("label").reset_index(drop=True)
    found = combinations(points)
    filters = list(dict.fromkeys(before for before, _ in found))
    methods = list(dict.fromkeys(method for _, method in found))
    alone = {name: points.index[points.label == name][0] for name in filters if (points.label == name).any()}
    exact = exact_of(points)
    unknown = {"none": -1}  # nothing before is the quickest
    filters.sort(key=lambda name: points.time_mean_ns[alone[name]] if name in alone else unknown.get(name, np.inf))
    columns = [*methods, "(filter alone)"]
    fig, axes = figure(height=0.42 * len(filters) + 1.5)
    axes.set(xlim=(0, len(columns)), ylim=(len(filters), 0))
    rows, titles = [], {}
    import matplotlib.pyplot as plt
    from matplotlib.patches import Rectangle

    colours = plt.get_cmap("viridis_r")
    for y, before in enumerate(filters):
        for x, method in enumerate(columns):
            row = alone.get(before) if method == "(filter alone)" else found.get((before, method))
            if row is None:
                continue
            point = points.loc[row]
            shade = colours(float(np.clip(point.error, 0, 1)))
            ink = "white" if point.error > 0.45 else "black"
            gid = f"of:{point.label}"
            titles[gid] = f"{point.label}: error {number(point.error)}, {duration(point.time_mean_ns)}"
            axes.add_patch(Rectangle((x, y), 1, 1, facecolor=shade, edgecolor="white", linewidth=1.5, gid=gid))
            axes.text(x + 0.5, y + 0.36, f"{point.error:.3f}", ha="center", va="center", fontsize=9, color=ink)
            axes.text(x + 0.5, y + 0.72, duration(point.time_mean_ns), ha="center", va="center", fontsize=8, color=ink)
            rows.append((before, method, point.label, point.error, point.time_mean_ns / 1e3, int(point.false_negative),
                         int(point.false_positive)))
    axes.set_xticks(np.arange(len(columns)) + 0.5, shortened(columns, 18).values(), rotation=30, ha="left",
                    rotation_mode="anchor")
    axes.xaxis.tick_top()
    axes.set_yticks(np.arange(len(filters)) + 0.5, shortened(filters, 24).values())
    axes.set_ylabel("filter, the quickest first")
    axes.tick_params(length=0)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    table = pd.DataFrame(rows, columns=["filter", "method", "label", "error", "mean time (µs)", "false negatives",
                                        "false positives"]).sort_values("error", ignore_index=True)
    pairs = table[table.method != "(filter alone)"]
    best = pairs.iloc[0]
    title = (
        f"Best pair: {best['filter']} before {best['method']}, error {number(best.error)} at "
        f"{number(best['mean time (µs)'])} µs"
    )
    said = [best.label]
    for limit in (0.3, 0.1, 0.01):
        ok = pairs[(pairs.error < limit)]
        if not len(ok):
            title += f"; none errs less than {limit:g}"
            break
        quick = ok.loc[ok["mean time (µs)"].idxmin()]
        if quick.label not in said:
            said.append(quick.label)
            title += (
                f"; quickest below {limit:g}: {quick['filter']} before {quick['method']}, "
                f"{number(quick['mean time (µs)'])} µs"
            )
    if exact is not None:
        title += f"; {exact.label} makes no error at {duration(exact.time_mean_ns)}"
    caption = (
        f"{scene.title}: {counted(len(pairs), 'pair')} of {counted(len(filters), 'filter')} and "
        f"{counted(len(methods), 'method')}. A cell: error (its colour, dark is worse) and mean time of a step; "
        f"“none”: no filter. Methods: {listed(methods)}, each with its usual knobs."
    )
    return Figure(title, svg_of(fig, titles), caption, table, key)
