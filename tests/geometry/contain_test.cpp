#include "geometry/decision/contain.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <set>
#include <string>

#include "geometry/decision/meet.hpp"
#include "geometry/decision/shells.hpp"
#include "geometry/meshes/shapes.hpp"
#include "tests/support/oracle.hpp"

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
  char inside = '-';  // 'a' or 'b' when contained
  bool operator==(const Answer&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Answer& a) {
  return out << (a.meet ? "meet" : a.contained ? "contained, inside: " : "apart") << a.inside;
}
constexpr Answer kApart{}, kMeet{.meet = true}, kContained{.contained = true, .inside = 'a'};
constexpr Answer kContains{.contained = true, .inside = 'b'};

/// Both orders of the pair must answer alike.
Answer answer(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b,
              double closed_within = geometry::kClosedWithin) {
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
    for (const Mesh& mesh : bodies.meshes) solids.push_back(geometry::solid_of(mesh, closed_within));
    std::vector<geometry::Contained> contained;
    geometry::Decision decision(bodies, bvhs, solids);
    const auto hits = decision.hits(poses, geometry::pair_runs(bodies, poses), &contained);
    EXPECT_LE(hits.size() + contained.size(), 1u);
    out[turned] = {!hits.empty(), !contained.empty()};
    if (!contained.empty()) out[turned].inside = (contained[0].inside == 0) == (turned == 0) ? 'a' : 'b';
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
  return inside(ta, tb) ? kContained : inside(tb, ta) ? kContains : kApart;
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
  EXPECT_EQ(geometry::solid_of(inside, geometry::kClosedWithin).components.size(), 2u);
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
  EXPECT_TRUE(geometry::solid_of(cut, geometry::kClosedWithin).closed);
  EXPECT_EQ(answer(cube(1), {0.5, 0, 0.25}, cut), kContained);
  EXPECT_EQ(answer(cube(1), {4, 0, 0.25}, cut), kApart);
}

TEST(Solid, ClosedIsAskedByCoordinates) {
  const Mesh sphere = geometry::sphere("sphere", 1, 4);
  EXPECT_TRUE(geometry::solid_of(sphere, geometry::kClosedWithin).closed);
  EXPECT_EQ(geometry::solid_of(sphere, geometry::kClosedWithin).components.size(), 1u);

  Mesh soup;  // three vertices a facet
  for (const auto& facet : sphere.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : facet) soup.vertices.push_back(sphere.vertices[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_FALSE(geometry::is_closed(soup));
  EXPECT_TRUE(geometry::solid_of(soup, geometry::kClosedWithin).closed);
  EXPECT_EQ(geometry::solid_of(soup, geometry::kClosedWithin).components.size(), 1u);
  EXPECT_EQ(answer(soup, Pose{{}, {0.5, 0, 0}}, cube(4), Pose{}), kContained);
  EXPECT_EQ(answer(cube(0.5), {0.1, 0, 0}, soup), kContained);

  soup.vertices[0].x() += 0x1p-40;  // a crack
  EXPECT_FALSE(geometry::solid_of(soup, 0).closed);
  soup.triangles.pop_back();
  EXPECT_FALSE(geometry::solid_of(soup, geometry::kClosedWithin).closed);
  EXPECT_FALSE(geometry::solid_of(Mesh{}, geometry::kClosedWithin).closed);
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

// ---- Corners a hair apart -----------------------------------------------------------------------------------------

namespace {

using geometry::Facet;
using geometry::Solid;

/// Three vertices a facet, as in an STL file.
Mesh soup_of(const Mesh& mesh) {
  Mesh soup;
  for (const Facet& facet : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : facet) soup.vertices.push_back(mesh.vertices[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

/// A cube as a soup, one corner of one facet moved along x.
Mesh cube_with_hair(double side, double hair) {
  Mesh mesh = soup_of(cube(side));
  mesh.vertices[0].x() += hair;
  return mesh;
}

/// The facets as places, whatever their numbers and their order.
std::multiset<std::array<std::array<double, 3>, 3>> places(const Mesh& mesh) {
  std::multiset<std::array<std::array<double, 3>, 3>> out;
  for (const Facet& f : mesh.triangles) {
    std::array<std::array<double, 3>, 3> t;
    for (std::size_t k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) t[k][std::size_t(i)] = mesh.vertices[f[k]][i] + 0.0;  // no -0
    std::ranges::sort(t);
    out.insert(t);
  }
  return out;
}

/// The oracle's answer, by its own closed surfaces.
Answer oracle_answer(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b, double closed_within) {
  const auto ta = oracle::world_triangles(a, at_a), tb = oracle::world_triangles(b, at_b);
  if (oracle::meet(ta, tb)) return kMeet;
  const auto inside = [&](const auto& inner, const Mesh& mesh, const Pose& pose) {
    const auto surface = oracle::closed_surface(mesh, closed_within);
    if (!surface) return false;
    const auto outer = oracle::world_triangles(*surface, pose);
    return !oracle::meet(inner, outer) && oracle::contained(inner, outer);
  };
  return inside(ta, b, at_b) ? kContained : inside(tb, a, at_a) ? kContains : kApart;
}

/// A cube [-1, 1]^3 whose top stands a slit above the sides: facets with z = 1 throughout are moved up.
Mesh slit_cube(double slit) {
  Mesh mesh = soup_of(cube(2));
  for (const Facet& f : mesh.triangles)
    if (mesh.vertices[f[0]].z() + mesh.vertices[f[1]].z() + mesh.vertices[f[2]].z() == 3)
      for (const std::uint32_t v : f) mesh.vertices[v].z() += slit;
  return mesh;
}

}  // namespace

// The width is 2^-20 of the side: at every size of mesh, hairs below it are one corner and hairs above are not.
TEST(Hair, CornersNearerThanTheWidthAreOneAtEverySize) {
  for (const double side : {1e-300, 1e-12, 1e-3, 1.0, 1e12, 1e290})
    for (const double share : {0x1p-52, 0x1p-40, 0x1p-24, 0x1p-21, 0x1p-19, 0x1p-10}) {
      const Mesh mesh = cube_with_hair(side, share * side);
      const Solid solid = geometry::solid_of(mesh, geometry::kClosedWithin);
      EXPECT_EQ(solid.closed, share < 0x1p-20) << side << ' ' << share;
      EXPECT_EQ(oracle::closed_surface(mesh, geometry::kClosedWithin).has_value(), solid.closed);
      EXPECT_FALSE(geometry::solid_of(mesh, 0).closed);
      if (solid.closed) {
        EXPECT_NEAR(solid.closed_within / side / share, 1, 0.5);  // the hair, as it rounds
        EXPECT_EQ(places(solid.surface->mesh).size(), 12u);
        EXPECT_EQ(places(solid.surface->mesh), places(*oracle::closed_surface(mesh, geometry::kClosedWithin)));
      } else {
        EXPECT_TRUE(std::isnan(solid.closed_within));
      }
      const Mesh grain = cube(side / 4);
      EXPECT_EQ(answer(grain, Vec3(side / 8, 0, 0), mesh), solid.closed ? kContained : kApart) << side << ' ' << share;
    }
}

// 1e-34 m where a sine should be 0: the product of two roundings.
TEST(Hair, AnyHairBelowTheWidthIsOneCorner) {
  for (const double hair : {5e-324, 1e-34, 2.7e-16}) {
    Mesh mesh = soup_of(cube(2));
    for (Vec3& v : mesh.vertices) v += Vec3(1, 1, 1);  // corners at 0, where such a hair can be
    for (Vec3& v : mesh.vertices)
      if (v == Vec3::Zero()) {
        v.y() = hair;
        break;
      }
    const Solid solid = geometry::solid_of(mesh, geometry::kClosedWithin);
    EXPECT_TRUE(solid.closed);
    EXPECT_EQ(solid.closed_within, hair);
    EXPECT_FALSE(geometry::solid_of(mesh, 0).closed);
  }
}

TEST(Hair, AMeshThatIsClosedAsReadStaysAsItIs) {
  const Solid solid = geometry::solid_of(cube(1), 1e-3);
  EXPECT_TRUE(solid.closed);
  EXPECT_EQ(solid.closed_within, 0);
  EXPECT_FALSE(solid.surface);
}

TEST(Hair, AnOpenMeshNamesItsFirstOpenEdgeAndTheWidth) {
  Mesh open = cube(2);
  const Facet gone = open.triangles.back();
  open.triangles.pop_back();
  const Solid solid = geometry::solid_of(open, 0x1p-20);
  ASSERT_TRUE(solid.open_edge);
  EXPECT_EQ(solid.open_edge->facets, 1u);
  std::set<std::array<double, 3>> ends;
  for (const Vec3& p : {solid.open_edge->from, solid.open_edge->to}) {
    EXPECT_TRUE(std::ranges::any_of(gone, [&](auto v) { return open.vertices[v] == p; })) << p.transpose();
    ends.insert({p.x(), p.y(), p.z()});
  }
  EXPECT_EQ(ends.size(), 2u);
  EXPECT_NE(geometry::open_text(solid).find(" belongs to 1 facet, also with corners within 1.91e-06 m"),
            std::string::npos)
      << geometry::open_text(solid);
  EXPECT_NE(geometry::open_text(geometry::solid_of(open, 0)).find("coordinates are equal"), std::string::npos);
  // A hair too wide: the edge as read, whose ends are those of the file.
  const Mesh wide = cube_with_hair(2, 0x1p-10);
  const Solid found = geometry::solid_of(wide, 0x1p-20);
  ASSERT_TRUE(found.open_edge);
  EXPECT_EQ(found.open_edge->from, wide.vertices[0]);
  EXPECT_EQ(found.open_edge->to, wide.vertices[1]);
}

/// Babylon's and everybody's sphere, as it is computed naively: a seam at 2 pi that is not the one at 0, and poles that
/// are rings of sin(pi) = 1.2e-16, open in their middle.
Mesh naive_sphere(double radius, int rows, int columns) {
  Mesh mesh;
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j <= columns; ++j) {
      const double a = std::numbers::pi * i / rows, f = 2 * std::numbers::pi * j / columns;
      mesh.vertices.push_back(radius * Vec3(std::sin(a) * std::cos(f), std::cos(a), std::sin(a) * std::sin(f)));
    }
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const auto v = [&](int down, int along) { return std::uint32_t((i + down) * (columns + 1) + j + along); };
      mesh.triangles.push_back({v(0, 0), v(1, 0), v(0, 1)});
      mesh.triangles.push_back({v(1, 0), v(1, 1), v(0, 1)});
    }
  return mesh;
}

TEST(Hair, SeamsAndPolesThatMissByARoundingAreClosed) {
  for (const double radius : {1e-9, 1.0, 1e9}) {
    const Mesh sphere = naive_sphere(radius, 12, 20);
    EXPECT_FALSE(geometry::solid_of(sphere, 0).closed) << "the seam is not what this test is about";
    const Solid solid = geometry::solid_of(sphere, geometry::kClosedWithin);
    ASSERT_TRUE(solid.closed);
    EXPECT_EQ(solid.surface->mesh.triangles.size(), 2u * 20 * 11);  // the poles' slivers are no facets
    EXPECT_LT(solid.closed_within, 1e-15 * radius);
    EXPECT_EQ(answer(cube(radius / 2), Vec3(0, 0.1 * radius, 0), sphere), kContained);
    EXPECT_EQ(answer(cube(radius / 2), Vec3(0, 2 * radius, 0), sphere), kApart);
    EXPECT_EQ(answer(sphere, Vec3(0, 0, 0), cube(4 * radius)), kContained);
  }
}

// Every facet's corners rounded to float after a rotation of their own, a step too high or too low, as in binary STL.
TEST(Hair, RoundingsOfFloatsAreOneCorner) {
  std::mt19937 random(12);
  SCOPED_TRACE("seed 12");
  Mesh stl = soup_of(geometry::sphere("ball", 1.7, 6));
  for (Vec3& v : stl.vertices)
    for (int k = 0; k < 3; ++k) {
      const float x = float(v[k] + 0.3), step = std::nextafter(2.0f, 3.0f) - 2.0f;  // of the greatest coordinate
      v[k] = x + step * float(int(random() % 3) - 1);
    }
  EXPECT_FALSE(geometry::solid_of(stl, 0).closed);
  const Solid solid = geometry::solid_of(stl, geometry::kClosedWithin);
  EXPECT_TRUE(solid.closed) << geometry::open_text(solid);
  EXPECT_EQ(answer(cube(1), Vec3(0.3, 0.3, 0.3), stl), kContained);
}

// A rim finer than the width is a rim: a bowl does not become closed because its border is a chain of near corners.
TEST(Hair, AFineBorderIsNoHair) {
  Mesh bowl;
  constexpr int kRim = 4000;
  bowl.vertices.push_back({0, 0, -1});
  for (int i = 0; i < kRim; ++i) {
    const double a = 2 * std::numbers::pi * i / kRim;
    bowl.vertices.push_back({std::cos(a), std::sin(a), 0});
    bowl.triangles.push_back({0, std::uint32_t(1 + i), std::uint32_t(1 + (i + 1) % kRim)});
  }
  const double within = 1e-3;  // of 2 m: beyond the rim's steps of 1.6 mm
  EXPECT_FALSE(geometry::solid_of(bowl, within).closed);
  EXPECT_FALSE(oracle::closed_surface(bowl, within));
  // Three in a row, each near the next and the ends not: no group either.
  Mesh chain = soup_of(cube(2));
  std::vector<std::uint32_t> here;
  for (std::uint32_t v = 0; v < chain.vertices.size(); ++v)
    if (chain.vertices[v] == Vec3(1, 1, 1)) here.push_back(v);
  ASSERT_GE(here.size(), 3u);
  chain.vertices[here[1]].x() += 0x1p-10;
  chain.vertices[here[2]].x() += 0x1p-9;
  EXPECT_FALSE(geometry::solid_of(chain, 0x1p-11 * 1.5).closed);  // a width of 0.75 times the whole
  EXPECT_FALSE(oracle::closed_surface(chain, 0x1p-11 * 1.5));
  EXPECT_TRUE(geometry::solid_of(chain, 0x1p-10).closed);  // all of it
  EXPECT_TRUE(oracle::closed_surface(chain, 0x1p-10));
}

// A closed detail smaller than the width is a detail: only corners of open edges are joined.
TEST(Hair, WhatIsClosedIsNotTouchedHoweverSmall) {
  Mesh mesh = cube_with_hair(2, 0x1p-30);
  const double tiny = 0x1p-24;
  const Mesh speck = cube(tiny);
  const auto first = std::uint32_t(mesh.vertices.size());
  for (const Vec3& v : speck.vertices) mesh.vertices.push_back(v + Vec3(3, 0, 0));
  for (const auto& [a, b, c] : speck.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  const Solid solid = geometry::solid_of(mesh, geometry::kClosedWithin);
  ASSERT_TRUE(solid.closed);
  EXPECT_EQ(solid.surface->mesh.triangles.size(), 24u);
  EXPECT_EQ(answer(cube(tiny / 4), Vec3(3, 0, 0), mesh), kContained);
  // An open one of that size closes by vanishing: of a lone facet nothing is left, and the cube is what it was.
  Mesh flake = cube(2);
  const auto v = std::uint32_t(flake.vertices.size());
  for (const Vec3& p : {Vec3(3, 0, 0), Vec3(3 + tiny, 0, 0), Vec3(3, tiny, 0)}) flake.vertices.push_back(p);
  flake.triangles.push_back({v, v + 1, v + 2});
  const Solid whole = geometry::solid_of(flake, geometry::kClosedWithin);
  ASSERT_TRUE(whole.closed);
  EXPECT_EQ(places(whole.surface->mesh), places(cube(2)));
  EXPECT_FALSE(geometry::solid_of(flake, 0).closed);
}

TEST(Hair, TheOrderOfVerticesAndFacetsDoesNotMatter) {
  constexpr unsigned kSeed = 77;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 random(kSeed);
  const Mesh sphere = naive_sphere(1, 8, 9);
  const Solid before = geometry::solid_of(sphere, geometry::kClosedWithin);
  ASSERT_TRUE(before.closed);
  for (int i = 0; i < 20; ++i) {
    std::vector<std::uint32_t> to(sphere.vertices.size());
    std::iota(to.begin(), to.end(), 0u);
    std::ranges::shuffle(to, random);
    Mesh mixed;
    mixed.vertices.resize(to.size());
    for (std::size_t v = 0; v < to.size(); ++v) mixed.vertices[to[v]] = sphere.vertices[v];
    for (const auto& [a, b, c] : sphere.triangles) mixed.triangles.push_back({to[b], to[c], to[a]});
    std::ranges::shuffle(mixed.triangles, random);
    const Solid after = geometry::solid_of(mixed, geometry::kClosedWithin);
    ASSERT_TRUE(after.closed);
    EXPECT_EQ(after.closed_within, before.closed_within);
    EXPECT_EQ(places(after.surface->mesh), places(before.surface->mesh));
  }
}

// The closed surface of the cube with a slit has its top at z = 1, the least of the corners that became one. As read
// the top is above, so a body there meets nothing: what it is to the cube is decided by the closed surface.
TEST(Hair, InTheHairTheClosedSurfaceDecides) {
  constexpr double kSlit = 0x1p-10, kWithin = 0x1p-10;  // a width of 2 slits
  const Mesh slit = slit_cube(kSlit);
  ASSERT_TRUE(geometry::solid_of(slit, kWithin).closed);
  const Mesh plate = geometry::box("plate", {1, 1, kSlit / 4});
  const auto at = [&](double bottom, double x = 0) { return Pose{{}, Vec3(x, 0, bottom + kSlit / 8)}; };
  const auto ask = [&](const Pose& pose) {
    const Answer found = answer(plate, pose, slit, Pose{}, kWithin);
    EXPECT_EQ(oracle_answer(plate, pose, slit, Pose{}, kWithin), found);
    return found;
  };
  EXPECT_EQ(ask(at(1 - kSlit)), kContained);                         // below
  EXPECT_EQ(ask(at(1 - kSlit / 4)), kApart);                         // its top touches the closed surface
  EXPECT_EQ(ask(at(1 - kSlit / 8)), kApart);                         // it crosses it
  EXPECT_EQ(ask(at(1)), kApart);                                     // its bottom touches it
  EXPECT_EQ(ask(at(1 + kSlit / 4)), kApart);                         // above it, below the top as read
  EXPECT_EQ(ask(at(1 + kSlit * 3 / 4)), kMeet);                      // touches the top as read
  EXPECT_EQ(ask(at(1 + kSlit / 4, 1)), kApart);                      // out through the slit
  EXPECT_EQ(ask(at(1 - kSlit, 1)), kMeet);                           // through the side
  EXPECT_EQ(answer(plate, at(1 - kSlit), slit, Pose{}, 0), kApart);  // open: holds nothing
}

TEST(Contain, AnOpenBodyCanBeInsideAndHoldsNothing) {
  Mesh cup = cube(2);
  cup.triangles.pop_back();
  EXPECT_EQ(answer(cup, {0, 0, 0}, cube(8)), kContained);
  EXPECT_EQ(answer(cup, {6, 0, 0}, cube(8)), kApart);
  EXPECT_EQ(answer(cube(1), {0, 0, 0}, cup), kApart);
  EXPECT_EQ(answer(cup, {0, 0, 0}, cube(1)), kApart);
}

// Plates, grains and cups near the walls of meshes with slits and frayed corners, so that many are in the hair.
TEST(Hair, AgreesWithTheOracleAtRandom) {
  constexpr unsigned kSeed = 2024;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937_64 random(kSeed);
  const auto real = [&] { return static_cast<double>(static_cast<std::int64_t>(random())) * 0x1p-63; };
  constexpr double kWithin = 0x1p-10;
  int counts[4] = {};
  for (int i = 0; i < 400; ++i) {
    Mesh outer = i % 3 ? slit_cube(0x1p-10) : soup_of(naive_sphere(1, 4, 5));
    for (Vec3& v : outer.vertices) v += 0x1p-12 * Vec3(real(), real(), real());
    if (i % 7 == 0) outer.triangles.erase(outer.triangles.begin() + int(random() % outer.triangles.size()));
    Mesh inner = geometry::box("grain", Vec3(1, 1, 1) * 0x1p-12 + Vec3(real() > 0 ? 0.2 : 0, real() > 0 ? 0.1 : 0, 0));
    if (i % 5 == 0) inner.triangles.pop_back();
    // Near the top in the cube's own frame, then both turned alike.
    const double z = i % 3 ? 1 + 0x1p-10 * 1.5 * real() : 0.9 + 0.1 * real();
    const auto q = geometry::normalised({real(), real(), real(), real()});
    const Vec3 local(0.5 * real(), 0.5 * real(), z);
    const Pose at_a{q, geometry::rotation(q) * local}, at_b{q, Vec3(0, 0, 0)};
    const Answer expected = oracle_answer(inner, at_a, outer, at_b, kWithin);
    ASSERT_EQ(answer(inner, at_a, outer, at_b, kWithin), expected) << "case " << i;
    ++counts[expected.meet ? 0 : !expected.contained ? 1 : expected.inside == 'a' ? 2 : 3];
  }
  for (const int k : {0, 1, 2}) EXPECT_GE(counts[k], 25) << k;
}

// ---- What parity makes hollow -------------------------------------------------------------------------------------

namespace {
geometry::Shells shells(const Mesh& mesh) {
  return geometry::shells_of(mesh, geometry::solid_of(mesh, geometry::kClosedWithin));
}
}  // namespace

TEST(Shells, OneOrSeveralApartAreNothingToSay) {
  for (const Mesh& mesh :
       {cube(2), soup_of(cube(2)), both(cube(2), cube(2), {5, 0, 0}), both(cube(8), cube(4), {0, 0, 0}, true)}) {
    const geometry::Shells found = shells(mesh);
    EXPECT_EQ(found.repeated_facets + found.meeting + found.nested_alike, 0u);
  }
  // A shell, its cavity, and an island in the cavity that faces outwards again.
  EXPECT_EQ(shells(both(both(cube(8), cube(4), {0, 0, 0}, true), cube(1), {0, 0, 0})).nested_alike, 0u);
}

TEST(Shells, FacetsThatStandTwiceAreCounted) {
  EXPECT_EQ(shells(both(cube(2), cube(2), {0, 0, 0})).repeated_facets, 12u);
  EXPECT_EQ(shells(both(cube(2), cube(2), {0, 0, 0}, true)).repeated_facets, 12u);  // both sides of each
  Mesh twice = cube(2);
  const auto [a, b, c] = twice.triangles[3];
  twice.triangles.push_back({b, c, a});
  EXPECT_EQ(shells(twice).repeated_facets, 1u);
  EXPECT_FALSE(geometry::solid_of(twice, 0).closed);
  // Nothing is inside a cube that stands twice: this is what the warning is about.
  EXPECT_EQ(answer(cube(1), {0, 0, 0}, both(cube(2), cube(2), {0, 0, 0})), kApart);
}

TEST(Shells, ThoseThatMeetAndThoseThatLieInOthersAreCounted) {
  const Mesh crossing = both(both(cube(4), cube(4), {2, 1, 1}), cube(1), {20, 0, 0});
  EXPECT_EQ(shells(crossing).shells, 3u);
  EXPECT_EQ(shells(crossing).meeting, 2u);
  EXPECT_EQ(answer(cube(0.5), {1, 0.5, 0.5}, crossing), kApart);  // in both
  const Mesh nested = both(cube(8), cube(4), {0, 0, 0});
  EXPECT_EQ(shells(nested).nested_alike, 1u);
  EXPECT_EQ(answer(cube(1), {0, 0, 0}, nested), kApart);
  // Wholly inside out is no different.
  Mesh turned = nested;
  for (auto& f : turned.triangles) std::swap(f[0], f[1]);
  EXPECT_EQ(shells(turned).nested_alike, 1u);
}
