"""What the report draws of studies of integrators: cases by what they vary, who is cheapest, who may be recommended.

Functions from a Run with a study (one row per case) to tables. Sweeps are told apart by what varies in them, not by
name: one that varies a single FACTOR is a map of integrators over that factor; cases that differ in accuracy or fixed
step alone are a work-precision problem; every other case is an extreme. A case that did not finish stays in every
table. Orders and drift are studies.py's.
"""

import tomllib

import numpy as np
import pandas as pd

from . import studies
from .studies import PARAMETERS, varied

CONTROLS = ["accuracy", "fixed_step"]
FACTORS = ["stiffness", "mass_ratio", "transition_velocity", "dissipation"]
UNITS = {"stiffness": "Pa", "transition_velocity": "m/s", "dissipation": "s/m", "offset": "m", "radius": "m",
         "mass": "kg",
         "greatest_step": "s", "speed": "m/s", "duration": "s", "thickness": "m", "inertia": "kg m²"}
THRESHOLDS = (1e-3, 1e-6, 1e-9)
BOUND = studies.SOUND  # of the problem's energy
NEAR = 10.0  # stiffness at most that many times smaller or greater than the scenes' counts as near


def setting(row):
    """How a row's steps are controlled: "accuracy 0.001", "step 0.001 s"."""
    return f"accuracy {row['accuracy']:g}" if row["accuracy"] == row["accuracy"] else f"step {row['fixed_step']:g} s"


def parts(study):
    """(maps, precision, extremes): lists of (name, rows), (name, rows) and the remaining rows."""
    maps, rest = [], []
    for name, rows in study.groupby("sweep", sort=False):
        vary = varied(rows)
        if len(vary) == 1 and vary[0] in FACTORS and rows.groupby("integrator")[CONTROLS].nunique().max().max() <= 2:
            maps.append((name, rows))
        else:
            rest.append(rows)
    rest = pd.concat(rest) if rest else study.iloc[:0]
    precision, left = [], []
    keys = ["problem", *[name for name in PARAMETERS if name in rest]]
    for values, rows in rest.groupby(keys, dropna=False, sort=False):
        if rows.groupby("integrator")[CONTROLS].nunique().max().max() >= 3:
            precision.append((values[0], rows))
        else:
            left.append(rows)
    names = [name for name, _ in precision]
    named = []
    for name, rows in precision:
        if names.count(name) > 1:  # the same problem with other parameters
            name = f"{name} ({rows['sweep'].iloc[0]}" + (f", {rows['units'].iloc[0]}" if "units" in rows else "") + ")"
        named.append((name, rows))
    return maps, named, (pd.concat(left).sort_index() if left else study.iloc[:0])


def work_precision(run):
    """What a precision costs. One row per case of a work-precision problem.

    Columns: problem, integrator, setting (text), accuracy, fixed_step (s), error (relative or rad; NaN where it did not
    finish), force_evaluations, time_s (of processor; NaN where nothing ran), energy_error, status, reason.
    """
    rows = [rows.assign(problem=name) for name, rows in parts(studies.study(run))[1]]
    columns = ["problem", "integrator", "setting", *CONTROLS, "error", "force_evaluations", "time_s", "energy_error",
               "status", "reason"]
    return joined(rows, columns)


def joined(tables, columns):
    """Tables of cases as one, with each row's setting and time_s; NaN for the error of a case that did not finish."""
    if not tables:
        return pd.DataFrame(columns=columns)
    table = pd.concat(tables, ignore_index=True)
    table["setting"] = [setting(row) for _, row in table.iterrows()]
    table["time_s"] = (table["time_ns"] / 1e9).where(table["time_ns"] > 0)
    table["error"] = table["error"].where(table["finished"])
    return table[columns]


def cheapest(run, cost="force_evaluations"):
    """Who reaches a precision most cheaply: per problem and threshold of the error the cheapest case at or below it.

    Columns: problem, threshold, integrator, setting, cost, error, apart (it is a fixed step of an integrator that takes
    accuracies, so not among those that a line of the figure joins), runner_up (another integrator; "" for none), times
    (its cost over the cheapest one's). Thresholds that nobody reaches have integrator "".
    """
    table, found = work_precision(run), []
    for problem, rows in table.groupby("problem", sort=False):
        if not (rows["error"] > 0).any():
            continue
        for threshold in THRESHOLDS:
            good = rows[(rows["error"] <= threshold) & (rows[cost] > 0)].sort_values(cost, kind="stable")
            if good.empty:
                found.append((problem, threshold, "", "", np.nan, np.nan, False, "", np.nan))
                continue
            best = good.iloc[0]
            others = good[good["integrator"] != best["integrator"]]
            second = others.iloc[0] if len(others) else None
            lined = controlled(rows[rows["integrator"] == best["integrator"]])
            found.append((problem, threshold, best["integrator"], best["setting"], float(best[cost]), best["error"],
                          best.name not in lined.index, "" if second is None else second["integrator"],
                          np.nan if second is None else float(second[cost]) / float(best[cost])))
    names = ["problem", "threshold", "integrator", "setting", "cost", "error", "apart", "runner_up", "times"]
    return pd.DataFrame(found, columns=names)


def controlled(rows):
    """Of one integrator the cases that a line joins, loose to tight: by accuracy, or by fixed step without any such."""
    by_accuracy = rows[rows["accuracy"].notna()]
    return (by_accuracy.sort_values("accuracy", ascending=False) if len(by_accuracy)
            else rows.sort_values("fixed_step", ascending=False))


def stability(run):
    """Where integrators hold. One row per case of a sweep over one factor.

    Columns: sweep, problem, factor, value (of the factor), integrator, setting, finished, status, reason, energy_error,
    momentum_drift, greatest_penetration (m), smallest_step (s), steps, rejected_steps, force_evaluations, time_s.
    """
    rows = []
    for _, found in parts(studies.study(run))[0]:
        factor = varied(found)[0]
        rows.append(found.assign(factor=factor, value=found[factor]))
    columns = ["sweep", "problem", "factor", "value", "integrator", "setting", "finished", "status", "reason",
               "energy_error", "momentum_drift", "greatest_penetration", "smallest_step", "steps", "rejected_steps",
               "force_evaluations", "time_s"]
    return joined(rows, columns)


def holds(table, bound=BOUND):
    """Of rows as of stability(): finished, and the energy within `bound` of its balance all the time."""
    return table["finished"].astype(bool) & (table["energy_error"].abs() <= bound)


def default_stiffness(run):
    """The stiffness (Pa) around which the other factors vary; NaN when the file does not tell."""
    study = studies.study(run)
    values = [rows["stiffness"].dropna() for _, rows in parts(study)[0] if varied(rows) != ["stiffness"]]
    values = pd.concat(values) if values else pd.Series(dtype=float)
    return float(values.mode().iloc[0]) if len(values) else np.nan


def recommendation(run, stiffness=None, bound=BOUND):
    """What may be recommended for a stiffness (the default one when not given): one row per integrator and setting.

    Judged are the cases of the sweeps over stiffness at most NEAR times from it. Columns: integrator, setting,
    accuracy, fixed_step, cases, of (cases that somebody has), holds (how many finish within `bound`),
    worst_energy_error, energy_error (geometric mean), force_evaluations (sum), cheapest (it needs the fewest of those
    that hold in all), recommended (of those that hold in all and need at most studies.DEARER times as many as the
    cheapest, the most accurate; none when nobody holds, or nobody has all cases). Sorted: those that hold in all first,
    by evaluations.
    """
    stiffness = default_stiffness(run) if stiffness is None else stiffness
    names = ["integrator", "setting", *CONTROLS, "cases", "of", "holds", "worst_energy_error", "energy_error",
             "force_evaluations", "cheapest", "recommended"]
    near = []
    for name, rows in parts(studies.study(run))[0]:
        if varied(rows) == ["stiffness"]:
            ratio = rows["stiffness"] / stiffness
            near.append(rows[(ratio <= NEAR * 1.001) & (ratio >= 0.999 / NEAR)])
    near = pd.concat(near) if near else pd.DataFrame()
    if near.empty:
        return pd.DataFrame(columns=names)
    of = len(near[["sweep", "stiffness"]].drop_duplicates())
    found = []
    for (integrator, accuracy, step), rows in near.groupby(["integrator", *CONTROLS], dropna=False, sort=False):
        worst = rows["energy_error"].iloc[rows["energy_error"].abs().fillna(np.inf).argmax()]
        found.append((integrator, setting(rows.iloc[0]), accuracy, step, len(rows), of, int(holds(rows, bound).sum()),
                      float(worst), studies.geometric(rows["energy_error"].abs().clip(lower=1e-16)),
                      int(rows["force_evaluations"].sum()), False, False))
    table = pd.DataFrame(found, columns=names)
    full = (table["cases"] == of) & (table["holds"] == of)
    table = table.assign(full=full).sort_values(["full", "force_evaluations"], ascending=[False, True], kind="stable")
    table = table.reset_index(drop=True)
    if len(table) and table["full"].iloc[0]:
        table.loc[0, "cheapest"] = True
        most = studies.DEARER * table["force_evaluations"].iloc[0]
        near_cheapest = table[table["full"] & (table["force_evaluations"] <= most)]
        table.loc[near_cheapest["energy_error"].idxmin(), "recommended"] = True
    return table.drop(columns="full")


def followed(run, others):
    """Whether integrated runs do as a study recommends at their stiffness: one row per run of `others` with a
    stiffness.

    Columns: file's title, integrator, setting, stiffness, recommended (text; "" for none), follows (bool), holds (their
    own integrator and setting hold in all near cases; NaN: the study has them not), times (their evaluations over the
    recommended ones' in those cases).
    """
    found = []
    for other in others:
        physics = physics_of(other)
        if not physics.get("stiffness") or not physics.get("integrator"):
            continue
        table = recommendation(run, float(physics["stiffness"]))
        step = physics.get("fixed_step") or np.nan
        mine = {"accuracy": np.nan if step == step else float(physics.get("accuracy", np.nan)), "fixed_step": step}
        same = table[table["integrator"] == physics["integrator"]]
        for name in CONTROLS:
            same = same[np.isclose(same[name].astype(float), mine[name], rtol=1e-9, equal_nan=True)]
        best = table[table["recommended"].astype(bool)]
        own, best = (None if rows.empty else rows.iloc[0] for rows in (same, best))
        found.append((
            other.meta.get("title", ""), physics["integrator"], setting(mine), float(physics["stiffness"]),
            "" if best is None else f"{best['integrator']} at {best['setting']}", own is not None
            and bool(own["recommended"]),
            np.nan if own is None else float(own["cases"] == own["of"] == own["holds"]),
            np.nan if own is None or best is None else own["force_evaluations"] / best["force_evaluations"],
        ))
    names = ["title", "integrator", "setting", "stiffness", "recommended", "follows", "holds", "times"]
    return pd.DataFrame(found, columns=names)


def physics_of(run):
    """The table [physics] of a run's configuration after defaults; empty when there is none."""
    return table_of(run, "physics")


def table_of(run, name):
    try:
        return dict(tomllib.loads(run.meta.get("config_effective", "")).get(name, {}))
    except (tomllib.TOMLDecodeError, TypeError):
        return {}


def extremes_of_motion(run):
    """The cases that are neither a map nor of a work-precision problem.

    Columns: sweep, case (what varies in its sweep, as text), integrator, finished, status, reason, error, energy_error,
    greatest_penetration (m), steps, force_evaluations, preventing_step (s), own_step (s; NaN: none: the fixed step that
    a case takes although its greatest step is to be shorter).
    """
    columns = ["sweep", "case", "integrator", "finished", "status", "reason", "error", "energy_error",
               "greatest_penetration", "steps", "force_evaluations", "preventing_step", "own_step"]
    rest, tables = parts(studies.study(run))[2], []
    for _, rows in rest.groupby("sweep", sort=False):
        names = varied(rows)
        several = rows.groupby("integrator")[CONTROLS].nunique().max().max() > 1
        words = [case_text(row, names, several) for _, row in rows.iterrows()]
        own = rows["fixed_step"].where(rows["fixed_step"] > rows["greatest_step"])
        tables.append(rows.assign(case=words, own_step=own))
    return pd.concat(tables, ignore_index=True)[columns] if tables else pd.DataFrame(columns=columns)


def case_text(row, names, control):
    words = []
    for name in names:
        value = row[name]
        if isinstance(value, str):
            words.append(value)
        elif value == value:
            words.append(f"{name.replace('_', ' ')} {value:g}\u00a0{UNITS.get(name, '')}".strip())
    if control:  # who takes no accuracy gets the same number as a step
        value = row["accuracy"] if row["accuracy"] == row["accuracy"] else row["fixed_step"]
        words.append(f"accuracy (or step) {value:g}")
    return ", ".join(words) or "as it stands"


def tunnelling(run):
    """Cases against a plate: which steps let the ball through, and the greatest that does not.

    One row per sweep, stiffness and integrator. Columns: speed (m/s), thickness (m), stiffness (Pa), went_through and
    stopped (steps of such cases, s, as lists: the fixed one, else the greatest allowed), preventing_step (s; NaN: none
    was found).
    """
    study = studies.study(run)
    fell_through = study["preventing_step"].notna() | (study["status"] == "tunnelled")
    rows = study[fell_through | (study["problem"] == "thin_plate")]
    found = []
    keys = ["sweep", "speed", "thickness", "stiffness", "integrator"]
    for key, mine in rows.groupby(keys, sort=False, dropna=False):
        taken = mine["fixed_step"].fillna(mine["greatest_step"])
        steps = {word: sorted(taken[which].dropna().unique(), reverse=True)
                 for word, which in (("through", mine["status"] == "tunnelled"), ("stopped", mine["finished"]))}
        found.append((*key, steps["through"], steps["stopped"], mine["preventing_step"].max()))
    return pd.DataFrame(found, columns=[*keys, "went_through", "stopped", "preventing_step"])


def drift_steps(run):
    """How an integrated run drifts, step by step; None when nothing was integrated.

    Columns: time (s), energy (J), energy_change (over the first energy that is not 0; NaN before and without one),
    greatest_penetration (m). attrs: status; lossless (by the configuration nothing gives or takes energy after the
    first step: then energy_change is an error).
    """
    if run.physics is None or not len(run.physics):
        return None
    physics = run.physics.reset_index(drop=True)
    rate = run.meta.get("rate", np.nan)
    table = pd.DataFrame({"time": np.arange(len(physics)) / (rate if rate == rate and rate > 0 else 1.0)})
    table["energy"] = physics["energy"].astype(float)
    there = np.flatnonzero(np.isfinite(table["energy"]) & (table["energy"] != 0))
    table["energy_change"] = np.nan
    if len(there):
        table.loc[there[0] :, "energy_change"] = table["energy"][there[0] :] / table["energy"][there[0]] - 1
    if "greatest_penetration" in physics:
        table["greatest_penetration"] = physics["greatest_penetration"].astype(float)
    table.attrs["status"] = run.physics.attrs.get("status", "complete")
    table.attrs["lossless"] = lossless(run)
    return table


def lossless(run):
    """Whether by its configuration a run has no losses, and no births and pushes after its first step."""
    options, scene = physics_of(run), table_of(run, "scene")
    losses = ["dissipation", "static_friction", "dynamic_friction", "viscous_friction", "linear_damping",
              "angular_damping"]
    if "dissipation" not in options or any(options.get(name) for name in losses):
        return False
    if (run.bodies["first_step"] > 0).any():
        return False
    push = scene.get("push", {})
    return not push.get("speed") or (push.get("from", 0) <= 0 and push.get("every", 0) >= run.meta["steps"])


def text(run):
    """All that a study or a long integrated motion says, as lines for a terminal."""
    if run.study is None:
        found = studies.drift(run)
        words = {name: f"{value:.6g}" if isinstance(value, float) else value for name, value in found.items()}
        return "\n".join(f"{name:<21} {value}" for name, value in words.items())
    study = studies.study(run)
    ends = ", ".join(f"{count} {status}" for status, count in study["status"].value_counts().items())
    found = [f"{len(study)} cases of {study['integrator'].nunique()} integrators" + (f": {ends}" if ends else "")]
    fitted = studies.orders(run).dropna(subset="order")
    if len(fitted):
        found.append("orders\n" + fitted.round(2).to_string())
    cases = stability(run)
    for sweep, mine in cases.groupby("sweep", sort=False):
        head = f"{sweep}, by {mine['factor'].iloc[0]}: energy off its balance, of the problem's"
        found.append(f"{head}\n{energy_map(mine).to_string()}")
    if len(cases):
        good = cases.assign(holds=holds(cases)).groupby("integrator", sort=False)["holds"]
        tally = good.agg(cases="size", holds="sum")
        found.append(f"cases of these that finish within {100 * BOUND:g} %\n" + tally.to_string())
    stiffness = default_stiffness(run)
    if len(cases) and stiffness == stiffness:
        near = recommendation(run, stiffness).drop(columns=CONTROLS).set_index("integrator")
        found.append(f"near {stiffness:g} Pa\n" + near.to_string(float_format="{:.2g}".format))
    return "\n\n".join(found)


def energy_map(cases):
    """Of one sweep of stability(): energy errors of the cases that finished, statuses of the others, as text.

    Rows: integrators, with their setting where one has several; columns: values of the factor; a dash: not run.
    """
    several = cases.groupby("integrator")["setting"].nunique().max() > 1
    who = cases["integrator"] + (", " + cases["setting"] if several else "")
    cell = [f"{row.energy_error:+.0e}" if row.finished else row.status for row in cases.itertuples()]
    table = cases.assign(who=who, cell=cell).pivot(index="who", columns="value", values="cell").fillna("-")
    table.columns = [f"{value:g}" for value in table.columns]
    return table.reindex(who.unique()).rename_axis("integrator")
