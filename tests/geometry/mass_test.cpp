// Volume, centre and inertia of meshes against closed forms, and against each other in other frames.
#include "geometry/mass.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "geometry/meshes/shapes.hpp"
#include "tests/support/l_shape.hpp"

namespace {

using namespace geometry;
constexpr double kPi = std::numbers::pi;

MassProperties of(const Mesh& mesh) { return mass_properties(mesh.vertices, mesh.triangles); }

void expect_moments(const MassProperties& found, double volume, const Vec3& moments, double tolerance) {
  EXPECT_NEAR(found.volume, volume, tolerance * volume);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(found.inertia[k], moments[k], tolerance * moments.maxCoeff()) << k;
    EXPECT_NEAR(found.inertia[3 + k], 0, 1e-3 * tolerance * moments.maxCoeff() + 1e-14 * moments.maxCoeff()) << k;
  }
}

TEST(MassProperties, OfABox) {
  const double x = 1.5, y = 0.5, z = 2, v = x * y * z;
  const MassProperties found = of(box("box", {x, y, z}));
  expect_moments(found, v, {v / 12 * (y * y + z * z), v / 12 * (x * x + z * z), v / 12 * (x * x + y * y)}, 1e-14);
  EXPECT_LT(found.centre.norm(), 1e-15);
}

/// How the error falls when a shape is made twice as fine: by 4 where facets are chords.
template <class Make>
void expect_second_order(Make make, double volume, const Vec3& moments) {
  double before[2] = {};
  for (const std::int64_t segments : {30, 62, 126}) {  // 32, 64 and 128 bands of a sphere
    const MassProperties found = of(make(segments));
    const double error[2] = {std::fabs(found.volume / volume - 1), std::fabs(found.inertia[0] / moments[0] - 1)};
    for (int k = 0; k < 2 && before[k] > 0; ++k) EXPECT_NEAR(before[k] / error[k], 4, 0.25) << segments;
    std::copy(error, error + 2, before);
  }
  EXPECT_LT(before[0], 2e-3);
  expect_moments(of(make(126)), volume, moments, 3e-3);
}

TEST(MassProperties, OfASphereConverge) {
  const double v = 4. / 3 * kPi;
  expect_second_order([](std::int64_t n) { return sphere("s", 1, n); }, v, Vec3::Constant(0.4 * v));
}

TEST(MassProperties, OfATorusConverge) {
  // Circle of radius c = 1.5 through the tube of radius a = 0.5; the axis is y.
  const double c = 1.5, a = 0.5, v = 2 * kPi * kPi * c * a * a;
  const double across = v * (c * c / 2 + 5 * a * a / 8), along = v * (c * c + 3 * a * a / 4);
  expect_second_order([](std::int64_t n) { return torus("t", 3, 1, n + 2); }, v, {across, along, across});
}

TEST(MassProperties, OfACapsuleConverge) {
  // A cylinder of height h between two half spheres of radius r, whose centres of mass are 3/8 r beyond its ends.
  const double r = 0.5, h = 2, cylinder = kPi * r * r * h, ball = 4. / 3 * kPi * r * r * r;
  const double along = cylinder * r * r / 2 + ball * 0.4 * r * r;
  const double across = cylinder * (h * h / 12 + r * r / 4) + ball * (0.4 * r * r + h * h / 4 + 3. / 8 * h * r);
  expect_second_order([](std::int64_t n) { return capsule("c", 3, 0.5, 0.5, n); }, cylinder + ball,
                      {across, along, across});
}

// An L of two boxes: their sums by the parallel-axis theorem.
TEST(MassProperties, OfAnLAreThoseOfItsBoxes) {
  const Mesh mesh = tests::l_shape();
  ASSERT_TRUE(is_closed(mesh));
  const Vec3 size[2] = {{3, 1, 1}, {1, 1, 1}}, middle[2] = {{1.5, 0.5, 0.5}, {0.5, 1.5, 0.5}};
  const double mass[2] = {3, 1};
  const Vec3 centre = (mass[0] * middle[0] + mass[1] * middle[1]) / 4;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 2; ++k) {
    const Vec3 arm = middle[k] - centre;
    const Vec3 second = (size[k].cwiseProduct(size[k])) / 12;
    inertia += mass[k] * ((second.sum() + arm.squaredNorm()) * Eigen::Matrix3d::Identity() - arm * arm.transpose());
    inertia -= mass[k] * Eigen::Matrix3d(second.asDiagonal());
  }
  const MassProperties found = of(mesh);
  EXPECT_NEAR(found.volume, 4, 1e-14);
  EXPECT_LT((found.centre - centre).norm(), 1e-14);
  const double expected[6] = {inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2)};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(found.inertia[k], expected[k], 1e-13) << k;
  EXPECT_GT(std::fabs(expected[3]), 0.5) << "its axes should be turned";
}

// Turned and far away the principal moments stay, to the rounding of coordinates.
TEST(MassProperties, PrincipalMomentsDoNotDependOnTheFrame) {
  const Mesh mesh = capsule("c", 3, 0.7, 0.4, 8);
  Mesh moved = mesh;
  const Pose pose{normalised({0.3, -0.5, 0.7, 0.2}), {100, -200, 300}};
  to_world(pose, mesh.vertices, moved.vertices);
  const auto principal = [](const MassProperties& m) {
    Eigen::Matrix3d inertia;
    inertia << m.inertia[0], m.inertia[3], m.inertia[4], m.inertia[3], m.inertia[1], m.inertia[5], m.inertia[4],
        m.inertia[5], m.inertia[2];
    return Vec3(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia).eigenvalues());
  };
  const MassProperties before = of(mesh), after = of(moved);
  EXPECT_LT((principal(after) - principal(before)).norm(), 1e-11 * principal(before).norm());
  Vec3 centre[1];
  to_world(pose, std::vector<Vec3>{before.centre}, centre);
  EXPECT_LT((after.centre - centre[0]).norm(), 1e-11);
}

TEST(MassProperties, AreNegativeInsideOut) {
  Mesh mesh = box("box", {1, 1, 1});
  EXPECT_TRUE(face_one_way(mesh.triangles));
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_FALSE(face_one_way(mesh.triangles));
  for (std::size_t f = 1; f < mesh.triangles.size(); ++f) std::swap(mesh.triangles[f][0], mesh.triangles[f][1]);
  EXPECT_TRUE(face_one_way(mesh.triangles));
  EXPECT_EQ(of(mesh).volume, -1);
}

}  // namespace
