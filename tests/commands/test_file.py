"""The file is the interface: what h5py, xarray and analysis/load.py find in a result."""

import json
import re
import shutil
import warnings

import h5py
import numpy as np
import pytest
import xarray
from conftest import SCENES
from editing import datasets, digests_of, edited, is_scale, objects, sealed

from program import pipeline

from analysis.load import load

# The dimensions of every dataset, by its path; a name in <> stands for one part of a path.
DIMENSIONS = {
    "/time": ["step"],
    "/config": [],
    "/bodies/mesh": ["body"],
    "/bodies/fixed": ["body"],
    "/bodies/first_step": ["body"],
    "/bodies/born": ["step"],
    "/bodies/chosen": ["body"],
    "/meshes/<>/vertices": ["vertex", "axis"],
    "/meshes/<>/triangles": ["triangle", "corner"],
    "/motion/position": ["step", "body", "axis"],
    "/motion/orientation": ["step", "body", "component"],
    "/physics/<>": ["step"],
    "/truth/hits": ["step"],
    "/truth/time_ns": ["step"],
    "/truth/pair_offset": ["boundary"],
    "/truth/pair": ["entry", "side"],
    "/truth/contained_offset": ["boundary"],
    "/truth/contained_pair": ["contained_entry", "side"],
    "/truth/contained_inside": ["contained_entry"],
    "/truth/gap_offset": ["boundary"],
    "/truth/gap_pair": ["gap_entry", "side"],
    "/truth/gap_lower": ["gap_entry"],
    "/truth/gap_upper": ["gap_entry"],
    "/results/<>": ["step", "algorithm"],
    "/answers/<>/pair_offset": ["boundary"],
    "/answers/<>/pair": ["entry", "side"],
    "/summary/<>": ["algorithm"],
    "/noise/time_ns": ["step"],
}
RESULT_COLUMNS = {
    "time_ns", "time_median_ns", "prepare_ns", "processor_ns", "hits", "true_positive", "false_positive",
    "false_negative", "rounding_miss", "operations",
}  # fmt: skip
SUMMARY_COLUMNS = {
    "hits", "true_positive", "false_positive", "false_negative", "error", "precision", "recall", "matthews",
    "operations", "time_mean_ns", "time_median_ns", "time_p95_ns", "promise_kept", "time_mean_low_ns",
    "time_mean_high_ns", "processor_mean_ns", "setup_ns", "memory_bytes", "memory_greatest_bytes",
}  # fmt: skip
PHYSICS_COLUMNS = {
    "energy", "kinetic_energy", "contacts", "greatest_penetration", "integrator_steps", "rejected_steps",
    "force_evaluations", "time_ns", "contact_time_ns",
}  # fmt: skip


@pytest.fixture
def file(result_file):
    with h5py.File(result_file) as opened:
        yield opened


@pytest.fixture
def copy(result_file, tmp_path):
    return shutil.copy(result_file, tmp_path / "copy.h5")


def columns(file):
    """Datasets that are no scales."""
    return {path: found for path, found in datasets(file).items() if not is_scale(found)}


def counted_apart(file):
    """The column that only files with recorded containment have."""
    return {"contained_hit"} if file["truth"].attrs.get("containment") == "record" else set()


def groups(file):
    return ["/"] + [path for path, found in objects(file) if isinstance(found, h5py.Group)]


def documented(path):
    """The dimensions that are documented for a path; None when it is not documented."""
    if path in DIMENSIONS:
        return DIMENSIONS[path]
    parts = path.split("/")
    for at in (2, len(parts) - 1):
        if "/".join(parts[:at] + ["<>"] + parts[at + 1 :]) in DIMENSIONS:
            return DIMENSIONS["/".join(parts[:at] + ["<>"] + parts[at + 1 :])]
    return None


def test_holds_the_documented_datasets_and_no_other(file):
    found = columns(file)
    for path, dataset in found.items():
        names = documented(path)
        assert names is not None, f"{path} is not documented"
        assert dataset.ndim == len(names), path
    for path in DIMENSIONS:
        apart = ("<>", "/bodies/chosen", "contained", "gap", "noise")
        if not any(word in path for word in apart):
            assert path in found, path
    assert set(file["results"]) == RESULT_COLUMNS | counted_apart(file) | {"step", "algorithm"}
    assert set(file["summary"]) == SUMMARY_COLUMNS | counted_apart(file) | {"algorithm"}
    if "physics" in file:
        assert set(file["physics"]) == PHYSICS_COLUMNS | {"step"}
    for label in file["algorithm"].asstr():
        assert set(file["answers"][label]) == {"pair_offset", "pair", "boundary", "entry", "side"}


def test_every_dimension_has_one_scale_of_its_size_in_the_same_group(file):
    for path, dataset in columns(file).items():
        for dim, name, size in zip(dataset.dims, documented(path), dataset.shape):
            assert len(dim) == 1, f"{path}: {len(dim)} scales"
            scale = dim[0]
            assert scale.name.split("/")[-1] == name, path
            assert scale.shape == (size,), path
            assert dataset.parent[name] == scale, f"{path}: its scale {name} is not linked beside it"


def test_time_is_no_scale_but_step_is(file):
    assert is_scale(file["step"]) and not is_scale(file["time"])
    np.testing.assert_array_equal(file["step"], np.arange(len(file["step"])))
    np.testing.assert_array_equal(file["time"], np.arange(len(file["step"])) / file["time"].attrs["rate"])


def test_xarray_opens_every_group_alone(result_file, file):
    seen = 0
    for group in groups(file):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with xarray.open_dataset(result_file, group=group, engine="h5netcdf") as opened:
                opened.load()
        prefix = "" if group == "/" else group
        for name, variable in opened.data_vars.items():
            assert list(variable.dims) == documented(f"{prefix}/{name}"), f"{group}/{name}"
            np.testing.assert_array_equal(variable.shape, file[f"{prefix}/{name}"].shape)
            seen += 1
        if group == "/motion":
            assert list(opened.body.values) == list(file["body"].asstr())
            assert list(opened.component.values) == ["w", "x", "y", "z"]
    assert seen == len(columns(file))


def test_xarray_selects_by_label(result_file, file):
    label = file["algorithm"].asstr()[-1]
    with xarray.open_dataset(result_file, group="results", engine="h5netcdf") as results:
        hits = results.hits.sel(algorithm=label).values
    np.testing.assert_array_equal(hits, np.diff(file["answers"][label]["pair_offset"].astype(np.int64)))


@pytest.mark.parametrize("config", SCENES, ids=lambda path: path.stem)
def test_every_dataset_is_among_those_that_the_program_lists(small_file, config):
    listed = {row["name"]: row for row in json.loads(pipeline("list", "datasets", "--json").stdout)}
    with h5py.File(small_file(config)) as opened:
        own = {path: found for path, found in datasets(opened).items() if path.count("/") == 1 or not is_scale(found)}
        assert len(own) > 20
        for path, dataset in own.items():
            general = re.sub("^/answers/[^/]+", "/answers/<label>", re.sub("^/meshes/[^/]+", "/meshes/<mesh>", path))
            general = re.sub("^(/meshes/<mesh>/proxies)/[^/]+", r"\1/<label>", general)
            assert listed[general]["unit"] == dataset.attrs["units"], path
            assert listed[general]["what"] == dataset.attrs["long_name"], path


def test_every_dataset_says_its_unit_and_meaning(file):
    for path, dataset in datasets(file).items():
        assert isinstance(dataset.attrs["units"], str) and dataset.attrs["units"], path
        assert isinstance(dataset.attrs["long_name"], str) and dataset.attrs["long_name"], path
        if path.endswith("_ns"):
            assert dataset.attrs["units"] == "ns", path


def test_types_are_as_documented(file):
    for path, dataset in datasets(file).items():
        name = path.split("/")[-1]
        if dataset.dtype == object:
            assert h5py.check_string_dtype(dataset.dtype) == ("utf-8", None), path
        elif name in ("fixed", "chosen", "promise_kept"):
            assert dataset.dtype == np.uint8, path
        elif name in ("pair", "triangles"):
            assert dataset.dtype == np.dtype("<u4"), path
        elif name.endswith("_ns"):
            assert dataset.dtype == np.dtype("<f8" if path.startswith("/summary") else "<i8"), path
        elif name in ("first_step", "pair_offset") or is_scale(dataset):
            assert dataset.dtype == np.dtype("<i8"), path
        elif path.startswith("/results/") or name in ("hits", "operations", "contacts"):
            assert dataset.dtype == np.dtype("<u8"), path


def test_chunks_are_whole_and_within_fixed_dimensions(file):
    for path, dataset in datasets(file).items():
        for chunk, size, most in zip(dataset.chunks or (), dataset.shape, dataset.maxshape):
            assert chunk <= max(size, 1) and (most is None or chunk <= most), path
        names = [path.split("/")[-1]] if is_scale(dataset) else documented(path)
        for name, most in zip(names, dataset.maxshape):
            assert (most is None) == (name in ("step", "boundary", "entry", "contained_entry",
                                               "gap_entry")), f"{path}: {name}"
        if dataset.chunks and not is_scale(dataset):
            assert dataset.shuffle and dataset.compression == "gzip", path


def test_no_group_is_empty(file):
    for path in groups(file):
        assert len(file[path]) or len(file[path].attrs), path


def test_pairs_are_sorted_unique_and_a_below_b(file):
    bodies = len(file["body"])
    for group in ["truth"] + [f"answers/{label}" for label in file["algorithm"].asstr()]:
        offset, pair = file[group]["pair_offset"][()].astype(np.int64), file[group]["pair"][()].astype(np.int64)
        assert offset[0] == 0 and offset[-1] == len(pair) and (np.diff(offset) >= 0).all(), group
        assert (pair[:, 0] < pair[:, 1]).all() and (pair < bodies).all(), group
        step = np.repeat(np.arange(len(offset) - 1), np.diff(offset))
        key = (step * bodies + pair[:, 0]) * bodies + pair[:, 1]
        assert (np.diff(key) > 0).all(), group


def test_hits_count_the_pairs(file):
    np.testing.assert_array_equal(file["truth/hits"], np.diff(file["truth/pair_offset"].astype(np.int64)))
    for column, label in enumerate(file["algorithm"].asstr()):
        counted = np.diff(file["answers"][label]["pair_offset"].astype(np.int64))
        np.testing.assert_array_equal(file["results/hits"][:, column], counted)


def test_poses_are_missing_before_the_first_step(file):
    first = file["bodies/first_step"][()]
    born = np.isfinite(file["motion/position"]).all(axis=2) & np.isfinite(file["motion/orientation"]).all(axis=2)
    for body, step in enumerate(first):
        assert not born[: step if step >= 0 else None, body].any()
        assert step < 0 or born[step, body]


def test_bodies_name_their_meshes(file):
    assert set(file["bodies/mesh"].asstr()) <= set(file["meshes"])
    for mesh in file["meshes"].values():
        assert mesh["triangles"][()].max() < len(mesh["vertices"])


def test_digests_are_recomputed_from_the_file(file):
    assert file.attrs["digest_algorithm"] == "XXH3-128"
    found = digests_of(file)
    assert found == {path: file[path].attrs["digest"] for path in found}
    carriers = [path for path in groups(file) if "digest" in file[path].attrs]
    assert sorted(carriers) == sorted(found)


# analysis/load.py


def test_per_step_is_tidy(result_file, file):
    run = load(result_file)
    table = run.per_step
    steps, labels = len(file["step"]), list(file["algorithm"].asstr())
    assert len(table) == steps * len(labels)
    assert set(table.columns) == RESULT_COLUMNS | counted_apart(file) | {"step", "time", "algorithm"}
    for column, label in enumerate(labels):
        mine = table[table.algorithm == label]
        np.testing.assert_array_equal(mine.step, np.arange(steps))
        np.testing.assert_array_equal(mine.time, file["time"])
        for name in RESULT_COLUMNS:
            np.testing.assert_array_equal(mine[name], file["results"][name][:, column], err_msg=f"{label} {name}")


def test_summary_is_indexed_by_algorithm(result_file, file):
    summary = load(result_file).summary
    assert list(summary.index) == list(file["algorithm"].asstr())
    assert set(summary.columns) == SUMMARY_COLUMNS | counted_apart(file)
    assert summary.promise_kept.dtype == bool
    for name in SUMMARY_COLUMNS:
        np.testing.assert_array_equal(summary[name], file["summary"][name], err_msg=name)


def test_physics_is_there_only_when_integrated(result_file, file, copy):
    with edited(copy) as changed:
        if "physics" in changed:
            del changed["physics"]
    assert load(copy).physics is None
    if "physics" in file:
        physics = load(result_file).physics
        assert set(physics.columns) == PHYSICS_COLUMNS
        assert physics.attrs["status"] == file["physics"].attrs["status"]
        np.testing.assert_array_equal(physics.energy, file["physics/energy"])


def test_pairs_are_rows_with_their_step(result_file, file):
    run = load(result_file)
    for table, group in [(run.truth_pairs, "truth")] + [
        (run.pairs(label), f"answers/{label}") for label in file["algorithm"].asstr()
    ]:
        assert list(table.columns) == ["step", "a", "b"]
        offset, pair = file[group]["pair_offset"][()], file[group]["pair"][()]
        assert len(table) == len(pair)
        for step in {0, len(offset) // 2, len(offset) - 2}:
            rows = table[table.step == step][["a", "b"]].to_numpy()
            np.testing.assert_array_equal(rows, pair[offset[step] : offset[step + 1]], err_msg=f"{group} {step}")


def test_an_unknown_label_is_named_with_those_there_are(result_file, file):
    with pytest.raises(KeyError, match=file["algorithm"].asstr()[0]):
        load(result_file).pairs("no_such_label")


def test_meta_says_where_the_result_comes_from(result_file, file):
    meta = load(result_file).meta
    assert meta["digest"] == file.attrs["digest"] and meta["schema_version"] == 2
    assert meta["config"] == file["config"].asstr()[()]
    assert meta["steps"] == len(file["step"]) and meta["bodies"] == list(file["body"].asstr())
    assert {"date", "host", "processor", "wall_time_s"} == set(meta["run"])
    for label in meta["algorithms"]:
        assert {
            "name", "knobs", "promise", "thesis_key", "operations_unit", "scope", "host", "processor",
            "build", "date", "digest", "setup_ns", "memory_bytes", "memory_greatest_bytes",
        } == set(meta["answers"][label])  # fmt: skip


# The first that everybody writes: which step each pair is of. Unsigned offsets made it a TypeError.
def test_offsets_are_signed_and_calculate(file, result_file):
    offset, pair = file["truth/pair_offset"][()], file["truth/pair"]
    assert offset.dtype == np.int64
    step = np.repeat(np.arange(len(file["step"])), np.diff(offset))
    assert len(step) == len(pair) and list(step) == list(load(result_file).truth_pairs.step)


# A file of schema version 1 differs from one of version 2 in the sign of its offsets alone; its digests are the same.
def test_an_older_file_with_unsigned_offsets_is_read(copy):
    digest = load(copy).meta["digest"]
    with h5py.File(copy, "a") as changed:
        changed.attrs["schema_version"] = 1
        for group in [changed["truth"], *changed["answers"].values()]:
            values, told = group["pair_offset"][()].astype(np.uint64), dict(group["pair_offset"].attrs)
            scale = group["pair_offset"].dims[0][0]
            del group["pair_offset"]
            made = group.create_dataset("pair_offset", data=values)
            made.dims[0].attach_scale(scale)
            for name in ("units", "long_name"):
                made.attrs[name] = told[name]
    older = load(copy, unsealed=True)
    assert older.meta["schema_version"] == 1 and len(older.truth_pairs) == older.truth_hits.sum()
    done = pipeline("show", copy, "--unsealed")
    assert done.returncode == 0 and digest in done.stdout, done.stderr


@pytest.mark.parametrize("version", [0, 3, 1000])
def test_load_refuses_a_schema_that_it_does_not_know(copy, version):
    with edited(copy) as changed:
        changed.attrs["schema_version"] = version
    with pytest.raises(ValueError, match=f"schema version {version}, this module reads 1 to 2"):
        load(copy)


def test_load_refuses_the_files_of_others(tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["data"] = [1, 2, 3]
    with pytest.raises(ValueError, match="not a result"):
        load(tmp_path / "other.h5")


# The seal, which other readers do not see (pipeline/result/seal.hpp).


def test_the_last_line_is_the_checksum_of_all_before_it(result_file):
    content = result_file.read_bytes()
    assert sealed(content) == content
    assert content.splitlines()[-1].startswith(b"collision benchmark result, seal 1: XXH3-128 ")


def test_xarray_finds_its_engine_in_a_sealed_file(result_file):
    with xarray.open_dataset(result_file, group="summary") as opened:
        assert "error" in opened
