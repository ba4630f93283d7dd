// Containment: which bodies lie wholly inside others.
//
// A closed body A is contained in a closed body B when their surfaces share no point and one vertex of every connected
// component of A is inside B by the parity rule: a path from it to the outside crosses B's surface an odd number of
// times. Exact for the world vertices as rounded by to_world, like the truth (geometry/meet.hpp).
//
// What matters here is the surface as a set of points, so vertices of equal coordinates are one: a sphere whose seam is
// doubled, or an STL file, is closed when its points are. (Equal local coordinates become equal world coordinates.)
// That is more than is_closed() sees, which goes by index.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/bvh.hpp"
#include "geometry/mesh.hpp"

namespace geometry {

/// What containment needs to know of a mesh, whatever its pose.
struct Solid {
  bool closed = false;                    // every edge belongs to an even number of facets
  std::vector<std::uint32_t> components;  // a vertex of each connected component of the facets
};

/// Vertices of equal coordinates count as one. A facet that is then a segment or a point counts as no facet for
/// `closed`. Without facets nothing is closed.
Solid solid_of(const Mesh& mesh);

/// Whether the point, which is on no facet, is inside by the parity rule. `world` are the vertices of a mesh that is
/// closed, `boxes` those of its hierarchy's nodes (refit). Coordinates are finite and below 1e300.
bool is_inside(const Vec3& point, const Mesh& mesh, const Bvh& bvh, std::span<const Vec3> world,
               std::span<const Box> boxes);

}  // namespace geometry
