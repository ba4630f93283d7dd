// World vertices and their boxes, and a dual descent in exact comparisons: nothing here is inflated, because the boxes
// hold the rounded vertices themselves. The tree's shape alone comes from the mesh's own frame.
#include "geometry/decision/placed.hpp"

#include <algorithm>
#include <cstring>

#include "geometry/decision/exact.hpp"

namespace geometry {
namespace {

/// Equality bit for bit: -0 and 0 may round differently.
template <class Matrix>
bool same_bits(const Matrix& p, const Matrix& q) {
  return std::memcmp(p.data(), q.data(), sizeof(double) * static_cast<std::size_t>(p.size())) == 0;
}

Box box_of(const Triangle& t) { return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])}; }

/// The least extent, over the axes, of what two touching boxes share: a guess at how likely their contents meet.
double overlap(const Box& a, const Box& b) { return (a.max.cwiseMin(b.max) - a.min.cwiseMax(b.min)).minCoeff(); }

/// The sum of the three edges.
double size(const Box& box) { return (box.max - box.min).sum(); }

Triangle facet(const Body& body, const Placed& placed, std::uint32_t k) {  // of the hierarchy's order
  const Facet& f = body.mesh.triangles[body.bvh.order[k]];
  return {placed.world()[f[0]], placed.world()[f[1]], placed.world()[f[2]]};
}

}  // namespace

void Placed::place(const Body& body) {
  if (mesh_ == &body.mesh && same_bits(r_, body.at.r) && same_bits(t_, body.at.t)) return;
  mesh_ = &body.mesh, r_ = body.at.r, t_ = body.at.t;
  world_.clear();
  for (const Vec3& v : body.mesh.vertices) world_.push_back(to_world(r_, t_, v));
  boxes_.resize(body.bvh.nodes.size());
  refit(body.bvh, body.mesh, world_, boxes_);
}

bool placed_meet(const Body& a, const Placed& a_placed, const Body& b, const Placed& b_placed, NodePairs& stack,
                 std::uint64_t& operations) {
  const std::span<const Box> a_boxes = a_placed.boxes(), b_boxes = b_placed.boxes();
  stack.clear();
  const auto visit = [&](std::uint32_t i, std::uint32_t j) {
    ++operations;
    if (touch(a_boxes[i], b_boxes[j])) stack.emplace_back(i, j);
  };
  visit(0, 0);
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    const Bvh::Node &m = a.bvh.nodes[i], &n = b.bvh.nodes[j];
    if (m.count && n.count) {
      for (std::uint32_t k = m.first; k < m.first + m.count; ++k) {
        const Triangle s = facet(a, a_placed, k);
        const Box s_box = box_of(s);
        for (std::uint32_t l = n.first; l < n.first + n.count; ++l) {
          const Triangle t = facet(b, b_placed, l);
          ++operations;
          if (touch(s_box, box_of(t)) && triangles_meet(s, t)) return true;
        }
      }
      continue;
    }
    // The larger is opened; of its children the one that overlaps deeper is looked at first.
    const bool open_a = n.count || (!m.count && size(a_boxes[i]) >= size(b_boxes[j]));
    std::uint32_t near = open_a ? i + 1 : j + 1, far = open_a ? m.second : n.second;
    const std::span<const Box> boxes = open_a ? a_boxes : b_boxes;
    const Box& other = open_a ? b_boxes[j] : a_boxes[i];
    if (overlap(boxes[far], other) > overlap(boxes[near], other)) std::swap(near, far);
    for (const std::uint32_t child : {far, near}) open_a ? visit(child, j) : visit(i, child);
  }
  return false;
}

bool placed_nested(const Placed& a_placed, const Placed& b_placed) {
  const Box &inner = a_placed.boxes()[0], &outer = b_placed.boxes()[0];
  return (inner.min.array() >= outer.min.array()).all() && (inner.max.array() <= outer.max.array()).all();
}

bool placed_inside(const Solid& a_solid, const Placed& a_placed, const Body& b, const Placed& b_placed) {
  return placed_nested(a_placed, b_placed) && std::ranges::all_of(a_solid.components, [&](std::uint32_t vertex) {
           return is_inside(a_placed.world()[vertex], b.mesh, b.bvh, b_placed.world(), b_placed.boxes());
         });
}

}  // namespace geometry
