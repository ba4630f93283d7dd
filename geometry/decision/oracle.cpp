// Separating axes, and rays, in CGAL's exact floating-point numbers.
//
// Two triangles as convex hulls A and B of three points are disjoint exactly when 0 is not in the polytope B - A, and
// then one of its supporting planes separates. The directions tried hold every such normal, whatever the dimension of
// B - A:
//   3  facets are spanned by two edges: e x f.
//   2  0 outside its plane: e x f; inside the plane: perpendicular to an edge within it, (e x f) x e.
//   1  0 outside its line: (e x w) x e, where w leads from a corner of A to one of B; on the line: e.
//   0  w.
// Trying more directions than needed can do no harm: a direction that separates is a proof by itself.
#include "geometry/decision/oracle.hpp"

#include <CGAL/Mpzf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

namespace geometry::brute_force {
namespace {

using Number = CGAL::Mpzf;  // a ring without rounding, whose exponent no double exhausts

struct Vec {
  Number x, y, z;
  bool zero() const { return x == 0 && y == 0 && z == 0; }
};
Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec cross(const Vec& a, const Vec& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Number dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

Vec exact(const Vec3& p) { return {Number(p.x()), Number(p.y()), Number(p.z())}; }

using Corners = std::array<Vec, 3>;
Corners corners(const Triangle& t) { return {exact(t[0]), exact(t[1]), exact(t[2])}; }

bool separates(const Vec& axis, const Corners& a, const Corners& b) {
  if (axis.zero()) return false;
  const std::array<Number, 3> pa{dot(axis, a[0]), dot(axis, a[1]), dot(axis, a[2])};
  const std::array<Number, 3> pb{dot(axis, b[0]), dot(axis, b[1]), dot(axis, b[2])};
  const auto [a_min, a_max] = std::minmax_element(pa.begin(), pa.end());
  const auto [b_min, b_max] = std::minmax_element(pb.begin(), pb.end());
  return *a_max < *b_min || *b_max < *a_min;
}

/// A triangle with its least and greatest coordinates.
struct Boxed {
  Triangle t;
  Extent extent;
};

Extent extent_of(const Triangle& t) {
  Extent out{t[0], t[0]};
  for (int k = 0; k < 3; ++k) {
    out.min[k] = std::min({t[0][k], t[1][k], t[2][k]});
    out.max[k] = std::max({t[0][k], t[1][k], t[2][k]});
  }
  return out;
}

Extent nothing() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {Vec3(kInfinity, kInfinity, kInfinity), Vec3(-kInfinity, -kInfinity, -kInfinity)};
}

Extent extent_of(std::span<const Triangle> all) {
  Extent out = nothing();
  for (const Triangle& t : all)
    for (const Vec3& p : t)
      for (int k = 0; k < 3; ++k) {
        out.min[k] = std::min(out.min[k], p[k]);
        out.max[k] = std::max(out.max[k], p[k]);
      }
  return out;
}

std::vector<Boxed> those_that_touch(std::span<const Triangle> all, const Extent& other) {
  std::vector<Boxed> out;
  for (const Triangle& t : all)
    if (const Extent extent = extent_of(t); touch(extent, other)) out.push_back({t, extent});
  return out;
}

enum class Crossing { no, yes, unclear };

/// Whether the ray from p along d crosses the triangle; unclear when it touches an edge, a corner or the plane.
///
/// With q_i the corners seen from p, the line hits the plane at s d = sum l_i q_i, sum l_i = 1. Cramer: s s_i = l_i D
/// with s_0 = [d q1 q2], s_1 = [d q2 q0], s_2 = [d q0 q1] and D = [q0 q1 q2], hence s (s_0 + s_1 + s_2) = D: it is in
/// the triangle's interior when the s_i have one sign, and ahead when D has that sign too. A facet without area is no
/// crossing: it covers each point of its line twice, so the others are a closed surface without it.
Crossing crossing(const Vec& p, const Vec& d, const Triangle& t) {
  const Vec q0 = exact(t[0]) - p, q1 = exact(t[1]) - p, q2 = exact(t[2]) - p;
  const int signs[] = {CGAL::sign(dot(d, cross(q1, q2))), CGAL::sign(dot(d, cross(q2, q0))),
                       CGAL::sign(dot(d, cross(q0, q1)))};
  const auto [least, most] = std::minmax({signs[0], signs[1], signs[2]});
  if (least < 0 && most > 0) return Crossing::no;
  if (least == 0 && most == 0) return degenerate(t) ? Crossing::no : Crossing::unclear;
  const int ahead = CGAL::sign(dot(q0, cross(q1, q2))) * (least + most);  // one of them is 0, or they are equal
  if (ahead < 0) return Crossing::no;
  if (least == 0 || most == 0) return Crossing::unclear;
  return Crossing::yes;
}

/// By rays from `point`, which is on no facet: first upwards, which the coordinates of most facets exclude at once,
/// then, while a ray touches an edge, along directions of which no plane holds more than two.
bool inside(const Vec3& point, std::span<const Boxed> surface) {
  const Vec p = exact(point);
  constexpr int kMostTries = 10000;
  for (int k = 0; k < kMostTries; ++k) {
    const Vec3 direction = k == 0 ? Vec3(0, 0, 1) : Vec3(1, k, double(k) * k);
    const Vec d = exact(direction);
    bool odd = false, clear = true;
    for (const Boxed& f : surface) {
      if (k == 0 && (f.extent.max.z() < point.z() || f.extent.max.x() < point.x() || f.extent.min.x() > point.x() ||
                     f.extent.max.y() < point.y() || f.extent.min.y() > point.y()))
        continue;
      const Crossing found = crossing(p, d, f.t);
      clear = found != Crossing::unclear;
      if (!clear) break;
      odd ^= found == Crossing::yes;
    }
    if (clear) return odd;
  }
  throw std::logic_error("the oracle found no ray in general position");
}

}  // namespace

bool triangles_meet(const Triangle& s, const Triangle& t) {
  const Corners a = corners(s), b = corners(t);
  const std::array<Vec, 6> edges{a[1] - a[0], a[2] - a[1], a[0] - a[2], b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  std::array<Vec, 11> normals{cross(edges[0], edges[1]), cross(edges[3], edges[4])};
  if (separates(normals[0], a, b) || separates(normals[1], a, b)) return false;
  for (int i = 0; i < 3; ++i)
    for (int j = 3; j < 6; ++j) {
      Vec& normal = normals[std::size_t(2 + 3 * i + j - 3)];
      normal = cross(edges[std::size_t(i)], edges[std::size_t(j)]);
      if (separates(normal, a, b)) return false;
    }
  for (const Vec& n : normals)
    for (const Vec& e : edges)
      if (dot(n, e) != 0) return true;  // three dimensions: no other normals exist
  for (const Vec& n : normals) {
    if (n.zero()) continue;
    for (const Vec& e : edges)
      if (separates(cross(n, e), a, b)) return false;
    return true;  // two
  }
  const Vec w = b[0] - a[0];
  for (const Vec& e : edges)
    if (separates(e, a, b) || separates(cross(cross(e, w), e), a, b)) return false;
  return !separates(w, a, b);
}

bool degenerate(const Triangle& t) {
  const Corners c = corners(t);
  return cross(c[1] - c[0], c[2] - c[0]).zero();
}

bool apart_along_an_axis(const Triangle& a, const Triangle& b) { return !touch(extent_of(a), extent_of(b)); }

Vec3 world_vertex(const Pose& pose, const Vec3& v) {
  const auto [w, x, y, z] = pose.q;
  const double r00 = 1 - 2 * (y * y + z * z), r01 = 2 * (x * y - w * z), r02 = 2 * (x * z + w * y);
  const double r10 = 2 * (x * y + w * z), r11 = 1 - 2 * (x * x + z * z), r12 = 2 * (y * z - w * x);
  const double r20 = 2 * (x * z - w * y), r21 = 2 * (y * z + w * x), r22 = 1 - 2 * (x * x + y * y);
  return {((r00 * v[0] + r01 * v[1]) + r02 * v[2]) + pose.t[0], ((r10 * v[0] + r11 * v[1]) + r12 * v[2]) + pose.t[1],
          ((r20 * v[0] + r21 * v[1]) + r22 * v[2]) + pose.t[2]};
}

std::vector<Triangle> world_triangles(const Mesh& mesh, const Pose& pose) {
  std::vector<Vec3> world;
  for (const Vec3& v : mesh.vertices) world.push_back(world_vertex(pose, v));
  std::vector<Triangle> out;
  for (const auto& [i, j, k] : mesh.triangles) out.push_back({world[i], world[j], world[k]});
  return out;
}

Extent world_extent(const Mesh& mesh, const Pose& pose) {
  Extent out = nothing();
  bool all_numbers = true;
  for (const Vec3& v : mesh.vertices) {
    const Vec3 p = world_vertex(pose, v);
    for (int k = 0; k < 3; ++k) {
      all_numbers = all_numbers && !std::isnan(p[k]);
      out.min[k] = std::min(out.min[k], p[k]);
      out.max[k] = std::max(out.max[k], p[k]);
    }
  }
  if (!all_numbers) out.min[0] = std::numeric_limits<double>::quiet_NaN();
  return out;
}

bool is_finite(const Extent& extent) { return extent.min.allFinite() && extent.max.allFinite(); }

bool touch(const Extent& a, const Extent& b) {
  for (int k = 0; k < 3; ++k)
    if (a.max[k] < b.min[k] || b.max[k] < a.min[k]) return false;
  return true;
}

bool nested(const Extent& inner, const Extent& outer) {
  for (int k = 0; k < 3; ++k)
    if (inner.min[k] < outer.min[k] || inner.max[k] > outer.max[k]) return false;
  return true;
}

bool meet(std::span<const Triangle> a, std::span<const Triangle> b) {
  const std::vector<Boxed> near_a = those_that_touch(a, extent_of(b));
  std::vector<Boxed> near_b = those_that_touch(b, extent_of(a));
  std::ranges::sort(near_b, {}, [](const Boxed& f) { return f.extent.min.x(); });
  for (const Boxed& s : near_a)
    for (const Boxed& t : near_b) {
      if (t.extent.min.x() > s.extent.max.x()) break;  // and so do all that follow
      if (touch(s.extent, t.extent) && triangles_meet(s.t, t.t)) return true;
    }
  return false;
}

std::optional<Mesh> closed_surface(const Mesh& mesh, double closed_within) {
  if (mesh.triangles.empty()) return std::nullopt;
  // Places by their coordinates, in order; the edges that were met an odd number of times.
  using Place = std::array<double, 3>;
  std::map<Place, std::uint32_t> first;
  std::vector<std::uint32_t> at(mesh.vertices.size());
  Extent extent = nothing();
  for (const Facet& facet : mesh.triangles)
    for (const std::uint32_t v : facet) {
      const Vec3& p = mesh.vertices[v];
      at[v] = first.emplace(Place{p[0], p[1], p[2]}, v).first->second;
      for (int k = 0; k < 3; ++k) {
        extent.min[k] = std::min(extent.min[k], p[k]);
        extent.max[k] = std::max(extent.max[k], p[k]);
      }
    }
  using Edges = std::set<std::pair<std::uint32_t, std::uint32_t>>;
  const auto odd_edges = [](const std::vector<Facet>& facets) {
    Edges odd;
    for (const Facet& f : facets)
      for (int k = 0; k < 3; ++k) {
        const auto edge = std::minmax(f[std::size_t(k)], f[std::size_t(k + 1) % 3]);
        if (edge.first != edge.second && !odd.insert(edge).second) odd.erase(edge);
      }
    return odd;
  };
  Mesh out = mesh;
  for (Facet& f : out.triangles)
    for (std::uint32_t& v : f) v = at[v];
  const Edges border = odd_edges(out.triangles);
  if (!border.empty()) {
    const Vec3 size = extent.max - extent.min;
    const double width = closed_within * std::max({size[0], size[1], size[2]});
    if (!std::isfinite(width)) return std::nullopt;
    const auto far = [&](double a, double b) { return std::abs(a - b) > width; };
    std::set<std::uint32_t> corners;
    for (const auto& [v, w] : border) corners.insert({v, w});
    // Along the axis on which they are spread most, so that few lie within the width of each other.
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (size[k] > size[axis]) axis = k;
    std::multimap<double, std::uint32_t> rest;  // those that are in no group yet
    for (const std::uint32_t v : corners) rest.emplace(mesh.vertices[v][axis], v);
    while (!rest.empty()) {
      std::vector<std::uint32_t> group{rest.begin()->second};  // grows while its members have neighbours
      rest.erase(rest.begin());
      for (std::size_t g = 0; g < group.size(); ++g) {
        const Vec3& p = mesh.vertices[group[g]];
        auto from = rest.lower_bound(p[axis]);
        while (from != rest.begin() && !far(std::prev(from)->first, p[axis])) --from;
        while (from != rest.end() && !far(from->first, p[axis])) {
          const Vec3& q = mesh.vertices[from->second];
          const bool near = !far(p[0], q[0]) && !far(p[1], q[1]) && !far(p[2], q[2]);
          if (near) group.push_back(from->second);
          from = near ? rest.erase(from) : std::next(from);
        }
      }
      std::vector<Place> places;
      for (const std::uint32_t v : group)
        places.push_back({mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]});
      bool fits = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::ranges::minmax(places, {}, [&](const Place& p) { return p[k]; });
        fits = fits && !far(low[k], high[k]);
      }
      const std::uint32_t least = first.at(std::ranges::min(places));
      if (fits)
        for (const std::uint32_t v : group) at[v] = least;
    }
    for (Facet& f : out.triangles)
      for (std::uint32_t& v : f) v = at[v];
    if (!odd_edges(out.triangles).empty()) return std::nullopt;
  }
  std::erase_if(out.triangles, [](const Facet& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
  if (out.triangles.empty()) return std::nullopt;
  if (border.empty()) return mesh;
  return out;
}

bool contained(std::span<const Triangle> inner, std::span<const Triangle> outer) {
  if (inner.empty() || outer.empty() || !nested(extent_of(inner), extent_of(outer))) return false;
  const std::vector<Boxed> surface = those_that_touch(outer, extent_of(outer));
  std::vector<Vec3> points;
  for (const Triangle& t : inner) points.insert(points.end(), t.begin(), t.end());
  const auto as_array = [](const Vec3& p) { return std::array{p.x(), p.y(), p.z()}; };
  std::ranges::sort(points, {}, as_array);
  points.erase(std::ranges::unique(points, {}, as_array).begin(), points.end());
  return std::ranges::all_of(points, [&](const Vec3& p) { return inside(p, surface); });
}

std::vector<Pair> hits(const Bodies& bodies, std::span<const Pose> poses, std::span<const PairRun> runs) {
  std::vector<std::vector<Triangle>> world(bodies.size());
  for (std::uint32_t i = 0; i < bodies.size(); ++i) world[i] = world_triangles(bodies.mesh_of(i), poses[i]);
  std::vector<Pair> out;
  for (const auto& run : runs)
    for (std::uint32_t b = run.first; b < run.last; ++b)
      if (meet(world[run.a], world[b])) out.push_back({run.a, b});
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace geometry::brute_force
