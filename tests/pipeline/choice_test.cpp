// Which label to take: by hand, with times of which is known whether they differ.
#include "pipeline/commands/choice.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/result/products/noise.hpp"

namespace pipeline {
namespace {

constexpr std::size_t kSteps = 300;  // six blocks

struct Label {
  const char* name;
  double time_ns, error;
  std::uint64_t false_negative = 0;
  double wave = 0;  // of its time, by blocks: what makes its mean uncertain
};

Result result_of(const std::vector<Label>& labels) {
  Result out;
  for (const Label& label : labels) {
    Answers answers;
    answers.label = label.name;
    double sum = 0;
    for (std::size_t step = 0; step < kSteps; ++step) {
      answers.time_ns.push_back(std::llround(label.time_ns * (1 + (step / 50 % 2 ? label.wave : -label.wave))));
      sum += double(answers.time_ns.back());
    }
    out.answers.push_back(answers);
    Summary summary;
    summary.time_mean_ns = sum / kSteps;
    summary.error = label.error;
    summary.false_negative = label.false_negative;
    out.summary.push_back(summary);
  }
  return out;
}

std::vector<std::size_t> labels_of(const std::vector<Taken>& front) {
  std::vector<std::size_t> out;
  for (const Taken& taken : front) out.push_back(taken.label);
  return out;
}

using Numbers = std::vector<std::size_t>;

TEST(Choice, TheFrontHasNoLabelThatAnotherBeatsInBoth) {
  const Advice found = advice(result_of({{"slow and wrong", 5000, 0.6},
                                         {"exact", 4000, 0},
                                         {"balls", 1000, 0.5, 0},
                                         {"boxes", 2000, 0.05, 7},
                                         {"worse boxes", 2500, 0.05, 7}}));
  EXPECT_EQ(labels_of(found.front), (Numbers{2, 3, 1}));
  ASSERT_EQ(found.fastest.size(), 4u);
  EXPECT_EQ(found.fastest[0].taken.at(0).label, 3u) << "at most 0.1";
  EXPECT_EQ(found.fastest[1].taken.at(0).label, 1u) << "at most 0.01";
  EXPECT_EQ(found.fastest[2].taken.at(0).label, 1u) << "no error";
  EXPECT_EQ(found.fastest[3].taken.at(0).label, 2u) << "no false negative";
  EXPECT_TRUE(found.left_out.empty());
}

// Their ratio is 1.01 in the mean, and anything from 0.9 to 1.1 in a block.
TEST(Choice, EqualsAreCalledEquals) {
  const Advice found = advice(result_of({{"boxes", 1000, 0.3, 0, 0.05}, {"better", 1010, 0.2, 0, -0.05}}));
  EXPECT_EQ(labels_of(found.front), (Numbers{1})) << "what errs less and is as fast is taken";
  EXPECT_EQ(found.fastest[3].taken.at(0).label, 0u);
  EXPECT_EQ(found.fastest[3].taken[0].equals, (Numbers{1}));

  const Advice same = advice(result_of({{"boxes", 1000, 0.3, 0, 0.05}, {"like them", 1010, 0.3, 0, -0.05}}));
  EXPECT_EQ(labels_of(same.front), (Numbers{0}));
  EXPECT_EQ(same.front[0].equals, (Numbers{1}));

  const Advice other = advice(result_of({{"boxes", 1000, 0.3, 0, 0.005}, {"better", 1010, 0.2, 0, 0.005}}));
  EXPECT_EQ(labels_of(other.front), (Numbers{0, 1})) << "1 % in every block is a difference";
}

TEST(Choice, BelowTheNoiseFloorNothingIsADifference) {
  Result result = result_of({{"boxes", 1000, 0.3}, {"better", 1010, 0.2}});
  EXPECT_EQ(labels_of(advice(result).front), (Numbers{0, 1}));
  result.products.put(Noise{"boxes", 1, 0.98, 1.02, {}});
  EXPECT_EQ(labels_of(advice(result).front), (Numbers{1}));
}

TEST(Choice, OnlyTimesOfOneMachineCompare) {
  Result result =
      result_of({{"here", 1000, 0.3}, {"here too", 2000, 0.1}, {"there", 10, 0}, {"fails", 10, 0}, {"untimed", 10, 0}});
  result.answers[2].machine.host = "another";
  result.answers[3].foreign = ForeignFacts{};
  result.answers[3].foreign->reason = "it ended";
  result.summary[4].time_mean_ns = std::nan("");
  const Advice found = advice(result);
  EXPECT_EQ(found.left_out, (Numbers{2, 3, 4}));
  EXPECT_EQ(labels_of(found.front), (Numbers{0, 1}));
  EXPECT_TRUE(found.fastest[2].taken.empty()) << "none of those that compare is without an error";
  const std::string text = advice_text(result);
  EXPECT_NE(text.find("no error"), std::string::npos);
  EXPECT_NE(text.find("none"), std::string::npos);
  EXPECT_NE(text.find("not compared (no time, failed, or timed by another machine or build): there, fails, untimed\n"),
            std::string::npos);
}

TEST(Choice, OneLabelIsNoChoice) {
  EXPECT_EQ(advice_text(result_of({{"alone", 1000, 0.3}})), "");
  EXPECT_EQ(advice_text(Result()), "");
}

}  // namespace
}  // namespace pipeline
