#include "algorithms/beyond/spheres.hpp"

#include <algorithm>

#include "algorithms/beyond/cells.hpp"
#include "algorithms/beyond/covering_balls.hpp"
#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/touching_balls.hpp"

namespace algorithms {
namespace {

constexpr std::int64_t kMostBalls = 1024;

std::size_t count_of(const Knobs& knobs) { return static_cast<std::size_t>(value_of<std::int64_t>(knobs, "count")); }

std::vector<Covering> coverings_of(const Bodies& bodies, const Knobs& knobs) {
  std::vector<Covering> out;
  for (const geometry::Mesh& mesh : bodies.meshes)
    out.push_back(covering_balls(mesh, count_of(knobs), bodies.closed_within));
  return out;
}

std::vector<Ball> wholes(std::span<const Covering> coverings) {
  std::vector<Ball> out;
  for (const Covering& covering : coverings) out.push_back(covering.whole);
  return out;
}

struct Spheres {
  Spheres(const Bodies& bodies, const Knobs& knobs)
      : bodies(bodies),
        coverings(coverings_of(bodies, knobs)),
        whole(bodies, wholes(coverings)),
        room(count_of(knobs)),
        parts(room * bodies.size()),
        placed(bodies.size()) {}

  static Memory memory(const Bodies& bodies, const Knobs& knobs) {
    const std::uint64_t balls = count_of(knobs);
    const std::uint64_t held = bodies.size() * (balls * sizeof(Ball) + touching_balls_bytes() + sizeof(std::uint64_t));
    std::uint64_t making = 0;
    for (const geometry::Mesh& mesh : bodies.meshes)
      if (balls > 1) making = std::max(making, cutting_bytes(mesh));
    return {held, std::max(held, making)};
  }

  void prepare(std::span<const Pose> at, double enlarge) {
    whole.prepare(at, enlarge);
    poses = at;
    ++step;
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    count += 1;
    return whole.touch(a, b) && parts_touch(a, b, count);
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) {
    whole.row(a, first, last, out);
    NoCount none;
    for (std::uint32_t b = first; b < last; ++b)
      if (out[b - first]) out[b - first] = parts_touch(a, b, none);
  }

  /// The balls of a body at the step, placed when they are first asked for.
  std::span<const Ball> balls(std::uint32_t body) {
    const std::vector<Ball>& local = coverings[bodies.mesh[body]].balls;
    const std::span<Ball> out = std::span(parts).subspan(body * room, local.size());
    if (placed[body] == step) return out;
    placed[body] = step;
    const Pose& pose = poses[body];
    const geometry::Mat3 r = geometry::rotation(pose.q);
    for (std::size_t i = 0; i < local.size(); ++i)
      out[i] = {geometry::to_world(r, pose.t, local[i].centre), local[i].radius + whole.slack(body)};
    return out;
  }

  /// Of a pair whose tightest balls touch: each ball of a that touches b's tightest against all of b that touch a's. A
  /// point that the bodies share is in all four. One of a that touches one of b need not touch b's tightest, beyond
  /// which b's balls may reach: asked of a alone, the answer would depend on which body comes first.
  template <class Count>
  bool parts_touch(std::uint32_t a, std::uint32_t b, Count& count) {
    const std::span<const Ball> of_a = balls(a), of_b = balls(b);
    if (of_a.size() == 1 && of_b.size() == 1) return true;  // the tightest
    for (const Ball& one : of_a) {
      count += 1;
      if (!whole.touch(one.centre, one.radius, b)) continue;
      for (const Ball& other : of_b) {
        count += 1;
        const geometry::Vec3 d = one.centre - other.centre;
        if (balls_touch(d.x(), d.y(), d.z(), one.radius + other.radius) && whole.touch(other.centre, other.radius, a))
          return true;
      }
    }
    return false;
  }

  const Bodies& bodies;
  std::vector<Covering> coverings;  // one a distinct mesh
  TouchingBalls whole;
  std::size_t room;                   // for that many balls a body
  std::vector<Ball> parts;            // of the step
  std::vector<std::uint64_t> placed;  // the step at which a body's balls were placed
  std::uint64_t step = 0;
  std::span<const Pose> poses;
};

std::vector<Proxy> proxies(const Bodies& bodies, const Knobs& knobs) {
  std::vector<Proxy> out;
  for (Covering& covering : coverings_of(bodies, knobs))
    out.push_back({.kind = Proxy::Kind::balls, .balls = std::move(covering.balls), .solids = {}});
  return out;
}

}  // namespace

Algorithm spheres() {
  return {.name = "spheres",
          .what = "balls that cover the bodies overlap",
          .operations_unit = "distances",
          .promise = Promise::conservative,
          .knobs = {{.name = "count",
                     .preset = std::int64_t{8},
                     .unit = "1",
                     .what = "at most this many balls cover a body; 1: the tightest ball",
                     .least = 1,
                     .most = kMostBalls}},
          .make = make_pairwise<Spheres>,
          .fits_all = true,
          .memory = Spheres::memory,
          .proxies = proxies};
}

}  // namespace algorithms
