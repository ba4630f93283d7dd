"""A result file as pandas tables.

h5py and xarray read the file unaided too: ``xarray.open_dataset(path, group="results", engine="h5netcdf")``.
``pandas.read_hdf`` does not: it reads only what pandas wrote.
"""

import json
import os
from dataclasses import dataclass, field
from functools import cached_property

import h5py
import numpy as np
import pandas as pd

SCHEMA_VERSION = 1  # the newest that this module knows


@dataclass(frozen=True)
class Run:
    """One result. Tables are read when they are first asked for; the file is not kept open.

    meta: the root's attributes (schema_version, title, git_commit, digest, ...) and
        steps: number of steps; rate: steps per second; bodies, algorithms: lists of names and labels;
        config, config_effective: TOML texts; run: dict of date, host, processor, wall_time_s;
        answers: dict label -> dict of name, knobs (JSON), promise, thesis_key, operations_unit, scope,
        host, processor, build, date, digest.
    """

    path: str
    meta: dict = field(repr=False)

    @cached_property
    def per_step(self):
        """One row per step and algorithm (S x A rows, step by step, algorithms in the file's order).

        Columns: step, time (s), algorithm (categorical); time_ns, time_median_ns, prepare_ns (ns); hits,
        true_positive, false_positive, false_negative, rounding_miss (pairs); operations (elementary tests).
        """
        steps, labels = self.meta["steps"], self.meta["algorithms"]
        table = {
            "step": np.repeat(np.arange(steps), len(labels)),
            "time": np.repeat(np.arange(steps) / self.meta["rate"], len(labels)),
            "algorithm": pd.Categorical.from_codes(np.tile(np.arange(len(labels)), steps), labels),
        }
        return pd.DataFrame(table | {name: values.ravel() for name, values in self._columns("results").items()})

    @cached_property
    def summary(self):
        """One row per algorithm, indexed by its label.

        Columns: hits, true_positive, false_positive, false_negative (pairs over all steps), operations, error,
        precision, recall, matthews (1; NaN for 0/0), time_mean_ns, time_median_ns, time_p95_ns (ns per step),
        promise_kept (bool).
        """
        table = pd.DataFrame(self._columns("summary"), index=pd.Index(self.meta["algorithms"], name="algorithm"))
        return table.astype({"promise_kept": bool}) if len(table.columns) else table

    @cached_property
    def physics(self):
        """One row per step, indexed by step; None when nothing was integrated. How it ended: attrs["status"]; and
        attrs["quaternion_drift"], the greatest deviation of a quaternion's norm from 1 in the integrator.

        Columns: energy, kinetic_energy (J), greatest_penetration (m), contacts; and since the step before:
        integrator_steps, rejected_steps, force_evaluations, time_ns, contact_time_ns.
        """
        columns = self._columns("physics")
        if not columns:
            return None
        table = pd.DataFrame(columns, index=pd.RangeIndex(self.meta["steps"], name="step"))
        with h5py.File(self.path) as file:
            table.attrs.update({name: file["physics"].attrs[name] for name in file["physics"].attrs})
        return table

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
        """The pairs of which one body lies wholly inside the other. Columns as truth_pairs; None when not recorded."""
        with h5py.File(self.path) as file:
            if "contained_pair" not in file["truth"]:
                return None
        return self._pairs("truth", "contained_pair", "contained_offset")

    @cached_property
    def bodies(self):
        """One row per body, indexed by its name.

        Columns: mesh (name), fixed (bool), first_step; kind ("box", "sphere", ...; "file" for a mesh read from one);
        size (3, m): the greatest less the least local vertex.
        """
        with h5py.File(self.path) as file:
            shapes = {name: (_kind(mesh.attrs["shape"]), np.ptp(mesh["vertices"][()], axis=0))
                      for name, mesh in file["meshes"].items()}  # fmt: skip
            mesh = list(file["bodies/mesh"].asstr()[()])
            table = {
                "mesh": mesh,
                "fixed": file["bodies/fixed"][()].astype(bool),
                "first_step": file["bodies/first_step"][()],
                "kind": [shapes[name][0] for name in mesh],
                "size": [shapes[name][1] for name in mesh],
            }
        return pd.DataFrame(table, index=pd.Index(self.meta["bodies"], name="body"))

    @cached_property
    def motion(self):
        """position (S,B,3) m and orientation (S,B,4) w x y z; NaN for a body that is not there."""
        with h5py.File(self.path) as file:
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
        with h5py.File(self.path) as file:
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
        with h5py.File(self.path) as file:
            if "passes" not in file:
                return None
            columns = {}
            for name, data in file["passes"].items():
                if not h5py.h5ds.is_scale(data.id):
                    columns[name] = (data.asstr() if data.dtype == object else data)[()]
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

    def _columns(self, group):
        """name -> values of a group's columns, its dimensions left out; empty when there is no such group."""
        with h5py.File(self.path) as file:
            datasets = file.get(group, {})
            return {name: data[()] for name, data in datasets.items() if not h5py.h5ds.is_scale(data.id)}

    def _pairs(self, group, pair="pair", offset="pair_offset"):
        with h5py.File(self.path) as file:
            offset, pair = file[group][offset][()], file[group][pair][()]
        step = np.repeat(np.arange(self.meta["steps"]), np.diff(offset).astype(np.int64))
        return pd.DataFrame({"step": step, "a": pair[:, 0], "b": pair[:, 1]})


def load(path):
    """Opens the result at `path` as a Run.

    Raises OSError when it is missing or not HDF5, ValueError when it is not a result or of a newer schema.
    """
    path = os.fspath(path)
    with h5py.File(path) as file:
        version = file.attrs.get("schema_version")
        if version is None:
            raise ValueError(f"{path}: is not a result of this program (it has no attribute schema_version)")
        if not 1 <= version <= SCHEMA_VERSION:
            raise ValueError(
                f"{path}: has schema version {version}, this module reads 1 to {SCHEMA_VERSION}; "
                "use the analysis/load.py that came with the program that wrote it"
            )
        meta = dict(file.attrs) | {
            "steps": file["step"].shape[0] if "step" in file else 0,
            "rate": float(file["time"].attrs["rate"]) if "time" in file else float("nan"),
            "bodies": _names(file, "body"),
            "algorithms": _names(file, "algorithm"),
            "config": file["config"].asstr()[()],
            "config_effective": file["config"].attrs["effective"],
            "run": dict(file["run"].attrs),
            "answers": {label: dict(file["answers"][label].attrs) for label in _names(file, "algorithm")},
        }
    return Run(path, meta)


def _kind(shape):
    """The kind of a mesh from its attribute `shape`: JSON of kind and parameters, or the name of a file."""
    try:
        return json.loads(shape)["kind"]
    except (ValueError, KeyError, TypeError):
        return "file"


def _names(file, scale):
    return list(file[scale].asstr()[()]) if scale in file else []
