// The parity rule with exact predicates, and the edges and components of a mesh by coordinates.
//
// Any mesh whose every edge belongs to an even number of facets is a cycle modulo 2, and a path in general position
// between two points off the surface crosses it equally often modulo 2, whichever path it is. Facets without area may
// be left out: around a degenerate facet each point of its line is covered twice, so the others are a cycle too.
#include "geometry/contain.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "geometry/exact.hpp"

namespace geometry {
namespace {

/// For every vertex the first, in the order of the mesh, that has its coordinates.
std::vector<std::uint32_t> joined_by_coordinates(std::span<const Vec3> vertices) {
  std::vector<std::uint32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto compare = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &p = vertices[a], &q = vertices[b];
    for (int k = 0; k < 3; ++k)
      if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const int sign = compare(a, b);
    return sign != 0 ? sign < 0 : a < b;
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && compare(order[i - 1], order[i]) == 0 ? first[order[i - 1]] : order[i];
  return first;
}

/// Disjoint sets of vertices.
class Sets {
 public:
  explicit Sets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t root(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

enum class Crossing { no, yes, unclear };

/// Whether the segment from p, which is not on the triangle, to q, which is not either, crosses it; unclear when it
/// touches an edge or lies in the plane.
Crossing crossing(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int p_side = orientation(a, b, c, p), q_side = orientation(a, b, c, q);
  if (p_side == 0 && q_side == 0) return is_degenerate({a, b, c}) ? Crossing::no : Crossing::unclear;
  // With one end in the plane the segment meets the plane in that end alone, which is off the triangle.
  if (p_side * q_side >= 0) return Crossing::no;
  const int ab = orientation(p, q, a, b), bc = orientation(p, q, b, c), ca = orientation(p, q, c, a);
  const auto differ = [](int s, int t) { return s * t < 0; };
  if (differ(ab, bc) || differ(bc, ca) || differ(ca, ab)) return Crossing::no;
  return ab == 0 || bc == 0 || ca == 0 ? Crossing::unclear : Crossing::yes;
}

/// The parity of the crossings of the segment with the surface; nothing when one of them is unclear.
std::optional<bool> odd(const Vec3& p, const Vec3& q, const Mesh& mesh, const Bvh& bvh, std::span<const Vec3> world,
                        std::span<const Box> boxes) {
  Box segment;
  segment.add(p);
  segment.add(q);
  bool out = false;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t i = stack.back();
    stack.pop_back();
    if (!touch(boxes[i], segment)) continue;
    const Bvh::Node& node = bvh.nodes[i];
    if (node.count == 0) {
      stack.push_back(node.second);
      stack.push_back(i + 1);
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const auto& [a, b, c] = mesh.triangles[bvh.order[k]];
      const Crossing found = crossing(p, q, world[a], world[b], world[c]);
      if (found == Crossing::unclear) return std::nullopt;
      out ^= found == Crossing::yes;
    }
  }
  return out;
}

}  // namespace

Solid solid_of(const Mesh& mesh) {
  const std::vector<std::uint32_t> joined = joined_by_coordinates(mesh.vertices);
  Sets sets(mesh.vertices.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Facet& facet : mesh.triangles) {
    const std::uint32_t v[] = {joined[facet[0]], joined[facet[1]], joined[facet[2]]};
    sets.join(v[0], v[1]);
    sets.join(v[1], v[2]);
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (int k = 0; k < 3; ++k) edges.push_back(std::minmax({v[k], v[(k + 1) % 3]}));
  }
  std::sort(edges.begin(), edges.end());
  Solid out;
  out.closed = !edges.empty();
  for (std::size_t i = 0; i < edges.size() && out.closed;) {
    const std::size_t begin = i;
    while (i < edges.size() && edges[i] == edges[begin]) ++i;
    out.closed = (i - begin) % 2 == 0;
  }
  for (const Facet& facet : mesh.triangles)
    for (const std::uint32_t v : facet) out.components.push_back(sets.root(joined[v]));
  std::sort(out.components.begin(), out.components.end());
  out.components.erase(std::unique(out.components.begin(), out.components.end()), out.components.end());
  return out;
}

bool is_inside(const Vec3& point, const Mesh& mesh, const Bvh& bvh, std::span<const Vec3> world,
               std::span<const Box> boxes) {
  const Box& box = boxes[0];
  Box at;
  at.add(point);
  if (!touch(box, at)) return false;
  // Segments end above the box and lean ever more: the first nearly stands, so that the hierarchy leaves few facets.
  // Of the ends, which lie on a curve that no line and no plane meets often, all but finitely many are in general
  // position with respect to the mesh; the limit only guards against a mistake.
  const Vec3 size = box.max - box.min;
  const double reach = std::fmax(std::fmax(size.x(), size.y()), size.z());
  constexpr int kMostTries = 100000;
  for (int i = 1; i <= kMostTries; ++i) {
    const double lean = reach * (i * 0x1.1p-12);
    const Vec3 end(point.x() + lean, point.y() + lean * (0.3 + 0.01 * i),
                   box.max.z() + (reach + std::fabs(box.max.z())));
    if (const auto answer = odd(point, end, mesh, bvh, world, boxes)) return *answer;
  }
  throw std::logic_error("no segment in general position was found for the parity rule");
}

}  // namespace geometry
