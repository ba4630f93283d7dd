#include "algorithms/thesis/rotated_aabb.hpp"

#include <gtest/gtest.h>

#include "geometry/portable_math.hpp"
#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

constexpr double kRightAngle = std::numbers::pi / 2;

bool met(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  return hit("rotated_aabb", a, at_a, b, at_b);
}

TEST(TurnedExtents, AreTheHalfExtentsUnturned) {
  const Vec3 extents = turned_extents({1, 2, 3}, {});
  EXPECT_NEAR(extents.x(), 1, 1e-15);
  EXPECT_NEAR(extents.y(), 2, 1e-15);
  EXPECT_NEAR(extents.z(), 3, 1e-15);
}

TEST(TurnedExtents, SwapAtRightAngles) {
  const Vec3 about_z = turned_extents({1, 2, 3}, {0, 0, kRightAngle});
  EXPECT_TRUE(about_z.isApprox(Vec3(2, 1, 3), 1e-15)) << about_z.transpose();
  const Vec3 about_y = turned_extents({1, 2, 3}, {0, kRightAngle, 0});
  EXPECT_TRUE(about_y.isApprox(Vec3(3, 2, 1), 1e-15)) << about_y.transpose();
  const Vec3 about_x = turned_extents({1, 2, 3}, {kRightAngle, 0, 0});
  EXPECT_TRUE(about_x.isApprox(Vec3(1, 3, 2), 1e-15)) << about_x.transpose();
}

TEST(TurnedExtents, OfASquareCornerAt45DegreesAreRootTwoAndNothing) {
  const Vec3 extents = turned_extents({1, 1, 1}, {0, 0, kRightAngle / 2});
  EXPECT_NEAR(extents.x(), std::numbers::sqrt2, 1e-15);
  EXPECT_NEAR(extents.y(), 0, 1e-15);
  EXPECT_NEAR(extents.z(), 1, 1e-15);
}

TEST(TurnedExtents, FollowZThenYThenX) {
  // By 90 degrees about z (1, 2, 3) becomes (2, 1, 3), about y (3, 1, 2), about x (3, 2, 1).
  const Vec3 extents = turned_extents({1, 2, 3}, {kRightAngle, kRightAngle, kRightAngle});
  EXPECT_TRUE(extents.isApprox(Vec3(3, 2, 1), 1e-15)) << extents.transpose();
}

TEST(TurnedExtents, OfNoSizeAreNothing) {
  EXPECT_EQ(turned_extents({0, 0, 0}, {1, 2, 3}), Vec3(0, 0, 0));
  EXPECT_EQ(turned_extents({0, 0, 2}, {0, 0, 1}).z(), 2);
}

TEST(RotatedAabb, IsExactOnTheUnturnedSlabAndCube) {
  const Mesh cube = geometry::box("cube", {2, 2, 2}), slab = geometry::box("slab", {6, 0.5, 4});
  for (const Mesh& other : {cube, slab}) {
    const Vec3 sum = geometry::half_extents(cube) + geometry::half_extents(other);
    for (int axis = 0; axis < 3; ++axis)
      for (const double gap : {-1e-6, 1e-6}) {
        Vec3 at = 0.3 * sum;
        at[axis] = sum[axis] + gap;
        EXPECT_EQ(met(cube, {}, other, {{}, at}), gap < 0) << "axis " << axis << ", gap " << gap;
        EXPECT_EQ(truly_meet(cube, {}, other, {{}, at}), gap < 0);
      }
  }
}

TEST(RotatedAabb, IsGoodNearRightAngles) {
  const Mesh slab = geometry::box("slab", {6, 1, 4});
  for (const double degrees : {89.0, 90.0, 91.0, 179.0, 181.0}) {
    const bool upright = degrees < 100;
    const Pose turned{turn_deg({0, 0, 1}, degrees), {0, 0, 0}};
    for (const double gap : {-0.15, 0.15}) {
      const Pose beside{{}, {(upright ? 0.5 : 3) + 3 + gap, 0, 0}};
      EXPECT_EQ(met(slab, turned, slab, beside), gap < 0) << degrees << " degrees, gap " << gap;
    }
  }
}

// 45 degrees about z leave a cube no extent along y: two of them, half a metre apart, do not see each other.
TEST(RotatedAabb, IsBlindAt45DegreesOnOneAxis) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const Quaternion q = turn_deg({0, 0, 1}, 45);
  EXPECT_FALSE(met(cube, {q, {0, 0, 0}}, cube, {q, {0, 0.5, 0}}));
  EXPECT_TRUE(truly_meet(cube, {q, {0, 0, 0}}, cube, {q, {0, 0.5, 0}}));
}

TEST(RotatedAabb, IsEarlyAt45DegreesOnTheOther) {
  const Mesh sphere = geometry::sphere("sphere", 1, 16);
  const Quaternion q = turn_deg({0, 0, 1}, 45);
  EXPECT_TRUE(met(sphere, {q, {0, 0, 0}}, sphere, {q, {2.8, 0, 0}})) << "a gap of 0.8 m";
  EXPECT_FALSE(met(sphere, {q, {0, 0, 0}}, sphere, {q, {2.9, 0, 0}}));
}

TEST(RotatedAabb, AnswersAsTheFormulas) {
  const auto extents = [](const Mesh& mesh, const Pose& pose) {
    const geometry::EulerAngles angles = geometry::euler_angles(pose.q);
    Vec3 e = geometry::half_extents(mesh);
    const int planes[3][2] = {{0, 1}, {2, 0}, {1, 2}};
    const double turns[3] = {angles.z, angles.y, angles.x};
    for (int i = 0; i < 3; ++i) {
      double &u = e[planes[i][0]], &v = e[planes[i][1]];
      const double r = std::sqrt(u * u + v * v), alpha = geometry::portable::asin(u / r);
      u = std::abs(r * geometry::portable::sin(turns[i] + alpha));
      v = std::abs(r * geometry::portable::cos(turns[i] + alpha));
    }
    return e;
  };
  const auto definition = [&](const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
    const Vec3 sum = extents(a, at_a) + extents(b, at_b), between = at_a.t - at_b.t;
    return std::abs(between.x()) <= sum.x() && std::abs(between.y()) <= sum.y() && std::abs(between.z()) <= sum.z();
  };
  for (std::uint32_t seed = 41; seed <= 48; ++seed) {
    std::mt19937 random(seed);
    const Setting setting = crowd(random, 60, 4);
    const std::vector<Pair> expected = by_definition(setting, definition);
    EXPECT_GT(expected.size(), 10u);
    EXPECT_EQ(hits("rotated_aabb", setting), expected) << "seed " << seed;
  }
}

}  // namespace
}  // namespace algorithms
