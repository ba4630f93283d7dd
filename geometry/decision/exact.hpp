// The exact answer for two triangles: do they share a point?
//
// Triangles are closed sets: touching counts. The answer is exact for the doubles given, over their whole finite range
// and also for triangles degenerated to a segment or a point. Most pairs are decided in doubles under a proved error
// bound; the rest by CGAL's exact predicates.
#pragma once
#include <array>

#include "geometry/pose.hpp"

namespace geometry {

using Triangle = std::array<Vec3, 3>;

/// True when the corners lie exactly on one line (or in one point).
bool is_degenerate(const Triangle& t);

/// The side of the plane through a, b and c on which d is: the sign of ((b - a) x (c - a)) . (d - a), exactly. 0 when
/// the four lie in one plane. Coordinates are finite.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// True when the closed triangles share a point. Coordinates are finite.
bool triangles_meet(const Triangle& a, const Triangle& b);

}  // namespace geometry
