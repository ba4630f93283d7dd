// facet_surface: closed surfaces of about one stride-th of the facets, made once per mesh, meet.
//
// Source  The envelope of facet_triangles and facet_rotations without its holes, wished for by Příbyl 2022,
// section 6.1. Made by
//         collapsing edges (algorithms/parts/simplified.hpp), each facet of the mesh into one of the surface, and grown by
//         `inflate` about the body's origin. A mesh of 32 facets and fewer stays as it is, and none gets fewer.
// Cost    Once per mesh O(F log F). Per pair that the prefilter leaves GJK between the hulls, and where they meet, of
// convex
//         bodies whether one is inside the other, of others the exact decision (geometry/decision/meet.hpp) of the two
//         surfaces.
// Misses  Contact in what the collapses cut off, bodies inside another, what the prefilter misses.
// Extra   What they add, and what the inflation adds.
//
// Convex bodies (whose volume is that of their hull to 2 %) have the hull of the surface's corners as their surface.
// algorithms/README.md has the constructions that were tried.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm facet_surface();

}  // namespace algorithms
