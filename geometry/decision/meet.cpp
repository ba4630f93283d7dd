// For each pair whose boxes touch, the cheapest question first: do the two facets meet that met a step before, does the
// direction still separate that did, do facets near the former meet; last a dual descent of the hierarchies, the
// deepest overlap first, until two triangles meet. Only certain answers count (geometry/decision/frames.hpp), so the
// order of the questions cannot change them.
#include "geometry/decision/meet.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "geometry/decision/exact.hpp"
#include "geometry/vec.hpp"

namespace geometry {
namespace {

Box box_of(const Triangle& t) { return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])}; }

/// The node `up` levels above the leaf that holds order[k].
std::uint32_t above(const Bvh& bvh, std::uint32_t k, std::size_t up) {
  std::array<std::uint32_t, Bvh::kMostDepth> path;
  std::size_t depth = 0;
  for (std::uint32_t i = path[0] = 0; bvh.nodes[i].count == 0; path[++depth] = i) {
    const std::uint32_t second = bvh.nodes[i].second;
    i = k < bvh.nodes[second].first ? i + 1 : second;
  }
  return path[depth - std::min(depth, up)];
}

/// A guess, for the order of the questions only.
bool hardly_touch(const Body& a, const Body& b) {
  constexpr double kHardly = 0.005;  // of the smaller radius; measured: tests/benchmarks/truth_bench.cpp
  const Vec3 between = b.at.middle - a.at.middle;
  const double reach = a.around.radius + b.around.radius - kHardly * std::min(a.around.radius, b.around.radius);
  return dot(between, between) > reach * reach;
}

}  // namespace

Decision::Decision(const Bodies& bodies, std::span<const Bvh> bvhs, std::span<const Solid> solids)
    : bodies_(bodies), bvhs_(bvhs), solids_(solids), broad_(bodies) {
  assert(bvhs.size() == bodies.meshes.size() && "one hierarchy per distinct mesh");
}

void Decision::prepare(std::span<const Pose> poses) {
  broad_.prepare(poses);
  for (Placed& placed : placed_) placed.forget();  // or a step asked twice would place less the second time
}

void Decision::hits(std::span<const PairRun> runs, std::vector<Pair>& out, std::vector<Contained>* contained) {
  assert((!contained || solids_.size() == bodies_.meshes.size()) && "containment needs a solid per distinct mesh");
  broad_.pairs(runs, near_);
  operations_ = broad_.comparisons() + near_.size();
  learned_.clear();
  auto known = memory_.begin();
  for (const Pair& pair : near_) {
    while (known != memory_.end() && known->pair < pair) ++known;
    Lesson lesson = known != memory_.end() && known->pair == pair ? *known : Lesson{pair};
    const Body a = body(pair.a, broad_.mesh_of(pair.a), broad_.at(pair.a));
    const Body b = body(pair.b, broad_.mesh_of(pair.b), broad_.at(pair.b));
    const Margin close = margin(a, b);
    if (close.useful && spheres_apart(a, b, close)) continue;
    if (decide(a, b, close, lesson))
      out.push_back(pair);
    else if (contained && is_contained(a, pair.a, b, pair.b))
      contained->push_back({pair, pair.a});
    else if (contained && is_contained(b, pair.b, a, pair.a))
      contained->push_back({pair, pair.b});
    learned_.push_back(lesson);
  }
}

std::vector<Pair> Decision::hits(std::span<const Pose> poses, std::span<const PairRun> runs,
                                 std::vector<Contained>* contained) {
  if (contained) contained->clear();
  std::vector<Pair> out;
  prepare(poses);
  hits(runs, out, contained);
  return out;
}

bool Decision::meet(std::span<const Pose> poses, Pair pair) {
  assert(poses.size() == bodies_.size() && "one pose per body");
  const Enclosure &a_around = broad_.mesh_of(pair.a), &b_around = broad_.mesh_of(pair.b);
  const Placement a_at = placement(a_around, poses[pair.a]), b_at = placement(b_around, poses[pair.b]);
  if (!touch(world_box(a_around, a_at), world_box(b_around, b_at))) return false;
  const Body a = body(pair.a, a_around, a_at), b = body(pair.b, b_around, b_at);
  const Margin close = margin(a, b);
  if (close.useful && spheres_apart(a, b, close)) return false;
  Lesson lesson{pair};
  return decide(a, b, close, lesson);
}

bool Decision::decide(const Body& a, const Body& b, const Margin& close, Lesson& lesson) {
  const bool met = lesson.a_facet != kNone;
  if (met && facets_meet(a, b, lesson)) return true;
  if (!close.useful) {
    placed_[0].place(a);
    placed_[1].place(b);
    return placed_meet(a, placed_[0], b, placed_[1], placed_stack_, operations_);
  }
  // A pair that parted is asked for its direction first, and so is one whose bounding spheres hardly touch. Others
  // mostly meet, and directions found after a descent in vain separated too rarely to pay for themselves.
  const bool first = !met && (lesson.direction != std::array<float, 3>{} || hardly_touch(a, b));
  if (first && separated(a, b, close, lesson)) return false;
  const Relative relative(a, b, close);
  constexpr int kUp = 3;  // measured: tests/benchmarks/truth_bench.cpp
  if (met && descend(a, b, relative, {above(a.bvh, lesson.a_facet, kUp), above(b.bvh, lesson.b_facet, kUp)}, lesson))
    return true;
  if (descend(a, b, relative, {0, 0}, lesson)) return true;
  lesson.a_facet = lesson.b_facet = kNone;
  return false;
}

bool Decision::facets_meet(const Body& a, const Body& b, Lesson& lesson) {
  ++operations_;
  return triangles_meet(a.facet(a.bvh.order[lesson.a_facet]), b.facet(b.bvh.order[lesson.b_facet]));
}

/// Asks the best direction known, and learns the next to try: the direction mirrored at the plane between the two
/// supports (K. Chung, W. Wang, "Quick collision detection of polytopes in virtual environments", 1996).
bool Decision::separated(const Body& a, const Body& b, const Margin& close, Lesson& lesson) {
  Vec3 direction(lesson.direction[0], lesson.direction[1], lesson.direction[2]);
  if (direction == Vec3::Zero()) direction = b.at.middle - a.at.middle;
  const double length = std::sqrt(dot(direction, direction));
  if (!(length > 0)) return false;  // one middle
  const auto keep = [&](const Vec3& d) {
    for (int k = 0; k < 3; ++k) lesson.direction[k] = static_cast<float>(d[k]);
  };
  direction /= length;
  keep(direction);
  const Slab slab = find_slab(a, b, direction, close, operations_);
  if (slab.apart) return true;
  const Vec3 between = slab.to - slab.from;
  const double square = dot(between, between);
  if (square > 0) keep(direction - 2 * dot(between, direction) / square * between);
  return false;
}

/// Descends both hierarchies at once from two nodes, deepest overlap first.
bool Decision::descend(const Body& a, const Body& b, const Relative& relative, NodePair from, Lesson& lesson) {
  std::array<NodePair, 2 * Bvh::kMostDepth> stack;  // every level of either hierarchy leaves one pair at most
  std::size_t open = 0;
  stack[open++] = from;
  while (open > 0) {
    const auto [i, j] = stack[--open];
    const Bvh::Node &m = a.bvh.nodes[i], &n = b.bvh.nodes[j];
    if (m.count && n.count) {
      if (leaves_meet(a, b, {i, j}, lesson)) return true;
      continue;
    }
    const bool open_a = n.count || (!m.count && a.bvh.bounds[i].half[3] >= b.bvh.bounds[j].half[3]);
    const std::array<NodePair, 2> halves = {open_a ? NodePair{i + 1, j} : NodePair{i, j + 1},
                                            open_a ? NodePair{m.second, j} : NodePair{i, n.second}};
    const std::array<float, 2> depth = relative.overlap(halves);
    operations_ += 2;
    const int deeper = depth[1] > depth[0];
    stack[open] = halves[1 - deeper];
    open += !(depth[1 - deeper] < 0);
    stack[open] = halves[deeper];
    open += !(depth[deeper] < 0);  // NaN, which there is none of, would reject nothing
  }
  return false;
}

bool Decision::leaves_meet(const Body& a, const Body& b, NodePair leaves, Lesson& lesson) {
  const Bvh::Node &m = a.bvh.nodes[leaves.a], &n = b.bvh.nodes[leaves.b];
  struct Facet {
    Triangle triangle;
    Box box;
  };
  std::array<Facet, Bvh::kLeafSize> of_b;
  for (std::uint32_t l = 0; l < n.count; ++l) {
    of_b[l].triangle = b.facet(b.bvh.order[n.first + l]);
    of_b[l].box = box_of(of_b[l].triangle);
  }
  for (std::uint32_t k = m.first; k < m.first + m.count; ++k) {
    const Triangle s = a.facet(a.bvh.order[k]);
    const Box s_box = box_of(s);
    for (std::uint32_t l = 0; l < n.count; ++l) {
      ++operations_;
      if (!touch(s_box, of_b[l].box) || !triangles_meet(s, of_b[l].triangle)) continue;
      lesson.a_facet = k;
      lesson.b_facet = n.first + l;
      return true;
    }
  }
  return false;
}

/// Whether a, whose surface shares no point with b's, lies inside b.
bool Decision::is_contained(const Body& a, std::uint32_t a_index, const Body& b, std::uint32_t b_index) {
  const Solid &solid = solids_[bodies_.mesh[a_index]], &around = solids_[bodies_.mesh[b_index]];
  if (!around.closed) return false;
  // Some world vertex outside b's box ends the question at once.
  Box first;
  first.add(to_world(a.at.r, a.at.t, a.mesh.vertices[solid.components[0]]));
  if (!touch(first, broad_.box(b_index))) return false;
  placed_[0].place(a);
  if (!around.surface) {
    placed_[1].place(b);
    return placed_inside(solid, placed_[0], b, placed_[1]);
  }
  const Body closed{around.surface->mesh, around.surface->bvh, b.around, b.at};
  placed_[2].place(closed);
  return placed_nested(placed_[0], placed_[2]) &&
         !placed_meet(a, placed_[0], closed, placed_[2], placed_stack_, operations_) &&
         placed_inside(solid, placed_[0], closed, placed_[2]);
}

BvhsBytes bvhs_bytes(const Bodies& bodies) {
  BvhsBytes out;
  for (const Mesh& mesh : bodies.meshes) {
    const std::uint64_t one = bvh_bytes(mesh.triangles.size());
    out.greatest = std::max(out.greatest, out.held + static_cast<std::uint64_t>(kBuildingBvh * double(one)));
    out.held += one;
  }
  return out;
}

std::vector<Bvh> build_bvhs(const Bodies& bodies) {
  std::vector<Bvh> out;
  for (const Mesh& mesh : bodies.meshes) out.push_back(build_bvh(mesh));
  return out;
}

}  // namespace geometry
