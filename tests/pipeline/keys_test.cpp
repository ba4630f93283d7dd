// The list of keys: whole, and what the readers themselves say.
#include "pipeline/keys.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/config.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

const KeyFacts& key(const std::vector<KeyFacts>& all, const std::string& path) {
  return *std::ranges::find(all, path, [](const KeyFacts& facts) { return facts.key.path; });
}

// A key that a reader allows but whose value no example makes it ask for has no type.
TEST(Keys, EveryAllowedKeyIsAskedForAndExplained) {
  const std::vector<KeyFacts> all = key_facts();
  EXPECT_GT(all.size(), 80u);
  for (const KeyFacts& facts : all) {
    EXPECT_FALSE(facts.key.type.empty()) << facts.key.path << ": no example of pipeline/keys.cpp makes its reader ask";
    EXPECT_FALSE(facts.what.empty()) << facts.key.path << ": has no words in pipeline/keys.cpp";
    EXPECT_FALSE(facts.where.empty()) << facts.key.path;
  }
  for (const std::string& path : unasked_keys()) ADD_FAILURE() << path << ": no reader asks for it";
}

TEST(Keys, TypesPresetsAndRulesAreTheReaders) {
  const std::vector<KeyFacts> all = key_facts();
  EXPECT_EQ(key(all, "physics.accuracy").key.type, "number");
  EXPECT_EQ(key(all, "physics.accuracy").key.rule, "a number above 0 and below 1");
  EXPECT_EQ(key(all, "physics.accuracy").where, (std::vector<std::string>{"falling", "box"}));
  EXPECT_EQ(key(all, "truth.containment").key.preset, "\"ignore\"");
  EXPECT_EQ(key(all, "truth.containment").key.rule, "\"ignore\", \"record\" or \"meet\"");
  EXPECT_EQ(key(all, "timing.repeats").key.preset, std::to_string(Config{}.repeats));
  EXPECT_EQ(key(all, "scene.kind").key.preset, "");
  EXPECT_EQ(key(all, "SHAPE.size").where, (std::vector<std::string>{"box"}));
  EXPECT_EQ(key(all, "scene.births.every").where, (std::vector<std::string>{"box"}));
  EXPECT_EQ(key(all, "sweep.N.balls").where, (std::vector<std::string>{"stack"}));
}

TEST(Keys, AreToldWhetherTheyAreThereOrNot) {
  const auto rate = [](const std::string& text) {
    std::vector<std::string> presets;
    for (const AskedKey& key : asked_keys(text))
      if (key.path == "rate" && !key.type.empty()) presets.push_back(key.preset);
    return presets;
  };
  const std::string scene = "[scene]\nkind = \"falling\"\n";
  EXPECT_EQ(rate(scene), rate("rate = 7\n" + scene));
  EXPECT_EQ(rate(scene).size(), 1u);
  EXPECT_THROW(asked_keys("rate = 0\n" + scene), Error);
}

}  // namespace
}  // namespace pipeline
