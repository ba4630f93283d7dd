#include <gtest/gtest.h>

#include "algorithms/cannon_naive.hpp"
#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

class Cannon : public testing::TestWithParam<std::string> {
 protected:
  bool met(const Mesh& a, const Vec3& at_a, const Mesh& b, const Vec3& at_b) const {
    return hit(GetParam(), a, {{}, at_a}, b, {{}, at_b});
  }
};

INSTANTIATE_TEST_SUITE_P(Phase, Cannon, testing::Values("cannon_naive", "cannon_sap"),
                         [](const auto& info) { return info.param; });

TEST_P(Cannon, SpheresAreStrict) {
  const Mesh sphere = geometry::sphere("sphere", 1, 8);
  EXPECT_FALSE(met(sphere, {0, 0, 0}, sphere, {2, 0, 0})) << "touching";
  EXPECT_TRUE(met(sphere, {0, 0, 0}, sphere, {std::nextafter(2.0, 0.0), 0, 0}));
  EXPECT_FALSE(met(sphere, {0, 0, 0}, sphere, {std::nextafter(2.0, 3.0), 0, 0}));
}

TEST_P(Cannon, ASphereShapeIsItselfAndNotItsBox) {
  const Mesh sphere = geometry::sphere("sphere", 1, 8);
  EXPECT_FALSE(met(sphere, {0, 0, 0}, sphere, {0, 2.1, 0}));
  EXPECT_TRUE(hit("bounding_sphere", sphere, {}, sphere, {{}, {0, 2.1, 0}}));
}

TEST_P(Cannon, AnyOtherBodyHasItsHalfDiagonal) {
  const Mesh three = geometry::box("three", {2, 4, 4});  // half diagonal 3
  EXPECT_FALSE(met(three, {0, 0, 0}, three, {0, 0, 6}));
  EXPECT_TRUE(met(three, {0, 0, 0}, three, {0, 0, 5.999999}));
}

TEST_P(Cannon, IsEarlyBetweenSphereAndMesh) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  EXPECT_TRUE(met(cube, {0, 0, 0}, cube, {0, 3, 0}));
  EXPECT_FALSE(truly_meet(cube, {}, cube, {{}, {0, 3, 0}}));
}

TEST_P(Cannon, DropsTwoFixedBodies) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const Setting setting = Setting().add(cube, {}, true).add(cube, {}, true).add(cube, {});
  EXPECT_EQ(hits(GetParam(), setting), (std::vector<Pair>{{0, 2}, {1, 2}}));
}

// Asked directly about two fixed bodies, only the algorithm's own filter could drop them: sweep and prune has it.
TEST(CannonSap, FiltersFixedPairsItself) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const Setting setting = Setting().add(cube, {}, true).add(cube, {}, true);
  const auto method = make("cannon_sap", setting.bodies);
  const std::vector<PairRun> both_fixed = {{0, 1, 2}};
  std::vector<Pair> found;
  method->prepare(setting.poses);
  method->answer(both_fixed, found);
  method->count(both_fixed, found);
  EXPECT_TRUE(found.empty());
}

TEST(CannonSap, AnswersAsNaive) {
  for (std::uint32_t seed = 91; seed <= 98; ++seed) {
    std::mt19937 random(seed);
    Setting setting = crowd(random, 80, 1 + seed % 5);
    for (std::uint32_t body = 0; body < 80; body += 9) setting.poses[body] = geometry::unborn();
    const std::vector<Pair> naive = hits("cannon_naive", setting);
    EXPECT_GT(naive.size(), 50u);
    EXPECT_EQ(hits("cannon_sap", setting), naive) << "seed " << seed;
  }
}

// Far from the origin x - r and x + r round by more than the overlap: the sweep may not break there.
TEST(CannonSap, AnswersAsNaiveFarFromTheOrigin) {
  std::mt19937 random(99);
  SCOPED_TRACE("seed 99");
  const Mesh sphere = geometry::sphere("sphere", 0.7, 8);
  int close = 0;
  for (int round = 0; round < 500; ++round) {
    const double x = 1e9 * uniform(random), step = std::nextafter(std::abs(x), 1e300) - std::abs(x);
    Setting setting;
    for (int i = 0; i < 10; ++i) setting.add(sphere, {{}, {x + std::floor(1.4 * i / step) * step, 0, 0}});
    const std::vector<Pair> naive = hits("cannon_naive", setting);
    close += static_cast<int>(naive.size());
    ASSERT_EQ(hits("cannon_sap", setting), naive) << "round " << round;
  }
  EXPECT_GT(close, 500);
}

TEST(CannonSap, TriesFewerPairs) {
  const Mesh sphere = geometry::sphere("sphere", 1, 8);
  Setting setting;
  for (int i = 0; i < 100; ++i) setting.add(sphere, {{}, {1.5 * i, 0, 0}});
  std::vector<Pair> found;
  const auto operations = [&](const std::string& name) {
    const auto method = make(name, setting.bodies);
    method->prepare(setting.poses);
    found.clear();
    return method->count(setting.runs(), found);
  };
  EXPECT_EQ(operations("cannon_naive"), 4950u);
  // Each but the last has one neighbour, found by halving at most 99 bounds: 1 to 7 comparisons, and its sphere.
  EXPECT_GE(operations("cannon_sap"), 99u * (1 + 1));
  EXPECT_LE(operations("cannon_sap"), 99u * (7 + 1));
  EXPECT_EQ(found.size(), 99u);
}

TEST(CannonSap, CountsTheBoundsItComparedAndTheSpheres) {
  const Mesh sphere = geometry::sphere("sphere", 1, 8);
  const auto operations = [&](double gap) {
    const Setting setting = Setting().add(sphere, {}).add(sphere, {{}, {gap, 0, 0}}).add(sphere, {{}, {2 * gap, 0, 0}});
    const auto method = make("cannon_sap", setting.bodies);
    std::vector<Pair> found;
    method->prepare(setting.poses);
    return method->count(setting.runs(), found);
  };
  // After the first, two bounds are halved at the farther one; after the second, one is left; after the third, none.
  EXPECT_EQ(operations(0.5), 1u + 1 + 2 + 1) << "one look at each and all three pairs";
  EXPECT_EQ(operations(1.5), 2u + 1 + 2) << "the first looks at the nearer one too; neighbours";
  EXPECT_EQ(operations(9), 2u + 1) << "no spheres";
}

}  // namespace
}  // namespace algorithms
