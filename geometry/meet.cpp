// A sweep along one axis finds the pairs of bodies whose boxes touch; a dual descent of their hierarchies then looks
// for two triangles that meet, the deepest overlap first, and stops at the first it finds.
//
// All boxes are the least and greatest of the very doubles that the truth is defined by. They reject only what is
// apart, and no bound on any rounding is needed.
#include "geometry/meet.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

namespace geometry {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Equality bit for bit: -0 and 0 may round differently.
bool same_bits(const Pose& p, const Pose& q) {
  return std::memcmp(&p.q, &q.q, sizeof p.q) == 0 && std::memcmp(p.t.data(), q.t.data(), 3 * sizeof(double)) == 0;
}

Box box_of(const Triangle& t) { return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])}; }

/// The least extent, over the axes, of what two touching boxes share: a guess at how likely their contents meet.
double overlap(const Box& a, const Box& b) { return (a.max.cwiseMin(b.max) - a.min.cwiseMax(b.min)).minCoeff(); }

/// The sum of the three edges.
double size(const Box& box) { return (box.max - box.min).sum(); }

/// A placed body, as the descents see it.
struct Surface {
  const Mesh& mesh;
  const Bvh& bvh;
  std::span<const Vec3> world;  // #vertices
  std::span<const Box> boxes;   // #nodes

  Triangle facet(std::uint32_t k) const {  // of the hierarchy's order
    const Facet& f = mesh.triangles[bvh.order[k]];
    return {world[f[0]], world[f[1]], world[f[2]]};
  }
};

double dot(const Vec3& d, const Vec3& p) { return (d.x() * p.x() + d.y() * p.y()) + d.z() * p.z(); }

/// The greatest value of dot(d, p) for p in the box. Rounding is monotone and the order of the operations is the same,
/// so this bounds dot() as computed, exactly.
double greatest_dot(const Vec3& d, const Box& box) {
  return dot(d, {d.x() > 0 ? box.max.x() : box.min.x(), d.y() > 0 ? box.max.y() : box.min.y(),
                 d.z() > 0 ? box.max.z() : box.min.z()});
}

struct Support {
  double dot = -std::numeric_limits<double>::infinity();
  Vec3 point = Vec3::Zero();
};

/// The vertex farthest along d, with its dot product: exactly the greatest of those computed.
void find_support(const Surface& s, const Vec3& d, std::uint32_t node, Support& best) {
  while (s.bvh.nodes[node].count == 0) {
    std::uint32_t near = node + 1, far = s.bvh.nodes[node].second;
    double near_dot = greatest_dot(d, s.boxes[near]), far_dot = greatest_dot(d, s.boxes[far]);
    if (far_dot > near_dot) std::swap(near, far), std::swap(near_dot, far_dot);
    if (near_dot <= best.dot) return;
    find_support(s, d, near, best);
    if (far_dot <= best.dot) return;
    node = far;
  }
  const Bvh::Node& leaf = s.bvh.nodes[node];
  for (std::uint32_t k = leaf.first; k < leaf.first + leaf.count; ++k)
    for (const std::uint32_t v : s.mesh.triangles[s.bvh.order[k]])
      if (const double along = dot(d, s.world[v]); along > best.dot) best = {along, s.world[v]};
}

/// What two bodies share along a direction: a reaches up to a_top, b down to b_bottom.
struct Slab {
  Vec3 direction = Vec3::Zero();
  double a_top = std::numeric_limits<double>::infinity(), b_bottom = -std::numeric_limits<double>::infinity();
  double error = 0;  // of a difference of two dot products

  double thickness() const { return a_top - b_bottom; }
  bool apart() const { return a_top + error < b_bottom; }
};

// With u = 2^-53, a dot product of three terms has an error of at most ((1 + u)^3 - 1) S and 3 x 2^-1075 for
// underflow, S = sum |d_k| |p_k|. A difference of two has twice that, and a_top + error rounds once more: 8 u S in all,
// taken twice. Where this overflows nothing is apart.
double dot_error(const Vec3& d, const Box& a, const Box& b) {
  const Vec3 reach = a.min.cwiseAbs().cwiseMax(a.max.cwiseAbs()).cwiseMax(b.min.cwiseAbs()).cwiseMax(b.max.cwiseAbs());
  return 0x1p-49 * dot(d.cwiseAbs(), reach) + 0x1p-1060;
}

/// The slab along a direction, and the direction to try next: d mirrored at the plane between the two supports (K.
/// Chung, W. Wang, "Quick collision detection of polytopes in virtual environments", 1996).
Slab find_slab(const Surface& a, const Surface& b, Vec3& d) {
  const double length = std::sqrt(dot(d, d));
  if (!(length > 0 && length <= std::numeric_limits<double>::max())) return {};  // one centre, or out of range
  d /= length;
  Support from, to;
  find_support(a, d, 0, from);
  find_support(b, -d, 0, to);
  const Slab slab{d, from.dot, -to.dot, dot_error(d, a.boxes[0], b.boxes[0])};
  const Vec3 between = to.point - from.point;
  const double square = dot(between, between);
  if (square > 0) d -= 2 * dot(between, d) / square * between;
  return slab;
}

/// The facets of `s` that touch `within` and reach `least` along the direction, less the error. False when there are
/// too many to compare all with all.
bool find_cap(const Surface& s, const Vec3& direction, double error, double least, const Box& within, NodePairs& stack,
              std::vector<PlacedFacet>& cap) {
  constexpr std::size_t kMost = 32;  // measured: tests/benchmarks/truth_bench.cpp
  cap.clear();
  stack.assign(1, {0, 0});
  while (!stack.empty()) {
    const std::uint32_t i = stack.back().first;
    stack.pop_back();
    if (greatest_dot(direction, s.boxes[i]) + error < least || !touch(s.boxes[i], within)) continue;
    const Bvh::Node& node = s.bvh.nodes[i];
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const Triangle t = s.facet(k);
      const double along = std::max({dot(direction, t[0]), dot(direction, t[1]), dot(direction, t[2])});
      if (along + error < least) continue;
      const Box box = box_of(t);
      if (!touch(box, within)) continue;
      if (cap.size() == kMost) return false;
      cap.push_back({t, box});
    }
    if (node.count == 0) {
      stack.emplace_back(node.second, 0);
      stack.emplace_back(i + 1, 0);
    }
  }
  return true;
}

/// Compares the facets that reach into the slab. Nothing when they are many: a deep overlap, or no convex bodies.
std::optional<bool> caps_meet(const Surface& a, const Surface& b, const Slab& slab, NodePairs& stack,
                              std::vector<PlacedFacet>& a_cap, std::vector<PlacedFacet>& b_cap) {
  if (!find_cap(a, slab.direction, slab.error, slab.b_bottom, b.boxes[0], stack, a_cap)) return {};
  Box a_box;
  for (const PlacedFacet& f : a_cap) a_box.add(f.box);
  if (!find_cap(b, -slab.direction, slab.error, -slab.a_top, a_box, stack, b_cap)) return {};
  for (const PlacedFacet& f : a_cap)
    for (const PlacedFacet& g : b_cap)
      if (touch(f.box, g.box) && triangles_meet(f.triangle, g.triangle)) return true;
  return false;
}

/// Descends both hierarchies at once, deepest overlap first.
bool descend(const Surface& a, const Surface& b, NodePairs& stack) {
  stack.clear();
  const auto visit = [&](std::uint32_t i, std::uint32_t j) {
    if (touch(a.boxes[i], b.boxes[j])) stack.emplace_back(i, j);
  };
  visit(0, 0);
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    const Bvh::Node &m = a.bvh.nodes[i], &n = b.bvh.nodes[j];
    if (m.count && n.count) {
      for (std::uint32_t k = m.first; k < m.first + m.count; ++k) {
        const Triangle s = a.facet(k);
        const Box s_box = box_of(s);
        if (!touch(s_box, b.boxes[j])) continue;
        for (std::uint32_t l = n.first; l < n.first + n.count; ++l) {
          const Triangle t = b.facet(l);
          if (touch(s_box, box_of(t)) && triangles_meet(s, t)) return true;
        }
      }
      continue;
    }
    // The larger is opened; of its children the one that overlaps deeper is looked at first.
    const bool open_a = n.count || (!m.count && size(a.boxes[i]) >= size(b.boxes[j]));
    std::uint32_t near = open_a ? i + 1 : j + 1, far = open_a ? m.second : n.second;
    const std::span<const Box> boxes = open_a ? a.boxes : b.boxes;
    const Box& other = open_a ? b.boxes[j] : a.boxes[i];
    if (overlap(boxes[far], other) > overlap(boxes[near], other)) std::swap(near, far);
    for (const std::uint32_t child : {far, near}) open_a ? visit(child, j) : visit(i, child);
  }
  return false;
}

/// The pairs of a step as a set.
class PairSet {
 public:
  PairSet(std::span<const PairRun> runs, std::size_t bodies) : runs_(runs), begin_(bodies + 1) {
    for (const PairRun& run : runs) ++begin_[run.a + 1];
    for (std::size_t a = 0; a < bodies; ++a) begin_[a + 1] += begin_[a];
  }
  bool contains(Pair pair) const {
    const auto of_a = runs_.subspan(begin_[pair.a], begin_[pair.a + 1] - begin_[pair.a]);
    const auto after = std::ranges::upper_bound(of_a, pair.b, {}, &PairRun::first);
    return after != of_a.begin() && pair.b < std::prev(after)->last;
  }
  /// The bodies of all the pairs, ascending.
  std::vector<std::uint32_t> members() const {
    std::vector<std::int64_t> steps(begin_.size());  // differences of how many runs hold the body
    for (const PairRun& run : runs_) {
      if (run.first >= run.last) continue;
      ++steps[run.a], --steps[run.a + 1];
      ++steps[run.first], --steps[run.last];
    }
    std::vector<std::uint32_t> out;
    std::int64_t count = 0;
    for (std::uint32_t body = 0; body + 1 < begin_.size(); ++body)
      if ((count += steps[body]) > 0) out.push_back(body);
    return out;
  }

 private:
  std::span<const PairRun> runs_;
  std::vector<std::size_t> begin_;  // #bodies + 1: where the runs of each body start
};

struct Swept {
  Box box;
  std::uint32_t body;
};

/// The axis along which the boxes' centres are spread most.
int sweep_axis(std::span<const Swept> all) {
  Vec3 sum = Vec3::Zero(), squares = Vec3::Zero();
  for (const Swept& s : all) sum += s.box.centre();
  const Vec3 mean = sum / static_cast<double>(all.size());
  for (const Swept& s : all) squares += (s.box.centre() - mean).cwiseAbs2();
  int axis = 0;
  squares.maxCoeff(&axis);
  return axis;
}

}  // namespace

Decision::Decision(const Bodies& bodies, std::span<const Bvh> bvhs, std::span<const Solid> solids)
    : bodies_(bodies), bvhs_(bvhs), solids_(solids), slot_(bodies.size(), kNone) {
  assert(bvhs.size() == bodies.meshes.size() && "one hierarchy per distinct mesh");
}

std::vector<Pair> Decision::hits(std::span<const Pose> poses, std::span<const PairRun> runs,
                                 std::vector<Pair>* contained) {
  assert(poses.size() == bodies_.size() && "one pose per body");
  assert((!contained || solids_.size() == bodies_.meshes.size()) && "containment needs a solid per distinct mesh");
  if (contained) contained->clear();
  const PairSet pairs(runs, bodies_.size());
  std::vector<Swept> sweep;
  for (const std::uint32_t body : pairs.members()) sweep.push_back({world_box(poses, body), body});
  const int axis = sweep_axis(sweep);
  std::ranges::sort(sweep, [axis](const Swept& s, const Swept& t) {
    return s.box.min[axis] != t.box.min[axis] ? s.box.min[axis] < t.box.min[axis] : s.body < t.body;
  });

  std::vector<Pair> out;
  std::vector<Swept> active;
  for (const Swept& next : sweep) {
    for (std::size_t i = 0; i < active.size();) {
      const Swept& other = active[i];
      if (other.box.max[axis] < next.box.min[axis]) {  // it meets nobody any more
        release(other.body);
        active[i] = active.back();
        active.pop_back();
        continue;
      }
      ++i;
      if (!touch(other.box, next.box)) continue;
      const Pair pair{std::min(other.body, next.body), std::max(other.body, next.body)};
      if (!pairs.contains(pair)) continue;
      const Placed& a = place(poses, pair.a);
      const Placed& b = place(poses, pair.b);
      if (meet_placed(pair.a, a, pair.b, b))
        out.push_back(pair);
      else if (contained && (is_contained(pair.a, a, pair.b, b) || is_contained(pair.b, b, pair.a, a)))
        contained->push_back(pair);
    }
    active.push_back(next);
  }
  for (const Swept& other : active) release(other.body);
  std::ranges::sort(out);
  if (contained) std::ranges::sort(*contained);
  return out;
}

bool Decision::meet(std::span<const Pose> poses, Pair pair) {
  assert(poses.size() == bodies_.size() && "one pose per body");
  const bool answer = meet_placed(pair.a, place(poses, pair.a), pair.b, place(poses, pair.b));
  release(pair.a);
  release(pair.b);
  return answer;
}

/// The body at its pose, with its boxes. The reference holds until the body is released.
const Decision::Placed& Decision::place(std::span<const Pose> poses, std::uint32_t body) {
  const Pose& pose = poses[body];
  std::uint32_t& slot = slot_[body];
  if (slot != kNone && same_bits(placed_[slot].pose, pose)) return placed_[slot];
  if (slot == kNone && !free_.empty()) {
    slot = free_.back();
    free_.pop_back();
  } else if (slot == kNone) {
    slot = static_cast<std::uint32_t>(placed_.size());
    placed_.emplace_back();
  }
  Placed& placed = placed_[slot];
  const Mesh& mesh = bodies_.mesh_of(body);
  const Bvh& bvh = bvhs_[bodies_.mesh[body]];
  placed.pose = pose;
  placed.world.resize(mesh.vertices.size());
  placed.boxes.resize(bvh.nodes.size());
  to_world(pose, mesh.vertices, placed.world);
  refit(bvh, mesh, placed.world, placed.boxes);
  return placed;
}

/// Gives a moving body's memory to the next.
void Decision::release(std::uint32_t body) {
  if (slot_[body] == kNone || bodies_.fixed[body]) return;
  free_.push_back(slot_[body]);
  slot_[body] = kNone;
}

Box Decision::world_box(std::span<const Pose> poses, std::uint32_t body) {
  if (bodies_.fixed[body]) return place(poses, body).boxes[0];
  const std::vector<Vec3>& vertices = bodies_.mesh_of(body).vertices;
  scratch_.resize(vertices.size());
  to_world(poses[body], vertices, scratch_);
  return bounds(scratch_);
}

bool Decision::meet_placed(std::uint32_t a, const Placed& a_placed, std::uint32_t b, const Placed& b_placed) {
  const Surface s{bodies_.mesh_of(a), bvhs_[bodies_.mesh[a]], a_placed.world, a_placed.boxes};
  const Surface t{bodies_.mesh_of(b), bvhs_[bodies_.mesh[b]], b_placed.world, b_placed.boxes};
  if (!touch(s.boxes[0], t.boxes[0])) return false;
  // Deep overlaps nearly always meet, and then the descent finds where at once: it pays to look closer at shallow ones
  // only.
  constexpr double kDeep = 1.0 / 16;  // of the smaller body; measured: tests/benchmarks/truth_bench.cpp
  const double shallow = kDeep / 3 * std::min(size(s.boxes[0]), size(t.boxes[0]));
  Vec3 direction = t.boxes[0].centre() - s.boxes[0].centre();
  for (int i = 0; i < 2; ++i) {
    const Slab slab = find_slab(s, t, direction);
    if (slab.apart()) return false;
    if (!(slab.thickness() < shallow)) break;
    if (const auto answer = caps_meet(s, t, slab, stack_, a_cap_, b_cap_)) return *answer;
  }
  return descend(s, t, stack_);
}

/// Whether a lies inside b; their surfaces share no point.
bool Decision::is_contained(std::uint32_t a, const Placed& a_placed, std::uint32_t b, const Placed& b_placed) const {
  const Box &inner = a_placed.boxes[0], &outer = b_placed.boxes[0];
  if ((inner.min.array() < outer.min.array()).any() || (inner.max.array() > outer.max.array()).any()) return false;
  const std::vector<std::uint32_t>& components = solids_[bodies_.mesh[a]].components;
  return std::ranges::all_of(components, [&](std::uint32_t vertex) {
    return is_inside(a_placed.world[vertex], bodies_.mesh_of(b), bvhs_[bodies_.mesh[b]], b_placed.world,
                     b_placed.boxes);
  });
}

std::vector<Bvh> build_bvhs(const Bodies& bodies) {
  std::vector<Bvh> out;
  for (const Mesh& mesh : bodies.meshes) out.push_back(build_bvh(mesh));
  return out;
}

}  // namespace geometry
