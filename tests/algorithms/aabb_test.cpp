#include "algorithms/aabb.hpp"

#include <gtest/gtest.h>

#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

geometry::Box world_box(const Mesh& mesh, const Pose& pose) {
  std::vector<Vec3> world(mesh.vertices.size());
  geometry::to_world(pose, mesh.vertices, world);
  return geometry::bounds(world);
}

TEST(Aabb, IsClosed) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  EXPECT_TRUE(hit("aabb", cube, {}, cube, {{}, {2, 2, 2}}));
  EXPECT_FALSE(hit("aabb", cube, {}, cube, {{}, {2, 2, 2 + 0x1p-51}}));
}

TEST(Aabb, GrowsWithTheTurn) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const Pose turned{turn_deg({0, 0, 1}, 45), {0, 0, 0}};
  EXPECT_TRUE(hit("aabb", cube, turned, cube, {{}, {2.414, 0, 0}}));
  EXPECT_FALSE(hit("aabb", cube, turned, cube, {{}, {2.4143, 0, 0}}));
}

TEST(Aabb, IsEarlyBesideATurnedBody) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const Pose turned{turn_deg({0, 0, 1}, 45), {0, 0, 0}}, at_corner{{}, {2.3, 2.3, 0}};
  EXPECT_TRUE(hit("aabb", cube, turned, cube, at_corner));
  EXPECT_FALSE(truly_meet(cube, turned, cube, at_corner));
}

// The box holds the very doubles of the truth: one body's box is put where the other's greatest vertex is, and one
// rounding beyond.
TEST(Aabb, HoldsTheWorldVerticesBitForBit) {
  std::mt19937 random(61);
  SCOPED_TRACE("seed 61");
  Mesh point = geometry::box("point", {0, 0, 0});
  for (const Mesh& mesh : {geometry::sphere("sphere", 1, 8), ring(1.2, 0.3), geometry::box("box", {1, 2, 3})})
    for (int round = 0; round < 50; ++round) {
      const Pose pose{uniform_turn(random), uniform_point(random, 100)};
      const geometry::Box box = world_box(mesh, pose);
      for (int axis = 0; axis < 3; ++axis)
        for (const bool high : {false, true}) {
          Vec3 at = box.centre();
          at[axis] = high ? box.max[axis] : box.min[axis];
          EXPECT_TRUE(hit("aabb", mesh, pose, point, {{}, at}));
          at[axis] = std::nextafter(at[axis], high ? 1e9 : -1e9);
          EXPECT_FALSE(hit("aabb", mesh, pose, point, {{}, at}));
        }
    }
}

TEST(Aabb, AnswersAsTheBoxesOfTheWorldVertices) {
  for (std::uint32_t seed = 62; seed <= 67; ++seed) {
    std::mt19937 random(seed);
    const Setting setting = crowd(random, 60, 4);
    const std::vector<Pair> expected =
        by_definition(setting, [](const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
          return geometry::touch(world_box(a, at_a), world_box(b, at_b));
        });
    EXPECT_GT(expected.size(), 50u);
    EXPECT_EQ(hits("aabb", setting), expected) << "seed " << seed;
  }
}

}  // namespace
}  // namespace algorithms
