"""What is kept of a point, and whether it still holds: state(folder, name), why_again(...)."""

import hashlib
import json
import os

from ..files import replaced


def write_json(path, value):
    """Whole or not at all. Raises OSError, in a line that starts with the path."""
    with replaced(path) as part:
        with open(part, "x", encoding="utf-8") as file:
            json.dump(value, file, indent=1, ensure_ascii=False, allow_nan=False)


def read_json(path):
    """The dict in a file, or None when there is none that can be read."""
    try:
        with open(path, encoding="utf-8") as file:
            value = json.load(file)
    except (OSError, ValueError, RecursionError):
        return None
    return value if isinstance(value, dict) else None


def file_sha256(path):
    """Hex; "" when the file cannot be read."""
    try:
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def identity(program, config, sets, options):
    """What a point's result depends on, besides the files that its configuration names."""
    said = json.dumps([sets, options])
    return {
        "configuration": file_sha256(config),
        "settings": hashlib.sha256(said.encode()).hexdigest(),
        "program": file_sha256(program),
    }


def inputs_sha256(text):
    """The inputs of a result, file -> SHA-256, from its attribute."""
    try:
        found = json.loads(text)
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def state(folder, name):
    """What is kept of a point, or None."""
    found = read_json(os.path.join(folder, "points", name + ".json"))
    return found if found and isinstance(found.get("status"), str) else None


def why_again(folder, point, now, places, digests):
    """Why a point must be run, "" when its result holds. now: its identity(); places: folders in which inputs are
    looked for besides the configuration's; digests: file -> SHA-256, filled here, for one input may be that of many.
    """
    kept = state(folder, point.name)
    if kept is None:
        return "missing"
    if kept["status"] != "done":
        return {"failed": "failed", "stopped": "stopped"}.get(kept["status"], "died")
    for what, value in now.items():
        if kept.get("identity", {}).get(what) != value:
            return f"{what} changed"
    for name, value in kept.get("inputs", {}).items():
        paths = [os.path.join(place, name) for place in (os.path.dirname(point.config), *places)]
        for path in paths:
            if path not in digests:
                digests[path] = file_sha256(path)
        if value not in [digests[path] for path in paths]:
            return f"input {name} changed"
    result = os.path.join(folder, "points", point.name + ".h5")
    if not os.path.exists(result) or os.path.getsize(result) != kept.get("file_bytes"):
        return "its result is missing or another"
    return ""
