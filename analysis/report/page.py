"""Sections as one HTML page that needs nothing else: no network, no font, no other file."""

import json
import numbers
import pathlib
import re

import numpy as np
import pandas as pd

from ..figures.figure import ABOUT, Explorer, Figure, Points, Table, Text, Verdicts, slug
from ..figures.thesis_tables import spelled
from ..output import templates
from . import vega
from ..tables.clauses import shown as value
from ..tables.sentences import NAMES
from ..words import counted

HERE = pathlib.Path(__file__).parent

OVERVIEW = "Overview"
LONG = 40  # characters: texts that are given room to be read in lines
SHORT = 26  # characters: texts that do not break
LONG_HEAD = 28  # characters: heads of rows that may break
TALL = 60  # rows: longer tables scroll within themselves
WIDE = 11  # columns: tables of more are set smaller
SHOWN = 2  # clauses of a verdict that are told while it is folded
SMALL = 9  # points: a picture with smaller text is not shrunk to a phone's width, it scrolls within itself


def page(title, lead, warnings, sections):
    """The whole document; the same input gives the same bytes.

    lead, warnings: lists of plain texts; sections: Section, in their order.
    """
    parts = [part for section in sections for part in section.parts]
    anchors = {part.key: part.title for part in parts if isinstance(part, Figure)} | {
        slug(section.title): section.title for section in sections}
    views, used = {}, {}
    for section in sections:
        content = [_part(part, anchors) for part in section.parts]
        key = _unique(slug(section.title), used)
        views.setdefault(section.scene or OVERVIEW, []).append((key, section.title, content))
    last = views.pop(ABOUT, None)
    shown_views = [*views.items(), *([(ABOUT, last)] if last else [])]
    named = [{"title": name, "key": _unique(f"view-{slug(name)}", used), "sections": of} for name, of in shown_views]
    drawn = any(isinstance(part, Explorer) for part in parts)
    return templates(HERE).get_template("page.html").render(
        title=title, lead=lead, warnings=warnings, views=named, css=_beside("page.css"),
        script=_beside("page.js") + _beside("explorer.js"), vega=vega.script() if drawn else "",
    )


def _unique(key, used):
    used[key] = used.get(key, 0) + 1
    return key if used[key] == 1 else f"{key}-{used[key]}"


def _beside(name):
    return (HERE / name).read_text(encoding="utf-8")


def _part(part, anchors):
    """A part as what its macro in page.html takes: its name and the arguments."""
    if isinstance(part, Figure):
        kind = "picture dense" if dense(part.svg) else "picture"
        return "figure", (part.key, part.title.removesuffix("."), kind, part.svg, part.caption,
                          table(part.table, part.title),
                          counted(len(part.table), "row"), part.number, part.czech, part.seen)
    if isinstance(part, Explorer):
        return "explorer", (part.key, part.title, json.dumps(part.data, separators=(",", ":")))
    if isinstance(part, Points):
        return "points", (part.title, part.items)
    if isinstance(part, Table):
        return "titled", (part.title, table(part.frame, part.title), part.caption)
    if isinstance(part, Verdicts):
        return "verdicts", (part.title, [_verdict(each, anchors) for each in part.found], part.caption)
    if isinstance(part, Text):
        return "text", (part.title, part.text)
    return "paragraph", (part,)


def _verdict(verdict, anchors):
    """A verdict as its macro takes it: links lead to figures that the page has."""
    word, _, why = verdict.verdict.partition(": ")
    return {
        "fell": _fell(verdict.clauses) if word == "refuted" else "",
        "key": f"statement-{verdict.number}{'-careful' if verdict.variant else ''}",
        "number": f"{verdict.number}{' careful' if verdict.variant else ''}",
        "word": word, "near": verdict.near, "why": why, "text": spelled(verdict.text), "czech": verdict.czech,
        "section": verdict.section, "cause": verdict.cause,
        "clauses": [(each.what, value(each.measured), each.needed, each.holds, each.near) for each in verdict.clauses],
        "see": [(key, NAMES.get(key) or key.replace("-", " ", 1).replace("-",
            ".")) for key in verdict.see if key in anchors],
    }


def _fell(clauses):
    """What fails, in a line: "H / G: 0.411, needed > 1"."""
    found = [f"{each.what}: {value(each.measured)}, needed {each.needed}" for each in clauses if each.holds is False]
    more = f"; and {counted(len(found) - SHOWN, 'clause')} more" if len(found) > SHOWN else ""
    return f"Measured {'; '.join(found[:SHOWN])}{more}." if found else ""


def dense(svg):
    """Whether a picture has text that a phone would make too small to be read."""
    return any(float(size) < SMALL for size in re.findall(r"font: (?:\w+ )*([\d.]+)px", svg))


def table(frame, title):
    """A DataFrame as what page.html makes a table of, which scrolls within itself. The row's head is the index, or the
    first column when rows are only numbered."""
    if isinstance(frame.index, pd.RangeIndex) and len(frame.columns):
        frame = frame.set_index(frame.columns[0], drop=True)
    frame = frame.reset_index() if isinstance(frame.index, pd.MultiIndex) else frame
    numeric = [
        pd.api.types.is_numeric_dtype(frame.dtypes.iloc[c]) and frame.dtypes.iloc[c] != bool
        for c in range(frame.shape[1])
    ]
    columns = [_cells(frame.iloc[:, c], right) for c, right in enumerate(numeric)]
    heads = map(shown, frame.index)
    return {
        "title": title,
        "tall": len(frame) > TALL,
        "wide": frame.shape[1] > WIDE,
        "sortable": len(frame) > 2,
        "heads": [(_head(frame.index.name or ""), False), *zip(map(_head, frame.columns), numeric)],
        "rows": [("long" if len(head) > LONG_HEAD else "", head, cells) for head, *cells in zip(heads, *columns)],
    }


def _head(name):
    return " ".join(map(str, name)) if isinstance(name, tuple) else str(name)


def _cells(values, right):
    """The cells of a column: class, style and text. Fractions of one size get the same number of decimals, so that they
    can be compared."""
    if not right:
        texts = [shown(value) for value in values]
        return [(_width(text), "", text) for text in texts]
    if values.name == "error" and values.between(0, 1).all():
        return [("n bar", f"--v:{value * 100:.0f}%", f"{value:.4f}") for value in values]
    size = values.abs()[(values != 0) & values.notna()].astype(float)
    size = size[np.isfinite(size)]
    decimals = None
    if pd.api.types.is_float_dtype(values.dtype) and len(size) and size.max() < 2000 * size.min():
        decimals = int(np.clip(2 - np.floor(np.log10(size.min())), 0, 6))
    return [("n", "", shown(value, decimals)) for value in values]


def _width(text):
    return "long" if len(text) > LONG else "s" if len(text) < SHORT else ""


def shown(value, decimals=None):
    """A cell's text: four digits or `decimals`, whole numbers in full with narrow spaces, a dash for
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
    return str(value)
