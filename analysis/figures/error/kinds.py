"""The two kinds of error apart: misses and false positives, precision against recall."""

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D

from ...words import counted, number, verb
from .. import labels
from ..drawing import shortened
from ..figure import FALSE_POSITIVE, Figure, MISSED, figure, style, svg_of
from .against import LONGEST, NAMED, TEXT


def trade(scene, key):
    """The figure of precision against recall: no misses first."""
    points = scene.points.reset_index(drop=True)
    points = points[points.recall.notna() & points.precision.notna()] if {"recall",
        "precision"} <= set(points) else points[:0]
    table = pd.DataFrame({
        "label": points.label, "recall": points.get("recall"), "precision": points.get("precision"),
        "missed": points.false_negative.astype("int64"), "false positives": points.false_positive.astype("int64"),
        "mean time (µs)": points.time_mean_ns / 1e3, "promise": points.promise,
    }).sort_values(["missed", "mean time (µs)"], ignore_index=True)
    fig, axes = figure(height=4.2)
    axes.set(xlim=(-0.02, 1.03), ylim=(-0.02, 1.03), xlabel="recall: share of meeting pairs that are found",
             ylabel="precision: share of hits that are right")
    axes.axvline(1, color="#999999", linewidth=0.8, linestyle=(0, (4, 2)))
    titles = {}
    for _, point in points.iterrows():
        look = style(point.algorithm, point.label)
        gid = f"of:{point.label}"
        titles[gid] = f"{point.label}: recall {number(point.recall)}, precision {number(point.precision)}"
        axes.plot([point.recall], [point.precision], **look | {"linestyle": "none"}, gid=gid, clip_on=False)
    if len(points):
        box = axes.get_window_extent()
        fig.draw_without_rendering()
        box = axes.get_window_extent()
        marks = axes.transData.transform(points[["recall", "precision"]].to_numpy(dtype=float))
        safe = np.flatnonzero(points.recall.to_numpy() == 1)
        few = list(range(len(points)) if len(points) <= NAMED else safe[:NAMED])
        texts = shortened(points.label.iloc[few], LONGEST)
        sizes = np.array([labels.size(texts[points.label.iloc[i]], TEXT) for i in few]).reshape(-1, 2)
        put, leaders = labels.place(few, sizes, (box.x0, box.y0, box.x1, box.y1), marks, np.full(len(marks), 5.0), [])
        back = fig.transFigure.inverted()
        for i, corner, line in zip(few, put, leaders):
            label = points.label.iloc[i]
            if np.isnan(corner).any():
                continue
            fig.text(*back.transform(corner), texts[label], fontsize=TEXT, va="bottom", ha="left", gid=f"halo:{label}")
            if not np.isnan(line).any():
                ends = back.transform(line.reshape(2, 2))
                colour = style(points.algorithm.iloc[i], label)["color"]
                fig.add_artist(Line2D(*ends.T, color=colour, linewidth=0.7, gid=f"of:{label}"))
    caption = (
        f"{scene.title}: {counted(len(points), 'label')}. On the dashed line nothing is missed: whoever may miss "
        "nothing chooses there, the higher the fewer false positives; times stand in the table, which has those that "
        "miss nothing first."
    )
    return Figure(_trade_finding(table), svg_of(fig, titles), caption, table, key)


def _trade_finding(table):
    if not len(table):
        return "No label has both a precision and a recall"
    safe = table[table.missed == 0]
    if not len(safe):
        best = table.iloc[0]
        return f"Every label misses something; {best.label} least, {counted(best.missed, 'pair')}"
    best = safe.loc[safe.precision.idxmax()]
    words = f"No misses first: {counted(len(safe), 'label')} {verb(len(safe), 'misses', 'miss')} nothing; "
    words += f"{best.label} has the "
    words += f"fewest false positives of them, {number(best['false positives'])}"
    timed = safe[safe["mean time (µs)"].notna()]
    if best.label not in set(timed.label):
        return words
    quick = timed.loc[timed["mean time (µs)"].idxmin()]
    words += f", at {number(best['mean time (µs)'])} µs"
    if quick.label != best.label:
        words += (
            f"; {quick.label} is the quickest, {number(quick['mean time (µs)'])} µs with "
            f"{number(quick['false positives'])}"
        )
    return words


def kinds(scene, key):
    """The figure of both kinds of error: the share of true pairs that is missed, and false reports per true pair."""
    points = scene.points.sort_values(["error", "time_mean_ns"]).reset_index(drop=True)
    met = float(scene.runs[0].truth_hits.sum())
    table = pd.DataFrame({
        "label": points.label,
        "missed (% of what meets)": points.false_negative / met * 100 if met else np.nan,
        "false positives per pair that meets": points.false_positive / met if met else np.nan,
        "false negatives": points.false_negative.astype("int64"),
        "false positives": points.false_positive.astype("int64"),
        "error": points.error,
    })
    drawn = table.iloc[:NAMED]
    rest = (
        ""
        if len(drawn) == len(table)
        else f" The {NAMED} with the smallest error of {len(table)} are drawn, all are below."
    )
    caption = (
        f"{scene.title}: {counted(len(table), 'label')}, the smallest error first; {number(met)} pairs truly meet over"
        f" all steps.{rest}"
    )
    missed = drawn["missed (% of what meets)"] if met else drawn["false negatives"]
    reported = drawn["false positives per pair that meets"] if met else drawn["false positives"]
    fig, (left, right) = figure(1, 2, height=0.75 + 0.2 * max(len(drawn), 3), sharey=True)
    rows = np.arange(len(drawn))[::-1]
    for axes, values, colour, words in (
        (left, missed, MISSED, "missed, % of what meets" if met else "missed"),
        (right, reported, FALSE_POSITIVE, "false positives per pair that meets" if met else "false positives"),
    ):
        for bar, label in zip(axes.barh(rows, values, color=colour, height=0.72), drawn.label):
            bar.set_gid(f"of:{label}")
        axes.set_xlabel(words)
        axes.grid(axis="y", visible=False)
        axes.set_xlim(0, (values.max() or 1) * 1.22)
        for row, value in zip(rows, values):
            axes.text(value, row, f" {number(value)}", va="center", fontsize=9, color="#111111" if value else "#767676")
        axes.tick_params(axis="y", length=0)
        axes.locator_params(axis="x", nbins=4)
    left.set_yticks(rows, shortened(drawn.label, LONGEST).values())
    left.set_ylim(-0.6, len(drawn) - 0.4)
    return Figure(_kinds_finding(points, met), svg_of(fig), caption, table, key)


def _kinds_finding(points, met):
    if not met:
        silent = (points.hits == 0).sum()
        return (f"No pair meets; {silent or 'none'} of {len(points)} {verb(silent or 1, 'reports', 'report')} none "
                "either")
    none_missed, none_false = (points.false_negative == 0).sum(), (points.false_positive == 0).sum()
    misses = points.loc[points.false_negative.idxmax()]
    most = points.loc[points.false_positive.idxmax()]
    words = (f"{none_missed or 'None'} of {len(points)} {verb(none_missed or 1, 'misses', 'miss')} nothing, "
             f"{none_false or 'none'} {verb(none_false or 1, 'has', 'have')} no false positive")
    if misses.false_negative:
        words += f"; {misses.label} misses most, {number(misses.false_negative / met * 100)} % of what meets"
    if most.false_positive:
        words += (f"; {most.label} has the most false positives, {number(most.false_positive / met)} for every pair "
                  "that meets")
    return words
