#include "algorithms/parts/enclosing_ball.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tests/support/adversary.hpp"
#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using geometry::Vec3;

/// The distance in long doubles, whose rounding is 2^-11 of a double's.
long double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(static_cast<long double>(a.x()) - b.x(), static_cast<long double>(a.y()) - b.y(),
                    static_cast<long double>(a.z()) - b.z());
}

/// The smallest radius around points by trying the ball of every two, three and four of them.
double least_radius(const std::vector<Vec3>& p) {
  double least = std::numeric_limits<double>::infinity();
  const auto tried = [&](const Vec3& centre) {
    double radius = 0;
    for (const Vec3& v : p) radius = std::fmax(radius, (v - centre).norm());
    least = std::fmin(least, radius);
  };
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      tried(0.5 * (p[i] + p[j]));
      for (std::size_t k = 0; k < j; ++k) {
        // Equally far from three points and in their plane; or equally far from four.
        const Vec3 a = p[j] - p[i], b = p[k] - p[i], normal = a.cross(b);
        geometry::Mat3 equations;
        equations << a.transpose(), b.transpose(), normal.transpose();
        tried(p[i] + equations.inverse() * Vec3(0.5 * a.squaredNorm(), 0.5 * b.squaredNorm(), 0));
        for (std::size_t l = 0; l < k; ++l) {
          const Vec3 c = p[l] - p[i];
          equations.row(2) = c.transpose();
          tried(p[i] + equations.inverse() * Vec3(0.5 * a.squaredNorm(), 0.5 * b.squaredNorm(), 0.5 * c.squaredNorm()));
        }
      }
    }
  return least;
}

// Radii may be larger by 2^-49 of sizes and coordinates, which covers roundings.
TEST(EnclosingBall, OfABoxIsItsHalfDiagonalAboutItsMiddle) {
  const Ball ball = ball_around(setting::shifted_box({2, 4, 4}, {7, -1, 3}).vertices);
  EXPECT_NEAR(ball.radius, 3, 1e-13);
  EXPECT_NEAR((ball.centre - Vec3(7, -1, 3)).norm(), 0, 1e-7) << "the radius feels the square of it";
}

TEST(EnclosingBall, OfARegularTetrahedronReachesItsCorners) {
  const std::vector<Vec3> corners = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  EXPECT_NEAR(ball_around(corners).radius, std::sqrt(3.0), 1e-13);
}

TEST(EnclosingBall, OfAnObtuseTriangleIsAboutItsLongestEdge) {
  EXPECT_NEAR(ball_around(std::vector<Vec3>{{-2, 0, 0}, {2, 0, 0}, {0.5, 1, 0}}).radius, 2, 1e-13);
}

TEST(EnclosingBall, IsTheSmallestOfAll) {
  std::mt19937 random(41);
  SCOPED_TRACE("seed 41");
  for (int round = 0; round < 300; ++round) {
    std::vector<Vec3> points;
    for (int i = 0; i < 9; ++i) points.push_back(setting::uniform_point(random, 3));
    ASSERT_NEAR(ball_around(points).radius, least_radius(points), 1e-12) << "round " << round;
  }
}

// Slivers, needles and points, of size 1e-310 to 1e150, some far from their own origin.
TEST(EnclosingBall, HoldsEveryPointWhateverTheMesh) {
  tests::Random random;
  SCOPED_TRACE(tests::kSeed);
  for (int round = 0; round < 3000; ++round) {
    const geometry::Mesh mesh = adversary::mesh(random);
    const Ball ball = ball_around(mesh.vertices);
    const double diagonal = 2 * geometry::local_box(mesh).half_size().stableNorm();
    for (const Vec3& v : mesh.vertices) ASSERT_LE(distance(v, ball.centre), ball.radius) << "round " << round;
    ASSERT_LE(ball.radius, 0.5 * diagonal * (1 + 1e-9) + 1e-12 * mesh.vertices[0].stableNorm()) << "round " << round;
  }
}

TEST(EnclosingBall, OfOnePlaceIsAPoint) {
  const Ball ball = ball_around(std::vector<Vec3>(5, Vec3(1, 2, 3)));
  EXPECT_EQ(ball.centre, Vec3(1, 2, 3));
  EXPECT_LT(ball.radius, 1e-13);
}

}  // namespace
}  // namespace algorithms
