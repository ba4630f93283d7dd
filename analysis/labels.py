"""Puts labels beside their points so that none covers another, a mark or, if it can be helped, a line."""

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

DISTANCES = (4, 8, 13, 19, 27, 36, 48, 62, 80)  # from the mark's edge, points
ANGLES = np.deg2rad([0, 180, 90, 270, 30, 150, 330, 210, 60, 120, 300, 240, 15, 165, 345, 195])
CLEAR = np.array([-2, -2, 2, 2])  # points: a line that comes nearer to a label than this touches it
LEADER = 12  # points: farther labels get a line to their mark


def size(text, points, weight="normal"):
    """Width and height of `text` in DejaVu Sans, the widest of the fonts that a reader's machine may take; points."""
    width, height, _ = text_to_path.get_text_width_height_descent(
        text, FontProperties(size=points, weight=weight), False
    )
    return width, max(height, points)


def place(named, sizes, region, marks, radii, segments):
    """Where labels go: an array (N,2) of their lower left corners; NaN for one that has no room.

    named: (N), the numbers of the marks to be labelled; sizes: (N,2), width and height; region: (left, bottom, right,
    top) to stay in; marks: (M,2), the middles of all marks, radii: (M); segments: (L,4), lines x0 y0 x1 y1 that had
    better stay readable. Greedy, the most crowded first, then every label three times again, given the others. Nothing
    is random.
    """
    sizes, marks = np.asarray(sizes, float).reshape(-1, 2), np.asarray(marks, float).reshape(-1, 2)
    radii, segments = np.asarray(radii, float), np.asarray(segments, float).reshape(-1, 4)
    named = np.asarray(named, int)
    anchors = marks[named]
    mark_boxes = np.hstack([marks - radii[:, None], marks + radii[:, None]])
    boxes = np.full((len(anchors), 4), np.nan)
    leaders = np.full((len(anchors), 4), np.nan)
    crowd = [(np.abs(marks - anchor) < (60, 20)).all(axis=1).sum() for anchor in anchors]
    order = sorted(range(len(anchors)), key=lambda label: (-crowd[label], label))
    for turn in range(4):
        for label in order:
            boxes[label] = leaders[label] = np.nan
            candidates, distance = _candidates(anchors[label], sizes[label], radii[named[label]])
            inside = (candidates[:, :2] >= region[:2]).all(axis=1) & (candidates[:, 2:] <= region[2:]).all(axis=1)
            candidates, distance = candidates[inside], distance[inside]
            if not len(candidates):
                continue
            start = np.broadcast_to(anchors[label], (len(candidates), 2))
            lines = np.hstack([start, _nearest(candidates, anchors[label])])
            covered = _overlap(candidates, boxes, 1.5).any(axis=1) | _overlap(candidates, mark_boxes, 0).any(axis=1)
            long = distance >= LEADER
            covered |= long & _crosses(boxes, lines).any(axis=0)  # its leader through another label
            covered |= _crosses(candidates, leaders).any(axis=1)  # another leader through it
            others = (marks != anchors[label]).any(axis=1)
            through = long * _crosses(mark_boxes[others] + [2, 2, -2, -2], lines).sum(axis=0)
            gaps = np.hypot(*np.moveaxis(_gap(candidates, marks[others]), 2, 0)).min(axis=1, initial=np.inf)
            own = np.hypot(*_gap(candidates, anchors[label : label + 1])[:, 0].T)
            price = distance + 2.5 * np.maximum(0, own + 2 - gaps)  # nearer to a stranger's mark than to its own
            price += 6 * _crosses(candidates + CLEAR, segments).sum(axis=1) + 15 * through
            price = np.where(covered, np.inf, price)
            best = int(np.argmin(price))
            if np.isfinite(price[best]):
                boxes[label] = candidates[best]
                leaders[label] = lines[best] if long[best] else np.nan
    return boxes[:, :2]


def leader(corner, extent, anchor, radius):
    """The line (x0, y0, x1, y1) from a mark's edge to its label, or None when they are near."""
    box = np.array([[*corner, *(np.asarray(corner) + extent)]])
    end = _nearest(box, np.asarray(anchor, float))[0]
    way = end - anchor
    length = np.hypot(*way)
    return None if length - radius < LEADER - 2 else (*(anchor + way * radius / length), *end)


def _candidates(anchor, extent, radius):
    """Boxes (C,4) about `anchor`, near ones and those to the right first, and how far each is (C)."""
    distance = np.repeat(DISTANCES, len(ANGLES)).astype(float)
    way = np.tile(np.column_stack([np.cos(ANGLES), np.sin(ANGLES)]), (len(DISTANCES), 1))
    middle = anchor + way * (distance + radius)[:, None] + np.sign(np.round(way, 9)) * extent / 2
    preferred = np.tile(np.arange(len(ANGLES)) * 0.3, len(DISTANCES))
    return np.hstack([middle - extent / 2, middle + extent / 2]), distance + preferred


def _nearest(boxes, point):
    return np.clip(point, boxes[:, :2], boxes[:, 2:])


def _gap(boxes, points):
    """(A,B,2): from points to the nearest of each box."""
    return points[None, :, :] - np.clip(points[None, :, :], boxes[:, None, :2], boxes[:, None, 2:])


def _overlap(a, b, gap):
    """(A,B): whether boxes come nearer than `gap`; never for NaN."""
    return ((a[:, None, :2] < b[None, :, 2:] + gap) & (b[None, :, :2] - gap < a[:, None, 2:])).all(axis=2)


def _crosses(boxes, lines):
    """(A,B): whether a line (x0, y0, x1, y1) passes a box, by clipping; never for NaN."""
    start, way = lines[None, :, :2], lines[None, :, 2:] - lines[None, :, :2]
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = (boxes[:, None, :2] - start) / way, (boxes[:, None, 2:] - start) / way
        still = way == 0
        within = (start >= boxes[:, None, :2]) & (start <= boxes[:, None, 2:])
        enter = np.where(still, np.where(within, -np.inf, np.inf), np.minimum(low, high)).max(axis=2)
        leave = np.where(still, np.where(within, np.inf, -np.inf), np.maximum(low, high)).min(axis=2)
    return (enter <= leave) & (enter <= 1) & (leave >= 0)
