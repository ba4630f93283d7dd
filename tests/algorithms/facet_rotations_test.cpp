// facet_rotations (U): answers as defined, by its directions and by turning, and its known errors.
#include "algorithms/thesis/facet_rotations.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numbers>

#include "tests/support/facet_scenes.hpp"

namespace algorithms {
namespace {

using namespace facet_scenes;

const Knobs kEvery = {{"prefilter", "none"}, {"stride", std::int64_t{1}}, {"inflate", 1.0}};

bool strictly_apart(const std::array<double, 3>& p, const std::array<double, 3>& q) {
  return *std::max_element(p.begin(), p.end()) < *std::min_element(q.begin(), q.end()) ||
         *std::max_element(q.begin(), q.end()) < *std::min_element(p.begin(), p.end());
}

/// The triangle test on all directions, by the arithmetic that defines the answers.
bool meet_on_directions(const Vec3* a, const Vec3* b, const std::vector<Vec3>& directions) {
  for (const Vec3& d : directions) {
    std::array<double, 3> p, q;
    for (int i = 0; i < 3; ++i) {
      p[i] = (d.x() * a[i].x() + d.y() * a[i].y()) + d.z() * a[i].z();
      q[i] = (d.x() * b[i].x() + d.y() * b[i].y()) + d.z() * b[i].z();
    }
    if (strictly_apart(p, q)) return false;
  }
  return true;
}

/// The thesis's triangle test, word for word: turn about z, then about x, and compare on x, y and z.
bool meet_by_turning(const Vec3* a, const Vec3* b, int turns) {
  for (int i = 1; i <= turns; ++i)
    for (int k = 1; k <= turns; ++k) {
      const double alpha = i * std::numbers::pi / turns, beta = k * std::numbers::pi / turns;
      std::array<std::array<double, 3>, 3> p, q;  // axis, corner
      for (int corner = 0; corner < 3; ++corner)
        for (auto [from, to] : {std::pair(a, &p), std::pair(b, &q)}) {
          const Vec3& v = from[corner];
          const double x = v.x() * std::cos(alpha) - v.y() * std::sin(alpha);
          const double y = v.x() * std::sin(alpha) + v.y() * std::cos(alpha);
          (*to)[0][corner] = x;
          (*to)[1][corner] = y * std::cos(beta) - v.z() * std::sin(beta);
          (*to)[2][corner] = y * std::sin(beta) + v.z() * std::cos(beta);
        }
      for (int axis = 0; axis < 3; ++axis)
        if (strictly_apart(p[axis], q[axis])) return false;
    }
  return true;
}

template <class Meet>
bool as_defined(const Scene& scene, std::size_t stride, double inflate, bool strip, Meet meet) {
  const auto a = world_points(scene.bodies.mesh_of(0), scene.poses[0], stride, inflate);
  const auto b = world_points(scene.bodies.mesh_of(1), scene.poses[1], stride, inflate);
  const std::size_t step = strip ? 1 : 3;
  for (std::size_t i = 0; i + 3 <= a.size(); i += step)
    for (std::size_t k = 0; k + 3 <= b.size(); k += step)
      if (meet(&a[i], &b[k])) return true;
  return false;
}

// For n = 180 / step turns: n lines from x; n n from y and as many from z, which are the same lines when 90 degrees is
// a multiple of the step. Of those n are horizontal, as the lines from x are, and n coincide in the vertical.
TEST(RotationGrid, HasEveryLineOnce) {
  EXPECT_EQ(rotation_grid(10).size(), 307u);
  for (const int n : {2, 4, 6, 10, 36})
    EXPECT_EQ(rotation_grid(180.0 / n).size(), static_cast<std::size_t>(n * n - n + 1));
  EXPECT_EQ(rotation_grid(180).size(), 3u);  // the axes
}

TEST(RotationGrid, HoldsUnitVectorsAndTheAxesExactly) {
  const std::vector<Vec3> grid = rotation_grid(10);
  for (const Vec3& d : grid) EXPECT_NEAR(d.x() * d.x() + d.y() * d.y() + d.z() * d.z(), 1, 1e-15);
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
    EXPECT_EQ(std::count(grid.begin(), grid.end(), axis), 1);
}

// Each direction of the definition lies on some line of the grid; odd numbers of turns have lines of their own in z.
TEST(RotationGrid, HoldsEveryDirectionOfTheDefinition) {
  for (const int n : {1, 3, 5, 18}) {
    const std::vector<Vec3> grid = rotation_grid(180.0 / n);
    for (int i = 1; i <= n; ++i)
      for (int k = 1; k <= n; ++k) {
        const double a = i * std::numbers::pi / n, b = k * std::numbers::pi / n;
        const double sa = std::sin(a), ca = std::cos(a), sb = std::sin(b), cb = std::cos(b);
        for (const Vec3& d : {Vec3(ca, -sa, 0), Vec3(cb * sa, cb * ca, -sb), Vec3(sb * sa, sb * ca, cb)})
          EXPECT_TRUE(
              std::any_of(grid.begin(), grid.end(),
                          [&](const Vec3& line) { return (line - d).norm() < 1e-14 || (line + d).norm() < 1e-14; }))
              << n << ' ' << i << ' ' << k;
      }
  }
}

// Triangles that share a point: a random one in both, made by moving the second onto it, overlapping by more than
// rounding; or a corner bit for bit.
TEST(FacetRotations, NeverDeniesTrianglesThatTrulyMeet) {
  const std::uint64_t seed = 21;
  SCOPED_TRACE(seed);
  Random random(seed);
  for (int i = 0; i < 1000; ++i) {
    std::vector<Vec3> a = {random.vector(1), random.vector(1), random.vector(1)};
    std::vector<Vec3> b = {random.vector(1), random.vector(1), random.vector(1)};
    if (i % 2) {
      b[i % 3] = a[(i / 3) % 3];
    } else {
      // Stabs through the middle of a: b's first corner on one side, the middle of its other side on the other.
      const Vec3 middle = (a[0] + a[1] + a[2]) / 3, away = random.vector(1), across = 0.1 * random.vector(1);
      b = {middle + away, middle - away + across, middle - away - across};
    }
    EXPECT_TRUE(hit("facet_rotations", two(cloud(a), at(0, 0, 0), cloud(b), at(0, 0, 0)), kEvery)) << i;
  }
}

/// Two parallel triangles of size 1, `gap` apart along the unit vector n.
Scene parallel(const Vec3& n, double gap) {
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  const Mesh triangle = cloud({u, -0.5 * u + 0.8 * v, -0.5 * u - 0.8 * v});
  return two(triangle, at(0, 0, 0), triangle, {.q = {}, .t = gap * n});
}

TEST(FacetRotations, SaysYesToNearMissesBetweenGridDirections) {
  const auto tilted = [](double degrees) {
    const double b = degrees * std::numbers::pi / 180;
    return Vec3(0, std::cos(b), -std::sin(b));
  };
  EXPECT_FALSE(hit("facet_rotations", parallel(tilted(30), 0.02), kEvery));  // on the grid
  EXPECT_TRUE(hit("facet_rotations", parallel(tilted(35), 0.02), kEvery));   // half way
  EXPECT_FALSE(hit("facet_rotations", parallel(tilted(35), 0.02), with(kEvery, {{"angle_step", 5}})));
  EXPECT_FALSE(hit("facet_rotations", parallel(tilted(35), 0.4), kEvery));   // a wide gap is seen anyway
  EXPECT_FALSE(hit("facet_triangles", parallel(tilted(35), 0.02), kEvery));  // by its normal
}

TEST(FacetRotations, TouchingIsAHit) {
  const Mesh triangle = cloud({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}), upright = cloud({{0, 0, 0}, {4, 0, 4}, {0, 0, 4}});
  EXPECT_TRUE(hit("facet_rotations", two(triangle, at(0, 0, 0), upright, at(0.5, 0.5, 0)), kEvery));
  EXPECT_FALSE(hit("facet_rotations", two(triangle, at(0, 0, 0), upright, at(0.5, 0.5, 0x1p-40)), kEvery));
}

// Unlike the 11-axis test, this one has axes in every plane.
TEST(FacetRotations, CoplanarTrianglesApartAreNoHit) {
  const Mesh triangle = cloud({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}});
  EXPECT_FALSE(hit("facet_rotations", two(triangle, at(0, 0, 0), triangle, at(1000, 0, 0)), kEvery));
}

TEST(FacetRotations, MissesABodyInsideAnother) { expect_blind_to_what_is_inside("facet_rotations"); }

TEST(FacetRotations, TrianglesThatCutAcrossABodySeeWhatIsInside) {
  expect_to_see_by_triangles_across("facet_rotations");
}

TEST(FacetRotations, FewerThanThreeSampledFacetsAreNeverHit) {
  expect_no_hit_of_fewer_than_three_facets("facet_rotations");
}

TEST(FacetRotations, EnvelopeHasHoles) { expect_holes("facet_rotations"); }

TEST(FacetRotations, AnswersAsDefinedOnDirections) {
  const std::uint64_t seed = 20260104;
  SCOPED_TRACE(seed);
  Random random(seed);
  int hits = 0;
  for (int i = 0; i < 900; ++i) {
    const Scene scene = random_pair(random, i);
    const std::int64_t stride = i % 3 == 2 ? random.whole(3, 9) : 1;
    const double inflate = i % 2 ? 1.1 : 1, angle_step = i % 7 == 0 ? 180.0 / random.whole(1, 9) : 10;
    const bool strip = i % 5 == 0;
    const std::vector<Vec3> grid = rotation_grid(angle_step);
    const bool expected = as_defined(scene, static_cast<std::size_t>(stride), inflate, strip,
                                     [&](const Vec3* a, const Vec3* b) { return meet_on_directions(a, b, grid); });
    EXPECT_EQ(hit("facet_rotations", scene,
                  {{"prefilter", "none"},
                   {"stride", stride},
                   {"inflate", inflate},
                   {"angle_step", angle_step},
                   {"triangles", strip ? "strip" : "disjoint"}}),
              expected)
        << i;
    hits += expected;
  }
  EXPECT_GT(hits, 150);
  EXPECT_LT(hits, 750);
}

// Rounding differs, so equality is a fact of these pairs and not of all; lattice pairs touch exactly and are left out.
TEST(FacetRotations, AnswersAsTurningDoes) {
  const std::uint64_t seed = 22;
  SCOPED_TRACE(seed);
  Random random(seed);
  int hits = 0, disagreements = 0;
  for (int i = 0; i < 400; ++i) {
    const Mesh a = random.points(6, 1), b = random.points(6, 1);
    const Pose pose = random.pose(0.5), other = random.pose(1.5);
    const Scene scene = two(a, pose, b, other);
    const int turns = i % 4 == 0 ? random.whole(1, 12) : 18;
    const bool expected =
        as_defined(scene, 1, 1.0, false, [&](const Vec3* s, const Vec3* t) { return meet_by_turning(s, t, turns); });
    disagreements += hit("facet_rotations", scene, with(kEvery, {{"angle_step", 180.0 / turns}})) != expected;
    hits += expected;
  }
  EXPECT_EQ(disagreements, 0);
  EXPECT_GT(hits, 50);
  EXPECT_LT(hits, 350);
}

// Thesis 5.3, "practically equal": what they tell apart are near misses, where U says yes.
TEST(FacetRotations, AnswersPracticallyAsFacetTriangles) {
  const std::uint64_t seed = 23;
  SCOPED_TRACE(seed);
  Random random(seed);
  const Mesh sphere = geometry::sphere("sphere", 1, 16);
  int only_u = 0, only_i = 0, both = 0;
  for (int i = 0; i < 300; ++i) {
    const Pose pose = random.pose(0.1);
    Pose other = random.pose(0.1);
    other.t.x() += random.between(1.2, 2.4);
    const Scene scene = two(sphere, pose, sphere, other);
    const bool u = hit("facet_rotations", scene, {{"prefilter", "none"}});
    const bool t = hit("facet_triangles", scene, {{"prefilter", "none"}});
    both += u && t;
    only_u += u && !t;
    only_i += t && !u;
  }
  EXPECT_EQ(only_i, 0);
  EXPECT_GT(both, 100);
  EXPECT_LE(only_u, 30) << "of 300 pairs";
}

TEST(FacetRotations, OrderOfThePairDoesNotMatter) {
  expect_the_same_in_either_order("facet_rotations", 24, 400, kEvery);
}

// On the axes alone lengths are coordinates, and a shift that keeps them exact keeps the answers. On the other
// directions products are rounded, so there is no such promise.
TEST(FacetRotations, ExactShiftChangesNothingOnTheAxes) {
  expect_the_same_elsewhere("facet_rotations", 25, 200, with(kEvery, {{"angle_step", 90}}));
}

TEST(FacetRotations, TrianglesWithoutAreaAreDefined) {
  const Mesh triangle = cloud({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}), needle = cloud({{0, 0, -1}, {0, 0, 0}, {0, 0, 1}});
  const Mesh point = cloud({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  EXPECT_TRUE(hit("facet_rotations", two(triangle, at(0, 0, 0), needle, at(1, 1, 0)), kEvery));
  EXPECT_FALSE(hit("facet_rotations", two(triangle, at(0, 0, 0), needle, at(5, 5, 0)), kEvery));
  EXPECT_TRUE(hit("facet_rotations", two(triangle, at(0, 0, 0), point, at(1, 1, 0)), kEvery));
  EXPECT_FALSE(hit("facet_rotations", two(point, at(0, 0, 0), point, at(9, 9, 9)), kEvery));
  EXPECT_TRUE(hit("facet_rotations", two(point, at(1, 2, 3), point, at(1, 2, 3)), kEvery));
}

// Far apart: one interval for each of the ten triangles of each body.
TEST(FacetRotations, CountsIntervals) {
  std::vector<Vec3> points;
  for (int i = 0; i < 10; ++i) points.insert(points.end(), {Vec3(0, 0, i), Vec3(1, 0, i), Vec3(0, 1, i)});
  EXPECT_EQ(ask("facet_rotations", two(cloud(points), at(0, 0, 0), cloud(points), at(50, 50, 0)), kEvery).operations,
            20u);
}

TEST(FacetRotations, RefusesAnglesThatDoNotDivideAHalfTurn) {
  EXPECT_NO_THROW(knobs("facet_rotations", {{"angle_step", std::int64_t{12}}}));
  EXPECT_NO_THROW(knobs("facet_rotations", {{"angle_step", 22.5}}));
  EXPECT_NO_THROW(knobs("facet_rotations", {{"angle_step", 180.0 / 7}}));
  for (const double bad : {0.0, -10.0, 7.0, 100.0, 360.0, 0.5})
    EXPECT_THROW(knobs("facet_rotations", {{"angle_step", bad}}), std::invalid_argument) << bad;
}

TEST(FacetRotations, UnbornBodiesAreInNoPair) { expect_unborn_bodies_in_no_pair("facet_rotations"); }

}  // namespace
}  // namespace algorithms
