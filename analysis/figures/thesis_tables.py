"""Tables 5.1 and 5.2 of the thesis beside this run's times, and the verdicts on its statements as a table."""

import json
import re

import numpy as np
import pandas as pd

from ..tables import intervals, thresholds as t
from .drawing import NotDrawn, caption, comparable, digits, key, log_seconds, steps_of
from .figure import PALETTE, Figure, Verdicts, figure, svg_of
from ..tables.scenes import twins
from ..tables.clauses import KEYS
from ..tables.statements import CAREFUL, verdicts
from ..words import listed

# Mean milliseconds per step, Babylon.js in a browser: letter -> (table 5.1, the box; table 5.2, the falling scene).
THESIS_MS = {
    "H": (0.1526, 7.2476),
    "G": (0.1963, 5.3706),
    "J": (0.9886, 33.922),
    "O": (3.0566, 40.9582),
    "L": (3.2171, 99.153),
    "I": (13.7473, 221.3034),
    "P": (14.116, 245.9314),
    "U": (16.9386, 205.4558),
    "K": (80.7932, 2128.7772),
}
TABLE = {"box": "5.1", "falling": "5.2"}
OTHER = "other procedure"


def spearman(x, y):
    """Pearson's correlation of the ranks, ties getting their mean rank; NaN when one side is all ties."""
    ranks = [pd.Series(np.asarray(values, dtype=float)).rank().to_numpy() for values in (x, y)]
    if len(ranks[0]) < 2 or any(np.ptp(r) == 0 for r in ranks):
        return np.nan
    return float(np.corrcoef(*ranks)[0, 1])


def kendall(x, y):
    """Kendall's tau-b: concordant less discordant pairs over the geometric mean of the pairs that each side orders."""
    signs = []
    for values in (x, y):
        values = np.asarray(values, dtype=float)
        signs.append(np.sign(values[:, None] - values)[np.triu_indices(len(values), 1)])
    ordered = (signs[0] != 0).sum() * (signs[1] != 0).sum()
    return float((signs[0] * signs[1]).sum() / np.sqrt(ordered)) if ordered else np.nan


def javascript(run):
    """letter -> the label of a program in JavaScript that answers as one of the nine: its language says so, and its
    name
    or one of its knobs is that of the algorithm."""
    letters, found = {name: letter for letter, name in KEYS.items()}, {}
    for label, answers in run.meta["answers"].items():
        if not answers.get("language", "").startswith("JavaScript"):
            continue
        knobs = json.loads(answers.get("knobs") or "{}")
        named = [answers.get("name", ""), *(value for value in knobs.values() if isinstance(value, str))]
        if letter := next((letters[name] for name in named if name in letters), ""):
            found.setdefault(letter, label)
    return found


def best_evaluation(run, label):
    """The fastest label in the program itself that answers the same as `label`, by the digests of their answers."""
    digest = run.meta["answers"][label].get("digest")
    steps = steps_of(run)
    same = [
        other for other in comparable(run)
        if other == label or (digest and run.meta["answers"][other].get("digest") == digest
                              and not run.meta["answers"][other].get("transport"))
    ]
    return min(same, key=lambda other: steps.time_ns[:, steps.labels.index(other)].mean())


def means_table(run, kind, published=None):
    """One row per algorithm of the thesis that the file has as published, fastest in the thesis first.

    Columns: key; timed (the label of the thesis's procedure); thesis ms; same procedure ms with from, to; best
    evaluation
    (label) and its ms; JavaScript ms (NaN where no program of the file is in JavaScript) and JS / C++ with its
    interval,
    from the same steps; thesis / C++; rank in the thesis, rank here. published: another run of the scene, of fewer
    steps,
    whose times are taken for procedures that this one has not. What is timed in another procedure than the thesis's has
    neither ratio nor ranks and its timed says so. Raises NotDrawn when fewer than two have them.
    """
    if kind not in TABLE:
        raise NotDrawn("the thesis has mean times of the box and the falling scene only")
    steps, twin = steps_of(run), twins(run)
    letters, programs = {key(run, label): label for label in comparable(run)}, javascript(run)
    rows = {}

    def times(of, label):
        return of.time_ns[:, of.labels.index(label)]

    for letter, milliseconds in THESIS_MS.items():
        if not (label := letters.get(letter)):
            continue
        timed, of, where = twin.get(label, label), steps, ""
        if not timed and published is not None and (slow := twins(published).get(label)):
            timed, of, where = slow, steps_of(published), f" ({published.meta['steps']} steps)"
        mean = intervals.mean(times(of, timed or label))
        if not mean.value > 0:
            continue
        best = best_evaluation(run, label)
        theirs, ratio = np.nan, intervals.Interval(np.nan)
        if letter in programs:
            script = times(steps, programs[letter])
            theirs = script.mean() / 1e6
            if timed and of is steps:
                ratio = intervals.ratio(script, times(steps, timed))
            elif timed:
                ratio = intervals.apart(intervals.mean(script), mean)
        rows[label] = {
            "key": letter, "timed": timed + where if timed else OTHER, "thesis ms": milliseconds[kind == "falling"],
            "same procedure ms": mean.value / 1e6, "from": mean.low / 1e6, "to": mean.high / 1e6,
            "best evaluation": best, "best ms": times(steps, best).mean() / 1e6,
            "JavaScript ms": theirs, "JS / C++": ratio.value, "JS / C++ from": ratio.low, "JS / C++ to": ratio.high,
        }
    table = pd.DataFrame.from_dict(rows, orient="index")
    same = table.timed != OTHER if len(table) else pd.Series(dtype=bool)
    if same.sum() < 2:
        raise NotDrawn(f"the file has {same.sum() or 'none'} of the thesis's nine algorithms as published, timed")
    table = table.sort_values("thesis ms").rename_axis("algorithm")
    table["thesis / C++"] = (table["thesis ms"] / table["same procedure ms"]).where(same)
    table["rank in the thesis"] = table["thesis ms"].where(same).rank().astype("Int64")
    table["rank here"] = table["same procedure ms"].where(same).rank(method="min").astype("Int64")
    return table.dropna(axis=1, how="all")


def means_figure(run, kind, name, published=None):
    """The thesis's mean times, the same procedure in C++, the best evaluation with the same answers and, where there is
    one, the JavaScript of this machine: one row per algorithm."""
    table = means_table(run, kind, published)
    same = (table.timed != OTHER).to_numpy()
    compared = table[same]
    rho, tau = (rank(compared["thesis ms"], compared["same procedure ms"]) for rank in (spearman, kendall))
    fig, axes = figure(height=0.34 * len(table) + 1.4)
    rows = np.arange(len(table))[::-1]
    theirs, ours = table["thesis ms"].to_numpy() / 1e3, table["same procedure ms"].to_numpy() / 1e3
    best = table["best ms"].to_numpy() / 1e3
    script = table["JavaScript ms"].to_numpy() / 1e3 if "JavaScript ms" in table else np.full(len(table), np.nan)
    axes.hlines(rows[same], np.minimum(ours, best)[same], theirs[same], color="#BBBBBB", linewidth=1.5)
    axes.plot(theirs, rows, "o", color=PALETTE["orange"], label="thesis, JavaScript of 2022")
    if np.isfinite(script).any():
        axes.plot(script, rows, "D", color=PALETTE["purple"], label="JavaScript, this machine")
    axes.plot(ours[same], rows[same], "s", color=PALETTE["blue"], label="C++, same procedure")
    faster = best < ours * 0.999
    if (faster | ~same).any():
        look = {"color": PALETTE["blue"], "markerfacecolor": "white", "markeredgewidth": 1.3}
        axes.plot(best[faster | ~same], rows[faster | ~same], "s", **look, label="C++, best evaluation")
    for row, right, ratio in zip(rows, np.fmax(np.fmax(ours, theirs), script), table["thesis / C++"]):
        said = OTHER if np.isnan(ratio) else f"{digits(ratio)}×"
        axes.annotate(said, (right, row), xytext=(8, 0), textcoords="offset points", va="center", fontsize=9)
    axes.set_yticks(rows, [f"{letter} {label}" for label, letter in table.key.items()])
    log_seconds(axes, "x")
    axes.set_xlim(right=axes.get_xlim()[1] * (4 if same.all() else 12))
    axes.set_xlabel("mean time per step")
    axes.grid(axis="y", visible=False)
    fig.suptitle(" \n ", fontsize=9)  # room for the legend
    fig.legend(loc="upper center", ncol=2, fontsize=9, frameon=False, borderaxespad=0.1)
    return Figure(_means_title(table, compared, rho, tau, kind), svg_of(fig),
                  caption(run, _means_caption(table, run, published), f"table {TABLE[kind]}"), table, name)


def _means_title(table, compared, rho, tau, kind):
    moved = (compared["rank here"] - compared["rank in the thesis"]).abs()
    if np.isnan(rho):
        title = f"All mean times are equal here, so their order cannot be compared with table {TABLE[kind]}"
    else:
        title = f"The order of mean times and that of table {TABLE[kind]} have rank correlation "
        title += f"{rho:.2f} (Spearman; Kendall {tau:.2f}; n = {len(compared)})"
    if moved.max() and not np.isnan(rho):
        label = moved.idxmax()
        title += f"; {label} moves most, from place {table['rank in the thesis'][label]} to {table['rank here'][label]}"
    low, high = compared["thesis / C++"].min(), compared["thesis / C++"].max()
    title += (
        f"; the thesis's JavaScript took {digits(low)} to {digits(high)} times as long as the same procedure "
        f"in C++ here"
    )
    if "JS / C++" in table and table["JS / C++"].notna().any():
        ratio = table["JS / C++"].dropna()
        title += f"; JavaScript on this machine takes {digits(ratio.min())} to {digits(ratio.max())} times as long"
    return title


def _means_caption(table, run, published):
    text = (
        "Two machines on one axis: the thesis's means come from its own computer and browser and scenes of its own "
        f"length, so only orders and ratios say something. n = {len(table)} algorithms, {run.meta['steps']} steps; "
        "numbers at the right are the thesis's time over that of the same procedure in C++."
    )
    if published is not None and table.timed.str.contains(" steps)", regex=False).any():
        slow = table.index[table.timed.str.contains(" steps)", regex=False)]
        text += f" {listed(slow)} as published: of {published.meta['steps']} steps of the same seconds."
    faster = table.index[(table["best ms"] < 0.999 * table["same procedure ms"]) & (table.timed != OTHER)]
    for label in faster:
        ratio = table["same procedure ms"][label] / table["best ms"][label]
        text += (
            f" {table['best evaluation'][label]} answers as {table.timed[label]} does, in 1/{digits(ratio)} of "
            f"its time."
        )
    if "JavaScript ms" not in table:
        text += " No program in JavaScript answered in this file, so the languages are not compared on one machine."
    return text


def in_javascript(run):
    """[label of C++, label of JavaScript]: the same method in both languages and by the same procedure, timed on one
    machine and build."""
    answers, timed = run.meta["answers"], set(comparable(run)) - set(twins(run))
    theirs = {KEYS[letter]: label for letter, label in javascript(run).items()}
    return [(label, theirs[told["name"]]) for label, told in answers.items()
            if not told.get("transport") and told["name"] in theirs and {label, theirs[told["name"]]} <= timed]


def languages_table(run, kind):
    """One row per method in C++ that the file has in JavaScript too, by the ratio of their times.

    Columns: key, C++ ms, JavaScript ms, JS / C++, low, high (of its 95 % interval, from the same steps; NaN with too
    few), thesis ms, same answers (pairs that both report over those that either does).
    """
    steps, letters = steps_of(run), {name: letter for letter, name in KEYS.items()}
    rows = {}
    for label, other in in_javascript(run):
        ours, theirs = (steps.time_ns[:, steps.labels.index(name)] for name in (label, other))
        if not (ours.mean() > 0 and theirs.mean() > 0):
            continue
        letter, ratio = letters[run.meta["answers"][label]["name"]], intervals.ratio(theirs, ours)
        one, both = (set(run.pairs(name).itertuples(index=False, name=None)) for name in (label, other))
        rows[label] = (letter, ours.mean() / 1e6, theirs.mean() / 1e6, ratio.value, ratio.low, ratio.high,
                       THESIS_MS[letter][kind == "falling"] if kind in TABLE else np.nan,
                       len(one & both) / len(one | both) if one | both else 1.0)
    columns = ["key", "C++ ms", "JavaScript ms", "JS / C++", "low", "high", "thesis ms", "same answers"]
    if not rows:
        raise NotDrawn("the file has none of the thesis's nine in both languages, timed")
    table = pd.DataFrame.from_dict(rows, orient="index", columns=columns)
    return table.sort_values("JS / C++").rename_axis("algorithm")


def languages_figure(run, kind, name):
    """Times of the same methods in C++ and in JavaScript, one row per method."""
    table = languages_table(run, kind)
    fig, axes = figure(height=0.34 * len(table) + 1.2)
    rows = np.arange(len(table))[::-1]
    ours, theirs = table["C++ ms"].to_numpy() / 1e3, table["JavaScript ms"].to_numpy() / 1e3
    axes.hlines(rows, np.minimum(ours, theirs), np.maximum(ours, theirs), color="#BBBBBB", linewidth=1.5)
    if kind in TABLE:
        axes.plot(table["thesis ms"] / 1e3, rows, "o", color=PALETTE["orange"], markerfacecolor="white",
                  label="thesis, JavaScript")
    axes.plot(theirs, rows, "o", color=PALETTE["orange"], label="JavaScript here")
    axes.plot(ours, rows, "s", color=PALETTE["blue"], label="C++ here")
    right = np.fmax(np.fmax(ours, theirs), np.nan_to_num(table["thesis ms"].to_numpy() / 1e3))
    for row, place, ratio, low, high in zip(rows, right, table["JS / C++"], table.low, table.high):
        said = f"{digits(ratio)}×" + (f" ({digits(low)} to {digits(high)})" if low <= high else "")
        axes.annotate(said, (place, row), xytext=(8, 0), textcoords="offset points", va="center", fontsize=9)
    axes.set_yticks(rows, [f"{letter} {label}" for label, letter in table.key.items()])
    log_seconds(axes, "x")
    axes.set_xlim(right=axes.get_xlim()[1] * 30)
    axes.set_xlabel("mean time per step")
    axes.grid(axis="y", visible=False)
    fig.suptitle(" ", fontsize=9)  # room for the legend
    fig.legend(loc="upper center", ncol=3, fontsize=9, frameon=False, borderaxespad=0.1)
    ratio, same = table["JS / C++"], table["same answers"].min()
    title = (f"On the same poses and machine JavaScript takes {digits(ratio.min())} ({ratio.idxmin()}) to "
             f"{digits(ratio.max())} times ({ratio.idxmax()}) as long as C++; ")
    alike = f"at least {100 * same:.4g} % of the answers are the same"
    title += "both answer alike on every pair" if same == 1 else alike
    what = (
        f"The same methods in both languages, timed in turn on the same {run.meta['steps']} steps; numbers are"
        " JavaScript's time over that of C++, in brackets the 95 % interval where there are steps enough. What C++"
        " gains by an index is left out; its vector instructions and orders that learn are not."
    )
    table_name = f"table {TABLE[kind]}" if kind in TABLE else "section 6.1"
    return Figure(title, svg_of(fig), caption(run, what, table_name), table, name)


def statements_part(scenes, notes=()):
    """The verdicts as Verdicts; scenes: as of statements.verdicts; notes: sentences on where the data come from."""
    found = verdicts(scenes)
    careful = [verdict for verdict in found if verdict.variant]
    published = [verdict for verdict in found if not verdict.variant]
    title = f"Of the thesis's {len(published)} statements {counted(published)}"
    title += f". Of {len(careful)} judged again on the careful form {counted(careful)}" if careful else ""
    letters = ", ".join(f"{letter} {label}" for letter, label in KEYS.items())
    text = (
        f"{letters}. What words such as “slightly” mean is a number of analysis/tables/thresholds.py, fixed before "
        f"there were results: early and late count from {t.EXACT_M} m on, “slightly” ends at {t.SLIGHT_M} m, “too "
        f"early” begins at {t.TOO_EARLY_M} m. A near miss is within {100 * t.NEAR:g} % of what was needed, or one pass "
        f"or sample from it. Careful: the labels …{CAREFUL}, with dense meshes and no prefilter that misses. Times are "
        "ratios, the rest shares of 1 unless a unit is named."
    )
    return Verdicts(title, found, " ".join([text, *notes]))


def spelled(text):
    """A statement with the names of its algorithms; one about more than two keeps the letters, which orders need."""
    letters = re.findall(rf"\b[{''.join(KEYS)}]\b", text)
    if len(set(letters)) > 2:
        return text
    for letter in dict.fromkeys(letters):
        text = re.sub(rf"\b{letter}\b", f"{letter} ({KEYS[letter]})", text, count=1)
    return text


def counted(found):
    """the data confirm 12 and refute 10, 2 of them by a near miss; 7 cannot be tested."""
    confirmed, refuted = (sum(verdict.verdict == word for verdict in found) for word in ("confirmed", "refuted"))
    near, rest = sum(verdict.near for verdict in found), len(found) - confirmed - refuted
    text = f"the data confirm {confirmed} and refute {refuted}"
    text += f", {near} of them by a near miss" if near else ""
    return text + (f"; {rest} cannot be tested" if rest else "")
