// ccd_mpr: libccd's convex hulls by Minkowski portal refinement.
//
// Source  libccd 2.1, ccdMPRIntersect, on support points of the meshes' vertices.
// Cost    The broad phase of `exact`; then per near pair a few support points, each a look at every vertex.
// Misses  Hulls that only just touch, as its tolerance of 1e-4 falls.
// Extra   What a hull adds to a body that is not convex; bodies inside others.
#include "algorithms/peers/libraries/ccd.hpp"

namespace peers {
namespace {

struct Hulls : Ccd {
  using Ccd::Ccd;
  bool meet(std::uint32_t a, std::uint32_t b) { return ccdMPRIntersect(hull(a), hull(b), &ccd) != 0; }
};

}  // namespace
}  // namespace peers

COLLISION_EXPORT const collision_table* collision_plugin() {
  static const collision_knob knobs[] = {peers::iterations_knob()};
  return peers::table<peers::Hulls>({.name = "ccd_mpr",
                                     .what = "libccd, convex hulls of the vertices by MPR",
                                     .precision = "double",
                                     .knobs = knobs});
}
