// What a scripted scene holds besides poses: straight passes of a hero, and sets of cases at the extremes.
#pragma once
#include <cstdint>
#include <string>

#include "geometry/pose.hpp"

namespace pipeline {

/// One body, the hero, moves on a straight line past another, the target; all others stand still.
struct Pass {
  std::uint32_t hero = 0, target = 0;  // bodies
  std::string path, orientation;       // their names
  double offset = 0;                   // m, of the line from the target's position
  geometry::Vec3 from, to;             // world, m
  geometry::Quaternion q;              // the hero's, all the way
  std::int64_t first_step = 0;
  std::int64_t samples = 2;  // at equal distances, both ends included
};

/// Metres from `from` to `to`.
double length(const Pass& pass);

/// Metres from `from` to a sample, 0 to samples - 1.
double position(const Pass& pass, std::int64_t sample);

/// The hero's pose that many metres from `from`: that of a sample at its position, bit for bit.
geometry::Pose pose_at(const Pass& pass, double metres);

/// Steps at which the same two bodies come ever nearer, from apart to deep inside each other or the other way.
struct CaseSet {
  std::int64_t first_step = 0, steps = 0;
  std::uint32_t a = 0, b = 0;
  geometry::Vec3 outward = geometry::Vec3::Zero();  // one ulp of the approach, m: b moves so to be farther
  geometry::Vec3 moved = geometry::Vec3::Zero();    // m: a + moved and b + moved are exact
};

}  // namespace pipeline
