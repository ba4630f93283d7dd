// capsule: tests whether tight capsules around the bodies' vertices touch.
//
// Source  The proxy of characters in engines: the segment of one against the segment of the other.
// Cost    1 distance per pair; of pairs whose balls overlap 5 more between points of the segments, and where these are
//         apart the separation along the line between the nearest two. Made once per mesh.
// Misses  Nothing that meets, nor a body inside another. Touching is a hit, and capsules are larger than they need to
// be
//         by about 2^-45 of the body's size and distance.
// Extra   Everything in the capsule and outside the mesh: of a box its faces' bulge, of a plate nearly a ball.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm capsule();

}  // namespace algorithms
