// aabb: compares the axis-aligned world boxes of all vertices.
//
// Source  Standard; the baseline that rotated_aabb falls short of, and a prefilter for the precise methods.
// Cost    3 axis intervals per pair at most; every vertex of a body turned once per step.
// Misses  Nothing that meets. Closed: touching is a hit.
// Extra   Whatever the box adds around the mesh.
//
// The boxes hold the very doubles that truth is defined by (geometry::to_world), so even rounding makes no miss.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm aabb();

}  // namespace algorithms
