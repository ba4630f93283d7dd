// The tests' own exact answers. They share no code with geometry/: other arithmetic, another method.
//
// Two triangles as convex hulls A and B of three points are disjoint exactly when 0 is not in the polytope B - A, and
// then one of its supporting planes separates. The directions tried hold every such normal, whatever the dimension of B
// - A:
//   3  facets are spanned by two edges: e x f.
//   2  0 outside its plane: e x f; inside the plane: perpendicular to an edge within it, (e x f) x e.
//   1  0 outside its line: (e x w) x e, where w leads from a corner of A to one of B; on the line: e.
//   0  w.
// Trying more directions than needed can do no harm: a direction that separates is a proof by itself.
#pragma once
#include <CGAL/Gmpq.h>
#include <CGAL/Mpzf.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/exact.hpp"

namespace oracle {

template <class Number>
struct Vec {
  Number x, y, z;
  bool zero() const { return x == 0 && y == 0 && z == 0; }
};
template <class N>
Vec<N> operator-(const Vec<N>& a, const Vec<N>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class N>
Vec<N> cross(const Vec<N>& a, const Vec<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class N>
N dot(const Vec<N>& a, const Vec<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class N>
using Corners = std::array<Vec<N>, 3>;

template <class N>
Corners<N> corners(const geometry::Triangle& t) {
  Corners<N> out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = {N(t[i].x()), N(t[i].y()), N(t[i].z())};
  return out;
}

template <class N>
bool separates(const Vec<N>& axis, const Corners<N>& a, const Corners<N>& b) {
  if (axis.zero()) return false;
  const std::array<N, 3> pa{dot(axis, a[0]), dot(axis, a[1]), dot(axis, a[2])};
  const std::array<N, 3> pb{dot(axis, b[0]), dot(axis, b[1]), dot(axis, b[2])};
  const auto [a_min, a_max] = std::minmax_element(pa.begin(), pa.end());
  const auto [b_min, b_max] = std::minmax_element(pb.begin(), pb.end());
  return *a_max < *b_min || *b_max < *a_min;
}

/// True when the closed triangles share a point, exactly; degenerate ones too. Number is an exact ring.
template <class Number = CGAL::Mpzf>
bool triangles_meet(const geometry::Triangle& s, const geometry::Triangle& t) {
  const Corners<Number> a = corners<Number>(s), b = corners<Number>(t);
  std::vector<Vec<Number>> edges{a[1] - a[0], a[2] - a[1], a[0] - a[2], b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  std::vector<Vec<Number>> normals{cross(edges[0], edges[1]), cross(edges[3], edges[4])};
  for (int i = 0; i < 3; ++i)
    for (int j = 3; j < 6; ++j) normals.push_back(cross(edges[i], edges[j]));
  for (const auto& axis : normals)
    if (separates(axis, a, b)) return false;
  for (const auto& n : normals)
    for (const auto& e : edges)
      if (dot(n, e) != 0) return true;  // B - A has a volume: no other normals exist

  std::vector<Vec<Number>> directions = edges;
  directions.push_back(b[0] - a[0]);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (separates(directions[i], a, b)) return false;
    for (std::size_t j = 0; j < i; ++j) {
      const Vec<Number> n = cross(directions[i], directions[j]);
      if (n.zero()) continue;
      if (separates(n, a, b)) return false;
      for (const auto& f : directions)
        if (separates(cross(n, f), a, b)) return false;
    }
  }
  return true;
}

inline bool degenerate(const geometry::Triangle& t) {
  const auto c = corners<CGAL::Mpzf>(t);
  return cross(c[1] - c[0], c[2] - c[0]).zero();
}

/// The world vertex as design.md defines it, written out once more.
inline geometry::Vec3 world_vertex(const geometry::Pose& pose, const geometry::Vec3& v) {
  const auto [w, x, y, z] = pose.q;
  const double r00 = 1 - 2 * (y * y + z * z), r01 = 2 * (x * y - w * z), r02 = 2 * (x * z + w * y);
  const double r10 = 2 * (x * y + w * z), r11 = 1 - 2 * (x * x + z * z), r12 = 2 * (y * z - w * x);
  const double r20 = 2 * (x * z - w * y), r21 = 2 * (y * z + w * x), r22 = 1 - 2 * (x * x + y * y);
  return {((r00 * v[0] + r01 * v[1]) + r02 * v[2]) + pose.t[0], ((r10 * v[0] + r11 * v[1]) + r12 * v[2]) + pose.t[1],
          ((r20 * v[0] + r21 * v[1]) + r22 * v[2]) + pose.t[2]};
}

inline std::vector<geometry::Triangle> world_triangles(const geometry::Mesh& mesh, const geometry::Pose& pose) {
  std::vector<geometry::Triangle> out;
  for (const auto& [i, j, k] : mesh.triangles)
    out.push_back({world_vertex(pose, mesh.vertices[i]), world_vertex(pose, mesh.vertices[j]),
                   world_vertex(pose, mesh.vertices[k])});
  return out;
}

/// True when a coordinate axis separates: the one short cut, in comparisons of doubles.
inline bool apart_along_an_axis(const geometry::Triangle& a, const geometry::Triangle& b) {
  for (int k = 0; k < 3; ++k) {
    const auto [a_min, a_max] = std::minmax({a[0][k], a[1][k], a[2][k]});
    const auto [b_min, b_max] = std::minmax({b[0][k], b[1][k], b[2][k]});
    if (a_max < b_min || b_max < a_min) return true;
  }
  return false;
}

inline bool meet(std::span<const geometry::Triangle> a, std::span<const geometry::Triangle> b) {
  for (const auto& s : a)
    for (const auto& t : b)
      if (!apart_along_an_axis(s, t) && triangles_meet(s, t)) return true;
  return false;
}

/// The pairs that meet, sorted, by asking every triangle about every other.
inline std::vector<geometry::Pair> hits(const geometry::Bodies& bodies, std::span<const geometry::Pose> poses,
                                        std::span<const geometry::PairRun> runs) {
  std::vector<std::vector<geometry::Triangle>> world(bodies.size());
  for (std::uint32_t i = 0; i < bodies.size(); ++i) world[i] = world_triangles(bodies.mesh_of(i), poses[i]);
  std::vector<geometry::Pair> out;
  for (const auto& run : runs)
    for (std::uint32_t b = run.first; b < run.last; ++b)
      if (meet(world[run.a], world[b])) out.push_back({run.a, b});
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace oracle
