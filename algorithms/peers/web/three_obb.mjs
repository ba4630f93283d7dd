// three.js: its OBB, boxes of the vertices.
import {engine} from './engine.mjs';

engine({name: 'three_obb', packages: ['three'], tests: 'oriented boxes of the vertices'}, async ({bodies}) => {
  const [{Matrix4, Quaternion, Vector3}, {OBB}] = await Promise.all([import('three'), import('three/addons/math/OBB.js')]);
  const local = bodies.map(({mesh}) => new OBB(new Vector3(...mesh.middle), new Vector3(...mesh.half)));
  const made = bodies.map(() => new OBB());
  const position = new Vector3(), turn = new Quaternion(), one = new Vector3(1, 1, 1), matrix = new Matrix4();
  return {
    place(body, pose, at) {
      position.set(pose[at], pose[at + 1], pose[at + 2]);
      turn.set(pose[at + 4], pose[at + 5], pose[at + 6], pose[at + 3]);
      made[body].copy(local[body]).applyMatrix4(matrix.compose(position, turn, one));
    },
    meets: (a, b) => made[a].intersectsOBB(made[b]),
  };
});
