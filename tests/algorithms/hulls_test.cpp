#include "algorithms/beyond/hulls.hpp"

#include <gtest/gtest.h>

#include "algorithms/beyond/convex_pieces.hpp"
#include "geometry/decision/hull.hpp"
#include "geometry/decision/wrapping.hpp"
#include "geometry/mass.hpp"
#include "tests/support/grazing.hpp"

namespace algorithms {
namespace {

using namespace setting;

bool met(const Mesh& a, const Mesh& b, const Vec3& at_b, std::int64_t count = 16) {
  return hit("hulls", a, {}, b, {{}, at_b}, {{"count", count}});
}

std::vector<Proxy> proxies_of(const Mesh& mesh, std::int64_t count) {
  const Algorithm& row = *find("hulls");
  Knobs knobs = presets(row);
  knobs["count"] = count;
  return row.proxies(Setting().add(mesh, {}).bodies, knobs);
}

/// The letter L, 3 high, 3 wide, 1 thick, of bars of width 1; its corner at the origin.
Mesh letter_l() {
  Mesh mesh;
  mesh.name = "l";
  const std::vector<std::pair<double, double>> outline = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : outline) mesh.vertices.push_back({x, y, z});
  mesh.triangles = {{6, 7, 8}, {6, 8, 9}, {6, 9, 10}, {6, 10, 11}, {0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 5, 4}};
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, j, j + 6});
    mesh.triangles.push_back({i, j + 6, i + 6});
  }
  return mesh;
}

double volume_of(const Proxy& proxy) {
  double sum = 0;
  for (const Mesh& solid : proxy.solids) sum += geometry::mass_properties(solid.vertices, solid.triangles).volume;
  return sum;
}

TEST(Hulls, OfAConvexMeshIsOnePiece) {
  for (const Mesh& mesh : {geometry::box("box", {1, 2, 3}), geometry::sphere("sphere", 1, 16)})
    EXPECT_EQ(proxies_of(mesh, 16)[0].solids.size(), 1u) << mesh.name;
}

// Its volume is 5 m^3; that of its hull 7. A cut through its inner corner leaves nothing beyond it.
TEST(Hulls, CutAnLAtItsInnerCorner) {
  const Mesh l = letter_l();
  ASSERT_TRUE(geometry::is_closed(l));
  const Proxy one = proxies_of(l, 1)[0], two = proxies_of(l, 2)[0];
  EXPECT_EQ(one.solids.size(), 1u);
  EXPECT_NEAR(volume_of(one), 7, 1e-12);
  EXPECT_EQ(two.solids.size(), 2u);
  EXPECT_NEAR(volume_of(two), 5, 1e-9);
  EXPECT_EQ(proxies_of(l, 16)[0].solids.size(), 2u) << "no more than it needs";
}

TEST(Hulls, FillTheNotchOnlyWhenThereIsOne) {
  const Mesh l = letter_l(), speck = geometry::box("speck", {0.1, 0.1, 0.1});
  EXPECT_TRUE(met(l, speck, {1.5, 1.5, 0.5}, 1));
  EXPECT_FALSE(met(l, speck, {1.5, 1.5, 0.5}, 2));
  EXPECT_TRUE(met(l, speck, {1.05, 1.5, 0.5}, 2)) << "it touches the bar";
  EXPECT_FALSE(met(l, speck, {1.05 + 1e-9, 1.5, 0.5}, 2));
}

TEST(Hulls, LeaveTheMiddleOfARingFree) {
  const Mesh wide = ring(3, 0.3, 24), ball = geometry::sphere("ball", 1, 8);
  EXPECT_TRUE(met(wide, ball, {0, 0, 0}, 1));
  EXPECT_FALSE(met(wide, ball, {0, 0, 0}, 16));
}

TEST(Hulls, ReportABodyInsideAnother) {
  const Mesh room = geometry::box("room", {8, 8, 8}), speck = geometry::box("speck", {0.1, 0.1, 0.1});
  EXPECT_TRUE(met(room, speck, {1, 2, 3}));
  EXPECT_FALSE(truly_meet(room, {}, speck, {{}, {1, 2, 3}}));
}

TEST(Hulls, HoldEveryVertex) {
  std::vector<Mesh> meshes = grazing::shapes();
  meshes.push_back(letter_l());
  meshes.push_back(geometry::torus("torus", 3, 1, 8));
  for (const Mesh& mesh : meshes)
    for (const std::int64_t count : {1, 5, 16}) {
      const geometry::Wrapping found =
          geometry::outside_solids(mesh, proxies_of(mesh, count)[0].solids, geometry::kClosedWithin);
      EXPECT_EQ(found.outside_share, 0) << mesh.name << ' ' << count;
      EXPECT_EQ(found.outside_greatest, 0) << mesh.name << ' ' << count;
    }
}

// More pieces hold less beyond the mesh. (Two halves of a torus hold as much as its hull.)
TEST(Hulls, HoldLessTheMoreThereAre) {
  const Mesh torus = geometry::torus("torus", 3, 1, 8);
  double before = volume_of(proxies_of(torus, 1)[0]);
  for (const std::int64_t count : {4, 16}) {
    const double now = volume_of(proxies_of(torus, count)[0]);
    EXPECT_LT(now, before) << count;
    before = now;
  }
  EXPECT_LT(before, 1.2 * std::fabs(geometry::mass_properties(torus.vertices, torus.triangles).volume));
}

TEST(Hulls, MissNothingThatGrazes) {
  int grazed = 0;
  SCOPED_TRACE("seed 71");
  grazing::each_pair(71, 20, [&](const Setting& pair) {
    ++grazed;
    EXPECT_EQ(hits("hulls", pair, {{"count", std::int64_t{6}}}).size(), 1u);
  });
  EXPECT_GT(grazed, 5);
}

TEST(Hulls, AreTheSameEveryTime) {
  const Mesh mesh = ring(2, 0.4, 12);
  EXPECT_EQ(convex_pieces(mesh, 8, 0.01, 0), convex_pieces(mesh, 8, 0.01, 0));
}

}  // namespace
}  // namespace algorithms
