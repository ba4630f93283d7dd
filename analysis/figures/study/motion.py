"""Extremes of the motion, and its drift."""

import numpy as np
import pandas as pd

from ...tables import studies, study_tables
from ...words import counted, listed, number, plural
from ..drawing import BINS, source
from ..figure import Figure, PALETTE, Table, figure, svg_of
from ..heat_map import draw_map
from .maps import cell, map_legend


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
        "the naive form and the adapted ones beside it: units of the problem's own size, or tolerances and steps that "
        f"fit it. {own_steps(table)}"
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
               f"steps.{ended} {more[:1].upper() + more[1:] + '. ' if more else ''}{source(run)}")
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
