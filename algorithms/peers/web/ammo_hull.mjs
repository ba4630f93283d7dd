// Ammo.js (Bullet): convex hulls, asked by contactPairTest.
import {ammo} from './ammo.mjs';

function shape(Ammo, {vertices}) {
  const hull = new Ammo.btConvexHullShape(), point = new Ammo.btVector3();
  for (let i = 0; i < vertices.length; i += 3) {
    point.setValue(...vertices.subarray(i, i + 3));
    hull.addPoint(point, i + 3 === vertices.length);
  }
  return hull;
}

function asked(Ammo, {space, made}) {
  const result = new Ammo.ConcreteContactResultCallback();
  let met = false;
  result.addSingleResult = point => {
    met ||= Ammo.wrapPointer(point, Ammo.btManifoldPoint).getDistance() <= 0;
    return 0;
  };
  return {
    meets(a, b) {
      met = false;
      space.contactPairTest(made[a], made[b], result);
      return met;
    },
  };
}

ammo('ammo_hull', 'convex hulls', shape, {about: {near: true}, asked});
