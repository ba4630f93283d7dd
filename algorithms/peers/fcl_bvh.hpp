// fcl_bvh: a well-known library beside the methods of the thesis: FCL, the Flexible Collision Library, which answers
// for meshes in robotics (MoveIt, Drake, Tesseract).
//
// Source  FCL 0.7, BVHModel<OBBRSS<double>>, one contact asked for; J. Pan, S. Chitta, D. Manocha, "FCL: A general
//         purpose library for collision and proximity queries", ICRA 2012.
// Cost    The broad phase of `exact`; then per near pair a descent of two hierarchies of oriented boxes, built once per
//         distinct mesh, and tests of triangles. About 600 bytes a triangle of each distinct mesh.
// Misses  Pairs that graze: FCL turns the one body into the other's frame and tests triangles in doubles with a
//         tolerance of its own, so its answer is that of slightly other triangles. Bodies without a common surface
//         point, one inside the other, as `exact` does.
// Extra   Pairs that nearly touch, for the same reason; anything beyond coordinates of 1e150, whose squares overflow.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm fcl_bvh();

}  // namespace algorithms
