// The table, the rules of knobs, and what holds for every algorithm of the table.
#include "algorithms/contract/algorithm.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/plugins.hpp"
#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using geometry::Mesh;
using geometry::Vec3;
using setting::crowd;
using setting::hits;
using setting::make;
using setting::Setting;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string refusal(const Knob& knob, const Value& value) {
  try {
    checked(knob, value);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

Knob whole_knob() {
  return {.name = "stride", .preset = std::int64_t{20}, .unit = "1", .what = "", .least = 1, .most = 1000000};
}

Knob real_knob() { return {.name = "far", .preset = 0.25, .unit = "m", .what = "", .least = 0}; }

TEST(Table, HoldsTheThesissNineInItsOrder) {
  std::string keys;
  for (const Algorithm& algorithm : all()) keys += algorithm.thesis_key;
  EXPECT_EQ(keys, "GHJKLPOIU");
}

TEST(Table, NamesAreUniqueAndFound) {
  std::set<std::string> names;
  for (const Algorithm& algorithm : all()) {
    EXPECT_TRUE(names.insert(algorithm.name).second) << algorithm.name;
    EXPECT_EQ(find(algorithm.name), &algorithm);
    EXPECT_FALSE(algorithm.what.empty()) << algorithm.name;
    EXPECT_FALSE(algorithm.operations_unit.empty()) << algorithm.name;
  }
  EXPECT_EQ(find("no_such_algorithm"), nullptr);
  EXPECT_EQ(find(""), nullptr);
}

TEST(Table, PromisesAreThoseOfTheDesign) {
  std::set<std::string> conservative, exact;
  for (const Algorithm& algorithm : all()) {
    if (algorithm.promise == Promise::conservative) conservative.insert(algorithm.name);
    if (algorithm.promise == Promise::exact) exact.insert(algorithm.name);
  }
  EXPECT_EQ(exact, (std::set<std::string>{"exact", "exact_cold"}));
  EXPECT_EQ(conservative, (std::set<std::string>{"obb_sat", "bounding_sphere", "aabb", "cannon_naive", "convex_hull",
                                                 "octree", "spheres", "capsule"}));
}

TEST(Table, MethodsWithABroadPhaseSaySo) {
  std::set<std::string> scene;
  for (const Algorithm& algorithm : all())
    if (algorithm.scope == Scope::scene && algorithm.library.name.empty()) scene.insert(algorithm.name);
  EXPECT_EQ(scene, (std::set<std::string>{"cannon_sap", "exact", "exact_cold", "octree", "proxy"}));
}

// Whatever this build found: a library's row is in one of the two tables, and says how to get what it needs.
TEST(Table, RowsOfLibrariesAreThereOrSayWhatIsMissing) {
  for (const Algorithm& row : all()) {
    EXPECT_TRUE(row.make) << row.name;
    EXPECT_EQ(row.library.name.empty(), row.library.version.empty()) << row.name;
    EXPECT_EQ(find_missing(row.name), nullptr) << row.name;
  }
  for (const Algorithm& row : missing()) {
    EXPECT_EQ(find(row.name), nullptr) << row.name;
    EXPECT_EQ(find_missing(row.name), &row);
    EXPECT_TRUE(row.library.version.empty()) << row.name;
    EXPECT_NE(remedy(row).find(row.library.name), std::string::npos) << remedy(row);
    EXPECT_NE(remedy(row).find("scripts/peers installs it (" + row.library.package), std::string::npos) << remedy(row);
  }
  EXPECT_TRUE(find("fcl_bvh") || find_missing("fcl_bvh"));
}

TEST(Table, WhoSamplesFacetsIsToldByKnobs) {
  const Algorithm& triangles = *find("obb_triangles");
  Knobs knobs = presets(triangles);
  EXPECT_FALSE(samples_facets(triangles, knobs));
  knobs["prefilter"] = std::string("facet_vectors");
  EXPECT_TRUE(samples_facets(triangles, knobs));
  EXPECT_TRUE(samples_facets(*find("facet_distance"), presets(*find("facet_distance"))));
  EXPECT_FALSE(samples_facets(*find("exact"), presets(*find("exact"))));
}

TEST(Table, EveryPresetIsAllowed) {
  for (const Algorithm& algorithm : all())
    for (const Knob& knob : algorithm.knobs)
      EXPECT_EQ(checked(knob, knob.preset), knob.preset) << algorithm.name << ' ' << knob.name;
}

TEST(Text, NamesPromisesAndScopes) {
  EXPECT_EQ(text(Promise::none), "none");
  EXPECT_EQ(text(Promise::conservative), "conservative");
  EXPECT_EQ(text(Promise::exact), "exact");
  EXPECT_EQ(text(Scope::pair), "pair");
  EXPECT_EQ(text(Scope::scene), "scene");
}

TEST(Knobs, PresetsHaveEveryKnob) {
  Algorithm algorithm;
  algorithm.knobs = {whole_knob(), real_knob()};
  const Knobs knobs = presets(algorithm);
  EXPECT_EQ(knobs.size(), 2u);
  EXPECT_EQ(value_of<std::int64_t>(knobs, "stride"), 20);
  EXPECT_EQ(value_of<double>(knobs, "far"), 0.25);
  EXPECT_THROW(value_of<double>(knobs, "near"), std::out_of_range);
}

TEST(Knobs, RangesIncludeTheirEnds) {
  EXPECT_EQ(refusal(whole_knob(), std::int64_t{1}), "accepted");
  EXPECT_EQ(refusal(whole_knob(), std::int64_t{1000000}), "accepted");
  EXPECT_EQ(refusal(whole_knob(), std::int64_t{0}), "must be between 1 and 1000000");
  EXPECT_EQ(refusal(whole_knob(), std::int64_t{1000001}), "must be between 1 and 1000000");
  EXPECT_EQ(refusal(real_knob(), 0.0), "accepted");
  EXPECT_EQ(refusal(real_knob(), -0.5), "must be at least 0");
  Knob knob = real_knob();
  knob.least = -std::numeric_limits<double>::infinity();
  knob.most = 0.5;
  EXPECT_EQ(refusal(knob, 0.75), "must be at most 0.5");
}

TEST(Knobs, AnIntegerServesARealKnobAndNothingElseIsConverted) {
  EXPECT_EQ(checked(real_knob(), std::int64_t{3}), Value(3.0));
  EXPECT_EQ(refusal(whole_knob(), 3.0), "must be an integer");
  EXPECT_EQ(refusal(whole_knob(), true), "must be an integer");
  EXPECT_EQ(refusal(real_knob(), true), "must be a number");
  EXPECT_EQ(refusal(real_knob(), std::string("3")), "must be a number");
  EXPECT_EQ(refusal(real_knob(), kNan), "must be finite");
  EXPECT_EQ(refusal(real_knob(), std::numeric_limits<double>::infinity()), "must be finite");
  const Knob flag{.name = "dense", .preset = true, .unit = "1", .what = ""};
  EXPECT_EQ(refusal(flag, std::int64_t{1}), "must be true or false");
  EXPECT_EQ(refusal(flag, false), "accepted");
}

TEST(Knobs, TextsAreChoices) {
  const Knob knob{
      .name = "search", .preset = std::string("fast"), .unit = "1", .what = "", .choices = {"fast", "slow"}};
  EXPECT_EQ(refusal(knob, std::string("slow")), "accepted");
  EXPECT_EQ(refusal(knob, std::string("slo")), "must be one of fast, slow");
  EXPECT_EQ(refusal(knob, std::int64_t{1}), "must be one of fast, slow");
}

TEST(Knobs, AFurtherRuleIsStated) {
  Knob knob = whole_knob();
  knob.valid = [](const Value& value) { return 180 % std::get<std::int64_t>(value) == 0; };
  knob.rule = "divide 180";
  EXPECT_EQ(refusal(knob, std::int64_t{10}), "accepted");
  EXPECT_EQ(refusal(knob, std::int64_t{7}), "must divide 180");
}

// What follows holds for every algorithm.
class Every : public testing::TestWithParam<std::string> {
 protected:
  bool conservative() const { return find(GetParam())->promise == Promise::conservative; }
};

INSTANTIATE_TEST_SUITE_P(Algorithm, Every, testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const Algorithm& algorithm : all()) names.push_back(algorithm.name);
                           return names;
                         }()),
                         [](const auto& info) { return info.param; });

// The same laws for libraries of others.
INSTANTIATE_TEST_SUITE_P(Plugin, Every, testing::ValuesIn([] {
                           plugins::add_examples();
                           return plugins::examples();
                         }()),
                         [](const auto& info) { return info.param; });

TEST_P(Every, AnswersTheSameWhenCounted) {
  std::size_t reported = 0;  // of all seeds: one crowd alone may be none to the facet methods
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Setting setting = crowd(random, 30, 4);
    const auto method = make(GetParam(), setting.bodies);
    std::vector<Pair> answered, counted, again;
    method->prepare(setting.poses);
    method->answer(setting.runs(), answered);
    const std::uint64_t operations = method->count(setting.runs(), counted);
    method->answer(setting.runs(), again);
    EXPECT_EQ(again, answered);
    std::sort(answered.begin(), answered.end());
    std::sort(counted.begin(), counted.end());
    EXPECT_EQ(counted, answered);
    reported += answered.size();
    EXPECT_GE(operations, 29u);
    EXPECT_EQ(std::set<Pair>(answered.begin(), answered.end()).size(), answered.size()) << "each pair once";
  }
  EXPECT_GT(reported, 0u);
}

TEST_P(Every, AnswersTheSameForThePairTheOtherWayRound) {
  std::mt19937 random(11);
  SCOPED_TRACE("seed 11");
  const Setting there = crowd(random, 30, 4), back = there.reversed();
  std::vector<Pair> mirrored;
  for (const Pair& pair : hits(GetParam(), back)) mirrored.push_back({29 - pair.b, 29 - pair.a});
  std::sort(mirrored.begin(), mirrored.end());
  EXPECT_EQ(mirrored, hits(GetParam(), there));
}

TEST_P(Every, AnswersTheSameAfterAnExactShift) {
  std::mt19937 random(12);
  SCOPED_TRACE("seed 12");
  Setting here = crowd(random, 30, 4);
  for (Pose& pose : here.poses)
    for (int i = 0; i < 3; ++i) pose.t[i] = std::round(pose.t[i] * 0x1p20) * 0x1p-20;
  Setting there = here;
  for (Pose& pose : there.poses) pose.t += Vec3(256, -128, 64);
  EXPECT_EQ(hits(GetParam(), there), hits(GetParam(), here));
}

TEST_P(Every, TakesBodiesAtTheSamePlace) {
  Setting setting;
  for (int i = 0; i < 3; ++i) setting.add(geometry::sphere("sphere", 1, 8), {{}, {1, 2, 3}});
  const std::vector<Pair> found = hits(GetParam(), setting);
  if (conservative()) {
    EXPECT_EQ(found.size(), 3u);
  }
}

TEST_P(Every, LeavesUnbornBodiesOut) {
  std::mt19937 random(13);
  SCOPED_TRACE("seed 13");
  Setting setting = crowd(random, 30, 3);
  std::vector<Pair> expected;
  const auto unborn = [](std::uint32_t body) { return body == 0 || body == 13 || body == 14 || body == 29; };
  for (const Pair& pair : hits(GetParam(), setting))
    if (!unborn(pair.a) && !unborn(pair.b)) expected.push_back(pair);
  for (std::uint32_t body = 0; body < 30; ++body)
    if (unborn(body)) setting.poses[body] = geometry::unborn();
  EXPECT_EQ(hits(GetParam(), setting), expected);
}

TEST_P(Every, TakesAStepWithoutBodies) {
  Setting setting;
  setting.add(geometry::sphere("sphere", 1, 8), geometry::unborn()).add(geometry::box("box", {1, 1, 1}), {});
  EXPECT_TRUE(hits(GetParam(), setting).empty());
}

TEST_P(Every, ReportsOnlyPairsThatAreAskedAbout) {
  std::mt19937 random(14);
  SCOPED_TRACE("seed 14");
  Setting setting = crowd(random, 30, 3);
  const std::vector<Pair> everything = hits(GetParam(), setting);
  setting.bodies.chosen.resize(30);
  std::vector<Pair> expected;
  for (const std::uint32_t body : {0, 5, 6, 21, 29}) setting.bodies.chosen[body] = 1;
  for (const Pair& pair : everything)
    if (setting.bodies.chosen[pair.a] || setting.bodies.chosen[pair.b]) expected.push_back(pair);
  EXPECT_LT(expected.size(), everything.size());
  EXPECT_EQ(hits(GetParam(), setting), expected);
}

TEST_P(Every, KeepsNothingFromTheStepBefore) {
  std::mt19937 random(15);
  SCOPED_TRACE("seed 15");
  Setting first = crowd(random, 20, 3);
  Setting second = first;
  for (Pose& pose : second.poses) pose = {setting::uniform_turn(random), setting::uniform_point(random, 3)};
  const auto method = make(GetParam(), first.bodies);
  std::vector<Pair> found;
  method->prepare(first.poses, conservative() ? 0.5 : 0);
  method->answer(first.runs(), found);
  found.clear();
  method->prepare(second.poses);
  method->answer(second.runs(), found);
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, hits(GetParam(), second));
}

TEST_P(Every, StartsEveryRepeatOfAStepFromTheSameMemory) {
  std::mt19937 random(17);
  SCOPED_TRACE("seed 17");
  Setting step = crowd(random, 30, 3);
  const auto method = make(GetParam(), step.bodies), forgetful = make(GetParam(), step.bodies);
  std::vector<Pair> found;
  for (int i = 0; i < 4; ++i) {
    for (Pose& pose : step.poses) pose.t += setting::uniform_point(random, 0.1);
    method->prepare(step.poses);
    const std::uint64_t operations = method->count(step.runs(), found);
    method->answer(step.runs(), found);
    method->prepare(step.poses);
    EXPECT_EQ(method->count(step.runs(), found), operations);
    method->remember();

    forgetful->prepare(step.poses);
    forgetful->answer(step.runs(), found);
    forgetful->remember();
  }
  const auto fresh = make(GetParam(), step.bodies);
  fresh->prepare(step.poses);
  forgetful->forget();
  forgetful->prepare(step.poses);
  EXPECT_EQ(forgetful->count(step.runs(), found), fresh->count(step.runs(), found));
}

TEST_P(Every, MissesNothingWhereItPromises) {
  if (!conservative()) return;
  for (std::uint32_t seed = 21; seed <= 24; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Setting setting = crowd(random, 40, 4);
    const std::vector<Pair> truly = setting::truth(setting), found = hits(GetParam(), setting);
    EXPECT_FALSE(truly.empty());
    EXPECT_TRUE(std::includes(found.begin(), found.end(), truly.begin(), truly.end()));
  }
}

TEST_P(Every, ReportsMoreWhenEnlarged) {
  if (!conservative()) return;
  std::mt19937 random(16);
  SCOPED_TRACE("seed 16");
  const Setting setting = crowd(random, 30, 5);
  const std::vector<Pair> plain = hits(GetParam(), setting), grown = hits(GetParam(), setting, {}, 0.05);
  EXPECT_GT(grown.size(), plain.size());
  EXPECT_TRUE(std::includes(grown.begin(), grown.end(), plain.begin(), plain.end()));
}

// Far from the origin a body's size is below the rounding of its place, so that enlarging by the size alone would not
// tell a rounding miss from a broken promise.
TEST_P(Every, EnlargesByThePlaceToo) {
  if (!conservative()) return;
  const Mesh sphere = geometry::sphere("sphere", 1, 8);
  const Setting setting = Setting().add(sphere, {{}, {1e6, 0, 0}}).add(sphere, {{}, {1e6 + 100, 0, 0}});
  EXPECT_TRUE(hits(GetParam(), setting).empty());
  EXPECT_EQ(hits(GetParam(), setting, {}, 1e-4).size(), 1u);
}

}  // namespace
}  // namespace algorithms

// The vertices' box of this mesh has a surface that is no double, so whoever makes it denser refuses it. Rows that do
// not sample facets are set up: they never ask for facet points.
TEST(Algorithms, OnlyMethodsOnFacetsComputeFacetPoints) {
  setting::Setting huge;
  huge.add(geometry::box("huge", {1e200, 1e200, 1e200}), {});
  for (const algorithms::Algorithm& row : algorithms::all()) {
    algorithms::Knobs knobs = algorithms::presets(row);
    const bool samples = knobs.contains("densify");
    if (samples) knobs["densify"] = true;
    if (samples)
      EXPECT_THROW(row.make(huge.bodies, knobs), std::invalid_argument) << row.name;
    else
      EXPECT_NO_THROW(row.make(huge.bodies, knobs)) << row.name;
  }
}
