"""Sections of the report on the extremes of the answers: errors by signed gap, offset, scale and shape; instability."""

import numpy as np
import pandas as pd
from matplotlib.patches import Patch

from ..tables import extremes, pareto
from .drawing import guarded, shortened, source
from .figure import FALSE_POSITIVE, MISSED, Figure, Section, Table, figure, slug, space, svg_of
from .heat_map import draw_map, heads_of
from ..words import listed, number, verb

# An error that differs by less over a thing may do so by chance: in configs/extremes.toml errors of one half of the
# random orientations of an offset differ by up to 0.053 from those of the other.
MATTERS = 0.1
SHADE = "#F1ECDD"  # of the classes within rounding of touching
# Share of wrong answers -> colour of its cell; from good to bad also from light to dark.
STEPS = [(0, "#FFFFFF"), (0.01, "#E3EEF6"), (0.1, "#BBD7EA"), (0.3, "#F9DDA4"), (0.6, "#F0B35A"), (1, "#D9822B")]
FAILED = "#3D3D3D"


def sections(runs):
    """A section for each run of `runs` with a scene of extremes."""
    found = []
    for count, run in enumerate(runs):
        if getattr(run, "extremes", None) is None:
            continue
        key = f"extremes-{count}-{slug(pareto.name(run))}"
        parts = [guarded("Error by signed gap", gap_figure, run, f"{key}-gap")]
        for word, unit, table in (("offset", "m", extremes.error_by_offset), ("scale", "m", extremes.error_by_scale),
                                  ("shape", "", extremes.error_by_shape)):
            parts.append(guarded(f"Error by {word}", by_figure, run, word, unit, table, f"{key}-{word}"))
        parts.append(guarded("Instability", instability_table, run))
        found.append(Section(f"{pareto.title(run)}: where answers fail", parts, pareto.title(run)))
    return found


def gap_shares(run):
    """The share of wrong answers by algorithm and class of gap, near touching apart.

    Rows as of extremes.error_by_gap, as columns; wrong: false positives and false negatives over the cases that did not
    fail (NaN where all failed); missed, false positive: its two parts. The contract's error is 0 or 1 where nothing
    meets, so it would say nothing of a class of gaps.
    """
    table = extremes.error_by_gap(run).reset_index()
    said = (table["cases"] - table["failed"]).where(lambda n: n > 0)
    return table.assign(missed=table["false_negative"] / said, **{"false positive": table["false_positive"] / said})


def gap_classes(table):
    """(class, whether it is of ulps), from deep inside to far apart: decades, ulps around 0, decades."""
    names = list(dict.fromkeys(table["gap_class"]))

    def place(name):
        value, ulps = name.removesuffix(" ulp"), name.endswith(" ulp")
        value = float(value.replace("−", "-"))
        return (value, 0.0) if not ulps else (0.0, value)

    def order(name):
        decade, ulps = place(name)
        return (0, decade, 0) if decade < 0 else (2, decade, 0) if decade > 0 else (1, 0, ulps)

    return [(name, name.endswith(" ulp")) for name in sorted(names, key=order)]


def drawn_classes(table):
    """Of every class the rows that are drawn: those near touching of a class of ulps, the others of a decade."""
    ulps = table["gap_class"].str.endswith(" ulp")
    return table[ulps == table["near_touching"]]


def gap_figure(run, key):
    """A row per algorithm, a column per class of gap; bars of what is missed and of false positives."""
    table = gap_shares(run)
    shown, classes = drawn_classes(table), gap_classes(table)
    labels = [label for label in run.meta["algorithms"] if label in set(table["algorithm"])]
    fig, ax = figure(height=0.42 * len(labels) + 1.9)
    near = [i for i, (_, ulps) in enumerate(classes) if ulps]
    if near:
        ax.axvspan(near[0] - 0.5, near[-1] + 0.5, color=SHADE, linewidth=0, zorder=0)
    place = {name: i for i, (name, _) in enumerate(classes)}
    for row, label in enumerate(labels):
        base = len(labels) - 1 - row
        mine = shown[shown["algorithm"] == label]
        x = mine["gap_class"].map(place).to_numpy(float)
        foot = np.full(len(mine), float(base))
        for column, colour in (("missed", MISSED), ("false positive", FALSE_POSITIVE)):
            # A share too small to be seen is given a visible foot: nothing wrong is told from little.
            height = mine[column].fillna(0).to_numpy(float)
            height = np.where(height > 0, np.maximum(0.82 * height, 0.05), 0)
            ax.bar(x, height, 0.92, bottom=foot, color=colour, linewidth=0)
            foot = foot + height
        silent = mine["wrong"].isna().to_numpy()
        ax.plot(x[silent], np.full(silent.sum(), base + 0.35), "x", color="#333333", markersize=4)
        ax.axhline(base, color="#999999", linewidth=0.6)
    every = [i for i, (name, ulps) in enumerate(classes) if ulps or i in (0, len(classes) - 1)
             or (name.lstrip("+-").startswith("1e-") and int(name.split("e-")[1]) % 3 == 0)]
    ax.set_xticks(every, [classes[i][0].replace(" ulp", " u").replace("-", "−") for i in every], rotation=90)
    ax.set_yticks([len(labels) - 1 - row + 0.4 for row in range(len(labels))], shortened(labels).values())
    ax.set(xlim=(-0.6, len(classes) - 0.4), ylim=(-0.05, len(labels)), xlabel="signed gap: inside ←  → apart (of the "
                                                                              "scale; u: ulps)")
    ax.tick_params(axis="y", length=0)
    ax.grid(False)
    ax.spines["left"].set_visible(False)
    handles = [Patch(color=colour, label=word) for word, colour in (("missed", MISSED),
                                                                    ("false positive", FALSE_POSITIVE),
                                                                          ("within 1000 ulps of touching", SHADE))]
    space(fig, top=0.3)
    fig.legend(handles=handles, loc="upper center", ncols=3, frameon=False, fontsize=9)
    everything = int(table.groupby("algorithm", observed=True)["cases"].sum().max())
    close = table["near_touching"]
    apart = int(table["cases"][close].sum() / max(1, len(labels)))
    hidden = int(table["cases"][close & ~table["gap_class"].str.endswith(" ulp")].sum() / max(1, len(labels)))
    caption = (
        f"Share of wrong answers among {number(everything)} cases of each algorithm; a full row's height is 100 %, any "
        "error has a visible foot; cases in which it failed are left out. Shaded: within 1000 ulps of touching, "
        f"{number(apart)} cases, counted apart; {number(hidden)} of them are decades so small that they are within "
        "1000 ulps at their offset, and are not in the bars. Deep inside, a body may lie wholly in the other or beyond "
        "it: no surfaces meet there, and a hit is a false positive. A cross: the algorithm failed in all cases of the "
        f"class. {source(run)}"
    )
    return Figure(gap_title(table, labels), svg_of(fig), caption, table.drop(columns="error").reset_index(drop=True),
                  key)


def totals(table):
    """Per algorithm over cases not near touching, and near: wrong, missed of what meets, false positives, failed."""
    rows = {}
    for (label, near), mine in table.groupby(["algorithm", "near_touching"], observed=True):
        said = int((mine["cases"] - mine["failed"]).sum())
        missed, reported = int(mine["false_negative"].sum()), int(mine["false_positive"].sum())
        rows[label, bool(near)] = {
            "cases": int(mine["cases"].sum()), "failed": int(mine["failed"].sum()), "missed": missed,
            "false positives": reported,
            "wrong": (missed + reported) / said if said else np.nan,
        }
    table = pd.DataFrame.from_dict(rows, orient="index")
    table.index = pd.MultiIndex.from_tuples(table.index, names=["algorithm", "near_touching"])
    return table


def gap_title(table, labels):
    away = totals(table)
    away = away[~away.index.get_level_values("near_touching")].droplevel("near_touching") if len(away) else away
    if away.empty:
        return "All cases are within 1000 ulps of touching"
    right = [label for label in labels if label in away.index and away["wrong"][label] == 0]
    never = [label for label in labels if label in away.index and away["missed"][label] == 0 and label not in right]
    if away["wrong"].isna().all():
        return f"{listed(away.index)} {verb(away, 'fails', 'fail')} in all cases beyond rounding of touching"
    if right:
        text = f"Beyond rounding of touching {listed(right)} {verb(right, 'is', 'are')} never wrong"
    else:
        best = away["wrong"].idxmin()
        text = (f"Beyond rounding of touching every algorithm errs; {best} least, in {100 * away['wrong'][best]:.1f} % "
                "of its cases")
    return (f"{text}; {listed(never)} {verb(never, 'has', 'have')} false positives but {verb(never, 'misses', 'miss')} "
            "nothing" if never else text)


def share_text(value):
    if np.isnan(value):
        return "F"
    if value == 0:
        return "0"
    return "<.1" if value < 0.0005 else f"{100 * value:.1f}" if value < 0.0995 else f"{100 * value:.0f}"


def by_figure(run, word, unit, make, key):
    """The error by algorithm and one other thing, near touching left out; F where the algorithm failed in all cases.

    Of a thing with a unit only cases that are alike in everything else are compared, if there are any.
    """
    table = make(run, like=True).reset_index() if unit else make(run).reset_index()
    like = bool(unit) and not table["near_touching"].astype(bool).all()
    table = table if like or not unit else make(run).reset_index()
    name = next(column for column in table.columns if column not in ("algorithm", "near_touching"))
    away = table[~table["near_touching"].astype(bool)]
    if away.empty:
        return f"Error by {word}: all cases are within 1000 ulps of touching."
    labels = [label for label in run.meta["algorithms"] if label in set(away["algorithm"])]
    values = list(dict.fromkeys(away[name].sort_values() if unit else away[name]))
    heads = dict(zip(values, heads_of(values) if unit else [str(value).replace("_", " ") for value in values]))
    cells = {}
    for row in away.itertuples():
        value = getattr(row, name)
        share = row.error
        colour = FAILED if np.isnan(share) else next(c for bound, c in STEPS if share <= bound + 1e-12)
        text = share_text(share) + ("*" if row.failed and not np.isnan(share) else "")
        cells[(row.algorithm, value) if unit else (value, row.algorithm)] = (text, colour)
    short = list(shortened(labels).values())
    if unit:
        fig, ax = figure(height=0.3 * len(labels) + 0.8)
        draw_map(ax, cells, labels, values, list(heads.values()), short)
        ax.set_xlabel(f"{word} ({unit})")
    else:
        fig, ax = figure(height=0.26 * len(values) + 1.9)
        draw_map(ax, cells, values, labels, short, list(heads.values()))
        ax.tick_params(axis="x", rotation=90)
    caption = (
        "Error (FP + FN) / (TP + FP + FN) in percent, over the "
        f"{number(int(away['cases'].sum() / max(1, len(labels))))} cases of each algorithm that are not within 1000 "
        f"ulps of touching{like_text(word) if like else ''}; those within are in the numbers below. F: failed in all "
        f"cases; *: failed in some, which are not counted. {source(run)}"
    )
    told = like or not unit or len(values) == 1
    title = (by_title(away, name, word, unit, heads) if told
             else f"No case is there at every {word}, so errors by {word} do not compare")
    return Figure(title, svg_of(fig), caption, table, key)


def like_text(word):
    other = "scale" if word == "offset" else "offset"
    return f" and whose pair, gap and {other} are there at every {word}, so that they compare"


def by_title(away, name, word, unit, heads):
    """Whether it matters: whose error varies most over it, or that it varies nowhere."""
    spread = away.groupby("algorithm", observed=True)["error"].agg(lambda e: e.max() - e.min())
    if not spread.notna().any():
        return f"No algorithm answers, so nothing depends on the {word}"
    if spread.max() < MATTERS:
        return f"The {word} hardly matters: no algorithm's error differs by more than {spread.max():.2g} over it"
    who = spread.idxmax()
    mine = away[away["algorithm"] == who].dropna(subset=["error"])
    low, high = (mine.loc[pick(mine["error"])] for pick in (pd.Series.idxmin, pd.Series.idxmax))
    place = (lambda row: f"{word} {heads[row[name]]} {unit}") if unit else (lambda row: heads[row[name]])
    steady = int((spread < MATTERS).sum())
    rest = f"; {steady} of {len(spread)} algorithms differ by less than {MATTERS:g} over it" if steady else ""
    return (f"{who} depends most on the {word}: error {low['error']:.2g} at {place(low)}, {high['error']:.2g} at "
            f"{place(high)}{rest}")


def instability_table(run):
    table = extremes.instability(run)
    frame = table.reset_index().rename(columns={
        "near_touching": "near touching", "swapped": "changes when swapped", "moved": "changes when both are moved",
        "truth_moved": "truth itself changes", "failure": "what it said when it failed first",
    })
    moved, swapped = (int(table[name].sum()) for name in ("moved", "swapped"))
    who = list(dict.fromkeys(table.index[(table["moved"] > 0) | (table["swapped"] > 0)].get_level_values("algorithm")))
    title = ("No algorithm answers any case" if not table["cases"].any() else
             "No answer changes with the order of a pair, nor when both bodies are moved exactly" if not who else
             f"{number(swapped)} answers change with the order of the pair and {number(moved)} when both bodies are "
             f"moved exactly: {listed(who)}")
    failed = list(dict.fromkeys(table.index[table["failed"] > 0].get_level_values("algorithm")))
    title += (f"; {listed(failed)} {verb(failed, 'fails', 'fail')} in {number(int(table['failed'].sum()))} cases"
              if failed else "; none fails")
    caption = ("Cases that did not fail; a move is by an exactly representable step, and cases in which it changes the "
               f"truth (rounding of the world's vertices) are apart. {source(run)}")
    return Table(title, frame.set_index("algorithm"), caption)
