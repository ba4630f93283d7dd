// What an algorithm compares of two bodies, computed again from the file's meshes and poses, to be drawn and told.
// Written after the definitions (algorithms/README.md and the headers of algorithms/), not after the pipeline's code:
// every candidate is looked at, nothing is left out early. A test compares it with the answers of the file. Only
// sines, cosines and their inverses may differ from the pipeline's, in the last bit; `tie` tells how near that is to
// deciding.
// Bodies are those of shapes.js.
"use strict";

const sees = (() => {
  const { sub, add, dot, cross, along, length } = vectors;
  const {
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
  } = shapes;
  const MOST_WORK = 5e8; // distances or vectors of a pair, a second or two
  const MOST_TRIANGLES = 2e6; // pairs of triangles of a pair, some seconds

  // ---- numbers in words

  function digits(x, most = 4) {
    if (x === 0) return "0";
    return Math.abs(x) < 1e-3 || Math.abs(x) >= 1e6
      ? x.toExponential(most - 2).replace(/\.?0+e/, "e")
      : String(Number(x.toPrecision(most)));
  }
  const metres = (x) => digits(x) + " m";
  const degrees = (x) => Number(((x * 180) / Math.PI).toFixed(1)) + "°";
  const many = (n, what) => `${n.toLocaleString("en")} ${what}${n === 1 ? "" : "s"}`;
  const triple = (p) => p.map((x) => digits(x, 3)).join(", ");

  // ---- comparisons. Each gives { hit, tie, because, rows: [[what, value]], marks }. `tie`: by which part of the lengths
  // involved the deciding comparison was clear. `marks` is drawn as above and shows what decided.

  const lengths = (a, b) =>
    Math.max(...a.t.map(Math.abs), ...b.t.map(Math.abs)) + length(half(a.mesh)) + length(half(b.mesh));

  const unknown = (because, rows = []) => ({ hit: null, tie: 0, because, rows, marks: {} });

  function balls(a, b, ra, rb, touching) {
    const apart = length(sub(a.t, b.t)),
      depth = ra + rb - apart,
      hit = touching(ra + rb, apart);
    const to = apart > 0 ? sub(b.t, a.t).map((x) => x / apart) : [1, 0, 0];
    return {
      hit,
      tie: Math.abs(depth) / lengths(a, b),
      because: hit ? `the balls overlap by ${metres(depth)}` : `the balls are ${metres(-depth)} apart`,
      rows: [
        ["radii", `${metres(ra)} and ${metres(rb)}, together ${metres(ra + rb)}`],
        ["centres", `${metres(apart)} apart`],
      ],
      marks: hit ? {} : { lines: [[along(a.t, to, ra), along(b.t, to, -rb)]] },
    };
  }

  // Boxes along the axes of the world: the overlap on each, negative where they are apart.
  function overlaps(of, wording, more = []) {
    const least = of.indexOf(Math.min(...of));
    const apart = AXES.filter((_, c) => of[c] < 0);
    const because = apart.length
      ? `${wording} are apart on ${apart.map((axis) => `${axis} by ${metres(-of[AXES.indexOf(axis)])}`).join(" and on ")}`
      : `${wording} overlap on x, y and z, least on ${AXES[least]} by ${metres(of[least])}`;
    return {
      because,
      rows: [
        ...of.map((x, c) => [`on ${AXES[c]}`, x < 0 ? `apart by ${metres(-x)}` : `overlap ${metres(x)}`]),
        ...more,
      ],
    };
  }

  // A bar over the gap of two boxes on the axis on which they are farthest apart.
  function gapBar(p, q) {
    const gap = [0, 1, 2].map((c) => Math.max(p.low[c] - q.high[c], q.low[c] - p.high[c])),
      axis = gap.indexOf(Math.max(...gap));
    if (!(gap[axis] > 0)) return {};
    const from = [0, 1, 2].map((c) => (Math.max(p.low[c], q.low[c]) + Math.min(p.high[c], q.high[c])) / 2),
      to = [...from];
    from[axis] = p.low[axis] > q.high[axis] ? p.low[axis] : p.high[axis];
    to[axis] = p.low[axis] > q.high[axis] ? q.high[axis] : q.low[axis];
    return { lines: [[from, to]] };
  }

  function rotatedAabb(a, b) {
    const ea = turnedExtents(a),
      eb = turnedExtents(b),
      delta = sub(a.t, b.t).map(Math.abs),
      of = delta.map((x, c) => ea[c] + eb[c] - x),
      hit = [0, 1, 2].every((c) => delta[c] <= ea[c] + eb[c]);
    const told = (body, e) => {
      const { low, high } = worldBox(body),
        reach = low.map((x, c) => Math.max(body.t[c] - x, high[c] - body.t[c]));
      return [
        [`angles of ${body.name}`, euler(body.q).map(degrees).join(", ") + " about x, y, z"],
        [`its extents`, `${triple(e)} m; its mesh reaches ${triple(reach)} m`],
      ];
    };
    const { because, rows } = overlaps(of, "the boxes of the turned corner", [...told(a, ea), ...told(b, eb)]);
    return {
      hit,
      tie: Math.min(...of.map(Math.abs)) / lengths(a, b),
      because,
      rows,
      marks: gapBar(boxAbout(a.t, ea), boxAbout(b.t, eb)),
    };
  }

  const apartBy = (p, q) => p.low.map((_, c) => Math.min(p.high[c] - q.low[c], q.high[c] - p.low[c]));

  function worldBoxes(a, b) {
    const p = worldBox(a),
      q = worldBox(b),
      of = apartBy(p, q),
      hit = [0, 1, 2].every((c) => p.low[c] <= q.high[c] && q.low[c] <= p.high[c]);
    return {
      hit,
      tie: Math.min(...of.map(Math.abs)) / lengths(a, b),
      ...overlaps(of, "the boxes of the vertices"),
      marks: gapBar(p, q),
    };
  }

  // ---- obb_sat

  function orientedBox(body) {
    const { low, high } = localBox(body.mesh),
      h = high.map((x, c) => 0.5 * (x - low[c])),
      middle = low.map((x, c) => 0.5 * (x + high[c])),
      r = rotation(body.q);
    const world = (p) => r.map((row, c) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + body.t[c]);
    return {
      h,
      middle: world(middle),
      axes: [0, 1, 2].map((i) => r.map((row) => row[i])),
      corners: signs(h).map((side) => world(add(middle, side))),
      radius: length(h) * (1 + 2 ** -50),
    };
  }

  function obbSat(a, b) {
    const p = orientedBox(a),
      q = orientedBox(b),
      between = sub(q.middle, p.middle),
      reach = p.radius + q.radius,
      spheres = reach * reach >= dot(between, between),
      wa = boxOf(p.corners.flat()),
      wb = boxOf(q.corners.flat()),
      of = apartBy(wa, wb),
      boxes = of.every((x) => x >= 0);
    const c = p.axes.map((u) => q.axes.map((v) => dot(u, v))),
      d = p.axes.map((u) => dot(u, between)),
      axes = []; // [name, overlap in units of the axis's length, that length]
    for (let i = 0; i < 3; ++i) {
      const reaches = p.h[i] + (Math.abs(c[i][0]) * q.h[0] + Math.abs(c[i][1]) * q.h[1] + Math.abs(c[i][2]) * q.h[2]);
      axes.push([`${AXES[i]} of ${a.name}`, reaches - Math.abs(d[i]), 1]);
    }
    for (let j = 0; j < 3; ++j) {
      const reaches = q.h[j] + (Math.abs(c[0][j]) * p.h[0] + Math.abs(c[1][j]) * p.h[1] + Math.abs(c[2][j]) * p.h[2]);
      axes.push([`${AXES[j]} of ${b.name}`, reaches - Math.abs(dot(q.axes[j], between)), 1]);
    }
    for (let i = 0; i < 3; ++i) {
      const k = (i + 1) % 3,
        l = (i + 2) % 3;
      for (let j = 0; j < 3; ++j) {
        // Their cross product: in the first box's frame nothing on axis i, -c[l][j] on k and c[k][j] on l.
        const m = (j + 1) % 3,
          n = (j + 2) % 3,
          u = c[k][j],
          v = c[l][j];
        const ofA = Math.abs(v) * p.h[k] + Math.abs(u) * p.h[l];
        const ofB = Math.abs(u * c[l][m] - v * c[k][m]) * q.h[m] + Math.abs(u * c[l][n] - v * c[k][n]) * q.h[n];
        const name = `${AXES[i]} of ${a.name} × ${AXES[j]} of ${b.name}`;
        axes.push([name, ofA + ofB - Math.abs(u * d[l] - v * d[k]), Math.sqrt(u * u + v * v)]);
      }
    }
    const parted = axes.filter(([, overlap]) => overlap < 0),
      hit = spheres && boxes && !parted.length;
    const inMetres = ([, overlap, long]) => (long > 0 ? overlap / long : Infinity); // nearly parallel edges part nothing
    const narrow = axes.reduce((best, axis) => (inMetres(axis) < inMetres(best) ? axis : best)),
      width = inMetres(narrow);
    const decided = !spheres
      ? `the balls about the boxes are ${metres(length(between) - reach)} apart`
      : !boxes
        ? overlaps(of, "the boxes about the boxes").because
        : parted.length
          ? `the axis ${narrow[0]} parts the boxes by ${metres(-width)}`
          : `none of 15 axes parts the boxes; least they overlap on ${narrow[0]}, by ${metres(width)}`;
    return {
      hit,
      tie: Math.min(Math.abs(reach - length(between)), ...of.map(Math.abs), Math.abs(width)) / lengths(a, b),
      because: decided,
      rows: [
        ["1. balls", `${metres(length(between))} apart, radii together ${metres(reach)}`],
        ["2. world boxes", overlaps(of, "they").because],
        [
          "3. 15 axes",
          parted.length
            ? `${parted.length} part, farthest ${narrow[0]}: ${metres(-width)}`
            : `none parts, least ${narrow[0]}: ${metres(width)}`,
        ],
      ],
      marks: boxes ? {} : gapBar(wa, wb),
    };
  }

  // ---- obb_corners

  // How far the corners of a are outside the unturned box of b, after b's turn is taken back by its negated angles.
  function cornersIn(a, b) {
    const back = euler(b.q).map((angle) => -angle),
      h = half(b.mesh),
      offset = sub(a.t, b.t);
    return turnedCorners(a).map((p) => {
      const local = turnedXyz(add(p, offset), back);
      return Math.max(...local.map((x, c) => Math.abs(x) - h[c]));
    });
  }

  const awayRow = (body) => {
    const angle = turnedAway(body);
    return angle > 1e-6
      ? [[`box of ${body.name}`, `turned ${degrees(angle)} away from the body: angles in another order`]]
      : [];
  };

  function obbCorners(a, b) {
    const inB = cornersIn(a, b),
      inA = cornersIn(b, a),
      nearest = Math.min(...inA, ...inB),
      hit = nearest <= 0;
    const told = (of, out, inside) => {
      const count = out.filter((x) => x <= 0).length;
      return [
        `corners of ${of.name}`,
        count
          ? `${count} of 8 in the box of ${inside.name}`
          : `none in the box of ${inside.name}, the nearest ${metres(Math.min(...out))} out`,
      ];
    };
    const dots = (of, out) =>
      turnedCorners(of)
        .map((p) => add(p, of.t))
        .filter((_, i) => out[i] <= 0);
    return {
      hit,
      tie: Math.abs(nearest) / lengths(a, b),
      because: hit
        ? `a corner is in the other's box, ${metres(-nearest)} deep`
        : `no corner of either box is in the other; the nearest is ${metres(nearest)} out`,
      rows: [told(a, inB, b), told(b, inA, a), ...awayRow(a), ...awayRow(b)],
      marks: { points: [...dots(a, inB), ...dots(b, inA)] },
    };
  }

  // ---- triangles

  // The eleven axes of the published triangle test: the gap in metres on the one that parts them most, negative when
  // none does. Gives up, with that gap, at the first beyond `enough`. An axis of length 0 parts nothing.
  function elevenAxes(s, t, enough = Infinity) {
    const e0 = sub(s[1], s[0]),
      e1 = sub(s[2], s[0]),
      f0 = sub(t[1], t[0]),
      f1 = sub(t[2], t[0]),
      e = [e0, e1, sub(e1, e0)],
      f = [f0, f1, sub(f1, f0)],
      normal = cross(e0, e1),
      other = cross(f0, f1),
      d = sub(t[0], s[0]);
    let most = -Infinity;
    const look = (axis, p, q, to, r, u) => {
      const x = to + r,
        y = to + u,
        gap = Math.max(Math.min(to, x, y) - Math.max(0, p, q), Math.min(0, p, q) - Math.max(to, x, y)),
        long = length(axis);
      if (long > 0 && gap / long > most) most = gap / long;
    };
    look(normal, 0, 0, dot(normal, d), dot(normal, f0), dot(normal, f1));
    look(other, dot(other, e0), dot(other, e1), dot(other, d), 0, 0);
    for (let i = 0; i < 3 && !(most > enough); ++i)
      for (let j = 0; j < 3; ++j) {
        const axis = cross(e[i], f[j]);
        look(
          axis,
          i === 0 ? 0 : dot(axis, e0),
          i === 1 ? 0 : dot(axis, e1),
          dot(axis, d),
          j === 0 ? 0 : dot(axis, f0),
          j === 1 ? 0 : dot(axis, f1),
        );
      }
    return most;
  }

  // The first pair of triangles that `test` does not part, or the one that it parts least: { gap, pair }; null when that
  // is too much work.
  function triangles(of, against, test) {
    if (of.length * against.length > MOST_TRIANGLES) return null;
    const best = { gap: Infinity, pair: null };
    for (const s of of)
      for (const t of against) {
        const gap = test(s, t, best.gap);
        if (gap < best.gap) Object.assign(best, { gap, pair: [s, t] });
        if (gap <= 0) return best;
      }
    return best;
  }

  function triangleAnswer(a, b, best, test, rows) {
    const hit = best.gap <= 0;
    return {
      hit,
      tie: Math.abs(best.gap) / lengths(a, b),
      because: hit
        ? `${test} does not part this pair of triangles`
        : `${test} parts every pair of triangles; the nearest by ${metres(best.gap)}`,
      rows,
      marks: best.pair
        ? {
            faces: best.pair,
            lines: best.pair.flatMap(([p, q, r]) => [
              [p, q],
              [q, r],
              [r, p],
            ]),
          }
        : {},
    };
  }

  const boxTriangles = (body) => boxFaces(turnedCorners(body).map((p) => add(p, body.t)));

  function obbTriangles(a, b) {
    const best = triangles(boxTriangles(a), boxTriangles(b), elevenAxes);
    return triangleAnswer(a, b, best, "the test on 11 axes", [
      ["compared", "12 × 12 triangles of the turned boxes' surfaces"],
      ...awayRow(a),
      ...awayRow(b),
    ]);
  }

  // ---- what samples facets

  function chosen(body, knobs) {
    const fixed = "facets_per_area" in knobs;
    return sampled(body.mesh, {
      facetsPerArea: fixed ? knobs.facets_per_area : 8,
      stride: fixed ? 0 : knobs.stride,
      dense: knobs.densify,
      inflate: knobs.inflate,
    });
  }

  const facetRow = (body, knobs) => {
    const { count, facets, stride } = chosen(body, knobs),
      own = body.mesh.index.length / 3;
    return [
      `facets of ${body.name}`,
      `${many(count, "point")} of ${facets.toLocaleString("en")}` +
        (stride > 1 ? `, one in ${stride.toLocaleString("en")}` : "") +
        (facets > own ? ` (made denser, its mesh has ${own.toLocaleString("en")})` : ""),
    ];
  };

  const tooMany = (rows) => unknown("too much to compute again in a page; the file has the answer", rows);

  function facetDistance(a, b, knobs) {
    const rows = [facetRow(a, knobs), facetRow(b, knobs)],
      [one, other] = [a, b].map((body) => chosen(body, knobs));
    if (!one.points || !other.points) return tooMany(rows);
    if (!one.count || !other.count)
      return { hit: false, tie: 1, because: "a body without facets has no points", rows, marks: {} };
    const [small, large] = [placed(a, one.points), placed(b, other.points)].sort((p, q) => p.length - q.length);
    // What is nearest to the small set is no farther from its box's middle than its nearest known point allows.
    const { low, high } = boxOf(small),
      middle = low.map((x, c) => (x + high[c]) / 2),
      radius = length(sub(high, low)) / 2;
    const square = (p, i, q, k) => {
      const dx = p[i] - q[k],
        dy = p[i + 1] - q[k + 1],
        dz = p[i + 2] - q[k + 2];
      return dx * dx + dy * dy + dz * dz;
    };
    let reach = Infinity;
    const away = new Float64Array(large.length / 3);
    for (let k = 0; k < large.length; k += 3) {
      away[k / 3] = Math.sqrt(square(middle, 0, large, k));
      reach = Math.min(reach, away[k / 3] + radius);
    }
    let best = Infinity,
      pair = [0, 0],
      looked = 0;
    for (let k = 0; k < large.length; k += 3) {
      if (away[k / 3] - radius > reach * (1 + 1e-9)) continue;
      looked += small.length / 3;
      if (looked > MOST_WORK) return tooMany(rows);
      for (let i = 0; i < small.length; i += 3) {
        const d = square(small, i, large, k);
        if (d < best) ((best = d), (pair = [i, k]));
      }
    }
    const limit = knobs.max_distance,
      hit = best < limit * limit,
      nearest = Math.sqrt(best);
    return {
      hit,
      tie: Math.abs(nearest - limit) / lengths(a, b),
      because: `the nearest two facet points are ${metres(nearest)} apart, ${hit ? "" : "not "}nearer than ${metres(limit)}`,
      rows,
      marks: { lines: [[[...small.subarray(pair[0], pair[0] + 3)], [...large.subarray(pair[1], pair[1] + 3)]]] },
    };
  }

  function facetVectors(a, b, knobs) {
    const rows = [facetRow(a, knobs), facetRow(b, knobs)],
      [one, other] = [a, b].map((body) => chosen(body, knobs));
    if (!one.points || !other.points || one.count * other.count > MOST_WORK / 3) return tooMany(rows);
    if (!one.count || !other.count)
      return { hit: false, tie: 1, because: "a body without facets has no points", rows, marks: {} };
    const from = placed(a, one.points),
      to = placed(b, other.points);
    let hit = null,
      tie = Infinity,
      marks = {};
    const told = [];
    for (const [u, v, w] of [
      [0, 1, 2],
      [1, 2, 0],
      [2, 0, 1],
    ]) {
      const ways = new Set();
      let third = Infinity,
        pair = [0, 0];
      for (let i = 0; i < from.length; i += 3)
        for (let k = 0; k < to.length; k += 3) {
          ways.add((to[k + u] > from[i + u] ? 1 : 0) + (to[k + v] > from[i + v] ? 2 : 0));
          const across = Math.abs(to[k + w] - from[i + w]);
          if (across < third) ((third = across), (pair = [i, k]));
        }
      const plane = AXES[u] + AXES[v],
        short = third < knobs.max_third;
      if (ways.size === 4) tie = Math.min(tie, Math.abs(third - knobs.max_third));
      if (ways.size === 4 && short && !hit) {
        hit = plane;
        marks = { lines: [[[...from.subarray(pair[0], pair[0] + 3)], [...to.subarray(pair[1], pair[1] + 3)]]] };
      }
      rows.push([
        `plane ${plane}`,
        `${ways.size} of 4 quadrants; least |${AXES[w]}| ${metres(third)}, ` +
          `${short ? "" : "not "}shorter than ${metres(knobs.max_third)}`,
      ]);
      told.push([plane, ways.size, short]);
    }
    const nearly = told.filter(([, ways]) => ways === 4).map(([plane]) => plane);
    const because = hit
      ? `the vectors between the points face all four ways in the plane ${hit} and are short across it`
      : nearly.length
        ? `the vectors face all four ways in the plane ${nearly.join(" and ")}, but are too long across it`
        : "in no plane do the vectors between the points face all four ways";
    return { hit: hit !== null, tie: Math.min(1, tie / lengths(a, b)), because, rows, marks };
  }

  function sampledTriangles(body, knobs) {
    const points = placed(body, chosen(body, knobs).points),
      step = knobs.triangles === "strip" ? 3 : 9,
      out = [];
    const at = (i) => [points[i], points[i + 1], points[i + 2]];
    for (let i = 0; i + 9 <= points.length; i += step) out.push([at(i), at(i + 3), at(i + 6)]);
    return out;
  }

  function envelopes(a, b, knobs, test, name) {
    const rows = [facetRow(a, knobs), facetRow(b, knobs)];
    if ([a, b].some((body) => !chosen(body, knobs).points)) return tooMany(rows);
    const [one, other] = [a, b].map((body) => sampledTriangles(body, knobs));
    rows.push([
      "triangles",
      `${one.length.toLocaleString("en")} × ${other.length.toLocaleString("en")} ` +
        `(${knobs.triangles}, ${knobs.inflate} times the body)`,
    ]);
    const empty = [a, b].filter((_, i) => ![one, other][i].length);
    if (empty.length)
      return {
        hit: false,
        tie: 1,
        because: empty
          .map((body) => `${body.name} has ${many(chosen(body, knobs).count, "sampled point")}, so no triangle`)
          .join("; "),
        rows,
        marks: {},
      };
    const best = triangles(one, other, test);
    return best ? triangleAnswer(a, b, best, name, rows) : tooMany(rows);
  }

  // The directions along which facet_rotations compares: x, y and z after turns by a about z and by b about x.
  const grids = new Map();
  function grid(step) {
    if (grids.has(step)) return grids.get(step);
    const n = Math.round(180 / step),
      lines = new Map();
    // Exactly 0 and 1 at multiples of 90 degrees.
    const sine = (i) => (i === 0 || i === n ? 0 : 2 * i === n ? 1 : Math.sin((i * Math.PI) / n));
    const cosine = (i) => (i === 0 ? 1 : i === n ? -1 : 2 * i === n ? 0 : Math.cos((i * Math.PI) / n));
    const keep = (...d) => {
      const first = d.find((x) => Math.abs(x) > 1e-9) < 0 ? -1 : 1;
      lines.set(d.map((x) => Math.round(first * x * 1e9)).join(), d);
    };
    for (let i = 1; i <= n; ++i) {
      keep(cosine(i), -sine(i), 0);
      for (let k = 1; k <= n; ++k) {
        keep(cosine(k) * sine(i), cosine(k) * cosine(i), -sine(k));
        keep(sine(k) * sine(i), sine(k) * cosine(i), cosine(k));
      }
    }
    grids.set(step, [...lines.values()]);
    return grids.get(step);
  }

  // A test of triangles along those directions, as elevenAxes; the direction that parted last is tried first.
  function rotated(directions) {
    let last = 0;
    return (s, t, enough = Infinity) => {
      let most = -Infinity;
      for (let i = 0; i < directions.length; ++i) {
        const k = i === 0 ? last : i === last ? 0 : i,
          d = directions[k],
          x = s.map((p) => dot(d, p)),
          y = t.map((p) => dot(d, p)),
          gap = Math.max(Math.min(...y) - Math.max(...x), Math.min(...x) - Math.max(...y));
        if (gap > most) most = gap;
        if (most > enough) return ((last = k), most);
      }
      return most;
    };
  }

  // ---- Cannon.js

  const nominal = (body) => body.mesh.ball || length(half(body.mesh));

  const squares = (a, b) => (reach) => {
    const d = sub(a.t, b.t);
    return dot(d, d) < reach * reach;
  };
  const cannonBalls = (a, b) => balls(a, b, nominal(a), nominal(b), squares(a, b));

  // The lower bound along x of the box about the body's position, in the engine's own order of sums.
  function lowest(body) {
    if (body.mesh.ball) return body.t[0] - nominal(body);
    const [w, qx, qy, qz] = body.q;
    return Math.min(
      ...signs(half(body.mesh)).map(([x, y, z]) => {
        const ix = w * x + qy * z - qz * y,
          iy = w * y + qz * x - qx * z,
          iz = w * z + qx * y - qy * x,
          iw = -qx * x - qy * y - qz * z;
        return body.t[0] + (ix * w + iw * -qx + iy * -qz - iz * -qy);
      }),
    );
  }

  // Sweep along x, which ends at the first ball apart: `all` are the bodies of the step that are there, by number.
  function cannonSap(a, b, knobs, all) {
    const answer = cannonBalls(a, b),
      order = [...all.entries()]
        .filter(([, body]) => body)
        .map(([number, body]) => ({ number, body, from: lowest(body) }));
    order.sort((p, q) => p.from - q.from || p.number - q.number);
    const places = [a, b].map((body) => order.findIndex((entry) => entry.body === body)),
      first = Math.min(...places),
      second = Math.max(...places);
    const start = order[first].body,
      end = start.t[0] + nominal(start);
    const begins = (body) => body.t[0] - nominal(body);
    const breaks = order
      .slice(first + 1, second + 1)
      .find(({ body }) => !(start.fixed && body.fixed) && !(begins(body) < end));
    answer.rows.unshift([
      "sweep along x",
      `from ${start.name}, whose ball ends at x = ${metres(end)}, ` +
        `${many(second - first, "place")} on to ${order[second].body.name}`,
    ]);
    if (!breaks) return answer;
    answer.tie = Math.min(answer.tie, Math.abs(begins(breaks.body) - end) / lengths(a, b));
    const where =
      breaks.body === order[second].body
        ? ""
        : `, ${many(second - order.indexOf(breaks), "place")} before ${order[second].body.name}`;
    return {
      ...answer,
      hit: false,
      because:
        `the sweep ends at ${breaks.body.name}, whose ball begins at x = ${metres(begins(breaks.body))}${where}` +
        (answer.hit ? "; the balls do overlap" : ""),
    };
  }

  // ---- what the file has in place of meshes, by label: balls, a capsule's two ends, or closed surfaces

  const placedBalls = (body, { balls }) =>
    Array.from({ length: balls.length / 4 }, (_, i) => [
      [...placed(body, balls.subarray(4 * i, 4 * i + 3))],
      balls[4 * i + 3],
    ]);

  function proxyView(body, proxy) {
    const found = { lines: [], faces: [], points: [], balls: proxy.balls ? placedBalls(body, proxy) : [] };
    if (proxy.kind === "capsule") {
      const [[p, r], [q]] = found.balls,
        axis = sub(q, p),
        aside = cross(axis, Math.abs(axis[0]) < Math.abs(axis[1]) ? [1, 0, 0] : [0, 1, 0]),
        other = cross(axis, aside);
      const unit = (d) => (length(d) > 0 ? d.map((x) => x / length(d)) : d);
      for (let i = 0; i < 12 && length(axis) > 0; ++i) {
        const angle = (i * Math.PI) / 6,
          off = unit(aside).map((x, c) => r * (x * Math.cos(angle) + unit(other)[c] * Math.sin(angle)));
        found.lines.push([add(p, off), add(q, off)]);
      }
    }
    if (proxy.index) {
      const world = list(placed(body, proxy.corners));
      for (let i = 0; i < proxy.index.length; i += 3) {
        const [p, q, r] = [0, 1, 2].map((c) => world[proxy.index[i + c]]);
        found.faces.push([p, q, r]);
        found.lines.push([p, q], [q, r], [r, p]);
      }
    }
    return found;
  }

  function wrapRow(body, { outside_share: share, outside_greatest: greatest }) {
    if (typeof share !== "number") return [];
    const out =
      share > 0
        ? `${digits(100 * share, 3)} % of its vertices are outside, at most ${metres(greatest)}`
        : "holds all vertices";
    return [[`proxy of ${body.name}`, out]];
  }

  // The surfaces of the proxies as measure() takes them.
  function proxySurface(body, proxy) {
    const world = list(placed(body, proxy.corners));
    return { index: proxy.index, vertex: (i) => world[i] };
  }

  function proxies(a, b, [p, q]) {
    const rows = [...wrapRow(a, p), ...wrapRow(b, q)];
    if (p.index && q.index) {
      const found = measure(proxySurface(a, p), proxySurface(b, q));
      if (!found) return tooMany(rows);
      if (found.pairs)
        return {
          hit: true,
          tie: 1,
          because: `${many(found.pairs, "pair")} of the proxies' triangles cross`,
          rows,
          marks: { lines: found.segments },
        };
      const { distance, from, to } = found.gap;
      return {
        ...unknown(`the proxies' surfaces are ${metres(distance)} apart, or one lies in the other`, rows),
        marks: { lines: [[from, to]] },
      };
    }
    if (!p.balls || !q.balls) return unknown("its proxies are of different kinds", rows);
    const [one, other] = [placedBalls(a, p), placedBalls(b, q)];
    const capsules = p.kind === "capsule" && q.kind === "capsule";
    let best = { gap: Infinity };
    const look = (from, r, to, t) => {
      const gap = length(sub(from, to)) - (r + t);
      if (gap < best.gap) best = { gap, from, r, to, t };
    };
    if (capsules) {
      const [from, to] = measure.between(one[0][0], one[1][0], other[0][0], other[1][0]);
      look(from, one[0][1], to, other[0][1]);
    } else for (const [from, r] of one) for (const [to, t] of other) look(from, r, to, t);
    const hit = best.gap <= 0,
      what = capsules ? "the capsules" : "the nearest two balls";
    const to =
      length(sub(best.to, best.from)) > 0
        ? sub(best.to, best.from).map((x) => x / length(sub(best.to, best.from)))
        : [1, 0, 0];
    return {
      hit,
      tie: Math.abs(best.gap) / lengths(a, b),
      because: hit ? `${what} overlap by ${metres(-best.gap)}` : `${what} are ${metres(best.gap)} apart`,
      rows: [
        ...rows,
        [
          "compared",
          capsules
            ? "the segments within"
            : `${one.length} × ${other.length} balls, where those about the whole bodies touch`,
        ],
      ],
      marks: hit ? {} : { lines: [[along(best.from, to, best.r), along(best.to, to, -best.t)]] },
    };
  }

  // ---- the methods

  const FILTER = { prefilter: "rotated_aabb" };
  const ENVELOPE = { ...FILTER, stride: 20, inflate: 1.1, triangles: "disjoint", densify: false };
  const ball = (radius) => (body) => ({ balls: [[body.t, radius(body)]] });
  const points = (body, knobs) => {
    const { points } = chosen(body, knobs);
    return points ? { points: list(placed(body, points)) } : {};
  };
  const envelope = (body, knobs) => {
    if (!chosen(body, knobs).points) return {};
    const faces = sampledTriangles(body, knobs);
    return {
      ...points(body, knobs),
      faces,
      lines: faces.flatMap(([p, q, r]) => [
        [p, q],
        [q, r],
        [r, p],
      ]),
    };
  };
  const turnedBox = (body) => turnedCorners(body).map((p) => add(p, body.t));

  // compare(a, b, knobs, all), view(body, knobs), presets: knobs of a prefilter, and what: the words of the page.
  const METHODS = {
    obb_sat: {
      what: "the boxes of the vertices, turned with the bodies",
      compare: obbSat,
      view: (body) => drawnBox(orientedBox(body).corners),
    },
    bounding_sphere: {
      what: "balls of the half diagonal about the positions",
      compare: (a, b) => balls(a, b, length(half(a.mesh)), length(half(b.mesh)), (reach, apart) => reach > apart),
      view: ball((body) => length(half(body.mesh))),
    },
    rotated_aabb: {
      what: "boxes along the world's axes, from one corner turned by the Euler angles",
      compare: rotatedAabb,
      view: (body) => drawnBox(cornersOf(boxAbout(body.t, turnedExtents(body)))),
    },
    facet_distance: {
      what: "points of sampled facets",
      presets: { ...FILTER, max_distance: 0.25, facets_per_area: 8, densify: true },
      compare: facetDistance,
      view: points,
    },
    obb_corners: {
      what: "the corners of the turned boxes",
      compare: obbCorners,
      view: (body) => ({ ...drawnBox(turnedBox(body)), points: turnedBox(body) }),
    },
    facet_vectors: {
      what: "points of sampled facets, and the vectors between them",
      presets: { ...FILTER, stride: 20, max_third: 0.5, densify: false },
      compare: facetVectors,
      view: points,
    },
    obb_triangles: {
      what: "the triangles of the turned boxes",
      presets: FILTER,
      compare: obbTriangles,
      view: (body) => ({
        faces: boxTriangles(body),
        lines: boxTriangles(body).flatMap(([p, q, r]) => [
          [p, q],
          [q, r],
          [r, p],
        ]),
      }),
    },
    facet_triangles: {
      what: "triangles between points of sampled facets",
      presets: ENVELOPE,
      compare: (a, b, knobs) => envelopes(a, b, knobs, elevenAxes, "the test on 11 axes"),
      view: envelope,
    },
    facet_rotations: {
      what: "triangles between points of sampled facets",
      presets: { ...ENVELOPE, angle_step: 10 },
      compare: (a, b, knobs) => {
        const directions = grid(knobs.angle_step);
        return envelopes(a, b, knobs, rotated(directions), `the test along ${directions.length} directions`);
      },
      view: envelope,
    },
    aabb: {
      what: "boxes of the vertices along the world's axes",
      compare: worldBoxes,
      view: (body) => drawnBox(cornersOf(worldBox(body))),
    },
    cannon_naive: { what: "the engine's balls about the positions", compare: cannonBalls, view: ball(nominal) },
    cannon_sap: {
      what: "the engine's balls about the positions, swept along x",
      compare: cannonSap,
      view: ball(nominal),
    },
  };

  const SURFACES = ["exact", "exact_cold", "fcl_bvh", "all_triangles"];

  function view(name, knobs, body, label) {
    const method = METHODS[name],
      proxy = body.mesh.proxies[label];
    return proxy ? proxyView(body, proxy) : method ? method.view(body, { ...method.presets, ...knobs }) : {};
  }

  // { hit, tie, because, rows, marks, own, filter: { name, answer } }: as the comparisons; `hit` is null where it is not
  // known, `own` is the answer without the prefilter. `all`: the bodies of the step, by number, undefined where one is
  // not there. With `short` nothing is computed that does not change the hit.
  function compare(name, knobs, a, b, { all, label, short = false }) {
    const method = METHODS[name],
      known = { ...(method ? method.presets : {}), ...knobs },
      pair = [a, b].map((body) => body.mesh.proxies[label]);
    const filter =
      known.prefilter && known.prefilter !== "none"
        ? { name: known.prefilter, answer: compare(known.prefilter, {}, a, b, { all, short }) }
        : null;
    const stopped = filter !== null && filter.answer.hit === false;
    if (stopped && short) return { ...filter.answer, filter };
    const own = pair.every(Boolean)
      ? proxies(a, b, pair)
      : method
        ? method.compare(a, b, known, all)
        : unknown(
            SURFACES.includes(name)
              ? "it compares the surfaces themselves, as they are drawn"
              : "what it compares is not known to this page",
          );
    if (!filter) return own;
    const hit = stopped || own.hit === false ? false : filter.answer.hit === null ? null : own.hit;
    return {
      ...own,
      hit,
      tie: Math.min(own.hit === null ? 1 : own.tie, filter.answer.tie),
      own: own.hit,
      marks: stopped ? filter.answer.marks : own.marks,
      stopped,
      filter,
    };
  }

  const presets = Object.fromEntries(Object.entries(METHODS).map(([name, { presets = {} }]) => [name, presets]));
  const what = (name) => (METHODS[name] ? METHODS[name].what : "");
  return { view, compare, presets, what, metres, digits };
})();
