"""Compares two results of one study: bodies = "tree" and bodies = "free".

usage: free_against_tree.py TREE.h5 FREE.h5

    build/pipeline run configs/integrators.toml --set bodies=tree -o tree.h5
    build/pipeline run configs/integrators.toml -o free.h5

Prints per problem and integrator: rows that ended otherwise, the errors and energy errors of the free bodies as
multiples of the tree's (median and greatest), the greatest momentum drifts, evaluations, and the ratio of processor
times. Then the rows whose error is more than 1.1 times the tree's and more than a tenth of the accuracy asked for.
"""
import sys

import h5py
import numpy as np


def rows(path):
    with h5py.File(path) as file:
        return {name: np.array([v.decode() if isinstance(v, bytes) else v for v in column[:]])
                for name, column in file["study"].items()}


tree, free = map(rows, sys.argv[1:])
same = ("problem", "integrator", "units", "accuracy", "fixed_step", "stiffness", "dissipation", "mass_ratio")
for name in same:
    equal = (tree[name] == free[name]) | ((tree[name] != tree[name]) & (free[name] != free[name]))
    assert equal.all(), f"the two are not of the same study: {name}"

KEYS = sorted(set(zip(tree["problem"], tree["integrator"])))


def ratio(a, b):
    """Errors at rounding level are equal."""
    with np.errstate(invalid="ignore"):
        return (np.abs(a) + 1e-12) / (np.abs(b) + 1e-12)


print(f"{'problem':14s}{'integrator':20s}{'rows':>5s}{'other':>6s}{'error: median, most':>21s}"
      f"{'energy: median, most':>22s}"
      f"{'momentum tree, free':>22s}{'evaluations':>12s}{'time':>7s}")
for problem, integrator in KEYS:
    at = (tree["problem"] == problem) & (tree["integrator"] == integrator)
    other = (tree["status"][at] != free["status"][at]).sum()
    both = at & (tree["finished"] == 1) & (free["finished"] == 1)
    error = ratio(free["error"][both], tree["error"][both])
    energy = ratio(free["energy_error"][both], tree["energy_error"][both])
    error, energy = error[~np.isnan(error)], energy[~np.isnan(energy)]

    def most(values):
        return f"{np.median(values):9.3f} {values.max():11.3g}" if len(values) else "                    -"

    def drift(table):
        values = table["momentum_drift"][both]
        return np.nanmax(values) if len(values) and not np.isnan(values).all() else np.nan

    spent = free["force_evaluations"][both].sum() / max(1, tree["force_evaluations"][both].sum())
    time = free["time_ns"][both].sum() / max(1, tree["time_ns"][both].sum())
    print(f"{problem:14s}{integrator:20s}{at.sum():5d}{other:6d}{most(error):>21s}{most(energy):>22s}"
          f"{drift(tree):11.2g}{drift(free):11.2g}{spent:12.4f}{time:7.3f}")

both = (tree["finished"] == 1) & (free["finished"] == 1)
asked = np.where(np.isnan(tree["accuracy"]), 1e-3, tree["accuracy"])
worse = both & (free["error"] > 1.1 * tree["error"]) & (free["error"] > 0.1 * asked)
better = both & (tree["error"] > 1.1 * free["error"]) & (tree["error"] > 0.1 * asked)
print(f"\n{both.sum()} rows finished in both; errors more than a tenth greater: free {worse.sum()}, tree "
      f"{better.sum()}")
for i in np.flatnonzero(worse):
    print(f"  {free['problem'][i]} {free['integrator'][i]} accuracy {free['accuracy'][i]:g} step "
          f"{free['fixed_step'][i]:g}: "
          f"{free['error'][i]:.3g} for {tree['error'][i]:.3g}")
print("rows that ended otherwise")
for i in np.flatnonzero(tree["status"] != free["status"]):
    print(f"  {free['problem'][i]} {free['integrator'][i]} accuracy {free['accuracy'][i]:g} step "
          f"{free['fixed_step'][i]:g} "
          f"stiffness {free['stiffness'][i]:g}: {free['status'][i]} for {tree['status'][i]}")
