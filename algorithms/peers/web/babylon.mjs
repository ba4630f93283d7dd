// What the labels of Babylon.js share: meshes without a screen, asked by intersectsMesh.
import {engine, refuse} from './engine.mjs';

/** A mesh of Babylon.js for every body, in a scene without a screen. `precision` of its matrices: "single" as it comes,
 *  or "double". */
export async function babylon_scene({bodies, meshes}, precision) {
  const [{PerformanceConfigurator}, {NullEngine}, {Scene}, {Mesh}, {VertexData}, {Quaternion}] = await Promise.all([
    import('@babylonjs/core/Engines/performanceConfigurator.js'), import('@babylonjs/core/Engines/nullEngine.js'),
    import('@babylonjs/core/scene.js'), import('@babylonjs/core/Meshes/mesh.js'),
    import('@babylonjs/core/Meshes/mesh.vertexData.js'), import('@babylonjs/core/Maths/math.vector.js')]);
  if (!['single', 'double'].includes(precision)) refuse(`precision must be "single" or "double", not '${precision}'`);
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
  engine({name, packages: ['@babylonjs/core'], tests}, async (world, {precision = 'single'}) => {
    const made = await babylon_scene(world, precision);
    return {
      about: {precision},
      place: (body, pose, at) => place_in_babylon(made[body], pose, at),
      meets: (a, b) => made[a].intersectsMesh(made[b], precise),
    };
  });
}
