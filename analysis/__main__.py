"""scripts/analysis: what the results say, printed or as a page.

Exit codes as the pipeline's: 0 done, 1 the program failed, 2 the command line's grammar, 3 a value that does not fit
the file, 4 a file that is missing, not a result or cannot be written.
"""

import argparse
import sys

from analysis import scenes, study_tables, viewer
from analysis.load import load
from analysis.output import refuse, write
from analysis.statements import shown, verdicts

KINDS = ("box", "falling", "playground")


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="scripts/analysis", description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    command = commands.add_parser("statements", help="judge the thesis's statements on results")
    command.add_argument("file", nargs="+", help="results of the box, falling and playground scenes, one of each")
    command.set_defaults(act=lambda chosen: print(table(verdicts(opened(chosen.file)))))
    command = commands.add_parser("report", help="one HTML page of figures and tables, which needs no network")
    command.add_argument("file", nargs="+", help="results; those of one motion and truth are drawn together")
    command.add_argument("-o", "--output", default="report.html", help="the page (default: report.html)")
    command.set_defaults(act=lambda chosen: write_report(chosen.file, chosen.output))
    command = commands.add_parser("study", help="orders, stability and recommendation of a study; drift of a long run")
    command.add_argument("file", help="result of a study of integrators, or of an integrated scene")
    command.set_defaults(act=lambda chosen: print(studied(chosen.file)))
    viewer.add_command(commands)
    chosen = parser.parse_args(arguments)
    try:
        chosen.act(chosen)
    except viewer.Unfit as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        return error.code
    except (OSError, KeyError, ValueError, RuntimeError) as error:
        text = error.args[0] if isinstance(error, KeyError) and error.args else error
        print(" ".join(str(text).split()), file=sys.stderr)
        return 4
    return 0


def write_report(paths, output):
    """The page of the results at `paths`, whole or not at all; prints where it is. Only a page is overwritten."""
    refuse(output)  # before the work
    runs = [read(path) for path in paths]
    from analysis.report import report  # matplotlib is slow to load, and nothing above needs it

    write(output, report(runs))
    print(output)


def studied(path):
    """What the study or the long motion at `path` says. Raises as read()."""
    run = read(path)
    try:
        return study_tables.text(run)
    except KeyError as error:  # a column
        raise OSError(f"{path}: is damaged ({error})") from error


def read(path):
    """The result at `path`, its tables read, so that damage is found here; raises as load() does."""
    run = load(path)
    try:
        run.summary, run.per_step, run.physics, run.truth_hits, run.extremes, run.study
    except (OSError, KeyError, ValueError, RuntimeError) as error:
        text = str(error.args[0] if error.args else error)
        raise OSError(text if text.startswith(path) else f"{path}: is damaged ({text})") from error
    return run


def opened(paths):
    """kind of scene -> what the statements ask of it. Raises OSError or ValueError, which name the file."""
    found = {}
    for path in paths:
        try:
            run = load(path)
            kind = scenes.kind(run)
            if kind not in KINDS:
                raise ValueError(f"is of a {kind or 'study, not a'} scene; the statements are about {', '.join(KINDS)}")
            if kind in found:
                raise ValueError(f"is a second file of a {kind} scene")
            found[kind] = scenes.playground(run) if kind == "playground" else scenes.timed(run)
        except (OSError, KeyError, ValueError) as error:
            message = str(error)
            raise ValueError(message if message.startswith(path) else f"{path}: {message}") from error
    return found


def table(found):
    """Number, verdict, figures and statement, one line each."""
    rows = [("no.", "verdict", "figures", "statement")]
    for verdict in found:
        word, _, why = verdict.verdict.partition(": ")  # why: only of what is not testable
        figures = "; ".join(f"{name} {shown(value)}" for name, value in verdict.figures.items())
        rows.append((f"{verdict.number} {verdict.variant}".strip(), word, figures or why, verdict.text))
    widths = [max(len(row[column]) for row in rows) for column in range(3)]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths + [0])).rstrip() for row in rows)


if __name__ == "__main__":
    sys.exit(main())
