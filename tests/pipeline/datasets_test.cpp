// The list of datasets against results as they are written.
#include "pipeline/result/datasets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "pipeline/result/layout.hpp"
#include "tests/support/synthetic_result.hpp"

namespace pipeline {
namespace {

/// The path with its names of meshes and labels as the list has them.
std::string general(const std::string& path) {
  for (const auto& [group, name] : {std::pair{"/meshes/", "<mesh>"}, std::pair{"/answers/", "<label>"}})
    if (path.starts_with(group)) return std::string(group) + name + path.substr(path.rfind('/'));
  return path;
}

const DatasetFacts& facts(const std::vector<DatasetFacts>& all, const std::string& path) {
  return *std::ranges::find(all, path, &DatasetFacts::path);
}

TEST(Datasets, OfAResultAreListedAsTheyAreWritten) {
  const std::vector<DatasetFacts> all = dataset_facts();
  const Result result = synthetic_result();
  std::size_t seen = 0;
  for (const Group& group : layout(result))
    for (const Dataset& dataset : group.datasets) {
      const auto found = std::ranges::find(all, general(dataset.path), &DatasetFacts::path);
      ASSERT_NE(found, all.end()) << dataset.path;
      EXPECT_EQ(found->unit, dataset.units) << dataset.path;
      EXPECT_EQ(found->long_name, dataset.long_name) << dataset.path;
      EXPECT_EQ(std::size_t(std::ranges::count(found->shape, ',') + !found->shape.empty()), dataset.shape.size())
          << dataset.path;
      ++seen;
    }
  EXPECT_GT(seen, 30u);
}

TEST(Datasets, AreListedOnceAndSayWhenTheyAreThere) {
  const std::vector<DatasetFacts> all = dataset_facts();
  std::set<std::string> paths;
  for (const DatasetFacts& one : all) {
    EXPECT_TRUE(paths.insert(one.path).second) << one.path;
    EXPECT_FALSE(one.when.empty()) << one.path;
    EXPECT_FALSE(one.long_name.empty()) << one.path;
  }
  EXPECT_EQ(facts(all, "/config").when, "always");
  EXPECT_EQ(facts(all, "/motion/position").when, "a scene");
  EXPECT_EQ(facts(all, "/motion/position").shape, "S, B, 3");
  EXPECT_EQ(facts(all, "/motion/position").type, "float64");
  EXPECT_EQ(facts(all, "/summary/error").when, "a scene with algorithms");
  EXPECT_EQ(facts(all, "/summary/contained_hit").when, "containment = \"record\"");
  EXPECT_EQ(facts(all, "/truth/gap_lower").when, "[truth] gap = true");
  EXPECT_EQ(facts(all, "/truth/gap_lower").shape, "E");
  EXPECT_EQ(facts(all, "/physics/energy").when, "the scene is integrated");
  EXPECT_EQ(facts(all, "/study/error").shape, "C");
  EXPECT_EQ(facts(all, "/answers/<label>/pair_offset").shape, "S + 1");
}

}  // namespace
}  // namespace pipeline
