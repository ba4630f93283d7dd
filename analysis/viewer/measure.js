// How two triangle meshes lie to each other, for the pair chosen in the page: where their surfaces cross, or the gap
// between them. For the eye: in doubles on vertices rounded to single precision. The exact answer is the file's.
"use strict";

const measure = (() => {
  const MOST_TRIANGLE_PAIRS = 3e7; // about a second in a browser
  const MOST_PROJECTIONS = 2e7; // of vertices on directions, as long

  const { sub, dot, cross, along, length } = vectors;
  const clamp = (x) => Math.min(1, Math.max(0, x));

  // Triangles with corners, box, and a sphere about the box's middle. vertex(i) is the i-th vertex in the world.
  function triangles(index, vertex) {
    const found = [];
    for (let i = 0; i < index.length; i += 3) {
      const corners = [vertex(index[i]), vertex(index[i + 1]), vertex(index[i + 2])];
      const low = [0, 1, 2].map((c) => Math.min(corners[0][c], corners[1][c], corners[2][c]));
      const high = [0, 1, 2].map((c) => Math.max(corners[0][c], corners[1][c], corners[2][c]));
      const middle = along(low, sub(high, low), 0.5);
      const radius = Math.sqrt(Math.max(...corners.map((p) => dot(sub(p, middle), sub(p, middle)))));
      found.push({ corners, low, high, middle, radius });
    }
    return found;
  }

  const apart = (a, b) => [0, 1, 2].some((c) => a.low[c] > b.high[c] || b.low[c] > a.high[c]);

  function hull(list) {
    const low = [Infinity, Infinity, Infinity],
      high = [-Infinity, -Infinity, -Infinity];
    for (const t of list)
      for (let c = 0; c < 3; ++c) {
        low[c] = Math.min(low[c], t.low[c]);
        high[c] = Math.max(high[c], t.high[c]);
      }
    return { low, high };
  }

  // The point in which the segment p q goes through the triangle (Moller and Trumbore 1997), or null.
  function through(p, q, [a, b, c]) {
    const d = sub(q, p),
      e = sub(b, a),
      f = sub(c, a),
      h = cross(d, f),
      det = dot(e, h);
    if (det === 0) return null;
    const s = sub(p, a),
      u = dot(s, h) / det,
      n = cross(s, e),
      v = dot(d, n) / det,
      t = dot(f, n) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t <= 1 ? along(p, d, t) : null;
  }

  function crossing(a, b) {
    const points = [];
    for (const [one, other] of [
      [a, b],
      [b, a],
    ])
      for (let i = 0; i < 3; ++i) {
        const point = through(one.corners[i], one.corners[(i + 1) % 3], other.corners);
        if (point) points.push(point);
      }
    return points;
  }

  // Nearest points of two segments (Ericson 2005, section 5.1.9).
  function between(p, q, r, s) {
    const d = sub(q, p),
      e = sub(s, r),
      w = sub(p, r),
      a = dot(d, d),
      b = dot(e, e),
      f = dot(e, w),
      c = dot(d, w),
      g = dot(d, e);
    const det = a * b - g * g;
    let t = det > 0 ? clamp((g * f - c * b) / det) : 0,
      u = b > 0 ? (g * t + f) / b : 0;
    if (u < 0 || u > 1 || b === 0) {
      u = clamp(u);
      t = a > 0 ? clamp((g * u - c) / a) : 0;
    }
    return [along(p, d, t), along(r, e, u)];
  }

  // The foot of p on the triangle's plane if it lies inside the triangle, else null: its edges are looked at apart.
  function foot(p, [a, b, c]) {
    const e = sub(b, a),
      f = sub(c, a),
      n = cross(e, f),
      nn = dot(n, n);
    if (nn === 0) return null;
    const w = sub(p, a),
      v = dot(cross(e, w), n) / nn,
      u = dot(cross(w, f), n) / nn;
    return u >= 0 && v >= 0 && u + v <= 1 ? along(p, n, -dot(w, n) / nn) : null;
  }

  function nearest(a, b, best) {
    const look = (p, q) => {
      const d = sub(p, q),
        distance = Math.sqrt(dot(d, d));
      if (distance < best.distance) Object.assign(best, { distance, from: p, to: q });
    };
    for (let i = 0; i < 3; ++i) {
      const onB = foot(a.corners[i], b.corners),
        onA = foot(b.corners[i], a.corners);
      if (onB) look(a.corners[i], onB);
      if (onA) look(onA, b.corners[i]);
      for (let j = 0; j < 3; ++j)
        look(...between(a.corners[i], a.corners[(i + 1) % 3], b.corners[j], b.corners[(j + 1) % 3]));
    }
  }

  // How far one must be moved, and whither, along a normal of a facet of either until their hulls are apart: bodies
  // that cross are that deep in each other at most. { distance, direction }; null when the meshes are too large.
  function way(one, other, a, b) {
    const found = new Map();
    for (const { corners } of [...a, ...b]) {
      const n = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])),
        size = length(n);
      if (!(size > 0)) continue;
      const up = n.map((x) => x / size),
        key = (by) => up.map((x) => Math.round(1e6 * by * x) + 0).join();
      if (!found.has(key(-1))) found.set(key(1), up); // the other way along it is looked at too
    }
    const points = [one, other].map(({ index, vertex }) => [...new Set(index)].map(vertex));
    if (found.size * (points[0].length + points[1].length) > MOST_PROJECTIONS) return null;
    const best = { distance: Infinity, direction: null };
    for (const up of found.values()) {
      const [first, second] = points.map((of) => {
        let low = Infinity,
          high = -Infinity;
        for (const p of of) {
          const at = dot(p, up);
          low = Math.min(low, at);
          high = Math.max(high, at);
        }
        return { low, high };
      });
      for (const [distance, by] of [
        [first.high - second.low, -1],
        [second.high - first.low, 1],
      ])
        if (distance < best.distance) Object.assign(best, { distance, direction: up.map((x) => by * x) });
    }
    return best;
  }

  // { segments: [[p, q], ...] where the surfaces cross, pairs: how many pairs of triangles do, and then out: the way of
  // the first out of the second; gap: { distance, from, to } when none does }; null when the meshes are too large.
  function measure(one, other) {
    if ((one.index.length / 3) * (other.index.length / 3) > MOST_TRIANGLE_PAIRS) return null;
    const a = triangles(one.index, one.vertex),
      b = triangles(other.index, other.vertex);
    const hullA = hull(a),
      hullB = hull(b),
      segments = [];
    const nearA = a.filter((t) => !apart(t, hullB)),
      nearB = b.filter((t) => !apart(t, hullA));
    let pairs = 0;
    for (const s of nearA)
      for (const t of nearB) {
        if (apart(s, t)) continue;
        const points = crossing(s, t);
        if (!points.length) continue;
        ++pairs;
        const far = (p) => length(sub(p, points[0]));
        segments.push([points[0], points.reduce((end, p) => (far(p) > far(end) ? p : end))]);
      }
    if (pairs) return { segments, pairs, out: way(one, other, a, b) };
    const gap = { distance: Infinity };
    // Nearest first, so that most pairs are left out by their spheres.
    const order = (list, to) => [...list].sort((s, t) => away(s, to) - away(t, to));
    const away = (t, to) => dot(sub(t.middle, to), sub(t.middle, to));
    const middle = (h) => along(h.low, sub(h.high, h.low), 0.5);
    const first = order(a, middle(hullB)),
      second = order(b, middle(hullA));
    for (const s of first)
      for (const t of second) {
        const reach = gap.distance + s.radius + t.radius;
        if (away(s, t.middle) < reach * reach) nearest(s, t, gap);
      }
    return { segments, pairs, gap };
  }

  return Object.assign(measure, { between });
})();
