// What the labels of Babylon.js share: meshes without a screen, asked by intersectsMesh.
import {engine} from './engine.mjs';

/** Meshes of a scene without a screen. `precision`, a knob: "single" as Babylon.js comes, or "double". */
export async function babylon_scene({bodies, meshes}, {precision = 'single'}) {
  const [{PerformanceConfigurator}, {NullEngine}, {Scene}, {Mesh}, {VertexData}, {Quaternion}] = await Promise.all([
    import('@babylonjs/core/Engines/performanceConfigurator.js'), import('@babylonjs/core/Engines/nullEngine.js'),
    import('@babylonjs/core/scene.js'), import('@babylonjs/core/Meshes/mesh.js'),
    import('@babylonjs/core/Meshes/mesh.vertexData.js'), import('@babylonjs/core/Maths/math.vector.js')]);
  if (precision === 'double') PerformanceConfigurator.SetMatrixPrecision(true);
  const scene = new Scene(new NullEngine());
  const data = new Map(meshes.map(mesh => {
    const made = new VertexData();
    made.positions = Array.from(mesh.vertices);
    made.indices = Array.from(mesh.triangles);
    return [mesh, made];
  }));
  return bodies.map(({name, mesh}) => {
    const made = new Mesh(name, scene);
    data.get(mesh).applyToMesh(made);
    made.rotationQuaternion = Quaternion.Identity();
    return made;
  });
}

export function place_in_babylon(mesh, pose, at) {
  mesh.position.set(pose[at], pose[at + 1], pose[at + 2]);
  mesh.rotationQuaternion.set(pose[at + 4], pose[at + 5], pose[at + 6], pose[at + 3]);
  mesh.computeWorldMatrix(true);
}

export function babylon(name, tests, precise) {
  const about = {name, packages: ['@babylonjs/core'], tests, precision: 'single'};
  engine(about, async (world, knobs) => {
    if (knobs.precision === 'double') about.precision = 'double';
    const made = await babylon_scene(world, knobs);
    return {
      place: (body, pose, at) => place_in_babylon(made[body], pose, at),
      meets: (a, b) => made[a].intersectsMesh(made[b], precise),
    };
  });
}
