// convex_hull: the convex hulls of the two meshes, taken as solids, share a point.
//
// Source  Příbyl 2022, section 2.1: of the wrappers the most precise and the dearest. Decided by GJK, exactly but for a
//         margin that covers rounding (algorithms/parts/convex.hpp).
// Cost    Once per mesh its hull, O(n log n) exact orientations. Per pair a ball, three box axes, and where these touch
// some
//         dozens of corners per direction tried, mostly 1 to 6 directions.
// Misses  Nothing that meets. Closed: touching is a hit.
// Extra   What the hull adds around the mesh: the middle of a ring, dents. A body wholly inside another.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm convex_hull();

}  // namespace algorithms
