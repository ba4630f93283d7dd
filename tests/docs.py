#!/usr/bin/env python3
"""The tables of the pages that the program itself knows: tests/docs.py prints those that differ, --write mends them.

A table stands between `<!-- NAME -->` and `<!-- end -->`; NAME is what `pipeline list NAME` lists, or `plugins`: those
of the algorithms that answer from plug-ins of other people's libraries, of which a build may be without.
"""

import json
import re
import subprocess
import sys

from program import PIPELINE, ROOT

PAGES = ["algorithms/README.md", "configs/README.md", "pipeline/FILE.md"]
PLACE = re.compile(r"(<!-- (\w+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def rows_of(what):
    return json.loads(subprocess.run([PIPELINE, "list", what, "--json"], capture_output=True, text=True,
                                     check=True).stdout)


def own_rows():
    """The algorithms that do not depend on which plug-ins a build has."""
    return [row for row in rows_of("algorithms") if not (row["library"] or {}).get("tests")]


def cell(text):
    return str(text).replace("|", "\\|")


def knob(one):
    preset = one["preset"]
    shown = str(preset).lower() if isinstance(preset, bool) else preset
    return f"`{one['name']}` ({shown})"


def short(text):
    """A long list, its middle left out."""
    return text if len(text) <= 90 else f"{text[:60].rsplit(',', 1)[0]}, …{text[-20:][text[-20:].find(',') + 1 :]}"


def table(what):
    """The list as a Markdown table."""
    if what == "algorithms":
        lines = ["| name | key | what | promise | scope | operations | knobs (preset) |",
                 "|---|---|---|---|---|---|---|"]
        for row in own_rows():
            cells = [f"`{row['name']}`", row["thesis_key"], row["what"], row["promise"], row["scope"],
                     row["operations_unit"], ", ".join(map(knob, row["knobs"]))]
            lines.append("| " + " | ".join(map(cell, cells)) + " |")
    elif what == "plugins":
        lines = ["| name | what | takes bodies for | precision | package | licence |", "|---|---|---|---|---|---|"]
        for row in rows_of("algorithms"):
            if row not in own_rows():
                library = row["library"]
                cells = [f"`{row['name']}`", row["what"], library["tests"], row["precision"], f"`{library['package']}`",
                         library["licence"]]
                lines.append("| " + " | ".join(map(cell, cells)) + " |")
    elif what == "keys":
        lines = ["| key | preset | unit | must be | what | in |", "|---|---|---|---|---|---|"]
        for row in rows_of(what):
            preset = f"`{short(row['preset'])}`" if row["preset"] is not None else ""
            unit = "" if row["unit"] == "1" else row["unit"]
            cells = [f"`{row['name']}`", preset, unit, short(row["rule"]), row["what"], row["where"]]
            lines.append("| " + " | ".join(map(cell, cells)) + " |")
    elif what == "datasets":
        lines = ["| dataset | shape | type | unit | what | present |", "|---|---|---|---|---|---|"]
        for row in rows_of(what):
            cells = [f"`{row['name']}`", row["shape"], row["type"], row["unit"], row["what"], row["when"]]
            lines.append("| " + " | ".join(map(cell, cells)) + " |")
    else:
        lines = [f"| {what[:-1]} | what |", "|---|---|"]
        lines += [f"| `{row['name']}` | {cell(row['what'])} |" for row in rows_of(what)]
    return "\n".join(lines) + "\n"


def fresh(page):
    """The page as it should be."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return PLACE.sub(lambda found: found[1] + table(found[2]) + found[4], text)


def main(write):
    differ = [page for page in PAGES if fresh(page) != (ROOT / page).read_text(encoding="utf-8")]
    for page in differ:
        print(page)
        if write:
            (ROOT / page).write_text(fresh(page), encoding="utf-8")
    return 1 if differ and not write else 0


if __name__ == "__main__":
    sys.exit(main("--write" in sys.argv))
