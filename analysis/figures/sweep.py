"""A sweep as sections of a report: curves over its parameters, spreads over its seeds, what holds at every point. As
many figures as there are parameters, not points."""

import numpy as np
import pandas as pd
from matplotlib.ticker import FixedLocator, NullLocator

from .drawing import digits, guarded, label_ends, log_seconds, shortened
from .figure import Figure, Points, Section, Table, figure, slug, style, svg_of
from ..tables import sweeps
from ..words import counted, listed, verb

MOST_LABELS = 16  # lines in one figure
MOST_SETTINGS = 4  # figures of one quantity over one parameter; the tables have all
MOST_MACHINES = 3
UNSEEDED = "Every point has one seed, so what is chance in it cannot be said; seeds = 8 in the sweep's file would tell."
QUANTITIES = {  # column -> (what it is, axis)
    "error": ("error", "error = (FP + FN) / (TP + FP + FN)"),
    "time_mean_ns": ("time", "mean time per step"),
}


def sections(table):
    """The sections of the sweep whose frame (load_sweep) this is."""
    drawn = curves(table)
    return [
        Section("Findings", findings(table)),
        *([Section("Over the parameters", drawn)] if drawn else []),
        Section("Over the seeds", [guarded("The spread over seeds", draws, table)] if seeded(table) else [UNSEEDED]),
        Section("What holds at every point", holding(table)),
        Section("Points", [of_points(table)]),
    ]


def lead(table):
    done = sweeps.points(table)
    over = [f"{done[name].nunique()} of {name}" for name in table.attrs["parameters"]]
    words = f"{table.attrs['title']}: {counted(len(done), 'point')}{' over ' + listed(over) if over else ''}"
    return [
        f"{words}; {int((done.status == 'done').sum())} are done. Sweep “{table.attrs['sweep']}” in "
        f"{table.attrs['folder']}."
    ]


def warnings(table):
    """What a reader must know before believing a number; one line each."""
    done = sweeps.points(table)
    lines = [f"{row.point}: {row.status}: {row.reason}" for row in done[done.status != "done"].head(12).itertuples()]
    if (bad := int((done.status != "done").sum())) > 12:
        lines.append(f"And {bad - 12} more points are not done; the section Points has all.")
    rows = sweeps.answers(table)
    if rows.empty:
        lines.append("No point has answers of an algorithm; nothing can be drawn.")
    machines = list(dict.fromkeys(sweeps.machine(rows))) if len(rows) else []
    if len(machines) > 1:
        lines.append(
            f"Points were timed on {len(machines)} unlike processors or builds ({'; '.join(machines)}): their times"
            " are drawn apart, errors compare."
        )
    if any("debug" in machine.lower() for machine in machines):
        lines.append("A debug build timed some points; those times mean nothing.")
    if beside := sweeps.side_by_side(table):
        lines.append(
            f"{counted(sum(beside.values()), 'point')} ran while another did on the same machine ({listed(beside)}):"
            " their times disturb each other. On a machine alone, with -j 1, they are surer."
        )
    if seeded(table):
        same = [name for name, part in sweeps.settings(done) if part.digest.nunique() < (part.digest != "").sum()]
        if same:
            where = f" at {listed(same)}" if same != [""] else ""
            lines.append(f"Different seeds gave one and the same result{where}: there they draw nothing.")
    return lines


def seeded(table):
    return "seed" in table and table.seed.nunique() > 1


# ---- Findings


def findings(table):
    rows, lines = sweeps.answers(table), []
    done = sweeps.points(table)
    lines.append(f"{int((done.status == 'done').sum())} of {counted(len(done), 'point')} are done.")
    if rows.empty:
        return [Points("In short", lines)]
    everywhere = [
        fact.text for fact in sweeps.facts(table) if fact.held == fact.of and fact.kind in ("error", "time", "promise")
    ]
    if everywhere:
        lines.append(f"At every point: {'; '.join(everywhere)}.")
    for column, does in (("error", "errs less"), ("time_mean_ns", "is quicker")):
        changing, pairs = sweeps.undecided(rows, column)
        if not pairs:
            continue
        # Equal errors are no other order; times that tell no difference leave it open.
        left_open = sweeps.untold(rows, column) if column == "time_mean_ns" else 0
        text = (
            f"Who {does} is the same at every point for {pairs - len(changing) - left_open} of"
            f" {counted(pairs, 'pair')} of labels"
        )
        if left_open:
            text += f", and not told at every point for {left_open}"
        some = "; ".join(
            f"{a} than {b} at {one} of {of}"
            for a, b, one, _, of in sorted(changing, key=lambda pair: pair[2] / pair[4])[:3]
        )
        lines.append(text + (f"; the least sure: {some}." if changing else "."))
    if seeded(table):
        lines += chance(rows)
    for name in sweeps.axes(table):
        lines += [trend(part, name, setting) for setting, part in sweeps.settings(rows, [name])[:MOST_SETTINGS]]
    return [Points("In short", [line for line in lines if line])]


def chance(rows):
    """What of the errors is chance: the label whose error spreads most over the seeds, and how far, and the median."""
    table = sweeps.spread(rows, "error", [*setting_names(rows), "label"]).dropna(subset=["sd"])
    if table.empty:
        return []
    worst = table.loc[table.sd.idxmax()]
    where = at(worst, setting_names(rows))
    return [
        f"Over {int(table['count'].max())} seeds the standard deviation of an error is {digits(table.sd.median())} in"
        f" the median of the labels, and {digits(worst.sd)} for {worst.label}, the greatest ({digits(worst['mean'])},"
        f" from {digits(worst.least)} to {digits(worst.most)}){where}."
    ]


def at(row, names):
    return f" at {', '.join(f'{name} {sweeps.text(row[name])}' for name in names)}" if names else ""


def setting_names(rows):
    return [name for name in rows.attrs["parameters"] if name != "seed" and rows[name].nunique() > 1]


def trend(rows, name, setting):
    """How error and time change from the first to the last value of a number."""
    if not numeric(rows[name]):
        return ""
    low, high = rows[name].min(), rows[name].max()
    ends = [rows[rows[name] == value].groupby("label")[["error", "time_mean_ns"]].mean() for value in (low, high)]
    both = ends[0].index.intersection(ends[1].index)
    if low == high or not len(both):
        return ""
    change = (ends[1].error - ends[0].error)[both]
    factor = (ends[1].time_mean_ns / ends[0].time_mean_ns)[both]
    most, grows, stays = change.abs().idxmax(), factor.idxmax(), factor.idxmin()
    where = f" ({setting})" if setting else ""
    words = f"From {name} {sweeps.text(low)} to {sweeps.text(high)}{where} the error of {most} changes most, "
    words += f"{digits(ends[0].error[most])} to {digits(ends[1].error[most])}"
    if one_machine(rows):
        words += f"; the time of {grows} grows most, {digits(factor[grows])}-fold, that of {stays} least,"
        words += f" {digits(factor[stays])}-fold"
    return words + "."


def one_machine(rows):
    return sweeps.machine(rows).nunique() == 1


# ---- Curves


def curves(table):
    parts, rows = [], sweeps.answers(table)
    if rows.empty:
        return parts
    for name in sweeps.axes(table):
        every = sweeps.settings(rows, [name])
        for setting, part in every[:MOST_SETTINGS]:
            for column in QUANTITIES:
                for number, mine in enumerate(by_machine(part) if column != "error" else [part], 1):
                    key = slug(f"sweep {name} {setting} {column} {number}")
                    parts.append(
                        guarded(f"{QUANTITIES[column][0]} over {name}", curve, mine, name, column, setting, key)
                    )
        if len(every) > MOST_SETTINGS:
            parts.append(
                f"Of {len(every)} settings beside {name} the first {MOST_SETTINGS} are drawn; sweep.csv has all."
            )
    return parts


def by_machine(rows):
    """The rows of each kind of machine, those of most points first."""
    kinds = sweeps.machine(rows)
    return [rows[kinds == kind] for kind in kinds.value_counts().index[:MOST_MACHINES]]


def curve(rows, name, column, setting, key):
    """The figure of `column` over a parameter, a line per label: the mean over seeds, within the least and the most."""
    what, axis = QUANTITIES[column]
    labels = list(dict.fromkeys(rows.label))
    table = sweeps.spread(rows, column, ["label", name])
    values = list(dict.fromkeys(rows[name]))
    number = numeric(rows[name])
    places = {value: value if number else place for place, value in enumerate(values)}
    scale = 1e9 if column != "error" else 1
    names = shortened(labels, 26)
    fig, axes = figure(height=4.6)
    ends = []
    for label in labels[:MOST_LABELS]:
        mine = table[table.label == label].sort_values(name, key=lambda v: v.map(places))
        x, look = mine[name].map(places).to_numpy(float), style(label)
        axes.plot(x, mine["mean"] / scale, markersize=4, **look)
        axes.fill_between(x, mine.least / scale, mine.most / scale, color=look["color"], alpha=0.13, linewidth=0)
        ends.append((mine["mean"].iloc[-1] / scale, names[label], look))
    axes.set(xlabel=f"{name}", ylabel=axis)
    if number and min(values) > 0 and max(values) > 8 * min(values):
        axes.set(xscale="log")
    if len(values) <= 12:
        axes.xaxis.set_major_locator(FixedLocator(sorted(places.values())))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xticklabels([sweeps.text(value) for value, _ in sorted(places.items(), key=lambda pair: pair[1])])
    if column == "error":
        axes.set(ylim=(-0.03, 1.03))
    else:
        log_seconds(axes)
    label_ends(axes, ends)
    count = int(table["count"].max())
    seeds = (
        f"Lines are means over {count} seeds, the shades reach from the least to the most"
        if count > 1
        else "One seed each"
    )
    left_out = (
        f" The first {MOST_LABELS} of {len(labels)} labels are drawn; the table has all."
        if len(labels) > MOST_LABELS
        else ""
    )
    caption = f"{rows.attrs['title']}{f', {setting}' if setting else ''}: {what} over {name}, "
    caption += f"{counted(rows.point.nunique(), 'point')}. {seeds}.{left_out}"
    if column != "error":
        caption += f" Timed by {sweeps.machine(rows).iloc[0]}."
    return Figure(
        headline(table, name, values, column, setting, number), svg_of(fig), caption, wide(table, name, column), key
    )


def headline(table, name, values, column, setting, number):
    """The finding of a curve."""
    where = f" ({setting})" if setting else ""
    best = {}  # value -> who; several where they are equal
    for value, rows in table.groupby(name, sort=False):
        best[value] = list(rows.label[rows["mean"] == rows["mean"].min()])
    places = {}  # who -> where
    for value, labels in best.items():
        places.setdefault(listed(labels), []).append(sweeps.text(value))
    if len(places) == 1:
        labels = next(iter(best.values()))
        does = verb(labels, "errs least", "err least") if column == "error" else "is the quickest"
        first = f"{listed(labels)} {does} at every value of {name}"
    else:
        each = [f"{labels} at {listed(values_)}" for labels, values_ in places.items()]
        does = "errs least" if column == "error" else "is the quickest"
        first = f"Which label {does} depends on {name}: {'; '.join(each[:4])}"
    ends = table.set_index([name, "label"])["mean"]
    low, high = (min(values), max(values)) if number else (values[0], values[-1])
    change = (ends[high] / ends[low] if column != "error" else ends[high] - ends[low]).dropna()
    if column == "error":
        most = change.abs().idxmax()
        words = f"changes most, {digits(ends[low, most])} to {digits(ends[high, most])}"
        return f"{first}; from {sweeps.text(low)} to {sweeps.text(high)} that of {most} {words}{where}"
    most = change.idxmax()
    words = f"grows most, {digits(change[most])}-fold"
    return f"{first}; from {sweeps.text(low)} to {sweeps.text(high)} that of {most} {words}{where}"


def wide(table, name, column):
    """Mean, and standard deviation where there are seeds, a row per label and a column per value."""
    unit, scale = (" (µs)", 1e3) if column != "error" else ("", 1)
    found = {}
    for value, rows in table.groupby(name, sort=False):
        rows = rows.set_index("label")
        found[f"{name} {sweeps.text(value)}{unit}"] = rows["mean"] / scale
        if rows.sd.notna().any():
            found[f"± at {sweeps.text(value)}"] = rows.sd / scale
    frame = pd.DataFrame(found)
    frame.index.name = "label"
    return frame


def numeric(values):
    return pd.api.types.is_numeric_dtype(values) and not pd.api.types.is_bool_dtype(values)


# ---- Seeds


def draws(table):
    """Error and time of every draw, label by label, for the first setting; one figure."""
    rows = sweeps.answers(table)
    setting, mine = sweeps.settings(rows)[0]
    order = list(mine.groupby("label")["error"].mean().sort_values(kind="stable").index)
    place = {label: len(order) - 1 - number for number, label in enumerate(order)}
    timed = by_machine(mine)[0]
    names = shortened(order, 26)
    fig, (left, right) = figure(1, 2, height=0.9 + 0.24 * max(len(order), 4), sharey=True)
    for axes, part, column, scale in ((left, mine, "error", 1), (right, timed, "time_mean_ns", 1e9)):
        for label, some in part.groupby("label", sort=False):
            color = style(label)["color"]
            y = np.full(len(some), place[label])
            axes.plot(some[column] / scale, y, "o", markersize=5, color=color, alpha=0.4, markeredgewidth=0)
            axes.plot(some[column].mean() / scale, place[label], "|", markersize=13, color="black", markeredgewidth=1.5)
    left.set(xlabel="error", yticks=list(place.values()), yticklabels=[names[label] for label in place])
    right.set(xlabel="mean time per step")
    log_seconds(right, "x")
    for text in right.get_xticklabels():
        text.set_fontsize(9)
    table_ = sweeps.spread(mine, "error", ["label"]).set_index("label").loc[order].drop(columns="count")
    times = sweeps.spread(timed, "time_mean_ns", ["label"]).set_index("label").drop(columns="count") / 1e3
    table_ = table_.rename(columns=lambda name: f"error, {name}").join(
        times.rename(columns=lambda name: f"time, {name} (µs)")
    )
    seeds = mine.seed.nunique()
    changing, pairs = sweeps.undecided(mine, "error")
    title = f"Over {seeds} seeds the order by error is the same for {pairs - len(changing)} of "
    title += f"{counted(pairs, 'pair')} of labels"
    if pairs and not changing:
        title = f"Over {seeds} seeds no two labels change their order by error"
    if not pairs:
        title = f"Over {seeds} seeds the error is {digits(mine.error.min())} to {digits(mine.error.max())}"
    caption = (
        f"{mine.attrs['title']}{f', {setting}' if setting else ''}: a dot for every seed, a bar for the mean; the least"
        f" mean error first. Times of {sweeps.machine(timed).iloc[0]}, with what disturbed them."
    )
    others = len(sweeps.settings(rows)) - 1
    return Figure(
        title,
        svg_of(fig),
        caption + (f" {counted(others, 'other setting')} of the sweep: above, and in sweep.csv." if others else ""),
        table_,
        "sweep-seeds",
    )


# ---- What holds


def holding(table):
    rows = sweeps.answers(table)
    if rows.empty:
        return ["No point has answers, so nothing holds."]
    facts = sweeps.facts(table)
    parts = [
        Points(
            f"At every one of {counted(facts[0].of, 'point')}",
            [f"{fact.text}." for fact in facts if fact.held == fact.of] or ["Nothing."],
        )
    ]
    some = [fact for fact in facts if fact.held < fact.of]
    if some:
        frame = pd.DataFrame(
            {"finding": [fact.text for fact in some], "at": [f"{fact.held} of {fact.of}" for fact in some]}
        )
        parts.append(Table("At some points", frame, "What of this kind holds at other points is the rest of them."))
    if rows.label.nunique() > 1:
        paired = "whose times over the same steps tell no difference"
        for column, words, even in (
            ("error", "Who errs less than whom", "equals"),
            ("time_mean_ns", "Who is quicker than whom", f"equals, and labels {paired},"),
        ):
            below, both = sweeps.order(rows, column)
            frame = below.astype(str)
            for label in frame.index:
                frame.loc[label, label] = "–"
            frame.columns = [f"than {label}" for label in frame.columns]
            frame.index.name = "label"
            parts.append(
                Table(
                    words,
                    frame,
                    f"At how many of {int(both.to_numpy().max())} points the row's label is below the column's; {even}"
                    " count for neither.",
                )
            )
    parts.append(guarded("The thesis's statements", judged, table))
    return parts


def judged(table):
    frame, lost = sweeps.statements(table)
    if frame.empty:
        return f"None of the thesis's statements can be judged on these points{'; ' + lost[0] if lost else ''}."
    sure = int(((frame.confirmed == 0) | (frame.refuted == 0)).sum())
    caption = (
        f"Of {counted(len(frame), 'statement')} that these points can judge, {sure} have one verdict at all of them."
    )
    return Table(
        "What the thesis said, point by point",
        frame,
        f"{caption}{' Not read: ' + '; '.join(lost[:3]) + '.' if lost else ''}",
    )


def of_points(table):
    done = sweeps.points(table)
    frame = done[["point", "status", "reason"]].assign(**{"wall time (s)": done.wall_time_s, "host": done.host})
    frame = frame.assign(bodies=done.bodies.astype("Int64"), steps=done.steps.astype("Int64"), digest=done.digest)
    return Table(
        "Every point",
        frame,
        "Each is a result of its own in the folder points; a digest covers everything but times and names of machines.",
    )
