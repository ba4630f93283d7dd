// The boxes: each mesh by columns, turned row by row of the rotation, so that the loops vectorise.
#include "algorithms/aabb.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "algorithms/contract/pairwise.hpp"
#include "geometry/processor_clones.hpp"

namespace algorithms {
namespace {

using geometry::Mat3;
using geometry::Vec3;

constexpr std::size_t kLanes = 8;  // vertices side by side: two AVX2 or four SSE2 registers

/// The vertices of a mesh by coordinate, the last one repeated up to a multiple of kLanes.
struct Vertices {
  std::vector<double> x, y, z;
};

Vertices columns(const geometry::Mesh& mesh) {
  assert(!mesh.vertices.empty() && "a mesh has vertices");
  Vertices out;
  const std::size_t size = mesh.vertices.size(), padded = (size + kLanes - 1) / kLanes * kLanes;
  for (auto* column : {&out.x, &out.y, &out.z}) column->reserve(padded);
  for (std::size_t i = 0; i < padded; ++i) {
    const Vec3& v = mesh.vertices[std::min(i, size - 1)];
    out.x.push_back(v.x());
    out.y.push_back(v.y());
    out.z.push_back(v.z());
  }
  return out;
}

/// Least and greatest (r0 x + r1 y) + r2 z of the vertices. `size` is a multiple of kLanes.
PROCESSOR_CLONES void range_along(const double* x, const double* y, const double* z, std::size_t size, double r0,
                                  double r1, double r2, double* least, double* greatest) {
  double low[kLanes], high[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) low[l] = high[l] = (r0 * x[l] + r1 * y[l]) + r2 * z[l];
  for (std::size_t i = kLanes; i < size; i += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) {
      const double p = (r0 * x[i + l] + r1 * y[i + l]) + r2 * z[i + l];
      low[l] = p < low[l] ? p : low[l];
      high[l] = p > high[l] ? p : high[l];
    }
  *least = *std::min_element(low, low + kLanes);
  *greatest = *std::max_element(high, high + kLanes);
}

struct Aabb {
  Aabb(const Bodies& all, const Knobs&) : mesh(all.mesh) {
    for (const geometry::Mesh& shape : all.meshes) vertices.push_back(columns(shape));
    for (auto* side : {&low, &high})
      for (std::vector<double>& column : *side) column.resize(all.size());
  }

  static Memory memory(const Bodies& all, const Knobs&) {
    Memory out = memory_by_body(all, sizeof(std::uint32_t) + 6 * sizeof(double));
    for (const geometry::Mesh& shape : all.meshes) out.held += sizeof(Vec3) * shape.vertices.size();
    out.greatest = out.held;
    return out;
  }

  void prepare(std::span<const Pose> poses, double enlarge) {
    for (std::size_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;  // takes part in no pair: must not cost time
      const Pose& pose = poses[body];
      const Mat3 r = geometry::rotation(pose.q);
      const Vertices& v = vertices[mesh[body]];
      for (int i = 0; i < 3; ++i) {
        double least, greatest;
        range_along(v.x.data(), v.y.data(), v.z.data(), v.x.size(), r(i, 0), r(i, 1), r(i, 2), &least, &greatest);
        // Rounding keeps order: the extremes of the sums with t are the sums of the extremes, bit for bit.
        low[i][body] = least + pose.t[i];
        high[i][body] = greatest + pose.t[i];
        if (enlarge > 0) {
          const double grow = enlarge * (std::fmax(std::fabs(least), std::fabs(greatest)) + pose.t.norm());
          low[i][body] -= grow;
          high[i][body] += grow;
        }
      }
    }
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    for (int i = 0; i < 3; ++i) {
      count += 1;
      if (!(low[i][a] <= high[i][b] && low[i][b] <= high[i][a])) return false;
    }
    return true;
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    touch_row(low[0].data(), low[1].data(), low[2].data(), high[0].data(), high[1].data(), high[2].data(), a, first,
              last, out);
  }

  /// Marks the boxes first ... last - 1 that touch box a.
  PROCESSOR_CLONES static void touch_row(const double* low_x, const double* low_y, const double* low_z,
                                         const double* high_x, const double* high_y, const double* high_z,
                                         std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* hit) {
    const double lx = low_x[a], ly = low_y[a], lz = low_z[a], hx = high_x[a], hy = high_y[a], hz = high_z[a];
    for (std::uint32_t b = first; b < last; ++b)
      hit[b - first] = (lx <= high_x[b]) & (low_x[b] <= hx) & (ly <= high_y[b]) & (low_y[b] <= hy) & (lz <= high_z[b]) &
                       (low_z[b] <= hz);
  }

  std::vector<std::uint32_t> mesh;               // per body
  std::vector<Vertices> vertices;                // per distinct mesh
  std::array<std::vector<double>, 3> low, high;  // of the step, per axis and body, metres
};

}  // namespace

Algorithm aabb() {
  return {.name = "aabb",
          .thesis_key = "",
          .what = "axis-aligned world boxes of the vertices touch",
          .operations_unit = "axis intervals",
          .promise = Promise::conservative,
          .make = make_pairwise<Aabb>,
          .memory = Aabb::memory};
}

}  // namespace algorithms
