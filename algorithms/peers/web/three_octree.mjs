// three.js: its Octree of a mesh's triangles against a sphere or a capsule. Two bodies of which neither is one of these
// it cannot ask about: they are never reported. Of two, the one of the lower number is the proxy.
import {engine} from './engine.mjs';

engine({name: 'three_octree', packages: ['three'], near: true,
        tests: 'a sphere or capsule against triangles; pairs with neither are never reported'},
       async ({bodies, meshes}) => {
  const [{Quaternion, Sphere, Triangle, Vector3}, {Octree}, {Capsule}] = await Promise.all(
    [import('three'), import('three/addons/math/Octree.js'), import('three/addons/math/Capsule.js')]);
  const tree = new Map(meshes.map(mesh => {
    const octree = new Octree(), corner = i => new Vector3(...mesh.vertices.subarray(3 * i, 3 * i + 3));
    for (let i = 0; i < mesh.triangles.length; i += 3)
      octree.addTriangle(new Triangle(...Array.from(mesh.triangles.subarray(i, i + 3), corner)));
    return [mesh, octree.build()];
  }));
  const position = bodies.map(() => new Vector3()), turn = bodies.map(() => new Quaternion());
  const back = new Quaternion(), proxies = bodies.map(({mesh: {sphere, capsule}}) =>
    sphere ? new Sphere(new Vector3(), sphere) : capsule && new Capsule(new Vector3(), new Vector3(), capsule.radius));
  const meet = (proxy, other) => {
    const {capsule} = bodies[proxy].mesh, octree = tree.get(bodies[other].mesh), made = proxies[proxy];
    back.copy(turn[other]).conjugate();
    const into = (point, along) =>
      point.set(0, along, 0).applyQuaternion(turn[proxy]).add(position[proxy]).sub(position[other]).applyQuaternion(back);
    if (capsule) {
      into(made.start, -capsule.half);
      into(made.end, capsule.half);
      return octree.capsuleIntersect(made) !== false;
    }
    into(made.center, 0);
    return octree.sphereIntersect(made) !== false;
  };
  return {
    place(body, pose, at) {
      position[body].set(pose[at], pose[at + 1], pose[at + 2]);
      turn[body].set(pose[at + 4], pose[at + 5], pose[at + 6], pose[at + 3]);
    },
    meets: (a, b) => proxies[a] ? meet(a, b) : proxies[b] ? meet(b, a) : false,
  };
});
