// obb_triangles: tests the 12 outer triangles of one turned box against the 12 of the other, 11 axes each.
//
// Source  Příbyl 2022, section 4.1, "OBB and per triangle" (key O).
// Cost    Behind the prefilter, 12 planes of faces per pair, then the triangle pairs that none of them parts, 144 at
//         most; 8 turned corners and 12 triangles per body and step.
// Misses  A body inside another; what the prefilter misses; bodies turned about more than one axis or about x beyond 90
//         degrees, whose box is another one.
// Extra   Whatever the box adds around the mesh, and coplanar faces, which are "yes" however far apart.
//
// The corners are turned about x, y, z by Babylon.js's angles, whose order is z, x, y: published so, and kept. The
// triangle test is algorithms/parts/eleven_axes.hpp's. Touching is a hit.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm obb_triangles();

}  // namespace algorithms
