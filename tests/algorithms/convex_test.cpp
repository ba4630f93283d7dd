// Convex solids against linear programming in exact numbers, and against known gaps.
#include "algorithms/parts/convex.hpp"

#include <gtest/gtest.h>

#include "geometry/meshes/shapes.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/programming.hpp"

namespace {

using namespace geometry;
using tests::Random;

bool met(const Convex& a, const Pose& at_a, const Convex& b, const Pose& at_b) {
  std::uint64_t operations = 0;
  const bool there = convex_meet(placed(a, at_a), placed(b, at_b), operations);
  EXPECT_EQ(convex_meet(placed(b, at_b), placed(a, at_a), operations), there) << "the other way round";
  EXPECT_GT(operations, 0u);
  return there;
}

std::vector<Vec3> world(const std::vector<Vec3>& points, const Pose& pose) {
  std::vector<Vec3> out(points.size());
  to_world(pose, points, out);
  return out;
}

std::vector<Vec3> grid_points(Random& random, int size) {
  std::vector<Vec3> out;
  const int count = random.integer(1, 8);
  for (int i = 0; i < count; ++i) out.push_back(random.grid_point(size));
  if (random.below(4) == 0)
    for (Vec3& p : out) p.z() = 1;
  return out;
}

// Solids, polygons, segments and points whose corners are small integers: they touch often, and what is apart is so by
// far more than rounding, so the answer has to be right both ways.
TEST(Convex, AnswersExactlyOnGrids) {
  Random random;
  SCOPED_TRACE(testing::Message() << "seed " << tests::kSeed);
  int met_count = 0;
  constexpr int kRounds = 1500;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Vec3> p = grid_points(random, 2), q = grid_points(random, 2);
    const Pose at{{}, random.grid_point(3)};
    const bool truly = programming::hulls_meet(p, world(q, at));
    ASSERT_EQ(met(convex_of(p), {}, convex_of(q), at), truly) << "round " << round;
    met_count += truly;
  }
  EXPECT_GT(met_count, kRounds / 8);
  EXPECT_LT(met_count, kRounds * 7 / 8);
}

// The farthest corner of one on the farthest of the other, but for rounding, which falls either way. A miss is never
// allowed, whatever the sizes; a false alarm only within the margin.
TEST(Convex, MissesNothingNearTouching) {
  Random random(5);
  int met_count = 0, apart_count = 0;
  for (int round = 0; round < 45; ++round) {
    const Mesh a = adversary::mesh(random), b = adversary::mesh(random);
    const Convex s = convex_of(a.vertices), t = convex_of(b.vertices);
    const Pose at_a = adversary::pose(random, s.around.reach);
    Pose at_b{adversary::quaternion(random), {0, 0, 0}};
    const std::vector<Vec3> p = world(a.vertices, at_a), q = world(b.vertices, at_b);
    const Vec3 d = random.point();
    const auto farthest = [](const std::vector<Vec3>& points, const Vec3& way) {
      return *std::ranges::max_element(points, {}, [&](const Vec3& v) { return way.dot(v); });
    };
    at_b.t = farthest(p, d) - farthest(q, -d);
    for (int k = 0; k < 3; ++k) {
      const bool truly = programming::hulls_meet(p, world(b.vertices, at_b));
      const bool found = met(s, at_a, t, at_b);
      EXPECT_LE(truly, found) << "round " << round;
      met_count += truly;
      apart_count += !truly;
      for (int i = 0; i < 3; ++i) at_b.t[i] = std::nextafter(at_b.t[i], 1e300);
    }
  }
  EXPECT_GT(met_count, 15);
  EXPECT_GT(apart_count, 15);
}

TEST(Convex, SeesGapsLittleAboveTheMargin) {
  const Convex cube = convex_of(box("cube", {2, 2, 2}).vertices);
  Random random(6);
  for (int round = 0; round < 200; ++round) {
    const Quaternion q = random.turn();
    // A face, an edge or a corner of one against the same of the other.
    const int axes = 1 + round % 3;
    Vec3 normal = Vec3::Zero(), slide = 0.5 * random.point();
    for (int i = 0; i < axes; ++i) normal[i] = 1, slide[i] = 0;
    const Mat3 r = rotation(q);
    const auto at = [&](double gap) { return Pose{q, to_world(r, Vec3::Zero(), (2 + gap) * normal + slide)}; };
    EXPECT_TRUE(met(cube, {q, {0, 0, 0}}, cube, at(-1e-15)));
    EXPECT_FALSE(met(cube, {q, {0, 0, 0}}, cube, at(2e-12))) << "round " << round;
  }
}

TEST(Convex, RoundSolidsMeetWhenTheirFacetsDo) {
  const Mesh mesh = sphere("sphere", 1, 4);
  const Convex ball = convex_of(mesh.vertices);
  EXPECT_GT(ball.inner, 0.9);
  Random random(7);
  for (int round = 0; round < 5; ++round) {
    const Pose a{random.turn(), {0, 0, 0}}, b{random.turn(), random.point().normalized() * (1.9 + 0.1 * random.real())};
    // Between the inner and the outer balls the exact answer decides.
    EXPECT_EQ(met(ball, a, ball, b), programming::hulls_meet(world(mesh.vertices, a), world(mesh.vertices, b)))
        << "round " << round;
  }
}

TEST(Convex, GrowsWhenEnlarged) {
  const Convex cube = convex_of(box("cube", {2, 2, 2}).vertices);
  std::uint64_t operations = 0;
  const Pose apart{{}, {2.1, 0, 0}};
  EXPECT_FALSE(convex_meet(placed(cube, {}), placed(cube, apart), operations));
  EXPECT_TRUE(convex_meet(placed(cube, {}, 0.02), placed(cube, apart, 0.02), operations));
}

}  // namespace
