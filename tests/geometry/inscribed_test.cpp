// Balls inside meshes: that they are inside is checked in exact numbers, how far the surface is from them by points.
#include "geometry/decision/inscribed.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "geometry/meshes/shapes.hpp"
#include "geometry/random.hpp"
#include "geometry/vec.hpp"
#include "tests/support/l_shape.hpp"

namespace {

using namespace geometry;
using Exact = CGAL::Exact_predicates_exact_constructions_kernel;

InscribedBalls balls_of(const Mesh& mesh, std::size_t most) {
  return inscribed_balls(mesh, solid_of(mesh, kClosedWithin), most);
}

std::vector<Mesh> shapes() {
  return {box("box", {1.6, 1, 1.2}), capsule("capsule", 2, 0.4, 0.4, 2), torus("torus", 1.5, 0.5, 10),
          torus_knot("knot", 0.7, 0.18, 28, 6, 2, 3), tests::l_shape()};
}

/// How often the surface goes round the point, by solid angles.
double winding(const Mesh& mesh, const Vec3& p) {
  double angle = 0;
  for (const Facet& f : mesh.triangles) {
    const Vec3 a = mesh.vertices[f[0]] - p, b = mesh.vertices[f[1]] - p, c = mesh.vertices[f[2]] - p;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    angle += 2 * std::atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
  }
  return angle / (4 * std::numbers::pi);
}

TEST(InscribedBalls, AreInsideExactly) {
  for (const Mesh& mesh : shapes()) {
    SCOPED_TRACE(mesh.name);
    const InscribedBalls found = balls_of(mesh, 12);
    ASSERT_FALSE(found.balls.empty());
    EXPECT_LE(found.balls.size(), 12u);
    for (const ContactBall& ball : found.balls) {
      EXPECT_NEAR(winding(mesh, ball.centre), 1, 1e-9);
      const auto point = [](const Vec3& p) { return Exact::Point_3(p.x(), p.y(), p.z()); };
      Exact::FT least = 1e9;
      for (const Facet& f : mesh.triangles) {
        const auto distance = CGAL::squared_distance(
            point(ball.centre),
            Exact::Triangle_3(point(mesh.vertices[f[0]]), point(mesh.vertices[f[1]]), point(mesh.vertices[f[2]])));
        if (distance < least) least = distance;
      }
      EXPECT_GE(least, Exact::FT(ball.radius) * Exact::FT(ball.radius));
      EXPECT_NEAR(std::sqrt(CGAL::to_double(least)), ball.radius, 1e-8) << "it should nearly touch";
    }
  }
}

TEST(InscribedBalls, DeviationIsThatOfPointsOfTheSurface) {
  constexpr std::uint64_t kSeed = 3;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  Random random(kSeed);
  for (const Mesh& mesh : shapes()) {
    SCOPED_TRACE(mesh.name);
    const InscribedBalls found = balls_of(mesh, 16);
    double greatest = 0;
    const auto look = [&](const Vec3& p) {
      double least = 1e9;
      for (const ContactBall& ball : found.balls) least = std::min(least, (p - ball.centre).norm() - ball.radius);
      greatest = std::max(greatest, least);
    };
    for (const Vec3& p : mesh.vertices) look(p);
    for (int i = 0; i < 20000; ++i) {
      const Facet& f = mesh.triangles[random.next() % mesh.triangles.size()];
      double s = random.unit(), t = random.unit();
      if (s + t > 1) s = 1 - s, t = 1 - t;
      look(mesh.vertices[f[0]] + s * (mesh.vertices[f[1]] - mesh.vertices[f[0]]) +
           t * (mesh.vertices[f[2]] - mesh.vertices[f[0]]));
    }
    EXPECT_LE(greatest, found.deviation * (1 + 1e-12));
    EXPECT_GE(greatest, 0.94 * found.deviation);
  }
}

// Of one ball in a cube a corner is furthest; the greatest there is has the radius 1.
TEST(InscribedBalls, OneInACubeLeavesACorner) {
  const InscribedBalls found = balls_of(box("cube", {2, 2, 2}), 1);
  ASSERT_EQ(found.balls.size(), 1u);
  const ContactBall& ball = found.balls[0];
  EXPECT_GT(ball.radius, 0.8);
  EXPECT_LE(ball.radius, 1);
  const double corner = (Vec3::Ones() + ball.centre.cwiseAbs()).norm() - ball.radius;
  EXPECT_NEAR(found.deviation, corner, 1e-3 * corner);
}

// A row of equal balls in a tube of radius r, d apart, leaves r - sqrt(r^2 - d^2/4) between two of them.
TEST(InscribedBalls, OfATorusStandOnItsCircle) {
  const InscribedBalls found = balls_of(torus("ring", 4, 1, 64), 24);
  for (const ContactBall& ball : found.balls) {
    EXPECT_NEAR(std::hypot(ball.centre.x(), ball.centre.z()), 2, 0.02);
    EXPECT_NEAR(ball.centre.y(), 0, 0.02);
    EXPECT_NEAR(ball.radius, 0.5, 0.02);
  }
  const double apart = 2 * std::numbers::pi * 2.5 / 24;  // on the outer side
  const double least = 0.5 - std::sqrt(0.25 - std::pow(apart * 2 / 2.5, 2) / 4);
  EXPECT_GT(found.deviation, least);
  EXPECT_LT(found.deviation, 3 * least);
}

TEST(InscribedBalls, MoreComeNearer) {
  for (const Mesh& mesh : {box("box", {1.6, 1, 1.2}), torus("torus", 1.5, 0.5, 24)}) {
    SCOPED_TRACE(mesh.name);
    const double few = balls_of(mesh, 8).deviation, many = balls_of(mesh, 32).deviation;
    EXPECT_LT(many, 0.7 * few);
  }
}

// Two sheets back to back are closed, and hold nothing.
TEST(InscribedBalls, OfASheetAreNone) {
  Mesh sheet;
  sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_TRUE(solid_of(sheet, 0).closed);
  EXPECT_TRUE(balls_of(sheet, 8).balls.empty());
}

// The same on every machine: motions recorded on one can be judged by another.
TEST(InscribedBalls, HaveTheSameBitsEverywhere) {
  std::uint64_t hash = 0xCBF29CE484222325u;  // FNV-1a, of words
  const auto add = [&](double x) { hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x100000001B3u; };
  for (const Mesh& mesh : shapes()) {
    const InscribedBalls found = balls_of(mesh, 10);
    for (const ContactBall& ball : found.balls) {
      for (const double x : ball.centre) add(x);
      add(ball.radius);
    }
    add(found.deviation);
  }
  EXPECT_EQ(hash, 0x7f7fcfd7e69bf328u) << std::hex << hash;
}

}  // namespace
