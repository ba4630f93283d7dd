// MuJoCo: the contacts that its collision pass finds, of meshes, which it takes for their convex hulls. Knob `native`:
// false asks its older routine for convex bodies. The one it comes with says nothing of bodies with one centre.
import {engine} from './engine.mjs';

engine({name: 'mujoco_hull', packages: ['@mujoco/mujoco'], tests: 'convex hulls', scope: 'scene'},
       async ({bodies, meshes}, {native = true}) => {
  const {default: make} = await import('@mujoco/mujoco');
  const library = await make();
  const name = mesh => `m${meshes.indexOf(mesh)}`;
  const model = library.MjModel.from_xml_string(`<mujoco>
    <option gravity="0 0 0"><flag nativeccd="${native ? 'enable' : 'disable'}"/></option><size memory="256M"/>
    <asset>${meshes.map(mesh => `<mesh name="${name(mesh)}" vertex="${mesh.vertices.join(' ')}"/>`).join('')}</asset>
    <worldbody>${bodies.map(({mesh, fixed}, i) =>  // apart until they are placed
      `<body pos="${1e4 * (i + 1)} 1e6 0" ${fixed ? 'mocap="true"' : ''}>${fixed ? '' : '<freejoint/>'}
         <geom type="mesh" mesh="${name(mesh)}"/></body>`).join('')}</worldbody></mujoco>`);
  const data = new library.MjData(model);
  let order = 0, still = 0;  // of the moving bodies and the fixed ones, as the model counts them
  const places = bodies.map(({fixed}) => fixed ? still++ : order++);
  return {
    place(body, pose, at) {
      // Views are of the heap as it is now: it may have grown.
      if (bodies[body].fixed) {
        data.mocap_pos.set(pose.subarray(at, at + 3), 3 * places[body]);
        data.mocap_quat.set(pose.subarray(at + 3, at + 7), 4 * places[body]);
      } else {
        data.qpos.set(pose.subarray(at, at + 7), 7 * places[body]);
      }
    },
    report(hit) {
      library.mj_kinematics(model, data);
      library.mj_collision(model, data);
      const contacts = data.contact, body = model.geom_bodyid;
      for (let i = 0; i < data.ncon; ++i) {
        const contact = contacts.get(i);
        if (contact.dist <= 0) hit(body[contact.geom1] - 1, body[contact.geom2] - 1);
        contact.delete();
      }
      contacts.delete();
    },
  };
});
