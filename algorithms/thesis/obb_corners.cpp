#include "algorithms/thesis/obb_corners.hpp"

#include <cmath>
#include <utility>

#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/turned_box.hpp"
#include "geometry/processor_clones.hpp"

namespace algorithms {
namespace {

using geometry::TurnXyz;
using geometry::Vec3;

/// A body's box at a step, metres: its corners relative to the centre, and the turn back into its own frame.
struct TurnedBox {
  alignas(64) double x[8], y[8], z[8];
  double centre[3], half[3];
  TurnXyz back;
};

/// The published test, eight corners at once: 0 when one of the first box is inside the second, otherwise 1 when one of
/// the second is inside the first, otherwise 2.
PROCESSOR_CLONES int order_with_corner_inside(const TurnedBox& first, const TurnedBox& second) {
  const TurnedBox *a = &first, *b = &second;
  for (int order = 0; order < 2; ++order, std::swap(a, b)) {
    const double dx = a->centre[0] - b->centre[0], dy = a->centre[1] - b->centre[1], dz = a->centre[2] - b->centre[2];
    const double hx = b->half[0], hy = b->half[1], hz = b->half[2];
    const TurnXyz t = b->back;
    std::int64_t inside[8];
    for (int k = 0; k < 8; ++k) {
      const double x = a->x[k] + dx, y = a->y[k] + dy, z = a->z[k] + dz;
      const double y1 = y * t.cos_x - z * t.sin_x, z1 = z * t.cos_x + y * t.sin_x;
      const double x2 = x * t.cos_y + z1 * t.sin_y, z2 = z1 * t.cos_y - x * t.sin_y;
      const double x3 = x2 * t.cos_z - y1 * t.sin_z, y3 = y1 * t.cos_z + x2 * t.sin_z;
      inside[k] = (std::fabs(x3) <= hx) & (std::fabs(y3) <= hy) & (std::fabs(z2) <= hz);
    }
    std::int64_t any = 0;
    for (int k = 0; k < 8; ++k) any |= inside[k];
    if (any) return order;
  }
  return 2;
}

/// Marks the bodies first ... last - 1 that are near enough to a for a corner to reach. Turns keep lengths but for
/// rounding, which 2^-40 covers: what is left out here, the test answers with no.
PROCESSOR_CLONES void within_reach(const double* x, const double* y, const double* z, const double* r, std::uint32_t a,
                                   std::uint32_t first, std::uint32_t last, std::uint8_t* near) {
  const double ax = x[a], ay = y[a], az = z[a], ar = r[a];
  for (std::uint32_t b = first; b < last; ++b) {
    const double dx = ax - x[b], dy = ay - y[b], dz = az - z[b], reach = ar + r[b];
    near[b - first] = dx * dx + dy * dy + dz * dz <= reach * reach * (1 + 0x1p-40);
  }
}

struct ObbCorners {
  ObbCorners(const Bodies& bodies, const Knobs&) {
    for (std::uint32_t body = 0; body < bodies.size(); ++body) {
      const Vec3 h = geometry::half_extents(bodies.mesh_of(body));
      half.push_back(h);
      r.push_back(std::sqrt(h.x() * h.x() + h.y() * h.y() + h.z() * h.z()));
    }
    x = y = z = r;
    boxes.resize(bodies.size());
  }

  static Memory memory(const Bodies& bodies, const Knobs&) {
    return memory_by_body(bodies, sizeof(Vec3) + 4 * sizeof(double) + sizeof(TurnedBox));
  }

  void prepare(std::span<const Pose> poses, double) {
    for (std::size_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;  // takes part in no pair: must not cost time
      const Vec3 &t = poses[body].t, &h = half[body];
      const TurnXyz turn = geometry::turn_xyz(geometry::euler_angles(poses[body].q));
      TurnedBox& box = boxes[body];
      const std::array<Vec3, 8> corners = geometry::turned_corners(h, turn);
      for (int k = 0; k < 8; ++k) {
        box.x[k] = corners[k].x();
        box.y[k] = corners[k].y();
        box.z[k] = corners[k].z();
      }
      for (int i = 0; i < 3; ++i) {
        box.centre[i] = t[i];
        box.half[i] = h[i];
      }
      box.back = geometry::negated(turn);
      x[body] = t.x();
      y[body] = t.y();
      z[body] = t.z();
    }
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    count += 1;
    std::uint8_t near;
    within_reach(x.data(), y.data(), z.data(), r.data(), a, b, b + 1, &near);
    if (!near) return false;
    const int order = order_with_corner_inside(boxes[a], boxes[b]);
    count += order == 0 ? 8 : 16;
    return order < 2;
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    within_reach(x.data(), y.data(), z.data(), r.data(), a, first, last, out);
    for (std::uint32_t b = first; b < last; ++b)
      if (out[b - first]) out[b - first] = order_with_corner_inside(boxes[a], boxes[b]) < 2;
  }

  std::vector<Vec3> half;        // metres
  std::vector<double> r;         // |half|
  std::vector<double> x, y, z;   // centres of the step
  std::vector<TurnedBox> boxes;  // of the step
};

}  // namespace

Algorithm obb_corners() {
  return {.name = "obb_corners",
          .thesis_key = "L",
          .what = "a corner of one turned box is inside the other",
          .operations_unit = "distances, and points in box",
          .promise = Promise::none,
          .make = make_pairwise<ObbCorners>,
          .memory = ObbCorners::memory};
}

}  // namespace algorithms
