// Pairs of bodies about to part: the last place, to a rounding, at which they truly meet.
#pragma once
#include <cmath>

#include "tests/support/setting.hpp"

namespace grazing {

/// Moves body 1 of `pair`, which meets body 0, along `way` as far as it still truly meets it: the next double of the
/// bisected way does not, or the way is too short to part them. `pair` is left there.
inline void part(setting::Setting& pair, const setting::Vec3& way) {
  const std::vector<geometry::Bvh> bvhs = geometry::build_bvhs(pair.bodies);
  geometry::Decision decision(pair.bodies, bvhs);
  const setting::Vec3 from = pair.poses[1].t;
  const auto meet = [&](double s) {
    pair.poses[1].t = from + s * way;
    return decision.meet(pair.poses, {0, 1});
  };
  double meets = 0, apart = 1;
  for (double middle = 0.5; meets < middle && middle < apart; middle = meets + 0.5 * (apart - meets))
    (meet(middle) ? meets : apart) = middle;
  pair.poses[1].t = from + meets * way;
}

/// Shapes with long edges, thin sides, holes and hardly any area, some not centred.
inline std::vector<setting::Mesh> shapes() {
  setting::Mesh triangle;
  triangle.name = "triangle";
  triangle.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 0.01, 0}};
  triangle.triangles = {{0, 1, 2}};
  return {geometry::sphere("sphere", 1, 4),
          geometry::box("cube", {1.5, 1.5, 1.5}),
          geometry::box("slab", {3, 0.02, 2}),
          setting::ring(1.2, 0.3, 6),
          setting::shifted_box({1, 2, 0.5}, {3, -7, 1}),
          triangle};
}

/// Bodies of random shapes that graze each other, `count` pairs, some of them far from the origin.
template <class Each>
void each_pair(std::uint32_t seed, int count, Each each) {
  std::mt19937 random(seed);
  const std::vector<setting::Mesh> all = shapes();
  for (int i = 0; i < count; ++i) {
    const setting::Mesh &a = all[random() % all.size()], &b = all[random() % all.size()];
    const double far = i % 3 == 0 ? 0 : std::pow(10, 1 + random() % 5);
    const setting::Vec3 at = setting::uniform_point(random, far);
    const geometry::Pose pose_a{setting::uniform_turn(random), at};
    geometry::Pose pose_b{setting::uniform_turn(random), at};
    // A vertex of b upon a vertex of a, but for rounding; two triangles in the plane of both: the surfaces meet there.
    const setting::Vec3 on_a = geometry::to_world(geometry::rotation(pose_a.q), pose_a.t, a.vertices[0]);
    const setting::Vec3 on_b = geometry::to_world(geometry::rotation(pose_b.q), pose_b.t, b.vertices[0]);
    pose_b.t += on_a - on_b;
    setting::Setting pair = setting::Setting().add(a, pose_a).add(b, pose_b);
    if (setting::truth(pair).empty()) continue;
    part(pair, setting::uniform_point(random, 8));
    each(pair);
  }
}

}  // namespace grazing
