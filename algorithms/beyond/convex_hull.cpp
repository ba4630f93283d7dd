#include "algorithms/beyond/convex_hull.hpp"

#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/balls_and_boxes.hpp"
#include "algorithms/parts/convex.hpp"

namespace algorithms {
namespace {

struct ConvexHull {
  ConvexHull(const Bodies& bodies, const Knobs&) : mesh(bodies.mesh), placed(bodies.size()) {
    solids.reserve(bodies.meshes.size());
    for (const geometry::Mesh& one : bodies.meshes) solids.push_back(geometry::convex_of(one.vertices));
    rejecting.resize(bodies.size());
  }

  /// As if all vertices were corners of their hull: whether they are is not known from sizes.
  static Memory memory(const Bodies& bodies, const Knobs&) {
    Memory out = memory_by_body(
        bodies, sizeof(std::uint32_t) + sizeof(geometry::PlacedConvex) + geometry::BallsAndBoxes::kBytes);
    std::uint64_t making = 0;
    for (const geometry::Mesh& one : bodies.meshes) {
      out.held += geometry::convex_bytes(one.vertices.size());
      making = std::max(making, out.held + geometry::convex_making_bytes(one.vertices.size()));
    }
    out.greatest = std::max(out.held, making);
    return out;
  }

  void prepare(std::span<const Pose> poses, double enlarge) {
    for (std::size_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;  // takes part in no pair: must not cost time
      const geometry::Convex& solid = solids[mesh[body]];
      placed[body] = geometry::placed(solid, poses[body], enlarge);
      const geometry::Placement& at = placed[body].at;
      const double margin = placed[body].margin;
      geometry::Box box = geometry::world_box(solid.around, at);
      if (enlarge > 0) {
        box.min.array() -= margin;
        box.max.array() += margin;
      }
      // 2^-49: the rounding of squares and their sum, (5) of geometry/decision/frames.cpp.
      rejecting.set(body, at.middle, (solid.around.radius + margin) * (1 + 0x1p-49), box);
    }
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    if (!rejecting.touch(a, b, count)) return false;
    std::uint64_t corners = 0;
    const bool met = geometry::convex_meet(placed[a], placed[b], corners);
    count += corners;
    return met;
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    rejecting.touch_row(a, first, last, out);
    std::uint64_t corners = 0;
    for (std::uint32_t b = first; b < last; ++b)
      if (out[b - first]) out[b - first] = geometry::convex_meet(placed[a], placed[b], corners);
  }

  std::vector<geometry::Convex> solids;        // per distinct mesh
  std::vector<std::uint32_t> mesh;             // per body
  std::vector<geometry::PlacedConvex> placed;  // of the step
  geometry::BallsAndBoxes rejecting;           // of the step
};

std::vector<Proxy> proxies(const Bodies& bodies, const Knobs&) {
  std::vector<Proxy> out;
  for (const geometry::Mesh& one : bodies.meshes)
    out.push_back({.kind = Proxy::Kind::solids,
                   .balls = {},
                   .solids = {geometry::surface_with_facets(geometry::convex_of(one.vertices))}});
  return out;
}

}  // namespace

Algorithm convex_hull() {
  return {.name = "convex_hull",
          .what = "the convex hulls of the meshes, as solids, share a point (GJK)",
          .operations_unit = "balls, axis intervals and corners",
          .promise = Promise::conservative,
          .make = make_pairwise<ConvexHull>,
          .fits_all = true,
          .memory = ConvexHull::memory,
          .proxies = proxies};
}

}  // namespace algorithms
