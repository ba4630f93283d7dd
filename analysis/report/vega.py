"""Vega, which draws the figures that answer to the pointer, as one script to be put into a page.

Debian's libjs-vega: one apt package that scripts/setup installs, no second registry, no bundler. It has Vega's modules
one
by one; those below are all that a figure with axes, marks and signals needs, 450 KB. Chosen among what is well kept:
its
SVG marks carry roles and names for screen readers, Plotly is 3.5 MB and ECharts 1 MB. Without the package the page has
its static figures alone.
"""

import pathlib

FOLDER = pathlib.Path("/usr/share/javascript/vega")
MODULES = (
    "util", "time", "format", "loader", "dataflow", "statistics", "transforms", "canvas", "scale", "scenegraph",
    "view-transforms", "encode", "expression", "selection", "functions", "runtime", "view", "event-selector", "parser",
)  # fmt: skip
LICENCE = "Vega 5.22 (vega.github.io), BSD 3-Clause, Copyright University of Washington Interactive Data Lab"

# A module takes what it needs through require(), as in Node.
HEAD = "/* {licence} */\nconst vega=(()=>{{const found={{}},need=name=>found[name.replace('selections','selection')];\n"
PART = "(()=>{{const exports=found['vega-{name}']={{}},module={{exports}},require=need;\n{source}\n}})();\n"
TAIL = (
    "const flow=found['vega-dataflow'];for(const name of ['transforms','view-transforms','encode'])"
    "Object.assign(flow.transforms,found['vega-'+name]);\n"
    "return{View:found['vega-view'].View,parse:found['vega-parser'].parse}})();\n"
)


def script():
    """The script that defines `vega` with View and parse; "" where the package is not installed or could not stand in a
    page."""
    try:
        sources = [(name, (FOLDER / f"vega-{name}.min.js").read_text(encoding="utf-8")) for name in MODULES]
    except OSError:
        return ""
    parts = [PART.format(name=name, source=_bare(source)) for name, source in sources]
    text = HEAD.format(licence=LICENCE) + "".join(parts) + TAIL
    return "" if "</script" in text.lower() or "<!--" in text else text


def _bare(source):
    """Without the note where a debugger finds the source."""
    return "\n".join(line for line in source.splitlines() if not line.startswith("//# sourceMappingURL"))
