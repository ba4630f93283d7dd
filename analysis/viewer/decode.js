// What viewer.py put into the page (its _page_data says what), decoded: lists of pairs by step, meshes, poses.
"use strict";

function decoded(data) {
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const Ends = data.wide ? Uint32Array : Uint16Array;

  // Lists of pairs, one per step of the window.
  function lists(packed) {
    const offset = new Uint32Array(bytes(packed.offset)),
      ends = new Ends(bytes(packed.pair));
    return {
      count: (k) => offset[k + 1] - offset[k],
      at: (k) =>
        Array.from({ length: offset[k + 1] - offset[k] }, (_, i) => [
          ends[2 * (offset[k] + i)],
          ends[2 * (offset[k] + i) + 1],
        ]),
    };
  }

  const key = (pair) => pair[0] + "-" + pair[1];
  const keys = (pairs) => new Set(pairs.map(key));
  const truth = lists(data.truth),
    contained = lists(data.contained);
  const algorithms = data.algorithms.map((a) => ({
    ...a,
    given: JSON.parse(a.knobs || "{}"),
    fp: lists(a.fp),
    fn: lists(a.fn),
    inside: lists(a.inside),
  }));
  const position = new Float64Array(bytes(data.position)),
    orientation = new Float64Array(bytes(data.orientation));
  const meshes = data.meshes.map((mesh) => {
    const corners = new Float64Array(bytes(mesh.vertices)),
      // About the middle of the mesh's box, so that vertices far from their origin keep their shape in single precision.
      vertices = Float32Array.from(corners, (x, i) => (x - mesh.centre[i % 3]) / data.unit);
    let radius = 0;
    for (let i = 0; i < vertices.length; i += 3)
      radius = Math.max(radius, Math.hypot(vertices[i], vertices[i + 1], vertices[i + 2]));
    const proxies = Object.fromEntries(
      Object.entries(mesh.proxies).map(([label, parts]) => [
        label,
        {
          ...parts,
          balls: parts.balls && new Float64Array(bytes(parts.balls)),
          corners: parts.vertices && new Float64Array(bytes(parts.vertices)),
          index: parts.triangles && new Uint32Array(bytes(parts.triangles)),
        },
      ]),
    );
    return { ...mesh, corners, vertices, radius, proxies, index: new Uint32Array(bytes(mesh.triangles)) };
  });

  function turned([w, x, y, z], v) {
    const a = 2 * (y * v[2] - z * v[1]),
      b = 2 * (z * v[0] - x * v[2]),
      c = 2 * (x * v[1] - y * v[0]);
    return [v[0] + w * a + y * c - z * b, v[1] + w * b + z * a - x * c, v[2] + w * c + x * b - y * a];
  }

  // The body as the algorithms have it, in metres (sees.js says what is in it); null when it is not there.
  function body(number, k) {
    const i = k * data.bodies.length + number,
      q = orientation.subarray(4 * i, 4 * i + 4),
      t = position.subarray(3 * i, 3 * i + 3);
    if (![...q, ...t].every(isFinite)) return null;
    const { name, fixed, mesh } = data.bodies[number];
    return { name, fixed, q: [...q], t: [...t], mesh: meshes[mesh] };
  }

  // From metres to what is drawn: units of data.unit metres about data.centre.
  const toDrawn = (p) => p.map((x, c) => (x - data.centre[c]) / data.unit);

  // Where bodies are drawn: w x y z of the turn, then the middle of the mesh, seven numbers a body.
  const poses = new Float32Array(7 * data.count * data.bodies.length);
  for (let i = 0; i < data.count * data.bodies.length; ++i) {
    const q = orientation.subarray(4 * i, 4 * i + 4),
      middle = turned(q, meshes[data.bodies[i % data.bodies.length].mesh].centre);
    poses.set(q, 7 * i);
    poses.set(toDrawn(middle.map((x, c) => x + position[3 * i + c])), 7 * i + 4);
  }

  // What is so at step k of the window for the algorithm: lists of pairs by kind.
  function answers(k, algorithm) {
    const real = truth.at(k);
    if (!algorithm) return { fn: [], fp: [], tp: real, inside: contained.at(k) };
    const fn = algorithm.fn.at(k),
      missed = keys(fn);
    return {
      fn,
      fp: algorithm.fp.at(k),
      tp: real.filter((p) => !missed.has(key(p))),
      inside: data.containment === "record" ? contained.at(k) : [],
    };
  }

  return { key, keys, truth, contained, algorithms, poses, meshes, turned, body, toDrawn, answers };
}
