// The decision against the oracle: over a million pairs of triangles and eleven thousand pairs of small meshes, class
// by class.
//
// Seconds, not milliseconds: exact numbers take some microseconds a pair. Every class must hold both answers, so that a
// comparison in which nothing meets is not mistaken for agreement. Without the error bounds of
// geometry/decision/exact.cpp's filter (both constants 0) 13 of these tests fail: 2026-11-22.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "geometry/decision/meet.hpp"
#include "geometry/meshes/shapes.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/random.hpp"

namespace {

using namespace geometry;
using tests::Random;

constexpr unsigned kSeed = 20260801;

double ulps_away(double x, int ulps) {
  for (; ulps > 0; --ulps) x = std::nextafter(x, DBL_MAX);
  for (; ulps < 0; ++ulps) x = std::nextafter(x, -DBL_MAX);
  return x;
}

Triangle placed(const Triangle& t, const Pose& pose, double scale = 1) {
  const Mat3 r = rotation(pose.q);
  const Vec3 p = scale * t[0], q = scale * t[1], s = scale * t[2];
  return {to_world(r, pose.t, p), to_world(r, pose.t, q), to_world(r, pose.t, s)};
}

// ---- Pairs of triangles

struct Two {
  Triangle a, b;
};
using Draw = std::function<Two(Random&, int)>;

struct Counts {
  std::size_t meeting = 0, apart = 0, wrong = 0;
};

/// Asks `decision` and the oracle about `count` pairs, in either order alternately.
template <class Decide>
Counts compare(const Draw& draw, int count, Decide decision) {
  Random random(kSeed);
  Counts out;
  for (int i = 0; i < count; ++i) {
    const auto [a, b] = draw(random, i);
    const bool meet = !oracle::apart_along_an_axis(a, b) && oracle::triangles_meet(a, b);
    ++(meet ? out.meeting : out.apart);
    out.wrong += (i % 2 ? decision(a, b) : decision(b, a)) != meet;
  }
  return out;
}

Two general(Random& random, int) { return {random.triangle(), random.triangle()}; }

/// A corner of one is a corner of the other, or lies rounded on an edge or in the face.
Two vertex_contact(Random& random, int i) {
  Two out{random.triangle(), random.triangle()};
  const double s = std::fabs(random.real()), t = i % 3 == 1 ? 0 : std::fabs(random.real()) * (1 - s);
  Vec3& corner = out.b[std::size_t(i / 3 % 3)];
  const Vec3 from = corner;
  corner = i % 3 == 0 ? out.a[std::size_t(random.integer(0, 2))]
                      : Vec3(out.a[0] + s * (out.a[1] - out.a[0]) + t * (out.a[2] - out.a[0]));
  if (i % 2 && i % 3 == 0)  // nearly a shared corner, and the rest elsewhere
    corner[random.integer(0, 2)] += std::ldexp(random.real(), -random.integer(1, 52));
  for (Vec3& p : out.b)
    if (&p != &corner) p += corner - from;
  return out;
}

/// Two faces in one plane with an edge, a part or nothing in common, turned: then rounded out of the plane.
Two face_contact(Random& random, int i) {
  const auto flat = [&] { return Vec3(random.integer(-4, 4), random.integer(-4, 4), 0); };
  const Pose pose{random.turn(), i % 2 ? Vec3::Zero().eval() : random.point()};
  const auto triangle = [&] {
    const Vec3 p = flat(), q = flat(), r = flat();
    return Triangle{p, q, r};
  };
  const Triangle a = triangle(), b = triangle();
  return {placed(a, pose, 0.25), placed(b, pose, 0.25)};
}

/// Exactly in one plane: multiples of two integer vectors.
Two coplanar(Random& random, int) {
  const Vec3 u = random.grid_point(5), v = random.grid_point(5), o = random.grid_point(9);
  const auto in_plane = [&] {
    const int k = random.integer(-4, 4), l = random.integer(-4, 4);
    return Vec3(o + k * u + l * v);
  };
  const auto triangle = [&] {
    const Vec3 p = in_plane(), q = in_plane(), r = in_plane();
    return Triangle{p, q, r};
  };
  const Triangle a = triangle(), b = triangle();
  return {a, b};
}

/// The smaller lies within the other's outline: in its plane as rounded, or off it by some ulps.
Two nested(Random& random, int i) {
  const Triangle a = random.triangle();
  Triangle b;
  for (Vec3& p : b) {
    double s = std::fabs(random.real()), t = std::fabs(random.real());
    if (s + t > 1) s = 1 - s, t = 1 - t;
    p = a[0] + (0.1 + 0.7 * s) * (a[1] - a[0]) + (0.1 + 0.7 * t) * (a[2] - a[0]);
  }
  const Vec3 n = (a[1] - a[0]).cross(a[2] - a[0]);
  if (i % 2)
    for (Vec3& p : b) p += 0x1p-52 * random.integer(-2, 6) * n;
  return {a, b};
}

Two slivers(Random& random, int i) {
  const auto sliver = [&]() -> Triangle {
    const Vec3 p = random.point(), q = random.point();
    const double s = random.real(), thickness = std::pow(10.0, -random.integer(3, 18));
    return {p, q, p + s * (q - p) + thickness * random.point()};
  };
  Two out{sliver(), i % 2 ? sliver() : random.triangle()};
  if (i % 4 < 3) {  // through a point of the first, nearly
    const Vec3 shift = out.a[0] + 0.4 * (out.a[1] - out.a[0]) - (out.b[0] + 0.3 * (out.b[1] - out.b[0]));
    for (Vec3& p : out.b) p += shift;
  }
  return out;
}

/// Points, segments and proper triangles in every combination, mostly in contact or near it.
Two degenerates(Random& random, int i) {
  const int n = 1 + i / 9 % 2;
  const auto simplex = [&](int dimension) -> Triangle {
    const Vec3 p = random.grid_point(n), d = random.grid_point(n), e = random.grid_point(n);
    if (dimension == 0) return {p, p, p};
    const int k = random.integer(-2, 2), l = random.integer(-2, 2);
    if (dimension == 1) return {p, p + k * d, p + l * d};
    return {p, p + d, p + e};
  };
  const Triangle a = simplex(i % 3);
  Triangle b = simplex(i / 3 % 3);
  if (i % 5 == 0) b[0].x() = ulps_away(b[0].x(), random.integer(-1, 1));
  return {a, b};
}

Two denormals(Random& random, int i) {
  const int n = i % 2 ? 2 : 4000;
  const auto triangle = [&] {
    const Vec3 p = random.grid_point(n), q = random.grid_point(n), r = random.grid_point(n);
    return Triangle{0x1p-1074 * p, 0x1p-1074 * q, 0x1p-1074 * r};
  };
  const Triangle a = triangle(), b = triangle();
  return {a, b};
}

/// General position and grids, placed so far away that few bits are left of them.
Two far_away(Random& random, int i) {
  const Vec3 o = std::pow(10.0, random.integer(3, 15)) * random.point();
  const auto move = [&](const Triangle& t) { return Triangle{t[0] + o, t[1] + o, t[2] + o}; };
  const Two two = i % 2 ? general(random, i) : vertex_contact(random, i);
  return {move(two.a), move(two.b)};
}

/// From where products underflow to where they overflow.
Two sizes(Random& random, int i) {
  const int exponent = random.integer(-1060, 1015);
  const auto scale = [&](const Triangle& t) {
    Triangle out = t;
    for (Vec3& p : out)
      for (int k = 0; k < 3; ++k) p[k] = std::ldexp(p[k], exponent);
    return out;
  };
  const Two two = i % 3 == 0 ? general(random, i) : i % 3 == 1 ? coplanar(random, i) : vertex_contact(random, i);
  return {scale(two.a), scale(two.b)};
}

/// Up to 1000 ulps on either side of contact along one coordinate: 30 pairs of each position that is found.
struct Grazing {
  Triangle a, b;
  int axis = 0;

  Two operator()(Random& random, int i) {
    if (i % 30 == 0) find(random);
    Triangle moved = b;
    const int reach = i % 3 == 0 ? 1000 : i % 3 == 1 ? 30 : 2;
    const double by = random.integer(-reach, reach) * ulp();
    for (Vec3& p : moved) p[axis] += by;
    return {a, moved};
  }
  double ulp() const {
    double most = 0;
    for (const Vec3& p : b) most = std::max(most, std::fabs(p[axis]));
    return std::nextafter(most, DBL_MAX) - most;
  }
  void find(Random& random) {
    for (;;) {
      const double offset = random.integer(0, 2) * 1000;
      const Triangle from = random.triangle();
      a = random.triangle();
      for (Vec3& p : a) p += Vec3(offset, -offset, offset / 2);
      axis = random.integer(0, 2);
      const auto move = [&](double by) {
        for (std::size_t k = 0; k < 3; ++k) {
          b[k] = from[k] + Vec3(offset, -offset, offset / 2);
          b[k][axis] += by;
        }
        return triangles_meet(a, b);
      };
      double meet = 0, apart = 3;  // no triangle of this size reaches so far
      if (!move(meet)) continue;
      for (int k = 0; k < 64; ++k) {
        const double middle = meet + 0.5 * (apart - meet);
        (move(middle) ? meet : apart) = middle;
      }
      move(meet);
      return;
    }
  }
};

constexpr int kPairs = 92000;  // of each of eleven classes

void expect_agreement(const std::string& name, const Draw& draw) {
  const Counts counts =
      compare(draw, kPairs, [](const Triangle& a, const Triangle& b) { return triangles_meet(a, b); });
  std::printf("%-15s %7zu meet, %7zu are apart, seed %u\n", name.c_str(), counts.meeting, counts.apart, kSeed);
  EXPECT_EQ(counts.wrong, 0u) << name << ", seed " << kSeed;
  EXPECT_GE(counts.meeting, std::size_t(kPairs) / 50) << name;
  EXPECT_GE(counts.apart, std::size_t(kPairs) / 50) << name;
}

TEST(MillionTriangles, GeneralPosition) { expect_agreement("general", general); }
TEST(MillionTriangles, VertexContact) { expect_agreement("vertex contact", vertex_contact); }
TEST(MillionTriangles, RotatedFaceContact) { expect_agreement("face contact", face_contact); }
TEST(MillionTriangles, GrazingWithinAThousandUlps) { expect_agreement("grazing", Grazing()); }
TEST(MillionTriangles, Degenerate) { expect_agreement("degenerate", degenerates); }
TEST(MillionTriangles, Nested) { expect_agreement("nested", nested); }
TEST(MillionTriangles, Coplanar) { expect_agreement("coplanar", coplanar); }
TEST(MillionTriangles, Slivers) { expect_agreement("slivers", slivers); }
TEST(MillionTriangles, Denormals) { expect_agreement("denormals", denormals); }
TEST(MillionTriangles, FarFromTheOrigin) { expect_agreement("far away", far_away); }
TEST(MillionTriangles, HugeAndTiny) { expect_agreement("sizes", sizes); }

// Wrong decisions of the kinds that happen are found: one that takes touching for apart, one in plain doubles, and one
// that errs once.
TEST(MillionTriangles, WrongDecisionsAreFound) {
  constexpr int kFew = 3000;
  const auto open_sets = [](const Triangle& a, const Triangle& b) {  // shrunk by an ulp or so
    const auto shrunk = [](const Triangle& t) {
      const Vec3 c = (t[0] + t[1] + t[2]) / 3;
      const auto in = [&](const Vec3& p) { return Vec3(c + (1 - 0x1p-50) * (p - c)); };
      return Triangle{in(t[0]), in(t[1]), in(t[2])};
    };
    return triangles_meet(shrunk(a), shrunk(b));
  };
  const auto plain = [](const Triangle& a, const Triangle& b) {  // the sides of corners in doubles, no filter
    const auto apart = [](const Triangle& s, const Triangle& t) {
      const Vec3 n = (s[1] - s[0]).cross(s[2] - s[0]);
      const double d0 = n.dot(t[0] - s[0]), d1 = n.dot(t[1] - s[0]), d2 = n.dot(t[2] - s[0]);
      return (d0 > 0 && d1 > 0 && d2 > 0) || (d0 < 0 && d1 < 0 && d2 < 0);
    };
    return !apart(a, b) && !apart(b, a) && triangles_meet(a, b);
  };
  int asked = 0;
  const auto once = [&](const Triangle& a, const Triangle& b) { return triangles_meet(a, b) != (++asked == 1234); };
  EXPECT_GT(compare(vertex_contact, kFew, open_sets).wrong, 0u);
  EXPECT_GT(compare(coplanar, kFew, open_sets).wrong, 0u);
  EXPECT_GT(compare(face_contact, kFew, plain).wrong, 0u);
  EXPECT_EQ(compare(general, kFew, once).wrong, 1u);
}

// ---- Pairs of small meshes

Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

/// 30 facets anywhere in a cube of edge 2; every third is a segment or a point.
Mesh soup() {
  Random random(kSeed);
  Mesh mesh;
  for (int i = 0; i < 60; ++i) mesh.vertices.push_back(random.point());
  for (int i = 0; i < 30; ++i) {
    const auto draw = [&] { return std::uint32_t(random.integer(0, 59)); };
    const std::uint32_t p = draw(), q = draw(), r = draw();
    mesh.triangles.push_back({p, i % 6 == 3 ? p : q, i % 3 ? r : p});
  }
  return mesh;
}

/// A square sheet of 8 facets in the plane z = 0.
Mesh sheet() {
  Mesh mesh;
  for (int i = 0; i < 9; ++i) mesh.vertices.push_back(Vec3(i % 3 - 1, i / 3 - 1, 0));
  for (const std::uint32_t corner : {0u, 1u, 3u, 4u}) {
    mesh.triangles.push_back({corner, corner + 1, corner + 4});
    mesh.triangles.push_back({corner, corner + 4, corner + 3});
  }
  return mesh;
}

Mesh scaled(Mesh mesh, const Vec3& by) {
  for (Vec3& v : mesh.vertices) v = v.cwiseProduct(by).eval();
  return mesh;
}

struct Bodies2 {
  Bodies bodies;
  std::vector<Pose> poses{2};

  Bodies2(Mesh a, Mesh b) {
    bodies.meshes = {std::move(a), std::move(b)};
    bodies.name = {"a", "b"};
    bodies.mesh = {0, 1};
    bodies.fixed = {0, 0};
  }
};

/// Sets two poses. `size` is the size of the meshes, metres.
using Place = std::function<void(Random&, double size, std::vector<Pose>&)>;

void anywhere(Random& random, double size, std::vector<Pose>& poses) {
  for (Pose& pose : poses) {
    const Quaternion q = random.turn();
    pose = {q, 0.8 * size * random.point()};
  }
}

void on_a_lattice(Random& random, double size, std::vector<Pose>& poses) {
  const Quaternion turns[] = {{}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}, {0.5, 0.5, 0.5, 0.5}};
  for (Pose& pose : poses) {
    const Quaternion q = turns[random.integer(0, 4)];
    pose = {q, 0.5 * size * random.grid_point(2)};
  }
}

/// One turn for both, one face's width apart: faces, edges and corners coincide before rounding.
void turned_lattice(Random& random, double size, std::vector<Pose>& poses) {
  const Quaternion q = random.turn();
  const Mat3 r = rotation(q);
  const Vec3 o = size * random.point(), step = 0.5 * size * random.grid_point(2);
  poses[0] = {q, o};
  poses[1] = {q, to_world(r, o, step)};
}

/// Corner 0 of both meshes at one point of the world, as rounded.
struct AtOneCorner {
  Vec3 a, b;
  void operator()(Random& random, double size, std::vector<Pose>& poses) const {
    const Vec3 o = size * random.point();
    const Quaternion q = random.turn(), p = random.turn();
    poses[0] = {q, o - to_world(rotation(q), Vec3::Zero(), a)};
    poses[1] = {p, o - to_world(rotation(p), Vec3::Zero(), b)};
  }
};

void with_one_centre(Random& random, double size, std::vector<Pose>& poses) {
  for (Pose& pose : poses) {
    const Quaternion q = random.turn();
    pose = {q, 0.05 * size * random.point()};
  }
}

Place far(double distance) {
  return [distance](Random& random, double size, std::vector<Pose>& poses) {
    anywhere(random, size, poses);
    const Vec3 o = distance * size * random.point();
    for (Pose& pose : poses) pose.t += o;
  };
}

/// Moves the second body along x to contact and then up to 1000 ulps off.
void grazing(Random& random, double size, std::vector<Pose>& poses, Decision& decision) {
  do {
    anywhere(random, size, poses);
  } while (!decision.meet(poses, {0, 1}));
  double& x = poses[1].t.x();
  double meets = x, apart = x + 8 * size;
  for (int k = 0; k < 64; ++k) {
    x = meets + 0.5 * (apart - meets);
    (decision.meet(poses, {0, 1}) ? meets : apart) = x;
  }
  const int reach = random.integer(0, 1) ? 1000 : 3;
  x = ulps_away(meets, random.integer(-reach, reach));
}

/// The tests below ask about 11,790 pairs in all.
Counts compare_meshes(const std::string& name, int count, const Mesh& a, const Mesh& b, double size, const Place& place,
                      bool graze = false) {
  EXPECT_TRUE(a.triangles.size() >= 4 && a.triangles.size() <= 60 && b.triangles.size() >= 4 &&
              b.triangles.size() <= 60)
      << name << ": " << a.triangles.size() << ", " << b.triangles.size();
  Random random(kSeed);
  Bodies2 two(a, b);
  const std::vector<Bvh> bvhs = build_bvhs(two.bodies);
  Decision decision(two.bodies, bvhs);
  Counts out;
  for (int i = 0; i < count; ++i) {
    if (graze)
      grazing(random, size, two.poses, decision);
    else
      place(random, size, two.poses);
    const bool meet = oracle::meet(oracle::world_triangles(a, two.poses[0]), oracle::world_triangles(b, two.poses[1]));
    ++(meet ? out.meeting : out.apart);
    out.wrong += decision.meet(two.poses, {0, 1}) != meet;
  }
  EXPECT_EQ(out.wrong, 0u) << name << ", seed " << kSeed;
  return out;
}

void expect_both(const std::string& name, const std::vector<Counts>& parts) {
  Counts sum;
  for (const Counts& part : parts) sum.meeting += part.meeting, sum.apart += part.apart;
  std::printf("%-15s %7zu meet, %7zu are apart, seed %u\n", name.c_str(), sum.meeting, sum.apart, kSeed);
  EXPECT_GE(sum.meeting, (sum.meeting + sum.apart) / 50) << name;
  EXPECT_GE(sum.apart, (sum.meeting + sum.apart) / 50) << name;
}

Mesh cube() { return box("cube", Vec3(1, 1, 1)); }
Mesh ball() { return sphere("ball", 0.6, 2); }
Mesh knot() { return torus_knot("knot", 0.5, 0.15, 10, 3, 2, 3); }

TEST(TenThousandMeshes, GeneralPosition) {
  expect_both("general", {compare_meshes("cubes", 400, cube(), cube(), 1, anywhere),
                          compare_meshes("cube and ball", 400, cube(), ball(), 1, anywhere),
                          compare_meshes("tetrahedra", 400, tetrahedron(), tetrahedron(), 1, anywhere)});
}
TEST(TenThousandMeshes, VertexContact) {
  const auto at = [](const Mesh& a, const Mesh& b) { return AtOneCorner{a.vertices[0], b.vertices[0]}; };
  expect_both("vertex contact",
              {compare_meshes("cubes", 500, cube(), cube(), 1, at(cube(), cube())),
               compare_meshes("tetrahedra", 500, tetrahedron(), tetrahedron(), 1, at(tetrahedron(), tetrahedron())),
               compare_meshes("on a lattice", 300, cube(), tetrahedron(), 1, on_a_lattice)});
}
TEST(TenThousandMeshes, RotatedFaceContact) {
  expect_both("face contact", {compare_meshes("cubes", 600, cube(), cube(), 1, turned_lattice),
                               compare_meshes("tetrahedra", 400, tetrahedron(), tetrahedron(), 1, turned_lattice)});
}
TEST(TenThousandMeshes, GrazingWithinAThousandUlps) {
  expect_both("grazing", {compare_meshes("cubes", 400, cube(), cube(), 1, {}, true),
                          compare_meshes("balls", 300, ball(), ball(), 1, {}, true),
                          compare_meshes("soup and cube", 300, soup(), cube(), 1, {}, true)});
}
TEST(TenThousandMeshes, DegenerateTriangles) {
  const Mesh small = scaled(soup(), 0.3 * Vec3(1, 1, 1));
  expect_both("degenerate",
              {compare_meshes("soup and tetrahedron", 300, small, tetrahedron(), 1, anywhere),
               compare_meshes("soups", 300, small, small, 0.6, anywhere),
               compare_meshes("on a lattice", 300, scaled(cube(), Vec3(1, 1, 0)), tetrahedron(), 1, on_a_lattice)});
}
TEST(TenThousandMeshes, Nested) {
  expect_both("nested",
              {compare_meshes("in a cube", 400, scaled(cube(), Vec3(2, 2, 2)), tetrahedron(), 1, with_one_centre),
               compare_meshes("in a ball", 400, ball(), scaled(ball(), Vec3(0.8, 0.8, 0.8)), 1, with_one_centre)});
}
TEST(TenThousandMeshes, Coplanar) {
  const auto slide = [](Random& random, double, std::vector<Pose>& poses) {
    poses[0] = {{}, Vec3(0, 0, 0)};
    const double up = random.integer(0, 2) ? 0 : 0x1p-60;
    poses[1] = {{}, Vec3(0.25 * random.integer(-9, 9), 0.25 * random.integer(-9, 9), up)};
  };
  expect_both("coplanar", {compare_meshes("sheets", 500, sheet(), sheet(), 1, slide),
                           compare_meshes("turned sheets", 300, sheet(), sheet(), 2, turned_lattice)});
}
TEST(TenThousandMeshes, Slivers) {
  const Mesh needle = scaled(ball(), Vec3(1, 1e-9, 1e-7)), blade = scaled(cube(), Vec3(1, 1e-12, 1));
  expect_both("slivers", {compare_meshes("needle and blade", 500, needle, blade, 0.6, anywhere),
                          compare_meshes("blades", 300, blade, blade, 0.8, anywhere),
                          compare_meshes("needle and knot", 200, needle, knot(), 0.6, anywhere)});
}
TEST(TenThousandMeshes, Denormals) {
  std::vector<Counts> parts;
  for (const double scale : {1e-318, 1e-310, 1e-300}) {
    const Vec3 by = scale * Vec3(1, 1, 1);
    parts.push_back(compare_meshes("cube and ball", 200, scaled(cube(), by), scaled(ball(), by), scale, anywhere));
    parts.push_back(compare_meshes("cubes", 100, scaled(cube(), by), scaled(cube(), by), scale, turned_lattice));
  }
  expect_both("denormals", parts);
}
TEST(TenThousandMeshes, FarFromTheOrigin) {
  std::vector<Counts> parts;
  for (const double distance : {1e3, 1e9, 1e12, 1e15}) {
    parts.push_back(compare_meshes("cubes", 150, cube(), cube(), 1, far(distance)));
    parts.push_back(compare_meshes("ball and tetrahedron", 150, ball(), tetrahedron(), 1, far(distance)));
  }
  expect_both("far away", parts);
}
TEST(TenThousandMeshes, HugeAndTiny) {
  std::vector<Counts> parts;
  for (const double scale : {1e-160, 1e-100, 1e-12, 1e12, 1e100, 1e153, 1e300}) {
    const Vec3 by = scale * Vec3(1, 1, 1);
    parts.push_back(compare_meshes("cubes", 60, scaled(cube(), by), scaled(cube(), by), scale, anywhere));
    parts.push_back(compare_meshes("balls", 60, scaled(ball(), by), scaled(ball(), by), scale, anywhere));
  }
  expect_both("sizes", parts);
}
TEST(TenThousandMeshes, KnotsAndSpheres) {
  expect_both("knots", {compare_meshes("knots", 350, knot(), knot(), 1, anywhere),
                        compare_meshes("knot and ball", 350, knot(), ball(), 1, anywhere),
                        compare_meshes("knots grazing", 150, knot(), knot(), 1, {}, true)});
}

}  // namespace
