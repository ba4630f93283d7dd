// The built-in shapes: closed, outward, true to the surface they stand for, and pinned.
#include "geometry/meshes/shapes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace geometry {
namespace {

constexpr double kPi = std::numbers::pi;

struct Case {
  Mesh mesh;
  std::size_t vertices, triangles;
  int euler;      // vertices - edges + facets
  double volume;  // of the surface it stands for, m^3
  double share;   // of that volume which the mesh holds at least
  std::uint64_t digest;
};

double squared(double x) { return x * x; }

/// Two caps and the frustum between the circles where they meet it.
double capsule_volume(double height, double bottom, double top) {
  const double between = height - bottom - top, sine = (bottom - top) / between;
  const auto cap = [](double radius, double h) { return kPi * h * h * (3 * radius - h) / 3; };
  const double r = bottom * std::sqrt(1 - sine * sine), s = top * std::sqrt(1 - sine * sine);
  const double frustum = kPi / 3 * (between + top * sine - bottom * sine) * (r * r + r * s + s * s);
  return cap(bottom, bottom * (1 + sine)) + cap(top, top * (1 - sine)) + frustum;
}

double torus_volume(double diameter, double thickness) { return kPi * kPi * diameter * squared(thickness / 2); }

Vec3 knot_curve(double radius, double p, double q, double u) {
  const double v = q / p * u;
  return radius / 2 * Vec3((2 + std::cos(v)) * std::cos(u), (2 + std::cos(v)) * std::sin(u), std::sin(v));
}

/// A tube holds its section times the length of its curve, as long as it does not cross itself.
double knot_volume(double radius, double tube, double p, double q) {
  constexpr int kParts = 20000;
  double length = 0;
  for (int i = 0; i < kParts; ++i)
    length +=
        (knot_curve(radius, p, q, 2 * kPi * p * (i + 1) / kParts) - knot_curve(radius, p, q, 2 * kPi * p * i / kParts))
            .norm();
  return kPi * tube * tube * length;
}

/// The shapes with the parameters that scenes use by default or that stand at an end of what is allowed.
const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {sphere("sphere_16", 1, 16), 614, 1224, 2, 4 * kPi / 3, 0.98, 0x99071cd7e41c90cd},
      {sphere("sphere_32", 1, 32), 2246, 4488, 2, 4 * kPi / 3, 0.99, 0x4a61548c2dcebcb5},
      {sphere("sphere_1", 2.5, 1), 14, 24, 2, 4 * kPi / 3 * 15.625, 0.6, 0x3a7aa1a239baa509},
      {box("cube", {1, 1, 1}), 8, 12, 2, 1, 1, 0x2b096dedce495e45},
      {box("slab", {10, 1, 6}), 8, 12, 2, 60, 1, 0x352b9dd921536e85},
      {capsule("hero", 3, 0.6, 0.6, 16), 686, 1368, 2, capsule_volume(3, 0.6, 0.6), 0.98, 0x637eaef4da3a4add},
      {capsule("tapered", 5, 1.4, 0.7, 16), 686, 1368, 2, capsule_volume(5, 1.4, 0.7), 0.98, 0xfa8db23959e4e74d},
      {capsule("inverted", 5, 0.7, 1.4, 16), 686, 1368, 2, capsule_volume(5, 0.7, 1.4), 0.98, 0xf3e8bc4b2dc7b7ad},
      {capsule("coarse", 5, 1.4, 0.7, 1), 32, 60, 2, capsule_volume(5, 1.4, 0.7), 0.7, 0x908629b0146026d5},
      {torus("ring_16", 4, 1, 16), 256, 512, 0, torus_volume(4, 1), 0.94, 0x3ae006dc7c0abce5},
      {torus("ring_32", 4, 1, 32), 1024, 2048, 0, torus_volume(4, 1), 0.98, 0x1fd0f54f85344d45},
      {torus("ring_3", 4, 1, 3), 9, 18, 0, torus_volume(4, 1), 0.15, 0x7cc50389effeef90},
      {torus_knot("knot", 2, 0.5, 32, 32, 2, 3), 1024, 2048, 0, knot_volume(2, 0.5, 2, 3), 0.9, 0x1b750e8a29c4c177},
      {torus_knot("knot_64", 2, 0.5, 64, 32, 2, 3), 2048, 4096, 0, knot_volume(2, 0.5, 2, 3), 0.96, 0x8c05d9568176f39d},
      {torus_knot("knot_5_2", 2, 0.1, 200, 8, 5, 2), 1600, 3200, 0, knot_volume(2, 0.1, 5, 2), 0.85,
       0xcd523d1101011642},
  };
  return all;
}

const Mesh& mesh_named(const std::string& name) {
  return std::ranges::find_if(cases(), [&](const Case& c) { return c.mesh.name == name; })->mesh;
}

double volume(const Mesh& mesh) {
  double sixfold = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sixfold += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c]));
  return sixfold / 6;
}

bool before(const Vec3& p, const Vec3& q) {
  return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
}

/// The vertices, mirrored at the plane across `axis` (none: -1), in an order of their own.
std::vector<Vec3> vertex_set(const Mesh& mesh, int axis = -1) {
  std::vector<Vec3> vertices = mesh.vertices;
  if (axis >= 0)
    for (Vec3& v : vertices) v[axis] = -v[axis];
  std::ranges::sort(vertices, before);
  return vertices;
}

/// The greatest of |distance| over a grid of points on every facet, barycentric weights in parts of `parts`.
double greatest_on_facets(const Mesh& mesh, int parts, const std::function<double(const Vec3&)>& distance) {
  double greatest = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    for (int i = 0; i <= parts; ++i)
      for (int j = 0; i + j <= parts; ++j) {
        const Vec3 p = (i * mesh.vertices[a] + j * mesh.vertices[b] + (parts - i - j) * mesh.vertices[c]) / parts;
        greatest = std::fmax(greatest, std::abs(distance(p)));
      }
  return greatest;
}

/// Signed distance of p from the union of the balls whose centres and radii go over from one sphere to the other,
/// which is their convex hull: by search, not by formula.
double outside_capsule(double height, double bottom, double top, const Vec3& p) {
  const auto outside = [&](double t) {
    const double y = (1 - t) * (bottom - height / 2) + t * (height / 2 - top), radius = (1 - t) * bottom + t * top;
    return (p - Vec3(0, y, 0)).norm() - radius;
  };
  double low = 0, high = 1;
  for (int i = 0; i < 45; ++i) {  // to 1e-8, and the distance to the square of that
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    const bool leave_left = outside(left) > outside(right);
    (leave_left ? low : high) = leave_left ? left : right;
  }
  return std::fmin(outside(low), std::fmin(outside(0), outside(1)));
}

double outside_torus(double diameter, double thickness, const Vec3& p) {
  return (p - diameter / 2 * Vec3(p.x(), 0, p.z()).normalized()).norm() - thickness / 2;
}

TEST(Shapes, AreClosedAndHaveTheGenusOfTheirSurface) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.mesh.shape);
    EXPECT_TRUE(is_closed(c.mesh));
    EXPECT_EQ(c.mesh.vertices.size(), c.vertices);
    EXPECT_EQ(c.mesh.triangles.size(), c.triangles);
    const auto edges = static_cast<int>(3 * c.mesh.triangles.size() / 2);
    EXPECT_EQ(static_cast<int>(c.mesh.vertices.size()) - edges + static_cast<int>(c.mesh.triangles.size()), c.euler);
    for (const Facet& facet : c.mesh.triangles)
      for (const std::uint32_t vertex : facet) ASSERT_LT(vertex, c.mesh.vertices.size());
  }
}

// Counter-clockwise from outside: the signed volume is positive. It is less than the true one: in every case here the
// surface is inscribed, or nearly (the inner side of a ring is not).
TEST(Shapes, FaceOutwardsAndHoldNearlyTheirVolume) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.mesh.shape);
    EXPECT_LE(volume(c.mesh), c.volume * (1 + 1e-12));
    EXPECT_GE(volume(c.mesh), c.volume * c.share);
  }
}

TEST(Shapes, HaveNoFacetWithoutArea) {
  for (const Case& c : cases())
    for (const auto& [i, j, k] : c.mesh.triangles) {
      const Vec3 &p = c.mesh.vertices[i], e = c.mesh.vertices[j] - p, f = c.mesh.vertices[k] - p;
      const double area_squared = e.squaredNorm() * f.squaredNorm() - squared(e.dot(f));
      ASSERT_GT(area_squared, 1e-4 * e.squaredNorm() * f.squaredNorm()) << c.mesh.shape;
    }
}

TEST(Shapes, HaveNoMinusZeroInTheirVertices) {
  for (const Case& c : cases())
    for (const Vec3& v : c.mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) ASSERT_FALSE(v[axis] == 0 && std::signbit(v[axis])) << c.mesh.shape;
}

TEST(Shapes, TellTheirKindAndParametersAsJson) {
  EXPECT_EQ(sphere("s", 1, 16).shape, R"({"kind":"sphere","radius":1,"segments":16})");
  EXPECT_EQ(sphere("s", 0.1, 1).shape, R"({"kind":"sphere","radius":0.1,"segments":1})");
  EXPECT_EQ(box("b", {1e-7, 2.5, 1e30}).shape, R"({"kind":"box","size":[1e-07,2.5,1e+30]})");
  EXPECT_EQ(capsule("c", 5, 1.4, 0.7, 16).shape,
            R"({"kind":"capsule","height":5,"radius_bottom":1.4,"radius_top":0.7,"segments":16})");
  EXPECT_EQ(torus("t", 4, 1, 16).shape, R"({"kind":"torus","diameter":4,"thickness":1,"segments":16})");
  EXPECT_EQ(torus_knot("k", 2, 0.5, 32, 16, 2, 3).shape,
            R"({"kind":"torus_knot","radius":2,"tube":0.5,"radial_segments":32,"tubular_segments":16,"p":2,"q":3})");
  EXPECT_EQ(sphere("pebble", 1, 1).name, "pebble");
}

TEST(Shapes, OnlyASphereHasASphereRadius) {
  for (const Case& c : cases())
    EXPECT_EQ(c.mesh.sphere_radius > 0, c.mesh.shape.find("sphere") != std::string::npos) << c.mesh.shape;
  EXPECT_EQ(mesh_named("sphere_1").sphere_radius, 2.5);
}

// What is pinned: the bytes of vertices and facets, by FNV-1a. Why: algorithms that sample facets depend on their
// order, recorded baselines on every bit. A change here makes old results incomparable and belongs into README's
// Changes.
TEST(Shapes, HaveTheRecordedVerticesAndFacets) {
  for (const Case& c : cases()) {
    std::uint64_t digest = 0xcbf29ce484222325;
    const auto add = [&](std::uint64_t value, int bits) {
      for (int shift = 0; shift < bits; shift += 8) digest = (digest ^ (value >> shift & 0xff)) * 0x100000001b3;
    };
    for (const Vec3& v : c.mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) add(std::bit_cast<std::uint64_t>(v[axis]), 64);
    for (const Facet& facet : c.mesh.triangles)
      for (const std::uint32_t vertex : facet) add(vertex, 32);
    EXPECT_EQ(digest, c.digest) << c.mesh.name;
  }
}

TEST(Sphere, BeginsAtThePoleAndRunsRowByRow) {
  const Mesh& mesh = mesh_named("sphere_16");
  const auto near = [&](std::size_t i, const Vec3& expected) {
    EXPECT_LT((mesh.vertices[i] - expected).norm(), 1e-15) << "vertex " << i;
  };
  const double ten = kPi / 18;
  EXPECT_EQ(mesh.vertices[0], Vec3(0, 1, 0));
  near(1, {std::sin(ten), std::cos(ten), 0});
  near(2, {std::sin(ten) * std::cos(ten), std::cos(ten), -std::sin(ten) * std::sin(ten)});
  near(10, {0, std::cos(ten), -std::sin(ten)});
  near(37, {std::sin(2 * ten), std::cos(2 * ten), 0});
  EXPECT_EQ(mesh.vertices[1 + 8 * 36], Vec3(1, 0, 0));
  EXPECT_EQ(mesh.vertices[1 + 8 * 36 + 9], Vec3(0, 0, -1));
  EXPECT_EQ(mesh.vertices[1 + 8 * 36 + 18], Vec3(-1, 0, 0));
  EXPECT_EQ(mesh.vertices[1 + 8 * 36 + 27], Vec3(0, 0, 1));
  EXPECT_EQ(mesh.vertices[613], Vec3(0, -1, 0));

  EXPECT_EQ(mesh.triangles[0], (Facet{1, 2, 0}));
  EXPECT_EQ(mesh.triangles[35], (Facet{36, 1, 0}));
  EXPECT_EQ(mesh.triangles[36], (Facet{1, 37, 2}));
  EXPECT_EQ(mesh.triangles[37], (Facet{37, 38, 2}));
  EXPECT_EQ(mesh.triangles[107], (Facet{72, 37, 1}));
  EXPECT_EQ(mesh.triangles[1223], (Facet{612, 613, 577}));
}

TEST(Sphere, HasItsVerticesOnTheSphere) {
  for (const char* name : {"sphere_16", "sphere_32", "sphere_1"}) {
    const Mesh& mesh = mesh_named(name);
    for (const Vec3& v : mesh.vertices) ASSERT_NEAR(v.norm(), mesh.sphere_radius, 4e-16 * mesh.sphere_radius);
  }
}

TEST(Sphere, MirrorsItselfToTheLastBit) {
  for (const char* name : {"sphere_16", "sphere_32"})
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(vertex_set(mesh_named(name)), vertex_set(mesh_named(name), axis)) << name << ", axis " << axis;
}

// Three bands of six columns: the middle band stands upright, its facets 3/4 of the radius from the axis.
TEST(Sphere, DeviatesByAQuarterWithOneSegment) { EXPECT_NEAR(mesh_named("sphere_1").surface_deviation, 0.625, 1e-15); }

// From two other sides: the ball of the facets' planes, and points on every facet.
TEST(Sphere, DeviatesByTheDepthOfItsDeepestFacet) {
  for (const char* name : {"sphere_16", "sphere_32", "sphere_1"}) {
    const Mesh& mesh = mesh_named(name);
    EXPECT_NEAR(mesh.surface_deviation, mesh.sphere_radius - inscribed_radius(mesh), 1e-12);
    const double sampled = greatest_on_facets(mesh, 20, [&](const Vec3& p) { return p.norm() - mesh.sphere_radius; });
    EXPECT_LE(sampled, mesh.surface_deviation + 1e-15);
    EXPECT_GE(sampled, 0.98 * mesh.surface_deviation);
  }
}

TEST(Box, HasItsCornersAtHalfItsSize) {
  const Mesh& mesh = mesh_named("slab");
  EXPECT_EQ(mesh.vertices[0], Vec3(-5, -0.5, -3));
  EXPECT_EQ(mesh.vertices[1], Vec3(5, -0.5, -3));
  EXPECT_EQ(mesh.vertices[2], Vec3(-5, 0.5, -3));
  EXPECT_EQ(mesh.vertices[4], Vec3(-5, -0.5, 3));
  EXPECT_EQ(mesh.vertices[7], Vec3(5, 0.5, 3));
  EXPECT_EQ(mesh.surface_deviation, 0);
  EXPECT_EQ(half_extents(mesh), Vec3(5, 0.5, 3));
}

// Facets 2f and 2f + 1 lie in one face; Babylon.js's order of faces is +z -z +x -x +y -y.
TEST(Box, HasTwoFacetsOnEachFaceInBabylonsOrder) {
  const Mesh& mesh = mesh_named("slab");
  const int axis[] = {2, 2, 0, 0, 1, 1};
  for (std::size_t f = 0; f < 12; ++f)
    for (const std::uint32_t vertex : mesh.triangles[f])
      EXPECT_EQ(mesh.vertices[vertex][axis[f / 2]] > 0, f / 2 % 2 == 0) << "facet " << f;
  EXPECT_EQ(mesh.triangles[0], (Facet{5, 6, 4}));
  EXPECT_EQ(mesh.triangles[11], (Facet{5, 4, 0}));
}

TEST(Capsule, ReachesFromMinusToPlusHalfItsHeight) {
  for (const char* name : {"hero", "tapered", "inverted", "coarse"}) {
    const Mesh& mesh = mesh_named(name);
    const double half = std::string(name) == "hero" ? 1.5 : 2.5;
    EXPECT_EQ(mesh.vertices.front(), Vec3(0, half, 0));
    EXPECT_EQ(mesh.vertices.back(), Vec3(0, -half, 0));
    EXPECT_EQ(local_box(mesh).max.y(), half);
    EXPECT_EQ(local_box(mesh).min.y(), -half);
  }
}

TEST(Capsule, HasItsVerticesOnTheHullOfTwoSpheres) {
  for (const Vec3& v : mesh_named("hero").vertices) ASSERT_NEAR(outside_capsule(3, 0.6, 0.6, v), 0, 1e-14);
  for (const Vec3& v : mesh_named("tapered").vertices) ASSERT_NEAR(outside_capsule(5, 1.4, 0.7, v), 0, 1e-14);
  for (const Vec3& v : mesh_named("inverted").vertices) ASSERT_NEAR(outside_capsule(5, 0.7, 1.4, v), 0, 1e-14);
}

// 36 columns; 9 bands of cap, 2 of side, 9 of cap. Where equal caps end the radius is reached exactly.
TEST(Capsule, RunsRowByRowFromTheTop) {
  const Mesh& mesh = mesh_named("hero");
  EXPECT_LT((mesh.vertices[1] - Vec3(0.6 * std::sin(kPi / 18), 0.9 + 0.6 * std::cos(kPi / 18), 0)).norm(), 1e-15);
  EXPECT_EQ(mesh.vertices[1 + 8 * 36], Vec3(0.6, 0.9, 0));
  EXPECT_EQ(mesh.vertices[1 + 8 * 36 + 9], Vec3(0, 0.9, -0.6));
  EXPECT_EQ(mesh.vertices[1 + 9 * 36], Vec3(0.6, 0, 0));
  EXPECT_EQ(mesh.vertices[1 + 10 * 36], Vec3(0.6, -0.9, 0));
  EXPECT_EQ(mesh.triangles[0], (Facet{1, 2, 0}));
  EXPECT_EQ(mesh.triangles[36], (Facet{1, 37, 2}));
  EXPECT_EQ(mesh.triangles[1367], (Facet{684, 685, 649}));
}

TEST(Capsule, MirrorsItselfToTheLastBitWithEqualRadii) {
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_EQ(vertex_set(mesh_named("hero")), vertex_set(mesh_named("hero"), axis)) << "axis " << axis;
}

TEST(Capsule, DeviatesByTheDepthOfItsDeepestPoint) {
  const auto check = [](const char* name, double height, double bottom, double top) {
    SCOPED_TRACE(name);
    const Mesh& mesh = mesh_named(name);
    const double sampled =
        greatest_on_facets(mesh, 4, [&](const Vec3& p) { return outside_capsule(height, bottom, top, p); });
    EXPECT_LE(sampled, mesh.surface_deviation + 1e-14);
    EXPECT_GE(sampled, 0.95 * mesh.surface_deviation);
  };
  check("hero", 3, 0.6, 0.6);
  check("tapered", 5, 1.4, 0.7);
  check("inverted", 5, 0.7, 1.4);
  check("coarse", 5, 1.4, 0.7);
}

TEST(Torus, RunsRingByRingFromTheInside) {
  const Mesh& mesh = mesh_named("ring_16");
  EXPECT_EQ(mesh.vertices[0], Vec3(0, 0, 1.5));
  EXPECT_EQ(mesh.vertices[4], Vec3(0, -0.5, 2));
  EXPECT_EQ(mesh.vertices[8], Vec3(0, 0, 2.5));
  EXPECT_EQ(mesh.vertices[12], Vec3(0, 0.5, 2));
  EXPECT_EQ(mesh.vertices[4 * 16 + 8], Vec3(2.5, 0, 0));
  EXPECT_EQ(mesh.vertices[8 * 16], Vec3(0, 0, -1.5));
  EXPECT_EQ(mesh.triangles[0], (Facet{0, 16, 1}));
  EXPECT_EQ(mesh.triangles[1], (Facet{1, 16, 17}));
  EXPECT_EQ(mesh.triangles[511], (Facet{240, 15, 0}));
}

TEST(Torus, HasItsVerticesOnTheTorusAndMirrorsItself) {
  for (const char* name : {"ring_16", "ring_32"}) {
    for (const Vec3& v : mesh_named(name).vertices) ASSERT_NEAR(outside_torus(4, 1, v), 0, 1e-15) << name;
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(vertex_set(mesh_named(name)), vertex_set(mesh_named(name), axis)) << name << ", axis " << axis;
  }
}

// Least: the middle of a chord of the outer equator. Most: the sags of both directions together.
TEST(Torus, DeviatesByTheSagOfItsFacets) {
  for (const char* name : {"ring_16", "ring_32"}) {
    const Mesh& mesh = mesh_named(name);
    const double sag = 1 - std::cos(kPi / (mesh.triangles.size() == 512 ? 16 : 32));
    EXPECT_GE(mesh.surface_deviation, 2.5 * sag - 1e-15) << name;
    EXPECT_LE(mesh.surface_deviation, 3 * sag) << name;
    const double sampled = greatest_on_facets(mesh, 25, [](const Vec3& p) { return outside_torus(4, 1, p); });
    EXPECT_NEAR(mesh.surface_deviation, sampled, 0.02 * sampled) << name;
  }
}

// Ring 0 lies at curve(0) = (3, 0, 0), whose first vertex points away from the axis by minus the tube.
TEST(TorusKnot, RunsRingByRingAlongTheCurve) {
  const Mesh& mesh = mesh_named("knot");
  EXPECT_LT((mesh.vertices[0] - Vec3(2.5, 0, 0)).norm(), 0.005);  // the frame is tilted by half of 0.01 rad
  EXPECT_LT((mesh.vertices[16] - Vec3(3.5, 0, 0)).norm(), 0.005);
  EXPECT_LT((0.5 * (mesh.vertices[0] + mesh.vertices[16]) - Vec3(3, 0, 0)).norm(), 1e-15);
  EXPECT_EQ(mesh.triangles[0], (Facet{1, 0, 32}));
  EXPECT_EQ(mesh.triangles[1], (Facet{1, 32, 33}));
  EXPECT_EQ(mesh.triangles[2047], (Facet{992, 31, 0}));
}

// Rings are joined vertex to vertex, the last one to the first like any other: no edge along the tube is longer than
// the longest step on the outside of the curve.
TEST(TorusKnot, ClosesWithoutATwist) {
  const auto check = [](const char* name, int rings, int sides) {
    const Mesh& mesh = mesh_named(name);
    double longest = 0, joint = 0;
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < sides; ++j) {
        const double edge = (mesh.vertices[(i + 1) % rings * sides + j] - mesh.vertices[i * sides + j]).norm();
        (i + 1 == rings ? joint : longest) = std::fmax(i + 1 == rings ? joint : longest, edge);
      }
    EXPECT_LE(joint, 1.001 * longest) << name;
  };
  check("knot", 32, 32);
  check("knot_64", 64, 32);
  check("knot_5_2", 200, 8);
}

/// Distance of p from the curve of the knot (2, 3) of radius 2, by trying every point of a fine polygon.
double distance_from_knot(const Vec3& p) {
  static const std::vector<Vec3> polygon = [] {
    std::vector<Vec3> points;
    for (int i = 0; i < 3000; ++i) points.push_back(knot_curve(2, 2, 3, 4 * kPi * i / 3000));
    return points;
  }();
  double least = HUGE_VAL;
  for (const Vec3& c : polygon) least = std::fmin(least, (p - c).squaredNorm());
  return std::sqrt(least);
}

// A vertex is `tube` from its ring's centre and, the frame being tilted, a little less from the curve. The trial
// polygon has steps of up to 0.014, so it finds distances too great by up to 0.007^2 / (2 x 0.4) = 6e-5.
TEST(TorusKnot, HasItsVerticesOnTheTube) {
  for (const Vec3& v : mesh_named("knot").vertices) {
    const double distance = distance_from_knot(v);
    ASSERT_LT(distance, 0.5 + 6e-5);
    ASSERT_GT(distance, 0.5 - 2e-4);
  }
}

TEST(TorusKnot, DeviatesAsATrialOfAllPointsOfTheCurveSays) {
  const Mesh coarse = torus_knot("coarse", 2, 0.5, 32, 6, 2, 3);
  const double sampled = greatest_on_facets(coarse, 4, [](const Vec3& p) { return distance_from_knot(p) - 0.5; });
  EXPECT_NEAR(coarse.surface_deviation, sampled, 6e-5);
}

}  // namespace
}  // namespace geometry
