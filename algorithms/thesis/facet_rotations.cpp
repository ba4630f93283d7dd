// facet_rotations: separating axes on a fixed grid of directions, which is what turning and comparing comes to.
//
// Turning by a about z, then by b about x, and looking at x, y and z, looks at the lengths along
//   (cos a, -sin a, 0), (cos b sin a, cos b cos a, -sin b), (sin b sin a, sin b cos a, cos b),  a, b in {step, ...,
//   180}.
// Those are computed once, each line once (307 at 10 degrees). The length of p along d is (dx x + dy y) + dz z in
// doubles; by this arithmetic the answers are defined, and the order in which directions and triangles are tried
// cannot change them: triangles are apart when some direction parts them strictly.
#include "algorithms/thesis/facet_rotations.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <vector>

#include "algorithms/contract/prefilter.hpp"
#include "algorithms/parts/facet_knobs.hpp"
#include "algorithms/parts/facets.hpp"
#include "geometry/portable_math.hpp"

namespace algorithms {
namespace {

using geometry::Points;
using geometry::Vec3;

/// sin(i * 90 degrees / n) for 0 <= i <= 2 n. Exactly 0, 1 and 0 at multiples of 90 degrees, and with equal bits for
/// equal values elsewhere, so that equal lines can be told by their bits.
double sine(std::int64_t i, std::int64_t n) {
  i = std::min(i, 2 * n - i);
  const auto angle = [n](std::int64_t k) {
    return static_cast<double>(k) * std::numbers::pi / (2 * static_cast<double>(n));
  };
  if (i == 0) return 0;
  return 2 * i <= n ? geometry::portable::sin(angle(i)) : geometry::portable::cos(angle(n - i));
}

/// cos(i * 90 degrees / n) for 0 <= i <= 2 n.
double cosine(std::int64_t i, std::int64_t n) { return i <= n ? sine(n - i, n) : -sine(i - n, n); }

/// The number of turns in 180 degrees.
std::int64_t turns(double angle_step) { return static_cast<std::int64_t>(std::llround(180 / angle_step)); }

/// The length of p along d, metres.
double along(const Vec3& d, double x, double y, double z) { return (d.x() * x + d.y() * y) + d.z() * z; }

struct Interval {
  double low, high;
};

struct Near {
  std::uint32_t triangle, first;  // its number and its first point
};

bool apart(const Interval& a, const Interval& b) { return a.high < b.low || b.high < a.low; }

/// Some directions at once, as columns. The width is that of two AVX or four SSE registers.
constexpr std::size_t kBlock = 8;
using Lanes = Eigen::Array<double, kBlock, 1>;
struct Directions {
  Lanes x, y, z;
};

struct FacetRotations {
  FacetRotations(const Bodies& bodies, const Knobs& knobs)
      : direction(rotation_grid(value_of<double>(knobs, "angle_step"))),
        placed(bodies, inflated_points(bodies, knobs)) {
    ball.resize(bodies.size());
    std::size_t most = 0;
    for (std::uint32_t body = 0; body < bodies.size(); ++body) {
      first.push_back(geometry::sampled_triangles(placed[body].size(), triangulation(knobs)));
      most = std::max(most, first.back().size());
    }
    interval_a.resize(most);
    interval_b.resize(most);
    near_a.reserve(most);
    near_b.reserve(most);
    // The last block is filled up with the last direction.
    for (std::size_t i = 0; i < direction.size(); i += kBlock) {
      Directions& block = blocks.emplace_back();
      for (std::size_t k = 0; k < kBlock; ++k) {
        const Vec3& d = direction[std::min(i + k, direction.size() - 1)];
        block.x[k] = d.x();
        block.y[k] = d.y();
        block.z[k] = d.z();
      }
    }
  }

  static Memory memory(const Bodies& bodies, const Knobs& knobs) {
    std::uint64_t scratch = 0;
    Memory out = sampled_memory(bodies, knobs, [&](std::size_t points) {
      return sizeof(geometry::Ball) + sizeof(first) +
             sizeof(std::uint32_t) * geometry::triangle_count(points, triangulation(knobs));
    });
    for (const std::size_t points : sampled_size(bodies, knobs).points)
      scratch = std::max(scratch, 2 * (sizeof(Interval) + sizeof(Near)) *
                                      std::uint64_t{geometry::triangle_count(points, triangulation(knobs))});
    // n (n - 1) + 1 distinct lines of the grid, and its map's nodes while it is made.
    const auto n = static_cast<std::uint64_t>(turns(value_of<double>(knobs, "angle_step")));
    const std::uint64_t lines = n * (n - 1) + 1, scattered = lines * (sizeof(Vec3) + sizeof(Directions) / kBlock);
    out.held += scattered + scratch;
    out.greatest = std::max(out.greatest + scattered + scratch, lines * (72 + 2 * sizeof(Vec3)));
    return out;
  }

  void prepare(std::span<const Pose> poses, double) { placed.prepare(poses); }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    if (first[a].empty() || first[b].empty()) return false;
    place(a);
    place(b);

    // One direction for all triangles: that nearest to the line between the bodies. It clears most of them.
    const Vec3& d = nearest_direction(ball[b].centre - ball[a].centre);
    const Interval whole_b = intervals(d, b, interval_b);
    const Interval whole_a = intervals(d, a, interval_a);
    count += first[a].size() + first[b].size();
    if (apart(whole_a, whole_b)) return false;
    const Interval near_whole = select(interval_a, first[a], whole_b, near_a);
    select(interval_b, first[b], near_whole, near_b);

    // The directions that parted triangles of this pair last, newest first: neighbours are parted by the same.
    std::array<std::size_t, 4> last = {0, 1, 2, 3};
    for (const Near& ta : near_a)
      for (const Near& tb : near_b) {
        count += 1;
        if (apart(interval_a[ta.triangle], interval_b[tb.triangle])) continue;
        if (!some_direction_parts(placed[a], ta.first, placed[b], tb.first, last, count)) return true;
      }
    return false;
  }

  void place(std::uint32_t body) {
    if (placed.place(body)) ball[body] = geometry::ball_around(placed[body]);
  }

  const Vec3& nearest_direction(const Vec3& line) const {
    std::size_t best = 0;
    double best_length = -1;
    for (std::size_t i = 0; i < direction.size(); ++i) {
      const double length = std::fabs(along(direction[i], line.x(), line.y(), line.z()));
      if (length > best_length) best_length = length, best = i;
    }
    return direction[best];
  }

  /// The intervals of the body's triangles along d; returns what they cover together.
  Interval intervals(const Vec3& d, std::uint32_t body, std::vector<Interval>& out) const {
    const Points& p = placed[body];
    Interval whole = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (std::size_t t = 0; t < first[body].size(); ++t) {
      const std::size_t i = first[body][t];
      const double l0 = along(d, p.x[i], p.y[i], p.z[i]), l1 = along(d, p.x[i + 1], p.y[i + 1], p.z[i + 1]),
                   l2 = along(d, p.x[i + 2], p.y[i + 2], p.z[i + 2]);
      out[t] = {std::min(std::min(l0, l1), l2), std::max(std::max(l0, l1), l2)};
      whole.low = std::min(whole.low, out[t].low);
      whole.high = std::max(whole.high, out[t].high);
    }
    return whole;
  }

  /// The triangles whose intervals are not apart from `other`; returns what those cover together.
  static Interval select(const std::vector<Interval>& of, const std::vector<std::uint32_t>& first,
                         const Interval& other, std::vector<Near>& out) {
    Interval whole = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    out.clear();
    for (std::uint32_t t = 0; t < first.size(); ++t) {
      if (apart(of[t], other)) continue;
      out.push_back({t, first[t]});
      whole.low = std::min(whole.low, of[t].low);
      whole.high = std::max(whole.high, of[t].high);
    }
    return whole;
  }

  /// The definition for two triangles, `last` first.
  template <class Count>
  bool some_direction_parts(const Points& a, std::size_t i, const Points& b, std::size_t k,
                            std::array<std::size_t, 4>& last, Count& count) const {
    const auto block_parts = [&](std::size_t block) {
      count += kBlock;
      return parts(blocks[block], a, i, b, k);
    };
    for (std::size_t& block : last)
      if (block < blocks.size() && block_parts(block)) {
        std::rotate(last.data(), &block, &block + 1);
        return true;
      }
    for (std::size_t block = 0; block < blocks.size(); ++block)
      if (block_parts(block)) {
        std::rotate(last.begin(), last.end() - 1, last.end());
        last[0] = block;
        return true;
      }
    return false;
  }

  /// Does some direction of the block part the triangles strictly?
  static bool parts(const Directions& d, const Points& a, std::size_t i, const Points& b, std::size_t k) {
    const auto length = [&d](const Points& p, std::size_t j) -> Lanes {
      return (d.x * p.x[j] + d.y * p.y[j]) + d.z * p.z[j];
    };
    const Lanes a0 = length(a, i), a1 = length(a, i + 1), a2 = length(a, i + 2);
    const Lanes b0 = length(b, k), b1 = length(b, k + 1), b2 = length(b, k + 2);
    const Lanes low_a = a0.min(a1).min(a2), high_a = a0.max(a1).max(a2);
    const Lanes low_b = b0.min(b1).min(b2), high_b = b0.max(b1).max(b2);
    // The sign of a rounded difference is that of the exact one.
    return (low_b - high_a).max(low_a - high_b).maxCoeff() > 0;
  }

  std::vector<Vec3> direction;
  std::vector<Directions> blocks;
  geometry::PlacedPoints placed;
  std::vector<std::vector<std::uint32_t>> first;  // per body, the first point of each triangle
  std::vector<geometry::Ball> ball;               // per body, around its placed points
  std::vector<Interval> interval_a, interval_b;   // scratch
  std::vector<Near> near_a, near_b;               // scratch
};

}  // namespace

std::vector<Vec3> rotation_grid(double angle_step) {
  const std::int64_t n = turns(angle_step);
  std::map<std::array<double, 3>, bool> distinct;
  const auto add = [&](double x, double y, double z) {
    const double sign = x != 0 ? x : y != 0 ? y : z;
    std::array<double, 3> line = {x, y, z};
    for (double& c : line) c = (sign < 0 ? -c : c) + 0.0;  // + 0.0 turns -0 into 0
    distinct[line] = true;
  };
  for (std::int64_t i = 1; i <= n; ++i) {
    const double sin_a = sine(2 * i, n), cos_a = cosine(2 * i, n);
    add(cos_a, -sin_a, 0);
    for (std::int64_t k = 1; k <= n; ++k) {
      const double sin_b = sine(2 * k, n), cos_b = cosine(2 * k, n);
      add(cos_b * sin_a, cos_b * cos_a, -sin_b);
      add(sin_b * sin_a, sin_b * cos_a, cos_b);
    }
  }
  std::vector<Vec3> sorted;
  for (const auto& [line, _] : distinct) sorted.emplace_back(line[0], line[1], line[2]);
  // Steps of about 0.618 of a whole visit a range evenly; a step prime to the size visits all of it.
  const std::size_t size = sorted.size();
  std::size_t step = std::max<std::size_t>(1, static_cast<std::size_t>(0.618 * static_cast<double>(size)));
  while (std::gcd(step, size) != 1) ++step;
  std::vector<Vec3> scattered;
  for (std::size_t i = 0; i < size; ++i) scattered.push_back(sorted[i * step % size]);
  return scattered;
}

Algorithm facet_rotations() {
  return {.name = "facet_rotations",
          .thesis_key = "U",
          .what = "triangles between inflated facet points are not parted on any direction of a grid of rotations",
          .operations_unit = with_prefilter("intervals"),
          .promise = Promise::none,
          .knobs = {stride_knob(),
                    inflate_knob(),
                    triangles_knob(),
                    prefilter_knob(),
                    densify_knob(),
                    {.name = "angle_step",
                     .preset = 10.0,  // degrees; thesis 4.1
                     .unit = "degrees",
                     .what = "the angle of one turn",
                     .least = 1,
                     .most = 180,
                     .valid =
                         [](const Value& value) {
                           const double count = 180 / std::get<double>(value);
                           return std::fabs(count - std::round(count)) < 1e-9;
                         },
                     .rule = "divide 180"}},
          .make = make_filtered<FacetRotations>,
          .memory = filtered_memory<FacetRotations>};
}

}  // namespace algorithms
