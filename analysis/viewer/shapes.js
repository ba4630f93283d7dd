// What algorithms make of a body before they compare: its box, its turned corners, points of its facets. After the
// definitions of algorithms/parts, in the same order of sums.
//
// A body is { name, fixed, q, t, mesh } in metres, a mesh { name, corners, index, ball, proxies }: its vertices one
// after another, the nominal radius of a sphere, else 0, and by label what stands for it in a method: { kind, balls,
// corners, index }.
"use strict";

const shapes = (() => {
  const { sub, add } = vectors;
  const AXES = ["x", "y", "z"];
  const MOST_POINTS = 1e6; // of a body; more would take seconds, and would be a fog

  // ---- of a mesh; kept with it, for all bodies of it

  function kept(mesh, key, make) {
    if (!mesh.kept) mesh.kept = new Map();
    if (!mesh.kept.has(key)) mesh.kept.set(key, make());
    return mesh.kept.get(key);
  }

  function localBox(mesh) {
    return kept(mesh, "box", () => boxOf(mesh.corners));
  }

  function boxOf(flat) {
    const low = [Infinity, Infinity, Infinity],
      high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < flat.length; ++i) {
      const c = i % 3;
      if (flat[i] < low[c]) low[c] = flat[i];
      if (flat[i] > high[c]) high[c] = flat[i];
    }
    return { low, high };
  }

  // Half extents: a box about the body's position, not about the middle of its vertices.
  function half(mesh) {
    const { low, high } = localBox(mesh);
    return low.map((x, c) => Math.max(Math.abs(x), Math.abs(high[c])));
  }

  function surface(mesh) {
    const { low, high } = localBox(mesh),
      [a, b, c] = sub(high, low);
    return 2 * (a * b + b * c + c * a);
  }

  // Into how many parts each edge is cut, so that there are facetsPerArea facets a square metre.
  function parts(mesh, facetsPerArea) {
    const facets = mesh.index.length / 3,
      wanted = facetsPerArea * surface(mesh);
    if (!(facets < wanted)) return 1;
    let n = Math.ceil(Math.sqrt(wanted / facets));
    while (n > 1 && facets * (n - 1) * (n - 1) >= wanted) --n;
    while (facets * n * n < wanted) ++n;
    return n;
  }

  const vertex = (mesh, i) => [mesh.corners[3 * i], mesh.corners[3 * i + 1], mesh.corners[3 * i + 2]];

  // The barycentre of facet number f of the mesh whose facets are cut into n x n.
  function facetPoint(mesh, f, n) {
    const whole = Math.floor(f / (n * n)),
      inner = f - whole * n * n,
      corner = [0, 1, 2].map((c) => vertex(mesh, mesh.index[3 * whole + c]));
    const at = (k, j) => {
      if (k === 0) return corner[0];
      if (k === n && j === 0) return corner[1];
      if (k === n && j === n) return corner[2];
      return [0, 1, 2].map((c) => ((n - k) * corner[0][c] + (k - j) * corner[1][c] + j * corner[2][c]) / n);
    };
    const k = Math.floor(Math.sqrt(inner)), // row k has 2 k + 1 facets
      j = Math.floor((inner - k * k) / 2),
      [p, q, r] =
        (inner - k * k) % 2 === 0
          ? [at(k, j), at(k + 1, j), at(k + 1, j + 1)]
          : [at(k, j), at(k + 1, j + 1), at(k, j + 1)];
    return [0, 1, 2].map((c) => (p[c] + q[c] + r[c]) / 3);
  }

  // { points: the chosen facet points one after another, facets: of how many facets, stride }, mesh frame; `points` is
  // null when they are too many for a page.
  function sampled(mesh, { facetsPerArea, stride, dense, inflate = 1 }) {
    return kept(mesh, JSON.stringify(["sampled", facetsPerArea, stride, dense, inflate]), () => {
      const n = dense ? parts(mesh, facetsPerArea) : 1,
        facets = (mesh.index.length / 3) * n * n;
      if (!stride) {
        const wanted = facetsPerArea * surface(mesh);
        stride = wanted > 0 ? Math.min(facets, Math.max(1, Math.floor(facets / wanted))) : 1;
      }
      const count = facets === 0 ? 0 : 1 + Math.floor((facets - 1) / stride);
      if (count > MOST_POINTS) return { points: null, count, facets, stride };
      const points = new Float64Array(3 * count);
      for (let i = 0; i < count; ++i)
        points.set(
          facetPoint(mesh, i * stride, n).map((x) => x * inflate),
          3 * i,
        );
      return { points, count, facets, stride };
    });
  }

  // ---- of a body

  function rotation([w, x, y, z]) {
    return [
      [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
      [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
      [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ];
  }

  function placed(body, flat) {
    const out = new Float64Array(flat.length),
      [r, s, u] = rotation(body.q),
      t = body.t;
    for (let i = 0; i < flat.length; i += 3) {
      const x = flat[i],
        y = flat[i + 1],
        z = flat[i + 2];
      out[i] = r[0] * x + r[1] * y + r[2] * z + t[0];
      out[i + 1] = s[0] * x + s[1] * y + s[2] * z + t[1];
      out[i + 2] = u[0] * x + u[1] * y + u[2] * z + t[2];
    }
    return out;
  }

  const worldBox = (body) => boxOf(placed(body, body.mesh.corners));

  // Babylon.js's Euler angles of a quaternion, R = Ry Rx Rz.
  function euler([w, x, y, z]) {
    const s = y * z - x * w;
    if (s < -0.4999999) return [Math.PI / 2, 2 * Math.atan2(y, w), 0];
    if (s > 0.4999999) return [-Math.PI / 2, 2 * Math.atan2(y, w), 0];
    return [
      Math.asin(-2 * s),
      Math.atan2(2 * (z * x + y * w), z * z - x * x - y * y + w * w),
      Math.atan2(2 * (x * y + z * w), -z * z - x * x + y * y + w * w),
    ];
  }

  // Turned about x, then y, then z, which is not the order of the angles: obb_corners' and obb_triangles' published turn.
  function turnedXyz([x, y, z], angles) {
    const [[sx, cx], [sy, cy], [sz, cz]] = angles.map((a) => [Math.sin(a), Math.cos(a)]);
    const y1 = y * cx - z * sx,
      z1 = z * cx + y * sx,
      x2 = x * cy + z1 * sy;
    return [x2 * cz - y1 * sz, y1 * cz + x2 * sz, z1 * cy - x * sy];
  }

  const signs = (h) => [0, 1, 2, 3, 4, 5, 6, 7].map((k) => h.map((x, c) => ((k >> c) & 1 ? x : -x)));

  // The corners of the box that obb_corners and obb_triangles think is the body's, about its position.
  function turnedCorners(body) {
    const angles = euler(body.q);
    return signs(half(body.mesh)).map((p) => turnedXyz(p, angles));
  }

  // By how much that box is turned away from the body: the angle between the two rotations.
  function turnedAway(body) {
    const angles = euler(body.q),
      r = rotation(body.q);
    let trace = 0; // of R^T T
    for (let c = 0; c < 3; ++c) {
      const column = turnedXyz(
        [0, 1, 2].map((k) => (k === c ? 1 : 0)),
        angles,
      );
      for (let k = 0; k < 3; ++k) trace += r[k][c] * column[k];
    }
    return Math.acos(Math.min(1, Math.max(-1, (trace - 1) / 2)));
  }

  // One corner turned three times, without signs: rotated_aabb's extents.
  function turnedExtents(body) {
    let [x, y, z] = half(body.mesh);
    const [ex, ey, ez] = euler(body.q);
    const turn = (u, v, angle) => {
      const r = Math.sqrt(u * u + v * v);
      if (r === 0) return [0, 0];
      const alpha = Math.asin(Math.min(u / r, 1));
      return [Math.abs(r * Math.sin(angle + alpha)), Math.abs(r * Math.cos(angle + alpha))];
    };
    [x, y] = turn(x, y, ez);
    [z, x] = turn(z, x, ey);
    [y, z] = turn(y, z, ex);
    return [x, y, z];
  }

  // ---- what is drawn: { lines: [[p, q]], faces: [[p, q, r]], points: [p], balls: [[centre, radius]] }, world, metres

  const BOX_EDGES = [0, 1, 2].flatMap((c) =>
    [0, 1, 2, 3, 4, 5, 6, 7].filter((k) => !((k >> c) & 1)).map((k) => [k, k | (1 << c)]),
  );
  // The 12 outer triangles of a box by its corners; bits 0, 1, 2 of a corner's number: plus on x, y, z.
  const BOX_TRIANGLES = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
  ];

  const boxLines = (corners) => BOX_EDGES.map(([i, k]) => [corners[i], corners[k]]);
  const boxFaces = (corners) => BOX_TRIANGLES.map((t) => t.map((i) => corners[i]));
  const drawnBox = (corners) => ({ lines: boxLines(corners), faces: boxFaces(corners) });
  const cornersOf = ({ low, high }) => signs([1, 1, 1]).map((s) => s.map((x, c) => (x > 0 ? high[c] : low[c])));
  const boxAbout = (t, h) => ({ low: sub(t, h), high: add(t, h) });

  function list(flat) {
    const out = [];
    for (let i = 0; i < flat.length; i += 3) out.push([flat[i], flat[i + 1], flat[i + 2]]);
    return out;
  }

  return {
    AXES,
    boxOf,
    localBox,
    half,
    sampled,
    placed,
    worldBox,
    euler,
    rotation,
    turnedXyz,
    signs,
    turnedCorners,
    turnedAway,
    turnedExtents,
    boxFaces,
    drawnBox,
    cornersOf,
    boxAbout,
    list,
  };
})();
