// facet_triangles (I): answers as defined and its known errors.
#include "algorithms/thesis/facet_triangles.hpp"

#include <algorithm>
#include <array>

#include "tests/support/facet_scenes.hpp"

namespace algorithms {
namespace {

using namespace facet_scenes;

const Knobs kEvery = {{"prefilter", "none"}, {"stride", std::int64_t{1}}, {"inflate", 1.0}};

double dot(const Vec3& a, const Vec3& b) { return a.x() * b.x() + a.y() * b.y() + a.z() * b.z(); }

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

bool strictly_apart(std::array<double, 3> p, std::array<double, 3> q) {
  return *std::max_element(p.begin(), p.end()) < *std::min_element(q.begin(), q.end()) ||
         *std::max_element(q.begin(), q.end()) < *std::min_element(p.begin(), p.end());
}

/// The 11-axis test, word for word.
bool eleven_axes(const Vec3* a, const Vec3* b) {
  const Vec3 e0 = a[1] - a[0], e1 = a[2] - a[0], f0 = b[1] - b[0], f1 = b[2] - b[0], d = b[0] - a[0];
  const Vec3 e[3] = {e0, e1, e1 - e0}, f[3] = {f0, f1, f1 - f0}, n = cross(e0, e1), m = cross(f0, f1);
  const double nd = dot(n, d), md = dot(m, d);
  if (strictly_apart({0, 0, 0}, {nd, nd + dot(n, f0), nd + dot(n, f1)})) return false;
  if (strictly_apart({0, dot(m, e0), dot(m, e1)}, {md, md, md})) return false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vec3 l = cross(e[i], f[j]);
      const double ld = dot(l, d);
      const std::array<double, 3> p = {0, i == 0 ? 0 : dot(l, e0), i == 1 ? 0 : dot(l, e1)};
      const std::array<double, 3> q = {ld, j == 0 ? ld : ld + dot(l, f0), j == 1 ? ld : ld + dot(l, f1)};
      if (strictly_apart(p, q)) return false;
    }
  return true;
}

bool as_defined(const Scene& scene, std::size_t stride, double inflate, bool strip) {
  const auto a = world_points(scene.bodies.mesh_of(0), scene.poses[0], stride, inflate);
  const auto b = world_points(scene.bodies.mesh_of(1), scene.poses[1], stride, inflate);
  const std::size_t step = strip ? 1 : 3;
  for (std::size_t i = 0; i + 3 <= a.size(); i += step)
    for (std::size_t k = 0; k + 3 <= b.size(); k += step)
      if (eleven_axes(&a[i], &b[k])) return true;
  return false;
}

const Mesh kTriangle = cloud({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}});
const Mesh kUpright = cloud({{0, 0, 0}, {4, 0, 4}, {0, 0, 4}});

TEST(FacetTriangles, TouchingIsAHit) {
  EXPECT_TRUE(hit("facet_triangles", two(kTriangle, at(0, 0, 0), kUpright, at(0.5, 0.5, 0)), kEvery));
  EXPECT_FALSE(hit("facet_triangles", two(kTriangle, at(0, 0, 0), kUpright, at(0.5, 0.5, 0x1p-40)), kEvery));
  EXPECT_TRUE(hit("facet_triangles", two(kTriangle, at(0, 0, 0), kUpright, at(0.5, 0.5, -0x1p-40)), kEvery));
}

// Two triangles in one plane, 1000 m apart: no axis of the test lies in their plane.
TEST(FacetTriangles, CoplanarTrianglesAreAHitHoweverFar) {
  EXPECT_TRUE(hit("facet_triangles", two(kTriangle, at(0, 0, 0), kTriangle, at(1000, 0, 0)), kEvery));
  EXPECT_FALSE(hit("facet_triangles", two(kTriangle, at(0, 0, 0), kTriangle, at(1000, 0, 1)), kEvery));
}

// Two rings of triangles in one plane among others: what clears most triangles must not clear these.
TEST(FacetTriangles, OneCoplanarPairAmongManyIsFound) {
  std::vector<Vec3> points;
  for (int i = 0; i < 10; ++i)
    points.insert(points.end(), {Vec3(0, 0, 2 * i + 1), Vec3(1, 0, 2 * i + 1), Vec3(0, 1, 2 * i + 1)});
  std::vector<Vec3> others = points;
  for (Vec3& p : others) p.z() += 18;  // only the last of `points` and the first of `others` share a plane
  EXPECT_TRUE(hit("facet_triangles", two(cloud(points), at(0, 0, 0), cloud(others), at(100, 0, 0)), kEvery));
  EXPECT_FALSE(hit("facet_triangles", two(cloud(points), at(0, 0, 0), cloud(others), at(100, 0, 0.5)), kEvery));
}

TEST(FacetTriangles, MissesABodyInsideAnother) { expect_blind_to_what_is_inside("facet_triangles"); }

TEST(FacetTriangles, TrianglesThatCutAcrossABodySeeWhatIsInside) {
  expect_to_see_by_triangles_across("facet_triangles");
}

TEST(FacetTriangles, FewerThanThreeSampledFacetsAreNeverHit) {
  expect_no_hit_of_fewer_than_three_facets("facet_triangles");
  EXPECT_FALSE(hit("facet_triangles", two(cloud({{0, 0, 0}, {1, 0, 0}}), at(0, 0, 0), kTriangle, at(0, 0, 0)), kEvery));
}

TEST(FacetTriangles, EnvelopeHasHoles) { expect_holes("facet_triangles"); }

// Points are enlarged about the body's origin before the pose: a body's place is not.
TEST(FacetTriangles, InflatesAboutTheBodysOrigin) {
  const Mesh floor = cloud({{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}), tip = cloud({{0, 0, -10}, {1, 0, 5}, {0, 1, 5}});
  const Knobs larger = with(kEvery, {{"inflate", 1.1}});
  EXPECT_FALSE(hit("facet_triangles", two(floor, at(0, 0, 0), tip, at(0, 0, 10.5)), kEvery));
  EXPECT_TRUE(hit("facet_triangles", two(floor, at(0, 0, 0), tip, at(0, 0, 10.5)), larger));
  EXPECT_FALSE(hit("facet_triangles", two(floor, at(0, 0, 0), tip, at(0, 0, 11.5)), larger));
}

TEST(FacetTriangles, StripSeesWhatDisjointTrianglesLeaveOut) {
  // The fourth to sixth points make the second disjoint triangle; (1,2,3) and (2,3,4) exist in the strip only.
  const Mesh folded = cloud({{0, 0, 9}, {4, 0, 0}, {0, 4, 0}, {0, 0, 0}, {0, 0, 8}, {0, 1, 9}});
  const Mesh pin = cloud({{1, 1, -1}, {1, 1.125, -1}, {1, 1, 1}});
  EXPECT_FALSE(hit("facet_triangles", two(folded, at(0, 0, 0), pin, at(0, 0, 0)), kEvery));
  EXPECT_TRUE(
      hit("facet_triangles", two(folded, at(0, 0, 0), pin, at(0, 0, 0)), with(kEvery, {{"triangles", "strip"}})));
}

TEST(FacetTriangles, AnswersAsDefined) {
  const std::uint64_t seed = 20260103;
  SCOPED_TRACE(seed);
  Random random(seed);
  int hits = 0;
  for (int i = 0; i < 1800; ++i) {
    const Scene scene = random_pair(random, i);
    const std::int64_t stride = i % 3 == 2 ? random.whole(2, 9) : 1;
    const double inflate = i % 2 ? 1.1 : 1;
    const bool strip = i % 5 == 0, expected = as_defined(scene, static_cast<std::size_t>(stride), inflate, strip);
    EXPECT_EQ(hit("facet_triangles", scene,
                  {{"prefilter", "none"},
                   {"stride", stride},
                   {"inflate", inflate},
                   {"triangles", strip ? "strip" : "disjoint"}}),
              expected)
        << i;
    hits += expected;
  }
  EXPECT_GT(hits, 300);
  EXPECT_LT(hits, 1500);
}

// Clouds in one plane, apart: a hit where the arithmetic is exact. Turned, the normals come out a little apart and the
// rounding decides; it must decide as the definition does.
TEST(FacetTriangles, CoplanarTrianglesAnswerAsDefinedExactOrTurned) {
  const std::uint64_t seed = 11;
  SCOPED_TRACE(seed);
  Random random(seed);
  const geometry::Quaternion half_turns[] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  int exact_hits = 0, turned_hits = 0;
  for (int i = 0; i < 800; ++i) {
    const bool exact = i % 2 == 0;
    std::vector<Vec3> a, b;
    for (int k = 0; k < 6; ++k) {
      a.emplace_back(random.whole(-4, 4) / 4.0, random.whole(-4, 4) / 4.0, 0);
      b.emplace_back(2 + random.whole(0, 4) / 4.0, random.whole(-4, 4) / 4.0, 0);
    }
    Pose pose = random.pose(10);
    if (exact) pose = {.q = half_turns[i / 2 % 4], .t = random.lattice(9)};
    const Scene scene = two(cloud(a), pose, cloud(b), pose);
    const bool expected = as_defined(scene, 1, 1, false);
    EXPECT_EQ(hit("facet_triangles", scene, kEvery), expected) << i;
    (exact ? exact_hits : turned_hits) += expected;
  }
  EXPECT_EQ(exact_hits, 400);
  EXPECT_LT(turned_hits, 400);
}

TEST(FacetTriangles, OrderOfThePairDoesNotMatter) {
  expect_the_same_in_either_order("facet_triangles", 12, 600, kEvery);
}

TEST(FacetTriangles, ExactShiftChangesNothing) { expect_the_same_elsewhere("facet_triangles", 13, 200, kEvery); }

// Points on one line, or all in one point, make triangles without a normal: the other axes judge.
TEST(FacetTriangles, TrianglesWithoutAreaAreDefined) {
  const Mesh needle = cloud({{0, 0, -1}, {0, 0, 0}, {0, 0, 1}}), point = cloud({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  EXPECT_TRUE(hit("facet_triangles", two(kTriangle, at(0, 0, 0), needle, at(1, 1, 0)), kEvery));
  EXPECT_FALSE(hit("facet_triangles", two(kTriangle, at(0, 0, 0), needle, at(5, 5, 0)), kEvery));
  EXPECT_TRUE(hit("facet_triangles", two(kTriangle, at(0, 0, 0), point, at(9, 9, 0)), kEvery));
  EXPECT_FALSE(hit("facet_triangles", two(kTriangle, at(0, 0, 0), point, at(1, 1, 1)), kEvery));
  EXPECT_TRUE(hit("facet_triangles", two(point, at(0, 0, 0), point, at(9, 9, 9)), kEvery));  // no axis at all
}

// Ten parallel planes each, all clear of the other body: ten planes looked at, no triangle pair.
TEST(FacetTriangles, CountsPlanesAndTrianglePairs) {
  std::vector<Vec3> points;
  for (int i = 0; i < 10; ++i) points.insert(points.end(), {Vec3(0, 0, i), Vec3(1, 0, i), Vec3(0, 1, i)});
  EXPECT_EQ(ask("facet_triangles", two(cloud(points), at(0, 0, 0), cloud(points), at(0, 0, 100)), kEvery).operations,
            10u);
  EXPECT_EQ(ask("facet_triangles", two(kTriangle, at(0, 0, 0), kTriangle, at(0, 0, 0)), kEvery).operations, 3u);
}

TEST(FacetTriangles, UnbornBodiesAreInNoPair) { expect_unborn_bodies_in_no_pair("facet_triangles"); }

}  // namespace
}  // namespace algorithms
