#include "algorithms/beyond/spheres.hpp"

#include <gtest/gtest.h>

#include "algorithms/beyond/covering_balls.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/grazing.hpp"

namespace algorithms {
namespace {

using namespace setting;

bool met(const Mesh& a, const Vec3& at_a, const Mesh& b, const Vec3& at_b, std::int64_t count) {
  return hit("spheres", a, {{}, at_a}, b, {{}, at_b}, {{"count", count}});
}

/// Whether one of the balls holds the point, in long doubles.
bool covered(const Vec3& p, const std::vector<Ball>& balls) {
  return std::ranges::any_of(balls, [&](const Ball& ball) {
    const long double x = static_cast<long double>(p.x()) - ball.centre.x(),
                      y = static_cast<long double>(p.y()) - ball.centre.y(),
                      z = static_cast<long double>(p.z()) - ball.centre.z();
    return std::hypot(x, y, z) <= ball.radius;
  });
}

/// Corners, middles of edges and points all over the facets.
void expect_covers(const Mesh& mesh, const std::vector<Ball>& balls, std::mt19937& random) {
  for (const Vec3& v : mesh.vertices) ASSERT_TRUE(covered(v, balls));
  for (const geometry::Facet& f : mesh.triangles)
    for (int i = 0; i < 12; ++i) {
      double s = 0.5 + 0.5 * uniform(random), t = 0.5 + 0.5 * uniform(random);
      if (i < 3) s = i == 1 ? 0 : 0.5, t = i == 0 ? 0 : 0.5;
      if (s + t > 1) s = 1 - s, t = 1 - t;
      const Vec3 &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
      ASSERT_TRUE(covered(a + (s * (b - a) + t * (c - a)), balls));
    }
}

// Half extents 1, 2, 2: the tightest ball has a radius of 3.
const Mesh kThree = geometry::box("three", {2, 4, 4});

TEST(Spheres, OneIsTheTightestBall) {
  EXPECT_TRUE(met(kThree, {0, 0, 0}, kThree, {6, 0, 0}, 1)) << "touching";
  EXPECT_TRUE(met(kThree, {0, 0, 0}, kThree, {6 - 1e-9, 0, 0}, 1));
  EXPECT_FALSE(met(kThree, {0, 0, 0}, kThree, {6 + 1e-9, 0, 0}, 1));
}

TEST(Spheres, OneIsAboutTheMiddleNotThePosition) {
  const Mesh off = shifted_box({2, 4, 4}, {5, 0, 0});
  EXPECT_FALSE(met(off, {0, 0, 0}, kThree, {-1.1, 0, 0}, 1));
  EXPECT_TRUE(hit("bounding_sphere", off, {}, kThree, {{}, {-1.1, 0, 0}})) << "H is about the position";
  EXPECT_TRUE(met(off, {0, 0, 0}, kThree, {10.9, 0, 0}, 1));
}

// A plate 12 x 0.2 x 12 has a ball of 8.5 m, or eight of 2 to 3 m.
TEST(Spheres, EightLieFlatterOnAPlateThanOne) {
  const Mesh plate = geometry::box("plate", {12, 0.2, 12}), ball = geometry::sphere("ball", 1, 8);
  EXPECT_TRUE(met(plate, {0, 0, 0}, ball, {0, 6, 0}, 1));
  EXPECT_FALSE(met(plate, {0, 0, 0}, ball, {0, 6, 0}, 8));
  EXPECT_TRUE(met(plate, {0, 0, 0}, ball, {0, 2, 0}, 8)) << "early all the same: a gap of 0.9 m";
  EXPECT_FALSE(truly_meet(plate, {}, ball, {{}, {0, 2, 0}}));
}

TEST(Spheres, NumberIsAtMostWhatIsAskedFor) {
  for (const Mesh& mesh : grazing::shapes())
    for (const std::size_t count : {1, 2, 3, 5, 8, 40})
      EXPECT_LE(covering_balls(mesh, count, geometry::kClosedWithin).balls.size(), count) << mesh.name;
  EXPECT_EQ(covering_balls(geometry::box("plate", {12, 0.2, 12}), 8, 0).balls.size(), 8u);
}

TEST(Spheres, OfASphereIsOneSinceMoreStickOut) {
  const Covering covering = covering_balls(geometry::sphere("sphere", 1, 16), 8, geometry::kClosedWithin);
  ASSERT_EQ(covering.balls.size(), 1u);
  EXPECT_NEAR(covering.balls[0].radius, 1, 1e-9);
}

TEST(Spheres, CoverEveryVertexAndFacet) {
  std::mt19937 random(51);
  SCOPED_TRACE("seed 51");
  for (const Mesh& mesh : grazing::shapes())
    for (const std::size_t count : {1, 2, 8, 64}) {
      SCOPED_TRACE(testing::Message() << mesh.name << ' ' << count);
      expect_covers(mesh, covering_balls(mesh, count, geometry::kClosedWithin).balls, random);
    }
}

TEST(Spheres, CoverSliversNeedlesAndPoints) {
  tests::Random adversaries;
  std::mt19937 random(52);
  SCOPED_TRACE(testing::Message() << "seeds 52 and " << tests::kSeed);
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    const Mesh mesh = adversary::mesh(adversaries);
    expect_covers(mesh, covering_balls(mesh, 8, geometry::kClosedWithin).balls, random);
  }
}

// A body inside a closed one is no miss either, however many balls there are: 64 on the walls alone would leave a hole.
TEST(Spheres, CoverTheInsideOfAClosedMesh) {
  std::mt19937 random(53);
  SCOPED_TRACE("seed 53");
  const Mesh room = geometry::box("room", {8, 6, 4}), ball = geometry::sphere("ball", 5, 10);
  const std::vector<Ball> of_room = covering_balls(room, 64, 0).balls, of_ball = covering_balls(ball, 64, 0).balls;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = uniform_point(random, 1);
    ASSERT_TRUE(covered(p.cwiseProduct(Vec3(4, 3, 2)), of_room));
    ASSERT_TRUE(p.norm() > 1 || covered(4.5 * p, of_ball));
  }
  const Mesh speck = geometry::box("speck", {1e-3, 1e-3, 1e-3});
  EXPECT_TRUE(met(room, {0, 0, 0}, speck, {0.7, 0.3, -0.9}, 64));
  EXPECT_FALSE(truly_meet(room, {}, speck, {{}, {0.7, 0.3, -0.9}})) << "their surfaces do not";
}

TEST(Spheres, LeaveTheMiddleOfARingFree) {
  const Mesh wide = ring(3, 0.2, 24), ball = geometry::sphere("ball", 0.5, 8);
  EXPECT_TRUE(met(wide, {0, 0, 0}, ball, {0, 0, 0}, 1));
  EXPECT_FALSE(met(wide, {0, 0, 0}, ball, {0, 0, 0}, 32));
}

TEST(Spheres, MissNothingThatGrazes) {
  int grazed = 0;
  for (const std::int64_t count : {1, 8}) {
    SCOPED_TRACE(testing::Message() << "seed 54, count " << count);
    grazing::each_pair(54, 30, [&](const Setting& pair) {
      ++grazed;
      EXPECT_EQ(hits("spheres", pair, {{"count", count}}).size(), 1u);
    });
  }
  EXPECT_GT(grazed, 20);
}

// Poses as far from unit as a motion can hold them; the tightest balls touch where the bodies do.
TEST(Spheres, MissNothingThatTouchesByItsFarthestPoints) {
  tests::Random random;
  SCOPED_TRACE(tests::kSeed);
  Mesh needle;
  needle.vertices = {{-1, 0, 0}, {1, 0, 0}, {0, 1e-3, 0}};
  needle.triangles = {{0, 1, 2}};
  for (int round = 0; round < 300; ++round) {
    Setting pair = Setting().add(needle, adversary::pose(random, 1)).add(needle, {adversary::quaternion(random), {}});
    const auto world = [&](int body, int v) {
      return geometry::to_world(geometry::rotation(pair.poses[body].q), pair.poses[body].t, needle.vertices[v]);
    };
    // Along one line, point against point, as near as rounding lets them.
    pair.poses[1].q = pair.poses[0].q;
    pair.poses[1].t = pair.poses[0].t;
    pair.poses[1].t += world(0, 1) - world(1, 0);
    if (truth(pair).empty()) continue;
    ASSERT_EQ(hits("spheres", pair, {{"count", std::int64_t{1}}}).size(), 1u) << "round " << round;
    ASSERT_EQ(hits("capsule", pair).size(), 1u) << "round " << round;
  }
}

TEST(Spheres, AreTheSameEveryTime) {
  const Mesh mesh = ring(2, 0.4, 12);
  const Covering once = covering_balls(mesh, 16, 0), again = covering_balls(mesh, 16, 0);
  ASSERT_EQ(once.balls.size(), again.balls.size());
  for (std::size_t i = 0; i < once.balls.size(); ++i) {
    EXPECT_EQ(once.balls[i].centre, again.balls[i].centre);
    EXPECT_EQ(once.balls[i].radius, again.balls[i].radius);
  }
}

}  // namespace
}  // namespace algorithms
