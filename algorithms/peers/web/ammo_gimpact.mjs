// Ammo.js (Bullet): GImpact, mesh against mesh. Pair tests are silent for it, so the world's own pass over all bodies is
// asked: it steps a world in which nothing is simulated.
import {ammo} from './ammo.mjs';

function shape(Ammo, {vertices, triangles}) {
  const mesh = new Ammo.btTriangleMesh(true, false);
  const [a, b, c] = [0, 1, 2].map(() => new Ammo.btVector3());
  for (let i = 0; i < triangles.length; i += 3) {
    [a, b, c].forEach((corner, j) => corner.setValue(...vertices.subarray(3 * triangles[i + j], 3 * triangles[i + j] + 3)));
    mesh.addTriangle(a, b, c, false);
  }
  return new Ammo.btGImpactMeshShape(mesh);
}

function asked(Ammo, {space, dispatcher, made}) {
  Ammo.btGImpactCollisionAlgorithm.prototype.registerAlgorithm(dispatcher);
  const number = new Map(made.map((object, i) => [Ammo.getPointer(object), i]));
  return {
    report(hit) {
      space.stepSimulation(1, 1, 1);
      for (let i = dispatcher.getNumManifolds(); i--;) {
        const manifold = dispatcher.getManifoldByIndexInternal(i);
        for (let j = manifold.getNumContacts(); j--;) {
          if (!(manifold.getContactPoint(j).getDistance() <= 0)) continue;
          hit(number.get(Ammo.getPointer(manifold.getBody0())), number.get(Ammo.getPointer(manifold.getBody1())));
          break;
        }
      }
    },
  };
}

ammo('ammo_gimpact', 'surfaces of the meshes', shape,
     {about: {scope: 'scene'}, asked, ready: shape => shape.updateBound()});
