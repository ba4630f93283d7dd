"""Sections of the report on studies of integrators: work and precision, where they hold, extremes and drift."""

import numpy as np
import pandas as pd
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator

from ..tables import pareto, studies, study_tables
from .drawing import BINS, guarded
from .figure import PALETTE, Figure, Section, Table, figure, style, svg_of, slug
from ..words import counted, listed, number, plural, verb

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
CLASSES = [(0.01, "#D6E9F5", "1 %"), (0.1, "#8CC3E6", "10 %"), (1, "#F6C667", "100 %"), (np.inf, "#E07B39", "more")]
DARK = "#3D3D3D"
CELL_SIZE = 8.5


def sections(runs, beside=None):
    """A section for each study among `runs`, and one for the drift of each integrated motion; none when there is
    neither.

    beside: all runs of the report; recommendations are compared with their configurations.
    """
    beside = runs if beside is None else beside
    found = []
    for count, run in enumerate(runs):
        key = f"study-{count}-{slug(pareto.name(run))}"
        if run.study is not None:
            found.append(Section(f"{pareto.title(run)}: integrators", study_parts(run, beside, key),
                                 pareto.title(run)))
        elif run.physics is not None and run.meta["steps"] > 1:
            found.append(Section("Drift of the motion", [guarded("Drift", drift_figure, run, key)], pareto.title(run)))
    return found


def study_parts(run, runs, key):
    """Whatever the file has of: precision figures, orders, maps, recommendation, extremes."""
    try:
        study = studies.study(run)
        maps, precision, rest = study_tables.parts(study)
    except (KeyError, ValueError) as error:
        return [f"The study cannot be read: {error}."]
    if study.empty:
        return ["The study has no cases."]
    found = [unfinished(study)]
    if precision:
        for cost in ("force_evaluations", "time_s"):
            found.append(guarded("Error against cost", precision_figure, run, cost, f"{key}-{cost.replace('_', '-')}"))
        found.append(guarded("Error against the step", order_figure, run, f"{key}-order"))
        found.append(guarded("Orders", orders_table, run))
    stiff = [name for name, rows in maps if studies.varied(rows) == ["stiffness"]]
    for name in stiff:
        found.append(guarded("The stability map", map_figure, run, name, f"{key}-map-{slug(name)}"))
    others = [name for name, _ in maps if name not in stiff]
    if others:
        found.append(guarded("The other factors", factor_figure, run, others, f"{key}-factors"))
    if stiff:
        found.append(guarded("The recommendation", recommendation_table, run, runs))
    if len(rest):
        found.append(guarded("The extremes of the motion", extremes_figure, run, f"{key}-extremes"))
        found.append(guarded("The plate", tunnelling_table, run))
    return [part for part in found if part is not None]


def unfinished(study):
    lost = study[~study["finished"]]
    who, where = (counted(study[name].nunique(), name) for name in ("integrator", "problem"))
    text = f"{counted(len(study), 'case')} of {who} on {where}"
    return f"{text}; {len(lost)} did not finish: {causes(lost)}." if len(lost) else f"{text}; all finished."


def causes(lost):
    """Why the cases `lost` did not finish, and how many for each reason."""
    return listed(f"{'not run' if status == 'not run' else (FAILED.get(status) or OTHERWISE)[1]} ({count})"
                  for status, count in lost["status"].value_counts().items())


def look(name):
    picked = INTEGRATORS.get(name)
    if not picked:
        return style(name)
    return {"color": PALETTE[picked[0]], "marker": picked[1], "linestyle": picked[2]}


def source(run):
    meta = run.meta
    return (f"{pareto.name(run)}, configuration “{meta.get('title', '')}” (sha256 "
            f"{meta.get('config_sha256', 'unknown')[:10]}), commit "
            f"{meta.get('git_commit', '?')[:7]}, {meta.get('run', {}).get('processor', 'unknown processor')}.")


# ---- Work and precision ------------------------------------------------------------------------------------------


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
        "Error at the end (of position over the problem's length, or of orientation in rad, the greater) against "
        "cost. A line joins one "
        "integrator's accuracies from loose to tight; SemiExplicitEuler takes fixed steps only (dashed). Fixed steps "
        "of the others are "
        "in the numbers below, and drawn hollow where they cost least for an error in the title. A cross at the top "
        f"is a case that did not finish ({lost}{f'; {idle} more ended before their first step' if idle else ''}); "
        "errors of 0 are drawn at the bottom. "
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


def space(fig, top=0.0, bottom=0.0):
    """Leaves that many inches above and below the axes to legends."""
    height = fig.get_size_inches()[1]
    fig.get_layout_engine().set(rect=(0, bottom / height, 1, 1 - (top + bottom) / height))


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
        "finish (crosses at the top; "
        f"those of much shorter or longer steps stand at the edge). CPodes takes no fixed steps. {source(run)}"
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
        f"Fitted are the finest {studies.FITTED} cases at most of "
        f"those whose errors fall from {studies.COARSE:g} down to {studies.FLOOR:g}, where rounding takes over, from "
        "each step to the next shorter. Erratic: the standard error is "
        f"above {STEADY:g}, the points are on no line; a dash: fewer than three cases are in the range. Where a "
        f"contact begins within a step, the force has no second derivative. {source(run)}"
    )
    return Table("Fitted convergence orders beside the nominal ones", frame.fillna("–"), caption)


def order_text(fit):
    if not fit["order"] == fit["order"]:
        return "–"
    return f"{fit['order']:.2f} ± {fit['spread']:.2f}" if fit["spread"] <= STEADY else f"erratic ({fit['order']:.1f})"


# ---- Maps ----------------------------------------------------------------------------------------------------------


def shade(share):
    """The colour of a share of energy."""
    return next(colour for bound, colour, _ in CLASSES if abs(share) <= bound)


def percent(value):
    """A signed share in few characters: 0.0123 -> "+1.2", 12.5 -> "+1e3"; in percent.

    As many decimals as tell on which side of its colour's bound it is: 0.0102 -> "+1.02".
    """
    share, value = value, 100 * value
    if not np.isfinite(value):
        return "–" if np.isnan(value) else "∞"
    if abs(value) < 0.05:
        return "0"
    sign = "+" if value > 0 else "−"
    if abs(value) >= 999.5:
        exponent = int(np.floor(np.log10(abs(value))))
        return (f"{sign}{abs(value) / 10**exponent:.0f}e{exponent}" if abs(value) / 10**exponent < 9.5
                else f"{sign}1e{exponent + 1}")
    texts = [f"{abs(value):.{decimals}f}" for decimals in range(int(abs(value) < 9.95), 4)]
    return sign + next((text for text in texts if shade(float(text) / 100) == shade(share)), texts[0])


def cell(row):
    """(text, colour) of a case in a map."""
    if not row["finished"]:
        return (FAILED.get(row["status"]) or OTHERWISE)[0], DARK
    error = abs(row["energy_error"])
    if np.isnan(error):
        return "–", "#FFFFFF"
    return percent(row["energy_error"]), shade(error)


def draw_map(ax, cells, rows, columns, heads, names=None):
    """cells: (row, column) -> (text, colour); without one: not run. heads, names: beside columns and rows."""
    ax.grid(False)
    picture = np.ones((len(rows), len(columns), 3))
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            text, colour = cells.get((row, column), ("", "#FFFFFF"))
            picture[i, j] = to_rgb(colour)
            ax.text(j, i, text, ha="center", va="center", fontsize=CELL_SIZE, color="#FFFFFF" if colour == DARK
                    else "#111111",
                    fontweight="bold" if colour == DARK else "normal")
    ax.imshow(picture, aspect="auto", interpolation="nearest")
    ax.set_xticks(range(len(columns)), heads)
    ax.set_yticks(range(len(rows)), names or rows)
    ax.set_xticks(np.arange(len(columns) - 1) + 0.5, minor=True)
    ax.set_yticks(np.arange(len(rows) - 1) + 0.5, minor=True)
    ax.grid(which="minor", color="#FFFFFF", linewidth=1.2)
    ax.tick_params(which="both", length=0)
    for side in ("left", "bottom"):
        ax.spines[side].set_visible(False)


def map_legend(fig, statuses):
    patches = [Patch(color=colour, label=f"≤ {word}" if word != "more" else "more") for _, colour, word in CLASSES]
    words = [FAILED.get(status, OTHERWISE) for status in dict.fromkeys(statuses)]
    failed = [Patch(color=DARK, label=f"{letter}: {what}") for letter, what in dict.fromkeys(words)]
    columns = 1 if len(failed) < 3 else 2
    space(fig, top=0.5, bottom=0.22 * -(-len(failed) // columns) + 0.12 if failed else 0)
    fig.legend(handles=patches, loc="upper center", ncols=4, frameon=False, fontsize=9, title_fontsize=9,
               title="finished; energy off its balance by")
    if failed:
        fig.legend(handles=failed, loc="lower center", ncols=columns, frameon=False, fontsize=9)


def map_table(run, names):
    table = study_tables.stability(run)
    table = table[table["sweep"].isin(names)]
    several = table.groupby("integrator")["setting"].nunique().max() > 1 if len(table) else False
    table["who"] = table["integrator"] + (", " + table["setting"] if several else "")
    return table


def heads_of(values):
    heads = []
    for value in values:
        text = (f"{value:g}" if 1e-3 <= abs(value) < 1e3 or value == 0
                else f"{value:.0e}".replace("e+0", "e").replace("e+", "e").replace("e-0", "e-"))
        heads.append(text)
    return heads


def map_figure(run, name, key):
    """Integrators over the stiffness."""
    table = map_table(run, [name])
    rows, columns = list(dict.fromkeys(table["who"])), sorted(table["value"].unique())
    cells = {(row["who"], row["value"]): cell(row) for _, row in table.iterrows()}
    fig, ax = figure(height=0.31 * len(rows) + 1.9)
    draw_map(ax, cells, rows, columns, heads_of(columns))
    ax.set_xlabel("stiffness (Pa)")
    map_legend(fig, table["status"][~table["finished"]])
    caption = (
        f"{table['problem'].iloc[0].replace('_', ' ')} ({name}); {len(table)} cases of {len(rows)} integrators at "
        f"{listed(dict.fromkeys(table['setting']))}. A "
        "cell says by how many percent of the problem's energy the balance is off at its worst: + is energy from "
        "nowhere, 0 is less than 0.05. A letter on dark: why "
        f"the case did not finish. An empty cell was not run. {source(run)}"
    )
    return Figure(map_title(table), svg_of(fig), caption, table.drop(columns=["who", "sweep"]), key)


def map_title(table):
    """Who holds over the whole range, who fails."""
    problem = table["problem"].iloc[0].replace("_", " ")
    good = study_tables.holds(table).groupby(table["who"], sort=False).all()
    lost = table["who"][~table["finished"]].unique()
    where = range_text(table, "Pa")
    names = list(good.index[good])
    text = f"{problem.capitalize()}: " + (f"{listed(names)} {verb(names, 'keeps', 'keep')} the energy within 1 % "
                                          f"{where}" if names
                                          else f"no integrator keeps the energy within 1 % {where}")
    return (f"{text}; {listed(lost)} {verb(lost, 'does', 'do')} not finish everywhere" if len(lost)
            else f"{text}; all finish")


def range_text(table, unit):
    """The range of a map's factor; says so when not every integrator has all of it."""
    low, high = heads_of([table["value"].min(), table["value"].max()])
    wanted, run = table["who"].nunique() * table["value"].nunique(), len(table[["who", "value"]].drop_duplicates())
    where = f"from {low} to {high} {unit}"
    return where if run == wanted else f"in the cases that were run, {run} of {wanted} {where}"


def factor_figure(run, names, key):
    """The other factors, a small map each, two in a row."""
    table = map_table(run, names)
    rows = list(dict.fromkeys(table["who"]))
    lines = -(-len(names) // 2)
    widths = [max([table["value"][table["sweep"] == name].nunique() for name in names[column::2]] or [1])
              for column in range(2)]
    fig, axes = figure(lines, 2, height=lines * (0.27 * len(rows) + 0.75) + 0.9, squeeze=False, sharey=True,
                       width_ratios=widths)
    for ax, name in zip(axes.ravel(), names):
        mine = table[table["sweep"] == name]
        columns = sorted(mine["value"].unique())
        cells = {(row["who"], row["value"]): cell(row) for _, row in mine.iterrows()}
        draw_map(ax, cells, rows, columns, heads_of(columns))
        factor = mine["factor"].iloc[0]
        ax.set_title(mine["problem"].iloc[0].replace("_", " "), loc="left", fontsize=9.5)
        unit = study_tables.UNITS.get(factor)
        ax.set_xlabel(factor.replace("_", " ") + (f" ({unit})" if unit else ""))
    for ax in axes.ravel()[len(names) :]:
        ax.set_axis_off()
    map_legend(fig, table["status"][~table["finished"]])
    good = study_tables.holds(table)
    best = good.groupby(table["who"], sort=False).all()
    worst = (~good).groupby(table["factor"]).mean()
    title = (
        f"{listed(best.index[best])} {verb(best.sum(), 'keeps', 'keep')} the energy within 1 % whatever one factor is"
        if best.any() else
        f"No integrator keeps the energy within 1 % over all factors; {worst.idxmax().replace('_', ' ')} costs most"
    )
    caption = (f"One factor at a time around the defaults; {len(table)} cases. Cells as in the stability map, in "
               f"percent. {source(run)}")
    return Figure(title, svg_of(fig), caption, table.drop(columns="who"), key)


def recommendation_table(run, runs):
    stiffness = study_tables.default_stiffness(run)
    others = study_tables.followed(run, [other for other in runs if other is not run])
    if not stiffness == stiffness and len(others):
        stiffness = others["stiffness"].iloc[0]
    if not stiffness == stiffness:
        return "No recommendation: neither this file nor another of the report says which stiffness the scenes have."
    table = study_tables.recommendation(run, stiffness)
    if table.empty:
        return f"No recommendation: no case is within a factor of {study_tables.NEAR:g} of {stiffness:g} Pa."
    best = table[table["recommended"]]
    title = (f"Near {stiffness:g} Pa {best['integrator'].iloc[0]} at {best['setting'].iloc[0]} is recommended"
             if len(best)
             else f"Near {stiffness:g} Pa no integrator is known to hold in all {table['of'].iloc[0]} cases")
    words = [follow_text(row) for row in others.itertuples()]
    frame = table.drop(columns=study_tables.CONTROLS).rename(columns={
        "of": "of cases", "force_evaluations": "force evaluations",
        "worst_energy_error": "worst energy error", "energy_error": "mean energy error",
    })
    caption = (
        f"Cases of the sweeps over stiffness from {stiffness / study_tables.NEAR:g} to "
        f"{stiffness * study_tables.NEAR:g} Pa. Holds: finished, with the energy within "
        f"{100 * study_tables.BOUND:g} % of its balance all the time. Recommended is, of those that hold in all and "
        f"need at most {studies.DEARER:g} times the force evaluations of the cheapest, the most accurate (geometric "
        "mean). These are "
        "small scenes: what hundreds of bodies cost (a dense Jacobian of CPodes, Verlet's convergence) is not in them. "
        "" + " ".join(words)
    )
    return Table(title, frame.set_index("integrator"), caption)


def follow_text(row):
    """Whether a scene given beside does as is recommended."""
    uses = f"“{row.title}” ({row.integrator} at {row.setting}, {row.stiffness:g} Pa)"
    if not row.recommended:
        return f"{uses}: nothing is recommended at its stiffness."
    if row.follows:
        return f"{uses} follows the recommendation."
    if row.holds != row.holds:
        return (f"{uses} does not follow the recommendation, {row.recommended}; the study has no cases of its own "
                "setting.")
    cost = f" and needs {row.times:.2g} times the evaluations" if row.times == row.times else ""
    return (f"{uses} does not follow the recommendation, {row.recommended}: its own "
            f"{'holds too' if row.holds else 'does not hold'}{cost}.")


# ---- Extremes and drift -------------------------------------------------------------------------------------------


def extremes_figure(run, key):
    """Every extreme case over the integrators."""
    table = study_tables.extremes_of_motion(run)
    table["row"] = [wrapped(f"{sweep.replace('_', ' ')}: {case}".removesuffix(": as it stands"))
                    for sweep, case in zip(table["sweep"], table["case"])]
    rows, columns = list(dict.fromkeys(table["row"])), list(dict.fromkeys(table["integrator"]))
    cells = {(row["row"], row["integrator"]): cell(row) for _, row in table.iterrows()}
    lines = sum(text.count("\n") + 1 for text in rows)
    fig, ax = figure(height=0.17 * lines + 0.13 * len(rows) + 2.9)
    draw_map(ax, cells, rows, columns, columns)
    ax.tick_params(axis="x", rotation=90)
    map_legend(fig, table["status"][~table["finished"]])
    good = study_tables.holds(table, 0.1).groupby(table["row"], sort=False).mean()
    none = [name.replace("\n", " ") for name in good.index[good == 0]]
    all_of = int((good == 1).sum())
    title = (f"Of {counted(len(good), 'extreme case')} {all_of} go well with every integrator and {len(none)} with "
             "none (finished, energy within 10 %)")
    caption = (
        f"{len(table)} cases. Cells as in the stability map: energy off its balance, in percent. Cases of one name are "
        "the naive form and the adapted ones "
        f"beside it: units of the problem's own size, or tolerances and steps that fit it. {own_steps(table)}"
        + source(run)
    )
    return Figure(title, svg_of(fig), caption, table.drop(columns="row"), key)


def own_steps(table):
    """Who takes a fixed step that is longer than a row says, as a sentence; "" when nobody does."""
    words = []
    for name, mine in table.dropna(subset=["own_step"]).groupby("integrator", sort=False):
        steps = listed(f"{step:g}" for step in sorted(mine["own_step"].unique()))
        words.append(f"{name} takes its own step of {steps} s also where that is above the greatest step of its row. ")
    return "".join(words)


def wrapped(text, most=34):
    lines, line = [], ""
    for word in text.split(" "):
        if line and len(line) + len(word) + 1 > most:
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}".strip()
    return "\n".join([*lines, line])


def tunnelling_table(run):
    table = study_tables.tunnelling(run)
    if table.empty:
        return None
    words = []
    for (speed, thickness, stiffness), mine in table.groupby(["speed", "thickness", "stiffness"], sort=False,
                                                             dropna=False):
        step, what = mine["preventing_step"].dropna(), f"a plate of {thickness:g} m and {stiffness:g} Pa"
        words.append(f"{what} is passed at {speed:g} m/s whatever the step" if step.empty else
                     f"{what} stops a ball of {speed:g} m/s with steps of at most {step.min():.2g} s"
                     + (f" with {len(step)} of {len(mine)} integrators" if len(step) < len(mine) else ""))
    title = "; ".join(words)
    title = title[:1].upper() + title[1:]
    frame = pd.DataFrame({
        "integrator": table["integrator"], "speed (m/s)": table["speed"], "plate (m)": table["thickness"],
        "stiffness (Pa)": table["stiffness"].map("{:g}".format),
        "went through with steps of (s)": [", ".join(f"{step:g}" for step in steps) or "–"
                                           for steps in table["went_through"]],
        "was stopped with (s)": [", ".join(f"{step:g}" for step in steps) or "–" for steps in table["stopped"]],
        "greatest step that stops it (s)": table["preventing_step"],
    })
    caption = ("The greatest step that stops the ball from whatever phase it comes, by bisection. A dash: none was "
               "found. " + source(run))
    return Table(title, frame.set_index("integrator"), caption)


def drift_figure(run, key):
    """Energy and penetration over the time of an integrated run, a panel each."""
    table = study_tables.drift_steps(run)
    what = {"energy": "energy (J)", "energy_change": "energy, off the first (1)",
            "greatest_penetration": "greatest penetration (m)"}
    names = [name for name in what if name in table and table[name].notna().any()
             and (name != "energy_change" or table.attrs["lossless"])]
    if not names:
        return "Drift: not drawn, no energy is recorded."
    fig, axes = figure(len(names), 1, height=1.45 * len(names) + 0.6, squeeze=False, sharex=True)
    for ax, name in zip(axes[:, 0], names):
        values = table[name].to_numpy(float)
        edges = np.linspace(0, len(values), min(BINS, len(values)) + 1).astype(int)
        time = [table["time"].iloc[a:b].mean() for a, b in zip(edges, edges[1:])]
        low, high = (np.array([reduce(values[a:b]) for a, b in zip(edges, edges[1:])])
                     for reduce in (np.fmin.reduce, np.fmax.reduce))
        ax.fill_between(time, low, high, color=PALETTE["sky"], linewidth=0, alpha=0.5)
        ax.plot(time, high, color=PALETTE["blue"])
        ax.set_title(what[name], loc="left", fontsize=9.5)
    axes[-1, 0].set_xlabel("time (s)")
    status = table.attrs["status"]
    ended = "" if status == "complete" else f" The integration {status.rstrip('.')}."
    more = drift_words(run)
    caption = (f"{number(len(table))} steps; the band is from the least to the greatest of each stretch of "
               f"steps.{ended} "
               f"{more[:1].upper() + more[1:] + '. ' if more else ''}{source(run)}")
    return Figure(drift_title(table), svg_of(fig), caption, table.iloc[:: max(1, len(table) // 60)], key)


def drift_words(run):
    """What is recorded of quaternions and of bodies that left, as words; "" for nothing."""
    norm, words = run.physics.attrs.get("quaternion_drift", np.nan), []
    if norm == norm:
        words.append(f"norms of the integrator's quaternions are off 1 by {norm:.2g} at most")
    try:
        count = studies.escaped(run)
        where = " (ended below everything fixed, or ten times its size away)" if count else ""
        words.append(f"{count or 'no'} {plural(count, 'body', 'bodies')} escaped{where}")
    except (KeyError, IndexError, AttributeError, ValueError, TypeError):
        pass  # a file without motion or bodies
    return "; ".join(words)


def drift_title(table):
    change, energy = table["energy_change"].dropna(), table["energy"].dropna()
    if energy.empty:
        text = "No energy is recorded"
    elif table.attrs["lossless"] and len(change):
        text = f"Nothing gives or takes energy, and it is off by {100 * change.abs().max():.2g} % at most"
    else:
        text = f"The energy goes from {energy.iloc[0]:.3g} to {energy.iloc[-1]:.3g} J"
    depth = table["greatest_penetration"].max() if "greatest_penetration" in table else np.nan
    return f"{text}; bodies sink into each other by {depth:.2g} m at most" if depth > 0 else text
