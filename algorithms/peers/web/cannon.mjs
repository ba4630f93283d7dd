// What the labels of cannon-es share: bodies of its own shapes, moved by hand, and its broad phase.
import {engine} from './engine.mjs';

/** Of a mesh: [shape, offset] each. Without `exact` what is no sphere is a box about its position, as people use it. */
function shapes(C, {sphere, capsule, box, reach, vertices, triangles}, exact) {
  if (sphere) return [[new C.Sphere(sphere)]];
  if (box || !exact) return [[new C.Box(new C.Vec3(...reach))]];
  if (!capsule) return [[new C.Trimesh(vertices, triangles)]];
  const balls = 1 + Math.ceil(2 * capsule.half / (capsule.radius / 4));  // it has no capsule
  return Array.from({length: balls}, (_, i) =>
    [new C.Sphere(capsule.radius), new C.Vec3(0, capsule.half * (2 * i / (balls - 1) - 1), 0)]);
}

export function cannon(name, tests, {sap = false, narrow = false} = {}) {
  engine({name, packages: ['cannon-es'], tests, scope: 'scene'}, async ({bodies}) => {
    const C = await import('cannon-es');
    const space = new C.World(), first = [], second = [];
    space.broadphase = sap ? new C.SAPBroadphase(space) : new C.NaiveBroadphase();
    const made = bodies.map(({mesh, fixed}, i) => {
      const body = Object.assign(new C.Body({mass: fixed ? 0 : 1}), {number: i});
      for (const [shape, offset] of shapes(C, mesh, narrow)) body.addShape(shape, offset);
      return body;
    });
    const place = (i, pose, at) => {
      const body = made[i];
      body.position.set(pose[at], pose[at + 1], pose[at + 2]);
      body.quaternion.set(pose[at + 4], pose[at + 5], pose[at + 6], pose[at + 3]);
      body.aabbNeedsUpdate = true;
      if (!body.world) space.addBody(body);
    };
    let kept = [];  // the order in which it sorted the step before
    const pairs = () => {
      first.length = second.length = 0;
      if (sap) space.broadphase.axisList = [...kept, ...space.bodies.slice(kept.length)];
      space.broadphase.dirty = true;  // bodies were moved, and nothing else tells it
      space.broadphase.collisionPairs(space, first, second);
    };
    let contacts = [], pool = [];
    const report = hit => {
      pairs();
      if (!narrow) return first.forEach((body, i) => hit(body.number, second[i].number));
      [contacts, pool] = [[], contacts];
      space.narrowphase.getContacts(first, second, space, contacts, pool, [], []);
      for (const {bi, bj} of contacts) hit(bi.number, bj.number);
    };
    const memory = {remember: () => kept = space.broadphase.axisList, forget: () => kept = []};
    return {place, report, once: !narrow, ...(sap ? memory : {})};
  });
}
