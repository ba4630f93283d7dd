"""Why a statement of the thesis does not hold, in sentences that the data prove; what they do not prove is not said.

A cause is asked for a refuted statement; each function below looks at one thing and gives "" where it is not so.
"""

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Callable

import numpy as np
import pandas as pd

from .clauses import KEYS
from ..words import counted, listed, number, verb

SAMPLERS = ("facet_triangles", "facet_rotations")
NEEDED = 3  # sampled facets of a body that make one triangle
LEADS = 0.5  # a part is the cause of what it is more than half of
TIED = 0.8  # a time follows what its correlation with is at least this


@dataclass(frozen=True)
class Evidence:
    """What causes are proved from. pairs: label -> table of step, a, b; truth: the same of pairs that meet; knobs:
    label -> (algorithm, its knobs); facets: triangles of each body's mesh; thin: whether a body is flat; names: of
    bodies; prepare_ns: label -> per step, time for what depends on one body."""

    pairs: Callable
    truth: pd.DataFrame
    knobs: dict
    facets: np.ndarray
    thin: np.ndarray
    names: list
    prepare_ns: dict

    def keys(self, table):
        bodies = len(self.names)
        return (table.step.to_numpy(dtype=np.int64) * bodies + table.a.to_numpy(dtype=np.int64)) * bodies + table.b

    @cached_property
    def true(self):
        return np.asarray(self.keys(self.truth))

    def hits(self, label):
        return np.asarray(self.keys(self.pairs(label)))

    def missed(self, label):
        """The pairs that meet and are not reported, as numbers."""
        return np.setdiff1d(self.true, self.hits(label), assume_unique=True)

    def false_positives(self, label):
        table = self.pairs(label)
        return table[~np.isin(np.asarray(self.keys(table)), self.true)]

    def bodies(self, keys):
        """(a, b) of pairs as numbers."""
        return keys // len(self.names) % len(self.names), keys % len(self.names)


def of(run):
    """The Evidence of a Run; None where the file lacks what it is made of."""
    try:
        knobs = {
            label: (answers.get("name", label), json.loads(answers.get("knobs") or "{}"))
            for label, answers in run.meta["answers"].items()
        }
        size = np.sort(np.array(run.bodies["size"].to_list(), dtype=float).reshape(-1, 3), axis=1)
        prepare = {}
        if "prepare_ns" in run.per_step:
            wide = run.per_step.prepare_ns.to_numpy(dtype=float).reshape(-1, len(run.meta["algorithms"]))
            prepare = dict(zip(run.meta["algorithms"], wide.T))
        flat = (run.bodies["kind"] == "box").to_numpy() & (size[:, 0] <= 0.1 * size[:, 2])
        return Evidence(run.pairs, run.truth_pairs, knobs, run.bodies.facets.to_numpy(), flat, list(run.bodies.index),
                        prepare)
    except (AttributeError, KeyError, ValueError, OSError):
        return None


def letter(label):
    return next((f"{key} ({name})" for key, name in KEYS.items() if name == label), label)


def share(part, whole):
    """"12 of 345 (3.5 %)"."""
    if part == whole:
        return f"all {number(whole)}"
    return f"{number(part)} of {number(whole)} ({number(100 * part / whole)} %)"


# ---- What the data can prove


def prefilter_misses(evidence, label):
    """Whose misses are the prefilter's: it never lets those pairs through."""
    before = evidence.knobs.get(label, ("", {}))[1].get("prefilter", "none")
    if before == "none" or before not in evidence.knobs:
        return ""
    missed, theirs = evidence.missed(label), evidence.missed(before)
    if not len(missed):
        return ""
    both = np.isin(missed, theirs).sum()
    if both < LEADS * len(missed):
        return ""
    own = len(missed) - both
    added = "it adds none of its own" if not own else f"it adds {number(own)} of its own"
    return f"{share(both, len(missed))} of the misses of {letter(label)} are misses of its prefilter {before}; {added}."


def without_triangle(evidence, label):
    """Which bodies give a sampler no triangle, and how many of its misses they have part in."""
    name, knobs = evidence.knobs.get(label, ("", {}))
    if name not in SAMPLERS or knobs.get("densify"):
        return ""
    stride = int(knobs.get("stride", 20))
    sampled = -(-evidence.facets // stride)
    poor = sampled < NEEDED
    missed = evidence.missed(label)
    if not poor.any() or not len(missed):
        return ""
    a, b = evidence.bodies(missed)
    part = int((poor[a] | poor[b]).sum())
    if not part:
        return ""
    few = listed(number(count) for count in np.unique(evidence.facets[poor]))
    named = [evidence.names[body] for body in np.flatnonzero(poor)]
    named = listed(named) if len(named) < 3 else f"{number(len(named))} bodies"
    return (
        f"{share(part, len(missed))} of the misses of {letter(label)} are pairs with {named}: of {few} facets every "
        f"{stride}th is taken, fewer than {NEEDED} points, which make no triangle."
    )


def per_body(evidence, bodies, times, label):
    """What part of the time is spent on bodies one by one, where there are most of them."""
    if label not in evidence.prepare_ns or label not in times:
        return ""
    most = bodies == bodies.max()
    part = float(np.median(evidence.prepare_ns[label][most]) / max(np.median(times[label][most]), 1))
    if not part > 0.1:
        return ""
    return (f"With all {number(int(bodies.max()))} bodies there, {number(100 * part)} % of the time of {letter(label)} "
            "is work on each body alone, which grows with their number and not with its square.")


def follows(evidence, scene, label, stage, why):
    """The time of a label follows the pairs that a stage of it lets through."""
    if label not in scene.times or stage not in scene.labels:
        return ""
    hits = scene.per_step.hits[scene.per_step.algorithm == stage].to_numpy(dtype=float)
    if not np.ptp(hits) or not np.ptp(scene.times[label]):
        return ""
    r = float(np.corrcoef(hits, scene.times[label])[0, 1])
    return f"The time of {letter(label)} follows {why} (r = {r:.2f})." if r >= TIED else ""


def works(scene, label):
    """The time of a label follows the tests that it makes, and those follow its hits."""
    rows = scene.per_step[scene.per_step.algorithm == label]
    if label not in scene.times or "operations" not in rows:
        return ""
    tests, hits = rows.operations.to_numpy(dtype=float), rows.hits.to_numpy(dtype=float)
    if not (np.ptp(tests) and np.ptp(hits) and np.ptp(scene.times[label])):
        return ""
    r = np.corrcoef([scene.times[label], tests, hits])
    if min(r[0, 1], r[1, 2]) < TIED:
        return ""
    return (f"The time of {letter(label)} follows the tests that it makes (r = {r[0, 1]:.2f}), and those its hits (r = "
            f"{r[1, 2]:.2f}): a pair that is near is looked at longer.")


def truth_comes_late(evidence, steps):
    """The pairs that meet are more in the second half of the steps."""
    if not len(evidence.truth):
        return ""
    late = float((evidence.truth.step.to_numpy() >= steps // 2).mean())
    return (f"Of the pairs that truly meet {number(100 * late)} % come in the second half of this motion: what reports "
            "them reports more there." if late > LEADS else "")


def subset(evidence, one, other):
    """Of two labels, whose hits the other has too."""
    first, second = evidence.hits(one), evidence.hits(other)
    only, more = np.setdiff1d(first, second), np.setdiff1d(second, first)
    if len(only) > len(more):
        return subset(evidence, other, one)
    if not len(more):
        return ""
    true = int(np.isin(more, evidence.true).sum())
    has = f"every hit of {letter(one)} is one of {letter(other)}" if not len(only) else (
        f"{letter(one)} reports {counted(len(only), 'pair')} that {letter(other)} does not")
    return (f"{has[:1].upper()}{has[1:]}; {letter(other)} reports {number(len(more))} more, of which {number(true)} "
            f"truly {verb(true, 'meets', 'meet')}.")


def kinds_of_error(scene, labels, name=""):
    """Misses and false positives of the labels, side by side."""
    table = scene.summary
    if table is None or not {"false_positive", "false_negative"} <= set(table):
        return ""
    each = [f"{letter(label)} misses {number(int(table.false_negative[label]))} and has "
            f"{counted(int(table.false_positive[label]), 'false positive')}" for label in labels]
    text = "; ".join(each)
    return f"{f'In the {name} scene ' if name else ''}{text}."


def out_of_order(clauses):
    """Which neighbours stand in the other order."""
    wrong = [each.what for each in clauses if each.holds is False and " / " in each.what and ":" not in each.what]
    if not wrong:
        return ""
    return f"Out of order: {listed(pair.replace(' / ', ' is not slower than ') for pair in wrong)}."


def failing(clauses):
    """At what the clauses fail."""
    told = [f"“{each.what}”: {each.where}" for each in clauses if each.holds is False and each.where]
    return "; ".join(told) + "." if told else ""


# ---- Which of it belongs to which statement

BLAME = {23, 25, 30, 31, 34, 35, 37, 42, 45, 46, 48, 49, 56}  # of errors


def cause(statement, clauses, scenes, labels):
    """Sentences for a refuted statement; "" when the data prove none. scenes: kind -> Timed or Playground."""
    number_, found = statement.number, []
    if number_ <= 3:
        found.append(out_of_order(clauses))
    if number_ in (7, 51, 52) and "falling" in scenes and scenes["falling"].evidence:
        scene = scenes["falling"]
        for label in failed_labels(clauses, labels):
            stage, why = STAGES.get(label, ("", ""))
            found.append(follows(scene.evidence, scene, label, stage, why) or works(scene, label))
        if number_ in (51, 52):
            found.append(truth_comes_late(scene.evidence, len(scene.bodies)))
    if number_ in (8, 55, 57) and scenes["box"].evidence:
        scene = scenes["box"]
        found += [per_body(scene.evidence, scene.bodies, scene.times, label) for label in failed_labels(clauses,
            labels)]
    if number_ in (10, 11, 12, 54):
        for kind, scene in scenes.items():
            if scene.evidence:
                text = subset(scene.evidence, *labels[:2]) if number_ != 10 else fewest(scene, labels)
                found.append(f"{kind}: {text}" if text and len(scenes) > 1 else text)
    if number_ in (10, 11) and scenes["falling"].evidence:
        found.append(without_triangle(scenes["falling"].evidence, labels[0]))
    if number_ in (6, 48, 55, 57):
        found += [tests_made(kind, scene, labels) for kind, scene in scenes.items() if kind != "playground"]
    if number_ in BLAME:
        found += blamed(clauses, scenes, labels)
    if number_ >= 13:
        found.append(failing(clauses))
    return " ".join(dict.fromkeys(filter(None, found)))


STAGES = {  # label -> what decides how far it goes with a pair
    "obb_sat": ("bounding_sphere", "the pairs whose balls overlap, which alone it looks at more closely"),
    "obb_triangles": ("rotated_aabb", "the pairs that its prefilter rotated_aabb lets through, which alone it tests by "
                                      "triangles"),
    "obb_corners": ("bounding_sphere", "the pairs whose balls overlap, which alone it looks at more closely"),
}


def failed_labels(clauses, labels):
    """The labels that clauses which fail name."""
    return [label for label in labels if any(each.holds is False and label in each.what.split() for each in clauses)]


def tests_made(kind, scene, labels):
    """How many elementary tests the labels make a step."""
    if "operations" not in scene.summary or not len(scene.bodies):
        return ""
    each = [f"{letter(label)} {number(float(scene.summary.operations[label]) / len(scene.bodies))}" for label in labels]
    return f"Elementary tests a step, each of its own kind, in the {kind} scene: {listed(each)}."


def fewest(scene, labels):
    hits = scene.summary.hits
    return subset(scene.evidence, hits[list(labels[1:])].idxmin(), labels[0])


def blamed(clauses, scenes, labels):
    """Of errors: per scene in which a clause fails, what the misses of its labels come from."""
    found, causes = [], []
    for kind, scene in scenes.items():
        failed = [each for each in clauses if each.holds is False and (each.what.startswith(kind) or len(scenes) == 1)]
        if not failed:
            continue
        named = [label for label in labels if any(label in f"{each.what} {each.where}".split() for each in failed)]
        if not named:
            named = labels[:1]
        if len(named) <= 4:
            found.append(kinds_of_error(scene, named, kind if len(scenes) > 1 else ""))
        if scene.evidence:
            for label in named[:4]:
                for why in (without_triangle(scene.evidence, label), prefilter_misses(scene.evidence, label)):
                    causes.append(f"{kind}: {why}" if why and len(scenes) > 1 else why)
    return found + causes


def who_misses(run):
    """Sentences on whose misses are whose, of the thesis's nine in a Run: for the findings."""
    evidence = of(run)
    if evidence is None:
        return []
    same = {}
    for label in KEYS.values():
        if label in evidence.knobs and (text := prefilter_misses(evidence, label)) and "adds none" in text:
            same.setdefault(evidence.knobs[label][1]["prefilter"], []).append(label)
    found = []
    for before, labels in same.items():
        count = len(evidence.missed(before))
        their, they_add = ("its", "it adds") if len(labels) == 1 else ("their", "they add")
        found.append(f"{listed(letter(label) for label in labels)} {verb(labels, 'misses', 'miss')} nothing that"
                     f" {their} prefilter {before} does not miss, which misses {counted(count, 'pair')}: {they_add} no"
                     f" miss of {their} own.")
    for label in SAMPLERS:
        if label in evidence.knobs and (text := without_triangle(evidence, label)):
            found.append(text)
    return found
