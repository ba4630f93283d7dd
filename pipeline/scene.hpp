// From a configuration to bodies: meshes, their physical side, and where they start.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/bodies.hpp"
#include "pipeline/config.hpp"
#include "pipeline/simulate.hpp"

namespace pipeline {

struct Scene {
  geometry::Bodies bodies;
  std::vector<RigidBody> rigid;   // B, what the integrator needs to know
  std::vector<BodyState> states;  // B, at t = 0
};

/// How large a scene is, without making it.
struct SceneSize {
  std::uint64_t bodies = 0, meshes = 0;
  std::uint64_t mesh_vertices = 0, mesh_triangles = 0;  // of the distinct meshes
  std::uint64_t body_vertices = 0;                      // over all bodies
};
SceneSize scene_size(const Config& config);

/// The falling scene (thesis, "Padání"): body 0 is the plate, then set by set the lying and the upper spheres, x slowest.
Scene make_scene(const Config& config);

/// The pose of a state: its quaternion normalised by the rule of the truth.
geometry::Pose pose_of(const BodyState& state);

}  // namespace pipeline
