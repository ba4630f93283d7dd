// Facet points: sampling, densifying, triangles of points, placing.
#include "algorithms/parts/facets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>

#include "geometry/meshes/shapes.hpp"

namespace geometry {
namespace {

Mesh one_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  Mesh mesh;
  mesh.name = "triangle";
  mesh.vertices = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// A row of triangles, facet i with its point at (i, 0, 0).
Mesh row(int facets) {
  Mesh mesh;
  mesh.name = "row";
  for (int i = 0; i < facets; ++i) {
    const auto v = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {Vec3(i - 1, -1, 0), Vec3(i + 1, -1, 0), Vec3(i, 2, 0)});
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  return mesh;
}

double area(const Mesh& mesh, const Facet& f) {
  const Vec3 &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
  const Vec3 u = b - a, v = c - a;
  const Vec3 n(u.y() * v.z() - u.z() * v.y(), u.z() * v.x() - u.x() * v.z(), u.x() * v.y() - u.y() * v.x());
  return 0.5 * n.norm();
}

TEST(Facets, PointIsTheBarycentre) {
  const Mesh mesh = one_triangle({0, 0, 0}, {3, 0, 6}, {0, 9, 3});
  EXPECT_EQ(facet_point(mesh, mesh.triangles[0]), Vec3(1, 3, 3));
}

TEST(Facets, SamplesEveryStridethFacetFromTheFirst) {
  EXPECT_EQ(facet_points(row(7), 3).x, (std::vector<double>{0, 3, 6}));
  EXPECT_EQ(facet_points(row(6), 3).x, (std::vector<double>{0, 3}));
  EXPECT_EQ(facet_points(row(4), 1).x, (std::vector<double>{0, 1, 2, 3}));
}

TEST(Facets, StrideBeyondTheLastFacetLeavesTheFirst) {
  EXPECT_EQ(facet_points(row(4), 4).x, std::vector<double>{0});
  EXPECT_EQ(facet_points(row(4), 5).x, std::vector<double>{0});
  EXPECT_EQ(facet_points(row(4), std::numeric_limits<std::size_t>::max()).x, std::vector<double>{0});
}

TEST(Facets, MeshWithoutFacetsHasNoPoints) { EXPECT_EQ(facet_points(Mesh{}, 1).size(), 0u); }

TEST(Facets, InflatesAboutTheOriginNotAboutTheMiddle) {
  Points points;
  points.add({1, 2, -3});
  points.add({2, 2, -3});
  const Points larger = inflated(points, 1.5);
  EXPECT_EQ(larger.at(0), Vec3(1.5, 3, -4.5));
  EXPECT_EQ(larger.at(1), Vec3(3, 3, -4.5));
}

TEST(Facets, SurfaceIsThatOfTheVertexBox) {
  EXPECT_EQ(box_surface(box("box", {1, 2, 3})), 22);
  EXPECT_EQ(box_surface(one_triangle({0, 0, 0}, {3, 0, 0}, {0, 4, 0})), 24);  // two sides of 12
  EXPECT_EQ(box_surface(one_triangle({1, 0, 0}, {3, 0, 0}, {7, 0, 0})), 0);   // a line
}

// A unit cube has 12 facets and a surface of 6: at 8 per m^2 it wants 48, which is exactly 12 * 2^2.
TEST(Facets, DensifiesNoFurtherThanNeeded) {
  const Mesh cube = box("cube", {1, 1, 1});
  EXPECT_EQ(densified(cube, 8).triangles.size(), 48u);
  EXPECT_EQ(densified(cube, 8.001).triangles.size(), 12u * 9);
  EXPECT_EQ(densified(cube, 7.999).triangles.size(), 48u);
  EXPECT_EQ(densified(cube, 2).triangles.size(), 12u);
  EXPECT_EQ(densified(cube, 2).vertices.size(), cube.vertices.size());
}

TEST(Facets, CutsRowByRowFromTheFirstCorner) {
  const Vec3 first(0, 0, 0), second(6, 0, 0), third(0, 6, 0);
  const Mesh dense = densified(one_triangle(first, second, third), 9.0 / 72);  // surface 72: nine facets, m = 3
  const auto at = [](int k, int j) { return Vec3(2 * (k - j), 2 * j, 0); };
  const std::vector<std::array<Vec3, 3>> expected = {
      {at(0, 0), at(1, 0), at(1, 1)}, {at(1, 0), at(2, 0), at(2, 1)}, {at(1, 0), at(2, 1), at(1, 1)},
      {at(1, 1), at(2, 1), at(2, 2)}, {at(2, 0), at(3, 0), at(3, 1)}, {at(2, 0), at(3, 1), at(2, 1)},
      {at(2, 1), at(3, 1), at(3, 2)}, {at(2, 1), at(3, 2), at(2, 2)}, {at(2, 2), at(3, 2), at(3, 3)}};
  ASSERT_EQ(dense.triangles.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    for (int corner = 0; corner < 3; ++corner)
      EXPECT_EQ(dense.vertices[dense.triangles[i][corner]], expected[i][corner]) << i << ' ' << corner;
}

TEST(Facets, DenseFacetsAreEqualPartsOfTheirFacet) {
  const Mesh whole = one_triangle({0.3, -1, 2}, {4, 0.7, 1}, {-1, 3, 0.9});
  const Mesh dense = densified(whole, 4);
  const double part = area(whole, whole.triangles[0]) / static_cast<double>(dense.triangles.size());
  ASSERT_GT(dense.triangles.size(), 16u);
  for (const Facet& facet : dense.triangles) EXPECT_NEAR(area(dense, facet), part, 1e-13);
}

// Points of an edge are made from both of its facets; if the bits differed, a crack would open. Closed means here:
// every directed edge between equal points has its opposite.
TEST(Facets, DenseMeshOfAClosedMeshHasNoCracks) {
  const Mesh sphere_mesh = sphere("sphere", 0.7, 3);
  const Mesh dense = densified(
      sphere_mesh, 7.0 * 7 * static_cast<double>(sphere_mesh.triangles.size()) / box_surface(sphere_mesh) * 0.999);
  ASSERT_EQ(dense.triangles.size(), 49 * sphere_mesh.triangles.size());
  std::map<std::array<double, 6>, int> edges;
  for (const Facet& f : dense.triangles)
    for (int i = 0; i < 3; ++i) {
      const Vec3 &p = dense.vertices[f[i]], &q = dense.vertices[f[(i + 1) % 3]];
      ++edges[{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0, q.x() + 0.0, q.y() + 0.0, q.z() + 0.0}];
    }
  for (const auto& [e, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({e[3], e[4], e[5], e[0], e[1], e[2]}), 1u) << "a crack at " << e[0] << ' ' << e[1];
  }
}

TEST(Facets, DensifyingKeepsCornersBitForBit) {
  const Mesh whole = one_triangle({0.1, 0.2, 0.3}, {1.1, 0.7, 1 / 3.0}, {-0.9, 3.3, 0.9});
  const Mesh dense = densified(whole, 3);
  for (const Vec3& corner : whole.vertices)
    EXPECT_NE(std::find(dense.vertices.begin(), dense.vertices.end(), corner), dense.vertices.end());
  EXPECT_EQ(box_surface(dense), box_surface(whole));
}

TEST(Facets, MeshWithoutBoxSurfaceIsDenseEnough) {
  const Mesh line = one_triangle({0, 0, 0}, {1, 0, 0}, {9, 0, 0});
  EXPECT_EQ(densified(line, 1e6).triangles.size(), 1u);
  EXPECT_EQ(densified(Mesh{}, 8).triangles.size(), 0u);
}

TEST(Facets, RefusesToFillTheMemory) {
  const Mesh wall = box("wall", {1e4, 1, 1e4});
  try {
    densified(wall, 1e3);
    FAIL() << "2e11 facets were not refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'wall'"), std::string::npos) << error.what();
  }
  EXPECT_THROW(densified(box("huge", {1e200, 1e200, 1e200}), 8), std::invalid_argument);
}

TEST(Facets, StrideLeavesTheWantedDensity) {
  EXPECT_EQ(stride_of_density(1224, 8, 24), 6u);  // 6.375
  EXPECT_EQ(stride_of_density(1152, 8, 24), 6u);  // exactly 6
  EXPECT_EQ(stride_of_density(1151, 8, 24), 5u);
  EXPECT_EQ(stride_of_density(12, 8, 24), 1u);  // too few already
}

TEST(Facets, StrideIsDefinedForEverySurface) {
  EXPECT_EQ(stride_of_density(12, 8, 0), 1u);  // no surface, no quotient: nothing is given up
  EXPECT_EQ(stride_of_density(12, 8, 1e-300), 12u);
  EXPECT_EQ(stride_of_density(12, 1e-9, 5e-324), 1u);  // the product underflows to no surface
  EXPECT_EQ(stride_of_density(12, 8, std::numeric_limits<double>::infinity()), 1u);
  EXPECT_EQ(stride_of_density(0, 8, 24), 1u);
}

TEST(Facets, TrianglesAreOfConsecutivePoints) {
  using List = std::vector<std::uint32_t>;
  EXPECT_EQ(sampled_triangles(7, Triangulation::disjoint), (List{0, 3}));
  EXPECT_EQ(sampled_triangles(9, Triangulation::disjoint), (List{0, 3, 6}));
  EXPECT_EQ(sampled_triangles(7, Triangulation::strip), (List{0, 1, 2, 3, 4}));
  EXPECT_EQ(sampled_triangles(3, Triangulation::strip), (List{0}));
}

TEST(Facets, FewerThanThreePointsMakeNoTriangle) {
  for (const std::size_t points : {0, 1, 2})
    for (const Triangulation kind : {Triangulation::disjoint, Triangulation::strip})
      EXPECT_TRUE(sampled_triangles(points, kind).empty()) << points;
}

TEST(Facets, BallHoldsItsPoints) {
  const std::uint64_t seed = 71;
  SCOPED_TRACE(seed);
  std::mt19937_64 engine(seed);
  for (int i = 0; i < 300; ++i) {
    std::uniform_real_distribution<double> value(-std::pow(10, i % 7 - 3), std::pow(10, i % 5 - 2));
    Points points;
    for (int k = 0; k <= i % 9; ++k) {
      const double x = value(engine), y = value(engine), z = value(engine);
      points.add({x, y, z});
    }
    const Ball ball = ball_around(points);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3 d = points.at(k) - ball.centre;
      const long double squared = static_cast<long double>(d.x()) * d.x() + static_cast<long double>(d.y()) * d.y() +
                                  static_cast<long double>(d.z()) * d.z();
      EXPECT_LE(std::sqrt(squared), static_cast<long double>(ball.radius));
    }
  }
}

Bodies two_rows() {
  Bodies bodies;
  bodies.meshes = {row(3), row(5)};
  bodies.name = {"a", "b", "c"};
  bodies.mesh = {0, 1, 0};
  bodies.fixed = {0, 0, 0};
  return bodies;
}

TEST(PlacedPoints, AreTheLocalPointsByToWorld) {
  const Bodies bodies = two_rows();
  PlacedPoints placed(bodies, {facet_points(bodies.meshes[0], 1), facet_points(bodies.meshes[1], 2)});
  EXPECT_EQ(placed.most(), 3u);
  const Pose pose{.q = normalised({0.3, -0.2, 0.8, 0.1}), .t = {0.1, -7, 3}};
  placed.prepare(std::array{unborn(), pose, unborn()});
  EXPECT_TRUE(placed.place(1));
  ASSERT_EQ(placed[1].size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(placed[1].at(i), to_world(rotation(pose.q), pose.t, Vec3(2 * i, 0, 0))) << i;
}

TEST(PlacedPoints, ArePlacedOnceAStep) {
  const Bodies bodies = two_rows();
  PlacedPoints placed(bodies, {facet_points(bodies.meshes[0], 1), facet_points(bodies.meshes[1], 1)});
  std::array<Pose, 3> poses;
  placed.prepare(poses);
  EXPECT_TRUE(placed.place(0));
  EXPECT_FALSE(placed.place(0));
  poses[0].t = {0, 0, 5};
  placed.prepare(poses);
  EXPECT_TRUE(placed.place(0));
  EXPECT_EQ(placed[0].at(1), Vec3(1, 0, 5));
}

}  // namespace
}  // namespace geometry
