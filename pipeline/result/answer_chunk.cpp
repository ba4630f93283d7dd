#include "pipeline/result/answer_chunk.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/result/attributes.hpp"
#include "pipeline/result/columns.hpp"

namespace pipeline {
namespace {

/// What a method of others said of itself belongs to its answers: it may be asked no more when they are read again.
constexpr std::string Answers::*kSaid[] = {&Answers::name, &Answers::promise, &Answers::operations_unit,
                                           &Answers::scope};

void put_facts(const Answers& answers, std::int64_t first, std::int64_t last, ChunkWriter& out) {
  out.put(std::vector<std::uint8_t>(answers.foreign ? 1 : 0));
  if (!answers.foreign) return;
  const ForeignFacts& f = *answers.foreign;
  for (const auto member : kSaid) out.put(answers.*member);
  for (const auto& [name, member, kind] : kForeignTexts) out.put(f.*member);
  out.put(std::vector<std::int64_t>{f.threads, std::clamp<std::int64_t>(f.steps_done - first, 0, last - first)});
  out.put(std::vector<double>{f.waited});
}

void get_facts(ChunkReader& in, Answers& answers) {
  if (in.get<std::uint8_t>().empty()) return;
  ForeignFacts& f = answers.foreign.emplace();
  for (const auto member : kSaid) answers.*member = in.text();
  for (const auto& [name, member, kind] : kForeignTexts) f.*member = in.text();
  const auto whole = in.get<std::int64_t>(2);
  const auto real = in.get<double>(1);
  f.threads = whole[0];
  f.steps_done = whole[1];
  f.waited = real[0];
}

void append_facts(const Answers& more, Answers& answers) {
  if (!more.foreign) return;
  const ForeignFacts before = answers.foreign.value_or(ForeignFacts{});
  for (const auto member : kSaid) answers.*member = more.*member;
  answers.foreign = more.foreign;
  answers.foreign->steps_done += before.steps_done;
  if (!before.reason.empty()) answers.foreign->reason = before.reason;
}

void append_costs(const Costs& more, Costs& costs) {
  for (const auto& [name, cost, column] : kCosts)
    costs.*cost = std::fmax(costs.*cost, more.*cost);  // the known one where the other is NaN
}

}  // namespace

void put_steps(const Answers& answers, std::int64_t first, std::int64_t last, ChunkWriter& out) {
  put_facts(answers, first, last, out);
  out.put(std::vector<Costs>{answers.costs});
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

Answers get_steps(ChunkReader& in, std::int64_t steps, std::uint64_t bodies) {
  Answers answers;
  get_facts(in, answers);
  answers.costs = in.get<Costs>(1)[0];
  answers.hits.offset = in.get<std::uint64_t>();
  answers.hits.pair = in.get<Pair>();
  in.require(sound(answers.hits, std::uint64_t(steps), bodies));
  each_answer_column([&]<class T>(const Column<Answers, std::vector<T>>& column) {
    std::vector<T>& values = answers.*column.member;
    values = in.get<T>();
    in.require(values.size() == std::size_t(steps) || (column.optional && values.empty()));
  });
  return answers;
}

void put_machine(const Machine& machine, ChunkWriter& out) {
  for (const auto& [name, member, kind] : kMachineTexts) out.put(machine.*member);
  out.put(std::vector<std::int64_t>{machine.pinned});
}

Machine get_machine(ChunkReader& in) {
  Machine machine;
  for (const auto& [name, member, kind] : kMachineTexts) machine.*member = in.text();
  machine.pinned = in.get<std::int64_t>(1)[0];
  return machine;
}

void note_machine(const Machine& machine, std::size_t steps, Machine& first, std::vector<Machine>& each) {
  if (steps == 0) first = machine;
  const bool other = machine.host != first.host || machine.processor != first.processor;
  if (each.empty() && other) each.assign((steps + kChunkSteps - 1) / kChunkSteps, first);
  if (!each.empty()) each.push_back(machine);
  if (first.pinned != machine.pinned) first.pinned = -1;
}

void leave_out_step(bool counts_contained, Answers& answers) {
  each_answer_column([&](const auto& column) {
    if (!column.optional) (answers.*column.member).push_back(0);
  });
  answers.processor_ns.push_back(0);
  answers.exchange_ns.push_back(0);
  if (counts_contained) answers.contained_hit.push_back(0);
  answers.hits.append({});
}

void append_chunk(const Answers& more, const Machine& machine, Answers& answers) {
  note_machine(machine, answers.hits.steps(), answers.machine, answers.timed_on);
  if (!failed(answers)) return append_steps(more, answers);
  for (std::size_t step = 0; step < more.hits.steps(); ++step) leave_out_step(!answers.contained_hit.empty(), answers);
}

void append_steps(const Answers& more, Answers& answers) {
  append_facts(more, answers);
  append_costs(more.costs, answers.costs);
  answers.hits.append_steps(more.hits);
  each_answer_column([&](const auto& column) {
    const auto& values = more.*column.member;
    auto& all = answers.*column.member;
    all.insert(all.end(), values.begin(), values.end());
  });
}

}  // namespace pipeline
