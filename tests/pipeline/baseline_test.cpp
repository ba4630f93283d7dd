// Baselines of made-up results: what is told apart, and that nothing but a baseline is ever replaced.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "pipeline/commands/score.hpp"
#include "pipeline/result/products/passes.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/files.hpp"
#include "tests/support/synthetic_result.hpp"
#include "tests/support/temporary_folder.hpp"

namespace pipeline {
namespace {

constexpr ScoreOptions kWrite{.write = true, .times = false, .tolerance = {}};

ExitCode code_of(const Result& result, const std::filesystem::path& path, const ScoreOptions& options) {
  try {
    score(result, path, options);
    return kDone;
  } catch (const Error& error) {
    return error.code();
  }
}

TEST(Baseline, IsTheSameAsItself) {
  const TemporaryFolder folder;
  const Result result = synthetic_result();
  const Score first = score(result, folder / "b.json", kWrite);
  EXPECT_TRUE(first.written);
  EXPECT_FALSE(first.had_baseline);
  const Score again = score(result, folder / "b.json", {});
  EXPECT_TRUE(again.same());
  EXPECT_EQ(again.algorithms, 3u);
}

// 100,000 arrays in one another ended the program by signal 11. The bound holds within texts of brackets, too.
TEST(Baseline, RefusesWhatIsNestedWithoutEnd) {
  const TemporaryFolder folder;
  const Result result = synthetic_result();
  std::ofstream(folder / "deep.json") << "{\"kind\":" + std::string(100'000, '[');
  EXPECT_EQ(code_of(result, folder / "deep.json", {}), kFile);
  EXPECT_EQ(code_of(result, folder / "deep.json", kWrite), kFile);
  std::ofstream(folder / "closed.json") << std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_EQ(code_of(result, folder / "closed.json", {}), kFile);
}

TEST(Baseline, IsARegularFileOfAFewMebibytes) {
  const TemporaryFolder folder;
  const Result result = synthetic_result();
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  std::ofstream(folder / "huge.json") << "{}";
  std::filesystem::resize_file(folder / "huge.json", std::uint64_t{1} << 40);  // a hole
  for (const std::filesystem::path& path :
       {folder / "fifo", folder / "huge.json", std::filesystem::path("/dev/zero"), folder / ""})
    for (const ScoreOptions& options : {ScoreOptions{}, kWrite})
      EXPECT_EQ(code_of(result, path, options), kFile) << path;
}

TEST(Baseline, ForgetsTimesAndMachines) {
  const TemporaryFolder folder;
  Result result = synthetic_result();
  score(result, folder / "b.json", kWrite);
  for (Answers& answers : result.answers) {
    for (auto& time : answers.time_ns) time *= 3;
    answers.machine.host = "elsewhere";
  }
  for (Summary& row : result.summary) row.time_mean_ns *= 5;
  for (auto& time : result.truth.time_ns) time += 1;
  result.title = "another";
  result.provenance.git_commit = "1";
  EXPECT_TRUE(score(result, folder / "b.json", {}).same());
}

TEST(Baseline, TellsEveryFigureApart) {
  const TemporaryFolder folder;
  const Result right = synthetic_result();
  score(right, folder / "b.json", kWrite);
  const auto changes = [&](auto change) {
    Result result = right;
    change(result);
    return score(result, folder / "b.json", {}).changes;
  };
  const auto only = [](const std::vector<Change>& found, const std::string& of, const std::string& key) {
    return found.size() == 1 && found[0].of == of && found[0].key == key;
  };
  const auto one_more = [](PairLists& lists) {
    lists.pair.push_back({0, 2});
    lists.offset.back() += 1;
  };
  const std::string label = right.answers[1].label;
  EXPECT_TRUE(only(changes([](Result& r) { r.summary[1].hits += 1; }), label, "hits"));
  EXPECT_TRUE(only(changes([](Result& r) { r.summary[1].true_positive += 1; }), label, "true_positive"));
  EXPECT_TRUE(only(changes([](Result& r) { r.summary[1].false_positive += 1; }), label, "false_positive"));
  EXPECT_TRUE(only(changes([](Result& r) { r.summary[1].false_negative += 1; }), label, "false_negative"));
  EXPECT_TRUE(only(changes([](Result& r) { r.summary[1].operations += 1; }), label, "operations"));
  EXPECT_TRUE(only(changes([](Result& r) { r.answers[1].rounding_miss[0] += 1; }), label, "rounding_miss"));
  EXPECT_TRUE(only(changes([&](Result& r) { one_more(r.answers[1].hits); }), label, "answers"));
  EXPECT_TRUE(only(changes([](Result& r) { r.answers[1].knobs = "{}"; }), label, "knobs"));
  EXPECT_TRUE(only(changes([](Result& r) { r.motion[3][1].t.x() += 1; }), "motion", "digest"));
  const auto truth = changes([&](Result& r) { one_more(r.truth.hits); });
  ASSERT_EQ(truth.size(), 2u);
  EXPECT_TRUE(truth[0].of == "truth" && truth[0].key == "digest" && !truth[0].by);
  EXPECT_TRUE(truth[1].of == "truth" && truth[1].key == "hits" && truth[1].by == 1);
  const auto by = changes([](Result& r) { r.summary[1].operations -= 2; });
  ASSERT_EQ(by.size(), 1u);
  EXPECT_EQ(by[0].by, -2);
}

TEST(Baseline, TellsPassesAndContainmentApart) {
  const TemporaryFolder folder;
  Result result = synthetic_result();
  score(result, folder / "b.json", kWrite);
  result.products.put<Passes>({});
  result.products.find<Passes>()->rows.push_back({"cube", "x", "along", 0, 0, 3, 1, 2, 1});
  result.products.find<Passes>()->answers.assign(3, {{0.5}, {-0.25}, {0}, {2}});
  result.truth.containment = Containment::record;
  for (std::size_t s = 0; s < result.steps(); ++s) result.truth.contained.append({});
  for (std::size_t a = 0; a < 3; ++a) {
    result.answers[a].contained_hit.assign(result.steps(), 0);
    result.summary[a].contained_hit = 0;
  }
  EXPECT_FALSE(score(result, folder / "b.json", {}).same());
  score(result, folder / "b.json", kWrite);
  EXPECT_TRUE(score(result, folder / "b.json", {}).same());
  result.products.find<Passes>()->answers[2].first[0] = std::numeric_limits<double>::quiet_NaN();
  const Score found = score(result, folder / "b.json", {});
  ASSERT_EQ(found.changes.size(), 1u);
  EXPECT_EQ(found.changes[0].key, "passes_digest");
  result.products.find<Passes>()->answers[2].first[0] = 0.5;
  result.products.find<Passes>()->rows[0].truth_first = 1.5;
  EXPECT_EQ(score(result, folder / "b.json", {}).changes.at(0).of, "truth");
}

TEST(Baseline, NamesNewAndMissingLabels) {
  const TemporaryFolder folder;
  Result result = synthetic_result();
  score(result, folder / "b.json", kWrite);
  const std::string old = result.answers[0].label;
  result.answers[0].label = "renamed";
  const Score found = score(result, folder / "b.json", {});
  EXPECT_TRUE(found.changes.empty());
  EXPECT_EQ(found.fresh, std::vector<std::string>{"renamed"});
  EXPECT_EQ(found.missing, std::vector<std::string>{old});
  EXPECT_FALSE(found.same());
}

TEST(Baseline, ReplacesNothingElse) {
  const TemporaryFolder folder;
  const std::string text = "[scene]\nkind = \"falling\"\n";
  std::ofstream(folder / "padani.toml") << text;
  EXPECT_EQ(code_of(synthetic_result(), folder / "padani.toml", kWrite), kFile);
  EXPECT_EQ(tests::bytes_of(folder / "padani.toml"), text);
  EXPECT_EQ(code_of(synthetic_result(), folder / "none.json", {}), kFile);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.json"));
}

// A machine that is slower by one factor has the same ratios; so has a run with one more algorithm.
TEST(Baseline, ComparesTimesWithinTheRun) {
  const TemporaryFolder folder;
  Result result = synthetic_result(7, 5, 4);
  for (std::size_t a = 0; a < 4; ++a) result.summary[a].time_mean_ns = 1000.0 * double(a + 1);
  score(result, folder / "b.json", {.write = true, .times = true, .tolerance = {}});
  for (Summary& row : result.summary) row.time_mean_ns *= 7;
  Result fewer = result;
  fewer.answers.pop_back();
  fewer.summary.pop_back();
  for (const Result* run : {&result, &fewer}) {
    const Score found = score(*run, folder / "b.json", {.write = false, .times = true, .tolerance = 1.01});
    EXPECT_TRUE(found.beyond_tolerance.empty());
    EXPECT_EQ(found.times.size(), run->answers.size());
  }
  result.summary[0].time_mean_ns *= 2;
  const Score found = score(result, folder / "b.json", {.write = false, .times = true, .tolerance = 1.5});
  EXPECT_EQ(found.beyond_tolerance, std::vector<std::string>{result.answers[0].label});
  EXPECT_TRUE(score(result, folder / "b.json", {.write = false, .times = true, .tolerance = {}}).same());
}

}  // namespace
}  // namespace pipeline
