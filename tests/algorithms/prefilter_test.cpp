#include "algorithms/contract/prefilter.hpp"

#include <gtest/gtest.h>

#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

/// What the knob of a row may name.
std::vector<std::string> choices(const Algorithm& algorithm) {
  for (const Knob& knob : algorithm.knobs)
    if (knob.name == "prefilter") return knob.choices;
  return {};
}

/// The rows that have the knob.
std::vector<const Algorithm*> filtered() {
  std::vector<const Algorithm*> out;
  for (const Algorithm& algorithm : all())
    if (presets(algorithm).count("prefilter")) out.push_back(&algorithm);
  return out;
}

std::uint64_t operations(const std::string& name, const Setting& setting, const Changed& changed) {
  const auto method = make(name, setting.bodies, changed);
  std::vector<Pair> found;
  method->prepare(setting.poses);
  return method->count(setting.runs(), found);
}

TEST(Prefilter, ChoicesAreNoneAndEveryPairwiseAlgorithm) {
  std::vector<std::string> expected = {"none"};
  for (const Algorithm& algorithm : all())
    if (algorithm.scope == Scope::pair) expected.push_back(algorithm.name);
  for (const Algorithm* algorithm : filtered()) EXPECT_EQ(choices(*algorithm), expected) << algorithm->name;
}

TEST(Prefilter, StandsBeforeTheFiveOfTheThesis) {
  std::string keys;
  for (const Algorithm* algorithm : filtered()) keys += algorithm->thesis_key;
  EXPECT_EQ(keys, "KPOIU");
}

// But before all facets of two bodies, which nothing should keep from being asked that may meet.
TEST(Prefilter, IsRotatedAabbByDefault) {
  for (const Algorithm* algorithm : filtered())
    EXPECT_EQ(value_of<std::string>(presets(*algorithm), "prefilter"),
              algorithm->name == "all_triangles" ? "aabb" : "rotated_aabb")
        << algorithm->name;
}

TEST(Prefilter, LeavesTheHitsThatBothReport) {
  std::mt19937 random(101);
  SCOPED_TRACE("seed 101");
  const Setting setting = crowd(random, 30, 3);
  for (const Algorithm* algorithm : filtered()) {
    const std::vector<Pair> alone = hits(algorithm->name, setting, {{"prefilter", std::string("none")}});
    for (const std::string& name : choices(*algorithm)) {
      if (name == "none") continue;
      const std::vector<Pair> passed = hits(name, setting);
      std::vector<Pair> expected;
      std::set_intersection(alone.begin(), alone.end(), passed.begin(), passed.end(), std::back_inserter(expected));
      EXPECT_EQ(hits(algorithm->name, setting, {{"prefilter", name}}), expected)
          << algorithm->name << " behind " << name;
    }
  }
}

TEST(Prefilter, OperationsAreItsOwnAndThoseOfTheCandidates) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const Quaternion q = turn_deg({1, 2, 3}, 20);
  // One candidate, and one body far away.
  const Setting near = Setting().add(cube, {}).add(cube, {q, {1, 0, 0}});
  const Setting three = Setting().add(cube, {}).add(cube, {q, {1, 0, 0}}).add(cube, {q, {0, 50, 0}});
  const Changed alone = {{"prefilter", std::string("none")}}, behind = {{"prefilter", std::string("bounding_sphere")}};
  EXPECT_EQ(operations("obb_triangles", near, behind), 1 + operations("obb_triangles", near, alone));
  EXPECT_EQ(operations("obb_triangles", three, behind), 3 + operations("obb_triangles", near, alone));
}

TEST(Prefilter, IsNamedByTheUnitOfOperations) {
  EXPECT_EQ(with_prefilter("vectors"), "vectors, and the prefilter's operations");
  for (const Algorithm& algorithm : all())
    EXPECT_EQ(algorithm.operations_unit.ends_with(with_prefilter("")), presets(algorithm).count("prefilter") == 1)
        << algorithm.name;
}

TEST(Prefilter, MayBeTheAlgorithmItself) {
  std::mt19937 random(102);
  SCOPED_TRACE("seed 102");
  const Setting setting = crowd(random, 30, 3);
  EXPECT_EQ(hits("obb_triangles", setting, {{"prefilter", std::string("obb_triangles")}}),
            hits("obb_triangles", setting));
}

}  // namespace
}  // namespace algorithms
