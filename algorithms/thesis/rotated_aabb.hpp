// rotated_aabb: compares axis-aligned boxes whose extents come from ONE corner turned by the body's Euler angles.
//
// Source  Příbyl 2022, sections 2.2 (formulas 2.3 and 2.4) and 4.1, "AABB" (key J).
// Cost    3 axis intervals per pair at most; 3 turns with asin, sin and cos per body and step.
// Misses  Bodies turned away from multiples of 90 degrees: a square corner at 45 degrees has no extent on one axis.
// Extra   The other axis of the same corner grows by up to sqrt(2); and whatever a box adds around the mesh.
//
// This is not the box of the turned corners: the error is published so, and kept. Closed: touching is a hit.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm rotated_aabb();

/// The corner (x, y, z) = `half` after the three turns: the extents on the world axes, metres.
geometry::Vec3 turned_extents(const geometry::Vec3& half, const geometry::EulerAngles& angles);

}  // namespace algorithms
