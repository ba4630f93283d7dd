"""What the studies of the integrators say: orders of convergence, the stability map, a recommendation, drift."""

import numpy as np
import pandas as pd

# Of fits of an order.
FLOOR = 1e-11  # errors below are rounding (relative or rad)
COARSE = 0.1  # errors above are not asymptotic
FITTED = 4  # the finest so many points

# Of the stability map: an energy error up to this is sound. The issue's own limit for a lossless cube.
SOUND = 0.01
# Of the recommendation: more accurate is better up to so many times the evaluations of the cheapest.
DEARER = 2

PARAMETERS = ("stiffness", "mass_ratio", "transition_velocity", "dissipation", "offset", "radius", "balls", "speed",
              "greatest_step", "thickness", "mass", "inertia", "duration")  # fmt: skip


def orders(run):
    """The order of convergence of every sweep and integrator, once by fixed steps and once by accuracies.

    Of sweeps that vary nothing else. Rows: sweep, integrator, by ("fixed_step" or "accuracy"). Columns: points (fitted), order (the slope of the error's
    logarithm over that of the step, by accuracies of the mean step), spread (standard error of the slope), nominal (by
    Simbody's documentation; NaN where it varies). NaN where fewer than three points are in the asymptotic range: errors
    from 0.1 down to 1e-11 that fall from each step to the next shorter, of them the finest four. Where a body enters a
    contact within a step even the high orders fall to 2 to 3: the force has no second derivative there.
    """
    table = study(run)
    table = table[table.finished & (table.error > 0)]
    rows = []
    for by in ("fixed_step", "accuracy"):
        chosen = table[table[by].notna()]
        alone = chosen.groupby("sweep", sort=False).filter(lambda cases: varied(cases) is None)
        for (sweep, integrator), cases in alone.groupby(["sweep", "integrator"], sort=False):
            step = cases.fixed_step if by == "fixed_step" else cases.reached / cases.steps
            points = asymptotic(step.to_numpy(), cases.error.to_numpy())
            order, spread = slope(*points) if len(points[0]) >= 3 else (np.nan, np.nan)
            rows.append((sweep, integrator, by, len(points[0]), order, spread, cases.nominal_order.iloc[0]))
    names = ["sweep", "integrator", "by", "points", "order", "spread", "nominal"]
    return pd.DataFrame(rows, columns=names).set_index(names[:3])


def asymptotic(step, error):
    """Steps and errors of the asymptotic range, coarsest first; see orders."""
    by_step = np.argsort(-step, kind="stable")
    kept = []
    for i in by_step:
        if error[i] > COARSE:
            kept = []
        elif error[i] < FLOOR:
            break
        elif not kept or step[i] < 0.9 * step[kept[-1]]:
            if kept and error[i] > 0.9 * error[kept[-1]]:
                if len(kept) >= 3:
                    break  # the rest is rounding
                kept = []
            kept.append(i)
    kept = kept[-FITTED:]
    return step[kept], error[kept]


def slope(step, error):
    """Slope of log error over log step by least squares, and its standard error."""
    x, y = np.log(step), np.log(error)
    x = x - x.mean()
    value = (x * y).sum() / (x * x).sum()
    rest = y - y.mean() - value * x
    return value, np.sqrt((rest * rest).sum() / max(len(x) - 2, 1) / (x * x).sum())


def varied(cases):
    """The parameter that a sweep varies, or None: the first with more than one value."""
    for name in PARAMETERS:
        if name in cases and cases[name].nunique() > 1:
            return name
    return None


def stability(run):
    """One row per case of the sweeps that vary a parameter, in the file's order.

    Columns: sweep, parameter (its name), value, integrator, verdict ("sound": finished with an energy error of at most
    1 %; "energy off": finished with a greater one; else the status), energy_error, momentum_drift,
    greatest_penetration, force_evaluations, reason.
    """
    parts = []
    for sweep, cases in study(run).groupby("sweep", sort=False):
        name = varied(cases)
        if name is None:
            continue
        sound = cases.energy_error.abs() <= SOUND
        verdict = np.where(cases.finished, np.where(sound, "sound", "energy off"), cases.status)
        kept = ["integrator", "energy_error", "momentum_drift", "greatest_penetration", "force_evaluations", "reason"]
        part = cases[kept].assign(sweep=sweep, parameter=name, value=cases[name], verdict=verdict)
        parts.append(part)
    columns = ["sweep", "parameter", "value", "integrator", "verdict", "energy_error", "momentum_drift",
               "greatest_penetration", "force_evaluations", "reason"]  # fmt: skip
    return pd.concat(parts)[columns] if parts else pd.DataFrame(columns=columns)


def stability_map(run, sweep, what="verdict"):
    """Integrators (rows, in the file's order) by values of the sweep's parameter: one column of `stability`."""
    cases = stability(run)
    cases = cases[cases.sweep == sweep]
    if cases.empty:
        raise KeyError(f"{run.path}: no sweep '{sweep}' that varies a parameter")
    table = cases.pivot_table(index="integrator", columns="value", values=what, aggfunc="first", sort=False)
    return table.reindex(cases.integrator.unique()).sort_index(axis=1)


def recommendation(run):
    """The integrators of a stability study, the one to take first.

    Rows: integrator. Columns: cases, sound (how many of them), evaluations and energy_error (geometric means over the
    cases), greatest_stiffness (Pa: up to there every case of the sweeps over stiffness is sound; NaN: from the first not).
    Order: by sound cases; of equals those at most twice as dear as the cheapest of them come first, by energy error;
    the dearer ones follow. attrs["sentence"] says it in words.
    """
    cases = stability(run)
    rows = {}
    for integrator, mine in cases.groupby("integrator", sort=False):
        rows[integrator] = {
            "cases": len(mine),
            "sound": int((mine.verdict == "sound").sum()),
            "evaluations": geometric(mine.force_evaluations.clip(lower=1)),
            "energy_error": geometric(mine.energy_error.abs().clip(lower=1e-16)),
            "greatest_stiffness": greatest_sound(mine[mine.parameter == "stiffness"]),
        }
    table = pd.DataFrame.from_dict(rows, orient="index").rename_axis("integrator")
    if table.empty:
        return table
    cheapest = table.groupby("sound").evaluations.transform("min")
    dear = table.evaluations > DEARER * cheapest
    table = table.assign(unsound=-table.sound, dear=dear)
    table = table.sort_values(["unsound", "dear", "energy_error"], kind="stable").drop(columns=["unsound", "dear"])
    first = table.iloc[0]
    if first.sound == 0:
        table.attrs["sentence"] = f"no integrator keeps its energy within {SOUND:.0%} in any case"
        return table
    full = list(table.index[table.sound == table.cases])
    table.attrs["sentence"] = (
        f"{table.index[0]}: {first.sound:.0f} of {first.cases:.0f} cases keep their energy within {SOUND:.0%}"
        + (f", as with {', '.join(full[1:])}" if len(full) > 1 and table.index[0] in full else "")
        + "; of those it is the most accurate within twice the evaluations of the cheapest"
    )
    return table


def geometric(values):
    """Geometric mean."""
    return float(np.exp(np.log(values.astype(float)).mean()))


def greatest_sound(cases):
    """The greatest value up to which every case is sound; NaN when the first is not."""
    reached = np.nan
    for value, at in cases.groupby("value"):
        if not (at.verdict == "sound").all():
            break
        reached = value
    return reached


def drift(run):
    """What a long integration lost or gained: a Series.

    seconds (simulated), status; energy_first, energy_last (J), energy_rise and energy_fall (greatest rise above and fall
    below the first energy, of it; of a run with births or pushes they say what came in), energy_last_relative;
    quaternion_drift (greatest deviation of a norm from 1 in the integrator, NaN: not recorded), penetration_median,
    penetration_greatest (m), escaped (bodies that were more than ten scenes' size away from the fixed bodies, or below
    them by one, at the end); steps, rejected (share), evaluations, processor_time (s).
    """
    physics = run.physics
    if physics is None:
        raise ValueError(f"{run.path}: nothing was integrated")
    energy = physics.energy.to_numpy()
    known = energy[np.isfinite(energy)]
    # What is there from the start: a scene that begins empty is measured from its first energy.
    first = known[np.flatnonzero(known)[0]] if known.any() else np.nan
    steps, rejected = physics.integrator_steps.sum(), physics.rejected_steps.sum()
    return pd.Series(
        {
            "seconds": (run.meta["steps"] - 1) / run.meta["rate"],
            "status": physics.attrs["status"],
            "energy_first": first,
            "energy_last": known[-1],
            "energy_last_relative": known[-1] / first - 1,
            "energy_rise": known.max() / first - 1,
            "energy_fall": 1 - known[np.flatnonzero(known)[0]:].min() / first,
            "quaternion_drift": physics.attrs.get("quaternion_drift", np.nan),
            "penetration_median": physics.greatest_penetration.median(),
            "penetration_greatest": physics.greatest_penetration.max(),
            "escaped": escaped(run),
            "steps": steps,
            "rejected": rejected / max(steps + rejected, 1),
            "evaluations": physics.force_evaluations.sum(),
            "processor_time": physics.time_ns.sum() * 1e-9,
        }
    )


def escaped(run):
    """How many moving bodies are at the end lower than everything fixed, or farther from it than ten times its size."""
    position = run.motion[0][-1]
    bodies = run.bodies
    fixed = bodies.fixed.to_numpy()
    size = np.stack(list(bodies["size"]))
    if not fixed.any():
        return 0
    low = (position[fixed] - size[fixed] / 2).min(axis=0)
    high = (position[fixed] + size[fixed] / 2).max(axis=0)
    reach = 10 * (high - low).max()
    moving = position[~fixed]
    moving = moving[np.isfinite(moving).all(axis=1)]
    below = moving[:, 1] + size[~fixed].max() / 2 < low[1]
    return int((below | (np.abs(moving - (low + high) / 2) > reach).any(axis=1)).sum())


def study(run):
    """The run's cases. Raises ValueError when it is not a study."""
    if run.study is None:
        raise ValueError(f"{run.path}: is not a study of integrators")
    return run.study


def text(run):
    """All that applies to a run, as lines for a terminal."""
    if run.study is None:
        return drift(run).to_string()
    found = []
    fitted = orders(run).dropna(subset="order")
    if len(fitted):
        found.append("orders\n" + fitted.round(2).to_string())
    cases = stability(run)
    for sweep in cases.sweep.unique():
        chosen = cases[cases.sweep == sweep]
        if not chosen.duplicated(["integrator", "value"]).any():
            found.append(f"{sweep}, by {chosen.parameter.iloc[0]}\n" + shown_map(chosen).to_string())
    if "stiffness" in set(cases.parameter):
        table = recommendation(run)
        found.append(table.to_string(float_format=lambda x: f"{x:.2g}") + "\n" + table.attrs["sentence"])
    return "\n\n".join(found)


def shown_map(cases):
    """Energy errors of those that finished, statuses of the others."""
    cell = [f"{error:+.0e}" if verdict in ("sound", "energy off") else verdict
            for error, verdict in zip(cases.energy_error, cases.verdict)]  # fmt: skip
    table = cases.assign(cell=cell).pivot(index="integrator", columns="value", values="cell")
    table.columns = [f"{value:g}" for value in table.columns]
    return table.reindex(cases.integrator.unique())

