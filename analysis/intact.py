"""Whether a result is as it was written: asked before anything of it is used.

A result may be anybody's and anything may have happened to it. In this order:

    it is a regular file, opened without waiting
    its seal holds: the checksum in its last line, over every byte before it (pipeline/result/seal.hpp)
    a child process reads all of it first: HDF5 1.10.8 crashes, loops or asks for all memory on some damaged files
    its links stay within it, its datasets are stored in it and no larger than what is stored can give
    its digests hold, of every group and of the whole (pipeline/result/digest.hpp), and its attributes are of their
    kinds

The seal is no signature: whoever changes a file on purpose can make another.
"""

import contextlib
import faulthandler
import json
import os
import re
import resource
import select
import signal
import stat
import struct
import time
import warnings

import h5py
import numpy as np
import xxhash

MAGIC = b"\ncollision benchmark result, seal "
SEAL = MAGIC + b"1: XXH3-128 %s of %020d bytes\n"
SEAL_BYTES = len(SEAL % (b"0" * 32, 0))

# What counts for digests: what the program writes. Own datasets belong at other places, and do not count.
ROOT = ("step", "time", "body", "algorithm")
GROUPS = ("bodies", "meshes", "motion", "physics", "truth", "results", "answers", "summary", "noise", "passes",
          "extremes", "study", "proxies")
DIGESTED = ("motion", "truth", "answers")  # carry digests of their own
TEXTS = {"title", "creator", "git_commit", "build_type", "compiler", "flags", "library_versions", "config_sha256",
         "inputs_sha256", "digest", "digest_algorithm", "effective", "shape", "name", "knobs", "promise", "thesis_key",
         "operations_unit", "scope", "library", "host", "processor", "build", "date", "containment", "status", "kind",
         "label", "transport", "command", "files_sha256", "version", "language", "precision", "tests", "licence",
         "reason"}
NUMBERS = {"schema_version", "rate", "wall_time_s", "gap_margin", "quaternion_drift", "surface_deviation",
           "contact_deviation", "closed", "ratio", "ratio_low", "ratio_high", "pinned", "setup_ns", "memory_bytes",
           "memory_greatest_bytes", "outside_share", "outside_greatest", "threads", "steps_done"}
OBJECTS = {"library_versions", "inputs_sha256", "files_sha256", "knobs", "shape"}  # JSON
MEASURED = ("_ns", "_bytes")  # ends of names that no digest counts: clocks and heap
MOST_NESTED = 32  # levels of it; ours have at most 3

MOST_INFLATION = 1032  # bytes that deflate makes of one
MOST_STEPS = 10_000_000  # no configuration can ask for more
MOST_DEPTH = 30  # of groups; ours: /meshes/<name>/proxies/<label>/vertices
# What reading an honest file may take, with a processor ten times slower than today's.
FREE_MEMORY, MEMORY_PER_BYTE, MEMORY_PER_VALUE_BYTE = 256 << 20, 16, 6
FREE_SECONDS, SLOW_BYTES, SLOW_VALUE_BYTES = 2, 1 << 20, 20 << 20
SLOW_DISK = 10  # times as long by the wall, and a minute


class Unvouched(UserWarning):
    """A result was read of which not everything is vouched for."""


def opened(path, mark):
    """The checked file, open for reading. Raises OSError when another stands there by now."""
    with _regular(path) as descriptor:
        if _mark(descriptor) != mark:
            raise OSError(f"{path}: was changed or replaced since it was loaded; load it again")
        try:
            return h5py.File(_opened_path(descriptor, path), "r")
        except OSError as error:
            raise OSError(f"{path}: {_reason(error)}") from error


def checked(path, look, unsealed=False):
    """What `look(file)` gives of the result at `path` once all of it was checked, and its mark for opened().

    look: gets an open h5py.File; it is called in the child process first, and refuses what is no result. Raises OSError
    or ValueError, one line that starts with the path. A seal that is missing or does not hold is refused; with
    `unsealed` the file is read all the same and Unvouched is warned, as of results from before there were seals.
    """
    with _regular(path) as descriptor:
        mark = _mark(descriptor)
        seal = _seal(descriptor)
    remedy = "copy it again, run again, or read it by --unsealed or load(path, unsealed=True), its times unvouched for"
    if seal == "unknown" and not unsealed:
        raise OSError(f"{path}: has a seal of a form that this module does not know; use a newer one or {remedy}")
    if seal == "differs" and not unsealed:
        raise OSError(f"{path}: was changed or damaged since it was written (its seal does not hold); {remedy}")

    def whole(file, allow):
        if "schema_version" in file.attrs:
            check_links(file)
        look(file)
        lost = seal == "none" and "sealed" in file.attrs
        if lost and not unsealed:
            raise OSError(f"{path}: was changed or damaged since it was written (its seal is missing); {remedy}")
        check_content(file, allow)

    _tried(path, mark, whole)
    with opened(path, mark) as file:
        found, older = look(file), "sealed" not in file.attrs
    if seal != "holds":
        why = "is not sealed, as results of older programs" if older else "is read although its seal does not hold"
        warnings.warn(f"{path}: {why}; its digests hold, its times and attributes are vouched for by nobody", Unvouched,
                      stacklevel=3)
    return found, mark


@contextlib.contextmanager
def _regular(path):
    """A descriptor of the regular file at `path`."""
    try:
        regular = stat.S_ISREG(os.stat(path).st_mode)  # opening a device may do something
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOCTTY) if regular else -1
    except OSError as error:
        raise OSError(f"{path}: cannot be read ({error.strerror})") from error
    if not regular:
        raise OSError(f"{path}: is not a regular file")
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise OSError(f"{path}: is not a regular file")
        yield descriptor
    finally:
        os.close(descriptor)


def _mark(descriptor):
    status = os.fstat(descriptor)
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


def _opened_path(descriptor, path):
    link = f"/proc/self/fd/{descriptor}"
    return link if os.path.exists(link) else path


def _seal(descriptor):
    """holds, differs, none or unknown (of a later form)."""
    size = os.fstat(descriptor).st_size - SEAL_BYTES
    found = os.pread(descriptor, SEAL_BYTES, size) if size >= 0 else b""
    if not found.startswith(MAGIC):
        return "none"
    if not found.startswith(MAGIC + b"1: "):
        return "unknown"
    hashed, at = xxhash.xxh3_128(), 0
    while at < size:
        block = os.pread(descriptor, min(1 << 20, size - at), at)
        if not block:
            return "differs"  # cut off meanwhile
        hashed.update(block)
        at += len(block)
    return "holds" if found == SEAL % (hashed.hexdigest().encode(), size) else "differs"


def check_links(file):
    """Raises ValueError unless every link is a hard one and nothing lies too deep. No link is followed elsewhere."""

    def look(name, info):
        if name.count(b"/") >= MOST_DEPTH:
            return f"/{name[:200].decode(errors='replace')}: is nested too deep"
        if info.type != h5py.h5l.TYPE_HARD:
            kind = "soft link" if info.type == h5py.h5l.TYPE_SOFT else "link to another file"
            return f"/{name[:200].decode(errors='replace')}: is a {kind}; a result has none"
        return None

    if flaw := file.id.links.visit(look, info=True):
        raise ValueError(flaw)


def check_content(file, allow=lambda size: None):
    """Reads all that the program writes. Raises ValueError when something is not as it must be.

    allow: hears of the bytes of a dataset before they are read.
    """
    if "step" in file and file["step"].size > MOST_STEPS:
        raise ValueError(f"/step: has {file['step'].size} entries, at most {MOST_STEPS} make sense")
    if "meshes" in file and len(file["meshes"]) > len(file["body"]):
        raise ValueError(f"/meshes: has {len(file['meshes'])} entries, at most {len(file['body'])} make sense")
    for path in ("/config", "/time", "/run"):
        if path in file:
            check_attributes(path, file[path].attrs)
    steps, labels = (file[name].shape[0] if name in file else 0 for name in ("step", "algorithm"))
    shapes = {"results": (steps, labels), "summary": (labels,), "physics": (steps,)}
    digests, others, stored = {}, [], 0
    for path, group in _groups(file):
        check_attributes(path, group.attrs)
        mine = []
        for name, dataset in group.items():
            if not isinstance(dataset, h5py.Dataset) or path == "/" and name not in ROOT:
                continue
            full = path.rstrip("/") + "/" + name
            if name.endswith(MEASURED) and dataset.dtype.kind not in "iuf":
                raise ValueError(f"{full}: holds no numbers")
            scale = h5py.h5ds.is_scale(dataset.id)
            wanted = shapes.get(path[1:])
            if wanted and not scale and dataset.shape != wanted:
                raise ValueError(f"{full}: has the shape {dataset.shape}, not {wanted}")
            if scale and path != "/":
                continue
            stored += check_storage(full, dataset)
            if stored > file.id.get_filesize():
                raise ValueError(f"{full}: datasets overlap")
            allow(dataset.size * dataset.dtype.itemsize)
            values = dataset[()]
            if not name.endswith(MEASURED):
                mine.append((full.encode(), record(full, values)))
        if path.split("/")[1] in DIGESTED and path != "/answers":
            digests[path] = xxhash.xxh3_128(b"".join(data for _, data in sorted(mine))).hexdigest()
        else:
            others += mine
    if "config" in file:
        check_storage("/config", file["config"])
    head = b"".join(_text(path.encode()) + _text(digests[path].encode()) for path in sorted(digests, key=str.encode))
    digests["/"] = xxhash.xxh3_128(head + b"".join(data for _, data in sorted(others))).hexdigest()
    for path, digest in digests.items():
        if file[path].attrs.get("digest") != digest:
            raise ValueError(f"{'its content' if path == '/' else path} does not have its digest")
    return digests


def _groups(file):
    """(path, group) of every group that the program writes."""
    yield "/", file
    for name in GROUPS:
        if name in file:
            group = file[name]
            if not isinstance(group, h5py.Group):
                raise ValueError(f"/{name}: is no group")
            yield f"/{name}", group
            if name in ("meshes", "answers"):
                for part, inner in group.items():
                    if isinstance(inner, h5py.Group):
                        yield f"/{name}/{part}", inner
                    proxies = inner.get("proxies") if name == "meshes" and isinstance(inner, h5py.Group) else None
                    for label, proxy in (proxies or {}).items():
                        if isinstance(proxy, h5py.Group):
                            yield f"/{name}/{part}/proxies/{label}", proxy


def check_attributes(path, attributes):
    for name in attributes:
        if name not in TEXTS | NUMBERS:
            continue
        value = attributes[name]
        if not isinstance(value, str if name in TEXTS else (int, float, np.integer, np.floating)):
            raise ValueError(f"attribute {name} of {path}: has another type")
        if name in OBJECTS:
            if not _is_object(value):
                raise ValueError(f"attribute {name} of {path}: is no JSON object")
    if path.startswith("/meshes/") and "/proxies/" not in path and "shape" not in attributes:
        raise ValueError(f"attribute shape of {path}: is missing")


def _is_object(text):
    """Whether it is a JSON object as the pipeline takes it: not nested too deep, without NaN."""
    depth = 0
    for bracket in re.sub(r'"(?:[^"\\]|\\.)*"|[^][{}"]', "", text):
        depth += 1 if bracket in "[{" else -1 if bracket in "]}" else 0
        if depth > MOST_NESTED:
            return False

    def refuse(word):
        raise ValueError(word)

    try:
        return isinstance(json.loads(text, parse_constant=refuse), dict)
    except ValueError:
        return False


def check_storage(path, dataset):
    """The bytes that are stored of a dataset. Raises ValueError when they are elsewhere or cannot give its size."""
    made = dataset.id.get_create_plist()
    if made.get_layout() == h5py.h5d.VIRTUAL or made.get_external_count():
        raise ValueError(f"{path}: its values are in another file; a result has none such")
    filters = [made.get_filter(i)[0] for i in range(made.get_nfilters())]
    allowed = (h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32)
    if any(one not in allowed for one in filters) or filters.count(h5py.h5z.FILTER_DEFLATE) > 1:
        raise ValueError(f"{path}: is packed by other filters than a result's")
    stored = dataset.id.get_storage_size() if dataset.size else 0
    # Whole multiples, as a dataset of few values may have no storage but its fill value.
    if dataset.size // MOST_INFLATION > stored // max(dataset.dtype.itemsize, 1):
        raise ValueError(f"{path}: of {dataset.size} values only {stored} bytes are stored")
    return stored


def _integer(value):
    return struct.pack("<Q", value)


def _text(value):
    return _integer(len(value)) + value


def record(path, values):
    """What a dataset of these values is to a digest, as bytes (pipeline/result/digest.hpp)."""
    values = np.asarray(values)
    is_text = values.dtype == object
    kind = "text" if is_text else values.dtype.str.lstrip("<|")
    if path.endswith("offset") and kind == "i8":  # as files of schema version 1 store them
        kind = "u8"
    head = _text(path.encode()) + _text(kind.encode()) + _integer(values.ndim)
    head += b"".join(_integer(size) for size in values.shape)
    if is_text:
        return head + b"".join(_text(bytes(value)) for value in values.ravel())
    if values.dtype.kind == "f":
        values = np.where(np.isnan(values), np.array(0x7FF8000000000000, "<u8").view("<f8"), values)
    return head + values.tobytes()


def _reason(error):
    reason = " ".join(str(error).split())
    if "signature not found" in reason:
        return "is not an HDF5 file"
    if "truncated" in reason:
        return "is truncated: its end is missing; copy it again"
    return f"cannot be read ({reason})"


def _tried(path, mark, whole):
    """Runs whole(file, allow) in a child process. Raises what it raised, or OSError when the child did not end well."""
    ours, theirs = os.pipe()
    parent = os.getpid()
    try:
        child = os.fork()
    except OSError as error:
        os.close(ours)
        os.close(theirs)
        raise OSError(f"{path}: cannot be tried in a child process ({error.strerror})") from error
    if child == 0:
        _be_child(path, mark, whole, theirs, parent)
    os.close(theirs)
    status, said, late = 0, b"", True  # late: also when this is interrupted
    try:
        end = time.monotonic() + 60 + SLOW_DISK * _seconds(mark[2], 0)
        while (left := end - time.monotonic()) > 0:
            if select.select([ours], [], [], left)[0]:
                if not (block := os.read(ours, 1 << 16)):
                    late = False
                    break
                said += block
    finally:
        os.close(ours)
        if late:
            os.kill(child, signal.SIGKILL)
        with contextlib.suppress(ChildProcessError):  # a program that ignores SIGCHLD
            status = os.waitpid(child, 0)[1]
    if said.startswith(b"good"):
        return
    if said.startswith((b"OSError ", b"ValueError ")):
        kind, _, text = said.decode(errors="replace").partition(" ")
        raise (OSError if kind == "OSError" else ValueError)(text)
    crashed = os.WIFSIGNALED(status)
    number = os.WTERMSIG(status) if crashed else 0
    ending = f"crashed by signal {number}" if crashed else "failed"
    why = "took too long" if late or number == signal.SIGXCPU else ending
    raise OSError(f"{path}: is damaged (a trial of reading it {why}); copy it again")


def _seconds(size, values):
    return FREE_SECONDS + size // SLOW_BYTES + values // SLOW_VALUE_BYTES


def _be_child(path, mark, whole, answer, parent):
    """The child of _tried; never returns."""
    said = b"failed"
    try:
        faulthandler.disable()  # what crashes here is no failure of this program
        null = os.open(os.devnull, os.O_RDWR)
        os.dup2(null, 1)
        os.dup2(null, 2)
        values = 0
        with open("/proc/self/statm", encoding="ascii") as statm:
            held = int(statm.read().split()[0]) * resource.getpagesize()

        def allow(size):
            nonlocal values
            values += size
            memory = held + FREE_MEMORY + MEMORY_PER_BYTE * mark[2] + MEMORY_PER_VALUE_BYTE * values
            for kind, most in ((resource.RLIMIT_AS, memory), (resource.RLIMIT_CPU, _seconds(mark[2], values))):
                hard = resource.getrlimit(kind)[1]
                resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        allow(0)
        with opened(path, mark) as file:
            whole(file, allow)
        said = b"good"
    except MemoryError:
        said = f"OSError {path}: needs more memory than its size explains or than there is; copy it again".encode()
    except Exception as error:  # noqa: BLE001 whatever h5py raises on damage
        text = str(error.args[0] if error.args else error)
        if not text.startswith(str(path)):
            text = f"{path}: is damaged ({' '.join(text.split())})"
        kind = "ValueError" if type(error) is ValueError and " is damaged " not in text else "OSError"
        said = f"{kind} {text}".encode(errors="replace")
    finally:
        with contextlib.suppress(BaseException):
            if os.getppid() == parent:
                os.write(answer, said[:60000])
        os._exit(0)
