"""A sweep file, read: read(path) gives the Sweep, points(sweep) what runs, each with its name and its --set values."""

import difflib
import hashlib
import itertools
import json
import math
import os
import re
import tomllib
from dataclasses import dataclass

from ..program import Refused

KEYS = ["title", "config", "set", "grid", "axis", "seeds", "options", "threads", "resources"]
RESOURCES = ["memory_mb", "minutes"]
OURS = ["-o", "--output", "--set", "--threads", "--force", "--json", "--quiet"]  # what the sweep itself says to a run
MOST_POINTS = 1000  # more are meant only with --yes
MOST_NAME = 180  # letters of a point's name: file systems take 255 bytes, endings are added
PLAIN = re.compile(r"[A-Za-z0-9_.+-]+")


@dataclass(frozen=True)
class Sweep:
    """axes: parameter -> list of (value, {key: TOML text}), in the file's order, the seeds last; a value is a number or
    a text. sets: {key: TOML text} of every point; grid_keys: those of the axes; memory_mb, minutes: None to ask check.
    """

    path: str
    name: str
    title: str
    configs: list
    axes: dict
    sets: dict
    options: list
    threads: int
    memory_mb: float | None
    minutes: float | None

    @property
    def folder(self):
        return os.path.dirname(os.path.abspath(self.path))

    @property
    def count(self):
        return math.prod(len(values) for values in self.axes.values())


@dataclass(frozen=True)
class Point:
    """One run. parameters: name -> value; sets: {key: TOML text}, those of the sweep included."""

    name: str
    parameters: dict
    config: str
    sets: dict


def read(path):
    """The Sweep of the file at `path`, which may be a configuration alone. Raises Refused."""
    path = os.fspath(path)
    try:
        with open(path, "rb") as file:
            raw = tomllib.load(file)
    except OSError as error:
        raise Refused(f"{path}: cannot be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Refused(f"{path}: is no TOML: {error}") from error
    if "config" not in raw and isinstance(raw.get("scene"), dict):  # a configuration is a sweep of one point
        raw = {"config": os.path.abspath(path), "title": raw.get("title", _stem(path))}
    _known(path, raw, KEYS, "")
    name = os.path.splitext(os.path.basename(path))[0]
    if not PLAIN.fullmatch(name):
        raise Refused(f"{path}: a sweep's file is named of letters, digits and _.+-, its results are named after it")
    title = _typed(path, raw, "title", str, "a text", name)
    configs = _configs(path, raw)
    sets = _sets(path, "set", _typed(path, raw, "set", dict, "a table of --set values", {}))
    axes = _axes(path, raw, configs, sets)
    options = _typed(path, raw, "options", list, "a list of texts", [])
    for option in options:
        if not isinstance(option, str):
            raise Refused(f"{path}: 'options' must be a list of texts, not {option!r}")
        if option.split("=")[0] in OURS:
            raise Refused(f"{path}: 'options': {option.split('=')[0]} is said by the sweep itself; remove it"
                          f"{', or write threads = N' if option.startswith('--threads') else ''}")  # fmt: skip
    threads = _typed(path, raw, "threads", int, "a whole number of at least 1", 1)
    if not 1 <= threads <= 1024:
        raise Refused(f"{path}: 'threads' must be 1 to 1024, not {threads}")
    resources = _typed(path, raw, "resources", dict, "a table with memory_mb and minutes", {})
    _known(path, resources, RESOURCES, "resources.")
    for key, value in resources.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value < math.inf:
            raise Refused(f"{path}: 'resources.{key}' must be a number above 0, not {value!r}")
    return Sweep(path, name, title, configs, axes, sets, options, threads, *map(resources.get, RESOURCES))


def refuse_if_many(sweep, yes):
    """Raises Refused, before anything is made of them, when there are more points than anybody writes by hand."""
    if sweep.count <= MOST_POINTS or yes:
        return
    each = " x ".join(f"{name} {len(values):,}" for name, values in sweep.axes.items())
    raise Refused(
        f"{sweep.path}: would be {sweep.count:,} points ({each}), each a process and a file; more than {MOST_POINTS:,}"
        " are done only with --yes"
    )


def points(sweep):
    """The points in the order of the axes, the last one fastest. Their names are those of always and everywhere: they
    depend on nothing but the names and values of their own parameters."""
    found = []
    for chosen in itertools.product(*sweep.axes.values()):
        parameters = dict(zip(sweep.axes, (value for value, _ in chosen)))
        sets, config = dict(sweep.sets), sweep.configs[0]
        for axis, (_, changed) in zip(sweep.axes, chosen):
            if axis == "config":
                config = changed["config"]
            else:
                sets |= changed
        found.append(Point(point_name(parameters) or _stem(config), parameters, config, sets))
    return found


def point_name(parameters):
    """ "segments=16,seed=3". Different parameters never get one name: what a file's name cannot say is followed by a
    digest of it."""
    name = ",".join(f"{key}={_value_name(value)}" for key, value in parameters.items())
    return name if len(name) <= MOST_NAME else f"{name[: MOST_NAME - 13]}~{_digest(name)}"


def value_text(value):
    """A value as people write it: 1e8 and not 100000000.0, lists as 6x6x6."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        texts = [re.sub(r"e\+?(-?)0*(?=\d)", r"e\1", text) for text in (f"{value:g}", repr(value))]
        return min(texts, key=lambda text: (float(text) != value, len(text)))
    if (
        isinstance(value, list)
        and value
        and all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in value)
    ):
        return "x".join(map(value_text, value))
    return value if isinstance(value, str) else toml(value)


def _value_name(value):
    """A value in a file's name; the values of an axis have different texts, and one that is changed has its digest."""
    text = value_text(value)
    if PLAIN.fullmatch(text) and len(text) <= 60:
        return text
    return f"{re.sub(r'[^A-Za-z0-9_.+-]+', '-', text)[:40].strip('-')}~{_digest(text)}"


def _digest(text):
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def toml(value):
    """A value as TOML on one line."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list):
        return f"[{', '.join(map(toml, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{json.dumps(key)} = {toml(inner)}' for key, inner in value.items())}}}"
    return str(value)


# ---- Parts of the file -----------------------------------------------------------------------------------------------


def _axes(path, raw, configs, sets):
    keys, axes = {}, {}

    def claim(place, key):
        """Two that set one key would overwrite each other without a word."""
        for other, where in [*keys.items(), *((key_, "set") for key_ in sets)]:
            if (key == other or key.startswith(other + ".") or other.startswith(key + ".")) and where != place:
                raise Refused(f"{path}: '{place}' sets {key}, as '{where}' does with {other}; keep one of them")
        keys[key] = place

    if len(configs) > 1:
        axes["config"] = [(_stem(config), {"config": config}) for config in configs]
    grid = _flat(_typed(path, raw, "grid", dict, "a table of lists", {}))
    short = _short(grid)
    for key, values in grid.items():
        place = f"grid.{key}"
        if not isinstance(values, list) or not values:
            raise Refused(f"{path}: '{place}' must be a list of values, not {value_text(values)}")
        claim(place, key)
        _once(path, place, values)
        for value in values:
            if isinstance(value, float) and not math.isfinite(value):
                raise Refused(f"{path}: '{place}' must be finite, not {value_text(value)}")
        axes[short[key]] = [(value if _single(value) else value_text(value), {key: toml(value)}) for value in values]
    for name, values in _typed(path, raw, "axis", dict, "a table of tables", {}).items():
        place = f"axis.{name}"
        if not PLAIN.fullmatch(name) or name in axes or name in ("seed", "config"):
            raise Refused(f"{path}: '{place}' must have a name of its own, of letters, digits and _.+-")
        if not isinstance(values, dict) or not values or not all(isinstance(value, dict) for value in values.values()):
            raise Refused(
                f"{path}: '{place}' must be a table of values, each with the keys that it sets: 275 = {{ steps = 60 }}"
            )
        found = {value: _sets(path, f"{place}.{value}", table) for value, table in values.items()}
        for key in dict.fromkeys(key for table in found.values() for key in table):
            claim(place, key)
        axes[name] = list(zip(_numbers(list(found)), found.values()))
    seeds = raw.get("seeds")
    if isinstance(seeds, int) and not isinstance(seeds, bool) and seeds > 0:
        seeds = range(1, seeds + 1)
    if seeds is not None:
        whole = isinstance(seeds, (list, range)) and all(type(seed) is int and seed >= 0 for seed in seeds)
        if not whole or not len(seeds):
            raise Refused(
                f"{path}: 'seeds' must be a list of whole numbers of at least 0, or how many, not "
                f"{value_text(raw['seeds'])}"
            )
        claim("seeds", "seed")
        _once(path, "seeds", list(seeds) if isinstance(seeds, list) else [])
        axes["seed"] = [(seed, {"seed": str(seed)}) for seed in seeds]
    return axes


def _configs(path, raw):
    if "config" not in raw:
        raise Refused(f"{path}: missing key 'config'; write config = \"padani.toml\", from this file's folder")
    given = raw["config"] if isinstance(raw["config"], list) else [raw["config"]]
    if not given or not all(isinstance(config, str) and config for config in given):
        raise Refused(f"{path}: 'config' must be a configuration's file, or a list of them")
    found = [os.path.join(os.path.dirname(os.path.abspath(path)), config) for config in given]
    for config, said in zip(found, given):
        if not os.path.isfile(config):
            raise Refused(f"{path}: 'config': there is no file {said}; it is looked for from this file's folder")
    stems = [_stem(config) for config in found]
    if len(set(stems)) < len(stems):
        raise Refused(f"{path}: 'config': two files have one name; points are named after them")
    return [os.path.normpath(config) for config in found]


def _sets(path, place, table):
    return {key: toml(value) for key, value in _flat(table).items()}


def _flat(table, before=""):
    """Dotted keys as --set takes them: {"scene": {"segments": 8}} -> {"scene.segments": 8}."""
    found = {}
    for key, value in table.items():
        found |= _flat(value, f"{before}{key}.") if isinstance(value, dict) and value else {before + key: value}
    return found


def _short(keys):
    """key -> the shortest end of it that no other key has, in whole words; `seed` and `config` are taken."""
    found = {}
    for key in keys:
        parts = key.split(".")
        ends = (".".join(parts[-n:]) for n in range(1, len(parts) + 1))
        found[key] = next((end for end in ends if end not in ("seed", "config")
                           and sum(other == end or other.endswith("." + end) for other in keys) == 1), key)  # fmt: skip
    return found


def _numbers(names):
    """The names of an axis's values: numbers when all are finite and different ones, as they are written otherwise."""
    for kind in (int, float):
        try:
            numbers = [kind(name) for name in names]
        except ValueError:
            continue
        if all(map(math.isfinite, numbers)) and len(set(numbers)) == len(names):
            return numbers
    return names


def _once(path, place, values):
    seen = set()
    for value in values:
        text = value_text(value)
        if text in seen:
            raise Refused(f"{path}: '{place}' has {text} twice; every value is one point")
        seen.add(text)


def _single(value):
    return isinstance(value, (bool, int, float, str))


def _typed(path, raw, key, kind, rule, preset):
    value = raw.get(key, preset)
    if not isinstance(value, kind) or isinstance(value, bool):
        raise Refused(f"{path}: '{key}' must be {rule}, not {value_text(value)}")
    return value


def _known(path, table, keys, before):
    for key in table:
        if key not in keys:
            near = difflib.get_close_matches(key, keys, 1)
            hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(keys)}"
            raise Refused(f"{path}: unknown key '{before}{key}'; {hint}")


def _stem(path):
    return os.path.splitext(os.path.basename(path))[0]
