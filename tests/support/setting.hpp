// Bodies put together by hand or at random, for the tests of algorithms.
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/contract/algorithm.hpp"
#include "geometry/decision/meet.hpp"
#include "geometry/meshes/shapes.hpp"

namespace setting {

using geometry::Bodies;
using geometry::Mesh;
using geometry::Pair;
using geometry::PairRun;
using geometry::Pose;
using geometry::Quaternion;
using geometry::Vec3;

/// Knobs that differ from the presets.
using Changed = std::vector<std::pair<std::string, algorithms::Value>>;

inline Quaternion turn_deg(const Vec3& axis, double degrees) {
  return geometry::normalised(geometry::turn_about(axis, degrees * std::numbers::pi / 180));
}

struct Setting {
  Bodies bodies;
  std::vector<Pose> poses;

  Setting& add(const Mesh& mesh, const Pose& pose, bool fixed = false) {
    bodies.add("body" + std::to_string(poses.size()), static_cast<std::uint32_t>(bodies.meshes.size()), fixed);
    bodies.meshes.push_back(mesh);
    poses.push_back(pose);
    return *this;
  }

  Setting reversed() const {
    Setting out;
    for (std::size_t i = poses.size(); i-- > 0;)
      out.add(bodies.mesh_of(static_cast<std::uint32_t>(i)), poses[i], bodies.fixed[i]);
    return out;
  }

  std::vector<PairRun> runs() const { return geometry::pair_runs(bodies, poses); }
};

inline std::unique_ptr<algorithms::Method> make(const std::string& name, const Bodies& bodies,
                                                const Changed& changed = {}) {
  const algorithms::Algorithm* algorithm = algorithms::find(name);
  algorithms::Knobs knobs = algorithms::presets(*algorithm);
  for (const auto& [knob, value] : changed) knobs.at(knob) = value;
  return algorithm->make(bodies, knobs);
}

/// The reported pairs, sorted.
inline std::vector<Pair> hits(const std::string& name, const Setting& setting, const Changed& changed = {},
                              double enlarge = 0) {
  const auto method = make(name, setting.bodies, changed);
  std::vector<Pair> out;
  method->prepare(setting.poses, enlarge);
  method->answer(setting.runs(), out);
  std::sort(out.begin(), out.end());
  return out;
}

/// Whether the algorithm reports two bodies alone.
inline bool hit(const std::string& name, const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b,
                const Changed& changed = {}) {
  return !hits(name, Setting().add(a, at_a).add(b, at_b), changed).empty();
}

/// The pairs that truly meet, sorted.
inline std::vector<Pair> truth(const Setting& setting) {
  const std::vector<geometry::Bvh> bvhs = geometry::build_bvhs(setting.bodies);
  return geometry::Decision(setting.bodies, bvhs).hits(setting.poses, setting.runs());
}

inline bool truly_meet(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  return !truth(Setting().add(a, at_a).add(b, at_b)).empty();
}

/// In [-1, 1), the same everywhere.
inline double uniform(std::mt19937& random) { return static_cast<double>(random()) * 0x1p-31 - 1; }

inline Vec3 uniform_point(std::mt19937& random, double half_width) {
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return half_width * Vec3(x, y, z);
}

inline Quaternion uniform_turn(std::mt19937& random) {
  Quaternion q;
  double square;
  do {
    q = {uniform(random), uniform(random), uniform(random), uniform(random)};
    square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  } while (square > 1 || square < 0.01);
  return geometry::normalised(q);
}

/// A square bar bent to a ring about y: closed, `n` corners, mean radius and half thickness in metres.
inline Mesh ring(double radius, double thickness, int n = 16) {
  Mesh mesh;
  mesh.name = "ring";
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    for (const auto& [r, y] : {std::pair{radius + thickness, -thickness}, std::pair{radius + thickness, thickness},
                               std::pair{radius - thickness, thickness}, std::pair{radius - thickness, -thickness}})
      mesh.vertices.push_back({r * std::cos(angle), y, -r * std::sin(angle)});
  }
  const auto vertex = [n](int i, int k) { return static_cast<std::uint32_t>(i % n * 4 + k % 4); };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) {
      mesh.triangles.push_back({vertex(i, k), vertex(i + 1, k), vertex(i + 1, k + 1)});
      mesh.triangles.push_back({vertex(i, k), vertex(i + 1, k + 1), vertex(i, k + 1)});
    }
  return mesh;
}

/// A box whose middle is not its origin, to tell |half extents| from half dimensions.
inline Mesh shifted_box(const Vec3& size, const Vec3& by) {
  Mesh mesh = geometry::box("shifted", size);
  for (Vec3& v : mesh.vertices) v += by;
  return mesh;
}

/// `count` bodies of mixed shapes at random in a cube, some of them fixed.
inline Setting crowd(std::mt19937& random, int count, double half_width) {
  const std::vector<Mesh> meshes = {geometry::sphere("sphere", 1, 8), geometry::box("cube", {1.5, 1.5, 1.5}),
                                    geometry::box("slab", {3, 0.2, 2}), ring(1.2, 0.3),
                                    shifted_box({1, 2, 0.5}, {0.3, -0.7, 0.1})};
  Setting out;
  for (int i = 0; i < count; ++i)
    out.add(meshes[i % meshes.size()], {uniform_turn(random), uniform_point(random, half_width)}, i % 7 == 3);
  return out;
}

/// The eight corners (+-h.x, +-h.y, +-h.z).
inline std::vector<Vec3> corners(const Vec3& h) {
  std::vector<Vec3> out;
  for (const double x : {-h.x(), h.x()})
    for (const double y : {-h.y(), h.y()})
      for (const double z : {-h.z(), h.z()}) out.push_back({x, y, z});
  return out;
}

/// The pairs that definition(mesh a, pose a, mesh b, pose b) reports, sorted.
template <class Definition>
std::vector<Pair> by_definition(const Setting& setting, Definition definition) {
  std::vector<Pair> out;
  for (const PairRun& run : setting.runs())
    for (std::uint32_t b = run.first; b < run.last; ++b)
      if (definition(setting.bodies.mesh_of(run.a), setting.poses[run.a], setting.bodies.mesh_of(b), setting.poses[b]))
        out.push_back({run.a, b});
  return out;
}

}  // namespace setting
