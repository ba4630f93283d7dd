// facet_distance: a hit when two facet points, one of each body, are nearer than `max_distance`.
//
// Source  Příbyl 2022, sections 3.1 and 4.1, "FaceT and distance" (key K).
// Cost    At worst m n distances for m and n sampled facets; with search = "indexed" about min(m, n), and m' log n' for
//         those that are near: the larger set has a tree, made once per mesh.
// Misses  A small body inside a big one, and contact in the middle of large facets that `densify` does not cut.
// Extra   Bodies up to `max_distance` apart; it flickers while bodies slide along each other, as points pass points.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm facet_distance();

}  // namespace algorithms
