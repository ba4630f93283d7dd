// fcl_bvh: an adaptor. That FCL is asked the right question, and what its answers are worth.
#include <gtest/gtest.h>

#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

struct FclBvh : testing::Test {
  void SetUp() override {
    if (const Algorithm* row = find_missing("fcl_bvh")) GTEST_SKIP() << "fcl_bvh needs " << remedy(*row);
  }
};

TEST_F(FclBvh, AgreesWithTheTruthInGeneralPosition) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Setting setting = crowd(random, 30, 3);
    EXPECT_FALSE(truth(setting).empty());
    EXPECT_EQ(hits("fcl_bvh", setting), truth(setting));
  }
}

TEST_F(FclBvh, BodiesOfOneMeshShareItsHierarchy) {
  Setting setting = Setting().add(geometry::sphere("sphere", 1, 8), {});
  for (int i = 1; i < 4; ++i) {
    setting.bodies.add(std::to_string(i), 0);
    setting.poses.push_back({turn_deg({0, 0, 1}, 10.0 * i), {1.5 * i, 0, 0}});
  }
  EXPECT_EQ(hits("fcl_bvh", setting), (std::vector<Pair>{{0, 1}, {1, 2}, {2, 3}}));
}

TEST_F(FclBvh, MissesABodyInsideAnother) {
  EXPECT_FALSE(hit("fcl_bvh", geometry::box("cube", {2, 2, 2}), {}, geometry::sphere("pea", 0.1, 4), {}));
}

// The place where two bodies cease to meet is found exactly, to one ulp; there FCL, which rounds in the one body's
// frame, is wrong either way.
TEST_F(FclBvh, ErrsBothWaysWhereBodiesGraze) {
  std::mt19937 random(41);
  SCOPED_TRACE("seed 41");
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  int missed = 0, invented = 0;
  for (int i = 0; i < 100; ++i) {
    const Pose here{uniform_turn(random), uniform_point(random, 1)};
    Pose there{uniform_turn(random), here.t};
    const Vec3 way = uniform_point(random, 1);
    double meets = 0, apart = 100;  // along x only: one coordinate is bisected to neighbouring doubles
    const auto move = [&](double x) { there.t = here.t + 0.2 * way + Vec3(x, 0, 0); };
    while (std::nextafter(meets, apart) < apart) {
      const double middle = 0.5 * (meets + apart);
      move(middle);
      (truly_meet(cube, here, cube, there) ? meets : apart) = middle;
    }
    move(meets);
    if (truly_meet(cube, here, cube, there)) missed += !hit("fcl_bvh", cube, here, cube, there);
    move(apart);
    if (!truly_meet(cube, here, cube, there)) invented += hit("fcl_bvh", cube, here, cube, there);
  }
  EXPECT_GT(missed, 0);
  EXPECT_GT(invented, 0);
}

TEST_F(FclBvh, TakesTrianglesWithoutArea) {
  Mesh flat = geometry::box("flat", {2, 2, 2});
  for (const geometry::Facet& facet : {geometry::Facet{0, 0, 0}, {0, 1, 1}, {7, 0, 7}}) flat.triangles.push_back(facet);
  Mesh point = flat;
  for (Vec3& v : point.vertices) v = Vec3(1, 1, 1);
  const Setting setting = Setting().add(flat, {}).add(flat, {{}, {1, 1, 1}}).add(flat, {{}, {9, 0, 0}}).add(point, {});
  const std::vector<Pair> found = hits("fcl_bvh", setting);
  EXPECT_TRUE(std::binary_search(found.begin(), found.end(), Pair{0, 1}));
  EXPECT_FALSE(std::binary_search(found.begin(), found.end(), Pair{0, 2}));
}

// Squares of these overflow or vanish: what FCL says of them is its own affair, but it comes back.
TEST_F(FclBvh, SurvivesCoordinatesWhoseSquaresAreNoDoubles) {
  for (const double size : {1e-320, 1e-200, 1e160, 1e300}) {
    SCOPED_TRACE(size);
    const Mesh sphere = geometry::box("box", {size, size, size});
    const Setting setting =
        Setting().add(sphere, {}).add(sphere, {turn_deg({1, 2, 3}, 40), {size / 2, 0, 0}}).add(sphere, {{}, {9, 0, 0}});
    EXPECT_LE(hits("fcl_bvh", setting).size(), 3u);
  }
}

}  // namespace
}  // namespace algorithms
