#include "algorithms/thesis/obb_sat.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

bool met(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) { return hit("obb_sat", a, at_a, b, at_b); }

/// The three stages in their own words: world axes, not normalised, every corner projected.
bool definition(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  struct Placed {
    geometry::Mat3 r;
    Vec3 middle;
    std::vector<Vec3> corners;
    double radius;
  };
  const auto placed = [](const Mesh& mesh, const Pose& pose) {
    const geometry::Box box = geometry::local_box(mesh);
    Placed out{geometry::rotation(pose.q), {}, {}, 0};
    out.middle = geometry::to_world(out.r, pose.t, box.centre());
    for (const Vec3& corner : corners(box.half_size()))
      out.corners.push_back(geometry::to_world(out.r, pose.t, box.centre() + corner));
    out.radius = box.half_size().norm() * (1 + 1e-12);
    return out;
  };
  const Placed p = placed(a, at_a), q = placed(b, at_b);
  const auto separates = [&](const Vec3& axis) {
    if (axis.squaredNorm() < 1e-20) return false;  // parallel edges: the face axes tell as much
    double p_low = 1e300, p_high = -1e300, q_low = 1e300, q_high = -1e300;
    for (const Vec3& corner : p.corners) {
      p_low = std::min(p_low, axis.dot(corner));
      p_high = std::max(p_high, axis.dot(corner));
    }
    for (const Vec3& corner : q.corners) {
      q_low = std::min(q_low, axis.dot(corner));
      q_high = std::max(q_high, axis.dot(corner));
    }
    return p_high < q_low || q_high < p_low;
  };
  if (p.radius + q.radius < (p.middle - q.middle).norm()) return false;
  for (int i = 0; i < 3; ++i)
    if (separates(Vec3::Unit(i)) || separates(p.r.col(i)) || separates(q.r.col(i))) return false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (separates(p.r.col(i).cross(q.r.col(j)))) return false;
  return true;
}

TEST(ObbSat, IsExactOnTheUnturnedSlabAndCube) {
  const Mesh cube = geometry::box("cube", {2, 2, 2}), slab = geometry::box("slab", {6, 0.5, 4});
  for (const Mesh& other : {cube, slab}) {
    const Vec3 sum = geometry::half_extents(cube) + geometry::half_extents(other);
    for (int axis = 0; axis < 3; ++axis)
      for (const double gap : {-0x1p-40, 0.0, 0x1p-40}) {
        Vec3 at = 0.25 * sum;
        at[axis] = sum[axis] + gap;
        EXPECT_EQ(met(cube, {}, other, {{}, at}), gap <= 0) << "axis " << axis << ", gap " << gap;
        EXPECT_EQ(truly_meet(cube, {}, other, {{}, at}), gap <= 0);
      }
  }
}

TEST(ObbSat, TouchingAtACornerIsAHit) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  EXPECT_TRUE(met(cube, {}, cube, {{}, {2, 2, 2}}));
  EXPECT_FALSE(met(cube, {}, cube, {{}, {2, 2, 2 + 0x1p-40}}));
}

// An edge of one cube against an edge of the other, crossed: only the cross product of the edges separates them.
TEST(ObbSat, SeparatesCrossedEdges) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const Quaternion about_x = turn_deg({1, 0, 0}, 45), about_z = turn_deg({0, 0, 1}, 45);
  for (const double gap : {-1e-6, 1e-6}) {
    const Pose above{about_z, {0, 2 * std::numbers::sqrt2 + gap, 0}};
    EXPECT_EQ(met(cube, {about_x, {0, 0, 0}}, cube, above), gap < 0) << "gap " << gap;
  }
}

TEST(ObbSat, UsesTheBoxOfTheVerticesWhereItIs) {
  const Mesh off = shifted_box({2, 2, 2}, {5, 0, 0});
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  EXPECT_TRUE(met(off, {}, cube, {{}, {5, 0, 0}}));
  EXPECT_FALSE(met(off, {}, cube, {})) << "the position itself is outside";
  EXPECT_TRUE(met(off, {turn_deg({0, 1, 0}, 90), {0, 0, 0}}, cube, {{}, {0, 0, -5}}));
}

TEST(ObbSat, ReportsTheEmptyMiddleOfTheRing) {
  const Mesh around = ring(3, 0.5), ball = geometry::sphere("ball", 1, 8);
  EXPECT_TRUE(met(around, {}, ball, {}));
  EXPECT_FALSE(truly_meet(around, {}, ball, {}));
}

// Equal turns make cross products of parallel edges that are mere rounding, or exactly zero: neither may separate.
TEST(ObbSat, MissesNothingBetweenParallelBoxes) {
  std::mt19937 random(51);
  SCOPED_TRACE("seed 51");
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  for (int round = 0; round < 2000; ++round) {
    const Quaternion q = uniform_turn(random);
    const geometry::Mat3 r = geometry::rotation(q);
    const double quarter = round % 4 * 90.0;
    const Vec3 inside = uniform_point(random, 2 - 1e-9);
    EXPECT_TRUE(met(cube, {q, {0, 0, 0}}, cube, {q * turn_deg({0, 1, 0}, quarter), r * inside}))
        << "round " << round << ": " << inside.transpose();
  }
}

TEST(ObbSat, AnswersAsItsThreeStages) {
  for (std::uint32_t seed = 52; seed <= 59; ++seed) {
    std::mt19937 random(seed);
    const Setting setting = crowd(random, 60, 4);
    const std::vector<Pair> expected = by_definition(setting, definition);
    EXPECT_GT(expected.size(), 50u);
    EXPECT_EQ(hits("obb_sat", setting), expected) << "seed " << seed;
  }
}

TEST(ObbSat, CountsTheAxesItTried) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const auto operations = [&](const Vec3& at) {
    const Setting setting = Setting().add(cube, {}).add(cube, {{}, at});
    const auto method = make("obb_sat", setting.bodies);
    std::vector<Pair> found;
    method->prepare(setting.poses);
    return method->count(setting.runs(), found);
  };
  EXPECT_EQ(operations({9, 0, 0}), 1u) << "the spheres";
  EXPECT_EQ(operations({2.5, 0, 0}), 2u) << "and the x axis";
  EXPECT_EQ(operations({0, 0, 2.5}), 4u) << "and x, y, z";
  EXPECT_EQ(operations({0, 0, 0}), 19u) << "and fifteen axes";
}

}  // namespace
}  // namespace algorithms
