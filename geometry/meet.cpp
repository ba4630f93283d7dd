// A sweep along one axis finds the pairs of bodies whose boxes touch; a dual descent of their hierarchies then looks
// for two triangles that meet, the deepest overlap first, and stops at the first it finds.
//
// All boxes are the least and greatest of the very doubles that the truth is defined by. They reject only what is
// apart, and no bound on any rounding is needed.
#include "geometry/meet.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>

#include "geometry/exact.hpp"

namespace geometry {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Equality bit for bit: -0 and 0 may round differently.
bool same_bits(const Pose& p, const Pose& q) {
  return std::memcmp(&p.q, &q.q, sizeof p.q) == 0 && std::memcmp(p.t.data(), q.t.data(), 3 * sizeof(double)) == 0;
}

Triangle triangle(const Facet& facet, std::span<const Vec3> world) {
  return {world[facet[0]], world[facet[1]], world[facet[2]]};
}

Box box_of(const Triangle& t) { return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])}; }

/// The least extent, over the axes, of what two touching boxes share: a guess at how likely their contents meet.
double overlap(const Box& a, const Box& b) { return (a.max.cwiseMin(b.max) - a.min.cwiseMax(b.min)).minCoeff(); }

double size(const Box& box) { return (box.max - box.min).sum(); }

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

Decision::Decision(const Bodies& bodies, std::span<const Bvh> bvhs)
    : bodies_(bodies), bvhs_(bvhs), slot_(bodies.size(), kNone) {
  assert(bvhs.size() == bodies.meshes.size() && "one hierarchy per distinct mesh");
}

std::vector<Pair> Decision::hits(std::span<const Pose> poses, std::span<const PairRun> runs) {
  assert(poses.size() == bodies_.size() && "one pose per body");
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
      if (meet_placed(pair.a, a, pair.b, b)) out.push_back(pair);
    }
    active.push_back(next);
  }
  for (const Swept& other : active) release(other.body);
  std::ranges::sort(out);
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
  const Mesh &a_mesh = bodies_.mesh_of(a), &b_mesh = bodies_.mesh_of(b);
  const Bvh &a_bvh = bvhs_[bodies_.mesh[a]], &b_bvh = bvhs_[bodies_.mesh[b]];
  const std::vector<Box>&a_boxes = a_placed.boxes, &b_boxes = b_placed.boxes;

  stack_.clear();
  const auto visit = [&](std::uint32_t i, std::uint32_t j) {
    if (touch(a_boxes[i], b_boxes[j])) stack_.emplace_back(i, j);
  };
  visit(0, 0);
  while (!stack_.empty()) {
    const auto [i, j] = stack_.back();
    stack_.pop_back();
    const Bvh::Node &m = a_bvh.nodes[i], &n = b_bvh.nodes[j];
    if (m.count && n.count) {
      for (std::uint32_t k = m.first; k < m.first + m.count; ++k) {
        const Triangle s = triangle(a_mesh.triangles[a_bvh.order[k]], a_placed.world);
        const Box s_box = box_of(s);
        if (!touch(s_box, b_boxes[j])) continue;
        for (std::uint32_t l = n.first; l < n.first + n.count; ++l) {
          const Triangle t = triangle(b_mesh.triangles[b_bvh.order[l]], b_placed.world);
          if (touch(s_box, box_of(t)) && triangles_meet(s, t)) return true;
        }
      }
      continue;
    }
    // The larger is opened; of its children the one that overlaps deeper is looked at first.
    const bool open_a = n.count || (!m.count && size(a_boxes[i]) >= size(b_boxes[j]));
    std::uint32_t near = open_a ? i + 1 : j + 1, far = open_a ? m.second : n.second;
    const std::vector<Box>& boxes = open_a ? a_boxes : b_boxes;
    const Box& other = open_a ? b_boxes[j] : a_boxes[i];
    if (overlap(boxes[far], other) > overlap(boxes[near], other)) std::swap(near, far);
    for (const std::uint32_t child : {far, near}) open_a ? visit(child, j) : visit(i, child);
  }
  return false;
}

std::vector<Bvh> build_bvhs(const Bodies& bodies) {
  std::vector<Bvh> out;
  for (const Mesh& mesh : bodies.meshes) out.push_back(build_bvh(mesh));
  return out;
}

}  // namespace geometry
