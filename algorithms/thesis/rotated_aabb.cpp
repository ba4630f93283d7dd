#include "algorithms/thesis/rotated_aabb.hpp"

#include <cmath>

#include "algorithms/contract/pairwise.hpp"
#include "geometry/portable_math.hpp"
#include "geometry/processor_clones.hpp"

namespace algorithms {
namespace {

/// Formulas 2.3 and 2.4: the corner (u, v) of a plane turned by `angle` radians, without sign.
void turn(double& u, double& v, double angle) {
  const double r = std::sqrt(u * u + v * v);
  if (r == 0) {
    u = v = 0;
    return;
  }
  const double alpha = geometry::portable::asin(std::fmin(u / r, 1.0));  // above 1 only where squares underflow
  u = std::fabs(r * geometry::portable::sin(angle + alpha));
  v = std::fabs(r * geometry::portable::cos(angle + alpha));
}

/// Marks the boxes first ... last - 1 that touch box a. Columns: centres, then extents.
PROCESSOR_CLONES void touch_row(const double* x, const double* y, const double* z, const double* ex, const double* ey,
                                const double* ez, std::uint32_t a, std::uint32_t first, std::uint32_t last,
                                std::uint8_t* hit) {
  const double ax = x[a], ay = y[a], az = z[a], aex = ex[a], aey = ey[a], aez = ez[a];
  for (std::uint32_t b = first; b < last; ++b)
    hit[b - first] = (std::fabs(ax - x[b]) <= aex + ex[b]) & (std::fabs(ay - y[b]) <= aey + ey[b]) &
                     (std::fabs(az - z[b]) <= aez + ez[b]);
}

struct RotatedAabb {
  RotatedAabb(const Bodies& bodies, const Knobs&) {
    for (std::uint32_t body = 0; body < bodies.size(); ++body)
      half.push_back(geometry::half_extents(bodies.mesh_of(body)));
    x = y = z = ex = ey = ez = std::vector<double>(bodies.size());
  }

  static Memory memory(const Bodies& bodies, const Knobs&) {
    return memory_by_body(bodies, sizeof(geometry::Vec3) + 6 * sizeof(double));
  }

  void prepare(std::span<const Pose> poses, double) {
    for (std::size_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;  // takes part in no pair: must not cost time
      const geometry::Vec3 extents = turned_extents(half[body], geometry::euler_angles(poses[body].q));
      x[body] = poses[body].t.x();
      y[body] = poses[body].t.y();
      z[body] = poses[body].t.z();
      ex[body] = extents.x();
      ey[body] = extents.y();
      ez[body] = extents.z();
    }
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    count += 1;
    if (!(std::fabs(x[a] - x[b]) <= ex[a] + ex[b])) return false;
    count += 1;
    if (!(std::fabs(y[a] - y[b]) <= ey[a] + ey[b])) return false;
    count += 1;
    return std::fabs(z[a] - z[b]) <= ez[a] + ez[b];
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    touch_row(x.data(), y.data(), z.data(), ex.data(), ey.data(), ez.data(), a, first, last, out);
  }

  std::vector<geometry::Vec3> half;         // per body, metres
  std::vector<double> x, y, z, ex, ey, ez;  // centre and extents of the step, metres
};

}  // namespace

geometry::Vec3 turned_extents(const geometry::Vec3& half, const geometry::EulerAngles& angles) {
  double x = half.x(), y = half.y(), z = half.z();
  turn(x, y, angles.z);
  turn(z, x, angles.y);
  turn(y, z, angles.x);
  return {x, y, z};
}

Algorithm rotated_aabb() {
  return {.name = "rotated_aabb",
          .thesis_key = "J",
          .what = "axis-aligned boxes touch, their extents taken from one corner turned by the Euler angles",
          .operations_unit = "axis intervals",
          .promise = Promise::none,
          .make = make_pairwise<RotatedAabb>,
          .memory = RotatedAabb::memory};
}

}  // namespace algorithms
