#include "algorithms/parts/enclosing_ball.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "geometry/vec.hpp"

namespace algorithms {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::Vec3;

constexpr double kNone = std::numeric_limits<double>::infinity();

double square(const Vec3& v) { return dot(v, v); }

/// A ball by the square of its radius.
struct Sphere {
  Vec3 centre = Vec3::Zero();
  double square = 0;
};

/// The least ball on whose surface all of 1 to 4 points are; an infinite one where they hardly span their simplex.
Sphere through(std::span<const Vec3> p) {
  constexpr double kFlat = 1e-24;  // of the product of the squared edges
  Vec3 to = Vec3::Zero();
  if (p.size() == 2) to = 0.5 * (p[1] - p[0]);
  if (p.size() == 3) {
    const Vec3 q = p[1] - p[0], r = p[2] - p[0];
    const double a = square(q), b = dot(q, r), c = square(r), det = square(cross(q, r));
    if (!(det > kFlat * a * c)) return {p[0], kNone};
    to = (0.5 * c * (a - b) / det) * q + (0.5 * a * (c - b) / det) * r;
  }
  if (p.size() == 4) {
    const Vec3 q = p[1] - p[0], r = p[2] - p[0], s = p[3] - p[0];
    const Vec3 rs = cross(r, s), sq = cross(s, q), qr = cross(q, r);
    const double det = dot(q, rs);
    if (!(det * det > kFlat * square(q) * square(r) * square(s))) return {p[0], kNone};
    to = (0.5 / det) * ((square(q) * rs + square(r) * sq) + square(s) * qr);
  }
  return {p[0] + to, square(to)};
}

/// The points that a ball is spanned by, at most four.
struct Support {
  std::array<Vec3, 4> point{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  std::size_t size = 0;
};

/// The smallest ball around the support and one more point, which is on its surface; the support becomes that ball's.
/// The ball is infinite when rounding leaves none.
Sphere pivot(Support& support, const Vec3& more) {
  constexpr double kOn = 1 + 1e-12;  // rounding of those on the surface
  Sphere best{more, kNone};
  Support of_best;
  for (unsigned mask = 0; mask < (1u << support.size); ++mask) {
    Support tried;
    tried.point[tried.size++] = more;
    for (std::size_t i = 0; i < support.size && tried.size < 4; ++i)
      if (mask & (1u << i)) tried.point[tried.size++] = support.point[i];
    const Sphere ball = through(std::span(tried.point).first(tried.size));
    if (!(ball.square < best.square)) continue;
    const bool holds = std::all_of(support.point.begin(), support.point.begin() + support.size,
                                   [&](const Vec3& p) { return square(p - ball.centre) <= ball.square * kOn; });
    if (holds) best = ball, of_best = tried;
  }
  support = of_best;
  return best;
}

}  // namespace

UnitFrame::UnitFrame(std::span<const Vec3> points) {
  const geometry::Box box = geometry::bounds(points);
  if (points.empty()) return;
  middle_ = box.min + (0.5 * box.max - 0.5 * box.min);
  double half = 0;
  for (int k = 0; k < 3; ++k) {
    half = std::fmax(half, 0.5 * box.max[k] - 0.5 * box.min[k]);
    greatest_ = std::fmax(greatest_, std::fmax(std::fabs(box.min[k]), std::fabs(box.max[k])));
  }
  if (half > 0) exponent_ = std::ilogb(half) + 2;  // within 1/2: also with all roundings within 1
}

Vec3 UnitFrame::to_unit(const Vec3& v) const {
  const Vec3 from = v - middle_;
  return {std::ldexp(from.x(), -exponent_), std::ldexp(from.y(), -exponent_), std::ldexp(from.z(), -exponent_)};
}

std::vector<Vec3> UnitFrame::to_unit(std::span<const Vec3> points) const {
  std::vector<Vec3> out;
  out.reserve(points.size());
  for (const Vec3& v : points) out.push_back(to_unit(v));
  return out;
}

Vec3 UnitFrame::from_unit(const Vec3& p) const {
  return middle_ + Vec3(from_unit(p.x()), from_unit(p.y()), from_unit(p.z()));
}

double UnitFrame::from_unit(double length) const { return std::ldexp(length, exponent_); }

Ball UnitFrame::from_unit(const Ball& ball, double more) const {
  return {from_unit(ball.centre), (from_unit(ball.radius + more) + slack()) * (1 + 0x1p-51)};
}

Ball ball_around(std::span<const Vec3> points) {
  const UnitFrame frame(points);
  return frame.from_unit(enclosing_ball(frame.to_unit(points)));
}

double greatest_distance(const Vec3& centre, std::span<const Vec3> points) {
  double most = 0;
  for (const Vec3& p : points) most = std::fmax(most, square(p - centre));
  return std::sqrt(most) * (1 + 0x1p-50);  // differences, squares, sums and the root: below 5 u
}

Ball enclosing_ball(std::span<const Vec3> points) {
  assert(!points.empty() && "a ball around something");
  constexpr int kMostPivots = 500;  // measured: 5 to 20
  Sphere ball{points.front(), 0};
  Support support{{points.front()}, 1};
  for (int i = 0; i < kMostPivots; ++i) {
    double most = 0;
    const Vec3* farthest = nullptr;
    for (const Vec3& p : points)
      if (const double at = square(p - ball.centre); at > most) most = at, farthest = &p;
    if (!(most > ball.square * (1 + 0x1p-46))) break;
    Support grown = support;
    const Sphere next = pivot(grown, *farthest);
    if (!(next.square > ball.square) || next.square == kNone) break;  // rounding: no progress
    ball = next, support = grown;
  }
  return {ball.centre, greatest_distance(ball.centre, points)};
}

}  // namespace algorithms
