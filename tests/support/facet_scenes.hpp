// Small scenes for the tests of the four facet algorithms: meshes with known facet points, and one way to ask.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "algorithms/contract/algorithm.hpp"
#include "algorithms/parts/facets.hpp"
#include "geometry/meshes/shapes.hpp"

namespace facet_scenes {

using algorithms::Bodies;
using algorithms::Knobs;
using algorithms::Pair;
using algorithms::Pose;
using algorithms::Value;
using geometry::Mesh;
using geometry::Vec3;

/// A mesh whose facet points are exactly these: each facet is one point three times, and (3 p) / 3 is p in doubles.
inline Mesh cloud(const std::vector<Vec3>& points) {
  Mesh mesh;
  mesh.name = "cloud";
  for (const Vec3& p : points) {
    const auto i = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(p);
    mesh.triangles.push_back({i, i, i});
  }
  return mesh;
}

struct Scene {
  Bodies bodies;
  std::vector<Pose> poses;

  void add(Mesh mesh, const Pose& pose) {
    const auto number = static_cast<std::uint32_t>(bodies.meshes.size());
    mesh.name += std::to_string(number);
    bodies.add("body" + std::to_string(number), number);
    bodies.meshes.push_back(std::move(mesh));
    poses.push_back(pose);
  }
};

inline Pose at(double x, double y, double z) { return {.q = {}, .t = {x, y, z}}; }

inline Scene two(const Mesh& a, const Pose& pose_a, const Mesh& b, const Pose& pose_b) {
  Scene scene;
  scene.add(a, pose_a);
  scene.add(b, pose_b);
  return scene;
}

inline Knobs with(Knobs knobs, const Knobs& more) {
  for (const auto& [key, value] : more) knobs[key] = value;
  return knobs;
}

/// The presets of the algorithm with some changes, each checked as a configuration's would be.
inline Knobs knobs(const std::string& name, const Knobs& changes) {
  const algorithms::Algorithm* algorithm = algorithms::find(name);
  Knobs all = algorithms::presets(*algorithm);
  for (const auto& [key, value] : changes)
    for (const algorithms::Knob& knob : algorithm->knobs)
      if (knob.name == key) all[key] = algorithms::checked(knob, value);
  return all;
}

struct Told {
  std::vector<Pair> hits;
  std::uint64_t operations = 0;
};

/// Asks about every pair of born bodies; answering and counting must agree, also when asked again.
inline Told ask(const std::string& name, const Scene& scene, const Knobs& changes = {}) {
  const auto method = algorithms::find(name)->make(scene.bodies, knobs(name, changes));
  const auto runs = geometry::pair_runs(scene.bodies, scene.poses);
  Told told;
  std::vector<Pair> again;
  method->prepare(scene.poses);
  method->answer(runs, told.hits);
  told.operations = method->count(runs, again);
  EXPECT_EQ(told.hits, again) << name << " answers differently when it counts";
  return told;
}

/// Does the algorithm report the only pair of the scene?
inline bool hit(const std::string& name, const Scene& scene, const Knobs& changes = {}) {
  return !ask(name, scene, changes).hits.empty();
}

/// The scene with its bodies in the opposite order.
inline Scene swapped(const Scene& scene) {
  return two(scene.bodies.mesh_of(1), scene.poses[1], scene.bodies.mesh_of(0), scene.poses[0]);
}

inline Scene shifted(Scene scene, const Vec3& by) {
  for (Pose& pose : scene.poses) pose.t += by;
  return scene;
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  Vec3 vector(double size) {
    const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
    return {x, y, z};
  }
  /// Small integers: ties, zeros, coplanar and degenerate triangles are common.
  Vec3 lattice(int size) {
    const int x = whole(-size, size), y = whole(-size, size), z = whole(-size, size);
    return Vec3(x, y, z);
  }
  geometry::Quaternion rotation() {
    const double w = between(-1, 1), x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
    return geometry::normalised({w, x, y, z});
  }
  Pose pose(double size) {
    const geometry::Quaternion q = rotation();
    return {.q = q, .t = vector(size)};
  }
  Mesh points(int count, double size) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) points.push_back(vector(size));
    return cloud(points);
  }
  Mesh lattice_points(int count, int size) {
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) points.push_back(lattice(size));
    return cloud(points);
  }

 private:
  std::mt19937_64 engine_;
};

/// The world points that the definitions speak of, one by one.
inline std::vector<Vec3> world_points(const Mesh& mesh, const Pose& pose, std::size_t stride, double inflate = 1) {
  std::vector<Vec3> out;
  const geometry::Mat3 r = geometry::rotation(pose.q);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += stride) {
    const geometry::Facet& f = mesh.triangles[i];
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = (mesh.vertices[f[0]][axis] + mesh.vertices[f[1]][axis] + mesh.vertices[f[2]][axis]) / 3 * inflate;
    out.push_back(geometry::to_world(r, pose.t, p));
  }
  return out;
}

/// Random pairs for comparisons with a definition: free points, lattice points (with ties) and turned spheres.
inline Scene random_pair(Random& random, int i) {
  switch (i % 3) {
    case 0: {
      const Mesh a = random.points(random.whole(1, 12), 1), b = random.points(random.whole(1, 12), 1);
      const Pose pose = random.pose(0.5), other = random.pose(1.5);
      return two(a, pose, b, other);
    }
    case 1: {
      const Mesh a = random.lattice_points(random.whole(3, 9), 2), b = random.lattice_points(random.whole(3, 9), 2);
      const Vec3 shift = random.lattice(3);
      return two(a, at(0, 0, 0), b, {.q = {}, .t = shift});
    }
    default: {
      const Pose pose = random.pose(0.1);
      Pose other = random.pose(0.9);
      other.t.x() += 1.2;
      return two(geometry::sphere("sphere", 1, 4), pose, geometry::sphere("sphere", 0.7, 5), other);
    }
  }
}

// ---- Facts of several of them; the tests of each ask.

inline void expect_the_same_in_either_order(const std::string& name, std::uint64_t seed, int count,
                                            const Knobs& knobs = {}) {
  SCOPED_TRACE(seed);
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    const Scene scene = random_pair(random, i);
    EXPECT_EQ(hit(name, scene, knobs), hit(name, swapped(scene), knobs)) << i;
  }
}

/// A shift that keeps coordinates exact changes no answer.
inline void expect_the_same_elsewhere(const std::string& name, std::uint64_t seed, int count, const Knobs& knobs) {
  SCOPED_TRACE(seed);
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    const Scene scene = random_pair(random, 3 * i + 1);  // lattice points
    EXPECT_EQ(hit(name, scene, knobs), hit(name, shifted(scene, {4096, -512, 64}), knobs)) << i;
  }
}

inline void expect_unborn_bodies_in_no_pair(const std::string& name, const Knobs& knobs = {}) {
  Scene scene = two(geometry::sphere("a", 1, 16), at(0, 0, 0), geometry::sphere("b", 1, 16), geometry::unborn());
  scene.add(geometry::sphere("c", 1, 16), at(0.1, 0, 0));
  EXPECT_EQ(ask(name, scene, knobs).hits, (std::vector<Pair>{{0, 2}}));
}

// Of the two that compare triangles of three sampled points:

inline void expect_blind_to_what_is_inside(const std::string& name) {
  const Mesh big = geometry::sphere("big", 1, 16), small = geometry::sphere("small", 0.1, 16);
  EXPECT_FALSE(hit(name, two(big, at(0, 0, 0), small, at(0.3, 0.3, 0.3))));
  EXPECT_FALSE(hit(name, two(big, at(0, 0, 0), small, at(0, 0, 0)), {{"stride", std::int64_t{5}}}));
}

/// A ring of the sphere has 72 facets, so three points at stride 20 lie 100 degrees apart and span a disc through the
/// sphere's middle rather than its surface.
inline void expect_to_see_by_triangles_across(const std::string& name) {
  const Mesh big = geometry::sphere("big", 1, 16), small = geometry::sphere("small", 0.1, 16);
  EXPECT_TRUE(hit(name, two(big, at(0, 0, 0), small, at(0, 0, 0))));
}

/// A box has twelve facets, hence one point at stride 20 and no triangle.
inline void expect_no_hit_of_fewer_than_three_facets(const std::string& name) {
  const Mesh box = geometry::box("box", {2, 2, 2}), sphere = geometry::sphere("sphere", 1, 16);
  EXPECT_FALSE(hit(name, two(box, at(0, 0, 0), box, at(0.5, 0.25, 0.125))));
  EXPECT_FALSE(hit(name, two(box, at(0, 0, 0), sphere, at(1, 0, 0))));
  EXPECT_TRUE(hit(name, two(box, at(0, 0, 0), sphere, at(1, 0, 0)), {{"densify", true}}));
}

/// A small sphere whose middle lies on the big one's surface always crosses it, and is seen at some places only.
inline void expect_holes(const std::string& name) {
  const Mesh big = geometry::sphere("big", 1, 16), small = geometry::sphere("small", 0.1, 16);
  int seen = 0, missed = 0;
  for (int i = 0; i < 200; ++i) {
    const double z = 1 - (2 * i + 1) / 200.0, around = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
    const Pose pose = at(r * std::cos(around), r * std::sin(around), z);
    (hit(name, two(big, at(0, 0, 0), small, pose), {{"prefilter", "none"}}) ? seen : missed) += 1;
  }
  EXPECT_GT(seen, 20);
  EXPECT_GT(missed, 20);
}

}  // namespace facet_scenes
