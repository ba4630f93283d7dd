// The keys of kind = "playground".
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/pose.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/scene/shape_keys.hpp"

namespace pipeline {

/// One obstacle of the playground. Where it stands follows from all of them.
struct PlaygroundObstacle {
  std::string name;
  Shape shape;
  geometry::Quaternion orientation;
};

/// One straight path of the hero, taken through each of `targets`.
struct PlaygroundPath {
  enum class Hero { along, across, given };

  std::string name;                  // of an axis: "x", "y" or "z"
  std::vector<std::string> targets;  // names of obstacles
  std::optional<int> axis;           // 0 to 2: parallel to it, from end to end of what bounding spheres reach, and 1 m
  double offset = 0;                 // m, along the axis after `axis`
  geometry::Vec3 from = geometry::Vec3::Zero(), to = geometry::Vec3::Zero();  // m, from the target; without an axis
  Hero hero = Hero::along;           // its own y axis lies along `axis`, or along the second axis after it, or as given
  geometry::Quaternion orientation;  // as given
};

/// kind = "playground": the hero passes through obstacles on straight paths.
struct PlaygroundScene {
  double step = 0.25;                         // m, at most, from sample to sample
  Shape hero = CapsuleShape{3, 0.6, 0.6};     // the thesis's
  std::vector<PlaygroundObstacle> obstacles;  // the thesis's eleven when the configuration names none
  std::vector<PlaygroundPath> paths;          // the twelve when the configuration names none
};

SceneKind playground_kind();

}  // namespace pipeline
