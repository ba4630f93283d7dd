// Axis-aligned boxes, closed.
#pragma once
#include <limits>
#include <span>

#include "geometry/pose.hpp"

namespace geometry {

/// The closed box min <= p <= max, metres. A default box is empty and touches no finite box.
struct Box {
  Vec3 min = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 max = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  void add(const Box& other) {
    min = min.cwiseMin(other.min);
    max = max.cwiseMax(other.max);
  }
  Vec3 centre() const { return 0.5 * (min + max); }
  Vec3 half_size() const { return 0.5 * (max - min); }
};

/// True when the closed boxes share a point. False when a coordinate is NaN.
inline bool touch(const Box& a, const Box& b) {
  return a.min.x() <= b.max.x() && b.min.x() <= a.max.x() && a.min.y() <= b.max.y() && b.min.y() <= a.max.y() &&
         a.min.z() <= b.max.z() && b.min.z() <= a.max.z();
}

/// The smallest box around the points. A coordinate that is NaN is left out.
Box bounds(std::span<const Vec3> points);

}  // namespace geometry
