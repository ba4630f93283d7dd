"""Sections of the report on studies of integrators: work and precision, where they hold, extremes and drift."""

from ...tables import pareto, studies, study_tables
from ...words import counted
from ..drawing import guarded
from ..figure import Section, slug
from .cases import causes
from .maps import factor_figure, map_figure, recommendation_table
from .motion import drift_figure, extremes_figure, tunnelling_table
from .precision import order_figure, orders_table, precision_figure


def sections(runs, beside=None):
    """A section for each study among `runs`, and one for the drift of each integrated motion; none when there is
    neither.

    beside: all runs of the report; recommendations are compared with their configurations.
    """
    beside = runs if beside is None else beside
    found = []
    for count, run in enumerate(runs):
        key = f"study-{count}-{slug(pareto.name(run))}"
        if run.study is not None:
            found.append(Section(f"{pareto.title(run)}: integrators", study_parts(run, beside, key),
                                 pareto.title(run)))
        elif run.physics is not None and run.meta["steps"] > 1:
            found.append(Section("Drift of the motion", [guarded("Drift", drift_figure, run, key)], pareto.title(run)))
    return found


def study_parts(run, runs, key):
    """Whatever the file has of: precision figures, orders, maps, recommendation, extremes."""
    try:
        study = studies.study(run)
        maps, precision, rest = study_tables.parts(study)
    except (KeyError, ValueError) as error:
        return [f"The study cannot be read: {error}."]
    if study.empty:
        return ["The study has no cases."]
    found = [unfinished(study)]
    if precision:
        for cost in ("force_evaluations", "time_s"):
            found.append(guarded("Error against cost", precision_figure, run, cost, f"{key}-{cost.replace('_', '-')}"))
        found.append(guarded("Error against the step", order_figure, run, f"{key}-order"))
        found.append(guarded("Orders", orders_table, run))
    stiff = [name for name, rows in maps if studies.varied(rows) == ["stiffness"]]
    for name in stiff:
        found.append(guarded("The stability map", map_figure, run, name, f"{key}-map-{slug(name)}"))
    others = [name for name, _ in maps if name not in stiff]
    if others:
        found.append(guarded("The other factors", factor_figure, run, others, f"{key}-factors"))
    if stiff:
        found.append(guarded("The recommendation", recommendation_table, run, runs))
    if len(rest):
        found.append(guarded("The extremes of the motion", extremes_figure, run, f"{key}-extremes"))
        found.append(guarded("The plate", tunnelling_table, run))
    return [part for part in found if part is not None]


def unfinished(study):
    lost = study[~study["finished"]]
    who, where = (counted(study[name].nunique(), name) for name in ("integrator", "problem"))
    text = f"{counted(len(study), 'case')} of {who} on {where}"
    return f"{text}; {len(lost)} did not finish: {causes(lost)}." if len(lost) else f"{text}; all finished."
