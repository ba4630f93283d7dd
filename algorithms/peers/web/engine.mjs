// What the engines of this folder share: the version that is asked for, a self-test, meshes with what engines want to
// know of them, and the pairs that are near, for those without a broad phase of their own.
import {readFileSync} from 'node:fs';
import {setFlagsFromString} from 'node:v8';
import {runInNewContext} from 'node:vm';
import {serve} from '../../program/collision_program.mjs';

const json = file => JSON.parse(readFileSync(new URL(file, import.meta.url), 'utf8'));
const installs = 'scripts/peers web installs it';

/** Throws an error of one line. */
export function refuse(why) {
  throw Object.assign(new Error(why), {stack: why});
}

/** The package.json of an installed package, of the version that ours asks for. */
function installed(name) {
  const wanted = json('package.json').dependencies[name];
  let found;
  try {
    found = json(`node_modules/${name}/package.json`);
  } catch {
    refuse(`${name} ${wanted} is not installed; ${installs}`);
  }
  if (found.version !== wanted) refuse(`${name} must be of version ${wanted}, not ${found.version}; ${installs}`);
  return found;
}

/** Bytes that this process holds, those of WebAssembly included, garbage collected. */
async function held() {
  setFlagsFromString('--expose_gc');
  const collect = runInNewContext('gc');
  for (let i = 0; i < 3; ++i) {  // what is let go of by a first pass goes with the next
    collect();
    await new Promise(setImmediate);
  }
  const {heapUsed, external} = process.memoryUsage();
  return heapUsed + external;
}

/**
 * Serves an engine. `about`: name, packages (the first answers), tests, precision and what else a hello says; and
 * whether knobs are such that the self-test tells something (self_test).
 * `make(world, knobs)`, for the self-test and then for the bodies of the run, gives
 *   place(body, pose, at)  moves a body: pose[at], ... are px py pz qw qx qy qz
 *   prepare(there)         after the bodies were placed, there[body] is 1 for those that are born; may be left out
 *   meets(a, b)            of a pair; with about.near it is asked only of pairs whose boxes and balls touch
 *   report(hit)            instead: calls hit(a, b) for every pair that meets, whichever first; as often as it likes, but
 *                          for `once`
 *   about                  what its hello says otherwise for these knobs
 *   remember(), forget()   as of the adapter; of those that have a memory between steps that can be put back
 */
export function engine({packages, near = false, self_test = () => true, ...about}, make) {
  serve(async ({bodies, meshes, knobs}) => {
    const [first, ...more] = packages.map(installed);
    about.version = [first.version, ...more.map(one => `${one.name} ${one.version}`)].join(', ');
    about.licence = [...new Set([first, ...more].map(one => one.license))].join(', ');
    if (self_test(knobs)) await test_itself(make, near, knobs);
    const world = world_of(bodies, meshes), before = await held(), begin = process.hrtime.bigint();
    let method;
    try {
      method = method_of(world, await make(world, knobs), near);
    } catch (error) {  // the engine is well: what it cannot do is its label's status
      about.refuses = String(error?.message ?? error).replace(/\s+/g, ' ').slice(0, 200);
      return {about};
    }
    about.setup_ns = Number(process.hrtime.bigint() - begin);
    Object.assign(about, method.about);
    about.memory_bytes = Math.max(0, await held() - before);
    return {...method, about};
  });
}

/** Bodies with their meshes, and what engines want to know of these. */
function world_of(bodies, meshes) {
  const made = meshes.map(({name, vertices, triangles}) =>
    described(name, Float64Array.from(vertices.flat()), Uint32Array.from(triangles.flat())));
  return {meshes: made, bodies: bodies.map(({name, mesh, fixed}) => ({name, fixed, mesh: made[mesh]}))};
}

/** A mesh: middle and half extents of its box, `reach`, the half extents of one about its origin, `ball`, the radius of
 *  a ball about the middle; and what it is by its vertices: `box`, `sphere` (its radius, else 0) or `capsule` (along y:
 *  radius and half of the length between the centres, else null). */
function described(name, vertices, triangles) {
  const low = [Infinity, Infinity, Infinity], high = low.map(x => -x);
  for (let i = 0; i < vertices.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], vertices[i]);
    high[i % 3] = Math.max(high[i % 3], vertices[i]);
  }
  const middle = low.map((x, axis) => (x + high[axis]) / 2), half = low.map((x, axis) => (high[axis] - x) / 2);
  const reach = low.map((x, axis) => Math.max(Math.abs(x), Math.abs(high[axis])));
  const points = Array.from({length: vertices.length / 3}, (_, i) => vertices.subarray(3 * i, 3 * i + 3));
  const centred = Math.hypot(...middle) <= 1e-12 * Math.hypot(...reach);
  const all = (distance, wanted) => points.every(p => Math.abs(distance(p) - wanted) <= 1e-9 * wanted);
  const corner = p => p.every((x, axis) => Math.abs(Math.abs(x - middle[axis]) - half[axis]) <= 1e-12 * half[axis]);
  const box = triangles.length === 36 && points.every(corner) &&
      new Set(points.map(p => p.map((x, axis) => Math.sign(x - middle[axis])).join())).size === 8;
  const far = Math.max(...points.map(p => Math.hypot(...p)));
  const sphere = !box && centred && points.length > 12 && all(p => Math.hypot(...p), far) ? Number(far.toPrecision(12)) : 0;
  const radius = Math.max(...points.map(([x, , z]) => Math.hypot(x, z))), between = reach[1] - radius;
  const off = ([x, y, z]) => Math.hypot(x, y - Math.max(-between, Math.min(between, y)), z);
  const capsule = !box && !sphere && centred && between > 0 && all(off, radius)
      ? {radius: Number(radius.toPrecision(12)), half: Number(between.toPrecision(12))} : null;
  const ball = Math.max(...points.map(p => Math.hypot(...p.map((x, axis) => x - middle[axis]))));
  return {name, vertices, triangles, middle, half, reach, ball, box, sphere, capsule};
}

/** prepare and answer of the adapter, by an engine. */
function method_of({bodies}, made, near) {
  const count = bodies.length, last = new Float64Array(7 * count), there = new Uint8Array(count);
  const boxes = near ? new Boxes(bodies) : null;
  const prepare = ({poses}) => {
    for (let body = 0; body < count; ++body) {
      const at = 7 * body;
      if (!(there[body] = Number.isNaN(poses[at]) ? 0 : 1)) continue;
      if (bodies[body].fixed) {  // stays where it was put
        let stays = true;
        for (let i = 0; i < 7; ++i) stays &&= last[at + i] === poses[at + i];
        if (stays) continue;
        last.set(poses.subarray(at, at + 7), at);
      }
      made.place(body, poses, at);
      boxes?.place(body, poses, at);
    }
    made.prepare?.(there);
  };
  const by_pair = ({runs}) => {
    const hits = [];
    for (let i = 0; i < runs.length; i += 3)
      for (let a = runs[i], b = runs[i + 1], end = runs[i + 2]; b < end; ++b)
        if ((!near || boxes.touch(a, b)) && made.meets(a, b)) hits.push([a, b]);
    return hits;
  };
  const begin = new Int32Array(count);  // of the runs of a body
  const by_report = ({runs}) => {
    const hits = [], seen = new Set();
    begin.fill(-1);
    for (let i = runs.length - 3; i >= 0; i -= 3) begin[runs[i]] = i;
    made.report((one, other) => {
      const a = Math.min(one, other), b = Math.max(one, other);
      for (let i = begin[a]; i >= 0 && runs[i] === a; i += 3)
        if (b >= runs[i + 1] && b < runs[i + 2]) {
          const {size} = seen;
          if (made.once || seen.add(a * count + b).size > size) hits.push([a, b]);
        }
    });
    return hits;
  };
  const {remember, forget, about} = made;
  return {prepare, answer: made.meets ? by_pair : by_report, about, ...(remember ? {remember, forget} : {})};
}

/** World boxes of turned boxes, and balls: what does not touch by both does not meet, also when it is rounded. */
class Boxes {
  constructor(bodies) {
    this.meshes = bodies.map(({mesh}) => mesh);
    this.rows = new Float64Array(7 * bodies.length);  // middle, half extents, radius
  }
  place(body, pose, at) {
    const [x, y, z] = this.meshes[body].middle, [a, b, c] = this.meshes[body].half, {rows} = this, to = 7 * body;
    const r = rotation(pose[at + 3], pose[at + 4], pose[at + 5], pose[at + 6]);
    let size = this.meshes[body].ball;
    for (let axis = 0; axis < 3; ++axis) {
      const i = 3 * axis;
      rows[to + axis] = r[i] * x + r[i + 1] * y + r[i + 2] * z + pose[at + axis];
      rows[to + 3 + axis] = Math.abs(r[i]) * a + Math.abs(r[i + 1]) * b + Math.abs(r[i + 2]) * c;
      size += Math.abs(pose[at + axis]);
    }
    for (let axis = 0; axis < 3; ++axis) rows[to + 3 + axis] += 1e-12 * size;
    rows[to + 6] = this.meshes[body].ball + 1e-12 * size;
  }
  touch(a, b) {
    const {rows} = this, i = 7 * a, j = 7 * b;
    const y = rows[i + 1] - rows[j + 1];
    if (Math.abs(y) > rows[i + 4] + rows[j + 4]) return false;
    const x = rows[i] - rows[j];
    if (Math.abs(x) > rows[i + 3] + rows[j + 3]) return false;
    const z = rows[i + 2] - rows[j + 2];
    if (Math.abs(z) > rows[i + 5] + rows[j + 5]) return false;
    const reach = rows[i + 6] + rows[j + 6];
    return x * x + y * y + z * z <= reach * reach;
  }
}

/** R of a quaternion, by rows; of one array, that is written anew at every call. */
const turned = new Float64Array(9);
export function rotation(w, x, y, z) {
  turned[0] = 1 - 2 * (y * y + z * z), turned[1] = 2 * (x * y - w * z), turned[2] = 2 * (x * z + w * y);
  turned[3] = 2 * (x * y + w * z), turned[4] = 1 - 2 * (x * x + z * z), turned[5] = 2 * (y * z - w * x);
  turned[6] = 2 * (x * z - w * y), turned[7] = 2 * (y * z + w * x), turned[8] = 1 - 2 * (x * x + y * y);
  return turned;
}

/** A cube of side 2, and a sphere of radius 1 as a closed mesh. */
function test_meshes() {
  const cube = {name: 'cube', vertices: [], triangles: []}, sphere = {name: 'sphere', vertices: [], triangles: []};
  for (let i = 0; i < 8; ++i) cube.vertices.push([i & 4 ? 1 : -1, i & 2 ? 1 : -1, i & 1 ? 1 : -1]);
  for (const [a, b, c, d] of [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    cube.triangles.push([a, b, c], [a, c, d]);
  const rows = 6, columns = 8;
  const row = i => Array.from({length: columns}, (_, j) => {
    const tilt = Math.PI * i / rows, turn = 2 * Math.PI * j / columns;
    return [Math.sin(tilt) * Math.cos(turn), Math.cos(tilt), Math.sin(tilt) * Math.sin(turn)];
  });
  sphere.vertices = [[0, 1, 0], ...Array.from({length: rows - 1}, (_, i) => row(i + 1)).flat(), [0, -1, 0]];
  const at = (i, j) => i === 0 ? 0 : i === rows ? sphere.vertices.length - 1 : 1 + (i - 1) * columns + j % columns;
  for (let i = 0; i < rows; ++i)
    for (let j = 0; j < columns; ++j) {
      if (i > 0) sphere.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
      if (i + 1 < rows) sphere.triangles.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
    }
  return [sphere, cube];
}

/** Two spheres and a fixed cube, apart, touching by turns, and apart again: a silent nothing is an error. */
async function test_itself(make, near, knobs) {
  const bodies = [{name: 'a', mesh: 0, fixed: false}, {name: 'b', mesh: 0, fixed: false}, {name: 'c', mesh: 1, fixed: true}];
  const world = world_of(bodies, test_meshes());
  const {prepare, answer} = method_of(world, await make(world, knobs), near);
  const turns = [[1, 0, 0, 0], [0.5, 0.5, -0.5, 0.5], [0.8, 0, 0.6, 0]], apart = [[0, 20, 1], [9, 20, 2], [1, 2, 30]];
  const placed = {'': [], '0-1': [[0.1, 20, 1], [1.3, 20.2, 1.4]], '0-2': [[1.2, 2.2, 31.6], [9, 20, 2]], apart: []};
  for (const [wanted, moved] of Object.entries(placed)) {
    const poses = Float64Array.from(turns.flatMap((turn, body) => [...(moved[body] ?? apart[body]), ...turn]));
    const step = {number: 0, enlarge: 0, poses, runs: Uint32Array.of(0, 1, 3, 1, 2, 3)};
    prepare(step);
    const said = answer(step).map(pair => pair.join('-')).join(' ');
    if (said !== wanted.replace('apart', ''))
      refuse(`self-test: of two balls and a cube ${wanted || 'none'} meet, it says ${said || 'none'}`);
  }
}
