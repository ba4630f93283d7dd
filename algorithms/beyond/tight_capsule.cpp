// For a direction the axis goes through the middle of the smallest circle around the points seen along it; the segment
// is as short as the points at both ends allow. Radii above the circle's make the segment shorter: they are tried too.
// Directions: the lines of a cube's grid, then from the best of them ever smaller steps.
#include "algorithms/beyond/tight_capsule.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "geometry/vec.hpp"

namespace algorithms {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::Vec3;

/// Up to a factor the volume of a capsule.
double volume(double radius, double length) { return radius * radius * (length + radius * (4.0 / 3)); }

/// A capsule about the line through `middle` along a unit vector, from `low` to `high` on it.
struct Found {
  Vec3 direction = Vec3(1, 0, 0), middle = Vec3::Zero();
  double radius = 0, low = 0, high = 0;
  double volume = 0;
};

Vec3 unit(const Vec3& v) { return v / std::sqrt(dot(v, v)); }

/// The best along a direction. `seen` is scratch.
Found along(const Vec3& direction, std::span<const Vec3> points, std::vector<Vec3>& seen) {
  seen.clear();
  for (const Vec3& p : points) seen.push_back(p - dot(p, direction) * direction);
  const Ball circle = enclosing_ball(seen);
  Found best;
  best.direction = direction, best.middle = circle.centre, best.volume = -1;
  constexpr std::array kWider = {1.0, 1.02, 1.05, 1.1, 1.2, 1.4};  // of the circle's radius
  for (const double wider : kWider) {
    const double r = wider * circle.radius;
    double low = 2, high = -2;  // the ends must be below and above these; points of a unit frame
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 from = seen[i] - circle.centre;
      const double z = dot(points[i], direction), cap = std::sqrt(std::fmax(r * r - dot(from, from), 0.0));
      low = std::fmin(low, z + cap);
      high = std::fmax(high, z - cap);
    }
    if (low > high) low = high = 0.5 * (low + high);
    if (const double now = volume(r, high - low); best.volume < 0 || now < best.volume)
      best.radius = r, best.low = low, best.high = high, best.volume = now;
  }
  return best;
}

/// Lines through the middle of a cube and the points of a grid on its faces: about one every 25 degrees.
std::vector<Vec3> lines() {
  constexpr int kGrid = 2;
  std::vector<Vec3> out;
  for (int x = -kGrid; x <= kGrid; ++x)
    for (int y = -kGrid; y <= kGrid; ++y)
      for (int z = 0; z <= kGrid; ++z) {
        const bool on_face = std::max({std::abs(x), std::abs(y), z}) == kGrid;
        const bool upper = z > 0 || y > 0 || (y == 0 && x > 0);
        if (on_face && upper) out.push_back(unit(Vec3(x, y, z)));
      }
  return out;
}

/// Of many points those that are farthest along some of many directions; a search needs no others, and what it finds is
/// widened to hold all.
std::vector<Vec3> outermost(std::span<const Vec3> points) {
  constexpr std::size_t kMany = 500;
  constexpr int kGrid = 6;
  if (points.size() <= kMany) return {points.begin(), points.end()};
  std::vector<std::uint8_t> taken(points.size());
  for (int x = -kGrid; x <= kGrid; ++x)
    for (int y = -kGrid; y <= kGrid; ++y)
      for (int z = -kGrid; z <= kGrid; ++z) {
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != kGrid) continue;
        const Vec3 direction(x, y, z);
        std::size_t farthest = 0;
        double most = dot(direction, points[0]);
        for (std::size_t i = 1; i < points.size(); ++i)
          if (const double at = dot(direction, points[i]); at > most) most = at, farthest = i;
        taken[farthest] = 1;
      }
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (taken[i]) out.push_back(points[i]);
  return out;
}

/// No point is farther from the segment, rounding included. Points of a unit frame.
double greatest_distance(const Vec3& from, const Vec3& to, std::span<const Vec3> points) {
  const Vec3 along = to - from;
  const double square = dot(along, along);
  double most = 0;
  for (const Vec3& p : points) {
    // Any point of the segment bounds the distance from above; this is the nearest but for rounding, with t in [0, 1].
    const double t = square > 0 ? std::clamp(dot(p - from, along) / square, 0.0, 1.0) : 0.0;
    const Vec3 away = p - (from + t * along);
    most = std::fmax(most, dot(away, away));
  }
  // The place on the segment is off it by the rounding of one product and one sum.
  return std::sqrt(most) * (1 + 0x1p-50) + 0x1p-50;
}

}  // namespace

Capsule tight_capsule(std::span<const Vec3> points) {
  assert(!points.empty() && "a capsule around something");
  const UnitFrame frame(points);
  const std::vector<Vec3> all = frame.to_unit(points), some = outermost(all);
  std::vector<Vec3> seen;
  seen.reserve(some.size());
  Found best;
  best.volume = -1;
  const auto try_along = [&](const Vec3& direction) {
    Found found = along(direction, some, seen);
    if (best.volume >= 0 && !(found.volume < best.volume)) return false;
    best = std::move(found);
    return true;
  };
  for (const Vec3& line : lines()) try_along(line);
  constexpr double kLeastStep = 1e-7;  // the volume changes by its square
  for (double step = 0.25; step > kLeastStep;) {
    const Vec3 d = best.direction;
    const Vec3 across = unit(cross(d, std::fabs(d.x()) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0))),
               other = cross(d, across);
    bool better = false;
    for (const Vec3& way : {across, Vec3(-across), other, Vec3(-other)})
      better = try_along(unit(d + step * way)) || better;
    if (!better) step *= 0.5;
  }
  const Ball ball = enclosing_ball(all);
  Vec3 from = best.middle + best.low * best.direction, to = best.middle + best.high * best.direction;
  if (!(best.volume < volume(ball.radius, 0))) from = to = ball.centre;
  const double radius = greatest_distance(from, to, all);
  return {frame.from_unit(from), frame.from_unit(to), (frame.from_unit(radius) + frame.slack()) * (1 + 0x1p-52)};
}

}  // namespace algorithms
