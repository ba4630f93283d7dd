"""Changes a result as somebody with h5py would, and makes of it one that its readers take: digests and seal renewed.

Digests and seal are made from their definitions alone (pipeline/result/digest.hpp, pipeline/result/seal.hpp).
"""
import contextlib
import struct

import h5py
import numpy as np
import xxhash

MAGIC = b"\ncollision benchmark result, seal 1: XXH3-128 "


def is_scale(dataset):
    return h5py.h5ds.is_scale(dataset.id)


def objects(group, path=""):
    """(path, object) of every link below a group, hard links to the same object each by its own path."""
    for name in group:
        yield f"{path}/{name}", group[name]
        if isinstance(group[name], h5py.Group):
            yield from objects(group[name], f"{path}/{name}")


def datasets(file):
    return {path: found for path, found in objects(file) if isinstance(found, h5py.Dataset)}


def integer(value):
    return struct.pack("<Q", value)


def text(value):
    return integer(len(value.encode())) + value.encode()


def record(path, dataset):
    is_text = dataset.dtype == object
    kind = "text" if is_text else dataset.dtype.str.lstrip("<|")
    if path.endswith("offset") and kind == "i8":
        kind = "u8"
    head = text(path) + text(kind) + integer(dataset.ndim) + b"".join(integer(size) for size in dataset.shape)
    if is_text:
        return head + b"".join(text(value) for value in dataset.asstr()[()].ravel())
    values = dataset[()]
    if kind == "f8":
        values = np.where(np.isnan(values), np.frombuffer(integer(0x7FF8000000000000), "<f8")[0], values)
    return head + values.astype(values.dtype.newbyteorder("<")).tobytes()


def xxh3(data):
    return xxhash.xxh3_128(data).hexdigest()


def digests_of(file):
    """path -> digest of the three kinds of group and of the root."""
    chosen = {
        path: dataset
        for path, dataset in datasets(file).items()
        if path != "/config"
        and not path.endswith(("_ns", "_bytes"))
        and (not is_scale(dataset) or path in ("/step", "/body", "/algorithm"))
    }
    owners = [f"/{name}" for name in ("motion", "truth") if name in file]
    owners += [f"/answers/{label}" for label in file.get("answers", [])]
    found, rest = {}, dict(chosen)
    for owner in owners:
        mine = sorted((path for path in chosen if path.rsplit("/", 1)[0] == owner), key=str.encode)
        found[owner] = xxh3(b"".join(record(path, rest.pop(path)) for path in mine))
    head = b"".join(text(path) + text(found[path]) for path in sorted(found, key=str.encode))
    found["/"] = xxh3(head + b"".join(record(path, rest[path]) for path in sorted(rest, key=str.encode)))
    return found


def sealed(content):
    """The bytes of an HDF5 file with their seal; one that is there already is replaced."""
    content = content[: content.rindex(MAGIC)] if MAGIC in content[-200:] else content
    return content + MAGIC + xxh3(content).encode() + b" of %020d bytes\n" % len(content)


def seal(path):
    with open(path, "rb") as file:
        content = file.read()
    with open(path, "wb") as file:
        file.write(sealed(content))


@contextlib.contextmanager
def edited(path, mode="r+", digests=True):
    """The file open for changes; then its digests, unless they are to be wrong, and its seal are renewed."""
    with h5py.File(path, mode) as file:
        yield file
        for group, digest in digests_of(file).items() if digests else ():
            file[group].attrs["digest"] = digest
        file.attrs["sealed"] = "by the last line"
    seal(path)
