#include "pipeline/result/products/study.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "pipeline/result/dataset.hpp"
#include "pipeline/result/hdf5/reader.hpp"
#include "pipeline/result/products/all.hpp"
#include "pipeline/terminal/print.hpp"

namespace pipeline {
namespace {

void lay(const Result& result, const Sizes&, std::vector<Group>& groups) {
  const StudyRows& rows = *result.products.find<StudyRows>();
  const Dimension cases{"/study/case", rows.size()};
  Group group{"/study", {}, {}};
  std::vector<std::int64_t> number(rows.size());
  std::iota(number.begin(), number.end(), 0);
  group.datasets.push_back(scale(owning(cases.scale, number, {cases}, "1", "number of the case, from 0")));
  each_study_column([&](const auto& column) { group.datasets.push_back(of_rows(group.path, column, rows, cases)); });
  groups.push_back(std::move(group));
}

void read(const Reader& from, Result& result) {
  StudyRows rows(from.values<std::int64_t>("/study/case", {kAny}).size());
  each_study_column([&](const auto& column) { from.rows("/study", column, rows); });
  result.products.put(std::move(rows));
}

/// What an integrator did in a sweep.
struct SweepSummary {
  std::string sweep, integrator;
  std::string statuses = {};  // of those that did not finish: "2 energy, 1 aborted"
  std::size_t cases = 0, finished = 0;
  double least_error = StudyRow::kNone, worst_energy = 0, time_ns = 0;  // of the finished; total
  std::uint64_t evaluations = 0;
};

std::vector<SweepSummary> summarise(const std::vector<StudyRow>& rows) {
  std::vector<SweepSummary> out;
  std::vector<std::map<std::string, int>> failed;
  for (const StudyRow& row : rows) {
    if (out.empty() || out.back().sweep != row.sweep || out.back().integrator != row.integrator) {
      out.push_back({.sweep = row.sweep, .integrator = row.integrator});
      failed.emplace_back();
    }
    SweepSummary& s = out.back();
    ++s.cases;
    s.time_ns += double(row.time_ns);
    s.evaluations += row.force_evaluations;
    if (row.finished) {
      ++s.finished;
      s.least_error = std::fmin(s.least_error, row.error);
      if (std::fabs(row.energy_error) > std::fabs(s.worst_energy)) s.worst_energy = row.energy_error;
    } else {
      ++failed.back()[row.status];
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i)
    for (const auto& [status, count] : failed[i])
      out[i].statuses += (out[i].statuses.empty() ? "" : ", ") + std::to_string(count) + " " + status;
  return out;
}

std::string text(const Result& result) {
  const StudyRows& rows = *result.products.find<StudyRows>();
  std::vector<std::vector<std::string>> table = {{"sweep", "integrator", "cases", "finished", "least error",
                                                  "worst energy", "evaluations", "time", "not finished"}};
  std::size_t finished = 0;
  for (const SweepSummary& s : summarise(rows)) {
    finished += s.finished;
    table.push_back({s.sweep, s.integrator, std::to_string(s.cases), std::to_string(s.finished),
                     std::isnan(s.least_error) ? "-" : print("%.1e", s.least_error), print("%+.1e", s.worst_energy),
                     std::to_string(s.evaluations), time_text(s.time_ns), s.statuses});
  }
  return print("a study of integrators: %zu cases, %zu finished\n\n", rows.size(), finished) + aligned(table) +
         "\nleast error: relative or rad, over the cases that finished; worst energy: greatest error of its balance "
         "there; time: of processor, all cases\n\n";
}

void json(const Result& result, OrderedJson& out) {
  const StudyRows* rows = result.products.find<StudyRows>();
  if (!rows) return;
  out["study"] = "integration";
  out["cases"] = rows->size();
  out["finished"] = std::ranges::count_if(*rows, &StudyRow::finished);
  out["sweeps"] = OrderedJson::array();
  for (const SweepSummary& s : summarise(*rows))
    out["sweeps"].push_back({{"sweep", s.sweep},
                             {"integrator", s.integrator},
                             {"cases", s.cases},
                             {"finished", s.finished},
                             {"not_finished", s.statuses},
                             {"least_error", s.least_error},
                             {"worst_energy_error", s.worst_energy},
                             {"force_evaluations", s.evaluations},
                             {"time_ns", s.time_ns}});
}

std::string plan(const OrderedJson& asked) {
  if (!asked.contains("study")) return "";
  const auto& budget = asked["budget"];
  std::string text;
  for (const auto& sweep : asked["sweeps"])
    text += "sweep       " + sweep["name"].get<std::string>() + ": " + sweep["problem"].get<std::string>() +
            print(", %zu integrators\n", sweep["integrators"].get<std::size_t>());
  const auto every = asked["every"].get<long long>();
  text += print("cases       %llu%s, each in a process of its own\n", asked["cases"].get<unsigned long long>(),
                every > 1 ? print(", one of every %lld", every).c_str() : "");
  return text + print("budget      %lld force evaluations and %g s of processor time for each case\n",
                      budget["force_evaluations"].get<long long>(), budget["processor_time"].get<double>());
}

Cost cost(const OrderedJson& asked, const Extent&) {
  constexpr double kFile = 36000, kCase = 500;  // bytes
  return asked.contains("study") ? Cost{.bytes = kFile + kCase * asked["cases"].get<double>()} : Cost{};
}

}  // namespace

Product study_product() {
  return {.name = "study",
          .place = Product::Place::alone,
          .sign = "/study",
          .has = [](const Result& result) { return result.products.find<StudyRows>() != nullptr; },
          .lay = lay,
          .read = read,
          .chunks = "case",
          .when = "study = \"integration\"",
          .sample = [](Result& result) { result.products.put(StudyRows(1)); },
          .what = "a study of the integrators",
          .text = text,
          .json = json,
          .plan = plan,
          .cost = cost};
}

}  // namespace pipeline
