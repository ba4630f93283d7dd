#include "pipeline/result/columns.hpp"

#include <gtest/gtest.h>

#include "pipeline/result/answer_chunk.hpp"
#include "pipeline/result/store.hpp"
#include "tests/support/synthetic_result.hpp"
#include "tests/support/temporary_folder.hpp"

namespace pipeline {
namespace {

constexpr std::uint64_t kSteps = 7;

/// Values that no other column, step or algorithm has.
void fill(Result& result) {
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    int number = int(1000 * (a + 1));
    each_answer_column([&](const auto& column) {
      auto& values = result.answers[a].*column.member;
      values.resize(kSteps);
      for (auto& value : values) value = ++number;
    });
  }
}

void expect_same(const Answers& a, const Answers& b) {
  each_answer_column([&](const auto& column) { EXPECT_EQ(a.*column.member, b.*column.member) << column.name; });
  EXPECT_EQ(a.hits.offset, b.hits.offset);
  EXPECT_EQ(a.hits.pair, b.hits.pair);
}

TEST(Columns, OfAnswersAreWrittenAndReadBack) {
  const TemporaryFolder folder;
  Result result = synthetic_result(kSteps, 4, 2, 5);
  fill(result);
  write_result(result, folder / "a.h5");
  const Result again = read_result(folder / "a.h5");
  ASSERT_EQ(again.answers.size(), 2u);
  for (std::size_t a = 0; a < 2; ++a) expect_same(again.answers[a], result.answers[a]);
}

TEST(Columns, OfAnswersAreKeptInChunksAndJoined) {
  Result result = synthetic_result(kSteps, 4, 1, 5);
  fill(result);
  Answers joined;
  for (const auto& [first, last] : {std::pair(0, 3), std::pair(3, 4), std::pair(4, 7)}) {
    ChunkWriter out;
    put_steps(result.answers[0], first, last, out);
    ChunkReader in(out.bytes);
    append_steps(get_steps(in, last - first, 4), joined);
  }
  expect_same(joined, result.answers[0]);
}

TEST(Columns, ThatAreOptionalAreNotThereWithoutValues) {
  const TemporaryFolder folder;
  Result result = synthetic_result(kSteps, 4, 2, 5);
  fill(result);
  for (Answers& answers : result.answers) answers.contained_hit.clear();
  for (Summary& row : result.summary) row.contained_hit.reset();
  write_result(result, folder / "none.h5");
  Result none = read_result(folder / "none.h5");
  EXPECT_TRUE(none.answers[0].contained_hit.empty() && none.answers[1].contained_hit.empty());
  EXPECT_FALSE(none.summary[0].contained_hit);

  // Beside an algorithm that has values, one without has zeros.
  none.answers[1].contained_hit.assign(kSteps, 3);
  none.summary[1].contained_hit = 3 * kSteps;
  write_result(none, folder / "one.h5");
  const Result one = read_result(folder / "one.h5");
  EXPECT_EQ(one.answers[0].contained_hit, std::vector<std::uint64_t>(kSteps, 0));
  EXPECT_EQ(one.answers[1].contained_hit, std::vector<std::uint64_t>(kSteps, 3));
  EXPECT_EQ(one.summary[1].contained_hit, 3 * kSteps);
}

}  // namespace
}  // namespace pipeline
