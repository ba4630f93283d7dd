"""The thesis's part of the report: its figures 5.1 to 5.25, tables 5.1 and 5.2, playground and statements, drawn anew.

The thesis ran each scene once; of several files of one motion the one with most of the thesis's algorithms is drawn,
the others are named. Every figure is of one file, its times of one machine and build; what was timed elsewhere is
named.
"""

from dataclasses import replace

from . import engine as engine_figures, numbered, playground as playground_map, steps as step_figures
from ..tables import pareto, scenes
from .drawing import NotDrawn, guarded, key, simulated
from .figure import Figure, Section, slug
from .thesis_tables import TABLE, in_javascript, languages_figure, means_figure, statements_part
from ..tables.sentences import FIGURES as CZECH
from ..tables.statements import PUBLISHED


def make_of(entry):
    return entry[1]


NAMES = {
    "box": ("The thesis's section 5.1 (Kostka)", "figures 5.1 to 5.13, table 5.1"),
    "falling": ("The thesis's section 5.2 (Padání)", "figures 5.14 to 5.25, table 5.2"),
    "playground": ("The thesis's section 5.3 (Hřiště)", "the maps of section 5.3"),
}
# kind -> part that makes a figure -> the anchor that the statements know, of the first scene of that kind
ANCHORS = {
    kind: dict(zip(map(make_of, engine_figures.FIGURES), map(numbered.anchor, numbered.ENGINE[kind])))
    | {means_figure: f"table-{TABLE[kind].replace('.', '-')}"}
    for kind in ("box", "falling")
} | {"playground": dict(zip(map(make_of, playground_map.FIGURES), ("map-obstacles", "map-kinds", "map-flicker")))}
NUMBERS = {kind: dict(zip(map(make_of, engine_figures.FIGURES), numbered.ENGINE[kind])) for kind in ("box", "falling")}
# What has a meaning without the thesis too: in every scene with bodies that move on their own.
STEPS = step_figures.FIGURES
THESIS = [*engine_figures.FIGURES, ("Mean times beside the thesis's", means_figure)]


def sections(runs):
    """Sections of the report on the thesis, from Runs of any scenes: of each scene, and the verdicts; never raises for
    what a file lacks."""
    chosen, notes, beside = chosen_runs(runs)
    return [*scene_sections(chosen, beside), statements_section([run for run, _ in chosen], notes, beside)]


def chosen_runs(runs):
    """([(run, what is said of others of its motion)], notes, kind -> the run beside it that has the thesis's
    procedures)."""
    groups, notes, beside = {}, [], scenes.companions(runs)
    for run in runs:
        if any(run is other for other in beside.values()):
            continue
        if kind_of(run) or run.meta["algorithms"]:
            groups.setdefault(run.meta["motion"].get("digest", run.path), []).append(run)
        else:
            notes.append(f"{pareto.name(run)} has neither a scene nor algorithms: the thesis has no figure of that.")
    found = []
    for group in groups.values():
        best = max(group, key=published)  # of equals the first
        more = [
            f"{pareto.name(run)} has the same motion; the thesis's figures are drawn from {pareto.name(best)}, which "
            f"has {'more' if published(run) < published(best) else 'no fewer'} of its algorithms as published."
            for run in group
            if run is not best
        ]
        found.append((best, more))
    return found, notes, beside


def scene_sections(chosen, beside):
    found, kinds = [], set()
    for number, (run, notes) in enumerate(chosen):
        kind = kind_of(run)
        found.append(section_of(run, kind, number, notes, beside.get(kind), kind not in kinds))
        kinds.add(kind)
    return found


def section_of(run, kind, number, notes, published=None, first=True):
    """A figure or a sentence for each of the thesis's. published: another run of the scene, for the times of the
    thesis's
    procedures; first: of its kind, whose figures have the thesis's numbers."""
    title = NAMES.get(kind, ("Step by step", ""))[0]
    place = slug(pareto.name(run))
    if kind == "playground":
        figures = playground_map.FIGURES
    else:
        figures = [*STEPS, *(THESIS if kind in NAMES else [])]
    if in_javascript(run):
        figures = [*figures, ("C++ beside JavaScript", languages_figure)]
    parts = []
    for name, make in figures:
        anchor = f"thesis-{number}-{place}-{make.__name__.replace('_', '-')}"
        more = [published] if make is means_figure else []
        part = guarded(name, make, run, kind, anchor, *more)
        if first and isinstance(part, Figure) and (known := ANCHORS.get(kind, {}).get(make, "figure-")) != "figure-":
            thesis_number = NUMBERS.get(kind, {}).get(make, "")
            part = replace(part, key=known, number=thesis_number, czech=CZECH.get(thesis_number, ""))
        parts.append(part)
    if first and kind in numbered.FIRST:
        for letter in numbered.ORDER:
            name = f"Figure {numbered.number_of(kind, letter)}"
            parts.append(guarded(name, numbered.one, run, kind, letter, published))
        parts.sort(key=lambda part: [int(n) for n in part.number.split(".")] if getattr(part, "number", "") else [0])
    # Figures first: sentences on what is missing are read once they are missed.
    found = sorted(parts, key=lambda part: not isinstance(part, Figure))
    return Section(title, [*notes, *found], pareto.title(run))


def statements_section(runs, notes, beside):
    """The verdicts, from one run of each kind; beside: kind -> the run whose times are those of the thesis's
    procedures."""
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
            if kind in beside:
                found[kind + PUBLISHED] = scenes.timed(beside[kind])
                used[kind + " times"] = f"{pareto.name(beside[kind])}, {beside[kind].meta['steps']} steps"
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
    """The kind of scene, of those that the thesis has; "" for none or when the configuration cannot be read."""
    try:
        return scenes.thesis_kind(run)
    except (KeyError, ValueError, OSError):
        return ""


def published(run):
    """How many of the thesis's nine a run has as published."""
    return sum(bool(key(run, label)) for label in run.meta["algorithms"])
