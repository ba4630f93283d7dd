"""The best of the thesis's nine, scene by scene."""

import numpy as np
import pandas as pd

from .figure import Points, Section, Table

from ..tables import pareto
from ..tables.clauses import KEYS
from ..words import counted, duration, number

NINE = list(KEYS.values())


def sections(runs):
    """The section; none without a scene that has at least two of the nine."""
    tables = {}
    for run in runs:
        table = run.summary
        if {"error", "time_mean_ns"} <= set(table.columns):
            mine = table.loc[[label for label in NINE if label in table.index]].dropna(subset=["error", "time_mean_ns"])
            if len(mine) > 1:
                title = pareto.title(run)
                tables.setdefault(title if title not in tables else f"{title} ({pareto.name(run)})", mine)
    if not tables:
        return []
    return [Section("Best of the nine", [Points("Of the thesis's nine, as published", told(tables)), beside(tables)])]


def told(tables):
    """A sentence a scene."""
    found = []
    for title, table in tables.items():
        best, safe = table.error.idxmin(), table[table.false_negative == 0]
        text = (
            f"{title}: {best} errs least of the nine, {number(table.error[best])} at "
            f"{duration(table.time_mean_ns[best])} a step"
        )
        faster = table[(table.time_mean_ns < table.time_mean_ns[best]) & (table.index != best)]
        if len(faster):
            next_ = faster.error.idxmin()
            text += (
                f"; of those that are faster {next_}, {number(table.error[next_])} at "
                f"{duration(table.time_mean_ns[next_])}"
            )
        if len(safe):
            exact = safe.error.idxmin()
            text += f"; of those that miss nothing {exact}, {number(table.error[exact])}"
        found.append(text + ".")
    return found


def beside(tables):
    """Errors and places of the nine in every scene."""
    frame = pd.DataFrame(index=pd.Index(NINE, name="algorithm"))
    frame.insert(0, "key", list(KEYS))
    for title, table in tables.items():
        frame[f"error, {title}"] = table.error
        frame[f"place, {title}"] = table.error.rank(method="min").astype("Int64")
    places = frame[[column for column in frame if column.startswith("place")]].astype(float)
    frame["mean place"] = places.mean(axis=1)
    frame = frame[places.notna().any(axis=1)].sort_values("mean place", kind="stable")
    caption = (
        f"Errors over all steps and the place by error, 1 the least, in {counted(len(tables), 'scene')}. K counts as "
        "published, its answers do not depend on how they are found."
    )
    return Table("Errors and places", frame.replace({np.nan: None}) if frame.isna().any(axis=None) else frame, caption)
