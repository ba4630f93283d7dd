"""What the statements ask of a run: the playground by pass and by sample, the box and falling scenes by step and in
sum."""

import json
import tomllib
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from . import causes, intervals
from .clauses import KEYS
from .thresholds import MIDDLE_M, PARALLEL, THIN

TURN_EPSILON = 1e-6  # of matrices and quaternions; the turns of a playground are tens of degrees


@dataclass(frozen=True)
class Playground:
    """The hero's passes through the targets.

    passes: as Run.passes;
    targets: per target kind ("box", "torus", ...), thin (a slab), turn ("none"; "quarter": the axes onto axes;
        "other") and axes (0, 1 or 2: turned about several of x, y, z);
    samples: per step target (the nearest), truth, contained (bool; contained None when not recorded), middle (the
        hero's centre near the target's) and through (it sticks in a slab's middle, its long axis across the slab);
    reports: per step and label, whether that target is reported; false_negative: per label; summary: as in Run;
    evidence: what causes are proved from.
    """

    passes: pd.DataFrame
    targets: pd.DataFrame
    samples: pd.DataFrame
    reports: pd.DataFrame
    false_negative: pd.Series
    summary: pd.DataFrame | None = None
    evidence: causes.Evidence | None = None

    @property
    def labels(self):
        return list(self.reports.columns)

    @property
    def error(self):
        """Per label; None when it is not known."""
        return self.summary.error if self.summary is not None and "error" in self.summary else None


@dataclass(frozen=True)
class Timed:
    """A run with dynamics. summary, per_step: as in Run; bodies: per step, how many are there; host: where it was
    timed; twins: as of twins(); times: label -> time per step; noise: as in Run;
    evidence: what causes are proved from."""

    summary: pd.DataFrame
    per_step: pd.DataFrame
    bodies: np.ndarray
    host: str
    twins: dict = field(default_factory=dict)
    times: dict = field(default_factory=dict)
    noise: intervals.Interval | None = None
    evidence: causes.Evidence | None = None

    @property
    def labels(self):
        return list(self.summary.index)

    @property
    def error(self):
        """Per label; None when it is not known."""
        return self.summary.error if "error" in self.summary else None

    def ratio(self, one, other):
        """The mean time of a label over another's, with its interval where times per step are known."""
        mean = self.summary.time_mean_ns
        if one not in self.times or other not in self.times:
            return intervals.Interval(float(mean[one] / mean[other]))
        return intervals.ratio(self.times[one], self.times[other])

    def mean(self, label):
        """The mean time of a label, likewise."""
        if label not in self.times:
            return intervals.Interval(float(self.summary.time_mean_ns[label]))
        return intervals.mean(self.times[label])


def kind(run):
    """The kind of scene of a Run: "box", "falling", "playground", "replay", ...; "" for a study without a scene."""
    return tomllib.loads(run.meta["config_effective"]).get("scene", {}).get("kind", "")


def ends_early(run):
    """What of its scene a run does not reach, being shortened: it is another scene then. Sentences."""
    try:
        config = tomllib.loads(run.meta["config_effective"])
        scene, steps, rate = config["scene"], int(run.meta["steps"]), float(run.meta["rate"])
        if scene["kind"] == "falling":
            gravity = -float(config.get("physics", {}).get("gravity", [0, -9.81, 0])[1])
            lands = [(float(np.sqrt(2 * max(float(group["height"]) - 2 * float(scene.get("radius", 1)), 0) / gravity)),
                place)
                     for place, group in enumerate(scene.get("set", []), 1) if "height" in group and gravity > 0]
            late = [(when, place) for when, place in lands if when > (steps - 1) / rate]
            if late:
                when, place = max(late)
                return [f"its {steps} steps end at {(steps - 1) / rate:.3g} s, before set {place} of {len(lands)} can "
                        f"have landed ({when:.3g} s): a run shortened so is another scene."]
        if scene["kind"] == "box":
            births = scene.get("births", {})
            last = int(births.get("from", 0)) + int(births.get("every", 0)) * (int(births.get("count", 1)) - 1)
            if last >= steps:
                return [f"its {steps} steps end before the last body is born (step {last}): a run shortened so is "
                        "another scene."]
    except (KeyError, ValueError, TypeError, IndexError, ZeroDivisionError):
        return []
    return []


def timed(run):
    first = run.bodies.first_step.to_numpy()
    there = (first[None, :] >= 0) & (first[None, :] <= np.arange(run.meta["steps"])[:, None])
    hosts = {(answers["host"], answers["processor"]) for answers in run.meta["answers"].values()}
    alike = len(hosts) == 1 and not run.unlike
    host = " ".join(hosts.pop()) if alike else ""  # "" when algorithms were timed on different machines
    times = {label: times for label, times in run.step_times.items() if label not in run.unlike}
    return Timed(run.summary, run.per_step, there.sum(axis=1), host, twins(run), times, run.noise, causes.of(run))


def twins(run):
    """Labels that are timed in another procedure than the thesis's -> the label of the same answers in the thesis's
    own, "" where the file has none.

    That is facet_distance with search = "indexed": it leaves out points that surely are not near, the thesis compared
    all. Its answers are the same.
    """
    knobs = {
        label: json.loads(answers.get("knobs") or "{}")
        for label, answers in run.meta["answers"].items()
        if answers.get("name") == "facet_distance"
    }
    return {
        label: next((other for other in knobs if knobs[other] == mine | {"search": "exhaustive"}), "")
        for label, mine in knobs.items()
        if mine.get("search") == "indexed"
    }


def thesis_kind(run):
    """As kind(), of scenes that the thesis has: its falling bodies are spheres. "" of others."""
    found = kind(run)
    if found == "falling" and {"kind", "fixed"} <= set(run.bodies.columns):
        moving, fixed = run.bodies[~run.bodies.fixed], run.bodies[run.bodies.fixed]
        if not (moving["kind"] == "sphere").all() or not (fixed["kind"] == "box").all() or len(fixed) > 1:
            return ""
    return found


def companions(runs):
    """kind -> the run that has the thesis's procedure for all nine where another of its kind, of more steps, has not:
    it is asked for times only."""
    found = {}
    for run in runs:
        mine, label = kind_or_none(run), KEYS["K"]
        others = [other for other in runs if other is not run and kind_or_none(other) == mine]
        if mine and twins(run).get(label) and set(KEYS.values()) <= set(run.meta["algorithms"]):
            if any(twins(other).get(label) == "" and other.meta["steps"] > run.meta["steps"] for other in others):
                found.setdefault(mine, run)
    return found


def kind_or_none(run):
    try:
        return thesis_kind(run)
    except (KeyError, ValueError, OSError):
        return ""


def playground(run):
    """Raises ValueError when not exactly one body moves, or there are no passes."""
    moving = np.flatnonzero(~run.bodies.fixed.to_numpy())
    if run.passes is None or len(moving) != 1:
        raise ValueError(f"{run.path}: a playground has /passes and one body that moves, this has {len(moving)}")
    hero = moving[0]
    position, orientation = run.motion
    fixed = np.flatnonzero(run.bodies.fixed.to_numpy())
    away = position[:, [hero]] - position[0, fixed]
    near = np.argmin((away**2).sum(axis=2), axis=1)
    steps = np.arange(len(position))
    nearest, away = fixed[near], away[steps, near]

    shapes = [_shape(run.bodies.iloc[body], orientation[0, body]) for body in fixed]
    targets = pd.DataFrame(shapes, index=pd.Index(run.bodies.index[fixed], name="target"))

    size = run.bodies["size"].to_list()
    along = rotation(orientation[:, hero])[:, :, np.argmax(size[hero])]
    normal = np.array([rotation(orientation[0, body])[:, np.argmin(size[body])] for body in fixed])[near]
    depth, cosine = (np.abs((vector * normal).sum(axis=1)) for vector in (away, along))

    def has(pairs):
        """Per step, whether `pairs` has the hero with the nearest target."""
        flags = np.zeros(len(steps), dtype=bool)
        other = np.where(pairs.a == hero, pairs.b, pairs.a)
        mine = (other == nearest[pairs.step]) & ((pairs.a == hero) | (pairs.b == hero))
        flags[pairs.step[mine]] = True
        return flags

    truth = has(run.truth_pairs)
    samples = pd.DataFrame(
        {
            "target": run.bodies.index[nearest],
            "truth": truth,
            "contained": None if run.contained_pairs is None else has(run.contained_pairs),
            "middle": (away**2).sum(axis=1) <= MIDDLE_M**2,
            "through": truth & targets.thin.to_numpy()[near] & (cosine >= PARALLEL) & (depth <= MIDDLE_M),
        }
    )
    reports = pd.DataFrame({label: has(run.pairs(label)) for label in run.meta["algorithms"]})
    return Playground(run.passes, targets, samples, reports, run.summary.false_negative, run.summary, causes.of(run))


def _shape(body, quaternion):
    size, turned = np.sort(body["size"]), np.abs(rotation(quaternion))
    # A permutation of the axes: every entry is 0 or 1.
    quarter = np.all(np.minimum(turned, np.abs(turned - 1)) < TURN_EPSILON)
    axes = int((np.abs(quaternion[1:]) > TURN_EPSILON).sum())
    return {
        "kind": body["kind"],
        "thin": body["kind"] == "box" and size[0] <= THIN * size[2],
        "turn": "none" if axes == 0 else "quarter" if quarter else "other",
        "axes": min(axes, 2),
    }


def rotation(quaternion):
    """(..., 4) w x y z, of unit length -> (..., 3, 3)."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))
