// Boxes of bodies from pose and mesh alone, and the pairs that touch.
//
// The letters. u = 2^-53; R the nine doubles of rotation(q), taken as they are; t the position; v a vertex; c, h, s the
// enclosure's centre, half and radius, so that |v_k - c_k| <= h_k and |v - c| <= s.
//
// World vertex. Row i of to_world passes each r_k v_k through four roundings (product, two sums, the sum with t) and
// t_i through one. With S = sum |r_k| |v_k|, its error is at most
//   e = ((1 + u)^4 - 1) S + u |t_i| + 3 x 2^-1074 <= 4.01 u (S + |t_i|) + 2^-1072                               (1)
//
// World box. With x = sum |r_k| h_k and P = sum |r_k| (|c_k| + h_k) + |t_i|, which bounds S + |t_i|,
//   r . v + t_i lies within r . c + t_i +- x                                                                    (2)
//
// The errors are: of the vertex 4.01 u P by (1), of the computed middle r . c + t_i another 4.01 u P, of x computed
// 3.01 u x, of middle -+ (x + pad) 2.01 u P and a rounding of pad: less than 14 u P in all. P computed is too small by
// 5 u P at most. All is covered by
//   pad = 2^-49 P + 2^-1060 = 16 u P + 2^-1060                                                                  (3)
//
// By the sphere. |R| <= 1 + kDefect where the quaternion is near unit, by (9). The product s (1 + 2 kDefect) rounds to
// more than (1 + kDefect) s, so it may stand for x; P is as before. The smaller x is taken:
//   |r . (v - c)| <= |R| s <= (1 + kDefect) s                                                                   (4)
//
// Defect. With w, v the parts of q and N = w^2 + |v|^2, [v] being the cross product with v, the exact matrix of the
// formula is M, and by [v]^4 = -|v|^2 [v]^2 its defect is
//   M = 1 + 2 w [v] + 2 [v]^2                                                                                   (5)
//   M^T M = 1 + 4 (1 - N) [v]^2,   so |M^T M - 1| <= 4 |1 - N| |v|^2                                            (6)
//
// The computed N differs from N by at most 4.01 u N, so within 1e-15 < 9.01 u of 1 it leaves |1 - N| <= 13.1 u:
//   |M^T M - 1| <= 52.5 u                                                                                       (7)
//
// Entries of R: 2 (yy + zz) and 2 (xy - wz) pass through two roundings each, the diagonal's last subtraction through
// one more: errors are below 2 (1 + 13.1 u) 2.01 u + u < 5.1 u on the diagonal and, since |xy| + |wz| <= N / 2, below
// 2.1 u beside it (and 2^-1072 for underflow):
//   |R - M| <= sqrt(3 x 5.1^2 + 6 x 2.1^2) u < 10.3 u                                                           (8)
//
// With (7), and hence |R v|^2 <= (1 + kDefect) |v|^2:
//   |R^T R - 1| <= 52.5 u + 2 x 10.3 u (1 + 27 u) + (10.3 u)^2 < 74 u < 2^-46 = 128 u = kDefect                 (9)
#include "geometry/decision/broad_phase.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "geometry/processor_clones.hpp"

namespace geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRelative = 0x1p-49, kUnderflow = 0x1p-1060;  // of pad: (3)

/// Not less than the exact result of an expression of at most eight roundings, none of a difference, that gave x >= 0.
double rounded_up(double x) { return x * (1 + 0x1p-49) + kUnderflow; }

/// |p|, not less than the exact one. Scaled, so that squares neither over- nor underflow.
double length_above(const Vec3& p) {
  const double most = std::fmax(std::fmax(std::fabs(p.x()), std::fabs(p.y())), std::fabs(p.z()));
  if (!(most > 0x1p-500 && most < 0x1p500)) return rounded_up(2 * most);  // sqrt(3) < 2
  return rounded_up(std::sqrt((p.x() * p.x() + p.y() * p.y()) + p.z() * p.z()));
}

/// Whether q is near enough to unit for kDefect. The sum is that of normalised().
bool near_unit(const Quaternion& q) {
  return std::fabs((((q.w * q.w + q.x * q.x) + q.y * q.y) + q.z * q.z) - 1) <= 1e-15;
}

/// touch[k] = -1 when the intervals of both axes meet [y0, y1] and [z0, z1], else 0. Written so that it vectorises.
PROCESSOR_CLONES void touch_columns(const double* y_low, const double* y_high, const double* z_low,
                                    const double* z_high, double y0, double y1, double z0, double z1, std::size_t count,
                                    std::int64_t* touch) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::int64_t y = -static_cast<std::int64_t>(y_low[k] <= y1) & -static_cast<std::int64_t>(y_high[k] >= y0);
    const std::int64_t z = -static_cast<std::int64_t>(z_low[k] <= z1) & -static_cast<std::int64_t>(z_high[k] >= z0);
    touch[k] = y & z;
  }
}

}  // namespace

Enclosure enclosure(const Mesh& mesh) {
  Enclosure out;
  const Box box = local_box(mesh);
  out.centre = 0.5 * box.min + 0.5 * box.max;  // halved first: no overflow
  for (int k = 0; k < 3; ++k)
    out.half[k] = rounded_up(std::fmax(box.max[k] - out.centre[k], out.centre[k] - box.min[k]));
  for (const Vec3& v : mesh.vertices) {
    out.radius = std::fmax(out.radius, length_above(v - out.centre));
    out.reach = std::fmax(out.reach, length_above(v));
  }
  return out;
}

Placement placement(const Enclosure& mesh, const Pose& pose) {
  Placement out;
  out.r = rotation(pose.q);
  out.t = pose.t;
  out.middle = to_world(out.r, out.t, mesh.centre);
  out.length = rounded_up((std::fabs(pose.t.x()) + std::fabs(pose.t.y())) + std::fabs(pose.t.z()));
  out.rigid = near_unit(pose.q);
  out.born = is_born(pose);
  return out;
}

Box world_box(const Enclosure& mesh, const Placement& at) {
  const Mat3& r = at.r;
  const double sphere = at.rigid ? mesh.radius * (1 + 2 * kDefect) : kInfinity;
  Box box;
  for (int i = 0; i < 3; ++i) {
    const double a = std::fabs(r(i, 0)), b = std::fabs(r(i, 1)), c = std::fabs(r(i, 2));
    const double x = (a * mesh.half.x() + b * mesh.half.y()) + c * mesh.half.z();
    const double to_centre =
        (a * std::fabs(mesh.centre.x()) + b * std::fabs(mesh.centre.y())) + c * std::fabs(mesh.centre.z());
    const double pad = kRelative * ((to_centre + x) + std::fabs(at.t[i])) + kUnderflow;
    const double extent = (x < sphere ? x : sphere) + pad;
    box.min[i] = at.middle[i] - extent;
    box.max[i] = at.middle[i] + extent;
    // Overflow may make either end anything.
    if (!(extent < kInfinity && std::fabs(at.middle[i]) < kInfinity)) box.min[i] = -kInfinity, box.max[i] = kInfinity;
  }
  return box;
}

BroadPhase::BroadPhase(const Bodies& bodies) : bodies_(bodies), at_(bodies.size()), box_(bodies.size()) {
  for (const Mesh& mesh : bodies.meshes) enclosures_.push_back(enclosure(mesh));
}

void BroadPhase::prepare(std::span<const Pose> poses) {
  assert(poses.size() == bodies_.size() && "one pose per body");
  std::size_t born = 0;
  Vec3 sum = Vec3::Zero(), squares = Vec3::Zero();
  for (std::uint32_t body = 0; body < poses.size(); ++body) {
    Placement& at = at_[body];
    at = placement(mesh_of(body), poses[body]);
    if (!at.born) continue;
    box_[body] = world_box(mesh_of(body), at);
    ++born;
    sum += at.middle;
    squares += at.middle.cwiseAbs2();
  }
  const double n = static_cast<double>(born);
  const Vec3 spread = squares - sum.cwiseAbs2() / n;
  int axis = 0;
  spread.maxCoeff(&axis);
  if (!(spread[axis] > 1.2 * spread[axis_])) axis = axis_;  // the order of the step before is worth some spread

  bool same = axis == axis_ && born == order_.size();
  for (std::size_t i = 0; same && i < born; ++i) same = at_[order_[i]].born;
  if (!same) {
    order_.clear();
    for (std::uint32_t body = 0; body < poses.size(); ++body)
      if (at_[body].born) order_.push_back(body);
  }
  sort_along(axis);
}

/// Sorts `order_` by where the boxes begin. Insertion, as long as little has changed since the step before.
void BroadPhase::sort_along(int axis) {
  axis_ = axis;
  const std::size_t n = order_.size();
  key_.resize(n);
  for (std::size_t i = 0; i < n; ++i) key_[i] = box_[order_[i]].min[axis];
  std::size_t moves = 0;
  for (std::size_t i = 1; i < n; ++i) {
    const double key = key_[i];
    const std::uint32_t body = order_[i];
    std::size_t k = i;
    for (; k > 0 && key < key_[k - 1]; --k) {
      key_[k] = key_[k - 1];
      order_[k] = order_[k - 1];
    }
    key_[k] = key;
    order_[k] = body;
    moves += i - k;
    if (moves > 16 * n) {
      std::ranges::sort(order_, {}, [&](std::uint32_t b) { return std::pair(box_[b].min[axis], b); });
      return;
    }
  }
}

void BroadPhase::pairs(std::span<const PairRun> runs, std::vector<Pair>& out) {
  found_.clear();
  comparisons_ = 0;
  const std::size_t n = order_.size();
  sets_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) sets_[i] = i;
  halve(0, n, {{-kInfinity, -kInfinity}, {kInfinity, kInfinity}});
  sort_found(out);
  // Both lists are sorted: one walk keeps the pairs that a run holds.
  auto run = runs.begin();
  std::erase_if(out, [&](const Pair& pair) {
    while (run != runs.end() && (run->a < pair.a || (run->a == pair.a && run->last <= pair.b))) ++run;
    return run == runs.end() || run->a != pair.a || pair.b < run->first;
  });
}

/// Finds the pairs of the set sets_[first, last) that answer to `region`: those for which the greater of the two lower
/// ends lies in it, so that of two sets that share a pair only one reports it.
void BroadPhase::halve(std::size_t first, std::size_t last, const Region& region) {
  constexpr std::size_t kFew = 320;            // measured: tests/benchmarks/truth_bench.cpp
  constexpr std::size_t kSamples = 31;         // of a median that only sets the cost
  constexpr double kMost = 0.8, kTwice = 1.3;  // of the set, in one half and in both: otherwise halving does not pay
  const std::size_t n = last - first;
  if (n <= kFew) return sweep(first, last, region);
  std::size_t best = static_cast<std::size_t>(kTwice * static_cast<double>(n));
  int best_side = -1;
  double best_pivot = 0;
  for (int side = 0; side < 2; ++side) {
    const int axis = (axis_ + 1 + side) % 3;
    std::array<double, kSamples> middle;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const Box& box = box_[order_[sets_[first + i * n / kSamples]]];
      const double at = 0.5 * box.min[axis] + 0.5 * box.max[axis];
      middle[i] = std::isnan(at) ? 0 : at;  // the whole space has no middle
    }
    std::ranges::nth_element(middle, middle.begin() + kSamples / 2);
    const double pivot = middle[kSamples / 2];
    std::size_t below = 0, above = 0;
    for (std::size_t i = first; i < last; ++i) {
      const Box& box = box_[order_[sets_[i]]];
      below += box.min[axis] < pivot;
      above += box.max[axis] >= pivot;
    }
    if (below + above > best || static_cast<double>(std::max(below, above)) > kMost * static_cast<double>(n)) continue;
    best = below + above;
    best_side = side;
    best_pivot = pivot;
  }
  if (best_side < 0) return sweep(first, last, region);

  const int axis = (axis_ + 1 + best_side) % 3;
  for (const bool upper : {false, true}) {
    sets_.resize(last);
    for (std::size_t i = first; i < last; ++i) {
      const Box& box = box_[order_[sets_[i]]];
      if (upper ? box.max[axis] >= best_pivot : box.min[axis] < best_pivot) sets_.push_back(sets_[i]);
    }
    Region half = region;
    (upper ? half.low : half.high)[best_side] = best_pivot;
    halve(last, sets_.size(), half);
  }
  sets_.resize(last);
}

void BroadPhase::sweep(std::size_t first, std::size_t last, const Region& region) {
  const std::size_t n = last - first;
  who_.resize(n);
  touch_.resize(n + 4);
  for (int k = 0; k < 3; ++k) low_[k].resize(n), high_[k].resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    who_[i] = order_[sets_[first + i]];
    const Box& box = box_[who_[i]];
    for (int k = 0; k < 3; ++k) low_[k][i] = box.min[(axis_ + k) % 3], high_[k][i] = box.max[(axis_ + k) % 3];
  }
  const double *x_low = low_[0].data(), *y_low = low_[1].data(), *z_low = low_[2].data();
  const double *y_high = high_[1].data(), *z_high = high_[2].data();
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const std::size_t next = i + 1;
    const std::size_t count =
        static_cast<std::size_t>(std::upper_bound(x_low + next, x_low + n, high_[0][i]) - x_low) - next;
    comparisons_ += count;
    touch_columns(y_low + next, y_high + next, z_low + next, z_high + next, y_low[i], y_high[i], z_low[i], z_high[i],
                  count, touch_.data());
    for (std::size_t k = count; k < count + 4; ++k) touch_[k] = 0;
    for (std::size_t four = 0; four < count; four += 4) {
      if (!(touch_[four] | touch_[four + 1] | touch_[four + 2] | touch_[four + 3])) continue;
      for (std::size_t k = four; k < four + 4; ++k) {
        if (!touch_[k]) continue;
        const double y = std::max(y_low[i], y_low[next + k]), z = std::max(z_low[i], z_low[next + k]);
        if (y < region.low[0] || y >= region.high[0] || z < region.low[1] || z >= region.high[1]) continue;
        found_.push_back({std::min(who_[i], who_[next + k]), std::max(who_[i], who_[next + k])});
      }
    }
  }
}

/// Sorts what was found by counting, first by b and then by a: two passes, whatever the order was.
void BroadPhase::sort_found(std::vector<Pair>& out) {
  const auto pass = [&](std::span<const Pair> from, std::vector<Pair>& to, std::uint32_t Pair::*key) {
    begin_.assign(bodies_.size() + 1, 0);
    for (const Pair& pair : from) ++begin_[pair.*key + 1];
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    to.resize(from.size());
    for (const Pair& pair : from) to[begin_[pair.*key]++] = pair;
  };
  pass(found_, by_b_, &Pair::b);
  pass(by_b_, out, &Pair::a);
}

}  // namespace geometry
