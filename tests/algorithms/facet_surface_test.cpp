// facet_surface and facet_gjk: the better envelope and the better vectors that the thesis wished for.
#include "algorithms/beyond/facet_surface.hpp"

#include <gtest/gtest.h>

#include "algorithms/beyond/facet_gjk.hpp"
#include "geometry/decision/contain.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

Changed open_to_all() { return {{"prefilter", std::string("none")}}; }

/// A method set up once for two meshes, asked again and again.
class Pairing {
 public:
  Pairing(const std::string& name, const Mesh& a, const Mesh& b, const Changed& changed = open_to_all())
      : setting_(Setting().add(a, {}).add(b, {})),
        method_(make(name, setting_.bodies, changed)),
        back_(make(name, Setting().add(b, {}).add(a, {}).bodies, changed)) {}

  bool met(const Pose& at_a, const Pose& at_b) const {
    const bool there = ask(*method_, {at_a, at_b});
    EXPECT_EQ(ask(*back_, {at_b, at_a}), there) << "the other way round";
    return there;
  }

 private:
  bool ask(Method& method, const std::vector<Pose>& poses) const {
    std::vector<Pair> found;
    method.prepare(poses);
    method.answer(geometry::pair_runs(setting_.bodies, poses), found);
    return !found.empty();
  }

  Setting setting_;
  std::unique_ptr<Method> method_, back_;
};

bool met(const std::string& name, const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b,
         const Changed& changed = open_to_all()) {
  return Pairing(name, a, b, changed).met(at_a, at_b);
}

class Wishes : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Row, Wishes, testing::Values("facet_surface", "facet_gjk"),
                         [](const auto& info) { return info.param; });

// Boxes keep their twelve facets and all their corners: the answer is exact.
TEST_P(Wishes, AreExactOnBoxes) {
  std::mt19937 random(91);
  SCOPED_TRACE("seed 91");
  Setting setting;
  for (int i = 0; i < 30; ++i)
    setting.add(geometry::box("box", {1.5, 1, 2}), {uniform_turn(random), uniform_point(random, 3)});
  const std::vector<Pair> truly = truth(setting);
  EXPECT_GT(truly.size(), 30u);
  EXPECT_EQ(hits(GetParam(), setting, open_to_all()), truly);
}

// A sphere's envelope has no holes and is nowhere far from it: contact from any side is seen, and nothing beyond a
// tenth of the radius is. facet_triangles, with the same facets, misses most.
TEST_P(Wishes, HaveNoHolesWhereFacetTrianglesHas) {
  const Mesh ball = geometry::sphere("ball", 1, 16);
  std::mt19937 random(92);
  SCOPED_TRACE("seed 92");
  const Pairing pair(GetParam(), ball, ball), triangles("facet_triangles", ball, ball);
  int missed_by_triangles = 0;
  for (int round = 0; round < 60; ++round) {
    Vec3 way = uniform_point(random, 1);
    way /= way.norm();
    const Pose a{uniform_turn(random), {0, 0, 0}};
    const auto at = [&](double distance) { return Pose{uniform_turn(random), distance * way}; };
    const Pose deep = at(1.8);
    EXPECT_TRUE(pair.met(a, deep)) << round;
    EXPECT_FALSE(pair.met(a, at(2.25))) << round;
    missed_by_triangles += !triangles.met(a, deep);
  }
  EXPECT_GT(missed_by_triangles, 10);
}

// A ball in the hole of a ring, and one that touches its tube.
TEST_P(Wishes, LeaveTheHoleOfARingOpen) {
  const Mesh around = geometry::torus("torus", 6, 1, 16), ball = geometry::sphere("ball", 1, 8);
  const Pairing pair(GetParam(), around, ball);
  EXPECT_FALSE(pair.met({}, {}));
  EXPECT_TRUE(pair.met({}, {{}, {1.8, 0, 0}}));
  EXPECT_TRUE(pair.met({}, {{}, {0, 0, -1.9}}));
  EXPECT_FALSE(pair.met({}, {{}, {0, 3, 0}}));
}

// Known: surfaces do not see a body inside another, solids do, whatever the truth asks for.
TEST(FacetSurface, MissesABodyInsideAnother) {
  const Mesh room = geometry::box("room", {9, 9, 9}), ball = geometry::sphere("ball", 1, 8);
  EXPECT_FALSE(met("facet_surface", room, {}, ball, {{}, {1, 0, 2}}));
  EXPECT_TRUE(met("facet_surface", room, {}, ball, {{}, {4, 0, 2}}));
  EXPECT_FALSE(met("facet_surface", geometry::sphere("globe", 4, 16), {}, ball, {}));
  EXPECT_TRUE(met("facet_gjk", room, {}, ball, {{}, {1, 0, 2}}));
}

TEST(FacetSurface, InflatesAboutTheOrigin) {
  const Mesh ball = geometry::sphere("ball", 1, 16);
  const auto at = [&](double inflate) {
    Changed changed = open_to_all();
    changed.push_back({"inflate", inflate});
    return met("facet_surface", ball, {}, ball, {{}, {2.5, 0, 0}}, changed);
  };
  EXPECT_FALSE(at(1.0));
  EXPECT_FALSE(at(1.1));
  EXPECT_TRUE(at(1.4));
}

TEST(FacetSurface, WithoutStrideIsTheMeshItself) {
  for (std::uint32_t seed = 93; seed <= 94; ++seed) {
    std::mt19937 random(seed);
    const Setting setting = crowd(random, 30, 3);
    Changed changed = open_to_all();
    changed.push_back({"stride", std::int64_t{1}});
    const std::vector<Pair> truly = truth(setting), found = hits("facet_surface", setting, changed);
    EXPECT_GT(truly.size(), 20u);
    EXPECT_EQ(found, truly) << "seed " << seed;
  }
}

TEST(FacetGjk, ReachesFartherByItsKnob) {
  const Mesh ball = geometry::sphere("ball", 1, 6);
  const auto at = [&](double reach) {
    Changed changed = open_to_all();
    changed.push_back({"reach", reach});
    return met("facet_gjk", ball, {}, ball, {{}, {2.4, 0, 0}}, changed);
  };
  EXPECT_FALSE(at(0.0));
  EXPECT_FALSE(at(0.5));
  EXPECT_TRUE(at(8.0));
}

// Without a filter in front it rejects what is far itself: by nothing that is within its reach, and one pair after
// another as row by row. The filter here is wider than all that it tests.
TEST(FacetGjk, AnswersAloneAsBehindAFilterThatLosesNothing) {
  for (std::uint32_t seed = 95; seed <= 97; ++seed) {
    std::mt19937 random(seed);
    Setting setting = crowd(random, 40, 3);
    for (int i = 0; i < 20; ++i)
      setting.add(i % 2 ? geometry::torus("torus", 2, 0.5, 8) : geometry::sphere("ball", 0.7, 6),
                  {uniform_turn(random), uniform_point(random, 3)});
    for (const double reach : {0.5, 1.0}) {
      const Changed alone = {{"prefilter", std::string("none")}, {"reach", reach}},
                    behind = {{"prefilter", std::string("bounding_sphere")}, {"reach", reach}};
      const std::vector<Pair> found = hits("facet_gjk", setting, alone);
      EXPECT_GT(found.size(), 100u);
      EXPECT_LT(found.size(), 1400u) << "of 1770 pairs";
      EXPECT_EQ(found, hits("facet_gjk", setting, behind)) << "seed " << seed << ", reach " << reach;
    }
  }
}

// What stands in the file in place of a mesh.
TEST_P(Wishes, TellWhatTheyTestInPlaceOfAMesh) {
  const Algorithm& row = *find(GetParam());
  const Mesh ring = geometry::torus("torus", 6, 1, 16), cube = geometry::box("cube", {1, 1, 1});
  const Setting setting = Setting().add(ring, {}).add(cube, {});
  const std::vector<Proxy> found = row.proxies(setting.bodies, presets(row));
  ASSERT_EQ(found.size(), 2u);
  const std::vector<Mesh>& of_ring = found[0].solids;
  if (row.name == "facet_surface") {
    ASSERT_EQ(of_ring.size(), 1u);
    EXPECT_LE(of_ring[0].triangles.size(), std::max<std::size_t>(32, ring.triangles.size() / 20));
    EXPECT_TRUE(geometry::solid_of(of_ring[0], 0).closed);
  } else {
    EXPECT_GT(of_ring.size(), 1u) << "the hole stays open";
    for (const Mesh& piece : of_ring)
      for (const Vec3& v : piece.vertices) EXPECT_NE(std::ranges::find(ring.vertices, v), ring.vertices.end());
  }
  ASSERT_EQ(found[1].solids.size(), 1u);
  EXPECT_EQ(found[1].solids[0].triangles.size(), 12u) << "a box is itself";
}

// Flat, straight, single and repeated facets have an answer, and are apart where nothing is near.
TEST_P(Wishes, TakeWhateverAMeshIs) {
  tests::Random random(12);
  for (int round = 0; round < 60; ++round) {
    const Mesh a = adversary::mesh(random), b = adversary::mesh(random);
    const Pose at_a = adversary::pose(random, 1), at_b = adversary::pose(random, 1);
    met(GetParam(), a, at_a, b, at_b);
  }
  Mesh sheet = geometry::box("sheet", {2, 2, 0}), needle = geometry::box("needle", {0, 0, 2}),
       point = geometry::box("point", {0, 0, 0});
  for (const Mesh* one : {&sheet, &needle, &point})
    for (const Mesh* other : {&sheet, &needle, &point}) {
      EXPECT_FALSE(met(GetParam(), *one, {}, *other, {{}, {5, 0, 0}}));
      EXPECT_TRUE(met(GetParam(), *one, {}, *other, {})) << one->name << ' ' << other->name;
    }
}

}  // namespace
}  // namespace algorithms
