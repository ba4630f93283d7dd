"""What the studies of the integrators measure: orders of convergence, and the drift of a long motion."""

import numpy as np
import pandas as pd

# Of fits of an order.
FLOOR = 1e-11  # errors below are rounding (relative or rad)
COARSE = 0.1  # errors above are not asymptotic
FITTED = 4  # that many points, the finest

# An energy error up to this is sound: of the problem's energy, or of a lossless cube's.
SOUND = 0.01
# Of the recommendation: more accurate is better up to that many times the evaluations of the cheapest.
DEARER = 2

PARAMETERS = [
    "units", "duration", "greatest_step", "radius", "thickness", "offset", "mass", "inertia", "balls", "mass_ratio",
    "speed", "transition_velocity", "stiffness", "dissipation",
]


def orders(run):
    """The order of convergence of every sweep and integrator, once by fixed steps and once by accuracies.

    Of sweeps that vary nothing else. Rows: sweep, integrator, by ("fixed_step" or "accuracy"). Columns: points
    (fitted), order (the slope of the error's logarithm over that of the step, by accuracies of the mean step), spread
    (standard error of the slope), nominal (by Simbody's documentation; NaN where it varies). NaN where fewer than three
    points are in the asymptotic range: errors from 0.1 down to 1e-11 that fall from each step to the next shorter, of
    them the finest four. Where a body enters a contact within a step even the high orders fall to 2 to 3: the force has
    no second derivative there.
    """
    table = study(run)
    table = table[table.finished & (table.error > 0)]
    rows = []
    for by in ("fixed_step", "accuracy"):
        chosen = table[table[by].notna()]
        alone = chosen.groupby("sweep", sort=False).filter(lambda cases: not varied(cases))
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
    from scipy.stats import linregress  # slow to load, and most of what is here does without

    fit = linregress(np.log(step), np.log(error))
    return fit.slope, fit.stderr


def varied(cases, names=PARAMETERS):
    """Which parameters have more than one value in `cases`."""
    return [name for name in names if name in cases and cases[name].nunique(dropna=False) > 1]


def geometric(values):
    """Geometric mean."""
    return float(np.exp(np.log(values.astype(float)).mean()))


def drift(run):
    """What a long integration lost or gained: a Series.

    seconds (simulated before it failed, if it did), status; energy_first, energy_last (J), energy_rise and energy_fall
    (greatest rise above and fall below the first energy, of it; of a run with births or pushes they say what came in),
    energy_last_relative;
    quaternion_drift (greatest deviation of a norm from 1 in the integrator, NaN: not recorded), penetration_median,
    penetration_greatest (m), escaped (bodies that were more than ten scenes' size away from the fixed bodies, or below
    them by one, at the end); steps, rejected (share), evaluations, processor_time (s).
    """
    physics = run.physics
    if physics is None:
        raise ValueError(f"{run.path}: nothing was integrated")
    energy = physics.energy.to_numpy()
    # What is there from the start: a scene that begins empty is measured from its first energy.
    known = energy[np.isfinite(energy)]
    known = known[np.flatnonzero(known)[0] :] if known.any() else np.array([np.nan])
    first = known[0]
    steps, rejected = physics.integrator_steps.sum(), physics.rejected_steps.sum()
    return pd.Series(
        {
            "seconds": max(simulated(run) - 1, 0) / run.meta["rate"],
            "status": physics.attrs["status"],
            "energy_first": first,
            "energy_last": known[-1],
            "energy_last_relative": known[-1] / first - 1,
            "energy_rise": known.max() / first - 1,
            "energy_fall": 1 - known.min() / first,
            "quaternion_drift": physics.attrs.get("quaternion_drift", np.nan),
            "penetration_median": physics["greatest_penetration"].median(),
            "penetration_greatest": physics["greatest_penetration"].max(),
            "escaped": escaped(run),
            "steps": steps,
            "rejected": rejected / max(steps + rejected, 1),
            "evaluations": physics.force_evaluations.sum(),
            "processor_time": physics.time_ns.sum() * 1e-9,
        }
    )


def simulated(run):
    """How many steps there are before an integration failed."""
    if run.physics is None or run.physics.attrs["status"] == "complete":
        return run.meta["steps"]
    return int(run.physics.energy.notna().cumprod().sum())


def escaped(run):
    """How many moving bodies are at the end lower than everything fixed, or farther from it than ten times its size.

    The end is the last step before an integration failed.
    """
    position = run.motion[0][max(simulated(run) - 1, 0)]
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
    """The rows of a study. Raises ValueError when the run is none."""
    if run.study is None:
        raise ValueError(f"{run.path}: is no study of integrators (it has no group /study)")
    return run.study
