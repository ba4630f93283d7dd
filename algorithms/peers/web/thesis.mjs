// The thesis's nine in its own language: JavaScript on Babylon.js, which gives meshes, boxes, facets, matrices and Euler
// angles. Knob `algorithm`: the name of one of the nine; the other knobs are its own, with the same presets. Each is
// written as it is defined, pair by pair, in plain loops: no index, no order that learns.
import {engine, refuse} from './engine.mjs';
import {babylon_scene, place_in_babylon} from './babylon.mjs';

const near = 1e-9;  // of a number of turns, to a whole one

/** Half extents about the position, from the box that Babylon.js makes of the vertices. */
function half_of(mesh) {
  const {minimum, maximum} = mesh.getBoundingInfo().boundingBox;
  return ['x', 'y', 'z'].map(axis => Math.max(Math.abs(minimum[axis]), Math.abs(maximum[axis])));
}

// ---- Facets -----------------------------------------------------------------------------------------------------

/** The surface of the vertex box, m^2. */
function area_of({half: [a, b, c]}) {
  return 2 * (4 * a * b + 4 * b * c + 4 * c * a);
}

/** Every edge cut into equal parts, until there are `wanted` facets: positions and indices. */
function densified({vertices, triangles}, wanted) {
  const facets = triangles.length / 3;
  let parts = 1;
  while (facets * parts * parts < wanted) ++parts;
  if (parts === 1) return {positions: vertices, indices: triangles};
  const positions = [], indices = [];
  for (let facet = 0; facet < facets; ++facet) {
    const base = positions.length / 3, at = (k, j) => base + k * (k + 1) / 2 + j;
    const [first, second, third] = [0, 1, 2].map(i => 3 * triangles[3 * facet + i]);
    for (let k = 0; k <= parts; ++k)
      for (let j = 0; j <= k; ++j)
        for (let axis = 0; axis < 3; ++axis)
          positions.push(((parts - k) * vertices[first + axis] + (k - j) * vertices[second + axis] +
                          j * vertices[third + axis]) / parts);
    for (let k = 0; k < parts; ++k)
      for (let j = 0; j <= k; ++j) {
        indices.push(at(k, j), at(k + 1, j), at(k + 1, j + 1));
        if (j < k) indices.push(at(k, j), at(k + 1, j + 1), at(k, j + 1));
      }
  }
  return {positions, indices};
}

/** Facet points of every body, x y z after each other: chosen once a mesh, moved once a step when first asked for. */
class Facets {
  constructor(made, world, {choose, factor}) {
    this.made = made;
    const local = new Map();
    world.bodies.forEach(({mesh}, i) => {
      if (local.has(mesh)) return;
      const points = choose(mesh, made[i]);
      local.set(mesh, Float64Array.from(points.flatMap(({x, y, z}) => [x * factor, y * factor, z * factor])));
    });
    this.local = world.bodies.map(({mesh}) => local.get(mesh));
    this.world = this.local.map(points => new Float64Array(points.length));
    this.placed = new Uint8Array(made.length);
  }
  at(body) {
    if (this.placed[body]) return this.world[body];
    this.placed[body] = 1;
    const {m} = this.made[body].getWorldMatrix(), local = this.local[body], world = this.world[body];
    for (let i = 0; i < local.length; i += 3) {
      const x = local[i], y = local[i + 1], z = local[i + 2];
      world[i] = m[0] * x + m[4] * y + m[8] * z + m[12];
      world[i + 1] = m[1] * x + m[5] * y + m[9] * z + m[13];
      world[i + 2] = m[2] * x + m[6] * y + m[10] * z + m[14];
    }
    return world;
  }
}

/** The barycentres of a mesh's facets, by Babylon.js; of a denser one when there are fewer facets than wanted. */
async function facet_points(dense, made) {
  const {Mesh} = await import('@babylonjs/core/Meshes/mesh.js');
  const {VertexData} = await import('@babylonjs/core/Meshes/mesh.vertexData.js');
  const scene = made[0].getScene();
  return mesh => {
    const {positions, indices} = densified(mesh, dense * area_of(mesh));
    const data = new VertexData(), facets = new Mesh(mesh.name, scene);
    [data.positions, data.indices] = [Array.from(positions), Array.from(indices)];
    data.normals = new Array(positions.length).fill(0);  // without any it silently makes no facet
    data.applyToMesh(facets);
    facets.partitioningSubdivisions = 1;  // its partition of space is not used
    const points = facets.updateFacetData().getFacetLocalPositions().map(({x, y, z}) => ({x, y, z}));
    facets.dispose();
    return points;
  };
}

const every = (points, stride) => points.filter((_, i) => i % stride === 0);

/** Numbers of the first points of the triangles of that many points. */
function triangles_of(points, triangles) {
  if (!['disjoint', 'strip'].includes(triangles)) refuse(`triangles must be "disjoint" or "strip", not '${triangles}'`);
  const step = triangles === 'disjoint' ? 3 : 1, first = [];
  for (let i = 0; i + 3 <= points; i += step) first.push(i);
  return first;
}

// ---- Triangles --------------------------------------------------------------------------------------------------

/** The 11-axis test of triangles at 3 i of p and 3 j of q: false when an axis separates them. */
function eleven_axes(p, i, q, j) {
  const ax = p[i], ay = p[i + 1], az = p[i + 2], bx = q[j], by = q[j + 1], bz = q[j + 2];
  const e0x = p[i + 3] - ax, e0y = p[i + 4] - ay, e0z = p[i + 5] - az;
  const e1x = p[i + 6] - ax, e1y = p[i + 7] - ay, e1z = p[i + 8] - az;
  const e2x = e1x - e0x, e2y = e1y - e0y, e2z = e1z - e0z;
  const f0x = q[j + 3] - bx, f0y = q[j + 4] - by, f0z = q[j + 5] - bz;
  const f1x = q[j + 6] - bx, f1y = q[j + 7] - by, f1z = q[j + 8] - bz;
  const f2x = f1x - f0x, f2y = f1y - f0y, f2z = f1z - f0z;
  const dx = bx - ax, dy = by - ay, dz = bz - az;
  const apart = (a1, a2, d, b1, b2) =>  // {0, a1, a2} and {d, d + b1, d + b2}
    Math.max(0, a1, a2) < d + Math.min(0, b1, b2) || d + Math.max(0, b1, b2) < Math.min(0, a1, a2);
  const nx = e0y * e1z - e0z * e1y, ny = e0z * e1x - e0x * e1z, nz = e0x * e1y - e0y * e1x;
  if (apart(0, 0, nx * dx + ny * dy + nz * dz, nx * f0x + ny * f0y + nz * f0z, nx * f1x + ny * f1y + nz * f1z)) return false;
  const mx = f0y * f1z - f0z * f1y, my = f0z * f1x - f0x * f1z, mz = f0x * f1y - f0y * f1x;
  if (apart(mx * e0x + my * e0y + mz * e0z, mx * e1x + my * e1y + mz * e1z, mx * dx + my * dy + mz * dz, 0, 0)) return false;
  for (let k = 0; k < 3; ++k) {
    const ex = k === 0 ? e0x : k === 1 ? e1x : e2x, ey = k === 0 ? e0y : k === 1 ? e1y : e2y;
    const ez = k === 0 ? e0z : k === 1 ? e1z : e2z;
    for (let l = 0; l < 3; ++l) {
      const fx = l === 0 ? f0x : l === 1 ? f1x : f2x, fy = l === 0 ? f0y : l === 1 ? f1y : f2y;
      const fz = l === 0 ? f0z : l === 1 ? f1z : f2z;
      const x = ey * fz - ez * fy, y = ez * fx - ex * fz, z = ex * fy - ey * fx;
      // What vanishes identically is 0: along its own edge nothing of it is seen.
      const on = (u, v, w) => x * u + y * v + z * w;
      const a1 = k === 0 ? 0 : on(e0x, e0y, e0z), a2 = k === 1 ? 0 : k === 2 ? a1 : on(e1x, e1y, e1z);
      const b1 = l === 0 ? 0 : on(f0x, f0y, f0z), b2 = l === 1 ? 0 : l === 2 ? b1 : on(f1x, f1y, f1z);
      if (apart(a1, a2, on(dx, dy, dz), b1, b2)) return false;
    }
  }
  return true;
}

/** The directions of the grid of rotations: x, y and z after turns about z and about x; each line once. */
function directions(step) {
  const turns = Math.round(180 / step);
  if (!(turns >= 1) || Math.abs(180 / step - turns) > near) refuse(`angle_step must divide 180, not be ${step}`);
  const lines = new Map();
  const add = (...line) => {
    const sign = Math.sign(line.find(x => Math.abs(x) > near));
    lines.set(line.map(x => Math.round(sign * x / near) + 0).join(), line);
  };
  for (let i = 1; i <= turns; ++i) {
    const a = i * step * Math.PI / 180;
    add(Math.cos(a), -Math.sin(a), 0);
    for (let k = 1; k <= turns; ++k) {
      const b = k * step * Math.PI / 180;
      add(Math.cos(b) * Math.sin(a), Math.cos(b) * Math.cos(a), -Math.sin(b));
      add(Math.sin(b) * Math.sin(a), Math.sin(b) * Math.cos(a), Math.cos(b));
    }
  }
  return Float64Array.from([...lines.values()].flat());
}

/** Does no direction of the grid part the triangles strictly? */
function unparted(grid, p, i, q, j) {
  for (let d = 0; d < grid.length; d += 3) {
    const x = grid[d], y = grid[d + 1], z = grid[d + 2];
    const a0 = x * p[i] + y * p[i + 1] + z * p[i + 2], a1 = x * p[i + 3] + y * p[i + 4] + z * p[i + 5];
    const a2 = x * p[i + 6] + y * p[i + 7] + z * p[i + 8], b0 = x * q[j] + y * q[j + 1] + z * q[j + 2];
    const b1 = x * q[j + 3] + y * q[j + 4] + z * q[j + 5], b2 = x * q[j + 6] + y * q[j + 7] + z * q[j + 8];
    if (Math.max(a0, a1, a2) < Math.min(b0, b1, b2) || Math.max(b0, b1, b2) < Math.min(a0, a1, a2)) return false;
  }
  return true;
}

// ---- Turned boxes -----------------------------------------------------------------------------------------------

/** Points, x y z after each other, turned into `out` about a centre by x, then y, then z: by the angles of which `trig`
 *  has sine and cosine each, or by the negated ones (sign = -1). */
function turn(points, centre, trig, sign, out) {
  const sx = sign * trig[0], kx = trig[1], sy = sign * trig[2], ky = trig[3], sz = sign * trig[4], kz = trig[5];
  const cx = centre[0], cy = centre[1], cz = centre[2];
  for (let i = 0; i < points.length; i += 3) {
    const x = points[i] - cx, y = points[i + 1] - cy, z = points[i + 2] - cz;
    const y1 = y * kx - z * sx, z1 = z * kx + y * sx;
    const x2 = x * ky + z1 * sy, z2 = z1 * ky - x * sy;
    out[i] = x2 * kz - y1 * sz + cx;
    out[i + 1] = y1 * kz + x2 * sz + cy;
    out[i + 2] = z2 + cz;
  }
}

const sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];

// ---- The nine ---------------------------------------------------------------------------------------------------

/** Each: (made, world, knobs) -> {meets(a, b), prepare(there), matrix: whether it reads matrices}. */
const nine = {
  bounding_sphere(made) {
    const radius = made.map(mesh => Math.hypot(...half_of(mesh)));
    return {
      meets(a, b) {
        const p = made[a].position, q = made[b].position, x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;
        return radius[a] + radius[b] > Math.sqrt(x * x + y * y + z * z);
      },
    };
  },

  obb_sat: made => ({meets: (a, b) => made[a].intersectsMesh(made[b], true), matrix: true}),

  rotated_aabb(made) {
    const half = made.map(half_of), extent = new Float64Array(3 * made.length);
    const turned = (u, v, angle) => {
      const r = Math.hypot(u, v);
      if (r === 0) return [0, 0];
      const alpha = Math.asin(u / r);
      return [Math.abs(r * Math.sin(angle + alpha)), Math.abs(r * Math.cos(angle + alpha))];
    };
    return {
      prepare: there => made.forEach((mesh, i) => {
        if (!there[i]) return;
        const angles = mesh.rotationQuaternion.toEulerAngles();
        let [x, y, z] = half[i];
        [x, y] = turned(x, y, angles.z);
        [z, x] = turned(z, x, angles.y);
        [y, z] = turned(y, z, angles.x);
        extent.set([x, y, z], 3 * i);
      }),
      meets(a, b) {
        const p = made[a].position, q = made[b].position, i = 3 * a, j = 3 * b;
        return Math.abs(p.x - q.x) <= extent[i] + extent[j] && Math.abs(p.y - q.y) <= extent[i + 1] + extent[j + 1] &&
          Math.abs(p.z - q.z) <= extent[i + 2] + extent[j + 2];
      },
    };
  },

  obb_corners(made) {
    const {corners, centre, trig, half, prepare} = turned_corners(made), points = new Float64Array(24);
    const inside = (a, b) => {
      turn(corners[a], centre[b], trig[b], -1, points);
      const c = centre[b], h = half[b];
      for (let i = 0; i < 24; i += 3)
        if (Math.abs(points[i] - c[0]) <= h[0] && Math.abs(points[i + 1] - c[1]) <= h[1] &&
            Math.abs(points[i + 2] - c[2]) <= h[2]) return true;
      return false;
    };
    return {prepare, meets: (a, b) => inside(a, b) || inside(b, a)};
  },

  obb_triangles(made) {
    const {corners, prepare} = turned_corners(made), outer = made.map(() => new Float64Array(108));
    return {
      filtered: true,
      prepare(there) {
        prepare(there);
        outer.forEach((out, body) => {
          if (!there[body]) return;
          let at = 0;
          for (const [a, b, c, d] of sides)
            for (const corner of [a, b, c, a, c, d])
              for (let axis = 0; axis < 3; ++axis) out[at++] = corners[body][3 * corner + axis];
        });
      },
      meets(a, b) {
        for (let i = 0; i < 108; i += 9)
          for (let j = 0; j < 108; j += 9)
            if (eleven_axes(outer[a], i, outer[b], j)) return true;
        return false;
      },
    };
  },

  async facet_distance(made, world, {max_distance = 0.25, facets_per_area = 8, densify = true}) {
    const points = await facet_points(densify ? facets_per_area : 0, made);
    const choose = mesh => {
      const all = points(mesh), wanted = facets_per_area * area_of(mesh);
      return every(all, wanted > 0 ? Math.max(1, Math.floor(all.length / wanted)) : 1);
    };
    const facets = new Facets(made, world, {choose, factor: 1}), limit = max_distance * max_distance;
    return {
      filtered: true, matrix: true, facets,
      meets(a, b) {
        const p = facets.at(a), q = facets.at(b);
        for (let i = 0; i < p.length; i += 3) {
          const u = p[i], v = p[i + 1], w = p[i + 2];
          for (let j = 0; j < q.length; j += 3) {
            const x = u - q[j], y = v - q[j + 1], z = w - q[j + 2];
            if (x * x + y * y + z * z < limit) return true;
          }
        }
        return false;
      },
    };
  },

  async facet_vectors(made, world, {stride = 20, max_third = 0.5, densify = false}) {
    const points = await facet_points(densify ? 8 : 0, made);
    const facets = new Facets(made, world, {choose: mesh => every(points(mesh), stride), factor: 1});
    return {
      filtered: true, matrix: true, facets,
      meets(a, b) {
        const p = facets.at(a), q = facets.at(b);
        let xy = 0, yz = 0, zx = 0, least_x = Infinity, least_y = Infinity, least_z = Infinity;
        for (let i = 0; i < p.length; i += 3)
          for (let j = 0; j < q.length; j += 3) {
            const x = q[j] - p[i], y = q[j + 1] - p[i + 1], z = q[j + 2] - p[i + 2];
            const sx = x > 0 ? 1 : 0, sy = y > 0 ? 1 : 0, sz = z > 0 ? 1 : 0;
            xy |= 1 << (2 * sx + sy);
            yz |= 1 << (2 * sy + sz);
            zx |= 1 << (2 * sz + sx);
            if (Math.abs(x) < least_x) least_x = Math.abs(x);
            if (Math.abs(y) < least_y) least_y = Math.abs(y);
            if (Math.abs(z) < least_z) least_z = Math.abs(z);
          }
        return xy === 15 && least_z < max_third || yz === 15 && least_x < max_third || zx === 15 && least_y < max_third;
      },
    };
  },

  facet_triangles: (made, world, knobs) => sampled_triangles(made, world, knobs, eleven_axes),

  facet_rotations(made, world, knobs) {
    const grid = directions(knobs.angle_step ?? 10);
    return sampled_triangles(made, world, knobs, (p, i, q, j) => unparted(grid, p, i, q, j));
  },
};

/** Triangles between every stride-th, inflated facet points, tested each with each. */
async function sampled_triangles(made, world, {stride = 20, inflate = 1.1, triangles = 'disjoint', densify = false}, test) {
  const points = await facet_points(densify ? 8 : 0, made);
  const facets = new Facets(made, world, {choose: mesh => every(points(mesh), stride), factor: inflate});
  const first = facets.local.map(local => triangles_of(local.length / 3, triangles));
  return {
    filtered: true, matrix: true, facets,
    meets(a, b) {
      if (first[a].length === 0 || first[b].length === 0) return false;
      const p = facets.at(a), q = facets.at(b);
      for (const i of first[a])
        for (const j of first[b])
          if (test(p, 3 * i, q, 3 * j)) return true;
      return false;
    },
  };
}

/** The corners of boxes about the positions, turned about x, then y, then z; sines and cosines of the angles. */
function turned_corners(made) {
  const half = made.map(half_of), columns = count => made.map(() => new Float64Array(count));
  const corners = columns(24), centre = columns(3), trig = columns(6), box = new Float64Array(24);
  const prepare = there => made.forEach((mesh, body) => {
    if (!there[body]) return;
    const p = mesh.position, euler = mesh.rotationQuaternion.toEulerAngles(), [hx, hy, hz] = half[body];
    centre[body].set([p.x, p.y, p.z]);
    [euler.x, euler.y, euler.z].forEach((angle, i) => trig[body].set([Math.sin(angle), Math.cos(angle)], 2 * i));
    for (let i = 0; i < 8; ++i) {
      box[3 * i] = p.x + (i & 4 ? hx : -hx);
      box[3 * i + 1] = p.y + (i & 2 ? hy : -hy);
      box[3 * i + 2] = p.z + (i & 1 ? hz : -hz);
    }
    turn(box, centre[body], trig[body], 1, corners[body]);
  });
  return {half, corners, centre, trig, prepare};
}

const about = {name: 'thesis', packages: ['@babylonjs/core'], tests: 'as the method of the thesis whose name it has'};
engine({...about, self_test: ({algorithm}) => !['facet_vectors', 'facet_triangles', 'facet_rotations'].includes(algorithm)},
       async (world, knobs) => {
  const {algorithm, precision = 'single', prefilter = 'rotated_aabb'} = knobs;
  if (!nine[algorithm]) refuse(`algorithm must be one of ${Object.keys(nine).join(', ')}, not '${algorithm}'`);
  if (!['none', 'bounding_sphere', 'obb_sat', 'obb_corners', 'rotated_aabb'].includes(prefilter))
    refuse(`prefilter must be "none" or one of the four that test boxes and balls, not '${prefilter}'`);
  const made = await babylon_scene(world, precision), one = await nine[algorithm](made, world, knobs);
  const before = one.filtered && prefilter !== 'none' ? await nine[prefilter](made, world, {}) : null;
  const matrix = one.matrix || before?.matrix;
  return {
    about: {name: algorithm, precision},
    place(body, pose, at) {
      if (matrix) return place_in_babylon(made[body], pose, at);
      made[body].position.set(pose[at], pose[at + 1], pose[at + 2]);
      made[body].rotationQuaternion.set(pose[at + 4], pose[at + 5], pose[at + 6], pose[at + 3]);
    },
    prepare(there) {
      before?.prepare?.(there);
      one.prepare?.(there);
      one.facets?.placed.fill(0);
    },
    meets: before ? (a, b) => before.meets(a, b) && one.meets(a, b) : one.meets,
  };
});
