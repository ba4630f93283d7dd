#include "pipeline/result/answer_chunk.hpp"

#include "pipeline/result/columns.hpp"

namespace pipeline {

void put_steps(const Answers& answers, std::int64_t first, std::int64_t last, ChunkWriter& out) {
  PairLists hits;
  for (std::int64_t step = first; step < last; ++step) hits.append(answers.hits.at(std::size_t(step)));
  out.put(hits.offset);
  out.put(hits.pair);
  each_answer_column([&]<class T>(const Column<Answers, std::vector<T>>& column) {
    const std::vector<T>& values = answers.*column.member;
    if (column.optional && values.empty())
      out.put(values);
    else
      out.put(std::vector<T>(values.begin() + first, values.begin() + last));
  });
}

Answers get_steps(ChunkReader& in) {
  Answers answers;
  answers.hits.offset = in.get<std::uint64_t>();
  answers.hits.pair = in.get<Pair>();
  each_answer_column(
      [&]<class T>(const Column<Answers, std::vector<T>>& column) { answers.*column.member = in.get<T>(); });
  return answers;
}

void append_steps(const Answers& more, Answers& answers) {
  answers.hits.append_steps(more.hits);
  each_answer_column([&](const auto& column) {
    const auto& values = more.*column.member;
    auto& all = answers.*column.member;
    all.insert(all.end(), values.begin(), values.end());
  });
}

}  // namespace pipeline
