// kind = "falling": sets of spheres fall onto others that lie on a finite plate, its top at y = 0 (thesis, "Padani").
#include <cmath>

#include "geometry/meshes/shapes.hpp"
#include "geometry/random.hpp"
#include "pipeline/scene/scene.hpp"

namespace pipeline {
namespace {

/// The thesis's scene: one sphere onto another, ten onto ten, and a block of 6 x 6 x 6 onto 6 x 6.
std::vector<FallingSet> thesis_sets() {
  return {{.lying = {1, 1}, .above = {1, 1, 1}, .corner = {-14, -20}, .spacing = 2.1, .height = 5},
          {.lying = {10, 1}, .above = {10, 1, 1}, .corner = {-10, -18}, .spacing = 2.5, .height = 26},
          {.lying = {6, 6}, .above = {6, 6, 6}, .corner = {-5, -3}, .spacing = 2.1, .height = 75}};
}

/// At most 1e12 + 1e18 by the rules for each count: no overflow.
std::int64_t sphere_count(const FallingSet& set) {
  return set.lying[0] * set.lying[1] + set.above[0] * set.above[1] * set.above[2];
}

void read(const Section& s, SceneConfig& config) {
  s.only({"kind", "segments", "radius", "density", "plate", "shift", "jitter", "set"});
  FallingScene scene;
  scene.segments = s.integer("segments", scene.segments, 1, kMostSegments);
  scene.radius = s.real("radius", scene.radius, kLength);
  scene.density = s.real("density", scene.density, kDensity);
  s.reals("plate", scene.plate, kLength);
  scene.shift = s.real("shift", scene.shift, kCoordinate);
  scene.jitter = s.real("jitter", scene.jitter, {.least = 0, .most = kMostLength});
  if (!s.has("set")) scene.sets = thesis_sets();
  std::int64_t spheres = 0;
  for (const Section& t : s.sections("set")) {
    t.only({"lying", "above", "corner", "spacing", "height"});
    FallingSet set;
    t.integers("lying", set.lying, 0, kMostBodies);
    t.integers("above", set.above, 0, kMostBodies);
    t.reals("corner", set.corner, kCoordinate);
    set.spacing = t.real("spacing", set.spacing, kLength);
    set.height = t.real("height", set.height, kCoordinate);
    spheres += sphere_count(set);
    if (spheres > kMostBodies)
      t.fail("'scene.set' must hold at most " + std::to_string(kMostBodies) + " spheres, not " +
             std::to_string(spheres) + "; lower 'lying' or 'above'");
    scene.sets.push_back(set);
  }
  if (s.has("set") && spheres == 0) s.fail("'scene.set' must hold at least 1 sphere, not 0; raise 'lying' or 'above'");
  config.scene = std::move(scene);
}

void write(const SceneConfig& config, TomlText& out) {
  const FallingScene& scene = std::get<FallingScene>(config.scene);
  out.line("segments", scene.segments);
  out.line("radius", scene.radius);
  out.line("density", scene.density);
  out.list("plate", scene.plate);
  out.line("shift", scene.shift);
  out.line("jitter", scene.jitter);
  for (const FallingSet& set : scene.sets) {
    out.table("[[scene.set]]");
    out.list("lying", set.lying);
    out.list("above", set.above);
    out.list("corner", set.corner);
    out.line("spacing", set.spacing);
    out.line("height", set.height);
  }
}

SceneSize size(const SceneConfig& config) {
  const FallingScene& scene = std::get<FallingScene>(config.scene);
  std::uint64_t spheres = 0;
  for (const FallingSet& set : scene.sets) spheres += std::uint64_t(sphere_count(set));
  const MeshSize plate = mesh_size(BoxShape{}), sphere = mesh_size(SphereShape{scene.radius, scene.segments});
  return {.bodies = 1 + spheres,
          .meshes = 2,
          .mesh_vertices = plate.vertices + sphere.vertices,
          .mesh_triangles = plate.triangles + sphere.triangles,
          .body_vertices = plate.vertices + spheres * sphere.vertices};
}

/// Body 0 is the plate, then set by set the lying and the upper spheres, x slowest. An upper sphere is displaced along
/// x, y and z by jitter times three numbers in [-1, 1), the first three of the stream of its body's number.
Scene make(const SceneConfig& config) {
  const FallingScene& falling = std::get<FallingScene>(config.scene);
  Scene scene;
  geometry::Bodies& bodies = scene.bodies;
  const auto& plate = falling.plate;
  bodies.meshes.push_back(geometry::box("plate", {plate[0], plate[1], plate[2]}));
  bodies.meshes.push_back(geometry::sphere("sphere", falling.radius, falling.segments));

  const auto add = [&](const std::string& name, std::uint32_t mesh, const RigidBody& rigid, double x, double y,
                       double z) {
    bodies.add(name, mesh, rigid.fixed);
    scene.rigid.push_back(rigid);
    scene.states.push_back({.position = {x, y, z}});
  };
  const auto displace = [&] {
    if (falling.jitter == 0) return;
    geometry::Random random = geometry::Random::of(std::uint64_t(config.seed), scene.states.size() - 1);
    for (double& coordinate : scene.states.back().position) coordinate += falling.jitter * random.signed_unit();
  };

  const RigidBody floor{.fixed = true, .sphere = false, .half_extents = {plate[0] / 2, plate[1] / 2, plate[2] / 2}};
  add("plate", 0, floor, 0, -plate[1] / 2, 0);

  const RigidBody sphere = solid_sphere(bodies.meshes[1], falling.density, config.contact_radius);
  for (std::size_t s = 0; s < falling.sets.size(); ++s) {
    const FallingSet& set = falling.sets[s];
    const std::string prefix = "set" + std::to_string(s + 1);
    std::int64_t number = 0;
    for (std::int64_t i = 0; i < set.lying[0]; ++i)
      for (std::int64_t k = 0; k < set.lying[1]; ++k)
        add(prefix + "_lying_" + std::to_string(number++), 1, sphere, set.corner[0] + set.spacing * double(i),
            falling.radius, set.corner[1] + set.spacing * double(k));
    number = 0;
    for (std::int64_t i = 0; i < set.above[0]; ++i)
      for (std::int64_t j = 0; j < set.above[1]; ++j)
        for (std::int64_t k = 0; k < set.above[2]; ++k) {
          add(prefix + "_above_" + std::to_string(number++), 1, sphere,
              set.corner[0] + falling.shift + set.spacing * double(i), set.height + set.spacing * double(j),
              set.corner[1] + falling.shift + set.spacing * double(k));
          displace();
        }
  }
  return scene;
}

/// Seconds in which a body at rest falls so many metres against linear damping: y = g / c (t - (1 - exp(-c t)) / c).
double fall_time(double metres, double gravity, double damping) {
  double low = 0, high = std::sqrt(2 * metres / gravity);
  const auto fallen = [&](double t) {
    return damping * t < 1e-6 ? gravity * t * t / 2 : gravity / damping * (t + std::expm1(-damping * t) / damping);
  };
  while (fallen(high) < metres) high *= 2;
  for (int i = 0; i < 60; ++i) (fallen((low + high) / 2) < metres ? low : high) = (low + high) / 2;
  return high;
}

/// Metres that the lowest of a set's upper spheres falls freely: to those that lie, beside them by `shift`, or to the
/// plate.
double drop(const FallingScene& falling, const FallingSet& set) {
  const double r = falling.radius, aside = 2 * falling.shift * falling.shift;
  const bool meets = set.lying[0] > 0 && set.lying[1] > 0 && aside < 4 * r * r;
  return set.height - r - (meets ? std::sqrt(4 * r * r - aside) : 0);
}

std::vector<Ahead> ahead(const SceneConfig& config) {
  const FallingScene& falling = std::get<FallingScene>(config.scene);
  constexpr double kLively = 0.75;  // of the time of the fall; measured on the third set of padani.toml
  std::vector<Ahead> out;
  for (std::size_t s = 0; s < falling.sets.size(); ++s) {
    const FallingSet& set = falling.sets[s];
    const std::uint64_t spheres = std::uint64_t(set.above[0] * set.above[1] * set.above[2]);
    const std::uint64_t lying = std::uint64_t(set.lying[0] * set.lying[1]);
    const double metres = drop(falling, set), gravity = -config.physics.gravity[1];
    if (spheres == 0) continue;
    double step = 0;
    if (metres > 0) {
      if (!(gravity > 0)) continue;  // it never lands
      step = config.rate * fall_time(metres, gravity, config.physics.linear_damping);
    }
    out.push_back({.what = "landing of set " + std::to_string(s + 1) + ", " + std::to_string(spheres) +
                           (spheres == 1 ? " sphere" : " spheres"),
                   .first = step,
                   .bodies = spheres + lying,
                   .lasts = kLively * step});
  }
  return out;
}

/// Every set has just landed; pressed together, near pairs that do not meet cost answers the most.
void hurry(const SceneConfig& config, std::vector<BodyState>& states, bool pressed) {
  constexpr double kPressed = 2.02;  // radii from middle to middle
  const FallingScene& falling = std::get<FallingScene>(config.scene);
  const double gravity = -config.physics.gravity[1];
  std::size_t body = 1;
  for (const FallingSet& set : falling.sets) {
    body += std::size_t(set.lying[0] * set.lying[1]);
    const std::array<double, 3> from{set.corner[0] + falling.shift, set.height, set.corner[1] + falling.shift};
    const double metres = drop(falling, set),
                 closer = pressed ? std::min(1.0, kPressed * falling.radius / set.spacing) : 1;
    const std::size_t end = body + std::size_t(set.above[0] * set.above[1] * set.above[2]);
    for (; body < end; ++body) {
      if (!(metres > 0 && gravity > 0)) continue;
      for (std::size_t axis = 0; axis < 3; ++axis)
        states[body].position[axis] = from[axis] + closer * (states[body].position[axis] - from[axis]);
      states[body].position[1] -= metres;
      // Half the speed, as if some of it were lost already.
      states[body].velocity[1] = -std::sqrt(2 * gravity * metres) / 2;
    }
  }
}

}  // namespace

SceneKind falling_kind() {
  return {.name = "falling",
          .what = "sets of spheres fall on a finite plate (thesis, \"Padani\")",
          .integrated = true,
          .read = read,
          .write = write,
          .size = size,
          .make = make,
          .draws = [](const SceneConfig& config) { return std::get<FallingScene>(config.scene).jitter > 0; },
          .draw_by = "scene.jitter above 0",
          .ahead = ahead,
          .hurry = hurry};
}

}  // namespace pipeline
