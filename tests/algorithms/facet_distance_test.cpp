// facet_distance (K): answers as defined, its known errors, and that the index changes nothing.
#include "algorithms/thesis/facet_distance.hpp"

#include "tests/support/facet_scenes.hpp"

namespace algorithms {
namespace {

using namespace facet_scenes;

const Knobs kAll = {{"prefilter", "none"}, {"densify", false}, {"facets_per_area", 1e9}};

/// The definition, word for word.
bool as_defined(const Scene& scene, double max_distance, double facets_per_area, bool densify) {
  std::vector<Vec3> points[2];
  for (std::uint32_t body : {0u, 1u}) {
    const Mesh& mesh = scene.bodies.mesh_of(body);
    const Vec3 size = geometry::local_box(mesh).max - geometry::local_box(mesh).min;
    const double area = 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
    const Mesh dense = densify ? geometry::densified(mesh, facets_per_area) : mesh;
    const double quotient = std::floor(static_cast<double>(dense.triangles.size()) / (facets_per_area * area));
    const auto stride = area > 0 ? static_cast<std::size_t>(std::fmax(1, quotient)) : 1;
    points[body] = world_points(dense, scene.poses[body], stride);
  }
  double smallest = std::numeric_limits<double>::infinity();
  for (const Vec3& p : points[0])
    for (const Vec3& q : points[1]) {
      const double dx = q.x() - p.x(), dy = q.y() - p.y(), dz = q.z() - p.z();
      smallest = std::fmin(smallest, dx * dx + dy * dy + dz * dz);
    }
  return smallest < max_distance * max_distance;
}

TEST(FacetDistance, LimitIsStrict) {
  const Mesh point = cloud({{0, 0, 0}});
  for (const char* search : {"indexed", "exhaustive"}) {
    const Knobs knobs = with(kAll, {{"search", search}});
    EXPECT_FALSE(hit("facet_distance", two(point, at(0, 0, 0), point, at(0.25, 0, 0)), knobs));
    EXPECT_TRUE(hit("facet_distance", two(point, at(0, 0, 0), point, at(0.25 - 0x1p-40, 0, 0)), knobs));
    EXPECT_FALSE(hit("facet_distance", two(point, at(0, 0, 0), point, at(0, -0.25 - 0x1p-40, 0)), knobs));
    EXPECT_TRUE(hit("facet_distance", two(point, at(3, 4, 5), point, at(3, 4, 5)), knobs));
  }
}

TEST(FacetDistance, NothingIsNearerThanZero) {
  const Mesh point = cloud({{0, 0, 0}});
  EXPECT_FALSE(hit("facet_distance", two(point, at(1, 1, 1), point, at(1, 1, 1)), with(kAll, {{"max_distance", 0.0}})));
}

// The inner sphere has a gap of 0.7 all round.
TEST(FacetDistance, MissesASmallBodyInsideABigOne) {
  const Scene scene = two(geometry::sphere("big", 1, 16), at(0, 0, 0), geometry::sphere("small", 0.3, 16), at(0, 0, 0));
  EXPECT_FALSE(hit("facet_distance", scene));
  EXPECT_FALSE(hit("facet_distance", scene, {{"prefilter", "none"}}));
}

// One of two spheres that overlap by 0.02 turns where it is: the contact stays, sampled points come and go.
TEST(FacetDistance, Flickers) {
  const Mesh sphere = geometry::sphere("sphere", 1, 16);
  int changes = 0;
  bool before = false;
  for (int i = 0; i < 120; ++i) {
    Pose turning = at(1.98, 0, 0);
    turning.q = geometry::turn_about({0, 1, 0}, 0.01 * i);
    const bool now = hit("facet_distance", two(sphere, at(0, 0, 0), sphere, turning), {{"prefilter", "none"}});
    if (i > 0 && now != before) ++changes;
    before = now;
  }
  EXPECT_GE(changes, 4);
}

TEST(FacetDistance, ReportsBodiesThatAreMerelyNear) {
  const Mesh sphere = geometry::sphere("sphere", 1, 16);
  EXPECT_TRUE(hit("facet_distance", two(sphere, at(0, 0, 0), sphere, at(2.1, 0, 0)), {{"prefilter", "none"}}));
  EXPECT_FALSE(hit("facet_distance", two(sphere, at(0, 0, 0), sphere, at(2.26, 0, 0)), {{"prefilter", "none"}}));
}

// A slab has two triangles on top, with points 5 m away from the pin.
TEST(FacetDistance, SeesTheMiddleOfLargeFacetsOnlyWhenTheyAreCut) {
  const Scene scene =
      two(geometry::box("slab", {20, 1, 20}), at(0, 0, 0), geometry::box("pin", {0.2, 0.2, 0.2}), at(0.3, 0.5, 0.2));
  EXPECT_TRUE(hit("facet_distance", scene));
  EXPECT_FALSE(hit("facet_distance", scene, {{"densify", false}}));
}

TEST(FacetDistance, AnswersAsDefined) {
  const std::uint64_t seed = 20260101;
  SCOPED_TRACE(seed);
  Random random(seed);
  int hits = 0;
  for (int i = 0; i < 240; ++i) {
    const Scene scene = random_pair(random, i);
    const bool densify = i % 2 == 0;
    // On the lattice distances of exactly 1 and 2 are common: the limit's strictness is asked all the time.
    const double limit = i % 3 == 1 ? random.whole(1, 2) : random.between(0.05, 0.6), density = random.between(0.5, 20);
    const bool expected = as_defined(scene, limit, density, densify);
    for (const char* search : {"indexed", "exhaustive"})
      EXPECT_EQ(hit("facet_distance", scene,
                    {{"prefilter", "none"},
                     {"densify", densify},
                     {"facets_per_area", density},
                     {"max_distance", limit},
                     {"search", search}}),
                expected)
          << i << ' ' << search;
    hits += expected;
  }
  EXPECT_GT(hits, 40);
  EXPECT_LT(hits, 200);
}

// The limit lies within a few roundings of the smallest distance, where an index with a wrong margin would show.
TEST(FacetDistance, IndexAgreesAtTheLastBit) {
  const std::uint64_t seed = 5;
  SCOPED_TRACE(seed);
  Random random(seed);
  int hits = 0, misses = 0;
  for (int i = 0; i < 400; ++i) {
    const Mesh a = random.points(8, 1), b = random.points(8, 1);
    const Pose pose = random.pose(3), other = random.pose(3);
    const Scene scene = two(a, pose, b, other);
    double smallest = std::numeric_limits<double>::infinity();
    for (const Vec3& p : world_points(a, pose, 1))
      for (const Vec3& q : world_points(b, other, 1)) {
        const Vec3 d = q - p;
        smallest = std::fmin(smallest, d.x() * d.x() + d.y() * d.y() + d.z() * d.z());
      }
    double limit = std::sqrt(smallest);
    for (int step = 0; step < i % 5; ++step) limit = std::nextafter(limit, i % 2 ? 0.0 : 100.0);
    const bool expected = smallest < limit * limit;
    EXPECT_EQ(hit("facet_distance", scene, with(kAll, {{"max_distance", limit}})), expected) << i;
    EXPECT_EQ(hit("facet_distance", scene, with(kAll, {{"max_distance", limit}, {"search", "exhaustive"}})), expected);
    (expected ? hits : misses) += 1;
  }
  EXPECT_GT(hits, 50);
  EXPECT_GT(misses, 50);
}

TEST(FacetDistance, OrderOfThePairDoesNotMatter) { expect_the_same_in_either_order("facet_distance", 6, 150); }

TEST(FacetDistance, ExactShiftChangesNothing) {
  expect_the_same_elsewhere("facet_distance", 7, 100, with(kAll, {{"max_distance", 2}}));
}

TEST(FacetDistance, PrefilterDecidesFirst) {
  const Mesh sphere = geometry::sphere("sphere", 1, 16);
  const Scene scene = two(sphere, at(0, 0, 0), sphere, at(2.1, 0, 0));  // boxes end at 1 and begin at 1.1
  EXPECT_FALSE(hit("facet_distance", scene));
  EXPECT_TRUE(hit("facet_distance", scene, {{"prefilter", "none"}}));
}

// Two rows of 50 points far apart: the exhaustive search has 2500 distances, the index one, between two balls.
TEST(FacetDistance, CountsDistances) {
  std::vector<Vec3> points;
  for (int i = 0; i < 50; ++i) points.emplace_back(0.01 * i, 0, 0);
  const Scene scene = two(cloud(points), at(0, 0, 0), cloud(points), at(0, 9, 0));
  EXPECT_EQ(ask("facet_distance", scene, with(kAll, {{"search", "exhaustive"}})).operations, 2500u);
  EXPECT_EQ(ask("facet_distance", scene, kAll).operations, 1u);
}

TEST(FacetDistance, UnbornBodiesAreInNoPair) {
  expect_unborn_bodies_in_no_pair("facet_distance", {{"max_distance", 1}});
}

TEST(FacetDistance, RefusesKnobsOutOfRange) {
  EXPECT_THROW(knobs("facet_distance", {{"facets_per_area", 0.0}}), std::invalid_argument);
  EXPECT_THROW(knobs("facet_distance", {{"max_distance", -0.1}}), std::invalid_argument);
  EXPECT_THROW(knobs("facet_distance", {{"search", "best"}}), std::invalid_argument);
}

}  // namespace
}  // namespace algorithms
