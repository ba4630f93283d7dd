"""What results say, in plain sentences computed from their data; a sentence that the data do not carry is not written.

Every function takes a Run and gives a list of sentences. Sentences of one file that tell what cannot be told (an
unfinished integration, cases left out) come first.
"""

import numpy as np

from ..figures import extremes as extremes_figures
from ..tables import causes as why
from ..tables import extremes, intervals, pareto, studies, study_tables
from ..figures.drawing import NotDrawn, places, plain
from ..figures.figure import Points, Section
from ..figures.heat_map import heads_of
from ..figures.study.cases import FAILED, OTHERWISE, causes
from ..figures.study.maps import follow_text
from ..figures.study.motion import drift_words
from ..figures.study.precision import steady
from ..words import counted, duration, listed, number, verb


def section(runs):
    """The section "Findings": the sentences of every file; None when there is none."""
    parts = []
    for run in runs:
        mine = []
        for tell in (study, answers, algorithms, misses, drift):
            try:
                mine += tell(run, runs) if tell is study else tell(run)
            except (KeyError, ValueError, OSError, AttributeError, NotDrawn) as error:
                mine.append(f"What {tell.__name__} would tell is left out, the file is not as expected: "
                            f"{plain(error)}.")
        if mine:
            parts.append(Points(f"{pareto.title(run)} ({pareto.name(run)})", mine))
    return Section("Findings", parts) if parts else None


# ---- Studies of integrators ----------------------------------------------------------------------------------------


def study(run, runs=()):
    """Findings of a study of integrators; runs: what stands beside it in the report."""
    if run.study is None:
        return []
    table = studies.study(run)
    if table.empty:
        return ["The study has no cases."]
    return [*ended(table), *precision(run), *converged(run), *held(run), *recommended(run, runs), *went_wrong(run)]


def ended(table):
    lost = table[~table["finished"]]
    if lost.empty:
        return [f"All {number(len(table))} cases finished." if len(table) > 1 else "The only case finished."]
    return [f"{number(len(lost))} of {counted(len(table), 'case')} did not finish: {causes(lost)}."]


def precision(run):
    """Who is cheapest for which precision, over the problems with a reference."""
    best, found = study_tables.cheapest(run), []
    for threshold, rows in best.groupby("threshold", sort=False):
        reached = rows[rows["integrator"] != ""]
        if reached.empty:
            found.append(f"No integrator brings the error below {short(threshold)} on any of "
                         f"{counted(len(rows), 'problem')} within its budget.")
            continue
        where = reached["problem"].str.replace("_", " ") + np.where(reached["apart"], " (fixed step)", "")
        each = [f"{name} on {listed(where[mine.index])} ({costs(mine)})"
                for name, mine in reached.groupby("integrator", sort=False)]
        text = f"For an error below {short(threshold)} the fewest force evaluations are those of {'; '.join(each)}"
        none = rows["problem"][rows["integrator"] == ""].str.replace("_", " ")
        found.append(f"{text}{f'; nobody reaches it on {listed(none)}' if len(none) else ''}.")
    return found


def costs(rows):
    low, high = rows["cost"].min(), rows["cost"].max()
    return number(int(low)) if low == high else f"{number(int(low))} to {number(int(high))}"


def short(value):
    return heads_of([value])[0]


def converged(run):
    fits = steady(studies.orders(run))
    found = []
    for name, mine in fits.groupby("integrator", sort=False):
        nominal, low, high = mine["nominal"].iloc[0], mine["order"].min(), mine["order"].max()
        range_ = f"{low:.2f}" if f"{low:.2f}" == f"{high:.2f}" else f"{low:.2f} to {high:.2f}"
        off = mine[mine["order"] < nominal - 0.3]
        text = f"{name} converges with order {range_} on {counted(len(mine), 'problem')}; nominal is {nominal:g}"
        if len(off):
            text += f", which it falls short of on {listed(off['sweep'].str.replace('_', ' '))}"
        found.append(text + ".")
    return found


def held(run):
    """Of every sweep over one factor: who keeps the energy within BOUND everywhere, who not at all, who fails."""
    table, found = study_tables.stability(run), []
    for sweep, mine in table.groupby("sweep", sort=False):
        factor, values = mine["factor"].iloc[0], sorted(mine["value"].unique())
        unit = study_tables.UNITS.get(factor, "")
        all_ = mine.groupby("integrator")["value"].nunique()
        whole = list(all_.index[all_ == len(values)])
        good = study_tables.holds(mine).groupby(mine["integrator"], sort=False).all()
        keep = [name for name in good.index if good[name] and name in whole]
        low, high = heads_of([values[0], values[-1]])
        where = f"over {factor.replace('_', ' ')} {low} to {high} {unit}".strip()
        problem = f"{mine['problem'].iloc[0].replace('_', ' ')} ({sweep})"
        if not whole:
            found.append(f"On the {problem} no integrator has all of {len(values)} values {where}; who holds "
                         "everywhere cannot be said.")
        elif keep:
            found.append(f"On the {problem} {listed(keep)} {verb(keep, 'keeps', 'keep')} the energy within "
                         f"{100 * study_tables.BOUND:g} % {where}.")
        else:
            found.append(f"On the {problem} no integrator keeps the energy within {100 * study_tables.BOUND:g} % "
                         f"everywhere {where}.")
        lost = mine[~mine["finished"]]
        for name, some in lost.groupby("integrator", sort=False):
            why = listed(dict.fromkeys((FAILED.get(status) or OTHERWISE)[1] for status in some["status"]))
            found.append(f"On the {problem} {name} does not finish at {factor.replace('_', ' ')} "
                         f"{listed(heads_of(sorted(some['value'].unique())))} {unit}".rstrip() + f": {why}.")
        gained = mine[mine["finished"] & (mine["energy_error"] > 1)]
        for name, some in gained.groupby("integrator", sort=False):
            worst = some.loc[some["energy_error"].idxmax()]
            found.append(f"On the {problem} {name} gains {worst['energy_error']:.3g} times the problem's energy and "
                         f"finishes all the same at {factor.replace('_', ' ')} {short(worst['value'])} {unit}".rstrip()
                         + ".")
    return found


def recommended(run, runs):
    maps, _, _ = study_tables.parts(studies.study(run))
    if not any(studies.varied(rows) == ["stiffness"] for _, rows in maps):
        return []
    found = []
    others = study_tables.followed(run, [other for other in runs if other is not run])
    stiffness = study_tables.default_stiffness(run)
    if stiffness == stiffness:
        table = study_tables.recommendation(run, stiffness)
        best = table[table["recommended"]]
        if len(best):
            row = best.iloc[0]
            found.append(
                f"Recommended near {stiffness:g} Pa: {row['integrator']} at {row['setting']}; it finishes all "
                f"{row['of']} cases within {100 * study_tables.BOUND:g} % of the energy "
                f"(worst {100 * row['worst_energy_error']:+.2g} %) with {number(int(row['force_evaluations']))} force "
                f"evaluations; {cheap_text(table)}."
            )
        elif len(table):
            whole = table[table["cases"] == table["of"]]
            why = "nobody holds in all of them" if len(whole) else "nobody has all of them"
            found.append(f"Nothing is recommended near {stiffness:g} Pa: of {table['of'].iloc[0]} cases {why}.")
    return found + [follow_text(row) for row in others.itertuples()]


def cheap_text(table):
    cheap, best = (table[table[name]].iloc[0] for name in ("cheapest", "recommended"))
    if cheap["integrator"] == best["integrator"] and cheap["setting"] == best["setting"]:
        return "none that holds is cheaper"
    return (f"{cheap['integrator']} at {cheap['setting']} holds with {number(int(cheap['force_evaluations']))}, the "
            "fewest, and is "
            f"{cheap['energy_error'] / best['energy_error']:.2g} times less accurate")


def went_wrong(run):
    """Extremes of the motion: per sweep what fails with whom, and what the greatest step is that stops a ball."""
    table, told = study_tables.extremes_of_motion(run), {}
    for (sweep, case), mine in table.groupby(["sweep", "case"], sort=False):
        told.setdefault((sweep, outcome(mine)), []).append(case)
    found = []
    for (sweep, text), cases in told.items():
        name = sweep[:1].upper() + sweep[1:].replace("_", " ")
        found.append(f"{name}{'' if cases == ['as it stands'] else ' (' + '; '.join(cases) + ')'}: {text}.")
    plates = study_tables.tunnelling(run)
    for (speed, thickness, stiffness), mine in plates.groupby(["speed", "thickness", "stiffness"], sort=False,
                                                              dropna=False):
        steps = mine["preventing_step"].dropna()
        text = f"A ball at {speed:g} m/s against a plate of {thickness:g} m and {stiffness:g} Pa"
        if steps.empty:
            found.append(f"{text}: no step was found that stops it, with any of {counted(len(mine), 'integrator')}.")
        else:
            low, high = f"{steps.min():.2g}", f"{steps.max():.2g}"
            found.append(f"{text} is stopped by steps of at most {low if low == high else f'{low} to {high}'} s, with "
                         f"{len(steps)} of {counted(len(mine), 'integrator')}.")
    return found


def outcome(rows):
    """How one case went with the integrators that had it."""
    good = study_tables.holds(rows, 0.1)
    if good.all():
        who = f"all {len(rows)} integrators" if len(rows) > 1 else rows["integrator"].iloc[0]
        return f"goes well with {who} (finished, energy within 10 %)"
    words = []
    for status, some in rows[~good].groupby("status", sort=False):
        what = "energy off by more than 10 %" if status == "finished" else (FAILED.get(status) or OTHERWISE)[1]
        names = [row.integrator + (f" (its step is {row.own_step:g} s)" if row.own_step == row.own_step else "")
                 for row in some.itertuples()]
        words.append(f"{what} with {listed(names) if len(some) < len(rows) or len(rows) == 1 else 'all'}")
    return f"goes wrong with {len(rows) - good.sum()} of {counted(len(rows), 'integrator')}: {'; '.join(words)}"


# ---- Answers, drift, scenes -------------------------------------------------------------------------------------


def answers(run):
    """Findings of the extremes of the answers."""
    if getattr(run, "extremes", None) is None:
        return []
    table, found = extremes_figures.totals(extremes_figures.gap_shares(run)), []
    for near, where in ((False, "farther than 1000 ulps from touching"), (True, "within 1000 ulps of touching")):
        if near not in table.index.get_level_values("near_touching"):
            continue
        mine = table.xs(near, level="near_touching")
        said = mine.dropna(subset=["wrong"])
        if said.empty:
            continue
        right = list(said.index[said["wrong"] == 0])
        if right:
            names = [f"{name}{judged(said.loc[name])}" for name in right]
            found.append(f"{listed(names)} {verb(right, 'is', 'are')} never wrong in "
                         f"{counted(int(mine['cases'].max()), 'case')} {where}.")
        wrong = said[said["wrong"] > 0].sort_values("wrong", kind="stable")
        if len(wrong):
            each = [f"{name} {100 * row['wrong']:.2f} %{judged(row)} ({number(int(row['missed']))} missed, "
                    f"{counted(int(row['false positives']), 'false positive')})" for name, row in wrong.iterrows()]
            found.append(f"Wrong {where}: {'; '.join(each)}.")
    shaky = extremes.instability(run)
    total = shaky.groupby("algorithm", observed=True)[["cases", "swapped", "moved", "failed"]].sum()
    for column, what in (("swapped", "with the order of the pair"), ("moved", "when both bodies are moved by an exact "
                                                                              "step")):
        who = total[total[column] > 0]
        if len(who):
            each = [f"{name} {number(int(row[column]))} of {number(int(row['cases']))}" for name, row in who.iterrows()]
            found.append(f"Answers that change {what}: {'; '.join(each)}.")
        elif (total["cases"] > 0).any():
            found.append(f"No answer changes {what}, of {counted(int((total['cases'] > 0).sum()), 'algorithm')}.")
    first = shaky.groupby("algorithm", observed=True)["failure"].first()
    for name, row in total[total["failed"] > 0].iterrows():
        cases = int(row["cases"] + row["failed"])
        found.append(f"{name} fails in {number(int(row['failed']))} of {number(cases)} cases; first: "
                     f"{plain(first[name])}.")
    if not (total["failed"] > 0).any():
        found.append("No algorithm refuses a pair or throws.")
    return found


def judged(row):
    """Of how many cases alone a share is, where an algorithm failed in the others."""
    return f" of the {number(int(row['cases'] - row['failed']))} it answers" if row["failed"] else ""


def drift(run):
    """Findings of a long integrated motion: energy, norms, depth and escapes, as far as they are recorded."""
    if run.physics is None or run.meta["steps"] < 2:
        return []
    table, reached, found = study_tables.drift_steps(run), studies.simulated(run), []
    if table.attrs["status"] != "complete":
        found.append(f"The integration {table.attrs['status'].rstrip('.')}; {reached} of {number(len(table))} steps "
                     "were reached.")
    if reached < 2:
        return found
    seconds = table["time"].iloc[reached - 1]
    change = table["energy_change"].dropna()
    if table.attrs["lossless"] and len(change):
        worst = change.abs().max()
        found.append(f"Nothing gives or takes energy; over {seconds:.4g} s it is off by {100 * worst:.2g} % at most "
                     f"and by {100 * change.iloc[-1]:+.2g} % at the end, "
                     f"{'within' if worst <= studies.SOUND else 'more than'} {100 * studies.SOUND:g} %.")
    if "greatest_penetration" in table and table["greatest_penetration"].notna().any():
        deepest = table["greatest_penetration"].idxmax()
        depth = table["greatest_penetration"][deepest]
        found.append(f"Over {seconds:.4g} s bodies sink into each other by {depth:.3g} m at most, at "
                     f"{table['time'][deepest]:.4g} s." if depth > 0
                     else f"Over {seconds:.4g} s no body sinks into another.")
    more = drift_words(run)
    return found + ([f"{more[:1].upper()}{more[1:]} over {seconds:.4g} s."] if more else [])


def misses(run):
    """Whose misses are whose, of the thesis's nine."""
    return why.who_misses(run) if run.meta["algorithms"] and getattr(run, "extremes", None) is None else []


def algorithms(run):
    """Who errs least and who is quickest in a scene with answers; extremes have findings of their own."""
    table = run.summary
    if not len(table) or getattr(run, "extremes",
                                 None) is not None or not {"error", "time_mean_ns"} <= set(table.columns):
        return []
    told = table.dropna(subset=["error", "time_mean_ns"])
    if len(told) < 2:
        return []
    if not run.truth_hits.sum():
        return ["No two bodies ever meet, so errors say little."]
    least, quick = told.loc[told["error"].idxmin()], told.loc[told["time_mean_ns"].idxmin()]
    even = told[told["error"] == least["error"]]
    least = even.loc[even["time_mean_ns"].idxmin()]
    text = (f"Of {len(told)} labels {least.name} errs least, {least['error']:.3g} at "
            f"{duration(least['time_mean_ns'])} a step; "
            f"{quick.name} is quickest, {quick['error']:.3g} at {duration(quick['time_mean_ns'])}.")
    if least.name == quick.name:
        text = (f"Of {len(told)} labels {least.name} errs least and is quickest: {least['error']:.3g} at "
                f"{duration(least['time_mean_ns'])} a step.")
    times = {label: times for label, times in run.step_times.items() if label in told.index}
    equals = [label for label, mine in times.items() if label != quick.name
              and intervals.alike(intervals.ratio(mine, times[quick.name]), run.noise)]
    if equals and len(places(run)) == 1:
        text += f" {listed(equals)} {verb(equals, 'is', 'are')} as fast as {quick.name}: their times do not differ."
    return [text]
