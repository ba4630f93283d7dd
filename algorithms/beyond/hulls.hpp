// hulls: tests whether one of the convex pieces of a body shares a point with one of those of the other.
//
// Source  Convex decomposition, what engines take in place of a concave mesh (V-HACD, CoACD, HACD); here by cutting
// with
//         planes (beyond/convex_pieces.hpp). Knobs: `count`, at most that many pieces; `concavity`, when it is enough.
// Cost    1 distance per pair; of pairs whose tightest balls overlap a GJK for each pair of pieces whose balls overlap.
//         Made once per mesh: that takes up to a second for a thousand facets.
// Misses  Nothing that was found: the pieces hold every vertex and every facet, but for the rounding of the corners
// that
//         cuts make. No promise; how far a piece wraps is measured (/meshes/<mesh>/proxies). Touching is a hit.
// Extra   What lies in the notches and holes that are left in a piece. A body inside another is a hit.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm hulls();

}  // namespace algorithms
