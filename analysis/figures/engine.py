"""Collisions and physics, together and by collision: figures 5.1 to 5.4 and 5.14 to 5.16 of the thesis.

The thesis measured Cannon.js, which does both. Here the collision phases of Cannon.js answer on Simbody's motion (the
algorithms cannon_naive and cannon_sap), and the physics are Simbody's own steps, contacts included.
"""

import numpy as np
import pandas as pd
from matplotlib.ticker import MaxNLocator

from ..tables import thresholds as t
from .drawing import (
    NotDrawn,
    algorithm,
    binned,
    caption,
    comparable,
    correlation,
    digits,
    label_ends,
    log_seconds,
    seconds,
    simulated,
    steps_of,
    stretch,
    stretches,
)
from .figure import PALETTE, Figure, figure, style, svg_of
from .steps import exponents, named
from ..words import duration

CANNON = ("cannon_naive", "cannon_sap")
THESIS = {"box": ("5.1", "5.2", "5.3", "5.4"), "falling": ("5.14", "5.15", "", "5.16")}
PHYSICS = {"color": PALETTE["blue"], "marker": "o", "linestyle": "-"}
START = 0.2  # of the steps: "the start", of the thesis's swings of time per collision


def parts(run):
    """(Steps, label -> column of Cannon's phases, physics) from step 1 on: step 0 is not integrated.

    physics: columns time_ns, contact_time_ns, contacts. Raises NotDrawn when there is neither or only one of them.
    """
    steps = steps_of(run)
    labels = [label for label in comparable(run) if algorithm(run, label) in CANNON]
    columns = {label: steps.labels.index(label) for label in labels}
    if not columns:
        raise NotDrawn("the file has no answers of cannon_naive or cannon_sap")
    if run.physics is None:
        raise NotDrawn("nothing was integrated in this file")
    physics = run.physics[["time_ns", "contact_time_ns", "contacts"]].iloc[: simulated(run)]
    if not (physics.time_ns > 0).any():
        raise NotDrawn("no time of the integration is recorded")
    if any(not (steps.time_ns[1:, column] > 0).any() for column in columns.values()):
        raise NotDrawn("no time of Cannon's phases is recorded")
    return steps, columns, physics


def timing_note(run):
    """What a caption says when physics were timed elsewhere than the algorithms, else ""."""
    timed = [run.meta["answers"][label] for label in comparable(run)]
    places = {(answers.get("host"), answers.get("processor")) for answers in timed}
    here = (run.meta["run"].get("host"), run.meta["run"].get("processor"))
    return "" if places == {here} else f" PHYSICS WERE TIMED ON ANOTHER MACHINE ({here[0]}, {here[1]})."


def thesis(kind, number):
    found = THESIS.get(kind, ("",) * 4)[number]
    return f"figure {found}" if found else ""


def first_label(columns):
    return next(iter(columns))


def widths(values, full):
    """How far values spread while all bodies are there: (95th - 5th percentile) / median."""
    low, middle, high = np.percentile(values[full], (5, 50, 95))
    return float((high - low) / middle) if middle > 0 else np.nan


def parts_of_a_step(run, kind, key):
    """Collision, physics and total time over the steps."""
    steps, columns, physics = parts(run)
    physics_ns = physics.time_ns.to_numpy(dtype=float)
    ours = {label: (steps.time_ns[:, i], style(algorithm(run, label), label)) for label, i in columns.items()}
    label = first_label(columns)
    total_ns = physics_ns + steps.time_ns[:, columns[label]]
    contacts = (physics.contact_time_ns.to_numpy(dtype=float), {"color": PALETTE["sky"], "linestyle": ":"})
    drawn = {  # on axes of their own: physics takes hundreds of times as long as collisions
        "collision": ours,
        "physics": {"contacts in it": contacts, "physics": (physics_ns, PHYSICS)},
        "total": {"total": (total_ns, {"color": PALETTE["black"], "linestyle": "--"})},
    }
    fig, panels_ = figure(len(drawn), 1, height=1.5 * len(drawn) + 0.4, sharex=True, squeeze=False)
    lines = {}
    for axes, (what, parts_) in zip(panels_[:, 0], drawn.items()):
        parts_ = {name: line for name, line in parts_.items() if line[0][1:].any()}
        ends, top = [], 0.0
        for name, (values, look) in parts_.items():
            middle, times = binned(values[1:] / 1e9, np.median)
            axes.plot(middle + 1, times, **look, markevery=(len(middle) // 12, max(1, len(middle) // 6)), markersize=5)
            ends.append((times[-1], name, look))
            top = max(top, times.max())
        axes.set_ylim(0, 1.1 * top if top else 1)
        axes.set_ylabel(what)
        axes.yaxis.set_major_locator(MaxNLocator(4))
        axes.margins(x=0.01)
        seconds(axes.yaxis)
        label_ends(axes, ends)
        lines |= parts_
    panels_[-1, 0].set_xlabel("step")
    fig.align_ylabels()

    all_there = steps.full & (np.arange(len(steps.full)) > 0)
    rows = {
        name: (values[1:].mean(), np.median(values[1:]), widths(values, all_there))
        for name, (values, _) in lines.items()
    }
    table = pd.DataFrame.from_dict(rows, orient="index", columns=["mean ns", "median ns", "spread / median"])
    parts_of_steps = stretches({name: values for name, (values, _) in lines.items()}, np.median)
    table = table.join(parts_of_steps.add_prefix("median ns, ")).rename_axis("part of a step")
    collision, whole = table.loc[label], table.loc["physics"]
    calmer = collision["spread / median"] < whole["spread / median"]
    title = (
        f"Collision time ({label}) varies {'less' if calmer else 'no less'} than physics time, "
        f"{'as in' if calmer else 'unlike in'} the thesis: its 5th to 95th percentile spans "
        f"{digits(collision['spread / median'])} times the median, that of physics {digits(whole['spread / median'])} "
        f"times; physics takes {digits(whole['mean ns'] / collision['mean ns'])} times as long"
    )
    what = (
        "Time of a step, each part on an axis of its own. Collision: Cannon's phases in C++ on all pairs; "
        "physics: Simbody's integration since the step "
        f"before, its own search for contacts and their forces included; total: physics and {label}. "
        f"n = {len(steps.hits) - 1} steps, {stretch(steps.hits)}; spread over the "
        f"{all_there.sum()} steps with all bodies there.{timing_note(run)}"
    )
    return Figure(title, svg_of(fig), caption(run, what, thesis(kind, 0), nine=False), table, key)


def against_collisions(run, kind, key):
    """Collision time against hits, physics time against contacts."""
    steps, columns, physics = parts(run)
    shown = [(label, steps.hits[:, i], steps.time_ns[:, i], style(algorithm(run, label), label)["color"],
              "pairs it reports")
             for label, i in columns.items()]
    shown.append(("physics", physics.contacts.to_numpy(dtype=float), physics.time_ns.to_numpy(dtype=float),
                  PHYSICS["color"], "contacts"))
    shown = shown[:2] + shown[-1:] if len(shown) > 3 else shown
    fig, axes = figure(1, len(shown), height=2.6, squeeze=False)
    rows = {}
    for panel, (name, hits, time, colour, words) in zip(axes[0], shown):
        panel.scatter(hits[1:], time[1:] / 1e9, s=5, alpha=0.5, color=colour, linewidths=0, rasterized=True)
        panel.set_ylim(0, 1.1 * max(1, np.percentile(time[1:], 99.5)) / 1e9)
        panel.set_xlim(0, max(1, hits.max()) * 1.03)
        panel.xaxis.set_major_locator(MaxNLocator(3, integer=True))
        panel.yaxis.set_major_locator(MaxNLocator(4))
        seconds(panel.yaxis)
        panel.set_title(name, fontsize=9)
        panel.set_xlabel(words, fontsize=9)
        still = correlation(hits[steps.full][1:], time[steps.full][1:])
        rows[name] = (correlation(hits[1:], time[1:]), still, time[1:].mean(), hits[1:].mean())
    axes[0, 0].set_ylabel("time of a step")
    columns_ = ["r, all steps", "r, all bodies there", "mean ns", "collisions per step"]
    table = pd.DataFrame.from_dict(rows, orient="index", columns=columns_).rename_axis("part of a step")
    r = table["r, all bodies there"]
    name = shown[0][0]
    if np.isnan(r["physics"]) or np.isnan(r[name]):
        title = "Whether time follows collisions cannot be told: one of them does not vary"
    else:
        more = r["physics"] > r[name]
        title = (
            f"Physics time follows the contacts {'more' if more else 'no more'} closely than collision time ({name}) "
            f"follows its hits, {'as in' if more else 'unlike in'} the thesis (r = {r['physics']:.2f} against "
            f"{r[name]:.2f})"
        )
    when = f" over the {steps.full.sum()} steps with all {steps.bodies.max()} bodies" if steps.grows else ""
    what = (
        f"A dot per step, n = {len(steps.hits) - 1}; r is Pearson's correlation{when}. The slowest 0.5 % may lie "
        f"above a panel; panels have axes of their own.{timing_note(run)}"
    )
    return Figure(title, svg_of(fig), caption(run, what, thesis(kind, 1), nine=False), table, key)


def against_bodies(run, kind, key):
    """Collision and physics time against the number of bodies."""
    steps, columns, physics = parts(run)
    if not steps.grows:
        raise NotDrawn(f"the number of bodies, {steps.bodies.max()}, does not change")
    times = pd.DataFrame({label: steps.time_ns[:, i] for label, i in columns.items()})
    times["physics"] = physics.time_ns.to_numpy(dtype=float)
    median = times.iloc[1:].groupby(steps.bodies[1:]).median()
    median = median[median.index > 0]
    power = exponents(median)
    fig, axes = figure(height=3.8)
    ends = []
    for name in median:
        look = PHYSICS if name == "physics" else style(algorithm(run, name))
        axes.plot(median.index, median[name] / 1e9, **look, markevery=max(1, len(median) // 6), markersize=5)
        ends.append((median[name].iloc[-1] / 1e9, named(name, power[name]), look))
    log_seconds(axes)
    axes.set_xlabel("bodies, fixed ones included")
    axes.set_ylabel("median time of a step")
    label_ends(axes, ends)
    low, high = median.index[[0, -1]]
    picked = median.index[np.unique(np.linspace(0, len(median) - 1, 10).astype(int))]
    table = median.loc[picked].rename(columns=lambda name: f"{name} ns").rename_axis("bodies")
    name = first_label(columns)
    if np.isnan(power[[name, "physics"]]).any():
        title = f"From {low} to {high} bodies: too few or too narrow a range for an exponent"
    else:
        title = (
            f"With the number of bodies, from {low} to {high}, collision time ({name}) grows to the power "
            f"{power[name]:.2f} and physics time to the power {power['physics']:.2f}"
        )
    what = (
        f"Median time over the steps with as many bodies, n = {len(steps.hits) - 1} steps; beside a name the exponent "
        f"fitted to the logarithms from {t.SQUARE_FROM} bodies on.{timing_note(run)}"
    )
    return Figure(title, svg_of(fig), caption(run, what, thesis(kind, 2), nine=False), table, key)


def per_collision(run, kind, key):
    """Time over collisions, step by step; steps without any are left out."""
    steps, columns, physics = parts(run)
    contacts = physics.contacts.to_numpy(dtype=float)
    shown = {
        label: (steps.time_ns[:, i], steps.hits[:, i], style(algorithm(run, label), label))
        for label, i in columns.items()
    }
    shown["physics"] = (physics.time_ns.to_numpy(dtype=float), contacts, PHYSICS)
    fig, axes = figure(height=3.8)
    ends, rows, costs = [], {}, {}
    number = np.arange(len(contacts))
    for name, (time, hits, look) in shown.items():
        there = (hits > 0) & (number > 0)
        if not there.any():
            continue
        each, at = time[there] / hits[there], number[there]
        middle, value = binned(each / 1e9, np.median)
        _, where = binned(at, np.mean)
        axes.plot(where, value, **look, markevery=(len(middle) // 12, max(1, len(middle) // 6)), markersize=5)
        ends.append((value[-1], name, look))
        early = at < START * len(number)
        costs[name] = np.where(there, time / np.where(there, hits, 1), np.nan)
        rows[name] = (there.sum(), np.median(each), swing(each[early]), swing(each[~early]))
    if not rows:
        raise NotDrawn("there is no step with a collision")
    log_seconds(axes)
    axes.set_xlabel("step")
    axes.set_ylabel("time per collision")
    axes.margins(x=0.01)
    label_ends(axes, ends)
    names = ["steps with collisions", "median ns per collision", "p95 / p5, first fifth", "p95 / p5, after"]
    table = pd.DataFrame.from_dict(rows, orient="index", columns=names)
    table = table.join(stretches(costs, median_of_some).add_prefix("median ns, ")).rename_axis("part of a step")
    name = table.index[0]
    row = table.loc[name]
    early, after = row.iloc[2], row.iloc[3]
    if np.isnan(early) or np.isnan(after):
        title = f"A collision costs {name} {duration(row.iloc[1])} (median)"
        title += "; too few steps have one to tell whether that settles"
    else:
        settles = after < early
        title = (
            f"Time per collision ({name}, median {duration(row.iloc[1])}) "
            f"{'settles' if settles else 'does not settle'} after the first fifth of the steps, "
            f"{'as in' if settles else 'unlike in'} the thesis: its 95th percentile is {digits(early)} times the 5th "
            f"there and {digits(after)} times afterwards"
        )
    if "physics" in table.index and name != "physics":
        title += f"; a contact costs the physics {duration(table['median ns per collision']['physics'])}"
    what = (
        "Collision time over the pairs that the same algorithm reports, physics time over the integrator's contacts; "
        f"n = {len(number) - 1} steps, those without a collision left out, each point a median.{timing_note(run)}"
    )
    return Figure(title, svg_of(fig), caption(run, what, thesis(kind, 3), nine=False), table, key)


def median_of_some(values):
    """The median of those that are not NaN; NaN for none."""
    return np.median(values[~np.isnan(values)]) if not np.isnan(values).all() else np.nan


def swing(values):
    """The 95th percentile over the 5th; NaN for fewer than 10 values."""
    if len(values) < 10:
        return np.nan
    low, high = np.percentile(values, (5, 95))
    return float(high / low) if low > 0 else np.nan


FIGURES = [
    ("Collision, physics and total time", parts_of_a_step),
    ("Collision and physics time against collisions", against_collisions),
    ("Collision and physics time against bodies", against_bodies),
    ("Time per collision", per_collision),
]
