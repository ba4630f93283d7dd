// Convex solids: the hull of a mesh's vertices or of any points, and whether two of them share a point.
//
// "No" is certain: a direction along which all corners of the one lie behind all of the other, by more than every
// rounding together. "Yes" is a common point, or no such direction found: solids that touch, or are apart by less than
// the rounding of where they are (2^-45 of sizes and distances from the origin). So nothing that meets is missed, and
// the answer for (b, a) is that for (a, b).
// Source: E. Gilbert, D. Johnson, S. Keerthi, "A fast procedure for computing the distance between complex objects in
// three-dimensional space", 1988; supports by walking along edges: S. Cameron, "Enhancing GJK", 1997.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/parts/facets.hpp"
#include "geometry/decision/broad_phase.hpp"
#include "geometry/mesh.hpp"

namespace geometry {

/// The hull of some points, made ready once.
struct Convex {
  static constexpr int kGrid = 8;   // cells along each edge of a cube of directions
  static constexpr int kLanes = 8;  // corners looked at side by side
  Mesh surface;                     // corners and facets of the hull (geometry/decision/hull.hpp), closed or flat
  int dimension = 0;                // of the hull: 3 solid, 2 flat, 1 a segment, 0 a point
  Enclosure around;                 // of the corners
  double inner = 0;                 // m: the ball about around.centre of this radius lies inside
  std::vector<std::uint32_t>
      first;  // #corners + 1: corner i has the neighbours beside[first[i]] to beside[first[i + 1] - 1]
  std::vector<std::uint32_t> beside;                   // along the edges of the facets
  Points columns;                                      // the corners, the last one repeated up to a multiple of kLanes
  std::vector<Vec3> normal;                            // #facets, unit
  std::array<std::uint32_t, 6 * kGrid * kGrid> start;  // a corner far along the directions of a cell
};

/// Of at least one point, all finite.
Convex convex_of(std::span<const Vec3> points);

/// Its surface; a segment or a point as one facet without area.
Mesh surface_with_facets(Convex solid);

/// Bytes of it for that many corners, about.
std::uint64_t convex_bytes(std::uint64_t corners);

/// Bytes more that it takes while it is made.
std::uint64_t convex_making_bytes(std::uint64_t corners);

/// A convex solid at a step.
struct PlacedConvex {
  const Convex* solid = nullptr;
  Placement at;
  double margin = 0;  // m: what it must be apart from others by for certain, and by how much it is enlarged
};

/// `enlarge` as in Method::prepare: it grows by enlarge (size + |t|).
PlacedConvex placed(const Convex& solid, const Pose& pose, double enlarge = 0);

/// Whether the solids share a point; touching counts. Adds the corners looked at to `operations`.
bool convex_meet(const PlacedConvex& a, const PlacedConvex& b, std::uint64_t& operations);

/// Whether b is solid and every corner of a lies in it, to rounding.
bool convex_inside(const PlacedConvex& a, const PlacedConvex& b, std::uint64_t& operations);

}  // namespace geometry
