// Jolt: CollideShape of two convex hulls. A hull has at most 256 vertices: of finer meshes it takes those that it deems
// best, and misses what the others would touch.
import {engine} from './engine.mjs';

engine({name: 'jolt_hull', packages: ['jolt-physics'], tests: 'convex hulls of at most 256 vertices', near: true,
        precision: 'single'}, async ({bodies, meshes}) => {
  const {default: make} = await import('jolt-physics');
  const Jolt = await make();
  const settings = new Jolt.JoltSettings();  // without an interface it aborts
  const filter = new Jolt.ObjectLayerPairFilterTable(1), layers = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
  filter.EnableCollision(0, 0);
  layers.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  settings.mObjectLayerPairFilter = filter;
  settings.mBroadPhaseLayerInterface = layers;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, filter, 1);
  settings.mMaxWorkerThreads = 0;
  settings.mMaxBodies = bodies.length + 1;
  const space = new Jolt.JoltInterface(settings).GetPhysicsSystem().GetBodyInterface();

  const shapes = new Map(meshes.map(mesh => {
    const hull = new Jolt.ConvexHullShapeSettings();
    hull.mMaxConvexRadius = 0;
    for (let i = 0; i < mesh.vertices.length; i += 3) hull.mPoints.push_back(new Jolt.Vec3(...mesh.vertices.subarray(i, i + 3)));
    const result = hull.Create();
    if (result.HasError()) throw new Error(`mesh '${mesh.name}': ${result.GetError().c_str()}`);
    const shape = result.Get();
    shape.AddRef();
    return [mesh, shape];
  }));
  const made = bodies.map(({mesh, fixed}) => space.CreateBody(new Jolt.BodyCreationSettings(
    shapes.get(mesh), new Jolt.RVec3(0, 0, 0), new Jolt.Quat(0, 0, 0, 1),
    fixed ? Jolt.EMotionType_Static : Jolt.EMotionType_Kinematic, 0)));
  const ids = made.map(body => body.GetID()), position = new Jolt.RVec3(), turn = new Jolt.Quat();
  const one = new Jolt.Vec3(1, 1, 1), origin = new Jolt.RVec3(0, 0, 0), all = new Jolt.ShapeFilter();
  const asked = new Jolt.CollideShapeSettings(), any = new Jolt.CollideShapeAnyHitCollisionCollector();
  return {
    place(body, pose, at) {
      position.Set(pose[at], pose[at + 1], pose[at + 2]);
      turn.Set(pose[at + 4], pose[at + 5], pose[at + 6], pose[at + 3]);
      space.SetPositionAndRotation(ids[body], position, turn, Jolt.EActivation_DontActivate);
    },
    meets(a, b) {
      any.Reset();
      made[b].GetTransformedShape().CollideShape(shapes.get(bodies[a].mesh), one, made[a].GetCenterOfMassTransform(),
                                                 asked, origin, any, all);
      return any.HadHit();
    },
  };
});
