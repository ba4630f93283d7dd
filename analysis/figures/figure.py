"""What a report is made of, and how everything in it is drawn.

A Section is a named list of parts: figures, tables and paragraphs. Figures are inline SVG: they stay sharp in print,
can be searched, and the same data give the same bytes.
"""

import contextlib
import hashlib
import io
import re
import zlib
from dataclasses import dataclass
from xml.etree import ElementTree

import matplotlib

matplotlib.use("svg")  # no display is asked for
import matplotlib.pyplot as plt  # noqa: E402
import pandas as pd  # noqa: E402

# Okabe and Ito's colours, told apart by colour-blind readers (their yellow is left out, it is too pale on white), then
# Paul Tol's muted ones: as many as there are algorithms, and marks tell them apart once more.
PALETTE = {
    "blue": "#0072B2",
    "orange": "#E69F00",
    "green": "#009E73",
    "vermilion": "#D55E00",
    "purple": "#CC79A7",
    "sky": "#56B4E9",
    "black": "#000000",
    "grey": "#767676",
    "indigo": "#332288",
    "wine": "#882255",
    "olive": "#8A8A1F",
    "teal": "#44AA99",
    "rose": "#CC6677",
    "brown": "#8C510A",
    "violet": "#AA4499",
    "moss": "#117733",
}

ABOUT = "About"  # the view of the page that comes last

MISSED, FALSE_POSITIVE = PALETTE["vermilion"], PALETTE["blue"]  # the two kinds of error, here as in the viewer

WIDTH = 6.0  # inches; at 9.5 points text is read on a phone, where the figure is about 340 pixels wide
HEIGHT = 4.0

SETTINGS = {
    "svg.fonttype": "none",  # text stays text
    "svg.hashsalt": "collision_benchmark",
    "figure.figsize": (WIDTH, HEIGHT),
    "figure.dpi": 72,
    "figure.constrained_layout.use": True,
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 9.5,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#555555",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E3E3E3",
    "grid.linewidth": 0.7,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "xtick.color": "#333333",
    "ytick.color": "#333333",
    "legend.fontsize": 9,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "lines.markersize": 6,
}

_STYLES = {
    "obb_sat": ("blue", "o", "-"),
    "bounding_sphere": ("sky", "s", "-"),
    "rotated_aabb": ("green", "^", "-"),
    "facet_distance": ("vermilion", "D", "-"),
    "obb_corners": ("orange", "v", "-"),
    "facet_vectors": ("purple", "P", "-"),
    "obb_triangles": ("grey", "X", "-"),
    "facet_triangles": ("indigo", "<", "-"),
    "facet_rotations": ("olive", ">", "--"),
    "cannon_naive": ("wine", "h", "--"),
    "cannon_sap": ("rose", "p", "--"),
    "aabb": ("teal", "d", "--"),
    "exact": ("black", "*", "-"),
    "exact_cold": ("brown", "*", ":"),
    "fcl_bvh": ("violet", "h", "--"),
}
_MARKERS = ["o", "s", "^", "D", "v", "P", "X", "<", ">", "h", "d", "p", "*", "H", "8"]
_LINES = ["--", ":", "-."]
_looks = {}  # label -> its style, of the labels that were made known


@dataclass(frozen=True)
class Figure:
    """A picture that states a finding.

    title: its finding, one sentence computed from the data; svg: inline SVG, as svg_of gives it; caption: what, how
    many, configuration, commit, machine; table: the numbers that are drawn; key: its anchor, unique in the report;
    number: of the thesis's figure that it answers, with the thesis's words in Czech and what they mean in short.
    """

    title: str
    svg: str
    caption: str
    table: pd.DataFrame
    key: str
    number: str = ""
    czech: str = ""
    seen: str = ""


@dataclass(frozen=True)
class Table:
    """A table that is read as such. caption: units and how many."""

    title: str
    frame: pd.DataFrame
    caption: str


@dataclass(frozen=True)
class Text:
    """Lines to be read as they are, folded under their title."""

    title: str
    text: str


@dataclass(frozen=True)
class Points:
    """Sentences one below the other. items: list of plain texts."""

    title: str
    items: list


@dataclass(frozen=True)
class Verdicts:
    """Statements and what the data say of them. found: list of statements.Verdict; caption: whose data they are."""

    title: str
    found: list
    caption: str


@dataclass(frozen=True)
class Explorer:
    """A figure that answers to the pointer, drawn in the page. data: as explorer.explorer() makes it, for JSON; key:
    its
    anchor."""

    title: str
    data: dict
    key: str


@dataclass(frozen=True)
class Section:
    """parts: Figure, Table, Text, Points, Verdicts, Explorer, or str (one paragraph of plain text).

    scene: what the section is of, "" for the overview, ABOUT for what is read last; the page shows one at a time.
    """

    title: str
    parts: list
    scene: str = ""


def know(labels):
    """Makes known what `labels`, pairs of label and algorithm, look like, and forgets those before: no two have one
    colour
    and one mark. The labels of an algorithm share its colour; while it has more labels than there are marks, the rest
    take other colours."""
    _looks.clear()
    taken = set()

    def take(label, wanted):
        look = next(look for look in wanted if (look["color"], look["marker"]) not in taken)
        taken.add((look["color"], look["marker"]))
        _looks[label] = look

    labels = list(dict.fromkeys(labels))
    for label, algorithm in sorted(labels, key=lambda pair: pair[0] != pair[1]):  # those under their own name first
        own = style(algorithm)
        marked = [own | {"marker": marker} for marker in _MARKERS]
        others = [own | {"color": colour, "marker": marker} for colour in PALETTE.values() for marker in _MARKERS]
        numbered = [own | {"color": f"#{x:06x}"} for x in range(0x101010, 0xF0F0F0, 0x050B11)]
        take(label, [own, *marked, *others, *numbered])


def style(name, label=None):
    """color, marker and linestyle of the algorithm `name`, as keywords of matplotlib; the same in every figure. label:
    of one of its labels, where it was made known.

    An algorithm that this module does not know gets one of its own name, so it keeps it too.
    """
    if label in _looks:
        return dict(_looks[label])
    picked = _STYLES.get(name)
    if not picked:
        taken = {(colour, marker) for colour, marker, _ in _STYLES.values()}
        free = [(colour, marker) for colour in PALETTE for marker in _MARKERS[:12] if (colour, marker) not in taken]
        number = zlib.crc32(name.encode())
        picked = *free[number % len(free)], _LINES[number // len(free) % len(_LINES)]
    return {"color": PALETTE[picked[0]], "marker": picked[1], "linestyle": picked[2]}


def figure(rows=1, columns=1, height=HEIGHT, width=WIDTH, **more):
    """A matplotlib figure and its axes in the report's settings; `more` as of plt.subplots."""
    with plt.rc_context(SETTINGS):
        return plt.subplots(rows, columns, figsize=(width, height), **more)


def space(fig, top=0.0, bottom=0.0):
    """Leaves that many inches above and below the axes to legends."""
    height = fig.get_size_inches()[1]
    fig.get_layout_engine().set(rect=(0, bottom / height, 1, 1 - (top + bottom) / height))


class Svg(str):
    """A picture as SVG; png: the same as PNG, where that was asked for."""

    png = None


_png = False


@contextlib.contextmanager
def with_png():
    """Within it svg_of() makes PNG too."""
    global _png
    _png = True
    try:
        yield
    finally:
        _png = False


def svg_of(fig, titles=None):
    """`fig` as SVG to be put into HTML; closes it.

    No XML header, no metadata, no address of any network; text is text. Identifiers that nothing refers to are dropped,
    the others start with a digest of the content, so several figures live on one page.
    titles: gid of an artist -> text that a browser shows when the pointer is over it. A text with the gid "halo" or
    "halo:LABEL" stands on white, so lines below it do not hurt. An artist with the gid "of:LABEL" is of that label:
    the page highlights all that is of one. "row:LABEL" is the name of a map's row, which the page keeps in sight.
    """
    with plt.rc_context(SETTINGS):
        drawn, png = io.StringIO(), io.BytesIO()
        fig.savefig(drawn, format="svg", metadata={"Date": None})
        if _png:
            fig.savefig(png, format="png", dpi=200, metadata={"Software": None})
    plt.close(fig)
    root = ElementTree.fromstring(drawn.getvalue())  # without comments
    for parent in list(root.iter()):
        for child in [child for child in parent if _name(child.tag) in ("metadata", "style")]:
            parent.remove(child)
    for element in root.iter():
        element.tag, element.tail = _name(element.tag), "\n"
        element.text = element.text if element.text and element.text.strip() else None
        for key in list(element.attrib):  # without the namespace of links
            value = element.attrib.pop(key)
            element.set(_name(key), "".join(value.split()) if value.startswith("data:") else value)
        gid = element.get("id")
        if gid and gid.startswith(("of:", "row:")):
            element.set("data-of", gid.partition(":")[2])
        if gid and gid.startswith("row:"):
            element.set("class", "row")
        if gid in (titles or {}):
            del element.attrib["id"]
            title = ElementTree.Element("title")
            title.text = titles[gid]
            element.insert(0, title)
        elif gid and gid.startswith("halo"):
            del element.attrib["id"]
            if of := gid.partition(":")[2]:
                element.set("data-of", of)
            element.set("style", "paint-order:stroke;stroke:#fff;stroke-width:2.5px;stroke-linejoin:round")
    for key in ("width", "height"):
        root.attrib.pop(key, None)  # the page's, not the paper's
    root.set("style", "stroke-linejoin:round;stroke-linecap:butt")
    _rename(root)
    svg = Svg(ElementTree.tostring(root, encoding="unicode").strip())
    svg.png = png.getvalue() if _png else None
    return svg


def _name(qualified):
    """A tag or an attribute without its namespace."""
    return qualified.rpartition("}")[2]


def _rename(root):
    """Identifiers that something refers to begin with a digest of the content; the others go."""
    link = re.compile(r"(?<=url\()#([^)]+)|^#(.+)")  # in a style or a clip-path; the whole of an href
    prefix = "f" + hashlib.sha256(ElementTree.tostring(root)).hexdigest()[:10]
    used = set()
    for element in root.iter():
        for key, value in element.attrib.items():
            if key == "href" or "url(" in value:
                used.update(one or other for one, other in link.findall(value))
                element.set(key, link.sub(lambda found: f"#{prefix}{found[1] or found[2]}", value))
    for element in root.iter():
        if (own := element.attrib.pop("id", None)) in used:
            element.set("id", prefix + own)


def slug(text):
    """The text as the name of a place in the page."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "section"
