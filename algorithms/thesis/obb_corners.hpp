// obb_corners: tests whether a corner of one turned box is inside the other.
//
// Source  Příbyl 2022, sections 2.2 and 4.1, "OBB" (key L).
// Cost    1 distance per pair; where corners may reach, 8 points in a box each way, the second way if the first has
//         none inside; 8 turned corners per body and step.
// Misses  Bodies that cross without a corner inside (a long capsule through a thin slab, two crossed planks), and
//         bodies turned about more than one axis or about x beyond 90 degrees, whose box is another one.
// Extra   Whatever the box adds around the mesh, and the box being another one.
//
// The corners are turned about x, y, z by Babylon.js's angles, whose order is z, x, y; and back by the negated angles
// in the same order. Both errors are published so, and kept. Closed: a corner on a face is a hit.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm obb_corners();

}  // namespace algorithms
