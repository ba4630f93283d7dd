"""Work and precision of integrators; their orders."""

import numpy as np
import pandas as pd
from matplotlib.ticker import LogLocator

from ...tables import studies, study_tables
from ...words import listed, verb
from ..drawing import source
from ..figure import Figure, Table, figure, space, svg_of
from .cases import look


def precision_figure(run, cost, key):
    table = study_tables.work_precision(run)
    best = study_tables.cheapest(run, cost)
    title = precision_title(best, "fewest force evaluations" if cost == "force_evaluations" else "least processor time")
    wanted = table.groupby("problem", sort=False)["error"].count()
    if not wanted.any():
        return f"Error against cost: not drawn, no case of {listed(wanted.index)} has an error."
    fig, lost, idle = precision_panels(table, [name for name in wanted.index if wanted[name]], cost,
                                 "force evaluations" if cost == "force_evaluations" else "processor time (s)",
                                       study_tables.controlled,
                                 best[best["apart"]])
    bare = [name for name in wanted.index if not wanted[name]]
    caption = (
        "Error at the end (of position over the problem's length, or of orientation in rad, the greater) against cost. "
        "A line joins one integrator's accuracies from loose to tight; SemiExplicitEuler takes fixed steps only "
        "(dashed). Fixed steps of the others are in the numbers below, and drawn hollow where they cost least for an "
        "error in the title. A cross at the top is a case that did not finish "
        f"({lost}{f'; {idle} more ended before their first step' if idle else ''}); errors of 0 are drawn at the "
        "bottom. "
        + (f"No case of {listed(bare)} has an error. " if bare else "") + source(run)
    )
    return Figure(title, svg_of(fig), caption, table, key)


def precision_title(best, word):
    reached = best[best["integrator"] != ""]
    if reached.empty:
        return f"No integrator reaches an error of {study_tables.THRESHOLDS[0]:g} on any problem"
    parts = []
    for threshold, rows in reached.groupby("threshold", sort=False):
        wins = rows["integrator"].value_counts()
        leaders = sorted(wins.index[wins == wins.max()])
        who = listed(leaders) if len(leaders) <= 2 else f"{len(leaders)} integrators"
        need = verb(leaders, "needs", "each need")
        parts.append(f"{who} {need if not parts else need.replace('needs', 'does').replace('need', 'do')}"
                     f"{' the ' + word if not parts else ''} for errors below {threshold:.0e} on {wins.max()} of "
                     f"{len(rows)} problems")
    return "; ".join(parts).replace("e-0", "e-")


def precision_panels(table, problems, cost, label, chosen, apart=None):
    """Small multiples of error against `cost`, two in a row, with one legend; how many cases did not finish, and how
    many did not even begin, so that they have no cost.

    apart: rows of study_tables.cheapest that are on no line.
    """
    rows = max(1, -(-len(problems) // 2))
    fig, axes = figure(rows, 2, height=2.15 * rows + 1.2, squeeze=False)
    lost, idle, drawn = 0, 0, {}
    for ax, problem in zip(axes.ravel(), problems):
        mine = table[table["problem"] == problem]
        lines = {integrator: chosen(some) for integrator, some in mine.groupby("integrator", sort=False)}
        done = pd.concat([line[(line[cost] > 0) & line["error"].notna()] for line in lines.values()])
        lone = table.iloc[:0] if apart is None else apart[apart["problem"] == problem]
        positive = pd.concat([done["error"], lone["error"]]).loc[lambda error: error > 0]
        low = max(positive.min() / 3, 1e-17) if len(positive) else 1e-16
        high = min(positive.max() * 8, 1e3) if len(positive) else 1
        for integrator, line in lines.items():
            good = line[(line[cost] > 0) & line["error"].notna()]
            drawn[integrator] = ax.plot(good[cost], good["error"].clip(low * 1.2, high), markersize=4, linewidth=1.1,
                                        label=integrator, **look(integrator))[0]
            bad = line[(line["status"] != "finished") & (line[cost] > 0)]
            lost += len(bad)
            idle += int((line["status"] != "finished").sum()) - len(bad)
            at = bad[cost].clip(done[cost].min() / 3, done[cost].max() * 3) if len(done) else bad[cost]
            ax.plot(at, np.full(len(bad), 0.93), "x", color=look(integrator)["color"], markersize=6,
                    transform=ax.get_xaxis_transform())
        for row in lone.itertuples():
            ax.plot([row.cost], [max(row.error, low * 1.2)], markersize=6, markerfacecolor="none", markeredgewidth=1.3,
                    **look(row.integrator) | {"linestyle": "none"})
        ax.set(xscale="log", yscale="log", ylim=(low, high * 4))
        ax.set_title(problem.replace("_", " "), loc="left", fontsize=9.5)
        ax.yaxis.set_major_locator(LogLocator(numticks=6))
        ax.xaxis.set_major_locator(LogLocator(numticks=6))
        ax.minorticks_off()
    for ax in axes.ravel()[len(problems) :]:
        ax.set_axis_off()
    for ax in axes[:, 0]:
        ax.set_ylabel("error")
    for column in range(2):
        last = [ax for ax in axes[:, column] if ax.axison]
        if last:
            last[-1].set_xlabel(label)
    space(fig, bottom=0.23 * -(-len(drawn) // 3) + 0.1)
    fig.legend(drawn.values(), drawn.keys(), loc="lower center", ncols=3, frameon=False, fontsize=9)
    return fig, lost, idle


def order_figure(run, key):
    table, fits = study_tables.work_precision(run), steady(studies.orders(run))
    table = table[table["fixed_step"].notna()]
    problems = [name for name in dict.fromkeys(table["problem"])
                if table["error"][table["problem"] == name].notna().any()]
    if not problems:
        return "Error against the step: not drawn, no case with a fixed step has an error."
    fig, lost, _ = precision_panels(table, problems, "fixed_step", "fixed step (s)",
                                    lambda rows: rows.sort_values("fixed_step"))
    off = fits[(fits["order"] - fits["nominal"]).abs() > 0.3]
    if fits.empty:
        title = "No convergence order can be fitted: fewer than three steps are in the asymptotic range"
    else:
        title = f"{len(fits) - len(off)} of {len(fits)} fitted orders are within 0.3 of the nominal ones"
        if len(off):
            far = off.loc[(off["order"] - off["nominal"]).abs().idxmax()]
            title += (f"; farthest is {far['integrator']} on {far['sweep'].replace('_', ' ')}, {far['order']:.2f} for "
                      f"{far['nominal']:g}")
    caption = (
        f"Error against the length of fixed steps; a straight line of slope p is an order of p. {lost} cases did not "
        "finish (crosses at the top; those of much shorter or longer steps stand at the edge). CPodes takes no fixed "
        f"steps. {source(run)}"
    )
    return Figure(title, svg_of(fig), caption, table[["problem", "integrator", "fixed_step", "error", "status"]], key)


STEADY = 0.3  # standard error of a slope: beyond, the points are on no line


def steady(fits):
    """Of studies.orders() those over fixed steps that are on a line and have a nominal order."""
    fits = fits.reset_index()
    is_steady = fits["order"].notna() & (fits["spread"] <= STEADY)
    return fits[(fits["by"] == "fixed_step") & is_steady & fits["nominal"].notna()]


def orders_table(run):
    fits = studies.orders(run).reset_index()
    if fits.empty:
        return None
    rows = {}
    for (integrator, by), mine in fits.groupby(["integrator", "by"], sort=False):
        nominal = mine["nominal"].iloc[0]
        rows[integrator, by] = {"nominal": f"{nominal:g}" if nominal == nominal else "varies"} | {
            fit["sweep"].replace("_", " "): order_text(fit) for _, fit in mine.iterrows()
        }
    frame = pd.DataFrame.from_dict(rows, orient="index")
    frame.insert(0, "over", [by.replace("_", " ") for _, by in rows])
    frame.index = pd.Index([integrator for integrator, _ in rows], name="integrator")
    caption = (
        "Slope of log error over log step by least squares, by accuracies over the mean step, and its standard error. "
        f"Fitted are the finest {studies.FITTED} cases at most of those whose errors fall from {studies.COARSE:g} down "
        f"to {studies.FLOOR:g}, where rounding takes over, from each step to the next shorter. Erratic: the standard "
        f"error is above {STEADY:g}, the points are on no line; a dash: fewer than three cases are in the range. Where "
        f"a contact begins within a step, the force has no second derivative. {source(run)}"
    )
    return Table("Fitted convergence orders beside the nominal ones", frame.fillna("–"), caption)


def order_text(fit):
    if not fit["order"] == fit["order"]:
        return "–"
    return f"{fit['order']:.2f} ± {fit['spread']:.2f}" if fit["spread"] <= STEADY else f"erratic ({fit['order']:.1f})"
