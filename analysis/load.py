"""A result file as pandas tables: load(path), then one attribute or call per table.

    per_step                one row per step and algorithm: times, hits, right and wrong answers, operations
    summary                 one row per algorithm, over all steps
    per_pair(label)         one row per step and pair that the algorithm reports or misses, and which of it is
    pairs(label), truth_pairs, contained_pairs     the lists of pairs as they are in the file
    passes                  the playground: how early or late each algorithm is, one row per pass and algorithm
    physics                 one row per step of an integrated motion
    bodies, motion          one row per body; poses as arrays
    proxies, proxy(label, mesh)     what methods test in place of meshes, and how far these stick out of it
    study                   one row per case of a study of integrators
    timed_on, unlike        which machine timed what, of a run that several shared

load_sweep(folder) gives all points of a sweep (scripts/sweep) as one table, a row per point and label.

Steps and counts are integers (int64, uint64), times in ns int64 (float64 in summary), everything else float64 in SI
units; labels and names are text. What a file does not have is None or a table without rows, as each says.

h5py and xarray read the file unaided too: ``xarray.open_dataset(path, group="results", engine="h5netcdf")``.
``pandas.read_hdf`` does not: it reads only what pandas wrote.
"""

import json
import os
from dataclasses import dataclass, field, replace
from functools import cached_property

import h5py
import numpy as np
import pandas as pd

from . import intact
from .tables.intervals import Interval

SCHEMA_VERSION = 2  # the newest that this module knows; 1 had unsigned offsets
SWEEP = "sweep.json"  # what makes a folder one of a sweep


@dataclass(frozen=True)
class Run:
    """One result. Tables are read when they are first asked for; the file is not kept open.

    meta: the root's attributes (schema_version, title, git_commit, digest, ...) and
        steps: number of steps; rate: steps per second; bodies, algorithms: lists of names and labels;
        config, config_effective: TOML texts; run: dict of date, host, processor, wall_time_s;
        answers: dict label -> dict of name, knobs (JSON), promise, thesis_key, operations_unit, scope,
        library (of somebody else's methods), host, processor, build, date, digest; of methods of others transport,
        command, files_sha256, version, language, precision, threads, status, reason, steps_done; motion, truth: dicts
        of digest, containment (if asked for).
        Of what a file lacks, the texts, lists and dicts are empty, steps 0 and rate NaN.
    """

    path: str
    meta: dict = field(repr=False)
    mark: tuple = field(repr=False)  # of the file that was checked
    shown: tuple = field(default=None, repr=False)  # places of the algorithms that completed() keeps; None: all

    @property
    def failed(self):
        """label -> why it ended, and how far it came, of methods of others that failed at a step. None in a scene of
        extremes: there a failure is the answer to its case, and the others are whole."""
        if self.extremes is not None:
            return {}
        ended = {label: answers for label, answers in self.meta["answers"].items() if answers.get("status") == "failed"}
        return {label: (answers["reason"], answers["steps_done"]) for label, answers in ended.items()}

    def completed(self):
        """The same result without the algorithms that failed: their tables know some steps only."""
        if not self.failed:
            return self
        labels = self.meta["algorithms"]
        shown = tuple(place for place, label in enumerate(labels) if label not in self.failed)
        kept = [labels[place] for place in shown]
        meta = self.meta | {"algorithms": kept, "answers": {label: self.meta["answers"][label] for label in kept}}
        return replace(self, meta=meta, shown=shown)

    def opened(self):
        """The file as an h5py.File, to be closed. Raises OSError when it is not the one that was loaded any more."""
        return intact.opened(self.path, self.mark)

    @cached_property
    def per_step(self):
        """One row per step and algorithm (S x A rows, step by step, algorithms in the file's order), numbered from 0.

        Columns: step (int64), time (float64, s), algorithm (categorical); time_ns, time_median_ns, prepare_ns (int64,
        ns); hits, true_positive, false_positive, false_negative, rounding_miss (uint64, pairs), contained_hit where it
        is recorded; operations (uint64, elementary tests).
        """
        steps, labels = self.meta["steps"], self.meta["algorithms"]
        table = {
            "step": np.repeat(np.arange(steps), len(labels)),
            "time": np.repeat(np.arange(steps) / self.meta["rate"], len(labels)),
            "algorithm": pd.Categorical.from_codes(np.tile(np.arange(len(labels)), steps), labels),
        }
        columns = {name: values.ravel() for name, values in self._columns("results").items()}
        return pd.DataFrame(table | columns if columns else {name: values[:0] for name, values in table.items()})

    @cached_property
    def summary(self):
        """One row per algorithm, indexed by its label.

        Columns: hits, true_positive, false_positive, false_negative (uint64, pairs over all steps), contained_hit where
        it is recorded; operations (uint64); error, precision, recall, matthews (float64, 1; NaN for 0/0); time_mean_ns,
        time_median_ns, time_p95_ns (float64, ns per step); promise_kept (bool). In files that have them, NaN where
        nothing is known: time_mean_low_ns and time_mean_high_ns, a 95 % interval of the mean; processor_mean_ns;
        setup_ns; memory_bytes and memory_greatest_bytes, heap after set-up and the most (all float64).
        """
        table = pd.DataFrame(self._columns("summary"), index=pd.Index(self.meta["algorithms"], name="algorithm"))
        return table.astype({"promise_kept": bool}) if len(table.columns) else table

    @cached_property
    def noise(self):
        """The noise floor: the ratio of the mean time of the first label, timed twice, to itself (an Interval); None
        when it was not asked for ([timing] noise). No smaller difference of times is one."""
        with self.opened() as file:
            if "noise" not in file:
                return None
            known = file["noise"].attrs
            return Interval(*(float(known[name]) for name in ("ratio", "ratio_low", "ratio_high")))

    @cached_property
    def timed_on(self):
        """One row per chunk of steps and algorithm: step (the chunk's first), algorithm (categorical), host, processor;
        None when the run was one machine's. Who decided the truth of a chunk: host and processor of truth_host,
        truth_processor."""
        with self.opened() as file:
            if "machines" not in file:
                return None
            group, labels = file["machines"], self.meta["algorithms"]
            hosts, processors = group["host"].asstr()[()], group["processor"].asstr()[()]
            first, truth = group["chunk"][()], np.repeat(group["truth"][()].astype(np.int64), len(labels))
            answers = self._values(group["answers"]).astype(np.int64).ravel() if labels else truth
        return pd.DataFrame({
            "step": np.repeat(first, len(labels)),
            "algorithm": pd.Categorical.from_codes(np.tile(np.arange(len(labels)), len(first)), labels),
            "host": hosts[answers], "processor": processors[answers],
            "truth_host": hosts[truth], "truth_processor": processors[truth],
        })  # fmt: skip

    @cached_property
    def unlike(self):
        """label -> the processors that it was timed on, of labels that were timed on several unlike ones: their times
        per step are no times of one machine, and their summary has none."""
        if self.timed_on is None:
            return {}
        found = self.timed_on.groupby("algorithm", observed=True)["processor"].unique()
        return {label: list(processors) for label, processors in found.items() if len(processors) > 1}

    @cached_property
    def step_times(self):
        """label -> time per step (float64, S, ns); empty when the file has no times per step."""
        table, labels = self.per_step, self.meta["algorithms"]
        if "time_ns" not in table or not labels:
            return {}
        times = table["time_ns"].to_numpy(dtype=float).reshape(-1, len(labels))
        return {label: times[:, place] for place, label in enumerate(labels)}

    @cached_property
    def physics(self):
        """One row per step, indexed by step; None when nothing was integrated. How it ended: attrs["status"]; and
        attrs["quaternion_drift"], the greatest deviation of a quaternion's norm from 1 in the integrator.

        Columns: energy, kinetic_energy (float64, J), greatest_penetration (float64, m), contacts (uint64); and since
        the step before: integrator_steps, rejected_steps, force_evaluations (uint64), time_ns, contact_time_ns (int64,
        ns).
        """
        columns = self._columns("physics")
        if not columns:
            return None
        table = pd.DataFrame(columns, index=pd.RangeIndex(self.meta["steps"], name="step"))
        with self.opened() as file:
            table.attrs.update({name: file["physics"].attrs[name] for name in file["physics"].attrs})
        return table

    @cached_property
    def truth_hits(self):
        """The number of pairs that meet, per step (uint64, S); empty when the file has no truth."""
        with self.opened() as file:
            return file["truth/hits"][()] if "truth/hits" in file else np.zeros(0, np.uint64)

    def per_pair(self, label):
        """What an algorithm says of each pair. One row per step and pair that it reports or that truly meets, sorted.

        Columns: step (int64), a, b (uint32, numbers of bodies, a < b), verdict (categorical: true_positive,
        false_positive, false_negative, contained_hit: a hit on a contained pair where those are counted apart).
        Raises KeyError as pairs().
        """
        reported, truth, contained = self.pairs(label), self.truth_pairs, None
        containment = self.meta["truth"].get("containment")
        if containment == "meet":
            truth = pd.concat([truth, self.contained_pairs[["step", "a", "b"]]], ignore_index=True)
        elif containment == "record":
            contained = self.contained_pairs
        bodies = max(len(self.meta["bodies"]), 1)

        def key(table):
            return (table.step.to_numpy() * bodies + table.a.to_numpy()) * bodies + table.b.to_numpy()

        hit, meets = key(reported), key(truth)
        verdict = np.where(np.isin(hit, meets, assume_unique=True), 0, 1)
        if contained is not None:
            verdict[np.isin(hit, key(contained), assume_unique=True)] = 3
        missed = truth[~np.isin(meets, hit, assume_unique=True)]
        table = pd.concat([reported, missed], ignore_index=True)
        verdict = np.concatenate([verdict, np.full(len(missed), 2)])
        names = ["true_positive", "false_positive", "false_negative", "contained_hit"]
        table["verdict"] = pd.Categorical.from_codes(verdict, names)
        return table.sort_values(["step", "a", "b"], ignore_index=True)

    def pairs(self, label):
        """The pairs that an algorithm reported. Columns: step, a, b (numbers of bodies, a < b); N rows, sorted.

        Raises KeyError, naming the labels there are, when `label` is not among them.
        """
        if label not in self.meta["answers"]:
            raise KeyError(f"{self.path}: no algorithm '{label}'; there are {', '.join(self.meta['answers'])}")
        return self._pairs(f"answers/{label}")

    @cached_property
    def truth_pairs(self):
        """The pairs that meet. Columns: step, a, b (numbers of bodies, a < b); N rows, sorted."""
        return self._pairs("truth")

    @cached_property
    def contained_pairs(self):
        """The pairs of which one body lies wholly inside the other; None when not recorded.

        Columns: step, a, b as truth_pairs; inside: the body that is, a or b (not in files older than the column).
        """
        with self.opened() as file:
            if "truth/contained_pair" not in file:
                return None
            inside = {"inside": data[()] for name, data in file["truth"].items() if name == "contained_inside"}
        return self._pairs("truth", "contained_pair", "contained_offset").assign(**inside)

    @cached_property
    def gaps(self):
        """The distances of near pairs that do not meet; None when not recorded. Margin (m): attrs["margin"].

        Columns: step, a, b (numbers of bodies, a < b), lower, upper (m): lower <= distance <= upper, both certified. A
        pair whose distance is surely above the margin is not there. N rows, sorted.
        """
        with self.opened() as file:
            truth = file["truth"]
            if "gap_pair" not in truth:
                return None
            bounds = {name: truth[f"gap_{name}"][()] for name in ("lower", "upper")}
            margin = float(truth.attrs["gap_margin"])
        table = self._pairs("truth", "gap_pair", "gap_offset").assign(**bounds)
        table.attrs["margin"] = margin
        return table

    @cached_property
    def bodies(self):
        """One row per body, indexed by its name.

        Columns: mesh (name), fixed (bool), first_step; kind ("box", "sphere", ...; "file" for a mesh read from one);
        size (3, m): the greatest less the least local vertex; facets: triangles of the mesh.
        """
        with self.opened() as file:
            shapes = {name: (_kind(mesh.attrs["shape"]), np.ptp(mesh["vertices"][()], axis=0), len(mesh["triangles"]))
                      for name, mesh in file["meshes"].items()}
            mesh = list(file["bodies/mesh"].asstr()[()])
            table = {
                "mesh": mesh,
                "fixed": file["bodies/fixed"][()].astype(bool),
                "first_step": file["bodies/first_step"][()],
                "kind": [shapes[name][0] for name in mesh],
                "size": [shapes[name][1] for name in mesh],
                "facets": [shapes[name][2] for name in mesh],
            }
        return pd.DataFrame(table, index=pd.Index(self.meta["bodies"], name="body"))

    @cached_property
    def proxies(self):
        """What methods test in place of meshes: one row per label and mesh; None when no method does.

        Columns: label, mesh, kind ("balls", "capsule", "solids" or "none"), reason (why there is none), parts (balls or
        closed surfaces); of the vertices of the mesh outside_share (1) and outside_greatest (m, certified), 0 where the
        proxy holds all of them, NaN where there is none.
        """
        with self.opened() as file:
            if "proxies" not in file:
                return None
        table = pd.DataFrame(self._columns("proxies"))
        return table[table["label"].isin(self.meta["algorithms"])].reset_index(drop=True)

    def proxy(self, label, mesh):
        """The shape that a label tests in place of a mesh, in the mesh's own frame, m: dict of kind and balls (K,4: x,
        y, z, radius; of a capsule its two ends), or vertices (V,3), triangles (T,3) and solid_offset (of solid i those
        from solid_offset[i] to solid_offset[i + 1] - 1). Raises KeyError where there is none.
        """
        with self.opened() as file:
            path = f"meshes/{mesh}/proxies/{label}"
            if path not in file:
                raise KeyError(f"{self.path}: '{label}' has nothing in place of mesh '{mesh}'")
            group = file[path]
            shape = {name: data[()] for name, data in group.items() if not h5py.h5ds.is_scale(data.id)}
            return {"kind": group.attrs["kind"]} | shape

    @cached_property
    def motion(self):
        """position (S,B,3) m and orientation (S,B,4) w x y z; NaN for a body that is not there."""
        with self.opened() as file:
            return file["motion/position"][()], file["motion/orientation"][()]

    @cached_property
    def study(self):
        """One row per case, indexed by its number; None when the result is not a study of integrators.

        Columns: sweep, problem, integrator, units, status, reason (text); what a case is made of, NaN where its problem
        has no such parameter: accuracy, fixed_step (s), nominal_order, duration (s), stiffness (Pa), ...; what came of
        it: finished (bool), reached (s), error (relative or rad), position_error (m), orientation_error (rad),
        energy_error, momentum_drift (1), greatest_penetration (m), smallest_step, preventing_step (s), steps,
        rejected_steps, force_evaluations, time_ns (of processor).
        """
        with self.opened() as file:
            if "study" not in file:
                return None
            columns = {}
            for name, data in file["study"].items():
                if not h5py.h5ds.is_scale(data.id):
                    columns[name] = (data.asstr() if data.dtype == object else data)[()]
            case = file["study/case"][()]
        return pd.DataFrame(columns, index=pd.Index(case, name="case")).astype({"finished": bool})

    @cached_property
    def passes(self):
        """One row per pass and algorithm (P x A rows, pass by pass); None when the scene has no passes.

        Columns: number (of the pass), target (name of the body), path, offset, orientation (as in the file), algorithm
        (categorical); truth_first, truth_last (m, NaN for never), first, last (m before the exact first and last
        contact, negative after; NaN for never), flicker, reported (samples; `hits` in the file), and what else it has.
        """
        with self.opened() as file:
            if "passes" not in file:
                return None
            columns = {}
            for name, data in file["passes"].items():
                if not h5py.h5ds.is_scale(data.id):
                    columns[name] = self._values(data)
        if "hits" in columns:
            columns["reported"] = columns.pop("hits")
        labels, bodies = self.meta["algorithms"], np.array(self.meta["bodies"], dtype=object)
        passes = len(columns["target"])
        if columns["target"].dtype.kind in "ui":
            columns["target"] = bodies[columns["target"]]
        table = {
            "number": np.repeat(np.arange(passes), len(labels)),
            "algorithm": pd.Categorical.from_codes(np.tile(np.arange(len(labels)), passes), labels),
        }
        for name, values in columns.items():
            table[name] = values.ravel() if values.ndim == 2 else np.repeat(values, len(labels))
        return pd.DataFrame(table)

    @cached_property
    def extremes(self):
        """One row per case and algorithm (S x A rows, step by step); None when the scene is not one of extremes.

        Columns: step, algorithm (categorical), pair (of shapes), gap_class, gap (m, negative beyond touching),
        gap_ulps, ulp (m), scale, offset (m), orientation_stream; truth, truth_moved, near_touching, reported, swapped,
        moved (bool: as in the file), failed (bool), refused (bool: it failed because it refused the bodies).
        """
        columns = self._columns("extremes")
        if not columns:
            return None
        steps, labels = self.meta["steps"], self.meta["algorithms"]
        columns.pop("failure", None)
        table = {
            "step": np.repeat(np.arange(steps), len(labels)),
            "algorithm": pd.Categorical.from_codes(np.tile(np.arange(len(labels)), steps), labels),
        }
        for name, values in columns.items():
            table[name] = values.ravel() if values.ndim == 2 else np.repeat(values, len(labels))
        table = pd.DataFrame(table)
        table["refused"] = table["failed"] == 1
        flags = ["truth", "truth_moved", "near_touching", "reported", "swapped", "moved", "failed"]
        return table.astype(dict.fromkeys(flags, bool))

    @cached_property
    def failures(self):
        """Per algorithm what it said when it first failed at a case of extremes, "" when it never did; else None."""
        with self.opened() as file:
            return list(self._values(file["extremes/failure"])) if "extremes/failure" in file else None

    def _columns(self, group):
        """name -> values of a group's columns, its dimensions left out; empty when there is no such group."""
        with self.opened() as file:
            datasets = file.get(group, {})
            return {name: self._values(data) for name, data in datasets.items() if not h5py.h5ds.is_scale(data.id)}

    def _values(self, data):
        """The values of a dataset, those of the shown algorithms where it has some of each."""
        values = (data.asstr() if data.dtype == object else data)[()]
        last = [scale.name for scale in data.dims[data.ndim - 1].values()] if data.ndim else []
        by_algorithm = any(name.rpartition("/")[2] == "algorithm" for name in last)
        return values if self.shown is None or not by_algorithm else values[..., list(self.shown)]

    def _pairs(self, group, pair="pair", offset="pair_offset"):
        with self.opened() as file:
            if group not in file:
                raise KeyError(f"{self.path}: has no /{group}")
            offset, pair = file[group][offset][()], file[group][pair][()]
        step = np.repeat(np.arange(self.meta["steps"]), np.diff(offset).astype(np.int64))
        return pd.DataFrame({"step": step, "a": pair[:, 0], "b": pair[:, 1]})


def load(path, unsealed=False):
    """Opens the result at `path` as a Run, once all of it was checked: its seal, its links and sizes, its digests.

    Raises OSError when it is missing, no regular file, not HDF5, cut off, changed or damaged, ValueError when it is an
    unfinished run, not a result, or of a schema that this module does not know. The message is one line that starts
    with the path. unsealed: read a file that was changed since it was written, as by own datasets in own groups; then,
    and of results from before there were seals, times and attributes are vouched for by nobody, which is warned.
    """
    path = os.fspath(path)
    if os.path.isdir(path):
        if os.path.exists(os.path.join(path, SWEEP)):
            raise ValueError(f"{path}: is the folder of a sweep; load_sweep reads it, load one of its points/*.h5")
        if os.path.exists(os.path.join(path, "manifest.json")) or path.rstrip("/").endswith(".part"):
            raise ValueError(f"{path}: is an unfinished run; the command that began it finishes it")
        raise ValueError(f"{path}: is a folder, not a result")
    if not os.path.exists(path):
        raise FileNotFoundError(f"{path}: there is no such file")
    meta, mark = intact.checked(path, lambda file: _meta(path, file), unsealed)
    return Run(path, meta, mark)


def load_sweep(folder):
    """A sweep as one frame: a row per point and label, and one of a point that failed, with label "".

    Columns: point (its name), a column per parameter of the sweep (text, int or float), status ("done", "failed", ...),
    reason, exit_code (float), host, processor, build, began (seconds since 1970), wall_time_s, digest, steps, bodies,
    truth_hits; label, algorithm, and the columns of Run.summary (float64; NaN where a point failed). attrs: sweep,
    title, parameters (their names), folder. Raises OSError when there is no such folder, ValueError when it is not one
    of a sweep, in a line that starts with it.
    """
    folder = os.fspath(folder)
    path = os.path.join(folder, SWEEP)
    if not os.path.isdir(folder):
        raise FileNotFoundError(f"{folder}: there is no such folder")
    if not os.path.exists(path):
        raise ValueError(f"{folder}: is not the folder of a sweep (it has no {SWEEP})")
    try:
        with open(path, encoding="utf-8") as file:
            table = sweep_frame(json.load(file))
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"{path}: is damaged ({type(error).__name__}: {error})") from error
    table.attrs["folder"] = folder
    return table


def sweep_frame(manifest):
    """The frame of load_sweep from what sweep.json holds."""
    told = ["status", "reason", "exit_code", "host", "processor", "build", "began", "wall_time_s", "digest"]
    told += ["steps", "bodies", "truth_hits"]
    texts, rows = ["reason", "host", "processor", "build", "digest"], []
    for point in manifest["points"]:
        parameters = {name: point["parameters"][name] for name in manifest["parameters"]}
        of_point = {"point": point["name"]} | parameters | {name: point.get(name) for name in told}
        of_point |= {name: of_point[name] or "" for name in texts}
        rows += [of_point | row for row in point.get("summary") or [{"label": "", "algorithm": ""}]]
    table = pd.DataFrame(rows, columns=list(dict.fromkeys(name for row in rows for name in row)))
    kept = {"point", "label", "algorithm", "status", *texts, *manifest["parameters"]}
    kept |= {"knobs", "promise", "scope", "operations_unit"}
    for name in table.columns:
        if name not in kept:
            table[name] = table[name].astype(float)
    table.attrs = {"sweep": manifest["sweep"], "title": manifest["title"], "parameters": list(manifest["parameters"])}
    return table


def _meta(path, file):
    """Run.meta of an open file. Raises ValueError when it is no result, or of an unknown schema."""
    version = file.attrs.get("schema_version")
    if version is None:
        raise ValueError(f"{path}: is not a result of this program (it has no attribute schema_version)")
    if not isinstance(version, (int, np.integer)) or not 1 <= version <= SCHEMA_VERSION:
        raise ValueError(
            f"{path}: has schema version {version}, this module reads 1 to {SCHEMA_VERSION}; use the analysis/load.py "
            "that came with the program that wrote it"
        )
    answers = file.get("answers", {})
    labels = _names(file, "algorithm")
    lost = [label for label in labels if label not in answers]
    if lost:
        raise ValueError(f"{path}: is damaged: /answers lacks {', '.join(lost)}")
    return {name: _plain(value) for name, value in file.attrs.items()} | {
        "steps": file["step"].shape[0] if "step" in file else 0,
        "rate": float(file["time"].attrs.get("rate", np.nan)) if "time" in file else np.nan,
        "bodies": _names(file, "body"),
        "algorithms": labels,
        "config": file["config"].asstr()[()] if "config" in file else "",
        "config_effective": file["config"].attrs.get("effective", "") if "config" in file else "",
        "run": _attributes(file, "run"),
        "motion": _attributes(file, "motion"),
        "truth": _attributes(file, "truth"),
        "answers": {label: _attributes(file, f"answers/{label}") for label in labels},
    }


def _attributes(file, group):
    return {name: _plain(value) for name, value in file[group].attrs.items()} if group in file else {}


def _plain(value):
    return value.item() if isinstance(value, np.generic) else value


def _kind(shape):
    """The kind of a mesh from its attribute `shape`: JSON of kind and parameters, or the name of a file."""
    try:
        return json.loads(shape)["kind"]
    except (ValueError, KeyError, TypeError):
        return "file"


def _names(file, scale):
    return list(file[scale].asstr()[()]) if scale in file else []
