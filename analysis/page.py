"""Sections as one HTML page that needs nothing else: no network, no font, no other file."""

import html
import numbers
import pathlib
import re

import numpy as np
import pandas as pd

from analysis.figure import Figure, Points, Table, Text

LONG = 40  # characters: texts that are given room to be read in lines
SHORT = 26  # characters: texts that do not break
LONG_HEAD = 28  # characters: heads of rows that may break
TALL = 60  # rows: longer tables scroll within themselves
SMALL = 9  # points: a picture with smaller text is not shrunk to a phone's width, it scrolls within itself


def page(title, lead, warnings, sections):
    """The whole document; the same input gives the same bytes.

    lead, warnings: lists of plain texts; sections: Section, in their order.
    """
    bodies, used = [], {}
    for section in sections:
        key = slug(section.title)
        used[key] = used.get(key, 0) + 1
        bodies.append((key if used[key] == 1 else f"{key}-{used[key]}", section))
    links = "".join(f'<li><a href="#{key}">{html.escape(section.title)}</a></li>' for key, section in bodies)
    return "\n".join(
        [
            '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{html.escape(title)}</title>\n<style>\n{_beside('page.css')}</style>\n</head>\n<body>",
            '<a class="skip" href="#content">To the content</a>',
            f"<header><h1>{html.escape(title)}</h1>",
            *(f'<p class="lead">{html.escape(text)}</p>' for text in lead),
            f'<nav aria-label="Sections"><ol>{links}</ol></nav></header>',
            '<main id="content">',
            _warnings(warnings),
            *(_section(key, section) for key, section in bodies),
            "</main>",
            (
                "<footer>Made by scripts/analysis report from result files alone; every figure's numbers are below"
                " it.</footer>"
            ),
            f"<script>\n{_beside('page.js')}</script>\n</body>\n</html>\n",
        ]
    )


def _beside(name):
    return pathlib.Path(__file__).with_name(name).read_text(encoding="utf-8")


def slug(text):
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "section"


def _warnings(warnings):
    if not warnings:
        return ""
    items = "".join(f"<li>{html.escape(text)}</li>" for text in warnings)
    head = '<section class="warnings" aria-labelledby="warnings"><h2 id="warnings">Mind this</h2>'
    return f"{head}<ul>{items}</ul></section>"


def _section(key, section):
    parts = "\n".join(_part(part) for part in section.parts)
    return f'<section aria-labelledby="{key}"><h2 id="{key}">{html.escape(section.title)}</h2>\n{parts}\n</section>'


def _part(part):
    if isinstance(part, Figure):
        title = html.escape(part.title.removesuffix("."))
        rows, count = table(part.table, part.title), len(part.table)
        kind = "picture dense" if dense(part.svg) else "picture"
        return (
            f'<figure id="{html.escape(part.key)}"><h3>{title}</h3>\n'
            f'<div class="{kind}" role="img" aria-label="{title}">{part.svg}</div>\n'
            f"<figcaption>{html.escape(part.caption)}</figcaption>\n"
            f"<details><summary>The numbers ({count} row{'s' * (count != 1)})</summary>{rows}</details></figure>"
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
        title, text = html.escape(part.title), html.escape(part.text)
        return f"<details class=text><summary>{title}</summary><pre>{text}</pre></details>"
    return f"<p>{html.escape(part)}</p>"


def dense(svg):
    """Whether a picture has text that a phone would make too small to be read."""
    return any(float(size) < SMALL for size in re.findall(r"font: (?:\w+ )*([\d.]+)px", svg))


def table(frame, title):
    """A DataFrame as a table that scrolls within itself. The row's head is the index, or the first column when rows are
    only numbered."""
    if isinstance(frame.index, pd.RangeIndex) and len(frame.columns):
        frame = frame.set_index(frame.columns[0], drop=True)
    frame = frame.reset_index() if isinstance(frame.index, pd.MultiIndex) else frame
    numeric = [
        pd.api.types.is_numeric_dtype(frame.dtypes.iloc[c]) and frame.dtypes.iloc[c] != bool
        for c in range(frame.shape[1])
    ]
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
        f'<div class="scroll{" tall" if len(frame) > TALL else ""}" tabindex="0" role="region"'
        f' aria-label="{html.escape(title)}: table"><table><thead><tr>{"".join(heads)}</tr></thead>\n<tbody>'
        + "\n".join(rows)
        + "</tbody></table></div>"
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
    """A cell's text, escaped: four digits or so many decimals, whole numbers in full with narrow spaces, a dash for
    what is not a number."""
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
