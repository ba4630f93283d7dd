// bounding_sphere: tests whether balls around the bodies' positions, each as long as the half diagonal, overlap.
//
// Source  Příbyl 2022, section 4.1, the test by the largest dimension (key H).
// Cost    1 distance per pair; nothing per body and step but a copy of its position.
// Misses  Nothing that meets. Balls that only touch are no hit, as published.
// Extra   Everything inside the ball and outside the mesh: the most of all nine.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm bounding_sphere();

}  // namespace algorithms
