"""scripts/analysis: what the results say, printed or as a page.

Exit codes as the pipeline's: 0 done, 1 the program failed, 2 the command line's grammar, 3 a value that does not fit
the file, 4 a file that is missing, not a result or cannot be written.
"""

import argparse
import contextlib
import os
import sys
import warnings

from .tables import scenes, study_tables
from .viewer import viewer
from .intact import Unvouched
from .load import SWEEP, load, load_sweep
from .output import complain, open_standard_descriptors, refuse, say, write
from .tables.clauses import shown
from .tables.statements import PUBLISHED, verdicts

KINDS = ("box", "falling", "playground")


def main(arguments=None):
    open_standard_descriptors()
    parser = argparse.ArgumentParser(prog="scripts/analysis", description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    command = commands.add_parser("statements", help="judge the thesis's statements on results")
    command.add_argument("file", nargs="+", help="results of the box, falling and playground scenes, one of each")
    command.set_defaults(act=lambda chosen: say(table(verdicts(opened(chosen.file, chosen.unsealed)))))
    command = commands.add_parser("report", help="one HTML page of figures and tables, which needs no network")
    words = "results; those of one motion and truth are drawn together. Or a sweep: its folder, or files of its points"
    command.add_argument("file", nargs="+", help=words)
    command.add_argument("-o", "--output", default="report.html", help="the page (default: report.html)")
    command.add_argument("--figures", metavar="DIR", help="also each figure as SVG, PNG and CSV, named by its anchor")
    command.set_defaults(act=lambda chosen: write_report(chosen.file, chosen.output, chosen.unsealed, chosen.figures))
    command = commands.add_parser("study", help="orders, stability and recommendation of a study; drift of a long run")
    command.add_argument("file", help="result of a study of integrators, or of an integrated scene")
    command.set_defaults(act=lambda chosen: say(studied(chosen.file, chosen.unsealed)))
    viewer.add_command(commands)
    for command in commands.choices.values():
        command.add_argument("--unsealed", action="store_true", help="read results although they were changed since "
                                                                     "they were written, as by own datasets; digests "
                                                                     "still hold")
    chosen = parser.parse_args(arguments)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", Unvouched)
            warnings.showwarning = lambda message, *where: complain(f"warning: {message}")
            chosen.act(chosen)
    except viewer.Unfit as error:
        complain(error)
        return error.code
    except (OSError, KeyError, ValueError, RuntimeError) as error:
        complain(error.args[0] if isinstance(error, KeyError) and error.args else error)
        return 4
    return 0


def write_report(paths, output, unsealed=False, figures=None):
    """The page of the results at `paths`, whole or not at all; prints where it is. Only a page is overwritten. figures:
    the folder for its figures as files."""
    refuse(output)  # before the work
    if figures and os.path.lexists(figures) and not os.path.isdir(figures):
        raise NotADirectoryError(f"{figures}: exists and is no folder; --figures names one")
    table = swept(paths)
    runs = [] if table is not None else [read(path, unsealed) for path in paths]
    from .figures.figure import with_png  # matplotlib is slow to load, and nothing above needs it
    from .report import report

    with with_png() if figures else contextlib.nullcontext():
        made = report.parts_of(runs) if table is None else report.sweep_parts(table)
    write(output, report.page(*made))
    say(output)
    if figures:
        say(f"{figures}: {report.write_figures(made[-1], figures)} figures")


def swept(paths):
    """The frame of the sweep that `paths` name: its folder alone, or several files of its points; None when they are
    other results. Raises as load_sweep()."""
    if len(paths) == 1 and os.path.exists(os.path.join(paths[0], SWEEP)):
        return load_sweep(paths[0])
    for path in paths:
        if os.path.exists(os.path.join(path, SWEEP)):
            raise ValueError(f"{path}: is the folder of a sweep; a report on it has no other files")
    folders = {os.path.dirname(os.path.abspath(path)) for path in paths}
    above = os.path.dirname(min(folders))
    if len(paths) < 2 or len(folders) > 1 or not os.path.exists(os.path.join(above, SWEEP)):
        return None
    table = load_sweep(above)
    names = [os.path.splitext(os.path.basename(path))[0] for path in paths]
    return table[table.point.isin(names)].reset_index(drop=True) if set(names) <= set(table.point) else None


def studied(path, unsealed=False):
    """What the study or the long motion at `path` says. Raises as read()."""
    run = read(path, unsealed)
    try:
        return study_tables.text(run)
    except KeyError as error:  # a column
        raise OSError(f"{path}: is damaged ({error})") from error


def read(path, unsealed=False):
    """The result at `path`, its tables read, so that damage is found here; raises as load() does."""
    run = load(path, unsealed)
    try:
        run.summary, run.per_step, run.physics, run.truth_hits, run.extremes, run.study
    except (OSError, KeyError, ValueError, RuntimeError) as error:
        text = str(error.args[0] if error.args else error)
        raise OSError(text if text.startswith(path) else f"{path}: is damaged ({text})") from error
    return run


def opened(paths, unsealed=False):
    """kind of scene -> what the statements ask of it. Raises OSError or ValueError, which name the file."""
    found, runs = {}, []
    for path in paths:
        try:
            runs.append((path, load(path, unsealed).completed()))
        except (OSError, KeyError, ValueError) as error:
            raise ValueError(named(path, error)) from error
    beside = scenes.companions([run for _, run in runs])
    for path, run in runs:
        try:
            kind = scenes.thesis_kind(run)
            if kind not in KINDS:
                other = scenes.kind(run)
                other = f"{other} scene that the thesis does not have" if other else "study, not a scene"
                raise ValueError(f"is of a {f'{kind} scene' if kind else other}; the statements are about "
                                 f"{', '.join(KINDS)}")
            name = kind + PUBLISHED if beside.get(kind) is run else kind
            if name in found:
                raise ValueError(f"is a second file of a {kind} scene")
            found[name] = scenes.playground(run) if kind == "playground" else scenes.timed(run)
        except (OSError, KeyError, ValueError) as error:
            raise ValueError(named(path, error)) from error
    return found


def named(path, error):
    message = str(error)
    return message if message.startswith(path) else f"{path}: {message}"


def table(found):
    """Number, verdict and statement, a line each; below it a line a clause, what failed marked; and the cause."""
    lines = []
    for verdict in found:
        word, _, why = verdict.verdict.partition(": ")  # why: only of what is not testable
        near = " (near miss)" if verdict.near else ""
        head = f"{verdict.number} {verdict.variant}".strip()
        lines.append(f"{head}  {word}{near}: {verdict.text} [thesis {verdict.section}]")
        if why:
            lines.append(f"    {why}")
        for each in verdict.clauses:
            needed = f", needed {each.needed}" if each.needed else ""
            fails = "" if each.holds is not False else "  <- near miss" if each.near else "  <- fails"
            lines.append(f"    {each.what}: {shown(each.measured)}{needed}{fails}")
        if verdict.cause:
            lines.append(f"    why: {verdict.cause}")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
