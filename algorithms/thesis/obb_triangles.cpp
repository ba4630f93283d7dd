#include "algorithms/thesis/obb_triangles.hpp"

#include <array>
#include <bit>
#include <cmath>

#include "algorithms/contract/prefilter.hpp"
#include "algorithms/parts/eleven_axes.hpp"
#include "algorithms/parts/turned_box.hpp"
#include "geometry/processor_clones.hpp"

namespace algorithms {
namespace {

using geometry::EdgedTriangle;
using geometry::kBoxTriangles;
using geometry::Vec3;

constexpr std::uint32_t kAllTriangles = 0xfff;

/// By a set of corners (bits): the triangles (bits) that have all three corners in it.
constexpr std::array<std::uint16_t, 256> triangles_within() {
  std::array<std::uint16_t, 256> within{};
  for (int set = 0; set < 256; ++set)
    for (int k = 0; k < 12; ++k) {
      bool all = true;
      for (const int corner : kBoxTriangles[k]) all = all && (set >> corner & 1);
      if (all) within[set] |= 1 << k;
    }
  return within;
}
constexpr std::array<std::uint16_t, 256> kTrianglesWithin = triangles_within();

/// A body's turned box at a step, metres.
struct BoxSurface {
  alignas(64) double x[8], y[8], z[8];  // world corners
  // Per face: the plane of its first triangle (point, unnormalised normal), and how far the normal projection of a
  // corner on it may be from that on either triangle: `slack` plus `slack_by_distance` per metre from the plane's
  // point.
  double px[6], py[6], pz[6], nx[6], ny[6], nz[6], slack[6], slack_by_distance[6];
  double reach;  // no corner is farther from the position
  std::array<EdgedTriangle, 12> triangles;
};

/// For each face of a, the triangles of b (bits) that lie beyond its plane, so surely that the published test, whose
/// first axes are the normals, must say no to them with both triangles of the face. `between`: the positions' distance.
PROCESSOR_CLONES void surely_apart(const BoxSurface& a, const BoxSurface& b, double between, std::uint32_t* apart) {
  const double distance = between + a.reach + b.reach;
  for (int face = 0; face < 6; ++face) {
    const double px = a.px[face], py = a.py[face], pz = a.pz[face];
    const double nx = a.nx[face], ny = a.ny[face], nz = a.nz[face];
    const double margin = a.slack[face] + a.slack_by_distance[face] * distance;
    std::uint64_t above[8], below[8];
    for (int k = 0; k < 8; ++k) {
      const double s = nx * (b.x[k] - px) + ny * (b.y[k] - py) + nz * (b.z[k] - pz);
      above[k] = s > margin ? std::uint64_t{1} << k : 0;
      below[k] = s < -margin ? std::uint64_t{1} << k : 0;
    }
    std::uint64_t all_above = 0, all_below = 0;
    for (int k = 0; k < 8; ++k) {
      all_above |= above[k];
      all_below |= below[k];
    }
    apart[face] = kTrianglesWithin[all_above] | kTrianglesWithin[all_below];
  }
}

struct ObbTriangles {
  ObbTriangles(const Bodies& bodies, const Knobs&) {
    for (std::uint32_t body = 0; body < bodies.size(); ++body)
      half.push_back(geometry::half_extents(bodies.mesh_of(body)));
    surfaces.resize(bodies.size());
    placed.resize(bodies.size());
  }

  static Memory memory(const Bodies& bodies, const Knobs&) {
    return memory_by_body(bodies, sizeof(Vec3) + sizeof(Pose) + 1 + sizeof(BoxSurface));
  }

  void prepare(std::span<const Pose> of_step, double) {
    poses.assign(of_step.begin(), of_step.end());
    std::fill(placed.begin(), placed.end(), std::uint8_t{0});
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    place(a);
    place(b);
    const BoxSurface &of_a = surfaces[a], &of_b = surfaces[b];
    // The published test, but for the pairs of triangles that a face's plane surely separates.
    const double between = (poses[a].t - poses[b].t).cwiseAbs().sum();
    std::uint32_t apart_from_a[6], apart_from_b[6];
    surely_apart(of_a, of_b, between, apart_from_a);
    surely_apart(of_b, of_a, between, apart_from_b);
    count += 12;  // the planes
    for (int i = 0; i < 12; ++i) {
      std::uint32_t left = kAllTriangles & ~apart_from_a[i / 2];
      for (int face = 0; face < 6; ++face)
        if (apart_from_b[face] >> i & 1) left &= ~(3u << 2 * face);
      for (; left; left &= left - 1) {
        count += 1;
        if (geometry::meet_by_eleven_axes(of_a.triangles[i], of_b.triangles[std::countr_zero(left)])) return true;
      }
    }
    return false;
  }

  /// Turns the body's box, once per step, when its first pair comes.
  void place(std::uint32_t body) {
    if (placed[body]) return;
    placed[body] = 1;
    const Pose& pose = poses[body];
    BoxSurface& s = surfaces[body];
    std::array<Vec3, 8> corners =
        geometry::turned_corners(half[body], geometry::turn_xyz(geometry::euler_angles(pose.q)));
    s.reach = 0;
    for (int k = 0; k < 8; ++k) {
      corners[k] += pose.t;
      s.x[k] = corners[k].x();
      s.y[k] = corners[k].y();
      s.z[k] = corners[k].z();
      s.reach = std::fmax(s.reach, (corners[k] - pose.t).cwiseAbs().sum());
    }
    for (int k = 0; k < 12; ++k)
      s.triangles[k] =
          geometry::edged(corners[kBoxTriangles[k][0]], corners[kBoxTriangles[k][1]], corners[kBoxTriangles[k][2]]);
    for (int face = 0; face < 6; ++face) {
      const EdgedTriangle &one = s.triangles[2 * face], &two = s.triangles[2 * face + 1];
      const Vec3& n = one.normal;
      s.px[face] = one.corner.x();
      s.py[face] = one.corner.y();
      s.pz[face] = one.corner.z();
      s.nx[face] = n.x();
      s.ny[face] = n.y();
      s.nz[face] = n.z();
      // 2^-45 is 256 roundings of a product with n; the rest is how much the face's two planes differ.
      const double size = n.cwiseAbs().sum(), differ = (two.normal - n).cwiseAbs().sum();
      s.slack[face] = 2 * std::fabs(n.dot(two.corner - one.corner));
      s.slack_by_distance[face] = 0x1p-45 * size + 4 * differ;
    }
  }

  std::vector<Vec3> half;            // metres
  std::vector<Pose> poses;           // of the step
  std::vector<std::uint8_t> placed;  // 1: `surfaces` holds the body's box of this step
  std::vector<BoxSurface> surfaces;
};

}  // namespace

Algorithm obb_triangles() {
  return {.name = "obb_triangles",
          .thesis_key = "O",
          .what = "behind the prefilter, outer triangles of the turned boxes pass the 11-axis test",
          .operations_unit = with_prefilter("planes and triangle pairs"),
          .promise = Promise::none,
          .knobs = {prefilter_knob()},
          .make = make_filtered<ObbTriangles>,
          .memory = filtered_memory<ObbTriangles>};
}

}  // namespace algorithms
