// What the parity rule makes of a mesh that covers some place twice: outside, though most would call it inside.
//
// Two facets of the same corners cancel each other, and what lies in two shells lies in none. Both are found exactly
// where that is cheap: facets by their corners, shells that meet and shells inside others by the decision itself. Which
// way a shell faces is the sign of its volume in doubles. A single shell that crosses itself is not looked for.
#pragma once
#include <cstddef>

#include "geometry/decision/contain.hpp"

namespace geometry {

struct Shells {
  std::size_t shells = 0;           // connected components of the closed surface
  std::size_t repeated_facets = 0;  // whose three corners another facet before them has
  std::size_t meeting = 0;          // shells that touch or cross another one
  std::size_t nested_alike = 0;     // shells that lie in another and face as it does: no cavity, no island in one
};

/// `solid` is that of the mesh. Of an open mesh only the facets are counted.
Shells shells_of(const Mesh& mesh, const Solid& solid);

}  // namespace geometry
