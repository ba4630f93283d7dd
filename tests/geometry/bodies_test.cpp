// The pairs of a step, against a double loop over all of them.
#include "geometry/bodies.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <ostream>
#include <random>

namespace geometry {

void PrintTo(const Pair& pair, std::ostream* out) { *out << '(' << pair.a << ", " << pair.b << ')'; }
void PrintTo(const PairRun& run, std::ostream* out) { *out << run.a << ": " << run.first << " to " << run.last; }
bool operator==(const PairRun& p, const PairRun& q) { return p.a == q.a && p.first == q.first && p.last == q.last; }

namespace {

using Runs = std::vector<PairRun>;

Bodies moving(std::size_t count) {
  Bodies bodies;
  bodies.mesh.resize(count);
  bodies.fixed.resize(count);
  return bodies;
}

std::vector<Pose> born(std::size_t count) { return std::vector<Pose>(count); }

std::vector<Pair> listed(const Runs& runs) {
  std::vector<Pair> pairs;
  for (const PairRun& run : runs)
    for (std::uint32_t b = run.first; b < run.last; ++b) pairs.push_back({run.a, b});
  return pairs;
}

TEST(PairRuns, HoldEveryPairOnceWhenAllMove) {
  EXPECT_EQ(pair_runs(moving(4), born(4)), (Runs{{0, 1, 4}, {1, 2, 4}, {2, 3, 4}}));
  EXPECT_TRUE(pair_runs(moving(0), born(0)).empty());
  EXPECT_TRUE(pair_runs(moving(1), born(1)).empty());
}

TEST(PairRuns, LeaveOutPairsOfFixedBodies) {
  Bodies bodies = moving(4);
  bodies.fixed = {1, 1, 0, 1};
  EXPECT_EQ(pair_runs(bodies, born(4)), (Runs{{0, 2, 3}, {1, 2, 3}, {2, 3, 4}}));
  bodies.fixed = {1, 1, 1, 1};
  EXPECT_TRUE(pair_runs(bodies, born(4)).empty());
}

TEST(PairRuns, LeaveOutTheUnborn) {
  std::vector<Pose> poses = born(4);
  poses[1] = unborn();
  EXPECT_EQ(pair_runs(moving(4), poses), (Runs{{0, 2, 4}, {2, 3, 4}}));
  poses[3].t.y() = std::nan("");
  EXPECT_EQ(pair_runs(moving(4), poses), (Runs{{0, 2, 3}}));
}

TEST(PairRuns, KeepOnlyPairsWithAChosenBody) {
  Bodies bodies = moving(4);
  bodies.chosen = {0, 0, 1, 0};
  EXPECT_EQ(pair_runs(bodies, born(4)), (Runs{{0, 2, 3}, {1, 2, 3}, {2, 3, 4}}));
  bodies.chosen = {0, 0, 0, 0};
  EXPECT_TRUE(pair_runs(bodies, born(4)).empty());
  bodies.chosen = {1, 1, 1, 1};
  EXPECT_EQ(pair_count(pair_runs(bodies, born(4))), 6u);
}

TEST(PairRuns, EqualADoubleLoopAndAreMaximal) {
  constexpr unsigned kSeed = 51;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (int round = 0; round < 3000; ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    const auto count = static_cast<std::uint32_t>(random() % 20);
    const auto flags = [&](unsigned percent) {
      std::vector<std::uint8_t> out(count);
      for (auto& flag : out) flag = random() % 100 < percent;
      return out;
    };
    Bodies bodies = moving(count);
    bodies.fixed = flags(random() % 101);
    if (random() % 2) bodies.chosen = flags(random() % 101);
    std::vector<Pose> poses = born(count);
    const std::vector<std::uint8_t> absent = flags(random() % 60);
    for (std::uint32_t b = 0; b < count; ++b)
      if (absent[b]) poses[b] = unborn();

    std::vector<Pair> expected;
    for (std::uint32_t a = 0; a < count; ++a)
      for (std::uint32_t b = a + 1; b < count; ++b) {
        const bool both_fixed = bodies.fixed[a] && bodies.fixed[b];
        const bool wanted = bodies.chosen.empty() || bodies.chosen[a] || bodies.chosen[b];
        if (!absent[a] && !absent[b] && !both_fixed && wanted) expected.push_back({a, b});
      }
    const Runs runs = pair_runs(bodies, poses);
    ASSERT_EQ(listed(runs), expected);
    ASSERT_EQ(pair_count(runs), expected.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
      ASSERT_LT(runs[i].first, runs[i].last);
      const bool joinable = i > 0 && runs[i - 1].a == runs[i].a && runs[i - 1].last >= runs[i].first;
      ASSERT_FALSE(joinable) << "run " << i;
    }
  }
}

// 378 million pairs: a vector of them would take 3 GB and seconds.
TEST(PairRuns, TakeMemoryByTheBodyNotByThePair) {
  constexpr std::uint32_t kBodies = 27500;
  Bodies bodies = moving(kBodies);
  for (std::uint32_t b = 0; b < 25; ++b) bodies.fixed[1000 * b] = 1;
  const auto start = std::chrono::steady_clock::now();
  const Runs runs = pair_runs(bodies, born(kBodies));
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(pair_count(runs), 27500ull * 27499 / 2 - 25 * 24 / 2);
  EXPECT_LT(runs.size(), kBodies + 25u * 25u);
  EXPECT_LT(spent.count(), 0.2);
}

}  // namespace
}  // namespace geometry
