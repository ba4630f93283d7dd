// A robot of a replayed scene: links and meshes from URDF, the values of its joints from a table. Each link that can
// collide is a body, of all its <collision> together.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"
#include "pipeline/scene/mesh_input.hpp"
#include "pipeline/scene/poses_csv.hpp"
#include "pipeline/scene/urdf.hpp"

namespace pipeline {

/// As a configuration names it.
struct Robot {
  std::string name;                               // what stands before the name of each link; may be empty
  std::string urdf, joints;                       // files as written; joints is empty where none moves
  std::array<double, 3> position{};               // m, of its root
  std::array<double, 4> orientation{1, 0, 0, 0};  // w x y z, as written
  std::string place, joints_place;                // of the files' keys, for messages
};

struct RobotBody {
  MeshInput input;     // its mesh is named after the body
  bool fixed = false;  // no joint between it and the root moves
};

struct LoadedRobot {
  std::vector<RobotBody> bodies;
  CsvMotion motion;  // a track for each; steps are 0 where no joint moves
};

/// Reads its files; `known` are meshes' files that were read already. Throws Error(kInput).
LoadedRobot load_robot(SceneConfig& config, const Robot& robot, NodeFiles& known);

/// The values of the joints at every step, as a table has them: columns are known by the names of the joints,
/// "shoulder" or "shoulder [deg]"; without a unit rad and m. Throws Error(kInput), "file:line: ...".
struct JointValues {
  std::vector<std::vector<double>> values;  // S x joints, rad or m; 0 for those that are fixed or follow
  std::vector<double> times;                // s; empty: there are none
  std::string understood, beyond;           // in words; what goes beyond its limits, or empty
};
JointValues parse_joints(std::string_view text, const std::string& file, const Urdf& urdf);

}  // namespace pipeline
