// URDF: a robot as a tree of links that joints hold together. What collides is read, each link's <collision>; masses,
// pictures and transmissions may hold anything.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/pose.hpp"

namespace pipeline {

/// One <collision> of a link.
struct UrdfCollision {
  enum Kind { mesh, box, sphere, cylinder };

  Kind kind = mesh;
  geometry::Pose origin;                         // in the link's frame
  std::string file;                              // of a mesh, as written
  std::array<double, 3> scale{1, 1, 1};          // of a mesh
  geometry::Vec3 size = geometry::Vec3::Zero();  // of a box, m
  double radius = 0, length = 0;                 // m; a cylinder stands along z
  int line = 0;
};

struct UrdfLink {
  std::string name;
  std::vector<UrdfCollision> collisions;
  int line = 0;
  std::size_t joint = std::size_t(-1);  // by which it hangs; the root has none
};

struct UrdfJoint {
  enum Kind { fixed, turning, sliding };
  struct Mimic {
    std::size_t joint = 0;  // whose value this one follows: multiplier * value + offset
    double multiplier = 1, offset = 0;
  };

  std::string name, type;
  Kind kind = fixed;
  std::size_t above = 0, below = 0;  // links
  geometry::Pose origin;             // in the link above
  geometry::Vec3 axis{1, 0, 0};
  std::optional<std::array<double, 2>> limits;  // rad or m
  std::optional<Mimic> mimic;
  int line = 0;
};

struct Urdf {
  std::string name;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  std::vector<std::size_t> order;  // links, each after the one that it hangs on
};

/// `text` is the content of `file`. Throws Error(kInput), one line "file:line: ...", for what is no URDF or no tree.
Urdf parse_urdf(std::string_view text, const std::string& file);

}  // namespace pipeline
