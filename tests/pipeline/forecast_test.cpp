#include "pipeline/terminal/forecast.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "pipeline/terminal/progress.hpp"

namespace {

using pipeline::Forecast;
using pipeline::Progress;
using pipeline::Shown;
using pipeline::Stage;

Stage even(const std::string& name, int items, double each) {
  Stage stage{name, {0}};
  for (int i = 0; i < items; ++i) stage.until.push_back(stage.until.back() + each);
  return stage;
}

TEST(Forecast, CountsTheStagesAhead) {
  Forecast forecast({even("motion", 10, 1), even("truth", 10, 0.5), even("detect", 10, 2)});
  forecast.begin("motion", 10);
  EXPECT_DOUBLE_EQ(*forecast.left(), 35);
  for (int i = 0; i < 5; ++i) forecast.done(1, 1, true);
  EXPECT_DOUBLE_EQ(*forecast.left(), 30);
  forecast.begin("truth", 10);
  EXPECT_DOUBLE_EQ(*forecast.left(), 25);
  EXPECT_TRUE(forecast.whole());
}

// Three times slower than foreseen is known after a tenth of the stage, within a factor of 1.5; of the later stages
// nothing is.
TEST(Forecast, LearnsThatAStageIsSlower) {
  Forecast forecast({even("motion", 1000, 1), even("detect", 1000, 1)});
  forecast.begin("motion", 1000);
  for (int i = 0; i < 100; ++i) forecast.done(1, 3, true);
  EXPECT_NEAR(*forecast.left(), 900 * 3 + 1000, 900);
}

TEST(Forecast, IsImprovedByWhatIsKnownLater) {
  Forecast forecast({even("motion", 10, 1), even("detect", 10, 2)});
  forecast.improve(even("detect", 10, 5));
  forecast.improve(even("passes", 10, 5));  // not foreseen at all
  forecast.begin("motion", 10);
  EXPECT_DOUBLE_EQ(*forecast.left(), 60);
}

// Others want the processor: what was foreseen in its time takes as much longer in the stages ahead as in this one.
TEST(Forecast, CountsABusyMachine) {
  Forecast forecast({even("motion", 100, 1), even("detect", 100, 1)});
  forecast.begin("motion", 100);
  for (int i = 0; i < 50; ++i) forecast.done(1, 3, true, 3);
  EXPECT_NEAR(*forecast.left(), 3 * (50 + 100), 5);
}

// A second half that takes ten times as long although nobody foresaw it: noticed while it lasts.
TEST(Forecast, FollowsTheRecentRate) {
  Forecast forecast({even("motion", 100, 1)});
  forecast.begin("motion", 100);
  for (int i = 0; i < 50; ++i) forecast.done(1, 1, true);
  EXPECT_NEAR(*forecast.left(), 50, 1);
  for (int i = 0; i < 25; ++i) forecast.done(1, 10, true);
  EXPECT_GT(*forecast.left(), 250 / 2.0);  // the mean rate would say 25 * 300 / 75 = 100
}

TEST(Forecast, KnowsALivelyHalfThatComesLater) {
  Stage lively{"motion", {0}};
  for (int i = 0; i < 100; ++i) lively.until.push_back(lively.until.back() + (i < 50 ? 1 : 9));
  Forecast forecast({lively});
  forecast.begin("motion", 100);
  for (int i = 0; i < 10; ++i) forecast.done(1, 2, true);  // all is twice as slow
  const double truly = 2 * (40 + 50 * 9);
  EXPECT_GT(*forecast.left(), truly / 2);  // the mean rate would say 2 * 90
  EXPECT_LT(*forecast.left(), truly * 2);
}

TEST(Forecast, TakesNoRateFromWhatAnEarlierRunDid) {
  Forecast forecast({even("motion", 100, 1)});
  forecast.begin("motion", 100);
  forecast.done(50, 0.001, false);
  EXPECT_DOUBLE_EQ(*forecast.left(), 50);
}

TEST(Forecast, CountsItemsWhereNothingIsForeseen) {
  Forecast forecast;
  forecast.begin("oracle", 10);
  EXPECT_FALSE(forecast.left());
  forecast.done(2, 3, true);
  EXPECT_DOUBLE_EQ(*forecast.left(), 12);
  EXPECT_FALSE(forecast.whole());
}

TEST(Progress, SlowWorkIsSecondsAnItem) {
  EXPECT_EQ(pipeline::rate_text(120, 1, "step"), "120 steps/s");
  EXPECT_EQ(pipeline::rate_text(3, 2, "step"), "1.5 steps/s");
  EXPECT_EQ(pipeline::rate_text(2, 5, "step"), "2.5 s/step");
  EXPECT_EQ(pipeline::rate_text(1, 250, "case"), "250 s/case");
  EXPECT_EQ(pipeline::rate_text(0, 3, "step"), "");
  EXPECT_EQ(pipeline::clock_text(12.4), "0:12");
  EXPECT_EQ(pipeline::clock_text(3723), "1:02:03");
}

std::string written(std::FILE* file) {
  std::string text(std::size_t(std::ftell(file)), '\0');
  std::rewind(file);
  EXPECT_EQ(std::fread(text.data(), 1, text.size(), file), text.size());
  std::fclose(file);
  return text;
}

// Of 30 s in a run, of 20 ms here.
TEST(Progress, WithoutATerminalIsALineNowAndThen) {
  using std::chrono::milliseconds;
  std::FILE* file = std::tmpfile();
  Forecast forecast({even("motion", 10, 60), even("detect", 10, 60)});
  {
    Progress progress("motion", 10, Shown{.to = file, .bar = false, .every = milliseconds(20)}, &forecast);
    for (int i = 0; i < 5; ++i) {
      std::this_thread::sleep_for(milliseconds(25));
      progress.add(1);
      progress.add(0);
    }
  }
  const std::string text = written(file);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5) << text;
  EXPECT_NE(text.find("motion 50 %, "), std::string::npos) << text;
  EXPECT_NE(text.find("steps/s, about "), std::string::npos) << text;
  EXPECT_NE(text.find(" left of the run\n"), std::string::npos) << text;
  EXPECT_EQ(text.find('\r'), std::string::npos) << text;
}

TEST(Progress, OnATerminalIsOneLineThatIsRewritten) {
  std::FILE* file = std::tmpfile();
  {
    Progress progress("oracle", 4, Shown{.to = file, .bar = true});
    progress.add(4);
  }
  const std::string text = written(file);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_NE(text.find("100 %"), std::string::npos) << text;
}

TEST(Progress, IsNothingWhenQuiet) {
  EXPECT_EQ(Shown::on_stderr(true).to, nullptr);
  EXPECT_EQ(Shown::on_stderr(false).every, std::chrono::seconds(30));
}

}  // namespace
