#include "algorithms/beyond/convex_hull.hpp"

#include <gtest/gtest.h>

#include "tests/support/adversary.hpp"
#include "tests/support/programming.hpp"
#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

bool met(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  const bool there = hit("convex_hull", a, at_a, b, at_b);
  EXPECT_EQ(hit("convex_hull", b, at_b, a, at_a), there);
  return there;
}

std::vector<Vec3> world(const Mesh& mesh, const Pose& pose) {
  std::vector<Vec3> out(mesh.vertices.size());
  to_world(pose, mesh.vertices, out);
  return out;
}

Mesh of_points(std::vector<Vec3> points) {
  Mesh mesh;
  mesh.name = "points";
  mesh.vertices = std::move(points);
  for (std::uint32_t i = 0; i + 3 <= mesh.vertices.size(); ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  return mesh;
}

TEST(ConvexHull, TouchingIsAHit) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  for (const Vec3& at : {Vec3(2, 0, 0), Vec3(2, 2, 0), Vec3(2, 2, 2), Vec3(2, 1, -1)}) {
    EXPECT_TRUE(met(cube, {}, cube, {{}, at}));
    EXPECT_FALSE(met(cube, {}, cube, {{}, at + Vec3(0x1p-40, 0, 0)}));
  }
}

TEST(ConvexHull, FillsRingsAndDents) {
  const Mesh around = ring(3, 0.5), ball = geometry::sphere("ball", 1, 8);
  EXPECT_TRUE(met(around, {}, ball, {}));
  EXPECT_FALSE(truly_meet(around, {}, ball, {}));
  EXPECT_TRUE(met(around, {}, ball, {{}, {0, 1.4, 0}})) << "sunk into the hole";
  EXPECT_FALSE(met(around, {}, ball, {{}, {0, 1.6, 0}}));
}

TEST(ConvexHull, ABodyInsideAnotherIsAHit) {
  EXPECT_TRUE(met(geometry::box("room", {9, 9, 9}), {}, geometry::sphere("ball", 1, 8), {{}, {1, 2, -1}}));
}

// A box set on its corner is its own hull where its box would be early.
TEST(ConvexHull, IsCloserThanTheBoxes) {
  const Mesh capsule = geometry::capsule("capsule", 4, 0.5, 0.5, 8);
  const Pose tilted{turn_deg({0, 0, 1}, 45), {0, 0, 0}}, beside{turn_deg({0, 0, 1}, 45), {0.95, 0.95, 0}};
  EXPECT_FALSE(met(capsule, tilted, capsule, beside));
  const Pose end{{}, {0.95, 3.7, 0}};  // past the round end
  EXPECT_FALSE(met(capsule, {}, capsule, end));
  EXPECT_TRUE(hit("obb_sat", capsule, {}, capsule, end));
}

// Whatever a mesh is, it has a hull: a facet, a flat sheet, a needle, one point thrice.
TEST(ConvexHull, TakesFlatStraightAndSinglePointMeshes) {
  const Mesh point = of_points({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}),
             needle = of_points({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}),
             facet = of_points({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}), sheet = geometry::box("sheet", {2, 2, 0}),
             cube = geometry::box("cube", {2, 2, 2});
  for (const Mesh* one : {&point, &needle, &facet, &sheet, &cube})
    for (const Mesh* other : {&point, &needle, &facet, &sheet, &cube}) {
      for (int x = -3; x <= 3; ++x)
        for (int z = -3; z <= 3; ++z) {
          const Pose at{{}, {1.0 * x, 0.5, 1.0 * z}};
          EXPECT_EQ(met(*one, {}, *other, at), programming::hulls_meet(one->vertices, world(*other, at)))
              << one->name << ' ' << other->name << ' ' << at.t.transpose();
        }
    }
}

// The hulls of open and concave meshes as their vertices have them, against exact programming; touching often.
TEST(ConvexHull, AnswersAsExactProgrammingOnCrowds) {
  int found = 0;
  for (std::uint32_t seed = 31; seed <= 33; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    Setting setting;
    const std::vector<Mesh> meshes = {geometry::sphere("sphere", 1, 1), geometry::box("cube", {1.5, 1.5, 1.5}),
                                      geometry::box("slab", {3, 0.2, 2}), ring(1.2, 0.3, 5)};
    for (int i = 0; i < 14; ++i)
      setting.add(meshes[i % meshes.size()], {uniform_turn(random), uniform_point(random, 2)});
    const std::vector<Pair> expected =
        by_definition(setting, [](const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
          return programming::hulls_meet(world(a, at_a), world(b, at_b));
        });
    EXPECT_EQ(hits("convex_hull", setting), expected);
    found += static_cast<int>(expected.size());
  }
  EXPECT_GT(found, 60);
}

// Slivers, needles, huge and tiny meshes far from the origin, put where they just meet or not: what truly meets, hull
// by hull and so facet by facet, is reported, and a miss would not even need enlarging to be excused.
TEST(ConvexHull, MissesNothingOfAdversaries) {
  tests::Random random(8);
  int met_count = 0;
  for (int round = 0; round < 300; ++round) {
    const Mesh a = adversary::mesh(random), b = adversary::mesh(random);
    const Pose at_a = adversary::pose(random, 1);
    Pose at_b{adversary::quaternion(random), {0, 0, 0}};
    at_b.t = world(a, at_a)[random.below(18)] - world(b, at_b)[random.below(18)];
    if (!truly_meet(a, at_a, b, at_b)) continue;
    ++met_count;
    EXPECT_TRUE(hit("convex_hull", a, at_a, b, at_b)) << "round " << round;
  }
  EXPECT_GT(met_count, 40);
}

TEST(ConvexHull, CountsWhatItLooksAt) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const auto operations = [&](const Vec3& at) {
    const Setting setting = Setting().add(cube, {}).add(cube, {{}, at});
    const auto method = make("convex_hull", setting.bodies);
    std::vector<Pair> found;
    method->prepare(setting.poses);
    return method->count(setting.runs(), found);
  };
  EXPECT_EQ(operations({9, 0, 0}), 1u) << "the balls";
  EXPECT_EQ(operations({0, 0, 2.5}), 4u) << "and x, y, z";
  EXPECT_EQ(operations({0, 0, 0}), 5u) << "and the balls inside";
  // The direction from middle to middle, two climbs, and all eight corners of both to be certain.
  EXPECT_GE(operations({1.99, 1.99, 1.99}), 5u + 2);
}

}  // namespace
}  // namespace algorithms
