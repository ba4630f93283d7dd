#include "algorithms/beyond/spheres.hpp"

#include <algorithm>
#include <cmath>

#include "algorithms/beyond/covering_balls.hpp"
#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/world_balls.hpp"
#include "geometry/processor_clones.hpp"

namespace algorithms {
namespace {

using geometry::Mat3;
using geometry::Vec3;

constexpr std::int64_t kMostBalls = 1024;

std::size_t count_of(const Knobs& knobs) { return static_cast<std::size_t>(value_of<std::int64_t>(knobs, "count")); }

/// Balls in the world by coordinate, metres.
struct Columns {
  std::vector<double> x, y, z, r;

  void resize(std::size_t size) {
    for (auto* column : {&x, &y, &z, &r}) column->resize(size);
  }
  void set(std::size_t i, const Vec3& centre, double radius) {
    x[i] = centre.x(), y[i] = centre.y(), z[i] = centre.z(), r[i] = radius;
  }
  /// Touching counts; what overflows is a hit.
  bool overlap(std::size_t i, const Columns& of, std::size_t k) const {
    const double dx = x[i] - of.x[k], dy = y[i] - of.y[k], dz = z[i] - of.z[k], reach = r[i] + of.r[k];
    return !(dx * dx + dy * dy + dz * dz > reach * reach);
  }
};

/// Columns::overlap of ball a with first ... last - 1.
PROCESSOR_CLONES void overlap_row(const double* x, const double* y, const double* z, const double* r, std::uint32_t a,
                                  std::uint32_t first, std::uint32_t last, std::uint8_t* hit) {
  const double ax = x[a], ay = y[a], az = z[a], ar = r[a];
  for (std::uint32_t b = first; b < last; ++b) {
    const double dx = ax - x[b], dy = ay - y[b], dz = az - z[b], reach = ar + r[b];
    hit[b - first] = !(dx * dx + dy * dy + dz * dz > reach * reach);
  }
}

struct Spheres {
  Spheres(const Bodies& bodies, const Knobs& knobs)
      : bodies(bodies), count(count_of(knobs)), slack(bodies.size()), placed(bodies.size()) {
    for (const geometry::Mesh& mesh : bodies.meshes) {
      coverings.push_back(covering_balls(mesh, count, bodies.closed_within));
      reach.push_back(reach_of(coverings.back().whole));
    }
    whole.resize(bodies.size());
    parts.resize(count * bodies.size());
  }

  static Memory memory(const Bodies& bodies, const Knobs& knobs) {
    const std::size_t balls = count_of(knobs);
    const std::uint64_t held = bodies.size() * (balls + 1) * sizeof(Ball) + bodies.size() * 2 * sizeof(double);
    std::uint64_t making = 0;
    for (const geometry::Mesh& mesh : bodies.meshes)
      if (balls > 1) making = std::max(making, covering_bytes(mesh));
    return {held, std::max(held, making)};
  }

  void prepare(std::span<const Pose> at, double enlarge) {
    poses = at;
    ++step;
    for (std::uint32_t body = 0; body < at.size(); ++body) {
      const Pose& pose = at[body];
      if (!geometry::is_born(pose)) continue;
      const Ball& ball = coverings[bodies.mesh[body]].whole;
      slack[body] = world_slack(reach[bodies.mesh[body]], pose.t, enlarge);
      whole.set(body, geometry::to_world(geometry::rotation(pose.q), pose.t, ball.centre), ball.radius + slack[body]);
    }
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    count += 1;
    return whole.overlap(a, whole, b) && parts_overlap(a, b, count);
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) {
    overlap_row(whole.x.data(), whole.y.data(), whole.z.data(), whole.r.data(), a, first, last, out);
    NoCount none;
    for (std::uint32_t b = first; b < last; ++b)
      if (out[b - first]) out[b - first] = parts_overlap(a, b, none);
  }

  std::size_t balls(std::uint32_t body) const { return coverings[bodies.mesh[body]].balls.size(); }

  /// The balls of a pair whose tightest ones overlap: each of a that overlaps b's tightest against all of b.
  template <class Count>
  bool parts_overlap(std::uint32_t a, std::uint32_t b, Count& count) {
    if (balls(a) == 1 && balls(b) == 1) return true;  // the tightest
    place(a);
    place(b);
    const std::size_t i_end = a * this->count + balls(a), k_end = b * this->count + balls(b);
    for (std::size_t i = a * this->count; i < i_end; ++i) {
      count += 1;
      if (!parts.overlap(i, whole, b)) continue;
      for (std::size_t k = b * this->count; k < k_end; ++k) {
        count += 1;
        if (parts.overlap(i, parts, k)) return true;
      }
    }
    return false;
  }

  void place(std::uint32_t body) {
    if (placed[body] == step) return;
    placed[body] = step;
    const Pose& pose = poses[body];
    const Mat3 r = geometry::rotation(pose.q);
    std::size_t i = body * count;
    for (const Ball& ball : coverings[bodies.mesh[body]].balls)
      parts.set(i++, geometry::to_world(r, pose.t, ball.centre), ball.radius + slack[body]);
  }

  const Bodies& bodies;
  std::size_t count;                  // room for so many balls a body
  std::vector<Covering> coverings;    // one per distinct mesh
  std::vector<double> reach, slack;   // m; of a mesh, of a body at the step
  Columns whole, parts;               // of the step: one a body, `count` a body
  std::vector<std::uint64_t> placed;  // the step at which a body's parts were placed
  std::uint64_t step = 0;
  std::span<const Pose> poses;
};

}  // namespace

Algorithm spheres() {
  return {.name = "spheres",
          .what = "balls that cover the bodies overlap",
          .operations_unit = "distances",
          .promise = Promise::conservative,
          .knobs = {{.name = "count",
                     .preset = std::int64_t{8},
                     .unit = "1",
                     .what = "at most so many balls cover a body; 1: the tightest ball",
                     .least = 1,
                     .most = kMostBalls}},
          .make = make_pairwise<Spheres>,
          .memory = Spheres::memory};
}

}  // namespace algorithms
