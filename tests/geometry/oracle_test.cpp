// The oracle itself: facts by hand, two other exact methods, and containment.
#include "geometry/decision/oracle.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "geometry/decision/meet.hpp"
#include "geometry/meshes/shapes.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/programming.hpp"
#include "tests/support/random.hpp"

namespace {

using geometry::Mesh;
using geometry::Pose;
using geometry::Quaternion;
using geometry::Triangle;
using geometry::Vec3;
using tests::Random;

constexpr unsigned kSeed = 20260802;

Triangle draw(Random& random, bool on_grid) { return on_grid ? random.grid_triangle(2) : random.triangle(); }

const Triangle kFloor{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};

struct Fact {
  const char* what;
  Triangle other;
  bool meet;
};
const Fact kFacts[] = {
    {"pierces", {Vec3(1, 1, -1), Vec3(1, 1, 1), Vec3(9, 9, 0)}, true},
    {"hovers", {Vec3(1, 1, 1), Vec3(2, 1, 1), Vec3(1, 2, 2)}, false},
    {"stands on it with a corner", {Vec3(1, 1, 0), Vec3(2, 1, 1), Vec3(1, 2, 2)}, true},
    {"stands a denormal above", {Vec3(1, 1, 0x1p-1074), Vec3(2, 1, 1), Vec3(1, 2, 2)}, false},
    {"shares a corner", {Vec3(4, 0, 0), Vec3(5, 0, 1), Vec3(6, 0, 0)}, true},
    {"passes a corner by an ulp", {Vec3(std::nextafter(4, 5), 0, 0), Vec3(5, 0, 1), Vec3(6, 0, 0)}, false},
    {"shares an edge", {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 0, -3)}, true},
    {"edges cross", {Vec3(2, -1, -1), Vec3(2, 1, 1), Vec3(2, -9, 1)}, true},
    {"coplanar, inside", {Vec3(1, 1, 0), Vec3(1.5, 1, 0), Vec3(1, 1.5, 0)}, true},
    {"coplanar, around", {Vec3(-9, -9, 0), Vec3(90, 0, 0), Vec3(0, 90, 0)}, true},
    {"coplanar, an edge from corner to edge", {Vec3(2, 2, 0), Vec3(3, 3, 0), Vec3(2, 4, 0)}, true},
    {"coplanar, apart though the boxes overlap", {Vec3(3, 3, 0), Vec3(3, 2, 0), Vec3(2.5, 3, 0)}, false},
    {"coplanar, apart", {Vec3(5, 0, 0), Vec3(6, 0, 0), Vec3(5, 1, 0)}, false},
    {"in a parallel plane", {Vec3(0, 0, 1), Vec3(4, 0, 1), Vec3(0, 4, 1)}, false},
    {"a segment through it", {Vec3(1, 1, -1), Vec3(1, 1, 1), Vec3(1, 1, 0.5)}, true},
    {"a segment beside it", {Vec3(3, 3, -1), Vec3(3, 3, 1), Vec3(3, 3, 0.5)}, false},
    {"a segment in its plane, crossing", {Vec3(-1, 1, 0), Vec3(9, 1, 0), Vec3(2, 1, 0)}, true},
    {"a segment in its plane, beyond", {Vec3(5, -1, 0), Vec3(5, 9, 0), Vec3(5, 2, 0)}, false},
    {"a segment along an edge's line, beyond", {Vec3(5, 0, 0), Vec3(6, 0, 0), Vec3(7, 0, 0)}, false},
    {"a point on it", {Vec3(1, 1, 0), Vec3(1, 1, 0), Vec3(1, 1, 0)}, true},
    {"a point on its edge", {Vec3(2, 2, 0), Vec3(2, 2, 0), Vec3(2, 2, 0)}, true},
    {"a point off its edge",
     {Vec3(2, std::nextafter(2, 3), 0), Vec3(2, std::nextafter(2, 3), 0), Vec3(2, std::nextafter(2, 3), 0)},
     false},
};

TEST(OracleFacts, OfATriangle) {
  for (const Fact& fact : kFacts) {
    EXPECT_EQ(oracle::triangles_meet(kFloor, fact.other), fact.meet) << fact.what;
    EXPECT_EQ(oracle::triangles_meet(fact.other, kFloor), fact.meet) << fact.what << ", swapped";
    EXPECT_EQ(programming::hulls_meet(kFloor, fact.other), fact.meet) << fact.what << ", simplex method";
  }
}

TEST(OracleFacts, OfSegmentsAndPoints) {
  const auto segment = [](const Vec3& p, const Vec3& q) { return Triangle{p, q, p}; };
  const Triangle along_x = segment(Vec3(0, 0, 0), Vec3(4, 0, 0));
  EXPECT_TRUE(oracle::triangles_meet(along_x, segment(Vec3(2, -1, 0), Vec3(2, 1, 0))));
  EXPECT_FALSE(oracle::triangles_meet(along_x, segment(Vec3(2, -1, 1), Vec3(2, 1, 1))));
  EXPECT_TRUE(oracle::triangles_meet(along_x, segment(Vec3(4, 0, 0), Vec3(9, 0, 0))));
  EXPECT_FALSE(oracle::triangles_meet(along_x, segment(Vec3(5, 0, 0), Vec3(9, 0, 0))));
  EXPECT_FALSE(oracle::triangles_meet(along_x, segment(Vec3(0, 1, 0), Vec3(4, 1, 0))));
  EXPECT_TRUE(oracle::triangles_meet(along_x, segment(Vec3(3, 0, 0), Vec3(3, 0, 0))));
  EXPECT_FALSE(oracle::triangles_meet(along_x, segment(Vec3(3, 1, 0), Vec3(3, 1, 0))));
  const Triangle one = segment(Vec3(1, 2, 3), Vec3(1, 2, 3)), other = segment(Vec3(1, 2, 4), Vec3(1, 2, 4));
  EXPECT_TRUE(oracle::triangles_meet(one, one));
  EXPECT_FALSE(oracle::triangles_meet(one, other));
}

// CGAL's own test with exact constructions, where its precondition holds.
TEST(OracleAgainst, EpeckOnProperTriangles) {
  using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
  const auto triangle = [](const Triangle& t) {
    const auto point = [](const Vec3& p) { return Kernel::Point_3(p.x(), p.y(), p.z()); };
    return Kernel::Triangle_3(point(t[0]), point(t[1]), point(t[2]));
  };
  Random random(kSeed);
  int meeting = 0, asked = 0;
  for (int i = 0; i < 20000; ++i) {
    const Triangle a = draw(random, i % 2), b = draw(random, i % 2);
    if (oracle::degenerate(a) || oracle::degenerate(b)) continue;
    const bool meet = CGAL::do_intersect(triangle(a), triangle(b));
    ASSERT_EQ(oracle::triangles_meet(a, b), meet) << "seed " << kSeed << ", pair " << i;
    meeting += meet;
    ++asked;
  }
  EXPECT_GT(meeting, asked / 5);
  EXPECT_LT(meeting, asked * 4 / 5);
}

// The simplex method, also on segments and points: on a grid of five every third triangle of a kind is one.
TEST(OracleAgainst, TheSimplexMethodInRationals) {
  Random random(kSeed);
  int meeting = 0, degenerate = 0;
  constexpr int kPairs = 2400;
  for (int i = 0; i < kPairs; ++i) {
    Triangle a = draw(random, i % 4), b = draw(random, i % 4);
    if (i % 3 == 0) a[2] = i % 2 ? a[0] : Vec3(2 * a[1] - a[0]);
    if (i % 5 == 0) b[1] = b[0], b[2] = i % 2 ? b[0] : b[2];
    if (i % 7 == 0) b[0] = a[std::size_t(i % 3)];
    const bool meet = programming::hulls_meet(a, b);
    ASSERT_EQ(oracle::triangles_meet(a, b), meet) << "seed " << kSeed << ", pair " << i;
    meeting += meet;
    degenerate += oracle::degenerate(a) || oracle::degenerate(b);
  }
  EXPECT_GT(meeting, kPairs / 10);
  EXPECT_LT(meeting, kPairs * 9 / 10);
  EXPECT_GT(degenerate, kPairs / 4);
}

TEST(Oracle, WorldVerticesHaveTheBitsOfTheProduct) {
  Random random(kSeed);
  for (int i = 0; i < 5000; ++i) {
    const Quaternion q = random.turn();
    const Pose pose{q, std::pow(10, random.integer(-3, 6)) * random.point()};
    const Vec3 v = random.point();
    ASSERT_EQ(oracle::world_vertex(pose, v), geometry::to_world(geometry::rotation(pose.q), pose.t, v)) << kSeed;
  }
}

TEST(Oracle, ExtentsThatTouchShareAPoint) {
  const oracle::Extent unit{Vec3(0, 0, 0), Vec3(1, 1, 1)};
  EXPECT_TRUE(oracle::touch(unit, {Vec3(1, 1, 1), Vec3(2, 2, 2)}));
  EXPECT_FALSE(oracle::touch(unit, {Vec3(0, 0, std::nextafter(1, 2)), Vec3(1, 1, 2)}));
  EXPECT_TRUE(oracle::nested(unit, unit));
  EXPECT_FALSE(oracle::nested(unit, {Vec3(0, 0x1p-1074, 0), Vec3(1, 1, 1)}));
}

TEST(Oracle, AnExtentWithoutNumbersIsNotFinite) {
  Mesh mesh = geometry::box("cube", Vec3(1, 1, 1));
  EXPECT_TRUE(oracle::is_finite(oracle::world_extent(mesh, {})));
  EXPECT_FALSE(oracle::is_finite(oracle::world_extent(mesh, geometry::unborn())));
  mesh.vertices[3].x() = 1e308;
  EXPECT_FALSE(oracle::is_finite(oracle::world_extent(mesh, {{2, 0, 3, 0}, Vec3(0, 0, 0)})));  // overflows
}

// ---- containment

bool contained(const Mesh& inner, const Pose& at, const Mesh& outer, const Pose& there = {}) {
  return oracle::contained(oracle::world_triangles(inner, at), oracle::world_triangles(outer, there));
}

TEST(OracleContained, ByHand) {
  const Mesh grain = geometry::box("grain", Vec3(0.25, 0.25, 0.25)), cube = geometry::box("cube", Vec3(4, 4, 4));
  EXPECT_TRUE(contained(grain, {{}, Vec3(0, 0, 0)}, cube));  // rays through edges of the facets' diagonals
  EXPECT_TRUE(contained(grain, {{}, Vec3(1, -1, 0.5)}, cube));
  EXPECT_FALSE(contained(grain, {{}, Vec3(3, 0, 0)}, cube));
  EXPECT_FALSE(contained(cube, {}, grain));
  EXPECT_FALSE(oracle::contained({}, oracle::world_triangles(cube, {})));

  const Mesh torus = geometry::torus("torus", 6, 1, 16);
  EXPECT_FALSE(contained(grain, {{}, Vec3(0, 0, 0)}, torus));
  EXPECT_TRUE(contained(grain, {{}, Vec3(3, 0, 0)}, torus));
  EXPECT_TRUE(contained(grain, {{}, Vec3(0, 0, -3)}, torus));
}

TEST(OracleContained, NeedsEveryComponentInside) {
  Mesh two = geometry::box("two", Vec3(0.5, 0.5, 0.5));
  const Mesh one = two;
  const auto n = std::uint32_t(one.vertices.size());
  for (const Vec3& v : one.vertices) two.vertices.push_back(v + Vec3(3, 0, 0));
  for (const geometry::Facet& f : one.triangles) two.triangles.push_back({f[0] + n, f[1] + n, f[2] + n});
  // The box reaches over both, its tube only around one.
  const Mesh torus = geometry::torus("torus", 6, 1.5, 16);
  EXPECT_FALSE(contained(two, {{}, Vec3(0, 0, 0)}, torus));
  EXPECT_TRUE(contained(one, {{}, Vec3(3, 0, 0)}, torus));
  EXPECT_TRUE(contained(two, {}, geometry::box("room", Vec3(9, 9, 9))));
}

TEST(OracleContained, FacetsWithoutAreaAreNoWalls) {
  Mesh cube = geometry::box("cube", Vec3(4, 4, 4));
  cube.vertices.push_back(Vec3(0, 0, 1));
  const auto spike = std::uint32_t(cube.vertices.size() - 1);
  cube.triangles.push_back({spike, spike, spike});
  cube.triangles.push_back({spike, 7, spike});
  EXPECT_TRUE(contained(geometry::box("grain", Vec3(0.5, 0.5, 0.5)), {}, cube));
}

TEST(OracleContained, AgreesWithTheDecision) {
  Random random(kSeed);
  geometry::Bodies bodies;
  bodies.meshes = {geometry::torus("torus", 2, 1, 8), geometry::sphere("ball", 1, 3),
                   geometry::box("grain", Vec3(0.2, 0.2, 0.2)), geometry::sphere("bead", 0.15, 2)};
  std::vector<geometry::Solid> solids;
  for (const Mesh& mesh : bodies.meshes) solids.push_back(geometry::solid_of(mesh, geometry::kClosedWithin));
  const std::vector<geometry::Bvh> bvhs = geometry::build_bvhs(bodies);
  int contained_pairs = 0, apart = 0;
  for (int i = 0; i < 150; ++i) {
    bodies.mesh = {std::uint32_t(i % 2), std::uint32_t(2 + i / 2 % 2)};
    bodies.fixed = {0, 0};
    bodies.name = {"a", "b"};
    const Quaternion q = random.turn(), p = random.turn();
    const std::vector<Pose> poses{{q, Vec3(0, 0, 0)}, {p, 1.1 * random.point()}};
    std::vector<geometry::Contained> listed;
    const bool meet =
        !geometry::Decision(bodies, bvhs, solids).hits(poses, geometry::pair_runs(bodies, poses), &listed).empty();
    const auto a = oracle::world_triangles(bodies.mesh_of(0), poses[0]);
    const auto b = oracle::world_triangles(bodies.mesh_of(1), poses[1]);
    ASSERT_EQ(oracle::meet(a, b), meet) << "seed " << kSeed << ", " << i;
    if (meet) continue;
    const bool inside = oracle::contained(a, b) || oracle::contained(b, a);
    ASSERT_EQ(inside, !listed.empty()) << "seed " << kSeed << ", " << i;
    ++(inside ? contained_pairs : apart);
  }
  EXPECT_GE(contained_pairs, 10);
  EXPECT_GE(apart, 10);
}

}  // namespace
