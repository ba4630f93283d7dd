#include "algorithms/beyond/capsule.hpp"

#include <gtest/gtest.h>

#include "algorithms/beyond/tight_capsule.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/grazing.hpp"

namespace algorithms {
namespace {

using namespace setting;

double length(const Capsule& capsule) { return (capsule.to - capsule.from).norm(); }

double volume(double radius, double length) { return std::numbers::pi * radius * radius * (length + 4.0 / 3 * radius); }

/// The farthest point from the segment, in long doubles.
long double farthest(const Capsule& capsule, const std::vector<Vec3>& points) {
  using Wide = Eigen::Matrix<long double, 3, 1>;
  const Wide from = capsule.from.cast<long double>(), along = capsule.to.cast<long double>() - from;
  long double most = 0;
  for (const Vec3& p : points) {
    const Wide to = p.cast<long double>() - from;
    const long double square = along.squaredNorm();
    const long double t = square > 0 ? std::clamp(to.dot(along) / square, 0.0L, 1.0L) : 0;
    most = std::max(most, (to - t * along).stableNorm());
  }
  return most;
}

Mesh rod(double length, double side) { return geometry::box("rod", {length, side, side}); }

bool met(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) { return hit("capsule", a, at_a, b, at_b); }

TEST(TightCapsule, OfACapsuleIsThatCapsule) {
  const Capsule found = tight_capsule(geometry::capsule("capsule", 6, 1, 1, 16).vertices);
  EXPECT_NEAR(found.radius, 1, 1e-6);
  EXPECT_NEAR(length(found), 4, 1e-3);
  EXPECT_NEAR(std::fabs((found.to - found.from).normalized().y()), 1, 1e-6) << "along its axis";
}

TEST(TightCapsule, OfASphereIsABall) {
  const Capsule found = tight_capsule(geometry::sphere("sphere", 2, 16).vertices);
  EXPECT_NEAR(volume(found.radius, length(found)) / volume(2, 0), 1, 1e-3);
}

// Through the corners of the ends: radius sqrt(1/2), as long as the rod; wider ones are shorter and smaller.
TEST(TightCapsule, OfARodIsNoLargerThanThroughItsCorners) {
  const Capsule found = tight_capsule(rod(10, 1).vertices);
  EXPECT_LE(volume(found.radius, length(found)), volume(std::sqrt(0.5), 10) * (1 + 1e-9));
  EXPECT_GE(found.radius, std::sqrt(0.5) * (1 - 1e-12)) << "no circle around the square is smaller";
}

// A rod turned by angles that no line of the grid has.
TEST(TightCapsule, FindsADirectionThatIsNoneOfTheGrid) {
  const geometry::Mat3 r = geometry::rotation(turn_deg(Vec3(0.6, 0.64, 0.48), 37));
  std::vector<Vec3> turned = rod(10, 1).vertices;
  for (Vec3& v : turned) v = r * v;
  const Capsule found = tight_capsule(turned), straight = tight_capsule(rod(10, 1).vertices);
  EXPECT_NEAR(volume(found.radius, length(found)) / volume(straight.radius, length(straight)), 1, 1e-4);
}

TEST(TightCapsule, HoldsEveryPointWhateverTheMesh) {
  tests::Random random;
  SCOPED_TRACE(tests::kSeed);
  for (int round = 0; round < 200; ++round) {
    const Mesh mesh = adversary::mesh(random);
    const Capsule found = tight_capsule(mesh.vertices);
    ASSERT_LE(farthest(found, mesh.vertices), found.radius) << "round " << round;
  }
  const Mesh fine = geometry::sphere("fine", 1, 32);  // more points than a search looks at
  EXPECT_LE(farthest(tight_capsule(fine.vertices), fine.vertices), tight_capsule(fine.vertices).radius);
}

TEST(CapsuleMethod, IsExactOnCapsulesSideBySideAndEndToEnd) {
  const Mesh mesh = geometry::capsule("capsule", 6, 1, 1, 16);
  EXPECT_TRUE(met(mesh, {}, mesh, {{}, {1.999, 0, 0}}));
  EXPECT_FALSE(met(mesh, {}, mesh, {{}, {2.001, 0, 0}}));
  EXPECT_TRUE(met(mesh, {}, mesh, {{}, {0, 5.999, 0}}));
  EXPECT_FALSE(met(mesh, {}, mesh, {{}, {0, 6.003, 0}}));
  const Quaternion across = turn_deg({1, 0, 0}, 90);
  EXPECT_TRUE(met(mesh, {}, mesh, {across, {1.999, 0, 0}})) << "crossed";
  EXPECT_FALSE(met(mesh, {}, mesh, {across, {2.001, 0, 0}}));
  EXPECT_FALSE(met(mesh, {}, mesh, {turn_deg({1, 0, 0}, 1e-9), {2.001, 0, 0}})) << "nearly parallel";
}

// Segments along one line, of which one has no length.
TEST(CapsuleMethod, TakesBallsAndPoints) {
  const Mesh ball = geometry::sphere("ball", 1, 16);
  Mesh point;
  point.vertices = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  point.triangles = {{0, 1, 2}};
  EXPECT_TRUE(met(ball, {}, point, {{}, {0.99, 0, 0}}));
  EXPECT_FALSE(met(ball, {}, point, {{}, {1.01, 0, 0}}));
  EXPECT_TRUE(met(point, {}, point, {}));
  EXPECT_FALSE(met(point, {}, point, {{}, {1e-6, 0, 0}}));
}

TEST(CapsuleMethod, BulgesOverTheFacesOfABox) {
  const Mesh slab = geometry::box("slab", {6, 0.2, 6}), ball = geometry::sphere("ball", 0.5, 8);
  EXPECT_TRUE(met(slab, {}, ball, {{}, {0, 3, 0}}));
  EXPECT_FALSE(truly_meet(slab, {}, ball, {{}, {0, 3, 0}}));
}

TEST(CapsuleMethod, MissesNothingThatGrazes) {
  int grazed = 0;
  SCOPED_TRACE("seed 61");
  grazing::each_pair(61, 40, [&](const Setting& pair) {
    ++grazed;
    EXPECT_EQ(hits("capsule", pair).size(), 1u);
  });
  EXPECT_GT(grazed, 15);
}

// Thin rods that nearly are the capsules' segments, nearly parallel: where the nearest points are hardly determined.
TEST(CapsuleMethod, MissesNothingOfNearlyParallelRods) {
  std::mt19937 random(62);
  SCOPED_TRACE("seed 62");
  const Mesh thin = rod(10, 1e-6);
  int grazed = 0;
  for (int round = 0; round < 60; ++round) {
    const Vec3 at = uniform_point(random, 100);
    const Quaternion turn = uniform_turn(random);
    const double tilt = std::pow(10, -1.0 - round % 12);
    const Quaternion tilted = geometry::normalised(turn * geometry::turn_about({0, 0, 1}, tilt));
    Setting pair = Setting().add(thin, {turn, at}).add(thin, {tilted, at});
    ASSERT_FALSE(truth(pair).empty());
    grazing::part(pair, uniform_point(random, 3));
    ++grazed;
    ASSERT_EQ(hits("capsule", pair).size(), 1u) << "round " << round;
  }
  EXPECT_GT(grazed, 50);
}

}  // namespace
}  // namespace algorithms
