// How much of a mesh sticks out of what is taken for it.
#pragma once
#include <span>

#include "geometry/mesh.hpp"

namespace geometry {

/// Of the vertices of a mesh.
struct Wrapping {
  double outside_share = 0;     // how many of them are outside, of all
  double outside_greatest = 0;  // m: none is farther outside than this, certified; 0 where none is
};

/// The union of balls. A vertex is outside when it certainly is: farther from every centre than the radius by more than
/// rounding.
Wrapping outside_balls(const Mesh& mesh, std::span<const ContactBall> balls);

/// What is within from.radius of the segment between the centres. Likewise.
Wrapping outside_capsule(const Mesh& mesh, const ContactBall& from, const ContactBall& to);

/// The union of solids: of each its surface and, where it is closed (geometry/decision/contain.hpp, `closed_within`
/// included), its inside. Which vertices are outside is decided exactly.
Wrapping outside_solids(const Mesh& mesh, std::span<const Mesh> solids, double closed_within);

}  // namespace geometry
