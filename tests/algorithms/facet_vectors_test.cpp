// facet_vectors (P): answers as defined and its known errors.
#include "algorithms/thesis/facet_vectors.hpp"

#include <array>

#include "tests/support/facet_scenes.hpp"

namespace algorithms {
namespace {

using namespace facet_scenes;

const Knobs kEvery = {{"prefilter", "none"}, {"stride", std::int64_t{1}}};

/// The definition, word for word.
bool as_defined(const Scene& scene, std::size_t stride, double max_third) {
  const auto from = world_points(scene.bodies.mesh_of(0), scene.poses[0], stride);
  const auto to = world_points(scene.bodies.mesh_of(1), scene.poses[1], stride);
  constexpr int planes[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};
  for (const auto& [u, v, w] : planes) {
    std::array<bool, 4> occurs = {};
    double third = std::numeric_limits<double>::infinity();
    for (const Vec3& b : to)
      for (const Vec3& a : from) {
        const Vec3 vector = b - a;
        occurs[(vector[u] > 0 ? 1 : 0) + (vector[v] > 0 ? 2 : 0)] = true;
        third = std::fmin(third, std::fabs(vector[w]));
      }
    if (occurs[0] && occurs[1] && occurs[2] && occurs[3] && third < max_third) return true;
  }
  return false;
}

// Four points of b around the one of a, in the plane xy and at a height.
Scene cross(double height) {
  return two(cloud({{0, 0, 0}}), at(0, 0, 0), cloud({{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}}),
             at(0, 0, height));
}

TEST(FacetVectors, FourWaysAndAShortThirdAreAHit) {
  EXPECT_TRUE(hit("facet_vectors", cross(0.25), kEvery));
  EXPECT_TRUE(hit("facet_vectors", cross(-0.25), kEvery));
}

TEST(FacetVectors, ThirdIsStrictlyBelowTheLimit) {
  EXPECT_FALSE(hit("facet_vectors", cross(0.5), kEvery));
  EXPECT_TRUE(hit("facet_vectors", cross(0.5 - 0x1p-40), kEvery));
  EXPECT_TRUE(hit("facet_vectors", cross(-0.5 + 0x1p-40), kEvery));
  EXPECT_FALSE(hit("facet_vectors", cross(-0.5 - 0x1p-40), kEvery));
}

TEST(FacetVectors, ThreeWaysAreNoHit) {
  const Scene scene =
      two(cloud({{0, 0, 0}}), at(0, 0, 0), cloud({{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {-2, -1, 0}}), at(0, 0, 0.25));
  EXPECT_FALSE(hit("facet_vectors", scene, kEvery));
}

TEST(FacetVectors, ZeroCountsAsNegative) {
  const Mesh a = cloud({{0, 0, 0}});
  EXPECT_TRUE(hit("facet_vectors",
                  two(a, at(0, 0, 0), cloud({{1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}}), at(0, 0, 0)), kEvery));
  EXPECT_FALSE(hit("facet_vectors",
                   two(a, at(0, 0, 0), cloud({{0, 0, 0}, {-1, 0, 0}, {-1, -1, 0}, {0, -1, 0}}), at(0, 0, 0)), kEvery));
}

// Every plane serves: the cross in xy, yz and zx.
TEST(FacetVectors, LooksAtAllThreePlanes) {
  for (const int w : {0, 1, 2}) {
    std::vector<Vec3> points;
    for (const double u : {-1.0, 1.0})
      for (const double v : {-1.0, 1.0}) {
        Vec3 p;
        p[w] = 0.25;
        p[(w + 1) % 3] = u;
        p[(w + 2) % 3] = v;
        points.push_back(p);
      }
    EXPECT_TRUE(hit("facet_vectors", two(cloud({{0, 0, 0}}), at(0, 0, 0), cloud(points), at(0, 0, 0)), kEvery)) << w;
  }
}

// Two boards side by side, turned 45 degrees about z, with a gap of 1 between their faces.
TEST(FacetVectors, IsEarlyOnTurnedBodies) {
  const Mesh board = geometry::box("board", {8, 1, 1});
  const geometry::Quaternion turned = geometry::turn_about({0, 0, 1}, 0.78539816339744828);
  const double across = 2 / std::sqrt(2.0);  // centres are 2 apart along the boards' normal
  const Scene apart = two(board, {.q = turned, .t = {0, 0, 0}}, board, {.q = turned, .t = {-across, across, 0}});
  const Knobs dense = {{"prefilter", "none"}, {"densify", true}};
  EXPECT_TRUE(hit("facet_vectors", apart, dense));
  // The same two boards unturned, with the same gap, are told apart.
  EXPECT_FALSE(hit("facet_vectors", two(board, at(0, 0, 0), board, at(0, 2, 0)), dense));
}

// A box has twelve facets, hence one point at stride 20: no four ways.
TEST(FacetVectors, MissesBoxesThatAreNotDensified) {
  const Mesh box = geometry::box("box", {2, 2, 2});
  const Scene scene = two(box, at(0, 0, 0), box, at(0.5, 0.25, 0.125));
  EXPECT_FALSE(hit("facet_vectors", scene));
  EXPECT_TRUE(hit("facet_vectors", scene, {{"densify", true}}));
}

TEST(FacetVectors, AnswersAsDefined) {
  const std::uint64_t seed = 20260102;
  SCOPED_TRACE(seed);
  Random random(seed);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Scene scene = random_pair(random, i);
    const std::size_t stride = i % 4 < 2 ? 1 : i % 7 + 1;
    const double limit = i % 3 == 1 ? random.whole(1, 2) : random.between(0.001, 0.5);
    const bool expected = as_defined(scene, stride, limit);
    EXPECT_EQ(hit("facet_vectors", scene,
                  {{"prefilter", "none"}, {"stride", static_cast<std::int64_t>(stride)}, {"max_third", limit}}),
              expected)
        << i;
    hits += expected;
  }
  EXPECT_GT(hits, 500);
  EXPECT_LT(hits, 2500);
}

// The second pass of the thesis, from b to a, is left out: with no component exactly zero it changes nothing.
TEST(FacetVectors, OrderOfThePairDoesNotMatterWithoutZeros) {
  const std::uint64_t seed = 8;
  SCOPED_TRACE(seed);
  Random random(seed);
  for (int i = 0; i < 600; ++i) {
    const Scene scene = random_pair(random, 3 * i + (i % 2 ? 2 : 0));
    EXPECT_EQ(hit("facet_vectors", scene, kEvery), hit("facet_vectors", swapped(scene), kEvery)) << i;
  }
}

// With a zero it can: from a to b the point straight above counts as left and below, from b to a as well.
TEST(FacetVectors, OrderOfThePairMattersWhereAComponentIsZero) {
  const Scene scene =
      two(cloud({{0, 0, 0}}), at(0, 0, 0), cloud({{1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}}), at(0, 0, 0));
  EXPECT_TRUE(hit("facet_vectors", scene, kEvery));
  EXPECT_FALSE(hit("facet_vectors", swapped(scene), kEvery));
}

TEST(FacetVectors, ExactShiftChangesNothing) { expect_the_same_elsewhere("facet_vectors", 9, 200, kEvery); }

TEST(FacetVectors, BodiesAtTheSamePlaceAndPointsAreDefined) {
  const Mesh sphere = geometry::sphere("sphere", 1, 16), point = cloud({{0, 0, 0}});
  EXPECT_TRUE(hit("facet_vectors", two(sphere, at(1, 2, 3), sphere, at(1, 2, 3))));
  EXPECT_FALSE(hit("facet_vectors", two(point, at(1, 2, 3), point, at(1, 2, 3)), kEvery));
}

// One bound for each plane; x and y overlap nowhere, so no vector is formed.
TEST(FacetVectors, CountsVectors) {
  const Mesh sphere = geometry::sphere("sphere", 1, 16);
  EXPECT_EQ(ask("facet_vectors", two(sphere, at(0, 0, 0), sphere, at(9, 9, 0)), kEvery).operations, 3u);
}

TEST(FacetVectors, UnbornBodiesAreInNoPair) { expect_unborn_bodies_in_no_pair("facet_vectors"); }

}  // namespace
}  // namespace algorithms
