// three.js with three-mesh-bvh: intersectsGeometry of two meshes, each with its hierarchy.
import {engine} from './engine.mjs';

engine({name: 'three_bvh', packages: ['three-mesh-bvh', 'three'], tests: 'surfaces of the meshes', near: true,
        precision: 'double, boxes single'}, async ({bodies, meshes}) => {
  const [{BufferAttribute, BufferGeometry, Matrix4, Quaternion, Vector3}, {MeshBVH}] =
    await Promise.all([import('three'), import('three-mesh-bvh')]);
  const geometry = new Map(meshes.map(mesh => {
    const made = new BufferGeometry();
    made.setAttribute('position', new BufferAttribute(mesh.vertices, 3));
    made.setIndex(new BufferAttribute(mesh.triangles.slice(), 1));
    made.boundsTree = new MeshBVH(made);
    return [mesh, made];
  }));
  const made = bodies.map(({mesh}) => geometry.get(mesh));
  const world = bodies.map(() => new Matrix4()), local = bodies.map(() => new Matrix4());  // local: the inverse
  const position = new Vector3(), turn = new Quaternion(), one = new Vector3(1, 1, 1), relative = new Matrix4();
  return {
    place(body, pose, at) {
      position.set(pose[at], pose[at + 1], pose[at + 2]);
      turn.set(pose[at + 4], pose[at + 5], pose[at + 6], pose[at + 3]);
      world[body].compose(position, turn, one);
      local[body].copy(world[body]).invert();
    },
    meets: (a, b) =>
      made[a].boundsTree.intersectsGeometry(made[b], relative.multiplyMatrices(local[a], world[b])),
  };
});
