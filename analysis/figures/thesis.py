"""The thesis's part of the report: its figures 5.1 to 5.25, tables 5.1 and 5.2, playground and statements, drawn anew.

The thesis ran each scene once; of several files of one motion the one with most of the thesis's algorithms is drawn,
the others are named. Every figure is of one file, its times of one machine and build; what was timed elsewhere is
named.
"""

import re

from analysis.figures import engine as engine_figures, playground as playground_map, steps as step_figures
from analysis.tables import pareto, scenes
from analysis.figures.drawing import NotDrawn, guarded, key, simulated
from analysis.figures.figure import Figure, Section
from analysis.figures.thesis_tables import in_javascript, languages_figure, means_figure, statements_part

NAMES = {
    "box": ("thesis section 5.1 (Kostka)", "figures 5.1 to 5.13, table 5.1"),
    "falling": ("thesis section 5.2 (Padání)", "figures 5.14 to 5.25, table 5.2"),
    "playground": ("thesis section 5.3 (Hřiště)", "the maps of section 5.3"),
}
# What has a meaning without the thesis too: in every scene with bodies that move on their own.
STEPS = step_figures.FIGURES
THESIS = [*engine_figures.FIGURES, ("Mean times beside the thesis's", means_figure)]


def sections(runs):
    """Sections of the report on the thesis, from Runs of any scenes; never raises for what a file lacks."""
    chosen, notes = {}, []
    for run in runs:
        if kind_of(run) or run.meta["algorithms"]:
            chosen.setdefault(run.meta["motion"].get("digest", run.path), []).append(run)
        else:
            notes.append(f"{pareto.name(run)} has neither a scene nor algorithms: the thesis has no figure of that.")
    found = []
    for number, (scene, group) in enumerate(chosen.items()):
        best = max(group, key=published)  # of equals the first
        more = [
            f"{pareto.name(run)} has the same motion; the thesis's figures are drawn from {pareto.name(best)}, which "
            f"has {'more' if published(run) < published(best) else 'no fewer'} of its algorithms as published."
            for run in group
            if run is not best
        ]
        chosen[scene] = best
        found.append(section_of(best, kind_of(best), number, more))
    found.append(statements_section(list(chosen.values()), notes))
    return found


def section_of(run, kind, number, notes):
    """A figure or a sentence for each of the thesis's."""
    title = f"{pareto.title(run)}: {NAMES.get(kind, ('step by step', ''))[0]}"
    slug = re.sub(r"[^a-z0-9]+", "-", pareto.name(run).lower()).strip("-")
    if kind == "playground":
        figures = playground_map.FIGURES
    else:
        figures = [*STEPS, *(THESIS if kind in NAMES else [])]
    if in_javascript(run):
        figures = [*figures, ("C++ beside JavaScript", languages_figure)]
    parts = list(notes)
    for name, make in figures:
        parts.append(guarded(name, make, run, kind, f"thesis-{number}-{slug}-{make.__name__.replace('_', '-')}"))
    # Figures first: sentences on what is missing are read once they are missed.
    return Section(title, [*notes, *sorted(parts[len(notes) :], key=lambda part: not isinstance(part, Figure))])


def statements_section(runs, notes):
    """The verdicts, from one run of each kind."""
    found, used, parts = {}, {}, list(notes)
    for run in runs:
        kind = kind_of(run)
        if kind not in NAMES:
            continue
        if kind in used:
            parts.append(f"{pareto.name(run)} is a second {kind} scene; the statements are judged on {used[kind]}.")
            continue
        data = guarded(f"The statements on {pareto.name(run)}", judged_data, run, kind, done="judged")
        if isinstance(data, str):
            parts.append(data)
        else:
            found[kind], used[kind] = data, pareto.name(run)
    for kind, (_, what) in NAMES.items():
        if kind not in {kind_of(run) for run in runs}:
            parts.append(f"No file of a {kind} scene was given: {what} are not drawn and statements on it not judged.")
    table = guarded("The statements", statements_part, found, [f"{kind}: {name}." for kind, name in used.items()])
    return Section("What the thesis said", [table, *parts])


def judged_data(run, kind):
    """What the statements ask of a run. Raises NotDrawn for an integration that failed: its steps are not the scene."""
    if simulated(run) < run.meta["steps"]:
        raise NotDrawn(f"the integration {run.physics.attrs['status']}")
    return scenes.playground(run) if kind == "playground" else scenes.timed(run)


def kind_of(run):
    """The kind of scene; "" for none or when the configuration cannot be read."""
    try:
        return scenes.kind(run)
    except (KeyError, ValueError):
        return ""


def published(run):
    """How many of the thesis's nine a run has as published."""
    return sum(bool(key(run, label)) for label in run.meta["algorithms"])
