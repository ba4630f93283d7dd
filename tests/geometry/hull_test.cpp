// Hulls: what a hull is, asked of every point and facet by exact orientations, also of flat, straight and repeated
// points.
#include "geometry/decision/hull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "geometry/decision/exact.hpp"
#include "geometry/meshes/shapes.hpp"
#include "tests/support/adversary.hpp"

namespace {

using namespace geometry;
using tests::Random;

/// What holds of every hull: corners are points, each once; a solid is closed, convex, and has no point in front.
void expect_hull(const Hull& hull, const std::vector<Vec3>& points, const std::string& what) {
  SCOPED_TRACE(what);
  ASSERT_TRUE(std::ranges::is_sorted(hull.corners));
  ASSERT_TRUE(std::ranges::adjacent_find(hull.corners) == hull.corners.end());
  Mesh mesh;
  for (const std::uint32_t i : hull.corners) mesh.vertices.push_back(points[i]);
  mesh.triangles = hull.triangles;
  if (hull.dimension < 2) {
    EXPECT_EQ(hull.corners.size(), static_cast<std::size_t>(hull.dimension + 1));
    EXPECT_TRUE(hull.triangles.empty());
    return;
  }
  EXPECT_EQ(degenerate_facets(mesh), 0u);
  if (hull.dimension == 2) {
    EXPECT_EQ(hull.triangles.size(), 2 * (hull.corners.size() - 2));
    return;
  }
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_EQ(hull.triangles.size(), 2 * hull.corners.size() - 4) << "Euler's formula";
  for (const auto& [a, b, c] : mesh.triangles)
    for (const Vec3& p : points) ASSERT_LE(orientation(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], p), 0);
}

std::vector<Vec3> corners_of(const Hull& hull, const std::vector<Vec3>& points) {
  std::vector<Vec3> out;
  for (const std::uint32_t i : hull.corners) out.push_back(points[i]);
  std::ranges::sort(out, [](const Vec3& p, const Vec3& q) {
    return std::tuple(p.x(), p.y(), p.z()) < std::tuple(q.x(), q.y(), q.z());
  });
  return out;
}

TEST(Hull, OfACubeWithPointsInItsFacesIsItsCorners) {
  std::vector<Vec3> points;
  for (int x = 0; x <= 3; ++x)
    for (int y = 0; y <= 3; ++y)
      for (int z = 0; z <= 3; ++z) points.push_back(Vec3(x, y, z));
  const Hull hull = convex_hull(points);
  expect_hull(hull, points, "grid");
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(3, 3, 3), Vec3(3, 0, 3)})
    EXPECT_TRUE(std::ranges::any_of(corners_of(hull, points), [&](const Vec3& q) { return p == q; }));
  EXPECT_TRUE(std::ranges::none_of(corners_of(hull, points), [&](const Vec3& q) { return q == Vec3(1, 1, 1); }));
}

TEST(Hull, OfConvexShapesHasAllTheirVertices) {
  for (const Mesh& mesh : {sphere("sphere", 1, 16), box("box", {1, 2, 3}), capsule("capsule", 3, 0.6, 0.6, 8)}) {
    const Hull hull = convex_hull(mesh.vertices);
    expect_hull(hull, mesh.vertices, mesh.name);
    EXPECT_EQ(hull.dimension, 3);
  }
  EXPECT_EQ(convex_hull(sphere("sphere", 1, 16).vertices).corners.size(), sphere("sphere", 1, 16).vertices.size());
}

TEST(Hull, OfFewOrFlatPointsIsOfTheirDimension) {
  EXPECT_EQ(convex_hull({}).dimension, -1);
  const std::vector<Vec3> one(5, Vec3(1, 2, 3));
  EXPECT_EQ(convex_hull(one).corners, std::vector<std::uint32_t>{0});
  const std::vector<Vec3> line = {{2, 2, 2}, {1, 1, 1}, {5, 5, 5}, {3, 3, 3}, {5, 5, 5}};
  EXPECT_EQ(convex_hull(line).corners, (std::vector<std::uint32_t>{1, 2}));
  // A square with a point in the middle, two on edges and one twice, in a slanting plane and far from the origin.
  for (const double far : {0.0, 1e15})
    for (const Vec3& u : {Vec3(1, 0, 0), Vec3(1, 0, 1)}) {
      std::vector<Vec3> square;
      for (const auto& [i, j] : {std::pair{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1}, {1, 0}, {2, 1}, {2, 2}})
        square.push_back(i * u + Vec3(far, far + j, far));
      const Hull hull = convex_hull(square);
      EXPECT_EQ(hull.dimension, 2);
      EXPECT_EQ(hull.corners, (std::vector<std::uint32_t>{0, 1, 2, 3})) << far;
      EXPECT_EQ(hull.triangles.size(), 4u) << "two for either side";
    }
}

// Ties everywhere: points of a coarse grid, more of them than places, in any order.
TEST(Hull, OfGridPointsHoldsThemAllWhateverTheirOrder) {
  Random random;
  SCOPED_TRACE(testing::Message() << "seed " << tests::kSeed);
  std::array<int, 4> of_dimension{};
  for (int round = 0; round < 2000; ++round) {
    std::vector<Vec3> points;
    const int size = random.integer(1, 12), count = random.integer(1, 20);
    for (int i = 0; i < count; ++i) points.push_back(random.grid_point(1 + size / 4));
    if (round % 4 == 0)
      for (Vec3& p : points) p.z() = p.x() + p.y();
    if (round % 16 == 0)
      for (Vec3& p : points) p = p.x() * Vec3(1, 2, 3);
    const Hull hull = convex_hull(points);
    expect_hull(hull, points, "round " + std::to_string(round));
    ++of_dimension[hull.dimension];
    std::vector<Vec3> other = points;
    std::ranges::reverse(other);
    EXPECT_EQ(convex_hull(other).dimension, hull.dimension);
  }
  for (const int seen : of_dimension) EXPECT_GT(seen, 20);
}

// Slivers, needles, points far from the origin, of denormal and of huge size.
TEST(Hull, OfAdversariesHoldsThemAll) {
  Random random(3);
  for (int round = 0; round < 500; ++round) {
    const Mesh mesh = adversary::mesh(random);
    expect_hull(convex_hull(mesh.vertices), mesh.vertices, "round " + std::to_string(round));
  }
}

// Rounding puts points of a turned cube's faces and of a sphere a hair before or behind each other.
TEST(Hull, OfNearlyFlatFacesIsExact) {
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    const Pose pose{random.turn(), 10 * random.point()};
    std::vector<Vec3> grid;
    for (int x = 0; x <= 4; ++x)
      for (int y = 0; y <= 4; ++y)
        for (int z = 0; z <= 4; z += 4) grid.push_back(Vec3(x, y, z));
    std::vector<Vec3> world(grid.size());
    to_world(pose, grid, world);
    expect_hull(convex_hull(world), world, "round " + std::to_string(round));
  }
}

}  // namespace
