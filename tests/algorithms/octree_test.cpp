#include "algorithms/beyond/octree.hpp"

#include <gtest/gtest.h>

#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

Changed by(std::int64_t depth, std::int64_t capacity, const std::string& then) {
  return {{"depth", depth}, {"capacity", capacity}, {"then", then}};
}

/// The leaves by the words of the header, all of them: which bodies share one.
struct Cell {
  Vec3 min, max;
};
void leaves(const std::vector<geometry::Box>& boxes, const std::vector<std::uint32_t>& bodies, const Cell& cell,
            int depth, std::size_t capacity, std::vector<std::vector<std::uint32_t>>& out) {
  if (bodies.size() <= capacity || depth == 0) return out.push_back(bodies);
  std::vector<std::vector<std::uint32_t>> inside(8);
  std::vector<Cell> cells(8);
  std::size_t together = 0;
  const Vec3 middle = 0.5 * cell.min + 0.5 * cell.max;
  for (unsigned c = 0; c < 8; ++c) {
    cells[c] = cell;
    for (int k = 0; k < 3; ++k) (c >> k & 1 ? cells[c].min : cells[c].max)[k] = middle[k];
    for (const std::uint32_t body : bodies)
      if (geometry::touch(boxes[body], {cells[c].min, cells[c].max})) inside[c].push_back(body);
    together += inside[c].size();
  }
  if (together >= 4 * bodies.size()) return out.push_back(bodies);
  for (unsigned c = 0; c < 8; ++c) leaves(boxes, inside[c], cells[c], depth - 1, capacity, out);
}

// Every pair that shares a leaf is asked about, no other: obb_sat tells which were, its answers being more than those
// of pairs whose world boxes touch.
TEST(Octree, AsksAboutThePairsThatShareALeaf) {
  for (const auto& [depth, capacity] : {std::pair{6, 8}, {2, 1}, {9, 2}, {1, 1}, {0, 1}})
    for (std::uint32_t seed = 61; seed <= 63; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", depth " << depth << ", capacity " << capacity);
      std::mt19937 random(seed);
      const Setting setting = crowd(random, 60, 8);
      std::vector<geometry::Box> boxes;
      geometry::Box scene;
      std::vector<std::uint32_t> all;
      for (std::uint32_t body = 0; body < 60; ++body) {
        std::vector<Vec3> world(setting.bodies.mesh_of(body).vertices.size());
        to_world(setting.poses[body], setting.bodies.mesh_of(body).vertices, world);
        boxes.push_back(geometry::bounds(world));
        const geometry::Enclosure around = geometry::enclosure(setting.bodies.mesh_of(body));
        boxes.back() = geometry::world_box(around, geometry::placement(around, setting.poses[body]));
        scene.add(boxes.back());
        all.push_back(body);
      }
      std::vector<std::vector<std::uint32_t>> found;
      leaves(boxes, all, {scene.min, scene.max}, depth, std::size_t(capacity), found);
      std::vector<Pair> shared;
      for (const auto& leaf : found)
        for (const std::uint32_t a : leaf)
          for (const std::uint32_t b : leaf)
            if (a < b) shared.push_back({a, b});
      std::ranges::sort(shared);
      shared.erase(std::unique(shared.begin(), shared.end()), shared.end());
      std::vector<Pair> expected;
      for (const Pair& pair : hits("bounding_sphere", setting))
        if (std::ranges::binary_search(shared, pair)) expected.push_back(pair);
      EXPECT_FALSE(expected.empty());
      EXPECT_EQ(hits("octree", setting, by(depth, capacity, "bounding_sphere")), expected);
    }
}

// What touches shares a leaf, whatever the cells: nothing of a conservative method that meets is lost.
TEST(Octree, LosesNothingThatMeets) {
  for (std::uint32_t seed = 71; seed <= 74; ++seed)
    for (const auto& [depth, capacity] : {std::pair{6, 8}, {20, 1}, {3, 2}}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", depth " << depth << ", capacity " << capacity);
      std::mt19937 random(seed);
      const Setting setting = crowd(random, 60, 5);
      const std::vector<Pair> truly = truth(setting);
      for (const std::string then : {"aabb", "obb_sat", "convex_hull"}) {
        const std::vector<Pair> found = hits("octree", setting, by(depth, capacity, then));
        EXPECT_TRUE(std::ranges::includes(found, truly)) << then;
        EXPECT_TRUE(std::ranges::includes(hits(then, setting), found)) << then;
      }
      EXPECT_EQ(hits("octree", setting, by(depth, capacity, "aabb")), hits("aabb", setting));
    }
}

// Cells end where bodies touch: at the planes that cut them.
TEST(Octree, BodiesThatTouchOnACutShareALeaf) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  Setting setting;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y) setting.add(cube, {{}, {2.0 * x, 2.0 * y, 0}});
  EXPECT_EQ(hits("octree", setting, by(6, 1, "aabb")), hits("aabb", setting));
}

TEST(Octree, ABodyThatSpansTheSceneMeetsAll) {
  Setting setting;
  setting.add(geometry::box("plate", {100, 1, 100}), {}, true);
  for (int i = 0; i < 200; ++i)
    setting.add(geometry::sphere("ball", 0.5, 2), {{}, {i % 20 * 4.0 - 40, 0.9, i / 20 * 4.0 - 20}});
  EXPECT_EQ(hits("octree", setting).size(), 200u);
  EXPECT_EQ(hits("octree", setting), hits("aabb", setting));
}

// All in one place: cutting thins nothing, so nothing is cut 20 times into 8.
TEST(Octree, StaysSmallWhereAllOverlap) {
  Setting setting;
  for (int i = 0; i < 300; ++i) setting.add(geometry::box("cube", {2, 2, 2}), {{}, {1e-3 * i, 0, 0}});
  const auto method = make("octree", setting.bodies, by(20, 1, "aabb"));
  std::vector<Pair> found;
  method->prepare(setting.poses);
  EXPECT_LT(method->count(setting.runs(), found), 1'000'000u);
  EXPECT_EQ(found.size(), 300u * 299 / 2);
}

TEST(Octree, PromisesWhatThenDoes) {
  const Algorithm& row = *find("octree");
  Knobs knobs = presets(row);
  EXPECT_EQ(promise(row, knobs), Promise::conservative);
  knobs["then"] = std::string("facet_distance");
  EXPECT_EQ(promise(row, knobs), Promise::none);
  EXPECT_TRUE(samples_facets(row, knobs));
  EXPECT_EQ(promise(*find("exact"), presets(*find("exact"))), Promise::exact);
}

TEST(Octree, MayEndInAnyPairwiseMethodAndInNoOther) {
  const Algorithm& row = *find("octree");
  const Knob& then = *std::ranges::find(row.knobs, "then", &Knob::name);
  for (const Algorithm& other : all())
    EXPECT_EQ(std::ranges::count(then.choices, other.name), other.scope == Scope::pair) << other.name;
  EXPECT_EQ(std::ranges::count(then.choices, "none"), 0);
}

}  // namespace
}  // namespace algorithms
