"""Time and hits step by step, against each other and against the number of bodies: figures 5.5 to 5.13 and 5.17 to 5.25
of the thesis, every algorithm in one figure."""

import numpy as np
import pandas as pd
from matplotlib.ticker import MaxNLocator

from ..tables import thresholds as t
from .drawing import key as key_of
from .drawing import (
    NotDrawn,
    algorithm,
    binned,
    caption,
    chosen,
    correlation,
    digits,
    full,
    heads,
    label_ends,
    left_out,
    log_seconds,
    panels,
    seconds,
    short,
    steps_of,
    stretch,
    stretches,
)
from .figure import PALETTE, Figure, figure, style, svg_of
from ..words import duration, listed, plural

THESIS = {"box": "figures 5.5 to 5.13", "falling": "figures 5.17 to 5.25"}
TRUTH = "#DADADA"

# What the thesis read off its own curves, figures 5.5 to 5.13 (box) and 5.17 to 5.25 (falling).
SEEN = {
    "box": {
        "G": "low and steady, hardly follows hits or bodies",
        "H": "low and steady, follows least; many hits",
        "J": "somewhat slower; hits unlike bodies",
        "K": "slowest by far, grows little with bodies",
        "L": "grows markedly with many bodies; hits like G's",
        "P": "slower, odd high peaks; hits like those of G and L",
        "O": "time and hits waver, hits more with more bodies",
        "I": "very slow, large swings",
        "U": "nearly as I, slightly slower",
    },
    "falling": {
        "G": "very low, very steady",
        "H": "very low, very steady; many more hits",
        "J": "very low, some swings; fewer hits",
        "K": "slowest by far, chaotic, unlike its hits",
        "L": "low and steady, hardly follows hits",
        "P": "steady but very slow; few hits",
        "O": "low and steady",
        "I": "slow, no relation to hits; fewest hits",
        "U": "slightly faster than I; hits nearly the same",
    },
}


def time_per_step(run, kind, key):
    """All algorithms over the steps, one axis."""
    steps = steps_of(run)
    drawn = chosen(run)
    names = full(run, drawn)
    if not (steps.time_ns[:, [steps.labels.index(label) for label in drawn]] > 0).any():
        raise NotDrawn("the file's times are all 0")
    fig, axes = figure(height=4.6)
    ends = []
    for label in drawn:
        look = style(algorithm(run, label), label) | {"gid": f"of:{label}"}
        middle, times = binned(steps.time_ns[:, steps.labels.index(label)] / 1e9, np.median)
        axes.plot(middle, times, **look, markevery=(len(middle) // 12, max(1, len(middle) // 6)), markersize=5)
        ends.append((times[-1], names[label], look))
    log_seconds(axes)
    axes.set_xlabel("step")
    axes.set_ylabel("time per step")
    axes.margins(x=0.01)
    label_ends(axes, ends)

    table = spread(steps)
    mean, ratio = table["mean ns"][drawn], table["p95 / p5"][drawn].dropna()
    mean = mean[mean > 0]
    slow, fast = mean.idxmax(), mean.idxmin()
    title = f"{slow} takes {duration(mean[slow])} per step, "
    title += f"{digits(mean[slow] / mean[fast])} times as long as {fast}" if slow != fast else "the only algorithm here"
    if ratio.nunique() > 1:
        calm, lively = ratio.idxmin(), ratio.idxmax()
        title += (
            f"; the times of {lively} spread most (their 95th percentile is {digits(ratio[lively])} times the 5th), "
            f"those of {calm} least ({digits(ratio[calm])} times)"
        )
    when = " with all bodies there" if steps.grows else ""
    what = (
        f"Time of an algorithm for all pairs of a step, preparation included; n = {len(steps.hits)} steps, "
        f"{stretch(steps.hits)}. Spread is over the {steps.full.sum()} steps{when}.{left_out(run)}"
    )
    return Figure(title, svg_of(fig), caption(run, what, THESIS.get(kind, "")), table, key)


def spread(steps):
    """Per algorithm, ns: mean, median, least and greatest time; the ratio of percentiles while all are there; and the
    median over each tenth of the steps."""
    times = pd.DataFrame(steps.time_ns, columns=pd.Index(steps.labels, name="algorithm"))
    low, high = np.percentile(steps.time_ns[steps.full], (5, 95), axis=0)
    table = {
        "mean ns": times.mean(),
        "median ns": times.median(),
        "least ns": times.min(),
        "greatest ns": times.max(),
        "p95 / p5": high / np.where(low > 0, low, np.nan),
    }
    parts = stretches(dict(times.items()), np.median).add_prefix("median ns, ")
    return pd.DataFrame(table).join(parts)


def hits_per_step(run, kind, key):
    """Pairs reported over the steps, beside those that meet."""
    steps = steps_of(run)
    drawn = chosen(run, times=False)
    names = full(run, drawn)
    fig, axes = figure(height=4.6)
    middle, truth = binned(steps.truth, np.mean)
    axes.fill_between(middle, truth, color=TRUTH, linewidth=0)
    ends = [(truth[-1], "truly meet", {"color": "#777777"})]
    for label in drawn:
        look = style(algorithm(run, label), label) | {"gid": f"of:{label}"}
        _, hits = binned(steps.hits[:, steps.labels.index(label)], np.mean)
        axes.plot(middle, hits, **look, markevery=(len(middle) // 12, max(1, len(middle) // 6)), markersize=5)
        ends.append((hits[-1], names[label], look))
    axes.set_yscale("symlog", linthresh=1, linscale=0.4)
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_ylim(bottom=0)
    axes.set_xlabel("step")
    axes.set_ylabel("pairs reported per step")
    axes.margins(x=0.01)
    label_ends(axes, ends)

    total, meet = pd.Series(steps.hits.sum(axis=0), steps.labels), steps.truth.sum()
    table = pd.DataFrame({"hits": total, "per step": total / len(steps.hits), "hits / pairs that meet": total / meet})
    table.loc["(truly meet)"] = [meet, meet / len(steps.hits), 1.0 if meet else np.nan]
    each = {label: steps.hits[:, column] for column, label in enumerate(steps.labels)} | {"(truly meet)": steps.truth}
    table = table.join(stretches(each, np.mean).add_prefix("mean, "))
    total = total[drawn]
    if not total.sum():
        title = f"No algorithm reports anything; {meet:.0f} {plural(meet, 'pair meets', 'pairs meet')}"
    else:
        most, fewest = total.idxmax(), total.idxmin()

        def share(label):
            return f"{digits(total[label] / meet)} times" if meet else f"{total[label]:.0f}"

        title = f"{most} reports the most pairs, {share(most)} "
        title += "those that meet" if meet else "though none meet"
        title += f"; {fewest} the fewest, {share(fewest)}" if most != fewest else ""
    what = (
        f"Pairs reported at a step; the grey area ends at the pairs that truly meet; n = {len(steps.hits)} steps, "
        f"{stretch(steps.hits, 'the mean')}. The axis is linear below 1.{left_out(run, times=False)}"
    )
    table = table.astype({"hits": int}).rename_axis("algorithm")
    return Figure(title, svg_of(fig), caption(run, what, THESIS.get(kind, ""), times=False), table, key)


def follows_table(steps):
    """Per algorithm: Pearson's correlation of time and hits, over all steps and while all bodies are there; what one
    more hit costs there, ns (the slope of the line of least squares), and how many hits there are."""
    rows = {}
    for i, label in enumerate(steps.labels):
        time, hits = steps.time_ns[:, i], steps.hits[:, i]
        still = correlation(hits[steps.full], time[steps.full])
        slope = np.nan
        if not np.isnan(still):
            slope = still * time[steps.full].std() / hits[steps.full].std()
        rows[label] = (correlation(hits, time), still, slope, hits.mean())
    columns = ["r, all steps", "r, all bodies there", "ns per hit", "hits per step"]
    return pd.DataFrame.from_dict(rows, orient="index", columns=columns).rename_axis("algorithm")


def follows_title(names, r):
    """names: how each algorithm is called; r: its correlation. One sentence that puts each where it belongs."""
    values = dict(zip(names, r))
    follow = [name for name in names if values[name] >= t.FOLLOWS]
    apart = [name for name in names if abs(values[name]) < t.FOLLOWS]
    against = [name for name in names if values[name] <= -t.FOLLOWS]
    parts = []
    if follow:
        parts.append(f"Time follows hits for {listed(follow)} ({span(values[name] for name in follow)})")
    if apart:
        start = "it does not" if parts else "Time does not follow hits"
        parts.append(f"{start} for {listed(apart)} (|r| < {t.FOLLOWS})")
    if against:
        many = span(values[name] for name in against)
        parts.append(f"{'it' if parts else 'Time'} falls as hits rise for {listed(against)} ({many})")
    if len(follow) + len(apart) + len(against) < len(names):
        unknown = listed(name for name in names if np.isnan(values[name]))
        start = "it" if parts else "Whether time follows hits"
        parts.append(f"{start} cannot be told for {unknown}, where one of them does not vary")
    return "; ".join(parts)


def span(values):
    values = list(values)
    low, high = f"{min(values):.2f}", f"{max(values):.2f}"
    return f"r = {low}" if low == high else f"r from {low} to {high}"


def curves_together(run, kind, key):
    """Per algorithm, time, hits and bodies over the steps, each by its own mean: do the curves have one form?"""
    steps = steps_of(run)
    drawn = chosen(run)
    names = heads(run, drawn)
    table = follows_table(steps)
    r = table["r, all bodies there"]
    fig, axes = panels(figure, len(drawn))
    curves = [("time", steps.time_ns, PALETTE["blue"], "-"), ("hits", steps.hits, PALETTE["orange"], "--")]
    for panel, label in zip(axes, drawn):
        column = steps.labels.index(label)
        if steps.grows:
            middle, bodies = binned(steps.bodies / steps.bodies.mean(), np.mean, 100)
            panel.plot(middle, bodies, color=PALETTE["grey"], linestyle=":", linewidth=1.6, label="bodies")
        for name, values, colour, line in curves:
            middle, mean = binned(values[:, column], np.mean, 100)
            if mean.any():
                panel.plot(middle, mean / mean.mean(), color=colour, linestyle=line, linewidth=1.2, label=name)
        panel.set_ylim(0, 3)
        panel.set_yticks([0, 1, 2, 3])
        panel.xaxis.set_major_locator(MaxNLocator(3, integer=True))
        panel.set_title(names[label], fontsize=9)
        note = "r: no variation" if np.isnan(r[label]) else f"r = {r[label]:.2f}"
        panel.text(0.04, 0.93, note, transform=panel.transAxes, va="top", fontsize=9)
    handles = {name: line for panel in axes for line, name in zip(*panel.get_legend_handles_labels())}
    fig.suptitle(" ", fontsize=9)  # room for the legend
    fig.legend(list(handles.values()), [name + " / own mean" for name in handles], loc="upper center", ncol=3,
               fontsize=9, frameon=False, borderaxespad=0.1)
    fig.supxlabel("step", fontsize=9.5)
    when = f"the {steps.full.sum()} steps with all {steps.bodies.max()} bodies" if steps.grows else "all steps"
    what = (
        f"Time, hits{' and bodies' if steps.grows else ''} at a step over their mean, n = {len(steps.hits)} steps in "
        f"100 stretches at most, cut at 3; r is Pearson's correlation of time and hits over {when}.{left_out(run)}"
    )
    title = follows_title([short(run, label) for label in drawn], [r[label] for label in drawn])
    if seen := SEEN.get(kind):
        table["the thesis saw"] = [seen.get(key_of(run, label), "") for label in table.index]
    return Figure(title, svg_of(fig), caption(run, what, THESIS.get(kind, "")), table, key)


def time_against_hits(run, kind, key):
    """Per algorithm a dot per step; axes of its own, for hits and times differ a thousandfold between algorithms."""
    steps = steps_of(run)
    drawn = chosen(run)
    names = heads(run, drawn)
    table = follows_table(steps)
    if table["ns per hit"].isna().all():
        raise NotDrawn("no algorithm's hits and time vary")
    fig, axes = panels(figure, len(drawn))
    every = np.arange(0, len(steps.hits), -(-len(steps.hits) // 2000))
    for panel, label in zip(axes, drawn):
        column = steps.labels.index(label)
        time, hits = steps.time_ns[:, column] / 1e9, steps.hits[:, column]
        dots = panel.scatter(hits[every], time[every], s=5, alpha=0.6, c=steps.bodies[every], cmap="viridis_r",
                             vmin=0, vmax=steps.bodies.max(), linewidths=0, rasterized=True)
        if not np.isnan(slope := table["ns per hit"][label]):
            x = np.array([hits[steps.full].min(), hits[steps.full].max()])
            y = time[steps.full].mean() + slope / 1e9 * (x - hits[steps.full].mean())
            panel.plot(x, y, color=PALETTE["vermilion"], linewidth=1.3)
        high = np.percentile(time, 99.5)
        panel.set_ylim(0, 1.1 * high if high > 0 else 1)
        panel.set_xlim(left=0, right=max(1, hits.max()) * 1.03)
        panel.xaxis.set_major_locator(MaxNLocator(3, integer=True))
        panel.yaxis.set_major_locator(MaxNLocator(3))
        seconds(panel.yaxis)
        panel.set_title(names[label], fontsize=9)
    if steps.grows:
        bar = fig.colorbar(dots, ax=list(axes), location="top", aspect=60, pad=0.01)
        bar.set_label("bodies", fontsize=9)
        bar.ax.tick_params(labelsize=9)
    fig.supxlabel("hits at a step", fontsize=9.5)
    fig.supylabel("time of a step", fontsize=9.5)
    cost = table.loc[drawn, "ns per hit"][table.loc[drawn, "r, all bodies there"] >= t.FOLLOWS]
    if cost.empty:
        title = f"No algorithm's time follows its hits (r below {t.FOLLOWS})"
    else:
        dear, cheap = cost.idxmax(), cost.idxmin()
        title = f"Where time follows hits, one hit more costs {duration(cost[cheap])} ({cheap})"
        title += f" to {duration(cost[dear])} ({dear})" if dear != cheap else ""
    when = f" over the {steps.full.sum()} steps with all bodies there" if steps.grows else ""
    what = (
        f"A dot per step, n = {len(every)} of {len(steps.hits)}; the line is the one of least squares{when}, its slope "
        "is the cost of a hit. The slowest 0.5 % of steps may lie above a panel; panels have axes of their own."
        f"{left_out(run)}"
    )
    return Figure(title, svg_of(fig), caption(run, what, THESIS.get(kind, "")), table, key)


def time_against_bodies(run, kind, key):
    """The median time at each number of bodies, and the exponent fitted to it."""
    steps = steps_of(run)
    if not steps.grows:
        raise NotDrawn(f"the number of bodies, {steps.bodies.max()}, does not change")
    drawn = chosen(run)
    names = full(run, drawn)
    median = pd.DataFrame(steps.time_ns, columns=steps.labels).groupby(steps.bodies).median()
    median = median[median.index > 0]
    power = exponents(median)
    fig, axes = figure(height=4.6)
    ends = []
    for label in drawn:
        look = style(algorithm(run, label), label) | {"gid": f"of:{label}"}
        axes.plot(median.index, median[label] / 1e9, **look, markevery=max(1, len(median) // 6), markersize=5)
        ends.append((median[label].iloc[-1] / 1e9, named(names[label], power[label]), look))
    axes.set_xscale("log")
    low, high = median.index[[0, -1]]
    between = {tick for tick in (2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000) if low * 1.3 < tick < high / 1.3}
    ticks = sorted({low, high} | between)
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    log_seconds(axes)
    axes.set_xlabel("bodies, fixed ones included")
    axes.set_ylabel("median time of a step")
    label_ends(axes, ends)
    table = median.T.rename_axis("algorithm")
    table = table[table.columns[np.unique(np.linspace(0, len(table.columns) - 1, 8).astype(int))]]
    table.columns = [f"ns at {bodies}" for bodies in table.columns]
    table.insert(0, "exponent", power)
    power = power[drawn].dropna()
    if power.empty:
        title = f"Time from {low} to {high} bodies: too few or too narrow a range for an exponent"
    else:
        steep, flat = power.idxmax(), power.idxmin()
        square = [short(run, label) for label in power.index if t.SQUARE[0] <= power[label] <= t.SQUARE[1]]
        title = f"Time grows with the number of bodies to the power {power[flat]:.2f} ({flat})"
        title += f" to {power[steep]:.2f} ({steep})" if steep != flat else ""
        title += f"; with its square: {listed(square)}" if square else "; with its square: none"
    what = (
        f"Median time over the steps with as many bodies, {len(median)} numbers of bodies, n = {len(steps.hits)} "
        f"steps. Beside a name: the exponent fitted to the logarithms from {t.SQUARE_FROM} bodies on; {t.SQUARE[0]} "
        f"to {t.SQUARE[1]} counts as the square.{left_out(run)}"
    )
    return Figure(title, svg_of(fig), caption(run, what, THESIS.get(kind, "")), table, key)


def named(name, power):
    """A line's name with its exponent, where it has one."""
    return name if np.isnan(power) else f"{name}  {power:.2f}"


def exponents(median):
    """Per column, the exponent of `median` (index: number of bodies), from SQUARE_FROM bodies on; NaN where the number
    does not double or a time is 0."""
    rows = median[median.index >= t.SQUARE_FROM]
    if len(rows) < 3 or rows.index.max() < 2 * rows.index.min():
        return pd.Series(np.nan, median.columns)
    bodies = np.log(rows.index.to_numpy(dtype=float))
    positive = rows.columns[(rows > 0).all()]
    fitted = {label: np.polyfit(bodies, np.log(rows[label].to_numpy(dtype=float)), 1)[0] for label in positive}
    return pd.Series(fitted, dtype=float).reindex(median.columns)


FIGURES = [
    ("Time per step", time_per_step),
    ("Hits per step", hits_per_step),
    ("Time, hits and bodies together", curves_together),
    ("Time against hits", time_against_hits),
    ("Time against bodies", time_against_bodies),
]
