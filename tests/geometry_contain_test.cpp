#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <string>

#include "geometry/contain.hpp"
#include "geometry/meet.hpp"
#include "geometry/shapes.hpp"
#include "tests/oracle.hpp"

namespace {

using geometry::Bodies;
using geometry::Mesh;
using geometry::Pair;
using geometry::Pose;
using geometry::Vec3;

/// The boxes' corners are halves and integers, and so are the shifts: everything is exact.
Mesh cube(double side) { return geometry::box("cube", {side, side, side}); }

/// One mesh of two, the second shifted; its facets turned inside out where asked.
Mesh both(Mesh a, const Mesh& b, const Vec3& shift, bool inside_out = false) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  for (const Vec3& v : b.vertices) a.vertices.push_back(v + shift);
  for (const auto& [i, j, k] : b.triangles) {
    if (inside_out)
      a.triangles.push_back({first + i, first + k, first + j});
    else
      a.triangles.push_back({first + i, first + j, first + k});
  }
  return a;
}

struct Answer {
  bool meet = false, contained = false;
  bool operator==(const Answer&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Answer& a) {
  return out << (a.meet ? "meet" : a.contained ? "contained" : "apart");
}
constexpr Answer kApart{}, kMeet{.meet = true}, kContained{.contained = true};

/// Both orders of the pair must answer alike.
Answer answer(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  Answer out[2];
  for (const int turned : {0, 1}) {
    Bodies bodies;
    bodies.meshes = {turned ? b : a, turned ? a : b};
    bodies.name = {"a", "b"};
    bodies.mesh = {0, 1};
    bodies.fixed = {0, 0};
    const std::vector<Pose> poses{turned ? at_b : at_a, turned ? at_a : at_b};
    const std::vector<geometry::Bvh> bvhs = geometry::build_bvhs(bodies);
    std::vector<geometry::Solid> solids;
    for (const Mesh& mesh : bodies.meshes) solids.push_back(geometry::solid_of(mesh));
    std::vector<Pair> contained;
    geometry::Decision decision(bodies, bvhs, solids);
    const auto hits = decision.hits(poses, geometry::pair_runs(bodies, poses), &contained);
    EXPECT_LE(hits.size() + contained.size(), 1u);
    out[turned] = {!hits.empty(), !contained.empty()};
  }
  EXPECT_EQ(out[0], out[1]) << "the order of the pair changes the answer";
  return out[0];
}

Answer answer(const Mesh& a, const Vec3& at, const Mesh& b) { return answer(a, Pose{{}, at}, b, Pose{}); }

// ---- Another method: the winding number as a sum of solid angles, in long double, for points away from the surface.

using Real = long double;
struct P {
  Real x, y, z;
};
P minus(const Vec3& a, const Vec3& b) { return {Real(a.x()) - b.x(), Real(a.y()) - b.y(), Real(a.z()) - b.z()}; }
Real dot(const P& a, const P& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// How often the surface winds around p.
Real winding(const Vec3& p, const std::vector<geometry::Triangle>& surface) {
  Real sum = 0;
  for (const auto& t : surface) {
    const P a = minus(t[0], p), b = minus(t[1], p), c = minus(t[2], p);
    const Real la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
    const P ab{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    sum += 2 * std::atan2(dot(ab, c), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi_v<Real>);
}

/// The answer by asking every triangle about every other, and the winding number of b around every vertex of a.
Answer slow_answer(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  const auto ta = oracle::world_triangles(a, at_a), tb = oracle::world_triangles(b, at_b);
  if (oracle::meet(ta, tb)) return kMeet;
  const auto inside = [](const auto& inner, const auto& outer) {
    for (const auto& t : inner)
      for (const Vec3& p : t)
        if (std::llround(winding(p, outer)) % 2 == 0) return false;
    return true;
  };
  return {.contained = inside(ta, tb) || inside(tb, ta)};
}

}  // namespace

TEST(Contain, ABoxInABox) {
  EXPECT_EQ(answer(cube(1), {0, 0, 0}, cube(4)), kContained);
  EXPECT_EQ(answer(cube(1), {1.25, 1, -1}, cube(4)), kContained);
  EXPECT_EQ(answer(cube(1), {3, 0, 0}, cube(4)), kApart);
  EXPECT_EQ(answer(cube(1), {2, 0, 0}, cube(4)), kMeet);
}

TEST(Contain, TouchingFromInsideIsAHitOfTheSurfaces) {
  EXPECT_EQ(answer(cube(1), {1.5, 0, 0}, cube(4)), kMeet);
  EXPECT_EQ(answer(cube(1), {1.5 - 0x1p-51, 0, 0}, cube(4)), kContained);  // one ulp less
  EXPECT_EQ(answer(cube(4), {0, 0, 0}, cube(4)), kMeet);
}

TEST(Contain, InTheHoleOfATorusIsOutside) {
  const Mesh torus = geometry::torus("torus", 6, 1, 16);
  const Mesh grain = geometry::sphere("grain", 0.1, 4);
  EXPECT_EQ(answer(grain, {0, 0, 0}, torus), kApart);
  EXPECT_EQ(answer(grain, {3, 0, 0}, torus), kContained);
  EXPECT_EQ(answer(grain, {0, 0, -3}, torus), kContained);
  EXPECT_EQ(answer(grain, {3, 0.5, 0}, torus), kMeet);
}

TEST(Contain, BetweenTheWallsOfAShellIsInsideAndInItsCavityIsNot) {
  const Mesh shell = both(cube(8), cube(4), {0, 0, 0}, true);
  EXPECT_EQ(answer(cube(1), {0, 0, 0}, shell), kApart);
  EXPECT_EQ(answer(cube(1), {3, 0, 0}, shell), kContained);
  // Parity does not ask how facets are turned.
  EXPECT_EQ(answer(cube(1), {3, 0, 0}, both(cube(8), cube(4), {0, 0, 0}, false)), kContained);
}

TEST(Contain, EveryComponentMustBeInside) {
  const Mesh inside = both(cube(1), cube(1), {2, 0, 0});
  EXPECT_EQ(geometry::solid_of(inside).components.size(), 2u);
  EXPECT_EQ(answer(inside, {-1, 0, 0}, cube(8)), kContained);
  // The shell's cavity holds one component, its wall the other.
  const Mesh shell = both(cube(16), cube(4), {0, 0, 0}, true);
  EXPECT_EQ(answer(both(cube(1), cube(1), {4, 0, 0}), {0, 0, 0}, shell), kApart);
  EXPECT_EQ(answer(both(cube(1), cube(1), {4, 0, 0}), {4 - 8, 6, 0}, shell), kContained);
  // A box around one of two apart: the whole is not inside, and the box is in no other.
  EXPECT_EQ(answer(both(cube(1), cube(1), {8, 0, 0}), {0, 0, 0}, cube(4)), kApart);
}

TEST(Contain, ABoxOfBoundsIsNotYetContainment) {
  // A cube in the corner of a sphere's bounding box.
  EXPECT_EQ(answer(cube(0.25), {0.875 - 0.125, 0.75, 0.75}, geometry::sphere("sphere", 1, 8)), kApart);
}

// Segments that pass through edges and vertices, and lie in planes of facets, must be found out and replaced.
TEST(Contain, PointsInLineWithEdgesVerticesAndPlanes) {
  const Mesh box = cube(2);
  geometry::Bodies bodies;
  bodies.meshes = {box};
  const auto bvhs = geometry::build_bvhs(bodies);
  std::vector<geometry::Box> boxes(bvhs[0].nodes.size());
  geometry::refit(bvhs[0], box, box.vertices, boxes);
  const auto inside = [&](const Vec3& p) { return geometry::is_inside(p, box, bvhs[0], box.vertices, boxes); };
  // All multiples of 1/4 off the surface: many on planes, diagonals and lines of edges.
  for (int x = -6; x <= 6; ++x)
    for (int y = -6; y <= 6; ++y)
      for (int z = -6; z <= 6; ++z) {
        const int most = std::max({std::abs(x), std::abs(y), std::abs(z)});
        if (most == 4) continue;  // on the surface: never asked
        EXPECT_EQ(inside(Vec3(x, y, z) / 4), most < 4) << x << ' ' << y << ' ' << z;
      }
}

/// A tetrahedron so placed that the very first segments from the origin run through its top vertex and along its edges.
TEST(Contain, AVertexStraightAboveIsNoCrossingTwice) {
  for (const Vec3& top : {Vec3(0, 0, 4), Vec3(0x1.1p-12, 0, 4), Vec3(1, 0, 4)}) {
    Mesh roof;
    roof.vertices = {top, {4, 4, -4}, {-4, 4, -4}, {0, -4, -4}};
    roof.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    EXPECT_EQ(answer(cube(0.5), {0, 0, 0}, roof), kContained) << top.transpose();
  }
}

TEST(Contain, FacetsWithoutAreaChangeNothing) {
  // One facet of the cube cut at the middle of its edge by a facet without area.
  Mesh cut = cube(4);
  auto [a, b, c] = cut.triangles[0];
  const auto m = static_cast<std::uint32_t>(cut.vertices.size());
  cut.vertices.push_back((cut.vertices[a] + cut.vertices[b]) / 2);
  cut.triangles[0] = {a, m, c};
  cut.triangles.push_back({m, b, c});
  cut.triangles.push_back({a, b, m});
  EXPECT_TRUE(geometry::solid_of(cut).closed);
  EXPECT_EQ(answer(cube(1), {0.5, 0, 0.25}, cut), kContained);
  EXPECT_EQ(answer(cube(1), {4, 0, 0.25}, cut), kApart);
}

TEST(Solid, ClosedIsAskedByCoordinates) {
  const Mesh sphere = geometry::sphere("sphere", 1, 4);
  EXPECT_TRUE(geometry::solid_of(sphere).closed);
  EXPECT_EQ(geometry::solid_of(sphere).components.size(), 1u);

  Mesh soup;  // three vertices a facet
  for (const auto& facet : sphere.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : facet) soup.vertices.push_back(sphere.vertices[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_FALSE(geometry::is_closed(soup));
  EXPECT_TRUE(geometry::solid_of(soup).closed);
  EXPECT_EQ(geometry::solid_of(soup).components.size(), 1u);
  EXPECT_EQ(answer(soup, Pose{{}, {0.5, 0, 0}}, cube(4), Pose{}), kContained);
  EXPECT_EQ(answer(cube(0.5), {0.1, 0, 0}, soup), kContained);

  soup.vertices[0].x() += 0x1p-40;  // a crack
  EXPECT_FALSE(geometry::solid_of(soup).closed);
  soup.triangles.pop_back();
  EXPECT_FALSE(geometry::solid_of(soup).closed);
  EXPECT_FALSE(geometry::solid_of(Mesh{}).closed);
}

TEST(Contain, AgreesWithWindingNumbersOnRandomPoses) {
  constexpr unsigned kSeed = 1603;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 random(kSeed);
  const auto real = [&] { return static_cast<double>(static_cast<std::int64_t>(random())) * 0x1p-63; };
  const std::vector<Mesh> outer{cube(4), geometry::sphere("s", 2.2, 2), geometry::torus("t", 4, 1.8, 7),
                                both(cube(6), cube(2), {0, 0, 0}, true)};
  const std::vector<Mesh> inner{cube(0.5), geometry::sphere("g", 0.4, 1), both(cube(0.5), cube(0.25), {0.8, 0, 0})};
  int counts[3] = {};
  for (int i = 0; i < 400; ++i) {
    const Mesh &b = outer[random() % outer.size()], &a = inner[random() % inner.size()];
    const auto pose = [&](double reach) {
      return Pose{geometry::normalised({real(), real(), real(), real()}), reach * Vec3(real(), real(), real())};
    };
    const Pose at_a = pose(2.6), at_b = pose(0.3);
    const Answer expected = slow_answer(a, at_a, b, at_b);
    EXPECT_EQ(answer(a, at_a, b, at_b), expected) << "case " << i;
    ++counts[expected.meet ? 0 : expected.contained ? 1 : 2];
  }
  for (const int count : counts) EXPECT_GE(count, 40);
}
