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
  const algorithms = data.algorithms.map((a) => ({ ...a, fp: lists(a.fp), fn: lists(a.fn), inside: lists(a.inside) }));
  const poses = new Float32Array(bytes(data.poses));
  const meshes = data.meshes.map((mesh) => ({
    ...mesh,
    vertices: new Float32Array(bytes(mesh.vertices)),
    index: new Uint32Array(bytes(mesh.triangles)),
  }));
  for (const mesh of meshes) {
    let most = 0;
    for (let i = 0; i < mesh.vertices.length; i += 3)
      most = Math.max(most, Math.hypot(mesh.vertices[i], mesh.vertices[i + 1], mesh.vertices[i + 2]));
    mesh.radius = most;
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

  return { key, keys, truth, contained, algorithms, poses, meshes, answers };
}
