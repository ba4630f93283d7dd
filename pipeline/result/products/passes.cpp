#include "pipeline/result/products/passes.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/result/dataset.hpp"
#include "pipeline/result/digest.hpp"
#include "pipeline/result/hdf5/reader.hpp"
#include "pipeline/result/products/all.hpp"
#include "pipeline/terminal/print.hpp"

namespace pipeline {
namespace {

inline constexpr Column<PassRow, std::string> kPassTexts[] = {
    {"target", &PassRow::target, "1", "body that the hero passes through"},
    {"path", &PassRow::path, "1", "name of the path: x, y and z are straight along that axis"},
    {"orientation", &PassRow::orientation, "1",
     "the hero's own y axis lies along the path, or across: along the second axis after the path's; or as given"}};
inline constexpr Column<PassRow, double> kPassReals[] = {
    {"offset", &PassRow::offset, "m", "distance of the path from the target's position"},
    {"truth_first", &PassRow::truth_first, "m", "way from the path's start to the exact first contact; NaN: none"},
    {"truth_last", &PassRow::truth_last, "m", "way from the path's start to the exact last contact; NaN: none"}};
inline constexpr Column<PassRow, std::uint64_t> kPassCounts[] = {
    {"first_step", &PassRow::first_step, "1", "step of the first sample of the pass"},
    {"samples", &PassRow::samples, "1", "samples of the pass, one a step, at equal distances"},
    {"truth_hits", &PassRow::truth_hits, "1", "samples that truly meet"}};
inline constexpr Column<PassAnswers, std::vector<double>> kPassAnswerReals[] = {
    {"first", &PassAnswers::first, "m",
     "how far before (positive) or after (negative) the exact first contact it first reports; NaN: one of them is "
     "none"},
    {"last", &PassAnswers::last, "m",
     "how far before (positive) or after (negative) the exact last contact it last reports; NaN: one of them is none"}};
inline constexpr Column<PassAnswers, std::vector<std::uint64_t>> kPassAnswerCounts[] = {
    {"flicker", &PassAnswers::flicker, "1", "changes of its answer between neighbouring samples that both truly meet"},
    {"hits", &PassAnswers::hits, "1", "samples reported, whether they truly meet or not"}};

/// Of the passes themselves.
template <typename Each>
void each_column(const Each& each) {
  for (const auto& column : kPassTexts) each(column);
  for (const auto& column : kPassCounts) each(column);
  for (const auto& column : kPassReals) each(column);
}

/// Of what an algorithm said.
template <typename Each>
void each_said_column(const Each& each) {
  for (const auto& column : kPassAnswerReals) each(column);
  for (const auto& column : kPassAnswerCounts) each(column);
}

void lay(const Result& result, const Sizes& n, std::vector<Group>& groups) {
  const Passes& passes = *result.products.find<Passes>();
  const Dimension pass{"/passes/pass", passes.rows.size()};
  Group group{"/passes", {}, {}};
  group.datasets.push_back(bare_scale(pass, "straight passes of the hero through an obstacle"));
  each_column([&](const auto& column) { group.datasets.push_back(of_rows(group.path, column, passes.rows, pass)); });
  if (!passes.answers.empty())
    each_said_column([&](const auto& column) {
      group.datasets.push_back(of_answers(group.path, column, passes.answers, pass, n.algorithm));
    });
  groups.push_back(std::move(group));
}

void read(const Reader& from, Result& result) {
  Passes passes;
  passes.rows.resize(from.texts(std::string("/passes/") + kPassTexts[0].name, {kAny}).size());
  each_column([&](const auto& column) { from.rows("/passes", column, passes.rows); });
  passes.answers.resize(result.answers.size());
  if (!passes.answers.empty())
    each_said_column([&](const auto& column) { from.answers("/passes", column, passes.rows.size(), passes.answers); });
  result.products.put(std::move(passes));
}

void take(Products& from, std::size_t i, Products& to, std::size_t at) {
  std::vector<PassAnswers>& all = to.find<Passes>()->answers;
  if (at == all.size()) all.emplace_back();
  all[at] = std::move(from.find<Passes>()->answers[i]);
}

/// Targets across, algorithms down: when each first reports, and what it never or wrongly does.
std::string text(const Result& result) {
  const Passes& passes = *result.products.find<Passes>();
  if (passes.answers.empty()) return "";
  const std::vector<std::string> names = targets(passes.rows);
  std::vector<std::vector<std::string>> first = {{"first report"}}, wrong = {{"missed + false positives"}};
  for (const std::string& name : names) {
    first[0].push_back(name);
    wrong[0].push_back(name);
  }
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    first.push_back({result.answers[a].label});
    wrong.push_back({result.answers[a].label});
    for (const std::string& name : names) {
      const TargetSummary row = summarise(passes.rows, passes.answers[a], name);
      // Positions are found to 1e-6 m: less than half a millimetre is nothing, and has no sign.
      first.back().push_back(std::isnan(row.median)           ? "-"
                             : std::fabs(row.median) < 0.5e-3 ? "0.000"
                                                              : print("%+.3f", row.median));
      wrong.back().push_back(print("%llu + %llu", static_cast<unsigned long long>(row.missed),
                                   static_cast<unsigned long long>(row.false_positives)));
    }
  }
  std::vector<std::string> met = {"passes that meet"};
  for (const std::string& name : names) {
    std::size_t all = 0, meet = 0;
    for (const PassRow& row : passes.rows) {
      all += row.target == name;
      meet += row.target == name && row.truth_hits > 0;
    }
    met.push_back(print("%zu of %zu", meet, all));
  }
  first.push_back(met);
  return aligned(first) +
         "\nfirst report: metres before (+) or after (-) the exact first contact, the median over the passes that meet "
         "and are reported\n\n" +
         aligned(wrong) +
         "\nmissed: passes that meet and are never reported; false positives: passes that never meet and are "
         "reported\n\n";
}

void json(const Result& result, OrderedJson& out) {
  const Passes* found = result.products.find<Passes>();
  if (!found) return;
  const Passes& passes = *found;
  OrderedJson& json = out["passes"] = OrderedJson::array();
  for (const std::string& name : targets(passes.rows))
    for (std::size_t a = 0; a < result.answers.size(); ++a) {
      const TargetSummary row = summarise(passes.rows, passes.answers[a], name);
      json.push_back({{"target", name},
                      {"algorithm", result.answers[a].label},
                      {"passes", row.passes},
                      {"met", row.met},
                      {"missed", row.missed},
                      {"false_positives", row.false_positives},
                      {"flicker", row.flicker},
                      {"first_median", row.median},
                      {"first_earliest", row.earliest},
                      {"first_latest", row.latest}});
    }
}

/// Where the surfaces of the passes first and last meet, to the bit.
std::string digest_of(const std::vector<PassRow>& rows) {
  Digest digest;
  for (const PassRow& row : rows) {
    const double ends[] = {row.truth_first, row.truth_last};
    digest.add(std::span<const double>(ends));
  }
  return digest.hex();
}

/// Where an algorithm first and last reports them.
std::string digest_of(const PassAnswers& answers) {
  Digest digest;
  digest.add(std::span(answers.first));
  digest.add(std::span(answers.last));
  return digest.hex();
}

void figures(const Result& result, nlohmann::json& truth) {
  truth["passes_digest"] = digest_of(result.products.find<Passes>()->rows);
}

void label_figures(const Result& result, std::size_t algorithm, nlohmann::json& out) {
  const PassAnswers& said = result.products.find<Passes>()->answers[algorithm];
  out["passes_hits"] = total(said.hits);
  out["passes_flicker"] = total(said.flicker);
  out["passes_digest"] = digest_of(said);
}

std::string plan(const OrderedJson& asked) {
  if (!asked.contains("passes")) return "";
  return print("passes      %llu, early or late found by bisection: truth to %g m, algorithms to %g m\n",
               asked["passes"].get<unsigned long long>(), kTruthTolerance, kAlgorithmTolerance);
}

Cost cost(const OrderedJson& asked, const Extent& run) {
  constexpr double kTexts = 160, kAnswer = 9;  // bytes of a pass, and of what an algorithm said of it
  if (!asked.contains("passes")) return {};
  return {.objects = 15, .bytes = asked["passes"].get<double>() * (kTexts + kAnswer * run.labels)};
}

}  // namespace

TargetSummary summarise(const std::vector<PassRow>& rows, const PassAnswers& answers, const std::string& target) {
  TargetSummary out;
  std::vector<double> first;
  for (std::size_t p = 0; p < rows.size(); ++p) {
    if (rows[p].target != target) continue;
    const bool met = rows[p].truth_hits > 0, reported = answers.hits[p] > 0;
    ++out.passes;
    out.met += met;
    out.missed += met && !reported;
    out.false_positives += !met && reported;
    out.flicker += answers.flicker[p];
    if (met && reported) first.push_back(answers.first[p]);
  }
  out.median = out.earliest = out.latest = std::numeric_limits<double>::quiet_NaN();
  if (first.empty()) return out;
  std::ranges::sort(first);
  out.median = median(first);
  out.earliest = first.back();
  out.latest = first.front();
  return out;
}

std::vector<std::string> targets(const std::vector<PassRow>& rows) {
  std::vector<std::string> out;
  for (const PassRow& row : rows)
    if (std::ranges::find(out, row.target) == out.end()) out.push_back(row.target);
  return out;
}

Product passes_product() {
  return {.name = "passes",
          .place = Product::Place::at_end,
          .sign = "/passes",
          .has = [](const Result& result) { return result.products.find<Passes>() != nullptr; },
          .lay = lay,
          .read = read,
          .when = "the scene has passes",
          .sample =
              [](Result& result) {
                result.products.put(Passes{.rows = {PassRow{}}, .answers = {PassAnswers{{0}, {0}, {0}, {0}}}});
              },
          .take = take,
          .text = text,
          .json = json,
          .figures = figures,
          .label_figures = label_figures,
          .plan = plan,
          .cost = cost};
}

}  // namespace pipeline
