#include "algorithms/parts/simplified.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/decision/contain.hpp"
#include "geometry/meshes/shapes.hpp"
#include "geometry/vec.hpp"
#include "tests/support/adversary.hpp"

namespace {

using namespace geometry;

double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    sum += dot(mesh.vertices[i], cross(mesh.vertices[j], mesh.vertices[k])) / 6;
  return sum;
}

TEST(Simplified, KeepsClosedShapesClosedAndTheirVolume) {
  for (const Mesh& mesh : {sphere("sphere", 1, 16), capsule("capsule", 3, 0.6, 0.6, 16), torus("torus", 6, 1, 16),
                           torus_knot("knot", 1, 0.3, 64, 12, 2, 3)}) {
    SCOPED_TRACE(mesh.name);
    const std::size_t wanted = mesh.triangles.size() / 3;
    const Mesh less = simplified(mesh, wanted);
    EXPECT_LE(less.triangles.size(), wanted);
    EXPECT_GE(less.triangles.size(), wanted - 2);
    EXPECT_TRUE(is_closed(less));
    EXPECT_NEAR(volume(less) / volume(mesh), 1, 0.1);
    Box before = local_box(mesh), after = local_box(less);
    const double size = (before.max - before.min).norm();
    EXPECT_LT((before.min - after.min).norm() + (before.max - after.max).norm(), 0.15 * size);
  }
}

TEST(Simplified, TakesFlatFacesAwayWithoutAHair) {
  Mesh grid = box("cube", {2, 2, 2});
  for (int round = 0; round < 3; ++round) {  // every facet in four
    Mesh fine;
    for (const auto& [i, j, k] : grid.triangles) {
      const Vec3 &p = grid.vertices[i], &q = grid.vertices[j], &r = grid.vertices[k];
      const auto first = static_cast<std::uint32_t>(fine.vertices.size());
      for (const Vec3& v : {p, q, r, Vec3((p + q) / 2), Vec3((q + r) / 2), Vec3((r + p) / 2)})
        fine.vertices.push_back(v);
      for (const Facet& f : {Facet{0, 3, 5}, Facet{3, 1, 4}, Facet{5, 4, 2}, Facet{3, 4, 5}})
        fine.triangles.push_back({first + f[0], first + f[1], first + f[2]});
    }
    grid = fine;
  }
  ASSERT_EQ(grid.triangles.size(), 768u);
  const Mesh less = simplified(grid, 12);
  EXPECT_EQ(less.triangles.size(), 12u);
  EXPECT_NEAR(volume(less), 8, 1e-9);
}

TEST(Simplified, LeavesAsItIsWhatHasNoMoreFacets) {
  const Mesh cube = box("cube", {1, 2, 3});
  EXPECT_EQ(simplified(cube, 12).vertices, cube.vertices);
  EXPECT_EQ(simplified(cube, 100).triangles, cube.triangles);
}

// Slivers, points, doubled facets, a single facet, an open sheet: something comes back, with facets that name vertices
// that are there; facets without area alone leave none.
TEST(Simplified, TakesWhateverAMeshIs) {
  tests::Random random(11);
  for (int round = 0; round < 100; ++round) {
    Mesh mesh = adversary::mesh(random);
    mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
    const Mesh less = simplified(mesh, std::size_t(random.integer(0, 5)));
    for (const Facet& f : less.triangles)
      for (const std::uint32_t v : f) ASSERT_LT(v, less.vertices.size());
  }
  Mesh point;
  point.vertices = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  point.triangles = {{0, 1, 2}, {0, 0, 0}};
  EXPECT_TRUE(simplified(point, 1).triangles.empty());
  Mesh sheet;  // open: its border stays
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 8; ++j) sheet.vertices.push_back(Vec3(i, j, 0));
  for (std::uint32_t i = 0; i < 8; ++i)
    for (std::uint32_t j = 0; j < 8; ++j) {
      const std::uint32_t v = 9 * i + j;
      sheet.triangles.push_back({v, v + 9, v + 1});
      sheet.triangles.push_back({v + 1, v + 9, v + 10});
    }
  const Box box = local_box(simplified(sheet, 8));
  EXPECT_NEAR(box.min.norm(), 0, 1e-9);
  EXPECT_NEAR((box.max - Vec3(8, 8, 0)).norm(), 0, 1e-9);
}

}  // namespace
