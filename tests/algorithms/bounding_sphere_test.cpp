#include "algorithms/thesis/bounding_sphere.hpp"

#include <gtest/gtest.h>

#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

bool met(const Mesh& a, const Vec3& at_a, const Mesh& b, const Vec3& at_b) {
  return hit("bounding_sphere", a, {{}, at_a}, b, {{}, at_b});
}

// Half extents 1, 2, 2: the half diagonal is 3, exactly.
const Mesh kThree = geometry::box("three", {2, 4, 4});

TEST(BoundingSphere, IsStrict) {
  EXPECT_FALSE(met(kThree, {0, 0, 0}, kThree, {6, 0, 0})) << "touching";
  EXPECT_TRUE(met(kThree, {0, 0, 0}, kThree, {std::nextafter(6.0, 0.0), 0, 0}));
  EXPECT_FALSE(met(kThree, {0, 0, 0}, kThree, {std::nextafter(6.0, 7.0), 0, 0}));
}

TEST(BoundingSphere, TouchesAlongADiagonalToo) {
  EXPECT_FALSE(met(kThree, {1, 1, 1}, kThree, {3, 5, 5})) << "distance 6: touching";
  EXPECT_TRUE(met(kThree, {1, 1, 1}, kThree, {3, 5, 4.999999})) << "a little nearer";
}

TEST(BoundingSphere, IsEarlyInEveryDirection) {
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
    const Mesh cube = geometry::box("cube", {2, 2, 2});
    EXPECT_TRUE(met(cube, {0, 0, 0}, cube, 3.4 * way)) << "a gap of 1.4 m between the faces";
    EXPECT_FALSE(truly_meet(cube, {{}, {0, 0, 0}}, cube, {{}, 3.4 * way}));
  }
}

TEST(BoundingSphere, IsAboutThePositionNotTheMiddle) {
  // Half extents of the box [0, 2]^3 are 2, 2, 2.
  const Mesh off = shifted_box({2, 2, 2}, {1, 1, 1});
  const double reach = 2 * std::sqrt(12.0);
  EXPECT_TRUE(met(off, {0, 0, 0}, off, {-reach + 1e-9, 0, 0}));
  EXPECT_FALSE(met(off, {0, 0, 0}, off, {-reach - 1e-9, 0, 0}));
}

TEST(BoundingSphere, DoesNotDependOnTheTurn) {
  const Mesh plank = geometry::box("plank", {8, 0.1, 0.1});
  const Pose turned{turn_deg({0, 0, 1}, 90), {7.9, 0, 0}};
  EXPECT_TRUE(hit("bounding_sphere", plank, {}, plank, turned));
  EXPECT_FALSE(truly_meet(plank, {}, plank, turned));
}

// The rows compare squares and must fall back on the root, which defines the answer, whenever rounding could tell.
TEST(BoundingSphere, AnswersAsTheRootDoesAtTheLimit) {
  const auto definition = [](const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
    const auto radius = [](const Mesh& mesh) {
      const Vec3 h = geometry::half_extents(mesh);
      return std::sqrt(h.x() * h.x() + h.y() * h.y() + h.z() * h.z());
    };
    const double dx = at_a.t.x() - at_b.t.x(), dy = at_a.t.y() - at_b.t.y(), dz = at_a.t.z() - at_b.t.z();
    return radius(a) + radius(b) > std::sqrt(dx * dx + dy * dy + dz * dz);
  };
  std::mt19937 random(31);
  SCOPED_TRACE("seed 31");
  int apart = 0, meeting = 0;
  for (int round = 0; round < 400; ++round) {
    Setting setting;
    const Vec3 size = uniform_point(random, 2).cwiseAbs() + Vec3(0.1, 0.1, 0.1);
    const Mesh mesh = geometry::box("box", size);
    const double reach = size.norm();
    setting.add(mesh, {});
    for (int i = 0; i < 20; ++i) {  // all at the limit but for a few roundings
      const Vec3 way = uniform_point(random, 1);
      setting.add(mesh, {{}, way * (reach / way.norm())});
    }
    const std::vector<Pair> expected = by_definition(setting, definition);
    ASSERT_EQ(hits("bounding_sphere", setting), expected) << "round " << round;
    for (std::uint32_t b = 1; b <= 20; ++b)
      ++(std::binary_search(expected.begin(), expected.end(), Pair{0, b}) ? meeting : apart);
  }
  EXPECT_GT(meeting, 500);
  EXPECT_GT(apart, 500);
}

TEST(BoundingSphere, AnswersAsDefinedForTinyBodies) {
  const Mesh dust = geometry::box("dust", {1e-170, 1e-170, 1e-170});
  EXPECT_FALSE(met(dust, {0, 0, 0}, dust, {1e-160, 0, 0})) << "squares underflow";
}

}  // namespace
}  // namespace algorithms
