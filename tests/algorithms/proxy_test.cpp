#include "algorithms/beyond/proxy.hpp"

#include <gtest/gtest.h>

#include "algorithms/beyond/solids.hpp"
#include "tests/support/grazing.hpp"

namespace algorithms {
namespace {

using namespace setting;

/// Both meshes as one, each with vertices of its own.
Mesh together(Mesh a, const Mesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const geometry::Facet& f : b.triangles) a.triangles.push_back({f[0] + first, f[1] + first, f[2] + first});
  return a;
}

Mesh shifted(Mesh mesh, const Vec3& by) {
  for (Vec3& v : mesh.vertices) v += by;
  return mesh;
}

Mesh cube(double side) { return geometry::box("cube", {side, side, side}); }

/// The same facets, none of which shares a vertex.
Mesh soup(const Mesh& mesh) {
  Mesh out;
  for (const geometry::Facet& f : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    for (const std::uint32_t v : f) out.vertices.push_back(mesh.vertices[v]);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

std::string refusal(const Mesh& mesh) {
  try {
    closed_components(mesh, geometry::kClosedWithin);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "taken";
}

/// The pairs that the row reports of the setting.
std::vector<Pair> reported(const Algorithm& row, const Setting& setting) {
  const auto method = row.make(setting.bodies, presets(row));
  std::vector<Pair> out;
  method->prepare(setting.poses);
  method->answer(setting.runs(), out);
  return out;
}

TEST(ClosedComponents, AreFoundByNumbersOfVertices) {
  const std::vector<Mesh> parts =
      closed_components(together(cube(2), shifted(geometry::sphere("s", 1, 4), {5, 0, 0})), 0);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].vertices, cube(2).vertices);
  EXPECT_EQ(parts[0].triangles, cube(2).triangles);
  EXPECT_EQ(parts[1].triangles.size(), geometry::sphere("s", 1, 4).triangles.size());
}

// Two cubes that share a corner's place are two, not one; a soup of facets is put together by its places.
TEST(ClosedComponents, AreFoundByCoordinatesWhereNumbersLeaveThemOpen) {
  EXPECT_EQ(closed_components(together(cube(2), shifted(cube(2), {2, 2, 2})), 0).size(), 2u);
  EXPECT_EQ(closed_components(soup(cube(2)), 0).size(), 1u);
  EXPECT_EQ(closed_components(soup(together(cube(2), shifted(cube(2), {9, 0, 0}))), 0).size(), 2u);
}

TEST(ClosedComponents, RefuseWhatIsOpenAndNameTheEdge) {
  Mesh open = cube(2);
  open.triangles.pop_back();
  EXPECT_NE(refusal(open).find("it is open, the edge from ("), std::string::npos) << refusal(open);
  EXPECT_NE(refusal(together(cube(2), shifted(open, {9, 0, 0}))).find("component 2 of 2 is open"), std::string::npos);
  EXPECT_EQ(refusal(cube(2)), "taken");
}

TEST(Proxy, IsDecidedExactlyAtTouching) {
  const Setting touching = Setting().add(cube(2), {}).add(cube(2), {{}, {2, 0, 0}});
  Setting apart = touching;
  apart.poses[1].t.x() = std::nextafter(2.0, 3.0);
  EXPECT_EQ(reported(proxy(), touching).size(), 1u);
  EXPECT_TRUE(reported(proxy(), apart).empty());
}

TEST(Proxy, IsSolid) {
  const Setting inside = Setting().add(cube(4), {}).add(cube(1), {{}, {0.5, 0.5, 0}});
  EXPECT_EQ(reported(proxy(), inside).size(), 1u);
  EXPECT_TRUE(truth(inside).empty());
}

// By the parity rule what lies in two components would be outside; and a part inside is enough, whatever sticks out.
TEST(Proxy, TakesOverlappingComponentsTogether) {
  const Mesh two = together(cube(4), shifted(cube(4), {1, 0, 0}));
  EXPECT_EQ(reported(proxy(), Setting().add(two, {}).add(cube(0.5), {{}, {0.5, 0, 0}})).size(), 1u);
  const Mesh far = together(cube(0.5), shifted(cube(0.5), {9, 0, 0}));
  EXPECT_EQ(reported(proxy(), Setting().add(cube(4), {}).add(far, {})).size(), 1u);
}

TEST(Proxy, AnswersInPlaceOfTheMeshes) {
  const Setting near = Setting().add(cube(2), {}).add(cube(2), {{}, {1.9, 0, 0}});
  Setting named = near;
  named.bodies.meshes[1].name = "other";
  const auto of = [](double side) { return std::vector<Mesh>{cube(side)}; };
  EXPECT_EQ(reported(proxy_of({{"cube", of(2)}, {"other", of(2)}}), named).size(), 1u);
  EXPECT_TRUE(reported(proxy_of({{"cube", of(1.7)}, {"other", of(2)}}), named).empty())
      << "a proxy that does not wrap misses";
  named.poses[1].t.x() = 2.1;
  EXPECT_TRUE(reported(proxy_of({{"cube", of(2)}, {"other", of(2)}}), named).empty());
  EXPECT_EQ(reported(proxy_of({{"cube", of(2.3)}, {"other", of(2)}}), named).size(), 1u) << "a larger one invents";
}

TEST(Proxy, WantsAFileForEveryMeshAndNoOther) {
  Bodies bodies = Setting().add(cube(2), {}).bodies;
  const auto refused = [&](const std::map<std::string, std::vector<Mesh>>& solids) -> std::string {
    const Algorithm row = proxy_of(solids);
    try {
      row.make(bodies, presets(row));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_EQ(refused({{"cube", {cube(2)}}}), "taken");
  EXPECT_EQ(refused({}), "no file is named for mesh 'cube'; add cube = \"....obj\"");
  EXPECT_EQ(refused({{"cube", {cube(2)}}, {"cub", {cube(2)}}}),
            "a file is named for mesh 'cub', which the scene has not; it has cube");
}

// Convex and closed, each is its own proxy: then the answer is that of `exact` with containment.
TEST(Proxy, OfTheMeshesThemselvesIsExact) {
  std::mt19937 random(81);
  SCOPED_TRACE("seed 81");
  const Setting many = crowd(random, 40, 3);
  std::vector<Pair> exact;
  const auto method = make("exact", many.bodies, {{"containment", true}});
  method->prepare(many.poses);
  method->answer(many.runs(), exact);
  std::sort(exact.begin(), exact.end());
  EXPECT_FALSE(exact.empty());
  EXPECT_EQ(hits("proxy", many), exact);
}

TEST(Proxy, ReportsNothingThatIsApartAndAllThatGrazes) {
  int grazed = 0;
  SCOPED_TRACE("seed 82");
  grazing::each_pair(82, 40, [&](Setting& pair) {
    ++grazed;
    EXPECT_EQ(hits("proxy", pair).size(), 1u);
  });
  EXPECT_GT(grazed, 15);
}

}  // namespace
}  // namespace algorithms
