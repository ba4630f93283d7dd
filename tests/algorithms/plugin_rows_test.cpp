// A shared library as rows and methods: what a method of it is given, and what becomes of what it gives.
#include "algorithms/contract/plugin_rows.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/plugins.hpp"
#include "tests/support/setting.hpp"

namespace {

using namespace algorithms;

const std::vector<Algorithm>& odd_rows() {
  static const std::vector<Algorithm> rows = plugin_rows(plugins::path_of("odd_plugin"));
  return rows;
}

const Algorithm& odd(const std::string& name) {
  for (const Algorithm& row : odd_rows())
    if (row.name == name) return row;
  throw std::out_of_range(name);
}

setting::Setting two_cubes() {
  setting::Setting out;
  out.add(geometry::box("cube", {1, 1, 1}), {{}, {0, 0, 0}}).add(geometry::box("slab", {2, 1, 1}), {{}, {3, 0, 0}});
  return out;
}

/// Why a method fails when it answers about its third step.
std::string failure(const std::string& name) {
  setting::Setting two = two_cubes();
  const auto method = odd(name).make(two.bodies, {});
  std::vector<Pair> found;
  try {
    for (int step = 0; step < 3; ++step) {
      two.poses[1].t.x() += 1;
      method->prepare(two.poses);
      found.clear();
      method->answer(two.runs(), found);
      if (step < 2) {
        EXPECT_EQ(found.size(), 1u) << name;
      }
    }
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "answered";
}

TEST(PluginRows, AreDescribedAsTheLibraryDoes) {
  const Algorithm row = plugin_rows(plugins::path_of("bounding_spheres_c")).at(0);
  EXPECT_EQ(row.name, "bounding_spheres_c");
  EXPECT_EQ(row.what, "balls of the half diagonal about the bodies' positions overlap");
  EXPECT_EQ(row.operations_unit, "distances");
  EXPECT_EQ(row.precision, "double");
  EXPECT_EQ(row.library.version, "1");
  EXPECT_EQ(row.promise, Promise::conservative);
  EXPECT_EQ(row.scope, Scope::pair);
  EXPECT_EQ(row.thesis_key, "");
  ASSERT_EQ(row.knobs.size(), 1u);
  EXPECT_EQ(row.knobs[0].name, "scale");
  EXPECT_EQ(row.knobs[0].preset, Value(1.0));
  EXPECT_EQ(row.knobs[0].least, 1);
  EXPECT_EQ(row.knobs[0].most, 1000);
}

TEST(PluginRows, KnobsHaveTheirTypesAndRules) {
  const Algorithm& row = odd("odd_teller");
  ASSERT_EQ(row.knobs.size(), 4u);
  EXPECT_EQ(row.knobs[0].preset, Value(true));
  EXPECT_EQ(row.knobs[1].preset, Value(std::int64_t{20}));
  EXPECT_EQ(row.knobs[2].preset, Value(0.25));
  EXPECT_EQ(row.knobs[3].preset, Value(std::string("fast")));
  EXPECT_EQ(row.knobs[3].choices, (std::vector<std::string>{"fast", "slow"}));
  EXPECT_THROW(checked(row.knobs[1], std::int64_t{101}), std::invalid_argument);
  EXPECT_THROW(checked(row.knobs[2], -1.0), std::invalid_argument);
  EXPECT_EQ(checked(row.knobs[2], 1e300), Value(1e300));
}

TEST(PluginRows, AMethodIsGivenKnobsBodiesAndMeshes) {
  setting::Setting two = two_cubes();
  two.bodies.fixed[1] = 1;
  const Algorithm& row = odd("odd_teller");
  Knobs knobs = presets(row);
  knobs["integer"] = std::int64_t{-3};
  knobs["choice"] = std::string("slow");
  try {
    row.make(two.bodies, knobs);
    FAIL() << "odd_teller refuses whatever it gets";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "create failed: flag 1, integer -3, real 0.250000, choice slow; "
                 "body0 is a cube of 8 and 12; body1 is a slab of 8 and 12, fixed");
  }
  two.bodies.chosen = {0, 1};
  EXPECT_THROW(
      {
        try {
          row.make(two.bodies, knobs);
        } catch (const std::invalid_argument& error) {
          EXPECT_TRUE(std::string(error.what()).ends_with(", fixed, chosen")) << error.what();
          throw;
        }
      },
      std::invalid_argument);
}

TEST(PluginRows, FailuresAreToldAsTheLibraryTellsThem) {
  EXPECT_EQ(failure("odd_good"), "answered");
  EXPECT_EQ(failure("odd_fails"), "answer failed: no more strength");
  EXPECT_EQ(failure("odd_fails_silently"), "answer failed: it gives no reason");
  EXPECT_EQ(failure("odd_fails_at_length"), "answer failed: " + std::string(511, 'x'));
  EXPECT_EQ(failure("odd_throws"), "answer let an exception out: thrown on purpose");
  EXPECT_EQ(failure("odd_throws_a_number"), "answer let an exception out: not a std::exception");
  EXPECT_EQ(failure("odd_overruns"), "reports 1025 pairs in a buffer of 1024; grow it before");
}

TEST(PluginRows, OneThatThrowsWhileItIsSetUpRefusesNothing) {
  EXPECT_THROW(odd("odd_create_throws").make(two_cubes().bodies, {}), std::runtime_error);
}

TEST(PluginRows, WithoutACountOperationsAreNone) {
  const setting::Setting two = two_cubes();
  const auto method = odd("odd_uncounted").make(two.bodies, {});
  std::vector<Pair> found;
  method->prepare(two.poses);
  EXPECT_EQ(method->count(two.runs(), found), 0u);
  EXPECT_EQ(found.size(), 1u);
  EXPECT_EQ(odd("odd_uncounted").operations_unit, "");
}

TEST(PluginRows, RemembersAndForgetsWhenItIsTold) {
  const setting::Setting two = two_cubes();
  const auto method = odd("odd_learner").make(two.bodies, {});
  std::vector<Pair> found;
  method->prepare(two.poses);
  for (const std::uint64_t remembered : {0, 0}) EXPECT_EQ(method->count(two.runs(), found), remembered);
  method->remember();
  EXPECT_EQ(method->count(two.runs(), found), 1u);
  method->answer(two.runs(), found);
  method->remember();
  EXPECT_EQ(method->count(two.runs(), found), 2u);
  method->forget();
  EXPECT_EQ(method->count(two.runs(), found), 0u);
}

// More hits than the buffer has at first, and again: it keeps its size, and nothing is left of the call before.
TEST(PluginRows, TheBufferGrowsWithTheAnswer) {
  setting::Setting many;
  const geometry::Mesh cube = geometry::box("cube", {1, 1, 1});
  for (int i = 0; i < 100; ++i) many.add(cube, {{}, {0.001 * i, 0, 0}});
  const auto method = odd("odd_good").make(many.bodies, {});
  method->prepare(many.poses);
  std::vector<Pair> found = {{7, 9}};
  method->answer(many.runs(), found);
  ASSERT_EQ(found.size(), 1 + 4950u);
  EXPECT_EQ(found[0], (Pair{7, 9})) << "what was there before stays";
  EXPECT_EQ(found[1], (Pair{0, 1}));
  EXPECT_EQ(found.back(), (Pair{98, 99}));
  found.clear();
  const std::vector<PairRun> one = {{3, 4, 6}};
  method->answer(one, found);
  EXPECT_EQ(found, (std::vector<Pair>{{3, 4}, {3, 5}}));
}

TEST(PluginRows, TheExampleInRustIsBuiltWhereItCanBe) {
  if (plugins::examples().size() < 3) GTEST_SKIP() << "no Rust compiler was found: apt-get install rustc";
  EXPECT_EQ(plugin_rows(plugins::path_of("bounding_spheres_rust")).at(0).name, "bounding_spheres_rust");
}

}  // namespace
