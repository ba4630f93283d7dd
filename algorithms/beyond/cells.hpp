// A mesh cut into cells by planes: what of its facets is in a cell, and which corners of the cell are inside it.
//
// What of a closed mesh is in a cell, inside and surface, lies in the convex hull of points_in: an extreme point of
// that hull is on the surface, hence on a facet in the cell, or else a corner of the cell; from every other place
// inside one can step both ways along some direction without leaving cell or mesh.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/decision/contain.hpp"
#include "geometry/mesh.hpp"

namespace algorithms {

/// Convex polygons, one after another.
struct Polygons {
  std::vector<geometry::Vec3> points;
  std::vector<std::uint32_t> ends;

  /// What was added since the last one is a polygon; nothing is none.
  void close();
};

/// The facets, and vertices that no facet has, with `at` in place of the mesh's vertices.
Polygons polygons_of(const geometry::Mesh& mesh, std::span<const geometry::Vec3> at);

/// What of the polygons has side (x_k - at) <= 0, side being 1 or -1. A corner that the cut makes is on it along k, and
/// along the others within 16 u of the greatest coordinate, u = 2^-53.
Polygons clipped(const Polygons& polygons, int k, double at, double side);

/// The same where no polygon need be on both sides that is not: what touches the plane alone, within `margin`, is on
/// its own side, what lies in it on that which `takes_flat`. Others are cut `margin` beyond.
Polygons parted(const Polygons& polygons, int k, double at, double side, double margin, bool takes_flat);

/// Whether points are inside a mesh; nothing is inside an open one.
class Inside {
 public:
  /// `at` in place of the mesh's vertices; `solid` is that of the mesh.
  Inside(const geometry::Mesh& mesh, const geometry::Solid& solid, std::vector<geometry::Vec3> at);

  bool operator()(const geometry::Vec3& point) const;

 private:
  geometry::Mesh mesh_;
  geometry::Bvh bvh_;
  std::vector<geometry::Box> boxes_;
};

/// Corner i of 8.
inline geometry::Vec3 corner(const geometry::Box& box, int i) {
  return {(i & 1 ? box.max : box.min).x(), (i & 2 ? box.max : box.min).y(), (i & 4 ? box.max : box.min).z()};
}

/// The points of polygons that were clipped to a box, and those corners of it that are inside.
std::vector<geometry::Vec3> points_in(const geometry::Box& box, const Polygons& facets, const Inside& inside);

/// Bytes of polygons and hierarchy of a mesh while it is cut, about.
std::uint64_t cutting_bytes(const geometry::Mesh& mesh);

}  // namespace algorithms
