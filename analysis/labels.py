"""Puts labels beside their points so that each is tied to its own mark and none covers another or a mark.

A label is tied when it stands so near to its mark that no other mark can be meant, or else by a line from its mark's
edge that passes no other mark and no other label; the caller draws that line in the mark's colour. A label that can
have neither is left out: no name is better than a wrong one.
"""

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

DISTANCES = (4, 8, 13, 19, 27, 36, 48, 62, 80, 102, 128)  # from the mark's edge, points
ANGLES = np.deg2rad([0, 180, 90, 270, 30, 150, 330, 210, 60, 120, 300, 240, 15, 165, 345, 195, 45, 135, 315, 225])
CLEAR = np.array([-2, -2, 2, 2])  # points: a line that comes nearer to a label than this touches it
LEADER = 7  # points: farther labels get a line to their mark
SHORTEST = 6  # points: a shorter line is not seen as one
PUSHES = 6  # places for which a label without room may push others away
APART = 1.5  # points: nearer marks are one for the eye
AIR = 1  # points between a line and the edge of a stranger's mark


def size(text, points, weight="normal"):
    """Width and height of `text` in DejaVu Sans, the widest of the fonts that a reader's machine may take; points."""
    width, height, _ = text_to_path.get_text_width_height_descent(
        text, FontProperties(size=points, weight=weight), False
    )
    return width, max(height, points)


def place(named, sizes, region, marks, radii, segments):
    """Where labels go: their lower left corners (N,2), and lines x0 y0 x1 y1 (N,4) from a mark's edge to its label.

    Both are NaN for a label that has no room, a line also where the label is so near that it needs none.
    named: (N), the numbers of the marks to be labelled; sizes: (N,2), width and height; region: (left, bottom, right,
    top) to stay in; marks: (M,2), the middles of all marks, radii: (M); segments: (L,4), lines x0 y0 x1 y1 that had
    better stay readable. Greedy, the most crowded first, then every label twice again, given the others; then one
    without room may push others away, if all of them find another place. Nothing is random.
    """
    sizes, marks = np.asarray(sizes, float).reshape(-1, 2), np.asarray(marks, float).reshape(-1, 2)
    radii, segments = np.asarray(radii, float), np.asarray(segments, float).reshape(-1, 4)
    named = np.asarray(named, int)
    spots = [_spots(mark, size, region, marks, radii, segments) for mark, size in zip(named, sizes)]
    put = np.full((len(named), 8), np.nan)  # box and line of each label

    def clashes(label):
        """(spots, labels): whether a label at its spot covers another, or either one's line passes the other."""
        boxes, lines = spots[label][0], spots[label][1]
        there = _overlap(boxes, put[:, :4], 1.5) | _crosses(put[:, :4], lines).T | _crosses(boxes, put[:, 4:])
        there[:, label] = False
        return there

    def settle(label):
        boxes, lines, price = spots[label]
        put[label] = np.nan
        price = np.where(clashes(label).any(axis=1), np.inf, price + 20 * _cut(lines, put[:, 4:]).sum(axis=1))
        if len(price) and np.isfinite(price.min()):
            best = int(np.argmin(price))
            put[label] = [*boxes[best], *lines[best]]

    def free():
        return int(np.isnan(put[:, 0]).sum())

    crowd = [(np.abs(marks - marks[mark]) < (60, 20)).all(axis=1).sum() for mark in named]
    order = sorted(range(len(named)), key=lambda label: (-crowd[label], label))
    for _ in range(3):
        for label in order:
            settle(label)
    for label in [label for label in order if np.isnan(put[label, 0])]:
        if not np.isnan(put[label, 0]):
            continue
        pushed, before = clashes(label), put.copy()
        for spot in np.lexsort((spots[label][2], pushed.sum(axis=1)))[:PUSHES]:
            put[pushed[spot]] = np.nan
            put[label] = [*spots[label][0][spot], *spots[label][1][spot]]
            for other in np.flatnonzero(pushed[spot]):
                settle(other)
            if free() < np.isnan(before[:, 0]).sum():
                break
            put[:] = before
    for label in order:  # what was pushed away may have left something better
        settle(label)
    return put[:, :2], put[:, 4:]


def _spots(mark, extent, region, marks, radii, segments):
    """Boxes (C,4), lines (C,4) and prices (C) of the places that a label may have as far as marks and `region` go."""
    anchor, radius = marks[mark], radii[mark]
    boxes, distance = _candidates(anchor, extent, radius)
    inside = (boxes[:, :2] >= region[:2]).all(axis=1) & (boxes[:, 2:] <= region[2:]).all(axis=1)
    boxes, distance = boxes[inside], distance[inside]
    lines, length = _leaders(boxes, anchor, radius)
    strangers = np.hypot(*(marks - anchor).T) > APART
    gaps = np.hypot(*np.moveaxis(_gap(boxes, marks[strangers]), 2, 0)) - radii[strangers]
    tied = (length >= LEADER) | (length + 2 > gaps.min(axis=1, initial=np.inf))
    passed = (_away(lines, marks[strangers]) < radii[strangers] + AIR).any(axis=1)
    bad = _overlap(boxes, np.hstack([marks - radii[:, None], marks + radii[:, None]]), 0).any(axis=1)
    bad |= tied & (passed | (length < SHORTEST))
    lines[~tied] = np.nan
    price = distance + 4 * tied + 6 * _crosses(boxes + CLEAR, segments).sum(axis=1)
    price += 6 * _cut(lines, segments).sum(axis=1)
    return boxes[~bad], lines[~bad], price[~bad]


def _leaders(boxes, anchor, radius):
    """Lines (C,4) from a mark's edge to the nearest point of each box, and their lengths (C)."""
    end = np.clip(anchor, boxes[:, :2], boxes[:, 2:])
    way = end - anchor
    length = np.hypot(*way.T)
    start = anchor + way * (radius / np.maximum(length, radius))[:, None]
    return np.hstack([start, end]), length - radius


def _candidates(anchor, extent, radius):
    """Boxes (C,4) about `anchor`, near ones and those to the right first, and how far each is (C)."""
    distance = np.repeat(DISTANCES, len(ANGLES)).astype(float)
    way = np.tile(np.column_stack([np.cos(ANGLES), np.sin(ANGLES)]), (len(DISTANCES), 1))
    middle = anchor + way * (distance + radius)[:, None] + np.sign(np.round(way, 9)) * extent / 2
    preferred = np.tile(np.arange(len(ANGLES)) * 0.3, len(DISTANCES))
    return np.hstack([middle - extent / 2, middle + extent / 2]), distance + preferred


def _gap(boxes, points):
    """(A,B,2): from points to the nearest of each box."""
    return points[None, :, :] - np.clip(points[None, :, :], boxes[:, None, :2], boxes[:, None, 2:])


def _away(lines, points):
    """(A,B): how far points are from lines x0 y0 x1 y1."""
    start, way = lines[:, None, :2], (lines[:, 2:] - lines[:, :2])[:, None]
    along = ((points[None] - start) * way).sum(axis=2) / np.maximum((way**2).sum(axis=2), 1e-300)
    return np.hypot(*np.moveaxis(points[None] - start - np.clip(along, 0, 1)[..., None] * way, 2, 0))


def _overlap(a, b, gap):
    """(A,B): whether boxes come nearer than `gap`; never for NaN."""
    near = [(a[:, None, c] < b[None, :, c + 2] + gap) & (b[None, :, c] - gap < a[:, None, c + 2]) for c in (0, 1)]
    return near[0] & near[1]


def _cut(a, b):
    """(A,B): whether lines x0 y0 x1 y1 cross; never for NaN."""

    def side(lines, points):  # (lines, points) of different shapes that broadcast
        along, off = lines[..., 2:] - lines[..., :2], points - lines[..., :2]
        return along[..., 0] * off[..., 1] - along[..., 1] * off[..., 0]

    a, b = a[:, None], b[None]
    apart = side(a, b[..., :2]) * side(a, b[..., 2:]), side(b, a[..., :2]) * side(b, a[..., 2:])
    return (apart[0] < 0) & (apart[1] < 0)


def _crosses(boxes, lines):
    """(A,B): whether a line (x0, y0, x1, y1) passes a box, by clipping; never for NaN."""
    enter, leave = 0, 1
    for c in (0, 1):  # an axis at a time: numpy is slow along an axis of two
        start, way = lines[None, :, c], lines[None, :, c + 2] - lines[None, :, c]
        with np.errstate(divide="ignore", invalid="ignore"):
            low, high = (boxes[:, None, c] - start) / way, (boxes[:, None, c + 2] - start) / way
        still = way == 0
        within = (start >= boxes[:, None, c]) & (start <= boxes[:, None, c + 2])
        enter = np.maximum(enter, np.where(still, np.where(within, -np.inf, np.inf), np.minimum(low, high)))
        leave = np.minimum(leave, np.where(still, np.where(within, np.inf, -np.inf), np.maximum(low, high)))
    return enter <= leave
