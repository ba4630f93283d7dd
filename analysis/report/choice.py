"""The report's answer to "Which one should I take?"."""

from ..figures.figure import Points, Section, Table
from ..tables import choice
from ..words import counted, listed, number, verb

CAPTION = (
    "Whoever can spend that much time a step takes this label, whoever allows that much error takes that one. “As"
    " fast” are labels whose times cannot be told apart: the 95 % interval of their ratio, from the same steps, holds 1"
    " or lies within the noise floor. Asked are all labels that one machine and build timed, filters and knobs"
    " included."
)


def section(scenes):
    """None when no scene has two labels that compare."""
    scenes = [scene for scene in scenes if len(choice.timed(scene.points)) > 1]
    parts = []
    found = choice.together(scenes) if len(scenes) > 1 else None
    if found is not None:
        parts += together(found)
    for scene in scenes:
        parts += [Points(scene.title, sentences(scene.points)), Table(scene.title, choice.table(scene.points), CAPTION)]
    return Section("Which one should I take?", parts) if parts else None


def sentences(points):
    """The answers of one scene."""
    steps = [f"from {number(row.time_mean_ns / 1e3)} µs a step on {row.label} errs least, "
             f"{_error(row.error)}{_as_good(others)}" for row, others in choice.front(points)]
    said = [f"By time: {listed(steps)}."]
    for words, limits in choice.ALLOWED.items():
        found = choice.fastest(points, *limits)
        if found is None:
            said.append(f"With {words}: none of {counted(len(choice.timed(points)), 'label')}.")
        else:
            row, others = found
            said.append(f"With {words}: {row.label} is the fastest, {number(row.time_mean_ns / 1e3)} µs a step"
                        f"{_as_good(others)}.")
    return said


def together(found):
    """Over all scenes: a setting counts by its worst error, and by the geometric mean of its times."""
    said = []
    for words, limits in choice.ALLOWED.items():
        best = choice.best(found, *limits)
        if best is None:
            said.append(f"With {words} in every scene: none of {counted(len(found.frame), 'setting')}.")
            continue
        row, others, alone = best
        unlike = ""
        if alone:
            unlike = f"; but by one scene alone: without {' or '.join(alone)} another is faster"
        ratio = "" if row.label == found.reference else f", {number(row.time)} times {found.reference}"
        said.append(f"With {words} in every scene: {row.label} is the fastest{ratio}{_as_good(others)}{unlike}.")
    worth = set(choice.front_together(found).label)
    frame = found.frame.drop(columns="setting").rename(columns={
        "worst_error": "worst error", "where": "in", "false_negative": "false negatives",
        "time": f"time over {found.reference}", "low": "from", "high": "to", "slowest": "at most"})
    frame["on the front"] = found.frame.label.isin(worth)
    caption = (
        f"{counted(len(frame), 'setting')} that answered in all of {counted(len(found.titles), 'scene')}:"
        f" {listed(found.titles)}. Times are over those of {found.reference} in the same steps: the geometric mean over"
        " the scenes, its 95 % interval, the greatest of them. Front: of worst error and that mean. So no scene decides"
        " alone."
    )
    return [Points("Over all scenes", said), Table("Over all scenes", frame, caption)]


def _error(error):
    return "without an error" if error == 0 else number(error)


def _as_good(others):
    return f" ({listed(others)} {verb(others, 'is', 'are')} as fast)" if others else ""
