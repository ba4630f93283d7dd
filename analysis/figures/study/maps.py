"""Where integrators hold: maps over stiffness and the other factors, and what follows from them."""

import numpy as np
from matplotlib.patches import Patch

from ...tables import studies, study_tables
from ...words import listed, verb
from ..drawing import source
from ..figure import Figure, Table, figure, space, svg_of
from ..heat_map import DARK, draw_map, heads_of
from .cases import FAILED, OTHERWISE

CLASSES = [(0.01, "#D6E9F5", "1 %"), (0.1, "#8CC3E6", "10 %"), (1, "#F6C667", "100 %"), (np.inf, "#E07B39", "more")]


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
        f"{listed(dict.fromkeys(table['setting']))}. A cell says by how many percent of the problem's energy the "
        "balance is off at its worst: + is energy from nowhere, 0 is less than 0.05. A letter on dark: why the case "
        f"did not finish. An empty cell was not run. {source(run)}"
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
        f"{stiffness * study_tables.NEAR:g} Pa. Holds: finished, with the energy within {100 * study_tables.BOUND:g} % "
        f"of its balance all the time. Recommended is, of those that hold in all and need at most {studies.DEARER:g} "
        "times the force evaluations of the cheapest, the most accurate (geometric mean). These are small scenes: what "
        "hundreds of bodies cost (a dense Jacobian of CPodes, Verlet's convergence) is not in them. " + " ".join(words)
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
