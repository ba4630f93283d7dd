"""The report's answer to "Which one should I take?"."""

from ..figures.figure import Points, Section, Table
from ..tables import choice
from ..words import counted, listed, number, verb

READING = (
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
    parts += [Points(scene.title, sentences(scene.points)) for scene in scenes]
    return Section("Which one should I take?", [READING, *parts]) if parts else None


def sentences(points):
    """The answers of one scene."""
    steps = [f"from {number(row.time_mean_ns / 1e3)} µs a step on {row.label} errs least, "
             f"{_error(row.error)}{_as_good(others)}" for row, others in choice.front(points)]
    said = [f"By time: {listed(steps)}."]
    answers = {}
    for words, limits in choice.ALLOWED.items():
        found = choice.fastest(points, *limits)
        if found is None:
            answer = f"none of {counted(len(choice.timed(points)), 'label')}"
        else:
            row, others = found
            answer = f"{row.label} is the fastest, {number(row.time_mean_ns / 1e3)} µs a step{_as_good(others)}"
        answers.setdefault(answer, []).append(words)
    return said + [f"With {_either(words)}: {answer}." for answer, words in answers.items()]


def _either(words):
    """error at most 0.1, error at most 0.01 or no error: what has one answer."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"


def together(found):
    """Over all scenes: a setting counts by its worst error, and by the geometric mean of its times."""
    answers = {}
    for words, limits in choice.ALLOWED.items():
        best = choice.best(found, *limits)
        if best is None:
            answers.setdefault(f"none of {counted(len(found.frame), 'setting')}", []).append(words)
            continue
        row, others, alone = best
        unlike = ""
        if alone:
            unlike = f"; but by one scene alone: without {' or '.join(alone)} another is faster"
        ratio = "" if row.label == found.reference else f", {number(row.time)} times {found.reference}"
        answers.setdefault(f"{row.label} is the fastest{ratio}{_as_good(others)}{unlike}", []).append(words)
    said = [f"With {_either(words)} in every scene: {answer}." for answer, words in answers.items()]
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
