// Oimo.js: its broad phase and its narrow phase, on spheres and boxes.
import {createRequire} from 'node:module';
import {engine} from './engine.mjs';

engine({name: 'oimo', packages: ['oimo'], tests: 'proxies: spheres, else boxes about the position', scope: 'scene'},
       async ({bodies}) => {
  const OIMO = createRequire(import.meta.url)('oimo');
  const space = new OIMO.World({info: false});
  const made = bodies.map(({mesh: {sphere, reach}, fixed}, i) => {
    const shape = sphere ? {type: 'sphere', size: [sphere]} : {type: 'box', size: reach.map(x => 2 * x)};
    return space.add({...shape, pos: [1e6 * (i + 1), 0, 0], move: !fixed, neverSleep: true});  // apart until placed
  });
  const number = new Map(made.map((body, i) => [body, i]));
  return {
    place(i, pose, at) {
      made[i].position.set(pose[at], pose[at + 1], pose[at + 2]);
      made[i].orientation.set(pose[at + 4], pose[at + 5], pose[at + 6], pose[at + 3]);
      made[i].syncShapes();
    },
    report(hit) {  // as World.step does, with contacts of their own for every step
      space.broadPhase.detectPairs();
      const {pairs, numPairs} = space.broadPhase;
      for (let i = 0; i < numPairs; ++i) {
        const {shape1, shape2} = pairs[i];
        space.addContact(...(shape1.id < shape2.id ? [shape1, shape2] : [shape2, shape1]));
        const contact = space.contacts;
        contact.updateManifold();
        if (contact.manifold.numPoints > 0) hit(number.get(contact.body1), number.get(contact.body2));
        space.removeContact(contact);
      }
    },
  };
});
