// The convex hull of points, exactly: its corners, and facets that share them.
//
// Every decision is an exact orientation, so that no point is ever outside, whatever the rounding: flat, needle-like
// and repeated points are no special case. (Qhull merges facets by tolerances, and CGAL's hulls are GPL.) The same bits
// on every machine. O(n log n) for points in no special order.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.hpp"

namespace geometry {

struct Hull {
  std::vector<std::uint32_t> corners;  // indices of points, ascending; all others lie in the hull of these
  std::vector<Facet> triangles;        // of places in `corners`; counter-clockwise seen from outside
  int dimension = -1;                  // 3 solid, 2 flat, 1 a segment, 0 a point, -1 no points
};

/// The hull of finite points. A corner may lie on an edge or in a face of the hull, never inside. A solid hull is a
/// closed surface; a flat one has its polygon twice, once for either side; segments and points have no triangles.
Hull convex_hull(std::span<const Vec3> points);

}  // namespace geometry
