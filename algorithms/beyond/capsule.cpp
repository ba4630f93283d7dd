#include "algorithms/beyond/capsule.hpp"

#include <algorithm>
#include <cmath>

#include "algorithms/beyond/tight_capsule.hpp"
#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/world_balls.hpp"
#include "geometry/processor_clones.hpp"
#include "geometry/vec.hpp"

namespace algorithms {
namespace {

using geometry::dot;
using geometry::Vec3;

/// The balls around the capsules, by coordinate, metres.
struct Columns {
  std::vector<double> x, y, z, r;
};

/// 1 where the balls touch; what overflows is a hit.
PROCESSOR_CLONES void overlap_row(const double* x, const double* y, const double* z, const double* r, std::uint32_t a,
                                  std::uint32_t first, std::uint32_t last, std::uint8_t* hit) {
  const double ax = x[a], ay = y[a], az = z[a], ar = r[a];
  for (std::uint32_t b = first; b < last; ++b) {
    const double dx = ax - x[b], dy = ay - y[b], dz = az - z[b], reach = ar + r[b];
    hit[b - first] = !(dx * dx + dy * dy + dz * dz > reach * reach);
  }
}

/// A segment about its middle, and how far from it the body reaches; in the world, metres.
struct Segment {
  Vec3 middle = Vec3::Zero(), half = Vec3::Zero();
  double radius = 0;
};

double clamped(double t) { return std::fmin(std::fmax(t, -1.0), 1.0); }

/// Whether two capsules touch. Whatever point is taken for nearest, "no" is only said where the line through both
/// really parts them: so rounding, also that of segments that are nearly parallel, can only add hits.
template <class Count>
bool capsules_touch(const Segment& a, const Segment& b, Count& count) {
  const Vec3 between = b.middle - a.middle;
  const double reach = a.radius + b.radius;
  Vec3 nearest = between;
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](double s, double t) {  // a.middle + s a.half and b.middle + t b.half
    count += 1;
    const Vec3 way = between + t * b.half - s * a.half;
    if (const double square = dot(way, way); square < least) least = square, nearest = way;
  };
  const double aa = dot(a.half, a.half), bb = dot(b.half, b.half), ab = dot(a.half, b.half), ad = dot(a.half, between),
               bd = dot(b.half, between);
  const auto on_a = [&](double t) { return aa > 0 ? clamped((ad + t * ab) / aa) : 0.0; };  // nearest to a point of b
  const auto on_b = [&](double s) { return bb > 0 ? clamped((s * ab - bd) / bb) : 0.0; };
  if (const double det = aa * bb - ab * ab; det > 0) {
    const double s = clamped((ad * bb - bd * ab) / det), t = on_b(s);
    take(on_a(t), t);
  }
  for (const double end : {-1.0, 1.0}) {
    take(end, on_b(end));
    take(on_a(end), end);
  }
  if (!(least > reach * reach)) return true;
  count += 1;
  const double length = std::sqrt(least);
  const double gap = dot(nearest, between) - std::fabs(dot(nearest, a.half)) - std::fabs(dot(nearest, b.half));
  return !(gap > reach * length);
}

struct CapsuleTest {
  CapsuleTest(const Bodies& bodies, const Knobs&) : bodies(bodies), segments(bodies.size()) {
    for (const geometry::Mesh& mesh : bodies.meshes) {
      const Capsule tight = tight_capsule(mesh.vertices);
      const Vec3 half = 0.5 * tight.to - 0.5 * tight.from;
      local.push_back({tight.from + half, half, tight.radius});
      const double length = std::sqrt(dot(half, half));
      reach.push_back(reach_of({local.back().middle, (length + tight.radius) * (1 + 0x1p-49)}));
      around.push_back(length);
    }
    for (auto* column : {&s.x, &s.y, &s.z, &s.r}) column->resize(bodies.size());
  }

  static Memory memory(const Bodies& bodies, const Knobs&) {
    std::uint64_t making = 0;
    for (const geometry::Mesh& mesh : bodies.meshes)
      making = std::max(making, mesh.vertices.size() * sizeof(Vec3) +
                                    3 * std::min<std::size_t>(mesh.vertices.size(), 500) * sizeof(Vec3));
    const Memory held = memory_by_body(bodies, sizeof(Segment) + 4 * sizeof(double));
    return {held.held, std::max(held.held, making)};
  }

  void prepare(std::span<const Pose> poses, double enlarge) {
    for (std::uint32_t body = 0; body < poses.size(); ++body) {
      const Pose& pose = poses[body];
      if (!geometry::is_born(pose)) continue;
      const std::uint32_t mesh = bodies.mesh[body];
      const geometry::Mat3 r = geometry::rotation(pose.q);
      Segment& at = segments[body];
      // The rounding of the half segment and of the separation is of the size of a ball's: twice the slack.
      const double slack = 2 * world_slack(reach[mesh], pose.t, enlarge);
      at.middle = geometry::to_world(r, pose.t, local[mesh].middle);
      at.half = geometry::to_world(r, Vec3::Zero(), local[mesh].half);
      at.radius = local[mesh].radius + slack;
      s.x[body] = at.middle.x();
      s.y[body] = at.middle.y();
      s.z[body] = at.middle.z();
      s.r[body] = around[mesh] + at.radius;
    }
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    count += 1;
    const double dx = s.x[a] - s.x[b], dy = s.y[a] - s.y[b], dz = s.z[a] - s.z[b], reach = s.r[a] + s.r[b];
    return !(dx * dx + dy * dy + dz * dz > reach * reach) && capsules_touch(segments[a], segments[b], count);
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    overlap_row(s.x.data(), s.y.data(), s.z.data(), s.r.data(), a, first, last, out);
    NoCount none;
    for (std::uint32_t b = first; b < last; ++b)
      if (out[b - first]) out[b - first] = capsules_touch(segments[a], segments[b], none);
  }

  const Bodies& bodies;
  std::vector<Segment> local;         // one per distinct mesh
  std::vector<double> reach, around;  // likewise, m: from the mesh's origin, from the middle to an end
  std::vector<Segment> segments;      // of the step
  Columns s;                          // of the step
};

}  // namespace

Algorithm capsule() {
  return {.name = "capsule",
          .what = "tight capsules around the vertices touch",
          .operations_unit = "distances",
          .promise = Promise::conservative,
          .make = make_pairwise<CapsuleTest>,
          .memory = CapsuleTest::memory};
}

}  // namespace algorithms
