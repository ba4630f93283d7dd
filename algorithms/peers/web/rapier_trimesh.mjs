// Rapier: contactCollider of two triangle meshes.
import {engine} from './engine.mjs';

engine({name: 'rapier_trimesh', packages: ['@dimforge/rapier3d-compat'], tests: 'surfaces of the meshes', near: true,
        precision: 'single'}, async ({bodies}) => {
  const {default: RAPIER} = await import('@dimforge/rapier3d-compat');
  await RAPIER.init();
  const space = new RAPIER.World({x: 0, y: 0, z: 0});
  const made = bodies.map(({mesh}) =>
    space.createCollider(RAPIER.ColliderDesc.trimesh(Float32Array.from(mesh.vertices), mesh.triangles.slice())));
  return {
    place(body, pose, at) {
      made[body].setTranslation({x: pose[at], y: pose[at + 1], z: pose[at + 2]});
      made[body].setRotation({w: pose[at + 3], x: pose[at + 4], y: pose[at + 5], z: pose[at + 6]});
    },
    meets(a, b) {
      const contact = made[a].contactCollider(made[b], 0);
      return contact !== null && contact.distance <= 0;
    },
  };
});
