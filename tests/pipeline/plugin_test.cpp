// Libraries of others: their rows read in a child process, and their examples on a recorded motion.
#include "pipeline/stages/plugin.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <fstream>

#include "algorithms/contract/algorithm.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/plugins.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace pipeline;
using algorithms::find;

TEST(Plugin, ItsRowsJoinTheTableAndItsCodeStaysOutside) {
  const std::string path = plugins::path_of("odd_plugin");
  const Plugin plugin = add_plugin(path, "", "here");
  EXPECT_EQ(plugin.sha256.size(), 64u);
  const algorithms::Algorithm* row = find("odd_teller");
  ASSERT_TRUE(row);
  EXPECT_EQ(row->what, "one of the tests' odd methods");
  EXPECT_EQ(row->library.version, "odd 1");
  EXPECT_EQ(row->library.sha256, plugin.sha256);
  ASSERT_EQ(row->knobs.size(), 4u);
  const std::vector<algorithms::Algorithm> own = algorithms::plugin_rows(path);  // loads it here, to compare
  const auto same = std::ranges::find(own, row->name, &algorithms::Algorithm::name);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(row->knobs[i].name, same->knobs[i].name);
    EXPECT_EQ(row->knobs[i].preset, same->knobs[i].preset);
    EXPECT_EQ(row->knobs[i].unit, same->knobs[i].unit);
    EXPECT_EQ(row->knobs[i].what, same->knobs[i].what);
    EXPECT_EQ(row->knobs[i].least, same->knobs[i].least);
    EXPECT_EQ(row->knobs[i].most, same->knobs[i].most);
    EXPECT_EQ(row->knobs[i].choices, same->knobs[i].choices);
  }
  const std::size_t rows = algorithms::added().size();
  add_plugin(path, "", "and again");
  EXPECT_EQ(algorithms::added().size(), rows) << "the same file again changes nothing";
}

TEST(Plugin, OneThatChangedSinceItsTableWasReadIsNotAnswered) {
  const TemporaryFolder folder;
  std::filesystem::copy(plugins::path_of("bounding_spheres_c"), folder / "mine.so");
  add_plugin("mine.so", folder / "", "here");
  std::ofstream(folder / "mine.so", std::ios::app) << "more";
  geometry::Bodies bodies;
  const algorithms::Algorithm& row = *find("bounding_spheres_c");
  try {
    row.make(bodies, algorithms::presets(row));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "mine.so is another file than when its table was read");
  }
}

TEST(Plugin, OneThatHangsWhenItIsLoadedIsGivenUp) {
  const auto start = std::chrono::steady_clock::now();
  const std::string line = tests::refusal_of([] {
    add_plugin(plugins::path_of("hanging_plugin"), "", "here", {.processor_seconds = 5, .wall_seconds = 0.2});
  });
  EXPECT_NE(line.find("its table cannot be read: more than 0.2 s of wall time; nothing may go"), std::string::npos)
      << line;
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "no child is left";
  EXPECT_EQ(find("plain"), nullptr);
}

// Every step of a recorded motion, pair by pair, in the order in which the runs ask.
TEST(Plugin, TheExamplesAnswerAsTheBuiltInBoundingSpheres) {
  const Result recorded = read_result(std::filesystem::path(TREE) / "tests/data/falling.h5");
  const auto own = find("bounding_sphere")->make(recorded.bodies, {});
  for (const std::string& name : plugins::examples()) {
    const algorithms::Algorithm row = algorithms::plugin_rows(plugins::path_of(name)).at(0);
    const auto method = row.make(recorded.bodies, algorithms::presets(row));
    std::size_t hits = 0;
    for (const auto& poses : recorded.motion) {
      const auto runs = geometry::pair_runs(recorded.bodies, poses);
      for (const double enlarge : {0.0, 0x1p-40, 0.1}) {
        std::vector<geometry::Pair> expected, found, counted;
        own->prepare(poses, enlarge);
        own->answer(runs, expected);
        method->prepare(poses, enlarge);
        method->answer(runs, found);
        ASSERT_EQ(found, expected) << name;
        EXPECT_EQ(method->count(runs, counted), geometry::pair_count(runs)) << name;
        EXPECT_EQ(counted, expected) << name;
        hits += found.size();
      }
    }
    EXPECT_GT(hits, 100u) << name << ": a motion in which nothing meets shows nothing";
  }
}

}  // namespace
