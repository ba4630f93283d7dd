#include "algorithms/thesis/obb_corners.hpp"

#include <gtest/gtest.h>

#include "geometry/portable_math.hpp"
#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

bool met(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  return hit("obb_corners", a, at_a, b, at_b);
}

/// The turns of the thesis about `centre`: x, then y, then z.
Vec3 turned(const Vec3& point, const Vec3& centre, double ex, double ey, double ez) {
  using geometry::portable::cos, geometry::portable::sin;
  Vec3 p = point - centre;
  p = Vec3(p.x(), p.y() * cos(ex) - p.z() * sin(ex), p.z() * cos(ex) + p.y() * sin(ex));
  p = Vec3(p.x() * cos(ey) + p.z() * sin(ey), p.y(), p.z() * cos(ey) - p.x() * sin(ey));
  p = Vec3(p.x() * cos(ez) - p.y() * sin(ez), p.y() * cos(ez) + p.x() * sin(ez), p.z());
  return centre + p;
}

bool corner_of_first_inside(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  const geometry::EulerAngles of_a = geometry::euler_angles(at_a.q), of_b = geometry::euler_angles(at_b.q);
  const Vec3 h = geometry::half_extents(b);
  for (const Vec3& corner : corners(geometry::half_extents(a))) {
    Vec3 p = turned(at_a.t + corner, at_a.t, of_a.x, of_a.y, of_a.z);
    p = turned(p, at_b.t, -of_b.x, -of_b.y, -of_b.z);
    bool inside = true;
    for (int i = 0; i < 3; ++i) inside = inside && p[i] >= at_b.t[i] - h[i] && p[i] <= at_b.t[i] + h[i];
    if (inside) return true;
  }
  return false;
}

bool definition(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  return corner_of_first_inside(a, at_a, b, at_b) || corner_of_first_inside(b, at_b, a, at_a);
}

const Mesh kCube = geometry::box("cube", {2, 2, 2});

TEST(ObbCorners, IsClosed) {
  EXPECT_TRUE(met(kCube, {}, kCube, {{}, {2, 2, 2}}));
  EXPECT_TRUE(met(kCube, {}, kCube, {{}, {2, 0, 0}}));
  EXPECT_FALSE(met(kCube, {}, kCube, {{}, {2 + 0x1p-50, 0, 0}}));
  EXPECT_FALSE(met(kCube, {}, kCube, {{}, {0, -2 - 0x1p-50, 0}}));
}

TEST(ObbCorners, SeesASmallBodyInsideABigOne) {
  const Mesh big = geometry::box("big", {10, 10, 10});
  EXPECT_TRUE(met(big, {}, kCube, {{}, {1, 2, 3}}));
  EXPECT_TRUE(met(kCube, {{}, {1, 2, 3}}, big, {}));
}

// A long capsule through a thin slab crosses it without a corner inside, either way round.
TEST(ObbCorners, MissesALongRodThroughAThinSlab) {
  const Mesh rod = geometry::box("rod", {0.5, 10, 0.5}), slab = geometry::box("slab", {8, 0.2, 8});
  EXPECT_FALSE(met(rod, {}, slab, {}));
  EXPECT_TRUE(truly_meet(rod, {}, slab, {}));
}

TEST(ObbCorners, MissesCrossedPlanks) {
  const Mesh along_x = geometry::box("along_x", {10, 1, 1}), along_z = geometry::box("along_z", {1, 1, 10});
  EXPECT_FALSE(met(along_x, {}, along_z, {{}, {0, 0.5, 0}}));
  EXPECT_TRUE(truly_meet(along_x, {}, along_z, {{}, {0, 0.5, 0}}));
}

TEST(ObbCorners, ReportsTheEmptyMiddleOfTheRing) {
  const Mesh around = ring(3, 0.5), ball = geometry::sphere("ball", 0.4, 8);
  EXPECT_TRUE(met(around, {}, ball, {}));
  EXPECT_FALSE(truly_meet(around, {}, ball, {}));
}

// Against the true boxes, whose corners truth places: for one axis the order of turns does not matter.
bool true_corner_inside(const Vec3& half_a, const Pose& at_a, const Vec3& half_b, const Pose& at_b) {
  const geometry::Mat3 ra = geometry::rotation(at_a.q), rb = geometry::rotation(at_b.q);
  for (const Vec3& corner : corners(half_a)) {
    const Vec3 local = rb.transpose() * (geometry::to_world(ra, at_a.t, corner) - at_b.t);
    if ((local.cwiseAbs() - half_b).maxCoeff() <= 0) return true;
  }
  return false;
}

TEST(ObbCorners, IsExactForTurnsAboutOneAxisAndWrongForTwo) {
  std::mt19937 random(71);
  SCOPED_TRACE("seed 71");
  const Mesh plank = geometry::box("plank", {4, 0.4, 1});
  const Vec3 h = geometry::half_extents(plank);
  int reported = 0, wrong_for_two = 0;
  for (int round = 0; round < 2000; ++round) {
    const Vec3 at = uniform_point(random, 2);
    const double most = round % 3 == 0 ? 90 : 180;  // about x the angles themselves end at 90 degrees, see below
    const double first = most * uniform(random), second = most * uniform(random);
    const Vec3 axis = Vec3::Unit(round % 3), next = Vec3::Unit((round + 1) % 3);
    const Pose one_a{turn_deg(axis, first), {0, 0, 0}}, one_b{turn_deg(axis, second), at};
    const bool expected = true_corner_inside(h, one_a, h, one_b) || true_corner_inside(h, one_b, h, one_a);
    ASSERT_EQ(met(plank, one_a, plank, one_b), expected) << "round " << round;
    reported += expected;
    const Pose two{turn_deg(axis, first) * turn_deg(next, second), {0, 0, 0}}, still{{}, at};
    wrong_for_two +=
        met(plank, two, plank, still) != (true_corner_inside(h, two, h, still) || true_corner_inside(h, still, h, two));
  }
  EXPECT_GT(reported, 100);
  EXPECT_GT(wrong_for_two, 50);
}

// Babylon.js's angle about x ends at 90 degrees: 120 about x come as (60, 180, 180), which in the order x, y, z make
// 240.
TEST(ObbCorners, IsWrongForTurnsAboutXBeyond90Degrees) {
  const Mesh plank = geometry::box("plank", {0.4, 8, 0.4}), seed = geometry::box("seed", {0.1, 0.1, 0.1});
  for (const double degrees : {60.0, 120.0}) {
    const Pose turned{turn_deg({1, 0, 0}, degrees), {0, 0, 0}};
    const Pose in_its_end{{}, geometry::rotation(turned.q) * Vec3(0, 3, 0)};
    EXPECT_EQ(met(plank, turned, seed, in_its_end), degrees < 90) << degrees << " degrees";
  }
}

// The negated angles in the same order do not undo two turns: a small cube in the end of a plank is not found there.
TEST(ObbCorners, DoesNotTurnBackAfterTwoTurns) {
  const Mesh plank = geometry::box("plank", {8, 0.4, 0.4}), seed = geometry::box("seed", {0.1, 0.1, 0.1});
  const Quaternion q = turn_deg({0, 1, 0}, 60) * turn_deg({1, 0, 0}, 50) * turn_deg({0, 0, 1}, 40);
  const Pose inside{{}, geometry::rotation(q) * Vec3(3, 0, 0)};
  EXPECT_FALSE(met(plank, {q, {0, 0, 0}}, seed, inside));
  EXPECT_TRUE(met(plank, {}, seed, {{}, {3, 0, 0}})) << "unturned it is found";
}

TEST(ObbCorners, AnswersAsDefined) {
  std::size_t reported = 0;
  for (std::uint32_t seed = 72; seed <= 79; ++seed) {
    std::mt19937 random(seed);
    const Setting setting = crowd(random, 60, 4);
    const std::vector<Pair> expected = by_definition(setting, definition);
    reported += expected.size();
    EXPECT_EQ(hits("obb_corners", setting), expected) << "seed " << seed;
  }
  EXPECT_GT(reported, 400u);
}

// Pairs that are too far apart are left out early; just at the reach of the corners nothing may be lost.
TEST(ObbCorners, FindsCornersThatOnlyJustReach) {
  EXPECT_TRUE(met(kCube, {}, kCube, {{}, {-2, 2, -2}}));
  EXPECT_TRUE(met(kCube, {{}, {1024, 0, 0}}, kCube, {{}, {1026, 2, 2}}));
}

TEST(ObbCorners, CountsTheDistanceAndThePointsOfEachWayItTried) {
  const Mesh big = geometry::box("big", {10, 10, 10});
  const auto operations = [&](const Mesh& first, const Mesh& second, const Vec3& at) {
    const Setting setting = Setting().add(first, {}).add(second, {{}, at});
    const auto method = make("obb_corners", setting.bodies);
    std::vector<Pair> found;
    method->prepare(setting.poses);
    return method->count(setting.runs(), found);
  };
  EXPECT_EQ(operations(kCube, kCube, {9, 9, 9}), 1u) << "the half diagonals, 2 root 3 together, do not reach";
  EXPECT_EQ(operations(kCube, kCube, {1, 1, 1}), 1u + 8) << "a corner of the first in the second";
  EXPECT_EQ(operations(kCube, big, {1, 2, 3}), 1u + 8);
  EXPECT_EQ(operations(big, kCube, {1, 2, 3}), 1u + 8 + 8) << "corners of the second only";
  EXPECT_EQ(operations(kCube, kCube, {3, 0, 0}), 1u + 8 + 8) << "within reach, no corner inside";
}

}  // namespace
}  // namespace algorithms
