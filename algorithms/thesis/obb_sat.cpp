#include "algorithms/thesis/obb_sat.hpp"

#include <cmath>

#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/balls_and_boxes.hpp"
#include "geometry/vec.hpp"

namespace algorithms {
namespace {

using geometry::dot;
using geometry::Mat3;
using geometry::Vec3;

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
    rejecting.resize(bodies.size());
  }

  static Memory memory(const Bodies& bodies, const Knobs&) {
    return memory_by_body(bodies, 2 * sizeof(Vec3) + sizeof(OrientedBox) + geometry::BallsAndBoxes::kBytes);
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
      // 2^-50: the rounding of a root and three squares, so that the ball surely holds the box.
      const double radius = std::sqrt(h.x() * h.x() + h.y() * h.y() + h.z() * h.z()) * (1 + 0x1p-50);
      rejecting.set(body, box.middle, radius, world);
    }
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    return rejecting.touch(a, b, count) && axes_overlap(boxes[a], boxes[b], count);
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    rejecting.touch_row(a, first, last, out);
    NoCount none;
    for (std::uint32_t b = first; b < last; ++b)
      if (out[b - first]) out[b - first] = axes_overlap(boxes[a], boxes[b], none);
  }

  std::vector<Vec3> local_middle, half;  // of the local vertex boxes, metres
  std::vector<OrientedBox> boxes;        // of the step
  geometry::BallsAndBoxes rejecting;     // of the step: stages 1 and 2
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
