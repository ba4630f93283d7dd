#include "algorithms/beyond/capsule.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/beyond/tight_capsule.hpp"
#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/touching_balls.hpp"
#include "geometry/vec.hpp"

namespace algorithms {
namespace {

using geometry::dot;
using geometry::Vec3;

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

/// In the frame of a mesh.
std::vector<Segment> segments_of(const Bodies& bodies) {
  std::vector<Segment> out;
  for (const geometry::Mesh& mesh : bodies.meshes) {
    const Capsule tight = tight_capsule(mesh.vertices);
    const Vec3 half = 0.5 * tight.to - 0.5 * tight.from;
    out.push_back({tight.from + half, half, tight.radius});
  }
  return out;
}

std::vector<Ball> balls_around(std::span<const Segment> segments) {
  std::vector<Ball> out;
  for (const Segment& one : segments)
    out.push_back({one.middle, (std::sqrt(dot(one.half, one.half)) + one.radius) * (1 + 0x1p-49)});
  return out;
}

struct CapsuleTest {
  CapsuleTest(const Bodies& bodies, const Knobs&)
      : bodies(bodies), local(segments_of(bodies)), whole(bodies, balls_around(local)), segments(bodies.size()) {}

  static Memory memory(const Bodies& bodies, const Knobs&) {
    std::uint64_t making = 0;
    for (const geometry::Mesh& mesh : bodies.meshes)
      making = std::max(making,
                        (mesh.vertices.size() + 2 * std::min<std::size_t>(mesh.vertices.size(), 500)) * sizeof(Vec3));
    const Memory held = memory_by_body(bodies, sizeof(Segment) + touching_balls_bytes());
    return {held.held, std::max(held.held, making)};
  }

  void prepare(std::span<const Pose> poses, double enlarge) {
    whole.prepare(poses, enlarge);
    for (std::uint32_t body = 0; body < poses.size(); ++body) {
      const Pose& pose = poses[body];
      if (!geometry::is_born(pose)) continue;
      const Segment& of = local[bodies.mesh[body]];
      const geometry::Mat3 r = geometry::rotation(pose.q);
      // The rounding of the half segment and of the separation is of the size of a ball's: twice its slack.
      segments[body] = {geometry::to_world(r, pose.t, of.middle), geometry::to_world(r, Vec3::Zero(), of.half),
                        of.radius + 2 * whole.slack(body)};
    }
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    count += 1;
    return whole.touch(a, b) && capsules_touch(segments[a], segments[b], count);
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    whole.row(a, first, last, out);
    NoCount none;
    for (std::uint32_t b = first; b < last; ++b)
      if (out[b - first]) out[b - first] = capsules_touch(segments[a], segments[b], none);
  }

  const Bodies& bodies;
  std::vector<Segment> local;  // one a distinct mesh
  TouchingBalls whole;
  std::vector<Segment> segments;  // of the step
};

std::vector<Proxy> proxies(const Bodies& bodies, const Knobs&) {
  std::vector<Proxy> out;
  for (const geometry::Mesh& mesh : bodies.meshes) {
    const Capsule tight = tight_capsule(mesh.vertices);
    out.push_back(
        {.kind = Proxy::Kind::capsule, .balls = {{tight.from, tight.radius}, {tight.to, tight.radius}}, .solids = {}});
  }
  return out;
}

}  // namespace

Algorithm capsule() {
  return {.name = "capsule",
          .what = "tight capsules around the vertices touch",
          .operations_unit = "distances",
          .promise = Promise::conservative,
          .make = make_pairwise<CapsuleTest>,
          .fits_all = true,
          .memory = CapsuleTest::memory,
          .proxies = proxies};
}

}  // namespace algorithms
