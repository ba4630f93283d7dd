"""How early or late each algorithm reports, obstacle by obstacle: section 5.3 of the thesis as maps."""

import numpy as np
import pandas as pd
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Rectangle

from ..tables import thresholds as t
from .drawing import NotDrawn, caption, key, shortened
from .figure import Figure, figure, svg_of
from ..words import counted, listed, verb

# Late is orange, early is purple (ColorBrewer's PuOr, told apart by colour-blind readers); the words' own steps.
EDGES = [-np.inf, -t.TOO_EARLY_M, -t.SLIGHT_M, -t.EXACT_M, t.EXACT_M, t.SLIGHT_M, t.TOO_EARLY_M, np.inf]
COLOURS = ["#E08214", "#FDB863", "#FEE0B6", "#F7F7F7", "#D8DAEB", "#B2ABD2", "#8073AC"]
SILENT = "#4D4D4D"
MOST_COLUMNS = 14
FLICKER = ["#FFFFFF", "#DEEBF7", "#9ECAE1", "#4292C6", "#08519C"]


def outcomes(passes, by):
    """One row per algorithm and value of `by` (columns of `passes`), in order of appearance.

    Columns: passes; touching (that truly meet); missed (of those, never reported); false positives (reported though
    they never meet); first m, last m (medians over those that meet and are reported: how far before the exact contact,
    less than 0 after it; NaN for none); flicker (changes of the answer within contacts).
    """
    touching = passes.truth_first.notna()
    seen = touching & passes["first"].notna()
    table = passes.assign(
        touching=touching,
        missed=touching & ~seen,
        reports=~touching & (passes.reported > 0),
        first_m=passes["first"].where(seen),
        last_m=passes["last"].where(seen),
    )
    grouped = table.groupby(["algorithm", *by], sort=False, observed=True)
    sums = grouped[["touching", "missed", "reports", "flicker"]].sum().astype(int)
    sums.insert(0, "passes", grouped.size())
    sums[["first m", "last m"]] = grouped[["first_m", "last_m"]].median()
    return sums.rename(columns={"reports": "false positives"})


def passes_of(run):
    if run.passes is None or run.passes.empty:
        raise NotDrawn("the file has no passes of a hero through obstacles")
    return run.passes


def kinds(passes):
    """The passes, each once for its path and once for how the hero lies and whether it goes through the middle."""
    off = np.where(passes.offset == 0, "middle", "off centre")
    parts = [
        passes.assign(kind="path " + passes.path.astype(str)),
        passes.assign(kind=passes.orientation.astype(str).to_numpy() + ", " + off),
    ]
    few = [part for part in parts if part.kind.nunique() <= MOST_COLUMNS]
    if not few:
        raise NotDrawn(f"there are more than {MOST_COLUMNS} paths and more than that many kinds of pass")
    return pd.concat(few, ignore_index=True)


def contact_map(run, _, name):
    """Obstacle by algorithm: metres early or late, misses and false positives."""
    passes = passes_of(run)
    cells = outcomes(passes, ["target"])
    overall = outcomes(passes, [])
    what = "Columns are obstacles."
    return drawn_map(run, cells, title_of(overall), what, name)


def kind_map(run, _, name):
    """Kind of pass by algorithm."""
    passes = passes_of(run)
    cells = outcomes(kinds(passes), ["kind"])
    missed = cells.missed.groupby(level="kind", sort=False).sum()
    touching = cells.touching.groupby(level="kind", sort=False).sum()
    share = (missed / touching.where(touching > 0)).dropna()
    if share.empty:
        title = "No pass of any kind meets its obstacle"
    elif share.max() == 0:
        title = "No kind of pass is ever missed"
    else:
        worst, best = share.idxmax(), share.idxmin()
        title = f"Passes of the kind “{worst}” are missed most, {share[worst]:.0%} over all algorithms"
        title += f"; “{best}” least, {share[best]:.0%}" if share[best] < share[worst] else ""
    what = (
        "Columns are kinds of pass over all obstacles, each pass counted once by its path and once by how the hero "
        "lies (its own axis along the path or across) and whether it goes through the middle."
    )
    return drawn_map(run, cells, title, what, name)


def title_of(overall):
    """overall: outcomes over all obstacles. What is earliest, misses most, has most false positives and is exact."""
    if not overall.touching.any():
        return "No pass meets its obstacle, so nothing can be early or late"
    first = overall["first m"].dropna()
    parts = []
    if not first.empty and first.max() > t.EXACT_M:
        parts.append(f"{first.idxmax()} is earliest (median {first.max():+.2f} m)")
    worst = overall.missed.idxmax()
    if overall.missed[worst]:
        parts.append(f"{worst} misses most ({overall.missed[worst]} of {overall.touching[worst]} passes that meet)")
    else:
        parts.append("no algorithm misses a pass that meets")
    worst = overall["false positives"].idxmax()
    apart = overall.passes - overall.touching
    if overall["false positives"][worst]:
        same = int((overall["false positives"] == overall["false positives"][worst]).sum()) - 1
        parts.append(
            f"{worst}{f' and {same} more' if same else ''} {verb(same + 1, 'has', 'have')} the most false positives "
            f"({overall['false positives'][worst]} of {apart[worst]} passes that do not meet)"
        )
    right = overall.index[(overall.missed == 0) & (overall["false positives"] == 0)]
    parts.append(f"neither miss nor false positive: {listed(right)}" if len(right) else "none is free of both")
    return "; ".join(parts)


def drawn_map(run, cells, title, what, name):
    """cells: outcomes by one column. A map algorithm by that column, numbers in the cells."""
    columns = list(cells.index.get_level_values(1).unique())
    cells = cells.loc[cells.index.get_level_values(1).isin(columns[:MOST_COLUMNS])]
    more = f" The first {MOST_COLUMNS} of {len(columns)} columns." if len(columns) > MOST_COLUMNS else ""
    columns, labels = columns[:MOST_COLUMNS], list(cells.index.get_level_values(0).unique())
    fig, axes = grid(run, labels, columns)
    norm, colours = BoundaryNorm(EDGES[1:-1], len(COLOURS), extend="both"), ListedColormap(COLOURS)
    for row, label in enumerate(labels):
        for column, at in enumerate(columns):
            cell = cells.loc[(label, at)] if (label, at) in cells.index else None
            if cell is None:
                continue
            first, errors = cell["first m"], []
            if cell.missed:
                errors.append(f"m{cell.missed:.0f}")
            if cell["false positives"]:
                errors.append(f"f{cell['false positives']:.0f}")
            if not np.isnan(first):
                face, text, ink = colours(norm(first)), metres(first), "black"
                ink = "white" if abs(first) > t.TOO_EARLY_M and first > 0 else "black"
            elif cell.touching:
                face, text, ink = SILENT, "never", "white"
            else:
                face, text, ink = "white", "–", "#777777"
            axes.add_patch(Rectangle((column, row), 1, 1, facecolor=face, edgecolor="white", linewidth=1.5))
            words = {"ha": "center", "va": "center", "color": ink}
            axes.text(column + 0.5, row + (0.34 if errors else 0.5), text, fontsize=8.5, **words)
            axes.text(column + 0.5, row + 0.76, " ".join(errors), fontsize=7.5, weight="bold", **words)
    legend(fig, COLOURS, [f"{edge:+g}".replace("-", "−") for edge in EDGES[1:-1]], "late  ←  first report, m  →  early")
    text = (
        "First report in metres before (+) or after (−) the exact first contact, median over the passes that meet and "
        "are reported; m: passes that meet and are never reported (misses), f: passes that never meet and are reported "
        f"(false positives); “never”: all are missed; “–”: no pass meets. {what} n = {passes_of(run).number.nunique()} "
        f"passes and {len(labels)} algorithms.{more}"
    )
    table = cells.drop(columns="flicker").reset_index()
    return Figure(title, svg_of(fig), caption(run, text, "section 5.3", times=False), table, name)


def metres(value):
    """Two digits or three; what rounds to nothing has no sign."""
    if abs(value) < 0.005:
        return "0"
    text = f"{value:+.2f}" if abs(value) < 0.995 else f"{value:+.1f}" if abs(value) < 9.95 else f"{value:+.0f}"
    return text.replace("-", "−")


def flicker_map(run, _, name):
    """Obstacle by algorithm: how often the answer changes while both samples truly meet."""
    passes = passes_of(run)
    cells = outcomes(passes, ["target"])
    overall = outcomes(passes, [])
    columns, labels = list(cells.index.get_level_values(1).unique())[:MOST_COLUMNS], list(overall.index)
    cells = cells.loc[cells.index.get_level_values(1).isin(columns)]
    fig, axes = grid(run, labels, columns)
    edges = [1, 5, 10, 20]
    for row, label in enumerate(labels):
        for column, at in enumerate(columns):
            changes = int(cells.flicker.get((label, at), 0))
            level = int(np.searchsorted(edges, changes, side="right"))
            axes.add_patch(Rectangle((column, row), 1, 1, facecolor=FLICKER[level], edgecolor="#DDDDDD", linewidth=0.7))
            axes.text(column + 0.5, row + 0.5, str(changes) if changes else "·", ha="center", va="center", fontsize=8,
                      color="white" if level > 2 else "black")
    legend(fig, FLICKER, [str(edge) for edge in edges], "changes of the answer within contacts")
    changes = overall.flicker
    still = changes.index[changes == 0]
    if not overall.touching.any():
        title = "No pass meets its obstacle, so no answer can flicker"
    elif not changes.any():
        title = "No algorithm's answer changes within a contact"
    else:
        worst = changes.idxmax()
        title = f"{worst} flickers most, {counted(changes[worst], 'change')} within {overall.touching[worst]} passes "
        title += "that meet; "
        few = len(still)
        title += (f"{few or 'none'} of {len(labels)} algorithms never {verb(few or 1, 'changes its', 'change their')} "
                  "answer within a contact")
    text = (
        "Changes of an algorithm's answer between neighbouring samples that both truly meet, over all passes through "
        f"an obstacle; n = {passes.number.nunique()} passes and {len(labels)} algorithms. One that never reports never "
        "flickers: see the misses above."
    )
    table = cells.flicker.unstack(1)[columns]
    table.insert(0, "all", changes)
    return Figure(title, svg_of(fig), caption(run, text, "section 5.3", times=False), table, name)


def grid(run, labels, columns):
    """Empty axes, a unit square per cell, rows from the top; names at the left and on top."""
    fig, axes = figure(height=0.36 * len(labels) + 1.75)
    axes.set(xlim=(0, len(columns)), ylim=(len(labels), 0))
    axes.set_xticks(np.arange(len(columns)) + 0.5, shortened(map(str, columns), 18).values(), rotation=60,
                    ha="left", rotation_mode="anchor")
    axes.xaxis.tick_top()
    named = [f"{key(run, label)} {text}".strip() for label, text in shortened(labels, 24).items()]
    axes.set_yticks(np.arange(len(labels)) + 0.5, named)
    for text, label in zip(axes.get_yticklabels(), labels):
        text.set_gid(f"row:{label}")
    axes.tick_params(length=0, labelsize=8)
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    return fig, axes


def legend(fig, colours, edges, words):
    """A strip of the colours below the figure, with the numbers between them."""
    strip = fig.add_axes((0.45, 0.0, 0.5, 0.0))
    strip.set_in_layout(False)
    height = 12 / (72 * fig.get_figheight())
    strip.set_position((0.42, 2.0 * height, 0.55, height))
    for i, colour in enumerate(colours):
        strip.add_patch(Rectangle((i, 0), 1, 1, facecolor=colour, edgecolor="#BBBBBB", linewidth=0.5))
    strip.set(xlim=(0, len(colours)), ylim=(0, 1), yticks=[])
    strip.set_xticks(range(1, len(colours)), edges)
    strip.set_title(words, fontsize=8, pad=3)
    strip.tick_params(length=0, labelsize=8)
    strip.grid(visible=False)
    strip.spines[:].set_visible(False)
    fig.get_layout_engine().set(rect=(0, 4.6 * height, 1, 1 - 4.6 * height))


FIGURES = [
    ("First report by obstacle", contact_map),
    ("First report by kind of pass", kind_map),
    ("Flicker", flicker_map),
]
