// Poses and meshes chosen to break bounds on rounding: what the tests of the exact answer share.
#pragma once
#include <cmath>
#include <utility>

#include "geometry/mesh.hpp"
#include "geometry/pose.hpp"
#include "tests/support/random.hpp"

namespace adversary {

using geometry::Mesh;
using geometry::Pose;
using geometry::Quaternion;
using geometry::Vec3;
using tests::kSeed;
using tests::Random;

/// Its computed squared norm is within 1e-15 of 1, as far out as a search in ulps brings it; some have parts that are
/// tiny, equal or zero.
inline Quaternion quaternion(Random& random) {
  Quaternion q = random.turn();
  switch (random.below(5)) {
    case 0:
      q = geometry::normalised({q.w, 1e-9 * q.x, 1e-160 * q.y, q.z});
      break;
    case 1:
      q = geometry::normalised({q.w, q.w, -q.w, random.below(2) ? q.w : 0});
      break;
    case 2:
      q = {0, 0.5 + 0.5 * (random.below(2)), 0, 0}, q = geometry::normalised(q);
      break;
    default:
      break;
  }
  const double away = random.below(2) ? 2 : 0;  // towards longer or shorter
  double* parts[] = {&q.w, &q.x, &q.y, &q.z};
  for (int i = 0; i < 40; ++i) {
    double& part = *parts[random.below(4)];
    const double before = part;
    part = std::nextafter(part, std::copysign(away, part));
    if (std::fabs((((q.w * q.w + q.x * q.x) + q.y * q.y) + q.z * q.z) - 1) > 1e-15) part = before;
  }
  return q;
}

/// A few facets of size 1e-12 to 1e12, some of denormal or huge size: slivers, needles, points; some far from their own
/// origin.
inline Mesh mesh(Random& random) {
  Mesh out;
  double scale = std::pow(10, 12 * random.real());
  if (random.below(16) == 0) scale = random.below(2) ? 1e-310 : 1e150;
  const double thin = random.below(3) == 0 ? 1e-9 : 1;
  const Vec3 offset = random.below(4) ? Vec3(0, 0, 0) : Vec3(scale * 1e3 * random.point());
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t first = 3 * i;
    for (int k = 0; k < 3; ++k) {
      Vec3 p = random.point();
      p.y() *= thin;
      out.vertices.push_back(offset + scale * p);
    }
    if (random.below(8) == 0) out.vertices[first + 1] = out.vertices[first];
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

/// Up to 1e12 sizes away.
inline Pose pose(Random& random, double size) {
  const double far = random.below(3) ? std::pow(10, 12 * random.real()) : 0;
  return {quaternion(random), far * size * random.point()};
}

}  // namespace adversary
