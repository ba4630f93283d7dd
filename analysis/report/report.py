"""What a report says: results -> sections. How they look is page.py's."""

import json
import os

import pandas as pd

from ..figures.error.against import against
from ..figures.error.costs import costs
from ..figures.error.kinds import kinds, trade
from ..engines import section as engines
from ..figures import extremes as extremes_figures
from ..figures import knobs as knobs_figures
from ..figures import nine
from ..figures.study import sections as study_figures
from ..figures import sweep as sweep_figures
from ..figures import thesis as thesis_figures
from . import choice, findings
from ..tables import pareto, scenes
from ..figures.figure import ABOUT, Figure, Section, Table, Text, know
from .explorer import explorer
from .page import page
from ..words import counted, listed, number, verb

SUMMARY = {  # column of the summary -> its head
    "error": "error",
    "time_mean_ns": "mean time (µs)",
    "time_median_ns": "median time (µs)",
    "time_p95_ns": "p95 (µs)",
    "operations": "operations per step",
    "false_positive": "FP",
    "false_negative": "FN",
    "hits": "hits",
    "precision": "precision",
    "recall": "recall",
    "matthews": "Matthews",
    "contained_hit": "contained hits",
}


DISTURBED = 0.02  # of the processor's time: more wall time than that was not the algorithm's

WORDS = """
pair: Two bodies, not both fixed. Every algorithm answers every pair at every step.
hit: A pair that an algorithm reports.
truth: Two bodies meet when some triangle of one meets some triangle of the other; triangles are closed sets, so
    touching counts. Decided with exact predicates for the world vertices ((r0 x + r1 y) + r2 z) + t as rounded in
    IEEE doubles.
contained: A body wholly inside another meets it not by surface. If the configuration records such pairs, hits on them
    are counted apart, neither right nor wrong; with containment = "meet" they belong to the truth.
true positive (TP): A hit on a pair that truly meets.
false positive (FP): A hit on a pair that does not meet.
false negative (FN): A pair that meets and is not reported: missed.
error: (FP + FN) / (TP + FP + FN) over all pairs and steps; 0 when the denominator is 0. True negatives are left out
    on purpose: nearly all pairs are far apart and would make every method look perfect.
precision, recall: TP / (TP + FP): how many hits are right. TP / (TP + FN): how many meeting pairs are found.
Matthews: Matthews' correlation coefficient of reported and true, over all pairs: 1 is perfect, 0 is guessing.
time: One thread, a monotonic clock around an algorithm's own work for one step: what depends on one body, then all
    pairs. The fastest of the repeats. Times compare within one machine and build only. From, to: a 95 % interval of the
    mean, by a block bootstrap over steps.
as fast as: The 95 % interval of the ratio of two mean times, from the same steps, holds 1 or lies within the noise
    floor, which is the interval of a label with itself, timed twice.
set-up and memory: What a method makes once for the bodies of a run, no part of its time per step; the heap that it
    holds then, and the most at any time.
operations: The elementary tests an algorithm really made, its cheap rejections and its prefilter's included: a cost
    that is the same on every machine.
promise: conservative: never misses a pair that truly meets; exact: neither misses one nor reports another; none. A
    miss that vanishes when boxes and radii grow by 2^-40 of their size is rounding and breaks nothing.
scope: A pairwise method visits every pair; a whole-scene method has a broad phase of its own and is drawn hollow.
Pareto front: The labels for which no other is at most as costly and at most as wrong, and better in one of the two.
"""  # one a line, its further lines indented


def report(runs):
    """The HTML of a report on `runs`, a list of Run; the same files give the same bytes."""
    return page(*parts_of(runs))


def parts_of(runs):
    """Title, lead, warnings and sections of a report on `runs`."""
    beside = companions(runs)
    titles = " / ".join(dict.fromkeys(pareto.title(run) for run in runs if not any(run is b for b in beside)))
    lost = failures(runs)
    completed = [run.completed() for run in runs]
    found = pareto.scenes(completed)
    know((point.label, point.algorithm) for scene in found for point in scene.points.itertuples())
    parts = sections(runs, found, completed)
    runs = completed
    return f"Collision benchmark: {titles}", lead(runs, found), lost + warnings(runs, found), parts


def write_figures(sections, folder):
    """Every figure of `sections` as KEY.svg, KEY.png and KEY.csv in `folder`, which is made; gives their number.

    Raises OSError, in a line that starts with the path.
    """
    os.makedirs(folder, exist_ok=True)
    figures = [part for section in sections for part in section.parts if isinstance(part, Figure)]
    for part in figures:
        name = os.path.join(folder, part.key)
        if part.svg:
            svg = part.svg.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" font-family="DejaVu Sans, '
                                            'sans-serif" ', 1)
            write_file(f"{name}.svg", svg.encode("utf-8", "replace"))
        if getattr(part.svg, "png", None):
            write_file(f"{name}.png", part.svg.png)
        index = not isinstance(part.table.index, pd.RangeIndex)
        write_file(f"{name}.csv", part.table.to_csv(index=index).encode("utf-8", "replace"))
    return len(figures)


def write_file(path, data):
    try:
        with open(path, "wb") as file:
            file.write(data)
    except OSError as error:
        raise OSError(f"{path}: cannot be written ({error.strerror})") from error


def failures(runs):
    """Methods of others that ended early; one line each."""
    return [
        f"{pareto.name(run)}: {label} failed after {number(int(done))} of {counted(run.meta['steps'], 'step')}:"
        f" {reason.rstrip('.')}. It is left out of figures and tables."
        for run in runs for label, (reason, done) in run.failed.items()
    ]


def foreign(runs):
    """What methods of others are, and how they ended; None when there are none."""
    rows = []
    for run in runs:
        exchange = {}
        if "exchange_ns" in run.per_step:
            exchange = run.per_step.groupby("algorithm", observed=False)["exchange_ns"].mean()
        for label, told in run.meta["answers"].items():
            if not told.get("transport"):
                continue
            whole = told.get("status") == "complete" and label in exchange and exchange[label] > 0
            rows.append({
                "label": label, "file": pareto.name(run), "asked as": told["transport"],
                "command": told.get("command", ""),
                "method": " ".join(filter(None, (told.get("name", ""), told.get("version", "")))),
                "language": told.get("language", ""), "precision": told.get("precision", ""),
                "threads": told.get("threads", 1),
                "exchange (µs)": exchange[label] / 1e3 if whole else float("nan"),
                "status": told.get("status", ""), "steps": told.get("steps_done", 0), "reason": told.get("reason", ""),
            })
    caption = (
        "Their time is their own, taken by a clock in their process around the work for a step; the wall time of"
        " question and answer, its mean over steps here, bounds it. A library is called in a process of its own, a"
        " program asked"
        " through pipes."
    )
    return Section("Methods of others", [Table("Who answered, and how", pd.DataFrame(rows), caption)]) if rows else None


def sweep_parts(table):
    """Title, lead, warnings and sections of a report on a sweep."""
    title = f"Collision benchmark: {table.attrs['title']}"
    return (title, sweep_figures.lead(table), sweep_figures.warnings(table),
            [*sweep_figures.sections(table), definitions()])


# A section of the page is a function (runs, found) -> list of Section; found: pareto.scenes of the runs. A further one
# is a
# line here. Section.scene says in which view it stands: "" in the overview, a scene's title, or ABOUT.
def findings_sections(runs, found):
    beside = companions(runs)
    return [part for part in [findings.section([run for run in runs if not any(run is b for b in beside)])] if part]


def answers_sections(runs, found):
    """Per scene: error against time, the summary."""
    if not any(not is_study(run) for run in runs):
        return []
    if not found:
        return [Section("Error against time", ["There is nothing to draw: no file has answers of an algorithm."]),
                Section("Summary", ["No file has a summary of algorithms."])]
    return [section for index, scene in enumerate(found, 1)
            for section in (error_against_cost(scene, index), summary(scene))]


def studies_sections(runs, found):
    studies = [run for run in runs if is_study(run)]
    return study_figures.sections(studies, runs)


def extremes_sections(runs, found):
    return extremes_figures.sections([run for run in runs if not is_study(run)])


def own_scenes(runs, found):
    """Without files that stand beside another of their scene for its times alone: they are no scene more."""
    beside = companions(runs)
    return [scene for scene in found if not all(any(run is other for other in beside) for run in scene.runs)]


def companions(runs):
    return list(scenes.companions(usual(runs)).values())


def usual(runs):
    return [run for run in runs if not is_study(run) and not is_extremes(run)]


def drift_sections(runs, found):
    beside = companions(runs)
    return study_figures.sections([run for run in usual(runs) if not any(run is other for other in beside)], runs)


def verdict_sections(runs, found):
    """Of the thesis's scenes; of other files alone there is nothing to say."""
    if not any(thesis_figures.kind_of(run) in thesis_figures.NAMES for run in usual(runs)):
        return []
    chosen, notes, beside = thesis_figures.chosen_runs(usual(runs))
    return [thesis_figures.statements_section([run for run, _ in chosen], notes, beside)]


def nine_sections(runs, found):
    return nine.sections(usual(runs))


def thesis_sections(runs, found):
    chosen, _, beside = thesis_figures.chosen_runs(usual(runs))
    return thesis_figures.scene_sections(chosen, beside)


def choice_sections(runs, found):
    return [part for part in [choice.section(own_scenes(runs, found))] if part]


def engines_sections(runs, found):
    return engines.sections([run for run in runs if not is_study(run)])


def knobs_sections(runs, found):
    return knobs_figures.sections(found)


def foreign_sections(runs, found):
    return [part for part in [foreign(runs)] if part]


def about_sections(runs, found):
    return [*([definitions()] if any(not is_study(run) for run in runs) else []), provenance(runs)]


SECTIONS = [findings_sections, choice_sections, engines_sections, verdict_sections, nine_sections, studies_sections,
            extremes_sections, answers_sections, knobs_sections, thesis_sections, drift_sections, foreign_sections,
            about_sections]


def sections(runs, found, completed):
    """All sections; the page puts those of one view together. runs: as read, for what failed too."""
    return [section for make in SECTIONS for section in make(runs if make is foreign_sections else completed, found)]


def is_extremes(run):
    return getattr(run, "extremes", None) is not None


def is_study(run):
    return getattr(run, "study", None) is not None


def lead(runs, found):
    """What was run, in a line each."""
    tests = {(p.algorithm, json.dumps(p.knobs, sort_keys=True)) for scene in found for p in scene.points.itertuples()}
    labels, lines = len(tests), []
    if labels or not any(map(is_study, runs)):
        lines.append(
            f"How often {counted(labels, 'collision test')} between triangle meshes {verb(labels, 'errs', 'err')}, "
            "judged by"
            f" exact answers, and what {verb(labels, 'it costs', 'they cost')}."
        )
    if any(map(is_study, runs)):
        lines.append(
            "When the simulated motion can be trusted: integrators judged by problems whose end is known, and by the"
            " energy they keep."
        )
    made_by = []
    for run in runs:
        meta = run.meta
        machine = " on ".join(filter(None, (meta["run"].get("processor"), meta["run"].get("host"))))
        made = f"{meta.get('build_type', '')} build of commit {meta.get('git_commit', '?')[:7]}"
        what = (f"{counted(meta['steps'], 'step')} of {counted(len(meta['bodies']), 'body', 'bodies')},"
                f" {counted(len(meta['algorithms']), 'label')}")
        if is_study(run):
            what = f"{counted(len(run.study), 'case')} of {counted(run.study['integrator'].nunique(), 'integrator')}"
        title = f"{pareto.title(run)} ({pareto.name(run)}): {what}"
        lines.append(title)
        made_by.append(", ".join(filter(None, (made, machine, meta["run"].get("date", "")[:10]))))
    if len(set(made_by)) > 1:
        return [*lines[: -len(runs)], *(f"{line}, {made}" for line, made in zip(lines[-len(runs):], made_by))]
    return [*lines, *(f"{'All: ' if len(runs) > 1 else ''}{made}" for made in made_by[:1])]


def warnings(runs, found):
    """What a reader must know before believing a number; one line each."""
    lines = []
    for run in runs:
        name, meta = pareto.name(run), run.meta
        builds = {meta.get("build_type", "")} | {
            answers.get("build", "").partition(" ")[2] for answers in meta["answers"].values()
        }
        if any("debug" in build.lower() for build in builds):
            lines.append(f"{name}: a debug build timed this; its times mean nothing.")
        if any("governor" in answers.get("processor", "") for answers in meta["answers"].values()):
            lines.append(f"{name}: the processor changed its frequency while it was timed; times are less certain.")
        if "dirty" in meta.get("git_commit", ""):
            lines.append(f"{name}: made by a program whose sources differ from commit {meta['git_commit'][:7]}.")
        if "openblas" in meta.get("library_versions", "").lower():
            lines.append(f"{name}: simulated with OpenBLAS; another kind of processor may move otherwise.")
        if run.physics is not None and run.physics.attrs["status"] != "complete":
            lines.append(
                f"{name}: the integration {_sentence(run.physics.attrs['status'])} From there on nothing moves and"
                " nothing meets."
            )
        if is_study(run):
            lines += [] if len(run.study) else [f"{name}: the study has no cases."]
            continue  # what follows is asked of scenes
        if not len(meta["algorithms"]):
            lines.append(f"{name}: no algorithm has answered; `pipeline detect` adds answers to the file.")
        elif not len(run.summary.columns):
            lines.append(f"{name}: the summary of the algorithms is missing.")
        elif len(meta["algorithms"]) == 1:
            lines.append(f"{name}: only one algorithm, {meta['algorithms'][0]}; nothing can be compared with it.")
        if not len(run.truth_hits):
            lines.append(f"{name}: has no truth to judge answers by.")
        elif run.truth_hits.sum() == 0:
            lines.append(f"{name}: no two bodies ever meet; whatever is reported is false, and recall says nothing.")
        if is_extremes(run):
            lost = run.extremes.groupby("algorithm", observed=True)["failed"].sum()
            lines += [
                f"{name}: {label} failed in {number(int(count))} of {number(meta['steps'])} cases; the summary, and"
                " errors against time and operations, count them as reporting nothing."
                for label, count in lost[lost > 0].items()
            ]
        lines += [f"{name}: {line}" for line in [*doubtful_times(run), *scenes.ends_early(run)]]
        if "promise_kept" in run.summary:
            broken = list(run.summary.index[~run.summary.promise_kept])
            if broken:
                lines.append(f"{name}: broke their promise: {', '.join(broken)}. That is an error of the program.")
        lost = [group for group in _expected(run) if not _has(run, group)]
        if lost:
            lines.append(f"{name}: lacks {', '.join(lost)}; what would be drawn from there is left out.")
    for scene in found:
        machines = list(dict.fromkeys(scene.points.machine))
        if len(machines) > 1:
            lines.append(
                f"{scene.title}: timed on {len(machines)} different machines or builds ({'; '.join(machines)}). Their"
                " times are drawn apart; errors and operations compare. “pipeline detect FILE --force” times them anew."
            )
    same = {}  # what is to be said of several files is said once
    for line in lines:
        name, colon, text = line.partition(": ")
        same.setdefault(text if colon else line, []).append(name if colon else "")
    return [f"{listed(names)}: {text}" if names[0] else text for text, names in same.items()]


def doubtful_times(run):
    """What makes mean times of a run doubtful; one line each."""
    table, lines = run.summary, []
    if run.unlike:
        processors = dict.fromkeys(name for names in run.unlike.values() for name in names)
        who = listed(run.unlike) if len(run.unlike) < len(run.meta["algorithms"]) else "all algorithms"
        lines.append(f"timed on unlike processors ({'; '.join(processors)}): {who}. Such times are drawn nowhere; "
                     f"`pipeline"
                     " show` has them by processor, and “pipeline detect FILE --force” times anew on one.")
    if {"time_mean_ns", "time_p95_ns"} <= set(table):
        few = list(table.index[table.time_mean_ns > table.time_p95_ns])
        if few:
            lines.append(f"the mean time of {listed(few)} lies above its 95th percentile: a few steps, or a "
                         "disturbance, take"
                         " most of it; the median tells more.")
    if "processor_mean_ns" in table:
        share = table.time_mean_ns / table.processor_mean_ns - 1
        late = share[share > DISTURBED]
        if len(late):
            each = listed(f"{label} by {number(100 * value)} %" for label, value in late.items())
            lines.append(f"the run was disturbed: wall time is above the processor's own, of {each}; time again on an "
                         "idle"
                         " machine.")
    return lines


def _sentence(status):
    return status.rstrip(".") + "."


def _expected(run):
    return ["/bodies", "/motion", "/run"] + (["/results"] if len(run.meta["algorithms"]) else [])


def _has(run, group):
    if group == "/results":
        return len(run.per_step) > 0 or run.meta["steps"] == 0
    return bool(run.meta["bodies"]) if group == "/bodies" else bool(run.meta[group[1:]])


def error_against_cost(scene, index):
    parts = [
        "Each mark is one algorithm with its settings. Its height is the share of wrong answers among all answers that"
        " matter, its place to the right is what it costs. Whoever wants fewer errors must pay along the dashed front;"
        " what is above it is never the best choice on this scene."
    ]
    parts += filter(None, [explorer(scene, f"explorer-{index}")])
    machines = list(dict.fromkeys(scene.points.machine))
    for place, machine in enumerate(machines, 1):
        mine = scene.points[scene.points.machine == machine]
        others = [label for label in scene.points.label if label not in set(mine.label)]
        apart = ""
        if others:
            apart = f"Other machines or builds timed {len(others)} more labels; they have a figure of their own."
        parts.append(against(scene, mine, "time_mean_ns", f"error-time-{index}-{place}", apart))
        parts += filter(None, [costs(scene, mine, f"costs-{index}-{place}")])
    parts.append(against(scene, scene.points, "operations", f"error-operations-{index}"))
    parts.append(trade(scene, f"precision-recall-{index}"))
    parts.append(kinds(scene, f"error-kinds-{index}"))
    return Section("Error against time", parts, scene.title)


def summary(scene):
    points = scene.points
    frame = pd.DataFrame({"algorithm": points.label})
    for column, head in SUMMARY.items():
        if column in points and points[column].notna().any():
            unit = 1e3 if column.endswith("_ns") else 1
            frame[head] = points[column] if unit == 1 else points[column] / unit
            if column in ("false_positive", "false_negative", "contained_hit", "hits"):
                frame[head] = frame[head].astype("Int64")
    frame["promise"] = [_promise(point) for point in points.itertuples()]
    timed_here = points.time_mean_ns.notna() & points.error.notna()
    frame["on the front"] = timed_here & pareto.front(
        points.time_mean_ns.fillna(float("inf")), points.error.fillna(float("inf"))
    )
    machines = {machine: chr(ord("A") + number) for number, machine in enumerate(dict.fromkeys(points.machine))}
    timed = "Front: of error against mean time."
    if len(machines) > 1:
        frame = frame.drop(columns="on the front")
        frame["timed on"] = points.machine.map(machines)
        timed = "; ".join(f"{letter}: {machine}" for machine, letter in machines.items())
        timed = f"Timed on {timed}. Times of different letters do not compare."
    hits = number(int(scene.runs[0].truth_hits.sum()))
    caption = (
        f"{counted(len(points), 'label')}; counts are sums over {counted(scene.runs[0].meta['steps'], 'step')}, in"
        f" which {hits} pairs truly meet. FP, FN: false positives, false negatives. Times are per step, the"
        " fastest repeat of each; p95: their 95th percentile. A dash stands for 0/0. "
        f"{timed}"
    )
    knobs = [
        (p.label, p.algorithm, json.dumps(p.knobs) if p.knobs else "none", p.unit) for p in points.itertuples()
    ]
    lines = "\n".join(
        f"{label}: {algorithm}, knobs {text}, operations are {unit}" for label, algorithm, text, unit in knobs
    )
    return Section("Summary", [Table(scene.title, frame, caption),
                               Text(f"Settings of {counted(len(points), 'label')}", lines)], scene.title)


def _promise(point):
    if point.promise == "none":
        return "none"
    return f"{point.promise}, {'kept' if point.promise_kept else 'BROKEN'}"


def definitions():
    lines = WORDS.strip().replace("\n    ", " ").splitlines()
    frame = pd.DataFrame([line.split(": ", 1) for line in lines], columns=["word", "what it means here"])
    return Section("What is measured", [Table("Words", frame, "As in the file, the configuration and README.")], ABOUT)


def provenance(runs):
    columns = {}
    for place, run in enumerate(runs, 1):
        name = pareto.name(run)
        columns[name if name not in columns else f"{name} ({place})"] = pd.Series(_provenance(run))
    frame = pd.DataFrame(columns)
    frame = frame.fillna("")
    frame = frame[(frame != "").any(axis=1)]
    frame.index.name = "file"
    caption = (
        "The digest covers everything but times and names of machines: equal digests are equal results. It stands here"
        " as the file has it; pipeline show computes it anew and refuses a file whose content differs."
    )
    texts = [
        Text(f"Configuration of {pareto.name(run)}, after defaults and --set", run.meta["config_effective"])
        for run in runs
    ]
    return Section(
        "What was run", [Table("Results, builds and machines", frame, caption), *(text for text in texts if text.text)],
        ABOUT,
    )


def _provenance(run):
    meta = run.meta
    answers = meta["answers"].values()
    libraries = _versions(meta.get("library_versions", "{}"))
    inputs = pareto.json_object(meta.get("inputs_sha256", "{}"))
    containment = meta["truth"].get("containment", "ignore")
    if is_study(run):
        of_scene = {"cases": number(len(run.study))}
    else:
        of_scene = {
            "steps": (
                f"{number(meta['steps'])} at {meta['rate']:g} per second"
                if meta["rate"] == meta["rate"]
                else str(meta["steps"])
            ),
            "bodies": str(len(meta["bodies"])),
            "pairs that meet": f"{number(int(run.truth_hits.sum()))} over all steps",
            "containment": containment,
            "algorithms": str(len(meta["algorithms"])),
            "integration": (
                run.physics.attrs["status"] if run.physics is not None else "none: the motion is scripted or replayed"
            ),
        }
    return {"title": meta.get("title", "")} | of_scene | {
        "made by": meta.get("creator", ""),
        "commit": meta.get("git_commit", ""),
        "build": f"{meta.get('build_type', '')}, {meta.get('compiler', '')}, {meta.get('flags', '')}",
        "libraries": libraries,
        "date": meta["run"].get("date", ""),
        "machine": f"{meta['run'].get('processor', '?')} on {meta['run'].get('host', '?')}",
        "wall time": f"{meta['run']['wall_time_s']:.1f} s" if "wall_time_s" in meta["run"] else "",
        "algorithms timed on": "; ".join(dict.fromkeys(map(pareto.machine, answers))),
        "configuration SHA-256": meta.get("config_sha256", ""),
        "inputs SHA-256": ", ".join(f"{path} {digest}" for path, digest in inputs.items()),
        "digest": f"{meta.get('digest', '')} ({meta.get('digest_algorithm', '')})",
        "digest of motion": meta["motion"].get("digest", ""),
        "digest of truth": meta["truth"].get("digest", ""),
        "schema version": str(meta["schema_version"]),
    }


def _versions(text):
    return ", ".join(f"{name} {version}" for name, version in pareto.json_object(text).items())
