#include <gtest/gtest.h>

#include "algorithms/cannon_naive.hpp"
#include "algorithms/parts/spheres.hpp"
#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

class Cannon : public testing::TestWithParam<std::string> {
 protected:
  bool met(const Mesh& a, const Vec3& at_a, const Mesh& b, const Vec3& at_b) const {
    return hit(GetParam(), a, {{}, at_a}, b, {{}, at_b});
  }
};

INSTANTIATE_TEST_SUITE_P(Phase, Cannon, testing::Values("cannon_naive", "cannon_sap"),
                         [](const auto& info) { return info.param; });

TEST_P(Cannon, SpheresAreStrict) {
  const Mesh sphere = geometry::sphere("sphere", 1, 8);
  EXPECT_FALSE(met(sphere, {0, 0, 0}, sphere, {2, 0, 0})) << "touching";
  EXPECT_TRUE(met(sphere, {0, 0, 0}, sphere, {std::nextafter(2.0, 0.0), 0, 0}));
  EXPECT_FALSE(met(sphere, {0, 0, 0}, sphere, {std::nextafter(2.0, 3.0), 0, 0}));
}

TEST_P(Cannon, ASphereShapeIsItselfAndNotItsBox) {
  const Mesh sphere = geometry::sphere("sphere", 1, 8);
  EXPECT_FALSE(met(sphere, {0, 0, 0}, sphere, {0, 2.1, 0}));
  EXPECT_TRUE(hit("bounding_sphere", sphere, {}, sphere, {{}, {0, 2.1, 0}}));
}

TEST_P(Cannon, AnyOtherBodyHasItsHalfDiagonal) {
  const Mesh three = geometry::box("three", {2, 4, 4});  // half diagonal 3
  EXPECT_FALSE(met(three, {0, 0, 0}, three, {0, 0, 6}));
  EXPECT_TRUE(met(three, {0, 0, 0}, three, {0, 0, 5.999999}));
}

TEST_P(Cannon, IsEarlyBetweenSphereAndMesh) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  EXPECT_TRUE(met(cube, {0, 0, 0}, cube, {0, 3, 0}));
  EXPECT_FALSE(truly_meet(cube, {}, cube, {{}, {0, 3, 0}}));
}

TEST_P(Cannon, DropsTwoFixedBodies) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const Setting setting = Setting().add(cube, {}, true).add(cube, {}, true).add(cube, {});
  EXPECT_EQ(hits(GetParam(), setting), (std::vector<Pair>{{0, 2}, {1, 2}}));
}

// Asked directly about two fixed bodies, only the algorithm's own filter could drop them: sweep and prune has it.
TEST(CannonSap, FiltersFixedPairsItself) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const Setting setting = Setting().add(cube, {}, true).add(cube, {}, true);
  const auto method = make("cannon_sap", setting.bodies);
  const std::vector<PairRun> both_fixed = {{0, 1, 2}};
  std::vector<Pair> found;
  method->prepare(setting.poses);
  method->answer(both_fixed, found);
  method->count(both_fixed, found);
  EXPECT_TRUE(found.empty());
}

// The ball of a sphere begins where its box does: nothing is hidden.
TEST(CannonSap, AnswersAsNaiveAmongSpheres) {
  for (std::uint32_t seed = 91; seed <= 98; ++seed) {
    std::mt19937 random(seed);
    Setting setting;
    for (int i = 0; i < 80; ++i)
      setting.add(geometry::sphere("sphere", 0.3 + 0.2 * (i % 5), 8), {{}, uniform_point(random, 1 + seed % 5)},
                  i % 7 == 3);
    for (std::uint32_t body = 0; body < 80; body += 9) setting.poses[body] = geometry::unborn();
    const std::vector<Pair> naive = hits("cannon_naive", setting);
    EXPECT_GT(naive.size(), 20u);
    EXPECT_EQ(hits("cannon_sap", setting), naive) << "seed " << seed;
  }
}

// The plate's box begins at x = -30, its ball at -42.4. The sphere at -35 touches that ball, but the search of its
// partners ends at the sphere at -32, whose box begins before the plate's.
TEST(CannonSap, LosesAPairBehindABodyWhoseBoxBeginsBefore) {
  const Mesh sphere = geometry::sphere("sphere", 1, 8), plate = geometry::box("plate", {60, 2, 60});
  const Setting two = Setting().add(plate, {}, true).add(sphere, {{}, {-35, 0, 0}});
  Setting three = two;
  three.add(sphere, {{}, {-32, 0, 0}});
  EXPECT_EQ(hits("cannon_sap", two), (std::vector<Pair>{{0, 1}}));
  EXPECT_EQ(hits("cannon_naive", three), (std::vector<Pair>{{0, 1}, {0, 2}}));
  EXPECT_EQ(hits("cannon_sap", three), (std::vector<Pair>{{0, 2}}));
}

// A pair of two fixed bodies is passed over before its bounds are looked at: it ends no search.
TEST(CannonSap, AFixedBodyIsNotHiddenBehindAFixedOne) {
  const Mesh sphere = geometry::sphere("sphere", 1, 8), plate = geometry::box("plate", {60, 2, 60});
  Setting setting = Setting().add(sphere, {{}, {-35, 0, 0}}, true).add(sphere, {{}, {-32, 0, 0}}, true);
  setting.add(plate, {});
  EXPECT_EQ(hits("cannon_sap", setting), (std::vector<Pair>{{0, 2}, {1, 2}}));
}

/// The engine's loop as it stands there, over boxes whose corners are placed by matrices.
std::vector<Pair> by_the_engines_loop(const Setting& setting) {
  struct Body {
    std::uint32_t number;
    double lower, radius;
    Vec3 at;
  };
  std::vector<Body> list;
  const std::vector<double> radii = geometry::nominal_radii(setting.bodies);
  for (std::uint32_t b = 0; b < setting.poses.size(); ++b) {
    if (!geometry::is_born(setting.poses[b])) continue;
    const Mesh& mesh = setting.bodies.mesh_of(b);
    const Vec3& at = setting.poses[b].t;
    const Vec3 way = (geometry::rotation(setting.poses[b].q).row(0).transpose().array().abs() *
                      geometry::half_extents(mesh).array());
    list.push_back({b, at.x() - (mesh.sphere_radius > 0 ? radii[b] : way.sum()), radii[b], at});
  }
  std::stable_sort(list.begin(), list.end(), [](const Body& p, const Body& q) { return p.lower < q.lower; });
  std::vector<Pair> out;
  for (std::size_t i = 0; i < list.size(); ++i)
    for (std::size_t k = i + 1; k < list.size(); ++k) {
      const Body &p = list[i], &q = list[k];
      if (setting.bodies.fixed[p.number] && setting.bodies.fixed[q.number]) continue;
      if (!(q.at.x() - q.radius < p.at.x() + p.radius)) break;
      if ((q.at - p.at).squaredNorm() < (p.radius + q.radius) * (p.radius + q.radius))
        out.push_back({std::min(p.number, q.number), std::max(p.number, q.number)});
    }
  std::sort(out.begin(), out.end());
  return out;
}

TEST(CannonSap, AnswersAsTheEnginesLoop) {
  int hidden = 0;
  for (std::uint32_t seed = 101; seed <= 140; ++seed) {
    std::mt19937 random(seed);
    Setting setting = crowd(random, 60, 2 + seed % 7);
    setting.add(geometry::box("plate", {12, 0.5, 12}), {uniform_turn(random), uniform_point(random, 2)}, seed % 2);
    for (std::uint32_t body = 0; body < 60; body += 9) setting.poses[body] = geometry::unborn();
    const std::vector<Pair> found = hits("cannon_sap", setting);
    ASSERT_EQ(found, by_the_engines_loop(setting)) << "seed " << seed;
    hidden += static_cast<int>(hits("cannon_naive", setting).size() - found.size());
  }
  EXPECT_GT(hidden, 0);
}

// Far from the origin x - r and x + r round by more than the overlap, and so the engine breaks.
TEST(CannonSap, BreaksByRoundedBoundsFarFromTheOrigin) {
  std::mt19937 random(99);
  SCOPED_TRACE("seed 99");
  const Mesh sphere = geometry::sphere("sphere", 0.7, 8);
  int lost = 0;
  for (int round = 0; round < 100; ++round) {
    const double x = 1e9 * uniform(random), step = std::nextafter(std::abs(x), 1e300) - std::abs(x);
    Setting setting;
    for (int i = 0; i < 10; ++i) setting.add(sphere, {{}, {x + std::floor(1.4 * i / step) * step, 0, 0}});
    const std::vector<Pair> found = hits("cannon_sap", setting);
    ASSERT_EQ(found, by_the_engines_loop(setting)) << "round " << round;
    lost += static_cast<int>(hits("cannon_naive", setting).size() - found.size());
  }
  EXPECT_GT(lost, 0);
}

TEST(CannonSap, TriesFewerPairs) {
  const Mesh sphere = geometry::sphere("sphere", 1, 8);
  Setting setting;
  for (int i = 0; i < 100; ++i) setting.add(sphere, {{}, {1.5 * i, 0, 0}});
  std::vector<Pair> found;
  const auto operations = [&](const std::string& name) {
    const auto method = make(name, setting.bodies);
    method->prepare(setting.poses);
    found.clear();
    return method->count(setting.runs(), found);
  };
  EXPECT_EQ(operations("cannon_naive"), 4950u);
  // Each but the last has one neighbour, found by halving at most 99 bounds: 1 to 7 comparisons, and its sphere.
  EXPECT_GE(operations("cannon_sap"), 99u * (1 + 1));
  EXPECT_LE(operations("cannon_sap"), 99u * (7 + 1));
  EXPECT_EQ(found.size(), 99u);
}

TEST(CannonSap, CountsTheBoundsItComparedAndTheSpheres) {
  const Mesh sphere = geometry::sphere("sphere", 1, 8);
  const auto operations = [&](double gap) {
    const Setting setting = Setting().add(sphere, {}).add(sphere, {{}, {gap, 0, 0}}).add(sphere, {{}, {2 * gap, 0, 0}});
    const auto method = make("cannon_sap", setting.bodies);
    std::vector<Pair> found;
    method->prepare(setting.poses);
    return method->count(setting.runs(), found);
  };
  // After the first, two bounds are halved at the farther one; after the second, one is left; after the third, none.
  EXPECT_EQ(operations(0.5), 1u + 1 + 2 + 1) << "one look at each and all three pairs";
  EXPECT_EQ(operations(1.5), 2u + 1 + 2) << "the first looks at the nearer one too; neighbours";
  EXPECT_EQ(operations(9), 2u + 1) << "no spheres";
}

}  // namespace
}  // namespace algorithms
