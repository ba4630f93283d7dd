"""Sections as one HTML page that needs nothing else: no network, no font, no other file."""

import html
import numbers
import re

import numpy as np
import pandas as pd

from analysis.figure import Figure, Points, Table, Text

STYLE = """
:root { --ink: #1a1a1a; --soft: #595959; --line: #d9d9d9; --tint: #f5f6f8; --blue: #0b5394; }
* { box-sizing: border-box; }
html { scroll-padding-top: 1rem; -webkit-text-size-adjust: 100%; }
body { margin: 0 auto; max-width: 58rem; padding: 1.2rem 1rem 4rem; color: var(--ink); background: #fff;
  font: 1rem/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "DejaVu Sans", sans-serif; }
h1 { font-size: 1.75rem; line-height: 1.2; margin: .4rem 0 .3rem; }
h2 { font-size: 1.35rem; margin: 3rem 0 .8rem; padding-bottom: .25rem; border-bottom: 2px solid var(--ink); }
h3 { font-size: 1.06rem; line-height: 1.4; margin: 0 0 .6rem; }
p { margin: .7rem 0; max-width: 46rem; }
a { color: var(--blue); }
.skip { position: absolute; left: -99rem; } .skip:focus { left: 1rem; }
.lead { color: var(--soft); }
nav ol { list-style: none; display: flex; flex-wrap: wrap; gap: .3rem 1.1rem; margin: .8rem 0; padding: .6rem 0;
  border: solid var(--line); border-width: 1px 0; font-size: .94rem; }
.warnings { border: 1px solid #b45f06; border-left-width: .4rem; background: #fff8ee; padding: .7rem 1rem; margin: 1.2rem 0;
  overflow-wrap: anywhere; }
.warnings h2 { font-size: 1rem; margin: 0 0 .3rem; border: 0; padding: 0; } .warnings ul { margin: 0; padding-left: 1.1rem; }
.points ul { margin: .3rem 0 1.4rem; padding-left: 1.1rem; max-width: 46rem; overflow-wrap: anywhere; } .points li { margin: .35rem 0; }
figure, .table { margin: 1.6rem 0 2.4rem; }
.picture { max-width: 42rem; } .picture svg { display: block; width: 100%; height: auto; }
.picture svg text { white-space: pre; }
figcaption, .caption { color: var(--soft); font-size: .86rem; line-height: 1.45; margin: .5rem 0; max-width: 46rem;
  overflow-wrap: anywhere; }
details { margin: .5rem 0; } summary { cursor: pointer; color: var(--blue); font-size: .92rem; width: fit-content; padding: .15rem 0; }
.scroll { overflow: auto; border: 1px solid var(--line); position: relative; }
.tall { max-height: 34rem; }
.scroll:focus-visible, summary:focus-visible, button:focus-visible { outline: 3px solid var(--blue); outline-offset: 1px; }
table { border-collapse: separate; border-spacing: 0; font-size: .84rem; line-height: 1.35; font-variant-numeric: tabular-nums; min-width: 100%; }
th, td { padding: .28rem .6rem; text-align: left; vertical-align: top; border-bottom: 1px solid #ececec; background: #fff; }
td.n, th.n { text-align: right; white-space: nowrap; }
td.s { white-space: nowrap; } thead th.n { white-space: normal; }
td.long { min-width: 15rem; overflow-wrap: anywhere; }
thead th { position: sticky; top: 0; z-index: 2; background: var(--tint); border-bottom: 1px solid #bbb; vertical-align: bottom; }
tbody th { position: sticky; left: 0; z-index: 1; font-weight: 600; border-right: 1px solid var(--line); }
tbody th.long { min-width: 9.5rem; overflow-wrap: anywhere; }
thead th:first-child { left: 0; z-index: 3; border-right: 1px solid var(--line); }
tbody tr:hover > * { background: #f0f5fb; }
th button { all: unset; cursor: pointer; font-weight: 600; }
th button::after { content: "\\2195"; color: #8a8a8a; padding-left: .25em; font-size: .85em; }
th[aria-sort="ascending"] button::after { content: "\\2191"; color: var(--ink); }
th[aria-sort="descending"] button::after { content: "\\2193"; color: var(--ink); }
td.bar { background: linear-gradient(90deg, #cfe2f3 var(--v), #fff var(--v)); }
pre { font-size: .8rem; line-height: 1.4; background: var(--tint); padding: .7rem .9rem; margin: 0; white-space: pre-wrap; overflow-wrap: anywhere; }
footer { margin-top: 4rem; padding-top: .7rem; border-top: 1px solid var(--line); color: var(--soft); font-size: .86rem; }
@media (max-width: 36rem) {
  body { padding: .8rem .75rem 3rem; } h1 { font-size: 1.4rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; }
  .picture { margin: 0 -.5rem; } th, td { padding: .25rem .45rem; }
  td.long { min-width: 12rem; }
}
@media print {
  @page { margin: 14mm; }
  body { max-width: none; padding: 0; font-size: 9.5pt; } nav, .skip { display: none; } a { color: inherit; text-decoration: none; }
  .scroll, .tall { overflow: visible; max-height: none; border: 0; } thead th, tbody th { position: static; }
  table { font-size: 6.8pt; min-width: 0; } th, td { padding: .12rem .3rem; } td.long { min-width: 0; } td.s { white-space: normal; }
  th button::after { content: none; }
  figure h3, h2, h3, .table h3 { break-after: avoid; } .picture, tr, h3, .warnings { break-inside: avoid; } .picture { max-width: 15cm; }
  details:not(.text)::details-content { content-visibility: visible; height: auto; } summary { color: var(--soft); list-style: none; }
  td.bar { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
"""

SCRIPT = """
// Tables are sorted by a column when its head is pressed; folded numbers are opened for printing.
const value = cell => { const text = cell.textContent.replace(/[\\u202f\\s]/g, ""), n = parseFloat(text);
  return text === "\\u2013" ? Infinity : isNaN(n) ? text : n; };
for (const button of document.querySelectorAll("th button")) button.addEventListener("click", () => {
  const head = button.parentElement, column = head.cellIndex, body = head.closest("table").tBodies[0];
  const up = head.getAttribute("aria-sort") !== "ascending", rows = [...body.rows];
  const keys = new Map(rows.map(row => [row, value(row.cells[column])]));
  const order = (a, b) => typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === "number" ? -1 : 1;
  rows.sort((a, b) => (up ? 1 : -1) * order(keys.get(a), keys.get(b)));
  for (const other of head.parentElement.cells) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", up ? "ascending" : "descending");
  body.append(...rows);
});
let folded = [];
addEventListener("beforeprint", () => { folded = [...document.querySelectorAll("details:not([open], .text)")]; folded.forEach(d => d.open = true); });
addEventListener("afterprint", () => folded.forEach(d => d.open = false));
"""

LONG = 40  # characters: texts that are given room to be read in lines
SHORT = 26  # characters: texts that do not break
LONG_HEAD = 28  # characters: heads of rows that may break
TALL = 60  # rows: longer tables scroll within themselves


def page(title, lead, warnings, sections):
    """The whole document. lead, warnings: lists of plain texts; sections: Section, in order; the same input gives the same bytes."""
    bodies = [(slug(section.title), section) for section in sections]
    links = "".join(f'<li><a href="#{key}">{html.escape(section.title)}</a></li>' for key, section in bodies)
    return "\n".join(
        [
            '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{html.escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>",
            '<a class="skip" href="#content">To the content</a>',
            f'<header><h1>{html.escape(title)}</h1>',
            *(f'<p class="lead">{html.escape(text)}</p>' for text in lead),
            f'<nav aria-label="Sections"><ol>{links}</ol></nav></header>',
            '<main id="content">',
            _warnings(warnings),
            *(_section(key, section) for key, section in bodies),
            "</main>",
            "<footer>Made by python3 -m analysis report from result files alone; every figure's numbers are below it.</footer>",
            f"<script>{SCRIPT}</script>\n</body>\n</html>\n",
        ]
    )


def slug(text):
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "section"


def _warnings(warnings):
    if not warnings:
        return ""
    items = "".join(f"<li>{html.escape(text)}</li>" for text in warnings)
    return f'<section class="warnings" aria-labelledby="warnings"><h2 id="warnings">Mind this</h2><ul>{items}</ul></section>'


def _section(key, section):
    parts = "\n".join(_part(part) for part in section.parts)
    return f'<section aria-labelledby="{key}"><h2 id="{key}">{html.escape(section.title)}</h2>\n{parts}\n</section>'


def _part(part):
    if isinstance(part, Figure):
        title = html.escape(part.title.removesuffix("."))
        return (
            f'<figure id="{html.escape(part.key)}"><h3>{title}</h3>\n'
            f'<div class="picture" role="img" aria-label="{title}">{part.svg}</div>\n'
            f"<figcaption>{html.escape(part.caption)}</figcaption>\n"
            f"<details><summary>The numbers ({len(part.table)} rows)</summary>{table(part.table, part.title)}</details></figure>"
        )
    if isinstance(part, Points):
        items = "".join(f"<li>{html.escape(text)}</li>" for text in part.items)
        return f'<div class="points"><h3>{html.escape(part.title)}</h3>\n<ul>{items}</ul></div>'
    if isinstance(part, Table):
        return (
            f'<div class="table"><h3>{html.escape(part.title)}</h3>\n{table(part.frame, part.title)}\n'
            f'<p class="caption">{html.escape(part.caption)}</p></div>'
        )
    if isinstance(part, Text):
        return f"<details class=text><summary>{html.escape(part.title)}</summary><pre>{html.escape(part.text)}</pre></details>"
    return f"<p>{html.escape(part)}</p>"


def table(frame, title):
    """A DataFrame as a table that scrolls within itself. The row's head is the index, or the first column when rows are
    only numbered."""
    if isinstance(frame.index, pd.RangeIndex) and len(frame.columns):
        frame = frame.set_index(frame.columns[0], drop=True)
    frame = frame.reset_index() if isinstance(frame.index, pd.MultiIndex) else frame
    numeric = [pd.api.types.is_numeric_dtype(frame.dtypes.iloc[c]) and frame.dtypes.iloc[c] != bool for c in range(frame.shape[1])]
    sortable = len(frame) > 2
    heads = [_head(frame.index.name or "", sortable, False)]
    heads += [_head(column, sortable, right) for column, right in zip(frame.columns, numeric)]
    columns = [_cells(frame.iloc[:, c], right) for c, right in enumerate(numeric)]
    rows = []
    for index, *cells in zip(frame.index, *columns):
        cells = "".join(cells)
        head = shown(index)
        rows.append(f'<tr><th scope="row"{" class=long" if len(head) > LONG_HEAD else ""}>{head}</th>{cells}</tr>')
    return (
        f'<div class="scroll{" tall" if len(frame) > TALL else ""}" tabindex="0" role="region" aria-label="{html.escape(title)}: table"><table>'
        f"<thead><tr>{''.join(heads)}</tr></thead>\n<tbody>" + "\n".join(rows) + "</tbody></table></div>"
    )


def _head(name, sortable, right):
    text = html.escape(" ".join(map(str, name)) if isinstance(name, tuple) else str(name))
    inner = f'<button type="button">{text}</button>' if sortable and text else text
    return f'<th scope="col"{" class=n" if right else ""}>{inner}</th>'


def _cells(values, right):
    """The cells of a column. Fractions of one size get the same number of decimals, so that they can be compared."""
    if not right:
        texts = [shown(value) for value in values]
        return [f"<td{_width(text)}>{text}</td>" for text in texts]
    if values.name == "error" and values.between(0, 1).all():
        return [f'<td class="n bar" style="--v:{value * 100:.0f}%">{value:.4f}</td>' for value in values]
    size = values.abs()[(values != 0) & values.notna()].astype(float)
    size = size[np.isfinite(size)]
    decimals = None
    if pd.api.types.is_float_dtype(values.dtype) and len(size) and size.max() < 2000 * size.min():
        decimals = int(np.clip(2 - np.floor(np.log10(size.min())), 0, 6))
    return [f"<td class=n>{shown(value, decimals)}</td>" for value in values]


def _width(text):
    return " class=long" if len(text) > LONG else " class=s" if len(text) < SHORT else ""


def shown(value, decimals=None):
    """A cell's text, escaped: four digits or so many decimals, whole numbers in full with narrow spaces, a dash for what is
    not a number."""
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, numbers.Integral):
        return f"{value:,}".replace(",", "\u202f") if abs(value) >= 10000 else str(value)
    if isinstance(value, numbers.Real):
        if not np.isfinite(value):
            return "–" if np.isnan(value) else ("∞" if value > 0 else "−∞")
        if decimals is not None:
            return f"{value:,.{decimals}f}".replace(",", "\u202f" if abs(value) >= 9999.5 else "")
        if abs(value) >= 9999.5 and abs(value) < 1e15:
            return f"{value:,.0f}".replace(",", "\u202f")
        return f"{value:.4g}"
    if value is None or value is pd.NaT or value is pd.NA:
        return "–"
    return html.escape(str(value))
