"""python3 -m analysis: what the results say, printed.

Exit codes as the pipeline's: 0 done, 2 the command line's grammar, 4 a file that is missing or not a result.
"""

import argparse
import sys

from analysis import scenes, studies
from analysis.load import load
from analysis.statements import verdicts

KINDS = ("box", "falling", "playground")


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python3 -m analysis", description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    command = commands.add_parser("statements", help="judge the thesis's statements on results")
    command.add_argument("file", nargs="+", help="results of the box, falling and playground scenes, one of each")
    command = commands.add_parser("study", help="orders, stability and recommendation of a study; drift of a long run")
    command.add_argument("file", help="result of a study of integrators, or of an integrated scene")
    chosen = parser.parse_args(arguments)
    try:
        if chosen.command == "study":
            print(studies.text(load(chosen.file)))
        else:
            print(table(verdicts(opened(chosen.file))))
    except (OSError, KeyError, ValueError) as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        return 4
    return 0


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


def shown(value):
    """A figure: three digits, whole numbers in full."""
    if not isinstance(value, float):
        return str(value)
    return f"{value:.0f}" if 1000 <= abs(value) < 1e15 else f"{value:.3g}"


if __name__ == "__main__":
    sys.exit(main())
