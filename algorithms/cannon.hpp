// cannon_naive, cannon_sap: the collision phases of the physics engine that the thesis compares with.
//
// Source  Příbyl 2022, section 2.3: Cannon.js with its NaiveBroadphase and its SAPBroadphase along x.
// Cost    naive: 1 distance per pair. sap: a sort of the bodies per step, then per body a bisection of the bounds, and
//         1 distance per pair that overlaps along x.
// Misses  Nothing that meets. Spheres that only touch are no hit, as published.
// Extra   Everything inside the spheres and outside the meshes.
//
// Three phases: pairs by the broad phase, a filter that drops two fixed bodies, and the test of bounding spheres. The
// sphere of a sphere shape is the shape (nominal radius); of any other body it is as long as the half diagonal.
#pragma once
#include "algorithms/algorithm.hpp"

namespace algorithms {

Algorithm cannon_naive();
Algorithm cannon_sap();

}  // namespace algorithms
