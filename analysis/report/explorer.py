"""What the page's figure that answers to the pointer is drawn from: the labels of a scene, and all that may be an
axis."""

import numpy as np

from ..figures.figure import Explorer, style
from ..tables import pareto
from ..tables.clauses import KEYS

LETTERS = {name: letter for letter, name in KEYS.items()}
MEASURES = ("error", "recall", "precision", "matthews", "false_negative", "false_positive", "hits", "time_mean_ns",
            "time_mean_low_ns", "time_mean_high_ns", "time_median_ns", "time_p95_ns", "operations", "setup_ns",
            "memory_bytes")


def explorer(scene, key):
    """The Explorer of a pareto.Scene; None when nothing could be drawn."""
    points = scene.points.reset_index(drop=True)
    if not {"error", "time_mean_ns"} <= set(points.columns) or not len(points):
        return None
    worst = {pareto.name(run): _worst(run) for run in scene.runs}
    files = {pareto.name(run): run.path for run in scene.runs}
    rows = []
    for _, point in points.iterrows():
        look = style(point.algorithm, point.label)
        label = point.label.partition(" (")[0]
        step, count = worst.get(point.file, {}).get(label, (None, None))
        row = {
            "label": point.label, "algorithm": point.algorithm, "letter": LETTERS.get(point.algorithm, ""),
            "nine": point.label in LETTERS, "promise": point.promise, "scope": point.scope, "unit": point.unit,
            "language": (point.asked.rpartition(", ")[2] if point.asked else "C++"), "machine": point.machine,
            "knobs": _text(point.knobs), "colour": look["color"], "mark": look["marker"], "file": point.file,
            "path": files.get(point.file, ""), "step": step, "wrong": count, "name": label,
        }
        rows.append(row | {name: _number(point[name]) for name in MEASURES if name in points.columns})
    lines = [
        {"knob": knob, "algorithm": algorithm, "labels": [points.label[row] for row in line]}
        for algorithm, knob, line in pareto.sweeps(points)
    ]
    return Explorer(f"{scene.title}: every label", {"points": rows, "lines": lines}, key)


def _worst(run):
    """label -> (the step with most wrong answers, how many they are)."""
    table, labels = run.per_step, run.meta["algorithms"]
    if not {"false_positive", "false_negative"} <= set(table.columns) or not labels or not len(table):
        return {}
    wrong = (table.false_positive.astype(int) + table.false_negative.astype(int)).to_numpy().reshape(-1, len(labels))
    steps = wrong.argmax(axis=0)
    return {label: (int(steps[i]), int(wrong[steps[i], i])) for i, label in enumerate(labels)}


def _text(knobs):
    return ", ".join(f"{name} = {value}" for name, value in knobs.items())


def _number(value):
    return float(value) if value is not None and np.isfinite(value) else None
