#include "pipeline/scene.hpp"

#include "geometry/shapes.hpp"

namespace pipeline {
namespace {

std::uint64_t sphere_count(const FallingSet& set) {
  return std::uint64_t(set.lying[0] * set.lying[1] + set.above[0] * set.above[1] * set.above[2]);
}

}  // namespace

SceneSize scene_size(const Config& config) {
  const FallingScene& scene = config.scene;
  std::uint64_t spheres = 0;
  for (const FallingSet& set : scene.sets) spheres += sphere_count(set);
  const std::uint64_t rows = std::uint64_t(scene.segments) + 2;  // geometry::sphere
  const std::uint64_t vertices = 2 * rows * (rows - 1) + 2, triangles = 4 * rows * (rows - 1);
  return {.bodies = 1 + spheres,
          .meshes = 2,
          .mesh_vertices = 8 + vertices,
          .mesh_triangles = 12 + triangles,
          .body_vertices = 8 + spheres * vertices};
}

Scene make_scene(const Config& config) {
  const FallingScene& falling = config.scene;
  Scene scene;
  geometry::Bodies& bodies = scene.bodies;
  const auto& plate = falling.plate;
  bodies.meshes.push_back(geometry::box("plate", {plate[0], plate[1], plate[2]}));
  bodies.meshes.push_back(geometry::sphere("sphere", falling.radius, falling.segments));

  const auto add = [&](const std::string& name, std::uint32_t mesh, const RigidBody& rigid, double x, double y,
                       double z) {
    bodies.name.push_back(name);
    bodies.mesh.push_back(mesh);
    bodies.fixed.push_back(rigid.fixed);
    scene.rigid.push_back(rigid);
    BodyState state;
    state.position = {x, y, z};
    scene.states.push_back(state);
  };

  RigidBody floor;
  floor.fixed = true;
  floor.sphere = false;
  floor.half_extents = {plate[0] / 2, plate[1] / 2, plate[2] / 2};
  add("plate", 0, floor, 0, -plate[1] / 2, 0);

  constexpr double kPi = 3.14159265358979323846;
  RigidBody sphere;
  sphere.radius = config.contact_radius == ContactRadius::nominal ? falling.radius
                                                                  : geometry::inscribed_radius(bodies.meshes[1]);
  // Mass and inertia are those of the solid nominal sphere: the contact radius only says where it is touched.
  sphere.mass = falling.density * (4.0 / 3.0) * kPi * (falling.radius * falling.radius * falling.radius);
  sphere.inertia = 0.4 * sphere.mass * (falling.radius * falling.radius);

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
        for (std::int64_t k = 0; k < set.above[2]; ++k)
          add(prefix + "_above_" + std::to_string(number++), 1, sphere,
              set.corner[0] + falling.shift + set.spacing * double(i), set.height + set.spacing * double(j),
              set.corner[1] + falling.shift + set.spacing * double(k));
  }
  return scene;
}

geometry::Pose pose_of(const BodyState& state) {
  const auto& q = state.orientation;
  const auto& p = state.position;
  return {geometry::normalised({q[0], q[1], q[2], q[3]}), {p[0], p[1], p[2]}};
}

}  // namespace pipeline
