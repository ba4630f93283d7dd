// Products of vectors whose order of additions is a contract: answers and certified bounds are defined by these bits.
// Eigen's own add in an order of their choosing.
#pragma once
#include "geometry/pose.hpp"

namespace geometry {

/// (x + y) + z of the products.
inline double dot(const Vec3& a, const Vec3& b) { return (a.x() * b.x() + a.y() * b.y()) + a.z() * b.z(); }

/// The vector at right angles to both, each component one difference of two products.
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

}  // namespace geometry
