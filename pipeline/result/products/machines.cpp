#include "pipeline/result/products/machines.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/dataset.hpp"
#include "pipeline/result/hdf5/reader.hpp"
#include "pipeline/result/products/all.hpp"
#include "pipeline/terminal/print.hpp"

namespace pipeline {
namespace {

bool same(const Machine& a, const Machine& b) { return a.host == b.host && a.processor == b.processor; }

std::size_t chunks_of(const Result& result) {
  return (result.steps() + std::size_t(kChunkSteps) - 1) / std::size_t(kChunkSteps);
}

/// The table of machines, and what refers to its rows.
struct Table {
  std::vector<Machine> machines;
  std::vector<std::uint64_t> truth;    // per chunk
  std::vector<std::uint64_t> answers;  // chunks x algorithms

  std::uint64_t number(const Machine& machine) {
    const auto at = std::ranges::find_if(machines, [&](const Machine& one) { return same(one, machine); });
    const auto number = std::uint64_t(at - machines.begin());
    if (at == machines.end()) machines.push_back(machine);
    return number;
  }
};

Table table_of(const Result& result) {
  Table table;
  const auto at = [](const std::vector<Machine>& each, const Machine& all, std::size_t chunk) {
    return each.empty() ? all : each.at(chunk);
  };
  for (std::size_t chunk = 0; chunk < chunks_of(result); ++chunk) {
    table.truth.push_back(table.number(at(result.truth.decided_on, result.truth.machine, chunk)));
    for (const Answers& answers : result.answers)
      table.answers.push_back(table.number(at(answers.timed_on, answers.machine, chunk)));
  }
  return table;
}

bool has(const Result& result) {
  return !result.truth.decided_on.empty() ||
         std::ranges::any_of(result.answers, [](const Answers& answers) { return !answers.timed_on.empty(); });
}

void lay(const Result& result, const Sizes& n, std::vector<Group>& groups) {
  const Table table = table_of(result);
  std::vector<std::int64_t> number(table.machines.size()), first(table.truth.size());
  std::vector<std::string> hosts, processors;
  for (std::size_t i = 0; i < number.size(); ++i) {
    number[i] = std::int64_t(i);
    hosts.push_back(table.machines[i].host);
    processors.push_back(table.machines[i].processor);
  }
  for (std::size_t chunk = 0; chunk < first.size(); ++chunk) first[chunk] = std::int64_t(chunk) * kChunkSteps;
  const Dimension machine{"/machines/machine", number.size()}, chunk{"/machines/chunk", first.size()};
  Group group{"/machines", {}, {}};
  auto& datasets = group.datasets;
  datasets.push_back(scale(owning(machine.scale, number, {machine}, "1", "machines that worked on the run, from 0")));
  datasets.push_back(scale(owning(chunk.scale, first, {chunk}, "1", "first step of the chunk")));
  datasets.push_back(texts("/machines/host", hosts, {machine}, "name of the machine"));
  datasets.push_back(texts("/machines/processor", processors, {machine}, "its processor"));
  datasets.push_back(owning("/machines/truth", table.truth, {chunk}, "1", "machine that decided the chunk"));
  if (!result.answers.empty())
    datasets.push_back(owning("/machines/answers", table.answers, {chunk, n.algorithm}, "1",
                              "machine that asked and timed the algorithm in the chunk"));
  groups.push_back(std::move(group));
}

void read(const Reader& from, Result& result) {
  const std::size_t chunks = chunks_of(result), labels = result.answers.size();
  const auto hosts = from.texts("/machines/host", {kAny});
  const auto processors = from.texts("/machines/processor", {hosts.size()});
  const auto machine = [&](std::uint64_t number, Machine like) {
    if (number >= hosts.size()) throw h5::Failure("/machines: there is no machine " + std::to_string(number));
    like.host = hosts[number];
    like.processor = processors[number];
    return like;
  };
  for (const std::uint64_t number : from.values<std::uint64_t>("/machines/truth", {chunks}))
    result.truth.decided_on.push_back(machine(number, {}));
  if (!result.truth.decided_on.empty()) result.truth.machine = result.truth.decided_on.front();
  if (labels == 0) return;
  const auto table = from.values<std::uint64_t>("/machines/answers", {chunks, labels});
  for (std::size_t a = 0; a < labels; ++a) {
    Answers& answers = result.answers[a];
    for (std::size_t chunk = 0; chunk < chunks; ++chunk)
      answers.timed_on.push_back(machine(table[chunk * labels + a], answers.machine));
    if (std::ranges::all_of(answers.timed_on, [&](const Machine& one) { return same(one, answers.machine); }))
      answers.timed_on.clear();
  }
}

std::string line(const Result& result) {
  const Table table = table_of(result);
  std::string text = print("%zu machines worked on it:", table.machines.size());
  constexpr std::size_t kMost = 8;
  for (std::size_t i = 0; i < table.machines.size() && i < kMost; ++i)
    text += (i ? "; " : " ") + table.machines[i].host + " (" + table.machines[i].processor + ")";
  return text + (table.machines.size() > kMost ? print("; and %zu more\n", table.machines.size() - kMost) : "\n");
}

void json(const Result& result, OrderedJson& out) {
  if (!has(result)) return;
  out["machines"] = OrderedJson::array();
  for (const Machine& machine : table_of(result).machines)
    out["machines"].push_back({{"host", machine.host}, {"processor", machine.processor}});
}

}  // namespace

std::vector<TimesOf> times_by_processor(const Answers& answers) {
  std::vector<TimesOf> all;
  for (std::size_t step = 0; step < answers.time_ns.size(); ++step) {
    const Machine& machine =
        answers.timed_on.empty() ? answers.machine : answers.timed_on.at(step / std::size_t(kChunkSteps));
    auto of = std::ranges::find(all, machine.processor, &TimesOf::processor);
    if (of == all.end()) of = all.insert(all.end(), TimesOf{machine.processor, {}});
    if (std::ranges::find(of->hosts, machine.host) == of->hosts.end()) of->hosts.push_back(machine.host);
    ++of->steps;
    of->mean_ns += double(answers.time_ns[step]);  // the sum, so far
  }
  for (TimesOf& one : all) one.mean_ns /= double(one.steps);
  return all;
}

Product machines_product() {
  return {.name = "machines",
          .place = Product::Place::at_end,
          .sign = "/machines",
          .has = has,
          .lay = lay,
          .read = read,
          .when = "several machines worked on the run",
          .sample =
              [](Result& result) {
                Machine other = result.answers[0].machine;
                other.host += "2";
                result.answers[0].timed_on = {other};
              },
          .line = line,
          .json = json};
}

}  // namespace pipeline
