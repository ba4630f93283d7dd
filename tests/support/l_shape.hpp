// A closed mesh that is not convex, of known boxes.
#pragma once
#include <vector>

#include "geometry/mesh.hpp"

namespace tests {

/// An L with arms 1 wide, 3 and 2 long, 1 thick: the boxes [0, 3] x [0, 1] x [0, 1] and [0, 1] x [1, 2] x [0, 1].
inline geometry::Mesh l_shape() {
  using geometry::Facet, geometry::Vec3;
  // The outline in x and y, counter-clockwise.
  const std::vector<Vec3> outline{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  geometry::Mesh mesh;
  mesh.name = "l";
  for (const double z : {1., 0.})
    for (const Vec3& p : outline) mesh.vertices.push_back(p + Vec3(0, 0, z));
  for (const auto& [a, b, c] : {Facet{0, 1, 3}, Facet{1, 2, 3}, Facet{0, 3, 5}, Facet{3, 4, 5}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({c + 6, b + 6, a + 6});
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, i + 6, j + 6});
    mesh.triangles.push_back({i, j + 6, j});
  }
  return mesh;
}

}  // namespace tests
