#include "pipeline/scene.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace pipeline {

const std::vector<SceneKind>& scene_kinds() {
  static const std::vector<SceneKind> kinds = {
      falling_kind(),
      box_kind(),
      playground_kind(),
      replay_kind(),
      extremes_kind(),
  };
  return kinds;
}

Scene make_scene(const Config& config) {
  Scene scene = config.scene_kind->make(config);
  scene.bodies.closed_within = config.closed_within;
  return scene;
}

BodyState unborn_state() {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  BodyState state;
  state.position.fill(kNaN);
  state.orientation.fill(kNaN);
  state.velocity.fill(kNaN);
  state.angular_velocity.fill(kNaN);
  return state;
}

bool is_born(const BodyState& state) { return !std::isnan(state.position[0]); }

geometry::Pose pose_of(const BodyState& state) {
  if (!is_born(state)) return geometry::unborn();
  const auto& q = state.orientation;
  const auto& p = state.position;
  return {geometry::normalised({q[0], q[1], q[2], q[3]}), {p[0], p[1], p[2]}};
}

RigidBody solid_sphere(const geometry::Mesh& mesh, double density, ContactRadius contact_radius) {
  const double nominal = mesh.sphere_radius;
  RigidBody sphere;
  sphere.radius = contact_radius == ContactRadius::nominal ? nominal : geometry::inscribed_radius(mesh);
  sphere.mass = density * (4.0 / 3.0) * std::numbers::pi * (nominal * nominal * nominal);
  sphere.inertia = 0.4 * sphere.mass * (nominal * nominal);
  return sphere;
}

}  // namespace pipeline
