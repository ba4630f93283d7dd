// Facts about a mesh: closedness by vertex indices, extents, the ball inside.
#include "geometry/mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/meshes/shapes.hpp"

namespace geometry {
namespace {

/// A regular tetrahedron about the origin; its facets' planes are 1 / sqrt(3) away.
Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.triangles = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
  return mesh;
}

Mesh moved(Mesh mesh, const Vec3& by) {
  for (Vec3& v : mesh.vertices) v += by;
  return mesh;
}

TEST(IsClosed, HoldsForATetrahedronAndForTwo) {
  Mesh mesh = tetrahedron();
  EXPECT_TRUE(is_closed(mesh));
  for (const Vec3& v : tetrahedron().vertices) mesh.vertices.push_back(v + Vec3(5, 0, 0));
  for (const auto& [a, b, c] : tetrahedron().triangles) mesh.triangles.push_back({a + 4, b + 4, c + 4});
  EXPECT_TRUE(is_closed(mesh));
}

TEST(IsClosed, FailsWithAFacetMissingTurnedOrTwice) {
  Mesh missing = tetrahedron();
  missing.triangles.pop_back();
  EXPECT_FALSE(is_closed(missing));
  Mesh turned = tetrahedron();
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_FALSE(is_closed(turned));
  Mesh twice = tetrahedron();
  twice.triangles.push_back(twice.triangles[0]);
  EXPECT_FALSE(is_closed(twice));
}

// Four facets at one edge: two tetrahedra that share it. Each pair would close, the edge is not one of two facets.
TEST(IsClosed, FailsForAnEdgeOfFourFacets) {
  Mesh mesh = tetrahedron();
  mesh.vertices.insert(mesh.vertices.end(), {{5, 1, 1}, {5, -1, -1}});
  mesh.triangles.insert(mesh.triangles.end(), {{1, 5, 4}, {0, 4, 5}, {0, 5, 1}, {0, 1, 4}});
  EXPECT_FALSE(is_closed(mesh));
}

TEST(IsClosed, DoesNotWeldDoubledVertices) {
  Mesh mesh = tetrahedron();
  mesh.vertices.push_back(mesh.vertices[0]);
  mesh.triangles[1][0] = 4;
  EXPECT_FALSE(is_closed(mesh));
}

TEST(IsClosed, FailsForAFacetThatNamesAVertexTwiceAndWithoutFacets) {
  Mesh mesh = tetrahedron();
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_FALSE(is_closed(mesh));
  EXPECT_FALSE(is_closed(Mesh{}));
}

TEST(Extents, AreThoseOfTheVertices) {
  Mesh mesh;
  mesh.vertices = {{1, -2, 0}, {-3, 1, 0.5}};
  EXPECT_EQ(local_box(mesh).min, Vec3(-3, -2, 0));
  EXPECT_EQ(local_box(mesh).max, Vec3(1, 1, 0.5));
  EXPECT_EQ(half_extents(mesh), Vec3(3, 2, 0.5));
}

TEST(InscribedRadius, IsThatOfTheBallInsideATetrahedronAndABox) {
  const double exact = 1 / std::sqrt(3.0);
  EXPECT_LE(inscribed_radius(tetrahedron()), exact);
  EXPECT_NEAR(inscribed_radius(tetrahedron()), exact, 1e-13 * exact);
  const Mesh slab = box("slab", {10, 1, 6});
  EXPECT_LE(inscribed_radius(slab), 0.5);
  EXPECT_NEAR(inscribed_radius(slab), 0.5, 1e-13);
  const Mesh off_centre = moved(slab, {0, 0.25, 0});
  EXPECT_NEAR(inscribed_radius(off_centre), 0.25, 1e-13);
}

TEST(InscribedRadius, IsZeroWithTheOriginOnOrBeyondAPlane) {
  EXPECT_EQ(inscribed_radius(moved(box("cube", {1, 1, 1}), {0.5, 0, 0})), 0);
  EXPECT_EQ(inscribed_radius(moved(box("cube", {1, 1, 1}), {2, 0, 0})), 0);
  EXPECT_EQ(inscribed_radius(torus("ring", 4, 1, 16)), 0);
  EXPECT_EQ(inscribed_radius(Mesh{}), 0);
}

TEST(InscribedRadius, IsZeroWithAFacetWithoutArea) {
  Mesh mesh = tetrahedron();
  mesh.vertices.push_back(0.5 * (mesh.vertices[0] + mesh.vertices[1]));
  mesh.triangles.push_back({0, 4, 1});
  EXPECT_EQ(inscribed_radius(mesh), 0);
}

TEST(InscribedRadius, ScalesWithTheMesh) {
  for (const double scale : {1e-60, 1e-6, 1e6, 1e60}) {
    Mesh mesh = tetrahedron();
    for (Vec3& v : mesh.vertices) v *= scale;
    EXPECT_LE(inscribed_radius(mesh), scale / std::sqrt(3.0));
    EXPECT_NEAR(inscribed_radius(mesh) / scale, 1 / std::sqrt(3.0), 1e-13);
  }
}

// Never up: against planes computed in numbers with 11 more digits, for slivers and planes close to the origin too.
TEST(InscribedRadius, NeverExceedsTheDistanceOfAPlane) {
  constexpr unsigned kSeed = 41;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-12, 0);
  int positive = 0;
  for (int i = 0; i < 100000; ++i) {
    Mesh mesh;
    const auto point = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    const Vec3 first = point(), along = point(), across = point();
    mesh.vertices = {first, first + along, first + along + std::pow(10.0, exponent(random)) * across};
    mesh.triangles = {{0, 1, 2}};
    using Real = long double;
    const auto real = [&](int v, int axis) { return static_cast<Real>(mesh.vertices[v][axis]); };
    Real e[3], f[3], n[3], height = 0, square = 0;
    for (int k = 0; k < 3; ++k) e[k] = real(1, k) - real(0, k), f[k] = real(2, k) - real(0, k);
    for (int k = 0; k < 3; ++k) n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    for (int k = 0; k < 3; ++k) height += n[k] * real(0, k), square += n[k] * n[k];
    const Real distance = height / std::sqrt(square);
    const double radius = inscribed_radius(mesh);
    ASSERT_LE(radius, std::fmax(Real{0}, distance)) << "triangle " << i;
    positive += radius > 0;
  }
  EXPECT_GT(positive, 40000);
}

}  // namespace
}  // namespace geometry
