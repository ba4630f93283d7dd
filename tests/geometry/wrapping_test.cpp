#include "geometry/decision/wrapping.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "geometry/bodies.hpp"
#include "geometry/meshes/shapes.hpp"
#include "tests/support/random.hpp"

namespace geometry {
namespace {

Mesh cube(double side) { return box("cube", {side, side, side}); }

Mesh at(Mesh mesh, const Vec3& by) {
  for (Vec3& v : mesh.vertices) v += by;
  return mesh;
}

TEST(OutsideBalls, CountsCornersAndTellsHowFar) {
  const ContactBall ball{{0, 0, 0}, 1};
  const Wrapping all = outside_balls(cube(2), std::vector{ball});
  EXPECT_EQ(all.outside_share, 1);
  EXPECT_NEAR(all.outside_greatest, std::sqrt(3.0) - 1, 1e-14);
  EXPECT_GE(all.outside_greatest, std::sqrt(3.0) - 1) << "an upper bound";
  // One more ball about a corner takes that corner in, and only it.
  const Wrapping seven = outside_balls(cube(2), std::vector{ball, ContactBall{{1, 1, 1}, 0.1}});
  EXPECT_EQ(seven.outside_share, 7.0 / 8);
}

TEST(OutsideBalls, DoesNotCountWhatIsOnTheBall) {
  EXPECT_EQ(outside_balls(cube(2), std::vector{ContactBall{{0, 0, 0}, std::sqrt(3.0)}}).outside_share, 0);
  EXPECT_EQ(outside_balls(box("b", {2, 4, 4}), std::vector{ContactBall{{0, 0, 0}, 3}}).outside_greatest, 0);
}

TEST(OutsideCapsule, CountsWhatIsFartherFromTheSegment) {
  const Wrapping found = outside_capsule(box("rod", {6, 0.2, 0.2}), {{-2, 0, 0}, 0.5}, {{2, 0, 0}, 0.5});
  EXPECT_EQ(found.outside_share, 1) << "the ends of the rod";
  EXPECT_NEAR(found.outside_greatest, std::sqrt(1.02) - 0.5, 1e-12);
  EXPECT_EQ(outside_capsule(box("rod", {4, 0.2, 0.2}), {{-2, 0, 0}, 0.5}, {{2, 0, 0}, 0.5}).outside_share, 0);
}

TEST(OutsideSolids, KnowsFaceEdgeAndCornerDistances) {
  const std::vector<Mesh> solid{cube(2)};
  const auto greatest = [&](const Vec3& point) {
    Mesh one;
    one.vertices = {point};
    return outside_solids(one, solid, kClosedWithin).outside_greatest;
  };
  EXPECT_NEAR(greatest({1.5, 0.2, 0}), 0.5, 1e-13);
  EXPECT_NEAR(greatest({1.3, 1.4, 0}), 0.5, 1e-13);
  EXPECT_NEAR(greatest({2, 3, 3}), 3, 1e-13);
  EXPECT_EQ(greatest({0.3, 0.2, 0.1}), 0);
}

// A vertex on a face, an edge or a corner is not outside; the next double is.
TEST(OutsideSolids, IsExactOnTheSurface) {
  const std::vector<Mesh> solid{cube(2)};
  Mesh mesh;
  mesh.vertices = {{1, 0.3, 0.1}, {1, 1, 0.1}, {1, 1, 1}, {std::nextafter(1, 2), 0.3, 0.1}};
  const Wrapping found = outside_solids(mesh, solid, kClosedWithin);
  EXPECT_EQ(found.outside_share, 0.25);
  EXPECT_GT(found.outside_greatest, 0);
  EXPECT_LT(found.outside_greatest, 1e-13);
}

TEST(OutsideSolids, TakesSolidsTogether) {
  const std::vector<Mesh> two{cube(2), at(cube(2), {1.5, 0, 0})};
  EXPECT_EQ(outside_solids(at(box("b", {3.4, 1, 1}), {0.75, 0, 0}), two, kClosedWithin).outside_share, 0);
  EXPECT_EQ(outside_solids(at(box("b", {4, 1, 1}), {1, 0, 0}), two, kClosedWithin).outside_share, 0.5);
}

TEST(OutsideSolids, HasNoInsideWhereItIsOpen) {
  Mesh open = cube(2);
  open.triangles.resize(11);
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {-1, -1, -1}};
  const Wrapping found = outside_solids(mesh, std::vector{open}, kClosedWithin);
  EXPECT_EQ(found.outside_share, 0.5);
  EXPECT_NEAR(found.outside_greatest, 1, 1e-13);
}

TEST(OutsideSolids, IsAnUpperBoundByLittle) {
  tests::Random random;
  SCOPED_TRACE(tests::kSeed);
  const Mesh ball = sphere("ball", 1, 6);
  for (int i = 0; i < 60; ++i) {
    Mesh mesh;
    mesh.vertices = {2 * random.point()};
    const double found = outside_solids(mesh, std::vector{ball}, kClosedWithin).outside_greatest;
    // Every facet of a convex solid bounds the distance from below by its plane, points of the facets from above.
    double below = 0, above = 1e9;
    for (const Facet& f : ball.triangles) {
      const Vec3 &a = ball.vertices[f[0]], &b = ball.vertices[f[1]], &c = ball.vertices[f[2]];
      const Vec3 normal = (b - a).cross(c - a);
      if (normal.norm() > 0) below = std::fmax(below, normal.normalized().dot(mesh.vertices[0] - a));
      for (int s = 0; s <= 20; ++s)
        for (int t = 0; s + t <= 20; ++t)
          above = std::fmin(above, (a + s / 20.0 * (b - a) + t / 20.0 * (c - a) - mesh.vertices[0]).norm());
    }
    if (below == 0) above = 0;
    ASSERT_GE(found, below * (1 - 1e-12)) << i;
    ASSERT_LE(found, above + 1e-12) << i;
  }
}

}  // namespace
}  // namespace geometry
