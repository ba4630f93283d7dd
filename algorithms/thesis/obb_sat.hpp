// obb_sat: bounding spheres, then axis-aligned boxes, then the fifteen separating axes of the oriented boxes.
//
// Source  Příbyl 2022, section 4.1, Babylon.js's precise intersectsMesh (key G).
// Cost    1 to 19 axis projections per pair (the spheres count as one); 8 turned corners per body and step.
// Misses  Nothing that meets. Closed: touching is a hit.
// Extra   Whatever the local vertex box adds around the mesh: the middle of a ring, the gaps of a knot.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm obb_sat();

}  // namespace algorithms
