// Axis-aligned boxes of the world vertices, the built-in `aabb` once more: an example of a method in JavaScript.
//
//   pipeline detect results/padani.h5 --algorithm 'program:command=node algorithms/program/world_boxes.mjs@boxes'
import {serve} from './collision_program.mjs';

function setup(run) {
  const vertices = run.bodies.map(body => run.meshes[body.mesh].vertices);
  const boxes = new Float64Array(6 * vertices.length);  // low and high along x, y and z
  const prepare = step => {
    for (let body = 0; body < vertices.length; ++body) {
      const t = step.position(body), [w, x, y, z] = step.orientation(body);
      if (Number.isNaN(w)) continue;  // not there yet
      const rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]];
      for (let axis = 0; axis < 3; ++axis) {
        const [a, b, c] = rows[axis];
        let low = Infinity, high = -Infinity;
        for (const [p, q, r] of vertices[body]) {
          const along = ((a * p + b * q) + c * r) + t[axis];
          if (along < low) low = along;
          if (along > high) high = along;
        }
        boxes[6 * body + 2 * axis] = low;
        boxes[6 * body + 2 * axis + 1] = high;
      }
    }
  };
  const touch = (a, b) => {
    for (let i = 0; i < 6; i += 2)
      if (!(boxes[6 * a + i] <= boxes[6 * b + i + 1] && boxes[6 * b + i] <= boxes[6 * a + i + 1])) return false;
    return true;
  };
  const answer = step => {
    const hits = [];
    for (let i = 0; i < step.runs.length; i += 3)
      for (let a = step.runs[i], b = step.runs[i + 1]; b < step.runs[i + 2]; ++b)
        if (touch(a, b)) hits.push([a, b]);
    return hits;
  };
  return {prepare, answer};
}

serve(setup, {name: 'world_boxes', version: '1'});
