// The parity rule with exact predicates, and the edges and components of a mesh by coordinates, equal or a hair apart.
//
// Any mesh whose every edge belongs to an even number of facets is a cycle modulo 2, and a path in general position
// between two points off the surface crosses it equally often modulo 2, whichever path it is. Facets without area may
// be left out: around a degenerate facet each point of its line is covered twice, so the others are a cycle too.
#include "geometry/decision/contain.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "geometry/decision/exact.hpp"

namespace geometry {
namespace {

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

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // first < second

Edge edge_of(const Facet& facet, std::size_t k) { return std::minmax({facet[k], facet[(k + 1) % 3]}); }

bool is_no_facet(const Facet& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; }

/// The edges that belong to an odd number of facets, sorted.
std::vector<Edge> open_edges(std::span<const Facet> facets) {
  std::vector<Edge> edges, out;
  edges.reserve(3 * facets.size());
  for (const Facet& facet : facets)
    if (!is_no_facet(facet))
      for (std::size_t k = 0; k < 3; ++k) edges.push_back(edge_of(facet, k));
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0, begin = 0; i < edges.size(); begin = i) {
    while (i < edges.size() && edges[i] == edges[begin]) ++i;
    if ((i - begin) % 2 == 1) out.push_back(edges[begin]);
  }
  return out;
}

/// The first facet's edge, as read, that became one of the `open` ones. `facets` has the joined corners.
OpenEdge first_open(const Mesh& mesh, std::span<const Facet> facets, std::span<const Edge> open) {
  OpenEdge out;
  std::optional<Edge> found;
  for (std::size_t f = 0; f < facets.size(); ++f)
    for (std::size_t k = 0; k < 3 && !is_no_facet(facets[f]); ++k) {
      const Edge edge = edge_of(facets[f], k);
      if (!found && std::ranges::binary_search(open, edge)) {
        found = edge;
        out.from = mesh.vertices[mesh.triangles[f][k]];
        out.to = mesh.vertices[mesh.triangles[f][(k + 1) % 3]];
      }
      out.facets += found == edge;
    }
  return out;
}

/// Joins those of `border` that are near by the rule of the header: `corner` of each becomes that of its group's least.
/// Gives the greatest extent of a group that was joined. Near ones are found in the cells of a grid, of which each
/// looks at itself and its neighbours.
double join_near(std::span<const Vec3> at, std::span<const std::uint32_t> border, double width, const Vec3& origin,
                 std::span<std::uint32_t> corner) {
  // Twice the width, so that rounding brings no two near points more than one cell apart; and not so small that the
  // number of a cell could overflow: |at - origin| <= side.
  double side = 0;
  for (const std::uint32_t v : border) side = std::fmax(side, (at[v] - origin).maxCoeff());
  const double cell = std::fmax(2 * width, 0x1p-40 * side);
  using Cell = std::array<std::int64_t, 3>;
  std::vector<std::pair<Cell, std::uint32_t>> placed;  // second: index into border
  for (std::uint32_t i = 0; i < border.size(); ++i) {
    const Vec3 p = (at[border[i]] - origin) / cell;
    placed.push_back({{std::int64_t(p.x()), std::int64_t(p.y()), std::int64_t(p.z())}, i});
  }
  std::sort(placed.begin(), placed.end());

  Sets sets(border.size());
  const auto near = [&](const Vec3& p, const Vec3& q) { return ((p - q).cwiseAbs().array() <= width).all(); };
  const auto join_cells = [&](auto begin, auto end, auto other, auto other_end) {
    Box box;  // all in one width: no need to ask each about each
    for (auto i = begin; i != end; ++i) box.add(at[border[i->second]]);
    for (auto j = other; j != other_end; ++j) box.add(at[border[j->second]]);
    const bool all = near(box.min, box.max);
    for (auto i = begin; i != end; ++i)
      for (auto j = begin == other ? i + 1 : other; j != other_end; ++j) {
        if (all || near(at[border[i->second]], at[border[j->second]])) sets.join(i->second, j->second);
        if (all && i != begin) break;
      }
  };
  for (auto begin = placed.begin(), end = begin; begin != placed.end(); begin = end) {
    const Cell here = begin->first;
    while (end != placed.end() && end->first == here) ++end;
    join_cells(begin, end, begin, end);
    for (int k = 14; k < 27; ++k) {  // the half of the neighbours that comes after it
      const Cell there{here[0] + k / 9 - 1, here[1] + k / 3 % 3 - 1, here[2] + k % 3 - 1};
      const auto [other, other_end] =
          std::ranges::equal_range(end, placed.end(), there, {}, [](const auto& p) { return p.first; });
      if (other != other_end) join_cells(begin, end, other, other_end);
    }
  }

  std::vector<Box> box(border.size());
  std::vector<std::uint32_t> least(border.size());  // by root
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return std::lexicographical_compare(at[a].data(), at[a].data() + 3, at[b].data(), at[b].data() + 3);
  };
  for (std::uint32_t i = 0; i < border.size(); ++i) {
    const std::uint32_t root = sets.root(i);
    box[root].add(at[border[i]]);
    if (root == i || before(border[i], least[root])) least[root] = border[i];
  }
  double widest = 0;
  for (std::uint32_t i = 0; i < border.size(); ++i) {
    const std::uint32_t root = sets.root(i);
    if (!near(box[root].min, box[root].max)) continue;
    corner[border[i]] = least[root];
    widest = std::fmax(widest, (box[root].max - box[root].min).maxCoeff());
  }
  return widest;
}

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

Solid solid_of(const Mesh& mesh, double closed_within) {
  const std::vector<Vec3>& at = mesh.vertices;
  const std::vector<std::uint32_t> joined = joined_by_coordinates(at);
  std::vector<Facet> facets = mesh.triangles;
  Box box;
  Sets sets(at.size());
  for (Facet& facet : facets) {
    for (std::uint32_t& v : facet) box.add(at[v]), v = joined[v];
    sets.join(facet[0], facet[1]);
    sets.join(facet[1], facet[2]);
  }
  Solid out;
  for (const Facet& facet : facets)
    for (const std::uint32_t v : facet) out.components.push_back(sets.root(v));
  std::sort(out.components.begin(), out.components.end());
  out.components.erase(std::unique(out.components.begin(), out.components.end()), out.components.end());
  if (facets.empty()) return out;

  out.width = closed_within * (box.max - box.min).maxCoeff();
  std::vector<Edge> open = open_edges(facets);
  double joined_within = 0;
  const bool as_read = open.empty();
  if (!as_read && out.width > 0 && std::isfinite(out.width)) {
    std::vector<std::uint32_t> border;
    for (const auto& [v, w] : open) border.insert(border.end(), {v, w});
    std::sort(border.begin(), border.end());
    border.erase(std::unique(border.begin(), border.end()), border.end());
    std::vector<std::uint32_t> corner(at.size());
    std::iota(corner.begin(), corner.end(), 0u);
    joined_within = join_near(at, border, out.width, box.min, corner);
    for (Facet& facet : facets)
      for (std::uint32_t& v : facet) v = corner[v];
    open = open_edges(facets);
  }
  const bool none = std::ranges::all_of(facets, is_no_facet);
  out.closed = open.empty() && !none;
  if (out.closed) {
    out.closed_within = joined_within;
    if (as_read) return out;
    Mesh surface;
    surface.vertices = at;
    surface.triangles = std::move(facets);
    std::erase_if(surface.triangles, is_no_facet);
    Bvh bvh = build_bvh(surface);
    out.surface = {std::move(surface), std::move(bvh)};
  } else if (!open.empty()) {
    out.open_edge = first_open(mesh, facets, open);
  }
  return out;
}

std::string open_text(const Solid& solid) {
  if (!solid.open_edge) return "it has no facet with three corners";
  const auto text = [](double x, int digits = 17) {  // as many as there are, at most
    char buffer[32];
    const std::to_chars_result end =
        digits < 17 ? std::to_chars(buffer, buffer + sizeof buffer, x, std::chars_format::general, digits)
                    : std::to_chars(buffer, buffer + sizeof buffer, x);
    return std::string(buffer, end.ptr);
  };
  const auto point = [&](const Vec3& p) { return text(p.x()) + ", " + text(p.y()) + ", " + text(p.z()); };
  const OpenEdge& edge = *solid.open_edge;
  return "the edge from (" + point(edge.from) + ") to (" + point(edge.to) + ") belongs to " +
         std::to_string(edge.facets) + (edge.facets == 1 ? " facet" : " facets") +
         (solid.width > 0 ? ", also with corners within " + text(solid.width, 3) + " m taken as one"
                          : ", corners being one where their coordinates are equal");
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
