// cannon_sap: the physics engine that the thesis compares with, its sweep and prune.
//
// Source  Příbyl 2022, section 2.3: Cannon.js with its SAPBroadphase along x; pair by pair the answers of cannon-es
// 0.20
//         to the world made anew at each step, with Sphere shapes for spheres and Box shapes of the half extents else.
// Cost    A sort of the bodies per step, then per body a bisection, and 1 distance per pair until the sweep breaks.
// Misses  What the sweep breaks before. It sorts by the lower bounds of boxes along x, and breaks at the first body
// whose
//         *ball* is apart along x: the ball of a large flat body begins far before its box, and a small body whose box
//         begins before that box can end the search for a third one. Spheres that only touch are no hit.
// Extra   Everything inside the spheres and outside the meshes.
//
// Three phases: pairs by the broad phase, a filter that drops two fixed bodies, and the test of bounding spheres
// (algorithms/parts/spheres.hpp).
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm cannon_sap();

}  // namespace algorithms
