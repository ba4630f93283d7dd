// How far surfaces are apart: a lower and an upper bound, both certified.
//
// The distance is that of the two surfaces as sets of points, made of the world vertices as rounded by to_world: the
// same doubles the truth is defined by. A body inside another keeps the distance of the two surfaces.
// geometry/decision/gap.cpp derives the bounds; they are about 1e-12 of the bodies' joint extent apart, also for
// slivers and degenerate triangles.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/decision/bvh.hpp"
#include "geometry/decision/exact.hpp"

namespace geometry {

/// lower <= distance <= upper, metres.
struct GapBounds {
  double lower = 0, upper = 0;
};

/// The distance of two triangles that do not meet; of two that do, lower is 0. Coordinates below 1e300 in magnitude.
/// Bounds are within 1e-12 of the triangles' joint extent of each other, and 1e-284 m.
GapBounds triangle_gap(const Triangle& a, const Triangle& b);

/// The distance of two bodies.
struct Gap {
  Pair pair;
  GapBounds metres;
};

/// Finds the distances of a step. Holds scratch memory: one object per thread. Answers do not depend on what was asked
/// before.
class GapSearch {
 public:
  /// `bodies` and `bvhs` (one per distinct mesh) must outlive this object.
  GapSearch(const Bodies& bodies, std::span<const Bvh> bvhs);

  /// The pairs among `runs` whose lower bound is at most `margin` (metres, finite) and that are not in `met`, which is
  /// sorted and holds those that meet: their distance is 0. Sorted. `poses` has one pose per body; those of bodies in
  /// no run are not read. A body with a vertex that is not finite is near nobody.
  std::vector<Gap> near(std::span<const Pose> poses, std::span<const PairRun> runs, double margin,
                        std::span<const Pair> met);

 private:
  struct Placed {
    std::vector<Vec3> world;  // #vertices
    std::vector<Box> boxes;   // #nodes
  };
  struct Visit {
    std::uint32_t i, j;  // nodes
    double least;        // lower bound on the distance of what is in them, metres
  };

  const Placed& place(std::span<const Pose> poses, std::uint32_t body);
  GapBounds between(std::uint32_t a, std::uint32_t b, double margin);

  const Bodies& bodies_;
  std::span<const Bvh> bvhs_;
  std::vector<Placed> placed_;       // reused from step to step
  std::vector<std::uint32_t> slot_;  // #bodies, index into placed_ or none
  std::size_t used_ = 0;             // of placed_
  std::vector<Vec3> scratch_;
  std::vector<Visit> stack_;
};

}  // namespace geometry
