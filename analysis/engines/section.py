"""The section "Engines": other people's engines and libraries side by side, where a file has at least two of them."""

import numpy as np
import pandas as pd

from . import answers as engines
from ..tables import pareto
from ..figures.drawing import digits, guarded, log_seconds, shortened
from ..figures.figure import FALSE_POSITIVE, MISSED, Figure, Points, Section, Table, figure, slug, space, svg_of
from ..words import counted, duration, listed, number, verb

LEAST = 2  # labels: with fewer there is nothing to compare
CONTAINED = "#B8B8B8"


def sections(runs):
    """The section, or nothing where no file has two engines."""
    parts = []
    for count, run in enumerate(runs):
        if len(engines.engines(run)) < LEAST:
            continue
        key = f"engines-{count}-{slug(pareto.name(run))}"
        name = f"{pareto.title(run)} ({pareto.name(run)})"
        if getattr(run, "extremes", None) is not None:
            parts += [guarded(name, extremes_points, run, name, done="told"),
                      guarded(name, extremes_table, run, done="told")]
            continue
        parts += [guarded(name, points, run, name, done="told"), guarded(name, picture, run, key),
                  guarded(name, table, run, name, done="told")]
    return [Section("Engines", parts)] if parts else []


# ---- Sentences -----------------------------------------------------------------------------------------------------


def points(run, name):
    answered = engines.answers(run)
    told = [who(answered), right(answered), *fastest(run, answered), *wrong(run, answered), *inside(answered),
            *by_margin(answered), *languages(answered)]
    return Points(name, told)


def who(answered):
    """The table has which."""
    each = [f"{number(len(mine))} by {tests}" if tests != engines.NOT_SAID else
            f"{number(len(mine))} {verb(len(mine), 'does', 'do')} not say by what"
            for tests, mine in answered.groupby("tests", sort=False)]
    return (f"{counted(len(answered), 'label')} of other people's engines {verb(len(answered), 'answers', 'answer')}: "
            f"{'; '.join(each)}.")


def right(answered):
    never = engines.without_error(answered)
    if never:
        return f"Never wrong {verb(never, 'is', 'are')} {listed(never)}."
    count = answered["false_positive"] + answered["false_negative"]
    least = count.idxmin()
    return f"None is without an error; {least} errs least, in {counted(int(count[least]), 'pair')}."


def fastest(run, answered):
    """Which is the fastest without an error, how far the next is behind, and what the project's own exact one takes."""
    never = [label for label in engines.without_error(answered) if answered["time_mean_ns"][label] > 0]
    if not never:
        return []
    best = answered.loc[never[0]]
    alike = [label for label in never[1:] if pareto.alike(answered.loc[label], best)]
    text = f"The fastest without an error is {never[0]}: {with_interval(best)} a step"
    if alike:
        text += f"; {listed(alike)} {verb(alike, 'is', 'are')} as fast"
    behind = [label for label in never[1:] if label not in alike]
    if behind:
        text += f"; {behind[0]} takes {ratio_text(answered.loc[behind[0]], best)} as long"
    found = [text + "."]
    own = own_exact(run)
    if own is not None:
        found.append(f"This project's {own['label']} takes {with_interval(own)}; {never[0]} takes "
                     f"{ratio_text(best, own)} as long.")
    return found


def own_exact(run):
    """The fastest of the file's own methods that are exact, as a row for pareto.compared(); None without one."""
    rows = []
    for label in run.meta["algorithms"]:
        told = run.meta["answers"][label]
        if not engines.is_engine(told) and told.get("promise") == "exact" and run.summary["time_mean_ns"][label] > 0:
            rows.append(run.summary.loc[label].to_dict() | {"label": label, "times": run.step_times.get(label, [])})
    return min(rows, key=lambda row: row["time_mean_ns"], default=None)


def wrong(run, answered):
    """How far from right: distances of false positives; what is missed is said without, for depths are not recorded."""
    found = []
    some = answered[answered["false_positive"] > 0].sort_values("false_positive")
    each = {}
    for label, row in some.iterrows():
        text = number(int(row["false_positive"]))
        if row["beyond"] > 0:
            text += f", {number(int(row['beyond']))} of them farther apart than {digits(run.gaps.attrs['margin'])} m"
        elif row["gap"] == row["gap"]:
            text += f", at most {digits(row['gap'])} m apart"
        each.setdefault(text, []).append(label)
    if each:
        texts = "; ".join(f"{listed(labels)} ({text})" for text, labels in each.items())
        found.append(f"Pairs that do not meet are reported by {texts}.")
    missed = {}
    for label, count in answered["false_negative"].sort_values().items():
        if count > 0:
            missed.setdefault(number(int(count)), []).append(label)
    if missed:
        texts = "; ".join(f"{listed(labels)} ({count})" for count, labels in missed.items())
        found.append(f"Pairs that meet are missed by {texts}.")
    return found


def inside(answered):
    if "contained_hit" not in answered or not (answered["contained_hit"] > 0).any():
        return []
    most = int(answered["contained_hit"].max())
    yes = [label for label in answered.index if answered["contained_hit"][label] == most]
    no = [label for label in answered.index if answered["contained_hit"][label] == 0]
    text = f"Bodies wholly inside others are reported most by {listed(yes)}, {number(most)} times"
    return [text + (f", and never by {listed(no)}." if no else ".")]


def by_margin(answered):
    found = []
    for less, more in engines.margins(answered):
        a, b = answered.loc[less], answered.loc[more]
        found.append(
            f"{a['algorithm']} with a margin of {a['knobs']['margin']:g} m has {number(int(a['false_positive']))} "
            f"false positives and {number(int(a['false_negative']))} misses; with {b['knobs']['margin']:g} m "
            f"{number(int(b['false_positive']))} and {number(int(b['false_negative']))}.")
    return found


def languages(answered):
    known = answered[(answered["language"] != "") & (answered["time_mean_ns"] > 0)]
    word = [language.split()[0].rstrip(",") for language in known["language"]]
    grouped = known.groupby(pd.Series(word, known.index, dtype=object), sort=False)
    kinds = {name: mine.sort_values("time_mean_ns").iloc[0] for name, mine in grouped}
    if len(kinds) < 2:
        return []
    each = [f"{row.name} in {name} ({duration(row['time_mean_ns'])})" for name, row in kinds.items()]
    return [f"The fastest of each language, right or wrong: {listed(each)}."]


def with_interval(row):
    text = duration(row["time_mean_ns"])
    low, high = row.get("time_mean_low_ns", np.nan), row.get("time_mean_high_ns", np.nan)
    return f"{text} ({duration(low)} to {duration(high)})" if low == low else text


def ratio_text(one, other):
    ratio = pareto.compared(one, other)
    text = f"{digits(ratio.value)} times"
    return f"{text} ({digits(ratio.low)} to {digits(ratio.high)})" if ratio.known else text


# ---- Figure and tables ---------------------------------------------------------------------------------------------


def picture(run, key):
    """Wrong answers and time per step, a row a label; the fastest at the top."""
    answered = engines.answers(run).sort_values("time_mean_ns")
    labels = list(answered.index)
    fig, (left, right_) = figure(1, 2, height=0.3 * len(labels) + 1.5, sharey=True)
    place = np.arange(len(labels))[::-1]
    handles, most = [], 1.0
    kinds = (("false_negative", MISSED, "missed"), ("false_positive", FALSE_POSITIVE, "false positive"),
             ("contained_hit", CONTAINED, "inside, reported"))
    for row, (column, colour, name) in enumerate(kind for kind in kinds if kind[0] in answered):
        width = answered[column].to_numpy(float)
        handles.append(left.barh(place + 0.27 * (1 - row), width, 0.26, color=colour, label=name))
        most = max(most, width.max())
    left.set_xscale("symlog", linthresh=1)
    left.set(xlabel="pairs over all steps", xlim=(0, 2 * most))
    left.set_yticks(place, shortened(labels, 24).values())
    time = answered["time_mean_ns"].to_numpy(float) / 1e9
    low, high = (answered.get(f"time_mean_{end}_ns", answered["time_mean_ns"]).fillna(answered["time_mean_ns"])
                 .to_numpy(float) / 1e9 for end in ("low", "high"))
    right_.hlines(place, low, high, color="#333333", linewidth=2)
    right_.plot(time, place, "o", color="#333333", markersize=4)
    right_.set_xlabel("mean time a step")
    log_seconds(right_, "x")
    space(fig, top=0.3)
    fig.legend(handles=handles, loc="upper center", ncols=3, frameon=False, fontsize=9)
    never = engines.without_error(answered)
    title = (f"{never[0]} is the fastest of {counted(len(never), 'engine')} without an error" if never else
             "No engine is without an error")
    caption = (f"{counted(len(labels), 'label')}; counts are sums over {counted(run.meta['steps'], 'step')}, a line is "
               "the 95 % interval of the mean. Each has the same boxes in front of it, or a broad phase of its own. "
               f"Timed on {'; '.join(dict.fromkeys(answered['machine']))}. {pareto.name(run)}.")
    told = answered[["false_negative", "false_positive", "error", "time_mean_ns"]].reset_index()
    return Figure(title, svg_of(fig), caption, told, key)


def table(run, name):
    answered = engines.answers(run)
    frame = pd.DataFrame({
        "label": answered.index,
        "library": (answered["library"] + " " + answered["version"]).str.strip(),
        "tests": answered["tests"],
        "language": answered["language"],
        "precision": answered["arithmetic"],
        "asked": answered["asked"],
        "error": answered["error"],
        "false positives": answered["false_positive"].astype("Int64"),
        "false negatives": answered["false_negative"].astype("Int64"),
    })
    if "contained_hit" in answered:
        frame["contained hits"] = answered["contained_hit"].astype("Int64")
    if answered["gap"].notna().any() or (answered["beyond"] > 0).any():
        frame["farthest (m)"] = [f"> {run.gaps.attrs['margin']:g}" if row.beyond > 0 else
                                 "–" if row.gap != row.gap else digits(row.gap) for row in answered.itertuples()]
    for column, head, unit in (("time_mean_ns", "mean time (µs)", 1e3), ("time_mean_low_ns", "from (µs)", 1e3),
                               ("time_mean_high_ns", "to (µs)", 1e3), ("setup_ns", "set-up (ms)", 1e6),
                               ("memory_bytes", "memory (KiB)", 1024)):
        if column in answered and answered[column].notna().any():
            frame[head] = answered[column] / unit
    frame["licence"] = answered["licence"]
    caption = ("Farthest: the greatest distance of a pair that is reported and does not meet, as far as distances are "
               "recorded; how deep a missed pair meets is not, a scene of extremes tells that. Contained hits are on "
               "bodies wholly inside others, neither right nor wrong.")
    return Table(name, frame.reset_index(drop=True), caption)


# ---- Extremes ------------------------------------------------------------------------------------------------------


def gap_text(value):
    return "–" if value != value else "0" if value == 0 else f"{value:.1g} m"


def near_and_far(run):
    found = engines.begins(run)
    offsets = sorted(found.index.get_level_values("offset").unique())
    return found, offsets[0], offsets[-1]


def extremes_points(run, name):
    """How wrong on boxes, spheres and capsules, by how far from the origin; the table has which way."""
    found, near, far = near_and_far(run)
    worst = found[["misses", "reports"]].max(axis=1).unstack("offset").loc[found.index.unique("label")]
    here, there = worst[near], worst[far]
    always = (worst == 0).all(axis=1)
    only_there = ~always & (here == 0) & (there > 0)
    grows = (here > 0) & (there >= 10 * here)
    rest = (here > 0) & there.notna() & ~grows
    home = "at the origin" if near == 0 else f"{near:g} m from the origin"
    away = f"{far:g} m from it in each coordinate"
    told = []
    for which, words, text in (
        (always, "On boxes, spheres and capsules right at every gap and offset", "{label}"),
        (only_there, f"Right {home}, but not {away}", "{label} (up to {there})"),
        (grows, f"At least ten times as wrong {away} as {home}", "{label} ({here} near, {there} far)"),
        (rest, f"As wrong {home} already", "{label} ({here})"),
        (there.isna(), f"Failed in all cases {away}", "{label}"),
    ):
        if which.any():
            told.append(f"{words}: " + listed([
                text.format(label=label, here=gap_text(here[label]), there=gap_text(there[label]))
                for label in worst.index[which]]) + ".")
    return Points(name, told)


def extremes_table(run):
    found, _, _ = near_and_far(run)
    frame = found.reset_index().rename(columns={
        "offset": "offset (m)", "misses": "deepest missed (m)", "reports": "farthest reported (m)",
        "other_misses": "of other shapes: deepest missed (m)", "other_reports": "farthest reported (m) "})
    title = "At which gap engines begin to err, by how far from the origin"
    caption = ("Cases of bodies of about a metre: boxes, spheres and capsules, then all other shapes, which are not "
               "convex, lie in another or have no volume. Deepest missed: the greatest depth by which two bodies meet "
               "that are not reported; farthest reported: the greatest gap of a pair that is reported and does not "
               "meet; 0: none. What a hull or a box adds to a body counts as reported. Distances of far cases are "
               "those of the bodies as rounded there.")
    return Table(title, frame, caption)
