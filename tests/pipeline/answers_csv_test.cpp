#include "pipeline/scene/answers_csv.hpp"

#include <gtest/gtest.h>

#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"

using namespace pipeline;
using geometry::Pose;

namespace {

/// hero and ball move, wall and floor are fixed; ball is born at step 1. Three steps.
geometry::Bodies four() {
  geometry::Bodies bodies;
  bodies.name = {"hero", "ball", "wall", "floor"};
  bodies.mesh = {0, 0, 0, 0};
  bodies.fixed = {0, 0, 1, 1};
  return bodies;
}

std::vector<std::vector<Pose>> poses() {
  std::vector<std::vector<Pose>> out(3, std::vector<Pose>(4));
  out[0][1] = geometry::unborn();
  return out;
}

PairLists read(const std::string& text, const geometry::Bodies& bodies = four()) {
  return parse_answers(text, "a.csv", bodies, poses());
}

std::string answers_error(const std::string& text, const geometry::Bodies& bodies = four()) {
  return tests::refusal_of([&] { read(text, bodies); });
}

std::string times_error(const std::string& text) {
  return tests::refusal_of([&] { parse_times(text, "t.csv", 3); });
}

}  // namespace

TEST(AnswersCsv, TakesRowsAndBodiesInAnyOrder) {
  const PairLists lists = read("step,a,b\n2,wall,hero\n1,ball,floor\n2,ball,hero\n");
  ASSERT_EQ(lists.steps(), 3u);
  EXPECT_EQ(lists.at(0).size(), 0u);
  ASSERT_EQ(lists.at(1).size(), 1u);
  EXPECT_EQ(lists.at(1)[0], (Pair{1, 3}));
  ASSERT_EQ(lists.at(2).size(), 2u);
  EXPECT_EQ(lists.at(2)[0], (Pair{0, 1}));
  EXPECT_EQ(lists.at(2)[1], (Pair{0, 2}));
}

TEST(AnswersCsv, TakesNumbersAsWellAsNames) {
  EXPECT_EQ(read("step,a,b\n1,0,3\n").at(1)[0], (Pair{0, 3}));
  EXPECT_EQ(read("step,a,b\n1,hero,3\n").at(1)[0], (Pair{0, 3}));
}

TEST(AnswersCsv, TakesByteOrderMarkCrLfQuotesAndTheHeadersOrder) {
  const PairLists lists = read("\xEF\xBB\xBF\"b\",\"step\",\"a\"\r\n\"wall\", 0 ,hero\r\n\r\n");
  EXPECT_EQ(lists.at(0)[0], (Pair{0, 2}));
}

TEST(AnswersCsv, AHeaderAloneReportsNothing) {
  EXPECT_EQ(read("step,a,b\n").pair.size(), 0u);
  EXPECT_EQ(read("step,a,b").steps(), 3u);
}

TEST(AnswersCsv, RefusesWithFileAndLine) {
  const std::string start = "step,a,b\n0,hero,wall\n";
  const std::pair<std::string, std::string> cases[] = {
      {"", "a.csv:1: is empty; it must begin with step,a,b"},
      {"\n\n", "a.csv:2: is empty; it must begin with step,a,b"},
      {"0,hero,wall\n", "a.csv:1: must be step,a,b, not \"0,hero,wall\""},
      {"step,a\n", "a.csv:1: must be step,a,b, not \"step,a\""},
      {"step,a,b,c\n", "a.csv:1: must be step,a,b, not \"step,a,b,c\""},
      {"step,a,a\n", "a.csv:1: must be step,a,b, not \"step,a,a\""},
      {start + "1,hero\n", "a.csv:3: must have 3 columns, not 2"},
      {start + "1,\"he,ro\",wall\n", "a.csv:3: must have 3 columns, not 4"},
      {start + "3,hero,wall\n", "a.csv:3: step 3 is beyond the last of the result, 2; steps count from 0"},
      {start + "-1,hero,wall\n", "a.csv:3: step must be an integer of at least 0, not \"-1\""},
      {start + "99999999999999999999,hero,wall\n", "a.csv:3: step must be an integer of at least 0"},
      {start + "1,herro,wall\n", "a.csv:3: there is no body \"herro\" in the result; did you mean \"hero\"?"},
      {start + "1,hero,4\n",
       "a.csv:3: there is no body \"4\" in the result; give names of /body, or numbers from 0 to 3"},
      {start + "1,hero,\n", "a.csv:3: there is no body \"\" in the result; give names"},
      {start + "1,hero,hero\n", "a.csv:3: pairs body \"hero\" with itself; name two bodies"},
      {start + "1,2,wall\n", "a.csv:3: pairs body \"wall\" with itself"},
      {start + "1,wall,floor\n", "a.csv:3: bodies \"wall\" and \"floor\" are both fixed, and no method is asked"},
      {start + "0,ball,wall\n", "a.csv:3: body \"ball\" is not there at step 0; leave the row out"},
      {start + "1,hero,ball\n0,wall,hero\n",
       "a.csv:4: the pair of bodies \"hero\" and \"wall\" is there a second time at step 0, first in line 2"},
  };
  for (const auto& [text, message] : cases) {
    const std::string got = answers_error(text);
    EXPECT_EQ(got.substr(0, message.size()), message);
    EXPECT_EQ(got.find('\n'), std::string::npos);
  }
}

TEST(AnswersCsv, RefusesPairsWithNoneOfTheChosen) {
  geometry::Bodies bodies = four();
  bodies.chosen = {1, 0, 0, 0};
  EXPECT_EQ(read("step,a,b\n1,ball,hero\n", bodies).pair.size(), 1u);
  EXPECT_EQ(
      answers_error("step,a,b\n1,ball,wall\n", bodies).find("a.csv:2: bodies \"ball\" and \"wall\" are not among"), 0u);
}

// A body may be called "0".
TEST(AnswersCsv, RefusesWhatIsANameAndTheNumberOfAnother) {
  geometry::Bodies bodies = four();
  bodies.name[2] = "0";
  EXPECT_EQ(
      answers_error("step,a,b\n1,ball,0\n", bodies).find("a.csv:2: \"0\" is the name of body 2 and the number of"), 0u);
  bodies.name = {"0", "1", "2", "17"};
  EXPECT_EQ(read("step,a,b\n1,17,0\n", bodies).at(1)[0], (Pair{0, 3}));
}

TEST(TimesCsv, GivesEveryStepItsTime) {
  EXPECT_EQ(parse_times("step,ns\n2,30\n0,10.4\n1,2e1\n", "t.csv", 3), (std::vector<std::int64_t>{10, 20, 30}));
}

TEST(TimesCsv, RefusesWithFileAndLine) {
  const std::string start = "step,ns\n0,10\n1,20\n";
  const std::pair<std::string, std::string> cases[] = {
      {"", "t.csv:1: is empty; it must begin with step,ns"},
      {"step,ms\n", "t.csv:1: must be step,ns, not \"step,ms\""},
      {start, "t.csv:3: step 2 has no time; give one for each of the 3 steps"},
      {start + "3,5\n", "t.csv:4: step 3 is beyond the last of the result, 2"},
      {start + "1,5\n", "t.csv:4: a second time of step 1, first in line 3"},
      {start + "2,nan\n", "t.csv:4: ns must be a time in ns above 0 and at most 1e15, not \"nan\""},
      {start + "2,0\n", "t.csv:4: ns must be a time in ns above 0"},
      {start + "2,0.3\n", "t.csv:4: ns must be a time in ns above 0"},
      {start + "2,-5\n", "t.csv:4: ns must be a time in ns above 0"},
      {start + "2,inf\n", "t.csv:4: ns must be a time in ns above 0"},
      {start + "2,2e15\n", "t.csv:4: ns must be a time in ns above 0"},
      {start + "2,\n", "t.csv:4: ns must be a time in ns above 0 and at most 1e15, not \"\""},
  };
  for (const auto& [text, message] : cases) {
    const std::string got = times_error(text);
    EXPECT_EQ(got.substr(0, message.size()), message);
  }
}
