// A tight capsule around points: the same bits on every machine.
#pragma once
#include <span>

#include "algorithms/parts/enclosing_ball.hpp"

namespace algorithms {

/// What is within `radius` of the segment, metres, in the frame of a mesh. A segment of length 0 is a ball.
struct Capsule {
  geometry::Vec3 from = geometry::Vec3::Zero(), to = geometry::Vec3::Zero();
  double radius = 0;
};

/// A capsule that holds all points, at least one, rounding included: the one of least volume that a search over
/// directions finds, or the smallest ball where none is less. A search that ends in a local best is no proof.
Capsule tight_capsule(std::span<const geometry::Vec3> points);

}  // namespace algorithms
