#include "algorithms/parts/turned_box.hpp"

#include "geometry/portable_math.hpp"

namespace geometry {

TurnXyz turn_xyz(const EulerAngles& angles) {
  return {portable::sin(angles.x), portable::cos(angles.x), portable::sin(angles.y),
          portable::cos(angles.y), portable::sin(angles.z), portable::cos(angles.z)};
}

std::array<Vec3, 8> turned_corners(const Vec3& half, const TurnXyz& turn) {
  std::array<Vec3, 8> corners;
  for (int k = 0; k < 8; ++k) {
    double x = k & 1 ? half.x() : -half.x(), y = k & 2 ? half.y() : -half.y(), z = k & 4 ? half.z() : -half.z();
    apply(turn, x, y, z);
    corners[k] = {x, y, z};
  }
  return corners;
}

}  // namespace geometry
