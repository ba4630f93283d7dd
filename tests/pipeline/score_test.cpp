#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/stages/summary.hpp"

using namespace pipeline;

namespace {

Answers counted(std::vector<std::uint64_t> tp, std::vector<std::uint64_t> fp, std::vector<std::uint64_t> fn) {
  Answers answers;
  answers.promise = "none";
  answers.true_positive = std::move(tp);
  answers.false_positive = std::move(fp);
  answers.false_negative = std::move(fn);
  answers.rounding_miss.assign(answers.true_positive.size(), 0);
  answers.operations.assign(answers.true_positive.size(), 1);
  answers.time_ns.assign(answers.true_positive.size(), 1);
  return answers;
}

}  // namespace

// By hand: TP 6, FP 2, FN 1, TN 91 of 100 pairs.
TEST(Score, FollowsTheDefinitions) {
  const Summary row = summarise(counted({4, 2}, {2, 0}, {0, 1}), 100);
  EXPECT_EQ(row.hits, 8u);
  EXPECT_DOUBLE_EQ(row.error, 3.0 / 9.0);
  EXPECT_DOUBLE_EQ(row.precision, 6.0 / 8.0);
  EXPECT_DOUBLE_EQ(row.recall, 6.0 / 7.0);
  EXPECT_DOUBLE_EQ(row.matthews, (6.0 * 91 - 2.0 * 1) / std::sqrt(8.0 * 7 * 93 * 92));
}

// TP 6, FP 2, FN 1, contained 3: those are no false positives, and of 97 pairs that are judged 88 are true negatives.
TEST(Score, CountsContainedHitsApart) {
  Answers answers = counted({4, 2}, {2, 0}, {0, 1});
  EXPECT_FALSE(summarise(answers, 97).contained_hit);
  answers.contained_hit = {1, 2};
  const Summary row = summarise(answers, 97);
  EXPECT_EQ(row.contained_hit, 3u);
  EXPECT_EQ(row.hits, 11u);
  EXPECT_DOUBLE_EQ(row.error, 3.0 / 9.0);
  EXPECT_DOUBLE_EQ(row.precision, 6.0 / 8.0);
  EXPECT_DOUBLE_EQ(row.matthews, (6.0 * 88 - 2.0 * 1) / std::sqrt(8.0 * 7 * 90 * 89));
}

// A pair that is recorded as contained is neither true nor false, whether somebody reports it or not.
TEST(Score, RecordedContainedPairsAreNotJudged) {
  Result result;
  result.bodies.mesh = {0, 0, 0, 0};
  result.bodies.fixed = {0, 0, 1, 1};
  result.motion.assign(3, std::vector<geometry::Pose>(4));  // 5 pairs a step: not that of two fixed bodies
  for (const std::vector<Pair>& step :
       {std::vector<Pair>{{0, 1}}, std::vector<Pair>{}, std::vector<Pair>{{0, 1}, {0, 2}}})
    result.truth.contained.append(step);
  result.truth.containment = Containment::record;
  EXPECT_EQ(judged_pairs(result.bodies, result.motion, result.truth), 12u);
  result.truth.containment = Containment::meet;
  EXPECT_EQ(judged_pairs(result.bodies, result.motion, result.truth), 15u);
}

TEST(Score, ErrorIsZeroAndRatiosAreNaNWhereNothingMeetsOrIsReported) {
  const Summary row = summarise(counted({0}, {0}, {0}), 10);
  EXPECT_EQ(row.error, 0);
  EXPECT_TRUE(std::isnan(row.precision));
  EXPECT_TRUE(std::isnan(row.recall));
  EXPECT_TRUE(std::isnan(row.matthews));
}

// True negatives would make a method that never reports look perfect; the error does not see them.
TEST(Score, ErrorDoesNotDependOnTrueNegatives) {
  EXPECT_EQ(summarise(counted({1}, {1}, {1}), 3).error, summarise(counted({1}, {1}, {1}), 1000000).error);
  EXPECT_EQ(summarise(counted({0}, {0}, {5}), 1000000).error, 1);
}

TEST(Score, JudgesPromises) {
  Answers answers = counted({5, 5}, {3, 0}, {0, 2});
  EXPECT_TRUE(summarise(answers, 100).promise_kept);  // none was made
  answers.promise = "conservative";
  EXPECT_FALSE(summarise(answers, 100).promise_kept);
  answers.rounding_miss = {0, 2};
  EXPECT_TRUE(summarise(answers, 100).promise_kept);
  answers.rounding_miss = {0, 1};
  EXPECT_FALSE(summarise(answers, 100).promise_kept);
  answers.promise = "exact";
  answers.rounding_miss = {0, 2};
  EXPECT_FALSE(summarise(answers, 100).promise_kept);
  EXPECT_TRUE(summarise(
                  [] {
                    Answers perfect = counted({5}, {0}, {0});
                    perfect.promise = "exact";
                    return perfect;
                  }(),
                  100)
                  .promise_kept);
}

TEST(Score, TimesAreMeanMedianAndNearestRank) {
  Answers answers =
      counted(std::vector<std::uint64_t>(20), std::vector<std::uint64_t>(20), std::vector<std::uint64_t>(20));
  for (std::size_t i = 0; i < 20; ++i) answers.time_ns[i] = std::int64_t((i * 7) % 20 + 1);  // 1 ... 20, shuffled
  const Summary row = summarise(answers, 0);
  EXPECT_DOUBLE_EQ(row.time_mean_ns, 10.5);
  EXPECT_DOUBLE_EQ(row.time_median_ns, 10.5);
  EXPECT_DOUBLE_EQ(row.time_p95_ns, 19);  // the smallest time that 95 % do not exceed
}

// 2^40 hits of each kind: the counts' product is beyond 64 bits.
TEST(Score, MatthewsSurvivesLargeCounts) {
  const std::uint64_t n = std::uint64_t{1} << 40;
  const Summary row = summarise(counted({n}, {n}, {n}), 4 * n);
  EXPECT_NEAR(row.matthews, 0, 1e-12);
}
