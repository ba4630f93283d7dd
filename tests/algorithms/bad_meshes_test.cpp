// What no set-up may stumble over: every method that tests something in place of a mesh makes it of any mesh.
#include <gtest/gtest.h>

#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using setting::Mesh;
using setting::Setting;
using setting::Vec3;

Mesh mesh_of(const std::string& name, std::vector<Vec3> vertices, std::vector<geometry::Facet> triangles) {
  Mesh mesh;
  mesh.name = name;
  mesh.vertices = std::move(vertices);
  mesh.triangles = std::move(triangles);
  return mesh;
}

std::vector<Mesh> bad_meshes() {
  std::vector<Mesh> out;
  out.push_back(mesh_of("single", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  out.push_back(mesh_of("flat", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}));
  out.push_back(mesh_of("needle", {{0, 0, 0}, {1, 1, 1}, {0.5, 0.5, 0.5}}, {{0, 1, 2}, {1, 2, 0}}));
  out.push_back(mesh_of("point", {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, {{0, 1, 2}}));
  Mesh open = geometry::box("open", {1, 1, 1});
  open.triangles.resize(7);
  out.push_back(open);
  Mesh twice = geometry::box("twice", {1, 1, 1});  // every facet and vertex once more at the same place
  const std::vector<geometry::Facet> facets = twice.triangles;
  const std::vector<Vec3> vertices = twice.vertices;
  for (const auto& [a, b, c] : facets) twice.triangles.push_back({a + 8, b + 8, c + 8});
  twice.vertices.insert(twice.vertices.end(), vertices.begin(), vertices.end());
  out.push_back(twice);
  Mesh spare = geometry::box("spare", {1, 1, 1});  // a vertex that no facet has
  spare.vertices.push_back({3, 0, 0});
  out.push_back(spare);
  return out;
}

TEST(BadMeshes, HaveAProxyInEverySetUp) {
  for (const Algorithm& row : all()) {
    if (!row.proxies) continue;
    for (const Mesh& mesh : bad_meshes()) {
      SCOPED_TRACE(row.name + " of " + mesh.name);
      const Setting alone = Setting().add(mesh, {});
      const std::vector<Proxy> proxies = row.proxies(alone.bodies, presets(row));
      ASSERT_EQ(proxies.size(), 1u);
      EXPECT_FALSE(proxies[0].balls.empty() && proxies[0].solids.empty());
      for (const Mesh& solid : proxies[0].solids) EXPECT_FALSE(solid.triangles.empty());
    }
  }
}

// `check` does not make these to ask, so they must not refuse later.
TEST(BadMeshes, AreNotRefusedByRowsThatSaySo) {
  int rows = 0;
  for (const Algorithm& row : all()) {
    if (!row.fits_all) continue;
    ++rows;
    for (const Mesh& mesh : bad_meshes()) {
      const Setting alone = Setting().add(mesh, {});
      EXPECT_NO_THROW(row.make(alone.bodies, presets(row))) << row.name << " of " << mesh.name;
    }
  }
  EXPECT_EQ(rows, 4) << "convex_hull, spheres, capsule, hulls";
}

TEST(BadMeshes, MeetThemselvesAndNothingFarAway) {
  for (const Algorithm& row : all()) {
    if (!row.proxies) continue;
    for (const Mesh& mesh : bad_meshes()) {
      SCOPED_TRACE(row.name + " of " + mesh.name);
      EXPECT_EQ(setting::hits(row.name, Setting().add(mesh, {}).add(mesh, {})).size(), 1u);
      EXPECT_TRUE(setting::hits(row.name, Setting().add(mesh, {}).add(mesh, {{}, {9, 0, 0}})).empty());
    }
  }
}

}  // namespace
}  // namespace algorithms
