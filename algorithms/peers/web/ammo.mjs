// What the labels of Ammo.js, Bullet as WebAssembly, share: objects that are moved by hand and never simulated.
import {createRequire} from 'node:module';
import {engine} from './engine.mjs';

/** `shape(Ammo, mesh)` of a mesh; `margin`, a knob in metres: 0, or 0.01 or 0.04 as Bullet comes. */
export function ammo(name, tests, shape, more) {
  engine({name, packages: ['ammojs-typed'], tests, precision: 'single', ...more.about}, async (world, {margin = 0}) => {
    const Ammo = await createRequire(import.meta.url)('ammojs-typed/wasm')();
    delete globalThis.Ammo;  // it leaves itself there, and would hold the memory of the self-test
    const configuration = new Ammo.btDefaultCollisionConfiguration();
    const dispatcher = new Ammo.btCollisionDispatcher(configuration), broadphase = new Ammo.btDbvtBroadphase();
    const space = new Ammo.btDiscreteDynamicsWorld(dispatcher, broadphase, new Ammo.btSequentialImpulseConstraintSolver(),
                                                   configuration);
    const shapes = new Map(world.meshes.map(mesh => {
      const made = shape(Ammo, mesh);
      made.setMargin(margin);
      more.ready?.(made);
      return [mesh, made];
    }));
    const made = world.bodies.map(({mesh}) => {
      const object = new Ammo.btPairCachingGhostObject();
      object.setCollisionShape(shapes.get(mesh));
      return object;
    });
    const position = new Ammo.btVector3(), turn = new Ammo.btQuaternion(0, 0, 0, 1), added = made.map(() => false);
    const place = (body, pose, at) => {
      const transform = made[body].getWorldTransform();
      position.setValue(pose[at], pose[at + 1], pose[at + 2]);
      turn.setValue(pose[at + 4], pose[at + 5], pose[at + 6], pose[at + 3]);
      transform.setOrigin(position);
      transform.setRotation(turn);
      if (added[body]) return;
      added[body] = true;
      const fixed = world.bodies[body].fixed;
      space.addCollisionObject(made[body], fixed ? 2 : 1, fixed ? 1 : 3);
    };
    return {place, ...more.asked(Ammo, {space, dispatcher, made})};
  });
}
