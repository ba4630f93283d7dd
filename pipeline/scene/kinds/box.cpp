// kind = "box": spheres are born one by one in a closed cube without gravity, and pushed again and again (thesis,
// "Kostka": a slider makes spheres at random places with random rotations; a key sets all of them in motion along one
// of four directions of their own, so that each flies elsewhere).
//
// Presets of the physics, chosen for spheres that fly and bounce:
//   gravity, damping 0     nothing brakes a sphere between two bounces; no gravity force is made.
//   dissipation 0.06 s/m   restitution near 0.8. From Hunt-Crossley's law, (1 + 3/2 c v) times the elastic force,
//                          follows exactly, whatever mass, radius and stiffness: with u = 3/2 c v,
//                              u - ln(1 + u) = -e u - ln(1 - e u),      so e = 1 - c v for slow bounces,
//                          where v is the speed of approach and e v that of parting. In configs/kostka.toml half of the
//                          bounces are faster than 4.3 m/s, where e is 0.79; nine of ten are between 1 and 9.5 m/s,
//                          where e falls from 0.94 to 0.64.
//   friction 0.1 / 0.05    little: a bounce still turns spheres a little.
//
// A push adds to the velocity, as an impulse does: what flies fast against it is slowed down.
#include "pipeline/scene/kinds/box.hpp"

#include <cmath>
#include <numbers>

#include "geometry/meshes/shapes.hpp"
#include "geometry/random.hpp"
#include "pipeline/scene/shape_keys.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

constexpr std::int64_t kMostStep = 10000000;  // of a schedule; a run has no more steps
constexpr int kTries = 100000;                // to place one sphere
constexpr double kMostSpeed = 1e4;            // m/s
constexpr std::size_t kPlates = 6;            // bodies 0 to 5; sphere i is body 6 + i
constexpr char kAxes[] = "xyz";

const BoxScene& box_of(const SceneConfig& config) { return config.keys<BoxScene>(); }

/// Spheres that are born by `step`, that step included.
std::int64_t born_by(const BoxScene& box, std::int64_t step) {
  const auto& births = box.births;
  if (step < births.from) return 0;
  if (births.every == 0) return births.count;
  return std::min(births.count, (step - births.from) / births.every + 1);
}

std::string sphere_name(std::int64_t sphere) { return "sphere_" + std::to_string(sphere); }

/// No more spheres than any packing holds. Copies of the cube tile space, so a packing of the cube is one of space, and
/// none of those fills more than pi / sqrt(18) (Hales 2005).
void refuse_too_many(const Section& section, const BoxScene& box, std::int64_t steps) {
  const std::int64_t spheres = born_by(box, steps - 1);
  const double width = 2 * box.half_width, r = box.radius;
  const double filled = double(spheres) * (4.0 / 3.0 * std::numbers::pi) * (r * r * r) / (width * width * width);
  if (filled > std::numbers::pi / std::sqrt(18.0))
    section.fail("'scene.births' must fit into the cube: " + std::to_string(spheres) + " spheres would fill " +
                 real_text(std::round(filled * 1000) / 1000) +
                 " of it and no packing fills more than 0.74; lower 'scene.births.count' or 'scene.radius', or raise "
                 "'scene.half_width'");
}

void read(const Section& s, SceneConfig& config) {
  s.only({"kind", "segments", "radius", "density", "half_width", "thickness", "births", "push"});
  BoxScene box;
  box.segments = s.integer("segments", box.segments, 1, kMostSegments);
  box.radius = s.real("radius", box.radius, kLength);
  box.density = s.real("density", box.density, kDensity);
  box.half_width = s.real("half_width", box.half_width, kLength);
  box.thickness = s.real("thickness", box.thickness, kLength);
  if (box.half_width < box.radius)
    s.fail("'scene.half_width' must be at least scene.radius, not " + real_text(box.half_width) + " below " +
           real_text(box.radius));

  const Section births = s.section("births").only({"count", "from", "every"});
  box.births.count = births.integer("count", box.births.count, 1, kMostBodies);
  box.births.from = births.integer("from", box.births.from, 0, kMostStep);
  box.births.every = births.integer("every", box.births.every, 0, kMostStep);
  if (box.births.from >= config.steps)
    births.refuse("from", "be below steps, which is " + std::to_string(config.steps), "no sphere would ever be born");
  refuse_too_many(births.exists() ? births : s, box, config.steps);

  const Section push = s.section("push").only({"from", "every", "speed", "directions"});
  box.push.from = push.integer("from", box.push.from, 0, kMostStep);
  box.push.every = push.integer("every", box.push.every, 1, kMostStep);
  box.push.speed = push.real("speed", box.push.speed, {.least = 0, .most = kMostSpeed});
  box.push.directions = push.choices("directions", box.push.directions, {"+x", "-x", "+y", "-y", "+z", "-z"});
  config.scene = std::move(box);

  Physics& physics = config.physics;
  physics.gravity = {0, 0, 0};
  physics.linear_damping = physics.angular_damping = 0;
  physics.material.dissipation = 0.06;
  physics.material.static_friction = 0.1;
  physics.material.dynamic_friction = 0.05;
}

void write(const SceneConfig& config, TomlText& out) {
  const BoxScene& box = box_of(config);
  out.line("segments", box.segments);
  out.line("radius", box.radius);
  out.line("density", box.density);
  out.line("half_width", box.half_width);
  out.line("thickness", box.thickness);
  out.table("[scene.births]");
  out.line("count", box.births.count);
  out.line("from", box.births.from);
  out.line("every", box.births.every);
  out.table("[scene.push]");
  out.line("from", box.push.from);
  out.line("every", box.push.every);
  out.line("speed", box.push.speed);
  out.list("directions", box.push.directions);
}

SceneSize size(const SceneConfig& config) {
  const BoxScene& box = box_of(config);
  const MeshSize plate = mesh_size(BoxShape{}), sphere = mesh_size(SphereShape{box.radius, box.segments});
  const std::uint64_t spheres = std::uint64_t(box.births.count);
  return {.bodies = kPlates + spheres,
          .meshes = 4,
          .mesh_vertices = 3 * plate.vertices + sphere.vertices,
          .mesh_triangles = 3 * plate.triangles + sphere.triangles,
          .body_vertices = kPlates * plate.vertices + spheres * sphere.vertices};
}

/// Bodies 0 to 5 are the plates -x, +x, -y, +y, -z, +z, each as wide as the whole cube, so that they overlap along its
/// edges. The spheres follow, none of them born yet.
Scene make(const SceneConfig& config) {
  const BoxScene& box = box_of(config);
  Scene scene;
  geometry::Bodies& bodies = scene.bodies;
  const auto add = [&](const std::string& name, std::uint32_t mesh, const RigidBody& rigid, const BodyState& state) {
    bodies.add(name, mesh, rigid.fixed);
    scene.rigid.push_back(rigid);
    scene.states.push_back(state);
  };

  const double whole = 2 * (box.half_width + box.thickness);
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    geometry::Vec3 sides(whole, whole, whole);
    sides[axis] = box.thickness;
    bodies.meshes.push_back(geometry::box(std::string("plate_") + kAxes[axis], sides));
    const RigidBody plate{
        .fixed = true, .sphere = false, .half_extents = {sides.x() / 2, sides.y() / 2, sides.z() / 2}};
    for (const double side : {-1.0, 1.0}) {
      BodyState state;
      state.position[axis] = side * (box.half_width + box.thickness / 2);
      add(std::string("plate_") + (side < 0 ? '-' : '+') + kAxes[axis], axis, plate, state);
    }
  }

  bodies.meshes.push_back(geometry::sphere("sphere", box.radius, box.segments));
  const RigidBody sphere = solid_sphere(bodies.meshes.back(), box.density, config.contact_radius);
  for (std::int64_t i = 0; i < box.births.count; ++i) add(sphere_name(i), 3, sphere, unborn_state());
  return scene;
}

/// A random place inside, clear of the plates and of every sphere that is there, at rest. The meshes lie within the
/// nominal spheres, so they are apart too.
BodyState born(const SceneConfig& config, std::int64_t sphere, std::int64_t step,
               const std::vector<BodyState>& states) {
  const BoxScene& box = box_of(config);
  const double room = box.half_width - box.radius, clear_squared = 4 * box.radius * box.radius;
  geometry::Random random = geometry::Random::of(std::uint64_t(config.seed), std::uint64_t(sphere));
  BodyState state;
  const geometry::Quaternion q = random.rotation();
  state.orientation = {q.w, q.x, q.y, q.z};
  for (int i = 0; i < kTries; ++i) {
    for (double& coordinate : state.position) coordinate = room * random.signed_unit();
    bool clear = true;
    for (std::size_t other = kPlates; clear && other < states.size(); ++other) {
      if (!is_born(states[other])) continue;
      double distance_squared = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double apart = state.position[axis] - states[other].position[axis];
        distance_squared += apart * apart;
      }
      clear = distance_squared >= clear_squared;
    }
    if (clear) return state;
  }
  throw Error(kInput, one_line(config.path.string(), 4096) + ": " + sphere_name(sphere) + " must be born at step " +
                          std::to_string(step) + ", but each of " + std::to_string(kTries) +
                          " random places overlaps a sphere that is there; lower scene.births.count or scene.radius, "
                          "or raise scene.half_width");
}

/// Adds `speed` m/s along a direction of the body's own frame, "+x" to "-z", to its velocity: an impulse of mass times
/// speed through its centre.
void push(BodyState& state, const std::string& direction, double speed) {
  const geometry::Pose pose = pose_of(state);
  const geometry::Vec3 axis = geometry::rotation(pose.q).col(direction[1] - 'x');
  const double along = direction[0] == '-' ? -speed : speed;
  for (int i = 0; i < 3; ++i) state.velocity[std::size_t(i)] += along * axis[i];
}

/// Births, then the push, which moves the newborn too.
bool events(const SceneConfig& config, std::int64_t step, std::vector<BodyState>& states) {
  const BoxScene& box = box_of(config);
  const std::int64_t first = step == 0 ? 0 : born_by(box, step - 1), last = born_by(box, step);
  for (std::int64_t i = first; i < last; ++i) states[kPlates + std::size_t(i)] = born(config, i, step, states);

  const std::int64_t since = step - box.push.from;
  const bool pushes = last > 0 && box.push.speed > 0 && since >= 0 && since % box.push.every == 0;
  if (pushes) {
    const auto& directions = box.push.directions;
    const std::string& direction = directions[std::size_t(since / box.push.every) % directions.size()];
    for (std::size_t body = kPlates; body < states.size(); ++body)
      if (is_born(states[body])) push(states[body], direction, box.push.speed);
  }
  return last > first || pushes;
}

/// A sphere has left when its centre is in a plate or beyond: a deeper contact would push it out on the far side.
std::string breach(const SceneConfig& config, const std::vector<BodyState>& states) {
  const double inside = box_of(config).half_width;
  for (std::size_t body = kPlates; body < states.size(); ++body)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (const double at = states[body].position[axis]; std::fabs(at) > inside)
        return sphere_name(std::int64_t(body - kPlates)) + " left the cube: its centre is at " + kAxes[axis] + " = " +
               real_text(at) + " m, the plate begins at " + real_text(inside) + " m";
  return "";
}

std::vector<Ahead> ahead(const SceneConfig& config) {
  const BoxScene& box = box_of(config);
  std::vector<Ahead> out{{.what = "births",
                          .first = double(box.births.from),
                          .times = std::uint64_t(box.births.count),
                          .every = double(box.births.every),
                          .bodies = 1}};
  // Pushes go on for ever: only a run before the first of them lacks something.
  if (box.push.speed > 0) out.push_back({.what = "first push", .first = double(box.push.from)});
  return out;
}

/// All spheres are born, and what was born flies.
void hurry(const SceneConfig& config, std::vector<BodyState>& states, bool /*pressed*/) {
  const BoxScene& box = box_of(config);
  for (std::int64_t i = 0; i < born_by(box, config.steps - 1); ++i) {
    BodyState& state = states[kPlates + std::size_t(i)];
    if (!is_born(state)) state = born(config, i, config.steps - 1, states);
    push(state, box.push.directions.front(), box.push.speed);
  }
}

}  // namespace

SceneKind box_kind() {
  return {.name = "box",
          .what = "spheres are born in a closed cube without gravity and pushed again and again (thesis, \"Kostka\")",
          .integrated = true,
          .read = read,
          .write = write,
          .size = size,
          .make = make,
          .events = events,
          .breach = breach,
          .draws = [](const SceneConfig&) { return true; },  // where every sphere is born
          .ahead = ahead,
          .hurry = hurry};
}

}  // namespace pipeline
