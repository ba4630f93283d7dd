// Polygons into triangles that do not leave them.
//
// A polygon is looked at in the coordinate plane in which its area is greatest, by exact orientations. Where the fan
// from its first corner stays inside, as in every convex polygon, it becomes that fan. Else ears are cut: corners whose
// triangle holds no other part of the outline, the smallest first. Corners may lie on a line, repeat, or touch
// other corners and edges; a hole may be joined to the outline by a bridge that is walked twice. A polygon that crosses
// itself has no inside to keep to: it becomes the fan from its first corner, and is named.
//
// n corners always become n - 2 triangles, in the polygon's own direction, some of them without area where corners
// repeat or the outline runs back on itself.
//
// Time: O(n) for a fan. Else O(n log n) for whether the outline crosses itself, and at most 3 n questions whether an
// ear is free, which look at about sqrt(n) corners each: 100,000 corners of combs, spirals and ribbons take 0.1 to 0.2
// s. Corners that are all in one place are looked at each time: 20,000 petals around one point take half a minute.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.hpp"

namespace geometry {

/// What should be known of a polygon beside its triangles.
struct PolygonFacts {
  bool crosses_itself = false;  // seen in the plane of its greatest area
  // How far its corners lie from the plane through their mean, at most, and the greatest side of the box around them;
  // metres.
  double off_plane = 0, extent = 0;
};

/// A polygon is far from flat when its corners are off their plane by more than this share of its extent. Numbers that
/// were written with three digits or more stay below.
constexpr double kFarFromFlat = 0.01;

/// Triangles of the polygon with these corners, at least three, are put into `out`, which has two less than the
/// corners.
PolygonFacts cut_polygon(std::span<const std::uint32_t> corners, std::span<const Vec3> vertices, std::span<Facet> out);

}  // namespace geometry
