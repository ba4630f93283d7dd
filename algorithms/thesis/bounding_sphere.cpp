#include "algorithms/thesis/bounding_sphere.hpp"

#include <cmath>

#include "algorithms/contract/pairwise.hpp"
#include "geometry/processor_clones.hpp"

namespace algorithms {
namespace {

/// Centres and radii of all bodies, metres.
struct Balls {
  std::vector<double> x, y, z, r;
};

/// Marks the balls first ... last - 1 that overlap ball a, by squares. Returns false when a square came so close that
/// only the square root, which defines the answer, may decide: 2^-50 is four times the rounding of both sides.
PROCESSOR_CLONES bool overlap_by_squares(const double* x, const double* y, const double* z, const double* r,
                                         std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* hit) {
  const double ax = x[a], ay = y[a], az = z[a], ar = r[a];
  std::uint8_t doubt = 0;
  for (std::uint32_t b = first; b < last; ++b) {
    const double dx = ax - x[b], dy = ay - y[b], dz = az - z[b], reach = ar + r[b];
    const double square = dx * dx + dy * dy + dz * dz, reach_square = reach * reach;
    hit[b - first] = square < reach_square;
    doubt |= std::fabs(square - reach_square) <= reach_square * 0x1p-50 + 1e-290;
  }
  return !doubt;
}

struct BoundingSphere {
  BoundingSphere(const Bodies& bodies, const Knobs&) {
    for (std::uint32_t body = 0; body < bodies.size(); ++body) {
      const geometry::Vec3 h = geometry::half_extents(bodies.mesh_of(body));
      radius.push_back(std::sqrt(h.x() * h.x() + h.y() * h.y() + h.z() * h.z()));
    }
    balls.x = balls.y = balls.z = balls.r = radius;
  }

  static Memory memory(const Bodies& bodies, const Knobs&) { return memory_by_body(bodies, 5 * sizeof(double)); }

  void prepare(std::span<const Pose> poses, double enlarge) {
    for (std::size_t body = 0; body < poses.size(); ++body) {
      const geometry::Vec3& t = poses[body].t;
      balls.x[body] = t.x();
      balls.y[body] = t.y();
      balls.z[body] = t.z();
      balls.r[body] = radius[body];
      if (enlarge > 0)
        balls.r[body] += enlarge * (radius[body] + std::sqrt(t.x() * t.x() + t.y() * t.y() + t.z() * t.z()));
    }
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    count += 1;
    const double dx = balls.x[a] - balls.x[b], dy = balls.y[a] - balls.y[b], dz = balls.z[a] - balls.z[b];
    return balls.r[a] + balls.r[b] > std::sqrt(dx * dx + dy * dy + dz * dz);
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    if (overlap_by_squares(balls.x.data(), balls.y.data(), balls.z.data(), balls.r.data(), a, first, last, out)) return;
    NoCount none;
    for (std::uint32_t b = first; b < last; ++b) out[b - first] = hit(a, b, none);
  }

  std::vector<double> radius;  // metres, not enlarged
  Balls balls;
};

}  // namespace

Algorithm bounding_sphere() {
  return {.name = "bounding_sphere",
          .thesis_key = "H",
          .what = "balls of the half diagonal about the bodies' positions overlap",
          .operations_unit = "distances",
          .promise = Promise::conservative,
          .make = make_pairwise<BoundingSphere>,
          .memory = BoundingSphere::memory};
}

}  // namespace algorithms
