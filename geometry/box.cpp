// Boxes around points.
#include "geometry/box.hpp"

namespace geometry {

Box bounds(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& p : points) box.add(p);
  return box;
}

}  // namespace geometry
