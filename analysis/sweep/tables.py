"""The tables of a sweep, from its manifest: sweep.csv for people, sweep.h5 for programs."""

import json
import os

import h5py
import numpy as np

from ..files import replaced
from ..load import sweep_frame

POINT = {  # column of /points -> long name
    "status": "done, failed, stopped, died or missing",
    "reason": "why it is not done",
    "exit_code": "exit code of the program, -1 where there is none",
    "host": "machine that ran it",
    "processor": "its processor",
    "wall_time_s": "wall time of the whole process",
    "digest": "digest of the result",
    "steps": "steps of the result",
    "bodies": "bodies of the result",
}
TEXTS = ("status", "reason", "host", "processor", "digest")
UNITS = {"wall_time_s": "s"}


def write(folder, manifest):
    """Both tables, each whole or not at all. Raises OSError, in a line that starts with the path."""
    with replaced(os.path.join(folder, "sweep.csv")) as path:
        sweep_frame(manifest).to_csv(path, index=False)
    with replaced(os.path.join(folder, "sweep.h5")) as path:
        index(path, manifest)


def index(path, manifest):
    """/points has a row per point, /summary a copy of all results' summaries, a row per point and label, so that
    nothing is missing where a result is; /results has an external link to each that there is."""
    points = manifest["points"]
    with h5py.File(path, "w") as file:
        file.attrs.update({"sweep": manifest["sweep"], "title": manifest["title"], "date": manifest["date"],
                           "sweep_version": 1, "parameters": json.dumps(manifest["parameters"])})
        scale(file, "point", [entry["name"] for entry in points], "point of the sweep")
        rows = [(number, row) for number, entry in enumerate(points) for row in entry.get("summary", [])]
        scale(file, "row", np.arange(len(rows)), "row of /summary")
        group = file.create_group("points")
        group["point"] = file["point"]  # so that the group can be opened alone
        for name in manifest["parameters"]:
            put(
                group,
                f"parameter_{name}",
                [entry["parameters"][name] for entry in points],
                "point",
                "1",
                f"parameter {name}",
            )
        for name, long_name in POINT.items():
            preset = "" if name in TEXTS else -1 if name == "exit_code" else None
            values = [preset if entry.get(name) is None else entry[name] for entry in points]
            put(group, name, values, "point", UNITS.get(name, "1"), long_name)
        group = file.create_group("summary")
        group["row"] = file["row"]
        put(
            group,
            "point_number",
            np.array([number for number, _ in rows], dtype=np.int64),
            "row",
            "1",
            "row of /points",
        )
        for name in dict.fromkeys(name for _, row in rows for name in row):
            unit = "ns" if name.endswith("_ns") else "B" if name.endswith("_bytes") else "1"
            put(group, name, [row.get(name) for _, row in rows], "row", unit, name.replace("_", " "))
        links = file.create_group("results")
        for entry in points:
            if entry.get("digest"):
                links[entry["name"]] = h5py.ExternalLink(os.path.join("points", entry["name"] + ".h5"), "/")


def scale(file, name, values, long_name):
    put(file, name, values, None, "1", long_name)
    file[name].make_scale(name)


def put(group, name, values, dimension, unit, long_name):
    """A column: numbers as they are, truth values as 0 and 1, NaN for a number that is missing, else text."""
    values = list(values)
    known = [value for value in values if value is not None]
    if all(isinstance(value, (bool, np.bool_)) for value in known) and known:
        values = [255 if value is None else int(value) for value in values]
        data = group.create_dataset(name, data=np.array(values, dtype=np.uint8))
    elif all(isinstance(value, (int, float, np.integer)) and not isinstance(value, bool) for value in known):
        whole = len(known) == len(values) and all(isinstance(value, (int, np.integer)) for value in values)
        data = group.create_dataset(
            name, data=np.array([np.nan if v is None else v for v in values], dtype=np.int64 if whole else float)
        )
    else:
        texts = ["" if value is None else value if isinstance(value, str) else json.dumps(value) for value in values]
        data = group.create_dataset(name, data=np.array(texts, dtype=object), dtype=h5py.string_dtype())
    data.attrs["units"], data.attrs["long_name"] = unit, long_name
    if dimension:
        data.dims[0].attach_scale(group.file[dimension])
