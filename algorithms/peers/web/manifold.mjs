// Manifold: the least gap between two solids is 0. It takes closed, oriented meshes only.
import {engine, rotation} from './engine.mjs';

engine({name: 'manifold', packages: ['manifold-3d'], tests: 'solids', near: true, precision: 'double, vertices single'},
       async ({bodies, meshes}) => {
  const {default: make} = await import('manifold-3d');
  const library = await make();
  library.setup();
  const solid = new Map(meshes.map(mesh => {
    try {
      return [mesh, new library.Manifold(new library.Mesh(
        {numProp: 3, vertProperties: Float32Array.from(mesh.vertices), triVerts: mesh.triangles}))];
    } catch (error) {
      throw new Error(`mesh '${mesh.name}': ${error.message ?? error}`);
    }
  }));
  const made = bodies.map(() => null);
  return {
    place(body, pose, at) {
      const r = rotation(pose[at + 3], pose[at + 4], pose[at + 5], pose[at + 6]);
      made[body]?.delete();
      made[body] = solid.get(bodies[body].mesh).transform(
        [r[0], r[3], r[6], 0, r[1], r[4], r[7], 0, r[2], r[5], r[8], 0, pose[at], pose[at + 1], pose[at + 2], 1]);
    },
    meets: (a, b) => made[a].minGap(made[b], 1e-3) <= 0,
  };
});
