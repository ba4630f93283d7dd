"""scripts/results: results over time and machines.

FOLDER keeps a small record of every result that is given to it, by machine and date: `pipeline show FILE --json` and,
of each label, the sums of its times over blocks of steps, so that ratios come from the same steps. FOLDER/index.html is
one page over all of them: whether errors are the same everywhere (by digests), times by machine and by commit, which
libraries differ, and what changed from one commit to the next above the noise. Records are text: keep them in a
repository, put those of several machines together by copying.

Exit codes: 0, 2 the command line's grammar, 4 a file that is no whole result or a record that cannot be read.
"""

import argparse
import glob
import itertools
import json
import os
import sys

import numpy as np
import pandas as pd

from .figures.figure import Figure, Points, Section, Table, figure, style, svg_of
from .files import replaced
from .load import load
from .output import complain, say, write
from .program import Refused, answered, default_program
from .report.page import page
from .tables import intervals
from .tables.intervals import Interval
from .words import counted, listed, number

DRAWN = 12  # labels in a figure: those with the most records


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="scripts/results", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER", help="of the records and their page, index.html")
    parser.add_argument("files", metavar="FILE.h5", nargs="*", help="results to be kept a record of")
    parser.add_argument("--program", default=default_program(), help="the built program (default: %(default)s)")
    chosen = parser.parse_args(arguments)
    try:
        for file in chosen.files:
            say(keep(chosen.folder, file, chosen.program))
        table = read(chosen.folder)
        target = os.path.join(chosen.folder, "index.html")
        write(target, report(table))
    except Refused as error:
        complain(f"scripts/results: {error}")
        return 4
    except OSError as error:
        complain(f"{error.filename}: {error.strerror}" if error.filename else error)
        return 4
    say(target)
    return 0


# ---- Records


def keep(folder, file, program):
    """Writes the record of a result; gives its path. The same result gives the same record."""
    told = json.loads(answered(program, "show", file, "--json"))
    if not told["complete"] or not told.get("algorithms"):
        raise Refused(f"{file}: has no answers of an algorithm; a finished run of a scene has")
    told.pop("which_one", None)
    told["file"] = os.path.basename(file)
    steps = load(file).step_times
    for one in told["algorithms"]:
        if one["label"] in steps and len(steps[one["label"]]):
            one["blocks_ns"] = intervals.blocks(steps[one["label"]]).tolist()
    timed = max(one["timed_on"]["date"] for one in told["algorithms"])
    host = told["algorithms"][0]["timed_on"]["host"]
    place = os.path.join(folder, _plain(host))
    os.makedirs(place, exist_ok=True)
    path = os.path.join(place, f"{_plain(timed)}_{_plain(told['title'])}_{told['digest'][:8]}.json")
    with replaced(path) as part:
        with open(part, "x", encoding="utf-8") as out:
            json.dump(told, out, indent=1)
            out.write("\n")
    return path


def _plain(text):
    return "".join(c if c.isalnum() or c in "-." else "_" for c in text)[:60].strip("_.") or "unknown"


def read(folder):
    """All records, a row per label: title, question, record, date, machine, commit, build, libraries, label, algorithm,
    knobs, digest, error, mean, low, high (ns; NaN: not timed), blocks (sums of times, ns; empty: not kept) and floor
    (an Interval or None); by date."""
    rows = []
    for path in sorted(glob.glob(os.path.join(glob.escape(folder), "*", "*.json"))):
        try:
            with open(path, encoding="utf-8") as file:
                rows += _rows(json.load(file), os.path.relpath(path, folder))
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise Refused(f"{path}: is no record of a result ({type(error).__name__}: {error})") from None
    if not rows:
        raise Refused(f"{folder}: has no records; name a result to keep one of it")
    return pd.DataFrame(rows).sort_values(["date", "record"], kind="stable", ignore_index=True)


def _rows(told, record):
    noise = told.get("noise") or {}
    floor = Interval(noise["ratio"], noise["ratio_low"], noise["ratio_high"]) if noise.get("ratio_low") else None
    for one in told["algorithms"]:
        timed = one["timed_on"]
        yield {
            "title": told["title"], "question": (told["digests"]["/motion"], told["digests"]["/truth"]),
            "record": record, "date": timed["date"], "machine": f"{timed['processor']} on {timed['host']}",
            "commit": timed["build"].split(" ")[0], "build": timed["build"].partition(" ")[2],
            "libraries": json.dumps(told["provenance"]["library_versions"], sort_keys=True), "label": one["label"],
            "algorithm": one["name"], "knobs": json.dumps(one["knobs"], sort_keys=True),
            "digest": told["digests"]["/answers/" + one["label"]], "error": one["error"],
            "mean": _known(one["time_mean_ns"]), "low": _known(one.get("time_mean_low_ns")),
            "high": _known(one.get("time_mean_high_ns")), "floor": floor,
            "blocks": np.array(one.get("blocks_ns", []), float),
        }


def _known(value):
    return np.nan if value is None else float(value)


# ---- What they say


def errors(table):
    """One row per label of a question: label, knobs, error (the last), records, digests (how many differ), and where
    they do, which commits gave which."""
    rows = []
    for (label, knobs), mine in table.groupby(["label", "knobs"], sort=False):
        differ = ""
        if mine.digest.nunique() > 1:
            differ = "; ".join(
                f"{digest[:8]} ({number(each.error.iloc[-1])}) by {listed(map(short, each.commit.unique()))}"
                for digest, each in mine.groupby("digest", sort=False))
        rows.append((label, knobs, mine.error.iloc[-1], len(mine), mine.digest.nunique(), differ))
    return pd.DataFrame(rows, columns=["label", "knobs", "error", "records", "different answers", "which"])


def short(commit):
    commit, _, dirty = commit.partition("-")
    return commit[:7] + (f"-{dirty}" if dirty else "")


def spread(means):
    """What runs of the same differ by: the greatest of their means over the least; none for one run."""
    return [float(means.max() / means.min())] if len(means) > 1 else []


def changes(table):
    """What changed between commits that follow each other on one machine and build, of one question; the same commit
    with other libraries counts as another.

    One row per label, machine and step from a commit to the next: ratio of the mean times with its interval, noise (the
    greatest ratio that is none: of the noise floors of both files, and of runs of the same commit; NaN where there is
    neither), time ("faster" or "slower"; "" within the noise, "?" where that is not known), answers (same or changed),
    error before and after, libraries that differ.
    """
    rows = []
    for (machine, build, label, knobs), mine in table.groupby(["machine", "build", "label", "knobs"], sort=False):
        versions = mine.groupby(["commit", "libraries"], sort=False)
        for ((before, _), old), ((after, _), new) in itertools.pairwise(versions):
            one, two = new.iloc[-1], old.iloc[-1]
            ratio = _ratio(one, two)
            floors = [max(floor.high, 1 / floor.low) for floor in (one.floor, two.floor) if floor is not None]
            noise = max([*spread(old["mean"]), *spread(new["mean"]), *floors], default=np.nan)
            differs = ratio.known and not ratio.holds(1) and not 1 / noise <= ratio.value <= noise
            rows.append({
                "label": label, "machine": machine, "from": short(before), "to": short(after), "ratio": ratio.value,
                "low": ratio.low, "high": ratio.high, "noise": noise,
                "time": ("?" if np.isnan(noise) else "slower" if ratio.value > 1 else "faster") if differs else "",
                "answers": "same" if one.digest == two.digest else "changed", "error before": two.error,
                "error": one.error, "libraries": _libraries(two.libraries, one.libraries),
            })
    columns = ["label", "machine", "from", "to", "ratio", "low", "high", "noise", "time", "answers", "error before",
               "error", "libraries"]
    return pd.DataFrame(rows, columns=columns)


def _ratio(one, other):
    """From the same steps where both records have their blocks."""
    if len(one.blocks) and len(one.blocks) == len(other.blocks):
        return intervals.of_blocks(one.blocks, other.blocks)
    return intervals.apart(*(Interval(row["mean"], row["low"], row["high"]) for row in (one, other)))


def _libraries(before, after):
    before, after = json.loads(before), json.loads(after)
    return ", ".join(f"{name} {before.get(name, 'none')} -> {after.get(name, 'none')}"
                     for name in sorted(before | after) if before.get(name) != after.get(name))


def times(table):
    """The last mean time (µs) of every label on every machine, with its interval in words."""
    frame = {}
    for machine, mine in table.groupby("machine", sort=False):
        last = mine.drop_duplicates("label", keep="last").set_index("label")
        frame[machine] = {
            label: number(row["mean"] / 1e3) + (f" ({number(row.low / 1e3)} to {number(row.high / 1e3)})"
                                                if row.low <= row.high else "")
            for label, row in last.iterrows() if row["mean"] == row["mean"]
        }
    return pd.DataFrame(frame).reindex(table.label.unique()).fillna("").rename_axis("label").reset_index()


# ---- The page


def report(table):
    """The HTML over all records; the same records give the same bytes."""
    commits, machines = table.commit.nunique(), table.machine.nunique()
    lead = [f"{counted(table.record.nunique(), 'result')} of {counted(table.question.nunique(), 'question')} (motion "
            f"and truth), by {counted(commits, 'commit')} on {counted(machines, 'machine')}, {table.date.iloc[0][:10]} "
            f"to {table.date.iloc[-1][:10]}."]
    sections = []
    for index, (_, mine) in enumerate(table.groupby("question", sort=False), 1):
        sections.append(Section(mine.title.iloc[-1], question(mine, index)))
    return page("Results over time and machines", lead, [], sections)


def question(table, index):
    found, changed = errors(table), changes(table)
    differ = found[found["different answers"] > 1]
    parts = [Points("Errors", [
        f"The answers of {listed(differ.label)} changed between commits." if len(differ) else
        f"Errors are the same everywhere: {counted(len(found), 'label')}, each with one digest of its answers in all"
        " of its records."])]
    told = changed[changed.time.isin(["slower", "faster"]) | (changed.answers == "changed")]
    unsure = changed[changed.time == "?"]
    said = [
        f"{row.label} from {row['from']} to {row.to} on {row.machine}: "
        + "; ".join(filter(None, [
            f"{row.time}, {number(row.ratio)} times ({number(row.low)} to {number(row.high)}; noise "
            f"{number(row.noise)})" if row.time in ("slower", "faster") else "",
            f"other answers, error {number(row['error before'])} -> {number(row.error)}"
            if row.answers == "changed" else "", row.libraries])) + "."
        for _, row in told.iterrows()]
    if len(unsure):
        said.append(f"Mean times of {counted(len(unsure), 'label')} differ, by {number(unsure.ratio.min())} to"
                    f" {number(unsure.ratio.max())} times; whether that means anything is not known: keep a second"
                    " result of each commit, or ask for the noise floor ([timing] noise = true).")
    steps = changed[["machine", "from", "to"]].drop_duplicates()
    none = f"Nothing above the noise, over {counted(len(steps), 'step')} from a commit to the next on a machine."
    parts.append(Points("What changed", said or [none if len(steps) else "No machine has results of two commits yet."]))
    parts += [part for part in [_figure(table, index)] if part]
    parts.append(Table("Times by machine", times(table), "The last mean time per step in µs, with its 95 % interval."))
    if len(changed):
        parts.append(Table(
            "From a commit to the next", changed,
            "Ratio: mean time after over before, of the last run of each commit. Noise: the greatest ratio that means"
            " nothing, of the files' noise floors and of runs of the same commit."))
    parts.append(Table("Answers", found, "Equal digests are equal answers, pair by pair."))
    return parts


def _figure(table, index):
    timed = table[table["mean"].notna()]
    timed = timed.assign(version=list(zip(timed.commit, timed.libraries)))
    if timed.empty or timed.groupby(["machine", "label"]).version.nunique().max() < 2:
        return None
    machines = list(dict.fromkeys(timed.machine))
    names = list(timed.label.value_counts(sort=True).index[:DRAWN])
    versions = list(dict.fromkeys(timed.version))
    fig, axes = figure(len(machines), 1, height=1 + 2.4 * len(machines), squeeze=False)
    for axis, machine in zip(axes[:, 0], machines):
        mine = timed[timed.machine == machine]
        for label in names:
            line = mine[mine.label == label].drop_duplicates("version", keep="last")
            at = [versions.index(version) for version in line.version]
            axis.plot(at, line["mean"] / 1e3, label=label, **style(line.algorithm.iloc[0] if len(line) else label))
            known = (line.low <= line.high).to_numpy()
            axis.vlines(np.array(at)[known], line.low[known] / 1e3, line.high[known] / 1e3, color="#777777")
        axis.set_yscale("log")
        axis.set_title(machine, loc="left")
        axis.set_ylabel("mean time (µs)")
        axis.set_xticks(range(len(versions)), _ticks(versions), rotation=30, ha="right")
    axes[-1, 0].set_xlabel("commit, by date of its first result")
    axes[0, 0].legend(loc="upper left", bbox_to_anchor=(1.01, 1))
    shown = timed[timed.label.isin(names)]
    names_of = dict(zip(versions, (text.replace("\n", ", ") for text in _ticks(versions))))
    frame = shown[["machine", "commit", "label", "mean", "low", "high"]].assign(
        commit=shown.version.map(names_of), **{column: shown[column] / 1e3 for column in ("mean", "low", "high")})
    where = "one machine" if len(machines) == 1 else f"each of {counted(len(machines), 'machine')}"
    title = f"Mean times of {counted(len(names), 'label')} by commit, on {where}"
    caption = "Bars: 95 % intervals. Machines do not compare with each other; each has a panel."
    return Figure(title, svg_of(fig), caption, frame, f"times-{index}")


def _ticks(versions):
    """The commits; of one that stands there before, what is new: its libraries."""
    texts, seen = [], {}
    for commit, libraries in versions:
        new = _libraries(seen[commit], libraries) if commit in seen else ""
        texts.append(short(commit) + (f"\n{new}" if new else ""))
        seen[commit] = libraries
    return texts


if __name__ == "__main__":
    sys.exit(main())
