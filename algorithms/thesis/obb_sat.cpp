#include "algorithms/thesis/obb_sat.hpp"

#include <cmath>

#include "algorithms/contract/pairwise.hpp"
#include "geometry/processor_clones.hpp"
#include "geometry/vec.hpp"

namespace algorithms {
namespace {

using geometry::dot;
using geometry::Mat3;
using geometry::Vec3;

/// The columns of the first two stages, metres: spheres and the world boxes of the turned corners.
struct Columns {
  std::vector<double> x, y, z, r, low_x, low_y, low_z, high_x, high_y, high_z;
};

/// Stages 1 and 2 of body a against first ... last - 1: 1 where the spheres and the boxes touch.
PROCESSOR_CLONES void spheres_and_boxes_touch(const double* x, const double* y, const double* z, const double* r,
                                              const double* low_x, const double* low_y, const double* low_z,
                                              const double* high_x, const double* high_y, const double* high_z,
                                              std::uint32_t a, std::uint32_t first, std::uint32_t last,
                                              std::uint8_t* hit) {
  const double ax = x[a], ay = y[a], az = z[a], ar = r[a];
  const double alx = low_x[a], aly = low_y[a], alz = low_z[a], ahx = high_x[a], ahy = high_y[a], ahz = high_z[a];
  for (std::uint32_t b = first; b < last; ++b) {
    const double dx = x[b] - ax, dy = y[b] - ay, dz = z[b] - az, reach = ar + r[b];
    hit[b - first] = (reach * reach >= dx * dx + dy * dy + dz * dz) & (alx <= high_x[b]) & (low_x[b] <= ahx) &
                     (aly <= high_y[b]) & (low_y[b] <= ahy) & (alz <= high_z[b]) & (low_z[b] <= ahz);
  }
}

/// The box in the world: middle, half sizes along its axes; row[k][i] is coordinate k of axis i, so that the products
/// of one axis with all three of another box are computed side by side.
struct OrientedBox {
  Vec3 middle, half;
  double row[3][3];
};

/// Stage 3, in a's frame: c(i, j) = a's axis i on b's axis j, d = the middles' distance. An axis and everything
/// projected on it come from the same c, so that a cross product of nearly parallel edges, which is mere rounding, is
/// still a valid axis; one that is exactly zero separates nothing.
template <class Count>
bool axes_overlap(const OrientedBox& a, const OrientedBox& b, Count& count) {
  const Vec3 between = b.middle - a.middle;
  double c[3][3], d[3];
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis(a.row[0][i], a.row[1][i], a.row[2][i]);
    for (int j = 0; j < 3; ++j) c[i][j] = dot(axis, {b.row[0][j], b.row[1][j], b.row[2][j]});
    d[i] = dot(axis, between);
  }
  const Vec3 &ha = a.half, &hb = b.half;
  for (int i = 0; i < 3; ++i) {
    count += 1;
    const double reach = ha[i] + (std::fabs(c[i][0]) * hb[0] + std::fabs(c[i][1]) * hb[1] + std::fabs(c[i][2]) * hb[2]);
    if (std::fabs(d[i]) > reach) return false;
  }
  for (int j = 0; j < 3; ++j) {
    count += 1;
    const double reach = hb[j] + (std::fabs(c[0][j]) * ha[0] + std::fabs(c[1][j]) * ha[1] + std::fabs(c[2][j]) * ha[2]);
    if (std::fabs(dot({b.row[0][j], b.row[1][j], b.row[2][j]}, between)) > reach) return false;
  }
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {  // the cross product has no part along i, -c[l][j] along k and c[k][j] along l
      count += 1;
      const int m = (j + 1) % 3, n = (j + 2) % 3;
      const double p = c[k][j], q = c[l][j];
      const double of_a = std::fabs(q) * ha[k] + std::fabs(p) * ha[l];
      const double of_b = std::fabs(p * c[l][m] - q * c[k][m]) * hb[m] + std::fabs(p * c[l][n] - q * c[k][n]) * hb[n];
      if (std::fabs(p * d[l] - q * d[k]) > of_a + of_b) return false;
    }
  }
  return true;
}

struct ObbSat {
  ObbSat(const Bodies& bodies, const Knobs&) {
    for (std::uint32_t body = 0; body < bodies.size(); ++body) {
      const geometry::Box box = geometry::local_box(bodies.mesh_of(body));
      local_middle.push_back(box.centre());
      half.push_back(box.half_size());
    }
    boxes.resize(bodies.size());
    for (auto* column : {&s.x, &s.y, &s.z, &s.r, &s.low_x, &s.low_y, &s.low_z, &s.high_x, &s.high_y, &s.high_z})
      column->resize(bodies.size());
  }

  static Memory memory(const Bodies& bodies, const Knobs&) {
    return memory_by_body(bodies, 2 * sizeof(Vec3) + sizeof(OrientedBox) + 10 * sizeof(double));
  }

  void prepare(std::span<const Pose> poses, double enlarge) {
    for (std::size_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;  // takes part in no pair: must not cost time
      const Pose& pose = poses[body];
      const Mat3 r = geometry::rotation(pose.q);
      OrientedBox& box = boxes[body];
      box.middle = geometry::to_world(r, pose.t, local_middle[body]);
      box.half = half[body];
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) box.row[k][i] = r(k, i);
      if (enlarge > 0) {
        const Vec3 corner = local_middle[body].cwiseAbs() + half[body];
        box.half += Vec3::Constant(enlarge * (corner.norm() + pose.t.norm()));
      }
      geometry::Box world;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 side(corner & 1 ? box.half.x() : -box.half.x(), corner & 2 ? box.half.y() : -box.half.y(),
                        corner & 4 ? box.half.z() : -box.half.z());
        world.add(geometry::to_world(r, pose.t, local_middle[body] + side));
      }
      const Vec3& h = box.half;
      s.x[body] = box.middle.x();
      s.y[body] = box.middle.y();
      s.z[body] = box.middle.z();
      // 2^-50: the rounding of a root and three squares, so that the ball surely holds the box.
      s.r[body] = std::sqrt(h.x() * h.x() + h.y() * h.y() + h.z() * h.z()) * (1 + 0x1p-50);
      s.low_x[body] = world.min.x();
      s.low_y[body] = world.min.y();
      s.low_z[body] = world.min.z();
      s.high_x[body] = world.max.x();
      s.high_y[body] = world.max.y();
      s.high_z[body] = world.max.z();
    }
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    count += 1;
    const double dx = s.x[b] - s.x[a], dy = s.y[b] - s.y[a], dz = s.z[b] - s.z[a], reach = s.r[a] + s.r[b];
    if (reach * reach < dx * dx + dy * dy + dz * dz) return false;
    count += 1;
    if (s.low_x[a] > s.high_x[b] || s.low_x[b] > s.high_x[a]) return false;
    count += 1;
    if (s.low_y[a] > s.high_y[b] || s.low_y[b] > s.high_y[a]) return false;
    count += 1;
    if (s.low_z[a] > s.high_z[b] || s.low_z[b] > s.high_z[a]) return false;
    return axes_overlap(boxes[a], boxes[b], count);
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    spheres_and_boxes_touch(s.x.data(), s.y.data(), s.z.data(), s.r.data(), s.low_x.data(), s.low_y.data(),
                            s.low_z.data(), s.high_x.data(), s.high_y.data(), s.high_z.data(), a, first, last, out);
    NoCount none;
    for (std::uint32_t b = first; b < last; ++b)
      if (out[b - first]) out[b - first] = axes_overlap(boxes[a], boxes[b], none);
  }

  std::vector<Vec3> local_middle, half;  // of the local vertex boxes, metres
  std::vector<OrientedBox> boxes;        // of the step
  Columns s;                             // of the step
};

}  // namespace

Algorithm obb_sat() {
  return {.name = "obb_sat",
          .thesis_key = "G",
          .what = "oriented boxes of the vertices touch: spheres, world boxes, then 15 separating axes",
          .operations_unit = "axis projections",
          .promise = Promise::conservative,
          .make = make_pairwise<ObbSat>,
          .memory = ObbSat::memory};
}

}  // namespace algorithms
