// Containment: which bodies lie wholly inside others.
//
// A body A is contained in a closed body B when their surfaces share no point, A's surface shares no point with B's
// closed surface either, and one vertex of every connected component of A is inside the latter by the parity rule: a
// path from it to the outside crosses that surface an odd number of times. Exact for the world vertices as rounded by
// to_world, like the truth (geometry/decision/meet.hpp). A may be open: that a surface lies inside another is asked of
// its points only. Nothing lies inside an open B.
//
// What matters here is the surface as a set of points, so vertices of equal coordinates are one: a sphere whose seam is
// doubled, or an STL file, is closed when its points are. (Equal local coordinates become equal world coordinates.)
// That is more than is_closed() sees, which goes by index.
//
// The hair. Exporters compute one corner twice and write it a hair apart. Where the mesh is open by its coordinates,
// corners are joined, for this question only, by a width w (closed_within times the greatest side of the box around the
// facets' corners):
// - Only corners of open edges are joined: of edges that belong to an odd number of facets.
// - Two are near when no coordinate differs by more than w; who is near somebody is with him, and so on. Such a group
//   that is at most w along every axis is one corner, at the place of its least member (by x, then y, then z). A longer
//   chain is a fine border, no hair: its corners stay what they are.
// - A facet of which two corners became one counts as no facet.
// The mesh is closed when then every edge belongs to an even number of facets. The facets' boundary modulo 2 is carried
// along by whatever joins vertices: open edges become open edges, coincide in pairs or shrink to a point, and edges
// that were even stay even. So joining opens nothing, what was closed before is not touched, however small, and a
// border as small as the width closes: a pole that is a ring of 1e-16 m, a facet too small to matter. The closed
// surface are the facets with their joined corners: true facets of true vertices, hence a cycle modulo 2 for which
// parity is exact and the same along every path. It differs from the mesh as read by w at most. What lies in between,
// in the hair, is decided too: a body that touches or crosses the closed surface there is not contained, though it
// meets no facet as read.
#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/decision/bvh.hpp"
#include "geometry/mesh.hpp"

namespace geometry {

/// An edge that belongs to an odd number of facets.
struct OpenEdge {
  Vec3 from, to;           // m, as read, in the mesh's frame
  std::size_t facets = 0;  // that it belongs to
};

/// What containment needs to know of a mesh, whatever its pose.
struct Solid {
  bool closed = false;
  std::vector<std::uint32_t> components;  // a vertex of each connected component of the facets as read
  double width = 0;                       // m; w above
  // The greatest distance, along an axis, of corners taken for one, m: 0 when closed as read; NaN when open.
  double closed_within = std::numeric_limits<double>::quiet_NaN();
  std::optional<OpenEdge> open_edge;  // when open: the first in the order of the facets that stays open

  /// The closed surface where it is not the mesh itself: the mesh's vertices, facets with joined corners.
  struct Surface {
    Mesh mesh;
    Bvh bvh;
  };
  std::optional<Surface> surface;
};

/// `closed_within` as in Bodies. A facet that is a segment or a point counts as no facet for `closed`. Without facets
/// nothing is closed.
Solid solid_of(const Mesh& mesh, double closed_within);

/// What is wrong with a mesh that is open: the edge and the width, without the mesh's name.
std::string open_text(const Solid& solid);

/// For every vertex the first, in the order of the mesh, that has its coordinates.
std::vector<std::uint32_t> joined_by_coordinates(std::span<const Vec3> vertices);

/// Whether the point, which is on no facet, is inside by the parity rule. `world` are the vertices of a mesh that is
/// closed, `boxes` those of its hierarchy's nodes (refit). Coordinates are finite and below 1e300.
bool is_inside(const Vec3& point, const Mesh& mesh, const Bvh& bvh, std::span<const Vec3> world,
               std::span<const Box> boxes);

}  // namespace geometry
