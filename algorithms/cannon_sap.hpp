// cannon_sap: the physics engine that the thesis compares with, its sweep and prune.
//
// Source  Příbyl 2022, section 2.3: Cannon.js with its SAPBroadphase along x.
// Cost    A sort of the bodies per step, then per body a bisection of the bounds, and 1 distance per pair that overlaps
//         along x.
// Misses  Nothing that meets. Spheres that only touch are no hit, as published.
// Extra   Everything inside the spheres and outside the meshes.
//
// Three phases: pairs by the broad phase, a filter that drops two fixed bodies, and the test of bounding spheres
// (algorithms/parts/spheres.hpp).
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm cannon_sap();

}  // namespace algorithms
