// ccd_gjk: libccd's convex hulls by Gilbert, Johnson and Keerthi's algorithm.
//
// Source  libccd 2.1, ccdGJKIntersect, on support points of the meshes' vertices.
// Cost    The broad phase of `exact`; then per near pair a few support points, each a look at every vertex.
// Misses  Hulls that only touch; with few iterations others too. Its answer can change when the two bodies are swapped.
// Extra   What a hull adds to a body that is not convex; bodies inside others.
#include "algorithms/peers/libraries/ccd.hpp"

namespace peers {
namespace {

struct Hulls : Ccd {
  using Ccd::Ccd;
  bool meet(std::uint32_t a, std::uint32_t b) { return ccdGJKIntersect(hull(a), hull(b), &ccd) != 0; }
};

}  // namespace
}  // namespace peers

COLLISION_EXPORT const collision_table* collision_plugin() {
  static const collision_knob knobs[] = {peers::iterations_knob()};
  return peers::table<peers::Hulls>({.name = "ccd_gjk",
                                     .what = "libccd, convex hulls of the vertices by GJK",
                                     .precision = "double",
                                     .knobs = knobs});
}
