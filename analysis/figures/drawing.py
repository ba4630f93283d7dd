"""What the figures of the thesis share: names, captions, the steps that there are, and how a part says why it is not
drawn."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter, LogLocator
from matplotlib.transforms import ScaledTranslation

from ..tables import pareto
from ..tables.scenes import twins
from ..tables.studies import simulated
from ..words import listed, verb

MOST_DRAWN = 12  # algorithms in one figure; lines and colours of more are not told apart
LINE = 19  # letters of a line above a small panel
TIE = 20  # points from the end of a line to its name
BINS = 150  # points of a line over steps: more are closer than a line is wide


class NotDrawn(Exception):
    """A part cannot be drawn; the text says why."""


def guarded(name, make, *arguments, done="drawn"):
    """What make(*arguments) gives, or the sentence why it is not drawn."""
    try:
        return make(*arguments)
    except NotDrawn as why:
        return f"{name}: not {done}, {why}."
    except KeyError as error:  # a group, column or attribute
        return f"{name}: not {done}, the file lacks something: {plain(error)}."
    except (ValueError, OSError, AttributeError) as error:
        return f"{name}: not {done}, the file is not as expected: {plain(error)}."


def plain(error):
    return " ".join(str(error).split()).strip("'\"")


@dataclass(frozen=True)
class Steps:
    """A run, step by step: the n steps that were simulated, A algorithms.

    time_ns, hits: (n, A); truth: (n) pairs that meet; bodies: (n) how many are there, fixed ones included.
    """

    labels: list
    time_ns: np.ndarray
    hits: np.ndarray
    truth: np.ndarray
    bodies: np.ndarray

    @property
    def full(self):
        """The steps at which all bodies are there: what varies here does not follow their number."""
        return self.bodies == self.bodies.max()

    @property
    def grows(self):
        return self.bodies.min() < self.bodies.max()


def steps_of(run):
    """Raises NotDrawn when the file has no algorithm, no step, or an integration failed at once."""
    labels, steps = run.meta["algorithms"], simulated(run)
    if not labels:
        raise NotDrawn("the file has no answers of any algorithm")
    if steps < 2:
        raise NotDrawn(f"the file has {steps} steps that were simulated")
    table = run.per_step
    if table.empty:
        raise NotDrawn("the file has no /results")
    column = {
        name: table[name].to_numpy(dtype=float).reshape(-1, len(labels))[:steps]
        for name in ("time_ns", "hits", "true_positive", "false_negative")
    }
    for label in run.unlike:  # as if it had not been timed
        column["time_ns"][:, labels.index(label)] = 0
    first = run.bodies.first_step.to_numpy()
    there = (first >= 0) & (first <= np.arange(steps)[:, None])
    truth = column["true_positive"][:, 0] + column["false_negative"][:, 0]
    return Steps(labels, column["time_ns"], column["hits"], truth, there.sum(axis=1))


def cut(run):
    """What a caption says when an integration failed, else ""."""
    if run.physics is None or run.physics.attrs["status"] == "complete":
        return ""
    return f" The integration {run.physics.attrs['status']}; the {simulated(run)} steps before it are drawn."


def chosen(run, times=True):
    """The labels that a figure draws, MOST_DRAWN at most: first those as published, under their own name, then the
    first of each algorithm, the second, and so on, in the file's order; of `times` those of one machine and build."""
    labels, seen, rank = run.meta["algorithms"], {}, {}
    if times:
        labels = [label for label in labels if label in comparable(run)]
    for label in labels:
        name = algorithm(run, label)
        seen[name] = seen.get(name, 0) + (label != name)
        rank[label] = 0 if label == name else seen[name]
    picked = sorted(labels, key=lambda label: (rank[label], labels.index(label)))[:MOST_DRAWN]
    return sorted(picked, key=labels.index)


def left_out(run, times=True):
    """What a caption says about labels that are too many to be drawn, else ""."""
    drawn, labels = len(chosen(run, times)), len(comparable(run) if times else run.meta["algorithms"])
    return f" Of {labels} labels {drawn} are drawn; the table has all." if labels > drawn else ""


def algorithm(run, label):
    return run.meta["answers"][label].get("name", label)


def key(run, label):
    """The thesis's letter of an algorithm as published; "" for others and for other knobs."""
    return run.meta["answers"][label].get("thesis_key", "") if label == algorithm(run, label) else ""


def short(run, label):
    """The letter or the label, for sentences: they have room for all of it."""
    return key(run, label) or label


def full(run, labels):
    """label -> letter and label, short enough for the end of a line."""
    return {label: f"{key(run, label)} {text}".strip() for label, text in shortened(labels, 32).items()}


def heads(run, labels):
    """label -> letter and label as the head of a small panel: two lines where one has no room for it."""
    found = {}
    for label, text in shortened(labels, 2 * LINE).items():
        text = f"{key(run, label)} {text}".strip()
        ends = [i + 1 for i, letter in enumerate(text) if letter in " +_…" and abs(i + 1 - len(text) / 2) < 6]
        middle = min(ends, key=lambda end: abs(end - len(text) / 2), default=len(text) // 2)
        found[label] = text if len(text) <= LINE else f"{text[:middle]}\n{text[middle:]}"
    return found


def shortened(names, most=22):
    """name -> a text of at most `most` letters, its middle left out; different names never get one text.

    Where the usual cut makes names alike, the cut is moved to where they differ; where no cut of that length tells them
    apart, their texts are longer.
    """
    names = list(dict.fromkeys(names))
    texts = {name: _cut(name, most, max(most - 9, (most - 1) // 2)) for name in names}
    alike = {}
    for name, text in texts.items():
        alike.setdefault(text, []).append(name)
    taken = {text for text, group in alike.items() if len(group) == 1}
    for group in (group for group in alike.values() if len(group) > 1):
        longest = max(map(len, group))
        cuts = ((wide, head) for wide in range(most, longest + 1) for head in range(wide - 2, 0, -1))
        tried = ({name: _cut(name, *cut) for name in group} for cut in cuts)
        own = next((t for t in tried if len({*t.values()} - taken) == len(group)), {name: name for name in group})
        texts |= own
        taken |= set(own.values())
    return texts


def _cut(text, most, head):
    """`text` with at most `most` letters: the first `head`, and the last of the rest."""
    return text if len(text) <= most else text[:head] + "…" + text[len(text) - (most - 1 - head) :]


def places(run):
    """Where and with what algorithms were timed -> their labels."""
    found = {}
    for label, answers in run.meta["answers"].items():
        found.setdefault(pareto.machine(answers), []).append(label)
    return found


def comparable(run):
    """The labels whose times compare: those of the machine and build that timed most; of equals the first."""
    return max(places(run).values(), key=len, default=[])


def machine(run, times=True):
    """Where and with what the algorithms were timed; what is not drawn because that was elsewhere, if `times` are."""
    found = places(run)
    if len(found) < 2 or not times:
        return f"timed on {'; '.join(found) or 'nothing'}"
    drawn = comparable(run)
    place = next(place for place, labels in found.items() if labels is drawn or labels == drawn)
    others = [label for label in run.meta["answers"] if label not in drawn]
    named = listed(others) if len(others) < 4 else f"{len(others)} algorithms"
    return f"timed on {place}; NOT DRAWN, FOR TIMED ON ANOTHER MACHINE OR BUILD: {named}"


def other_procedure(run):
    """What a caption of times says about algorithms as published that are timed in another procedure, else ""."""
    found = [f"{key(run, label)} ({label})" for label in twins(run) if key(run, label)]
    if not found:
        return ""
    return (
        f' {listed(found)} {verb(found, "is", "are")} timed in another procedure than the thesis\'s: with search ='
        ' "indexed" points that surely are not near are left out, where the thesis compared all.'
    )


def source(run):
    meta = run.meta
    return (f"{pareto.name(run)}, configuration “{meta.get('title', '')}” (sha256 "
            f"{meta.get('config_sha256', 'unknown')[:10]}), commit {meta.get('git_commit', '?')[:7]}, "
            f"{meta.get('run', {}).get('processor', 'unknown processor')}.")


def caption(run, what, thesis="", times=True, nine=True):
    """what: what is drawn and how many (sentences); thesis: the figures of the thesis that it answers; times: whether
    it draws times, so only those of one machine and build; nine: whether times of the thesis's nine."""
    config = f"“{run.meta.get('title', '')}” (sha256 {run.meta.get('config_sha256', 'unknown')[:10]})"
    other = other_procedure(run) if times and nine and thesis else ""
    text = f"{what}{cut(run)}{other} {pareto.name(run)}, configuration {config}, {machine(run, times)}."
    return f"{text} Answers {thesis} of the thesis." if thesis else text


def binned(values, reduce, bins=BINS):
    """(middle steps, values reduced over each of at most `bins` equal stretches of steps). values: (n, ...)."""
    edges = np.linspace(0, len(values), min(bins, len(values)) + 1).astype(int)
    middle = (edges[:-1] + edges[1:] - 1) / 2
    return middle, np.array([reduce(values[a:b], axis=0) for a, b in zip(edges, edges[1:])])


def stretch(values, reduced="the median"):
    """What a caption says of one point of a line over steps: how many of them are in it, at most."""
    count = -(-len(values) // BINS)
    return f"each point {reduced} of {count}" if count > 1 else "a point each"


def stretches(columns, reduce, count=10):
    """What a line over steps shows, in few numbers: a row per name of `columns` (name -> (n) values), `reduce` over
    each of `count` equal stretches of steps."""
    length = len(next(iter(columns.values())))
    edges = np.linspace(0, length, min(count, length) + 1).astype(int)
    heads = [f"steps {a} to {b - 1}" if b - a > 1 else f"step {a}" for a, b in zip(edges, edges[1:])]
    rows = {name: [reduce(values[a:b]) for a, b in zip(edges, edges[1:])] for name, values in columns.items()}
    return pd.DataFrame.from_dict(rows, orient="index", columns=heads)


def correlation(x, y):
    """Pearson's; NaN when one does not vary."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if len(x) < 3 or np.ptp(x) == 0 or np.ptp(y) == 0:
        return np.nan
    return float(np.corrcoef(x, y)[0, 1])


def seconds(axis):
    """Ticks of an axis in seconds: "10 µs"."""
    axis.set_major_formatter(EngFormatter("s", sep=" "))


def log_seconds(axes, which="y"):
    """A logarithmic axis of seconds; after the lines, for it divides a short range more finely."""
    axis = getattr(axes, f"{which}axis")
    if not getattr(axes.dataLim, f"{which}max") > 0:
        return seconds(axis)  # nothing to be drawn on a logarithmic axis
    axes.set(**{f"{which}scale": "log"})
    low, high = axis.get_view_interval()
    axis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < 300 * low else (1,), numticks=15))
    axes.minorticks_off()
    seconds(axis)


def digits(value):
    """Three digits, without exponent where that is short: 0.0123, 1.23, 123, 12345."""
    if not np.isfinite(value) or 0 < abs(value) < 1e-4:
        return f"{value:.3g}"
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def label_ends(axes, ends, gap=12):
    """Names lines at their right end, `gap` points apart at least, each tied to the end of its line by a line of the
    same colour and its mark. ends: [(y, text, look)], y in data, look as keywords of matplotlib."""
    axes.figure.draw_without_rendering()  # the layout decides how far apart they are
    points = axes.figure.dpi / 72
    place = np.array([axes.transData.transform((0, y))[1] / points if y > 0 else -np.inf for y, _, _ in ends])
    low, high = (axes.transAxes.transform((0, y))[1] / points for y in (0, 1))
    order = np.argsort(place, kind="stable")
    at = np.clip(place[order], low, high)
    for i in range(1, len(at)):  # push up, then down from the top where that went too far
        at[i] = max(at[i], at[i - 1] + gap)
    for i in range(len(at) - 1, -1, -1):
        at[i] = min(at[i], high if i == len(at) - 1 else at[i + 1] - gap)
    for i, y in zip(order, at):
        _, text, look = ends[i]
        end = np.clip(place[i], low, high)
        tie = {"arrowstyle": "-", "color": look["color"], "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}
        tie |= {"linestyle": look.get("linestyle", "-"), "relpos": (0, 0.5)}
        gid = {"gid": look["gid"]} if "gid" in look else {}
        axes.annotate(text, (1, (end - low) / (high - low)), xycoords="axes fraction", xytext=(TIE, y - end),
                      textcoords="offset points", va="center", color=look["color"], fontsize=9, arrowprops=tie, **gid)
        if look.get("marker"):
            middle = axes.transAxes + ScaledTranslation((TIE - 5) / 72, (y - end) / 72, axes.figure.dpi_scale_trans)
            mark = {"color": look["color"], "marker": look["marker"], "markersize": 5, "linestyle": "none"} | gid
            axes.add_artist(Line2D([1], [(end - low) / (high - low)], transform=middle, clip_on=False, **mark))


def panels(figure, count, columns=3):
    """rows for `count` small panels, and what turns surplus axes off."""
    rows = -(-count // columns)
    fig, axes = figure(rows, columns, height=1.55 * rows + 0.5, squeeze=False)
    axes = axes.ravel()
    for surplus in axes[count:]:
        surplus.set_axis_off()
    return fig, axes[:count]
