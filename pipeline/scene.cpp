#include "pipeline/scene.hpp"

namespace pipeline {

const std::vector<SceneKind>& scene_kinds() {
  static const std::vector<SceneKind> kinds = {
      falling_kind(),
      replay_kind(),
  };
  return kinds;
}

geometry::Pose pose_of(const BodyState& state) {
  const auto& q = state.orientation;
  const auto& p = state.position;
  return {geometry::normalised({q[0], q[1], q[2], q[3]}), {p[0], p[1], p[2]}};
}

RigidBody solid_sphere(const geometry::Mesh& mesh, double density, ContactRadius contact_radius) {
  constexpr double kPi = 3.14159265358979323846;
  const double nominal = mesh.sphere_radius;
  RigidBody sphere;
  sphere.radius = contact_radius == ContactRadius::nominal ? nominal : geometry::inscribed_radius(mesh);
  sphere.mass = density * (4.0 / 3.0) * kPi * (nominal * nominal * nominal);
  sphere.inertia = 0.4 * sphere.mass * (nominal * nominal);
  return sphere;
}

}  // namespace pipeline
