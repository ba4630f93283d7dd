// facet_rotations: as facet_triangles, with the thesis's own triangle test: turn both, compare intervals, turn on.
//
// Source  Příbyl 2022, sections 3.1 and 4.1, "FaceT and new per triangle" (key U).
// Cost    At worst m n intervals on 307 directions (angle_step 10) for m and n sampled triangles; one or two
//         directions clear most pairs of bodies, and most triangles of the others.
// Misses  Contact in the holes of the envelope, most bodies inside another, bodies with fewer than 3 sampled facets.
//         Its triangle test never denies triangles that truly meet.
// Extra   Near misses between the directions of the grid, and as the envelope is inflated; bodies inside another that
//         one of its triangles, cutting across it, meets.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm facet_rotations();

/// The distinct lines on which the turns by `angle_step` degrees compare intervals, as unit vectors whose first
/// non-zero component is positive. Scattered: any few consecutive ones look all ways. 307 at 10 degrees.
std::vector<geometry::Vec3> rotation_grid(double angle_step);

}  // namespace algorithms
