// A ball and an axis-aligned box around each body as columns: what rejects most pairs before a dearer test.
#pragma once
#include <cstdint>
#include <vector>

#include "geometry/box.hpp"

namespace geometry {

/// One ball and one box per body, metres.
struct BallsAndBoxes {
  std::vector<double> x, y, z, r, low_x, low_y, low_z, high_x, high_y, high_z;

  static constexpr std::size_t kBytes = 10 * sizeof(double);  // of a body

  void resize(std::size_t bodies);
  void set(std::size_t body, const Vec3& centre, double radius, const Box& box);

  /// Whether balls and boxes touch; counts the balls as one test and every axis looked at.
  template <class Count>
  bool touch(std::uint32_t a, std::uint32_t b, Count& count) const {
    count += 1;
    const double dx = x[b] - x[a], dy = y[b] - y[a], dz = z[b] - z[a], reach = r[a] + r[b];
    if (reach * reach < dx * dx + dy * dy + dz * dz) return false;
    count += 1;
    if (low_x[a] > high_x[b] || low_x[b] > high_x[a]) return false;
    count += 1;
    if (low_y[a] > high_y[b] || low_y[b] > high_y[a]) return false;
    count += 1;
    return !(low_z[a] > high_z[b] || low_z[b] > high_z[a]);
  }

  /// touch of body a with first ... last - 1: hit[k - first] is 0 or 1.
  void touch_row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* hit) const;
};

}  // namespace geometry
