#include "pipeline/result/products/extremes.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <nlohmann/json.hpp>

#include "pipeline/result/dataset.hpp"
#include "pipeline/result/hdf5/reader.hpp"
#include "pipeline/result/products/all.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

inline constexpr Column<ExtremeCase, std::string> kCaseTexts[] = {
    {"pair", &ExtremeCase::pair, "1", "the two shapes"},
    {"gap_class", &ExtremeCase::gap_class, "1",
     "the gap as it was asked for: ulps, or a part of the scale; negative: beyond touching"}};
inline constexpr Column<ExtremeCase, double> kCaseReals[] = {
    {"gap", &ExtremeCase::gap, "m", "displacement along the approach from exact touching; positive: apart"},
    {"ulp", &ExtremeCase::ulp, "m", "spacing of doubles at the greatest coordinate, offset + 8 scale"},
    {"scale", &ExtremeCase::scale, "m", "size of the bodies: about half their extent"},
    {"offset", &ExtremeCase::offset, "m", "each coordinate at which the first body stands"}};
inline constexpr Column<ExtremeCase, std::int64_t> kCaseIntegers[] = {
    {"gap_ulps", &ExtremeCase::gap_ulps, "1", "gap in units of ulp"}};
inline constexpr Column<ExtremeCase, std::uint64_t> kCaseCounts[] = {
    {"orientation_stream", &ExtremeCase::orientation, "1", "stream of the seed that turned the two and chose the way"}};
inline constexpr Column<ExtremeCase, std::uint8_t> kCaseFlags[] = {
    {"truth", &ExtremeCase::truth, "1", "1 when the pair meets, by which answers are scored"},
    {"truth_moved", &ExtremeCase::truth_moved, "1",
     "1 when the pair meets with both bodies moved by an exactly representable step, by the same truth"},
    {"near_touching", &ExtremeCase::near_touching, "1",
     "1 within 1000 ulps of touching, or where the truth changes within 1000 ulps: to be counted apart"}};
inline constexpr Column<ExtremeAnswers, std::string> kCaseReason{
    "failure", &ExtremeAnswers::reason, "1", "what the algorithm said when it first failed; empty: it never did"};

/// Of the cases themselves.
template <typename Each>
void each_column(const Each& each) {
  for (const auto& column : kCaseTexts) each(column);
  for (const auto& column : kCaseReals) each(column);
  for (const auto& column : kCaseIntegers) each(column);
  for (const auto& column : kCaseCounts) each(column);
  for (const auto& column : kCaseFlags) each(column);
}

void lay(const Result& result, const Sizes& n, std::vector<Group>& groups) {
  const Extremes& extremes = *result.products.find<Extremes>();
  assert(extremes.rows.size() == n.step.size && "a row for every step");
  Group group{"/extremes", {}, {}};
  each_column(
      [&](const auto& column) { group.datasets.push_back(of_rows(group.path, column, extremes.rows, n.step)); });
  if (!extremes.answers.empty()) {
    each_case_answer_column([&](const auto& column) {
      group.datasets.push_back(of_answers(group.path, column, extremes.answers, n.step, n.algorithm));
    });
    group.datasets.push_back(of_rows(group.path, kCaseReason, extremes.answers, n.algorithm));
  }
  groups.push_back(std::move(group));
}

void read(const Reader& from, Result& result) {
  Extremes extremes;
  extremes.rows.resize(result.steps());
  each_column([&](const auto& column) { from.rows("/extremes", column, extremes.rows); });
  extremes.answers.resize(result.answers.size());
  if (!extremes.answers.empty()) {
    each_case_answer_column(
        [&](const auto& column) { from.answers("/extremes", column, result.steps(), extremes.answers); });
    from.rows("/extremes", kCaseReason, extremes.answers);
  }
  result.products.put(std::move(extremes));
}

void take(Products& from, std::size_t i, Products& to, std::size_t at) {
  std::vector<ExtremeAnswers>& all = to.find<Extremes>()->answers;
  if (at == all.size()) all.emplace_back();
  all[at] = std::move(from.find<Extremes>()->answers[i]);
}

/// The different values of a column, ascending.
std::vector<double> distinct(const Extremes& extremes, double ExtremeCase::*column) {
  std::vector<double> out;
  for (const ExtremeCase& row : extremes.rows) out.push_back(row.*column);
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// How often algorithms err near touching and clear of it, by scale and by offset, and how often they contradict
/// themselves.
std::string text(const Result& result) {
  const Extremes& extremes = *result.products.find<Extremes>();
  if (extremes.answers.empty()) return "";
  std::vector<std::vector<std::string>> rows = {
      {"cases", "error clear", "error near", "failed", "swap changes", "move changes"}};
  std::vector<std::vector<std::string>> places = {{"error clear of touching"}};
  const std::vector<double> scales = distinct(extremes, &ExtremeCase::scale),
                            offsets = distinct(extremes, &ExtremeCase::offset);
  for (const double scale : scales) places[0].push_back(print("scale %g", scale));
  for (const double offset : offsets) places[0].push_back(print("offset %g", offset));
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    const auto error = [&](auto chosen) { return share_text(count(extremes, a, chosen).error()); };
    const auto clear = [](const ExtremeCase& row) { return !row.near_touching; };
    const ExtremesInstability unsure = instability(extremes, a);
    rows.push_back({result.answers[a].label, error(clear),
                    error([](const ExtremeCase& row) { return row.near_touching; }),
                    std::to_string(count(extremes, a, [](const ExtremeCase&) { return true; }).failed),
                    std::to_string(unsure.swapped), std::to_string(unsure.moved)});
    places.push_back({result.answers[a].label});
    for (const double scale : scales)
      places.back().push_back(error([&](const ExtremeCase& row) { return clear(row) && row.scale == scale; }));
    for (const double offset : offsets)
      places.back().push_back(error([&](const ExtremeCase& row) { return clear(row) && row.offset == offset; }));
  }
  const auto near = std::ranges::count_if(extremes.rows, [](const ExtremeCase& row) { return row.near_touching; });
  std::string out =
      aligned(rows) +
      print(
          "\nof %zu cases %td are near touching: the truth changes within %lld ulps; failed: refused the bodies or "
          "threw, no part of these errors\n\n",
          extremes.rows.size(), near, static_cast<long long>(kNearUlps)) +
      aligned(places) +
      "\nfar offsets lack small scales and small gaps, which rounding would swallow: like is compared with like by\n"
      "analysis.tables.extremes, error_by_offset(run, like=True)\n\n";
  for (std::size_t a = 0; a < result.answers.size(); ++a)
    if (!extremes.answers[a].reason.empty())
      out += result.answers[a].label + " failed first: " + one_line(extremes.answers[a].reason, 200) + "\n";
  return out + "\n";
}

void json(const Result& result, OrderedJson& out) {
  const Extremes* found = result.products.find<Extremes>();
  if (!found) return;
  const Extremes& extremes = *found;
  OrderedJson& json = out["extremes"] = OrderedJson::array();
  for (std::size_t a = 0; a < result.answers.size(); ++a)
    for (const bool near : {false, true}) {
      const ExtremesCount row =
          count(extremes, a, [&](const ExtremeCase& row) { return bool(row.near_touching) == near; });
      json.push_back({{"algorithm", result.answers[a].label},
                      {"near_touching", near},
                      {"cases", row.cases},
                      {"true_positive", row.true_positive},
                      {"false_positive", row.false_positive},
                      {"false_negative", row.false_negative},
                      {"failed", row.failed},
                      {"error", row.error()}});
    }
}

std::string plan(const OrderedJson& asked) {
  if (!asked.contains("case_sets")) return "";
  return print("cases       %llu sets of gaps, each answered as two bodies alone, in both orders and moved\n",
               asked["case_sets"].get<unsigned long long>());
}

Cost cost(const OrderedJson& asked, const Extent& run) {
  constexpr double kTexts = 62;  // bytes of a case
  return asked.contains("case_sets") ? Cost{.objects = 17, .bytes = kTexts * run.steps} : Cost{};
}

}  // namespace

double ExtremesCount::error() const {
  if (cases == failed) return std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t wrong = false_positive + false_negative;
  return wrong == 0 ? 0 : double(wrong) / double(true_positive + wrong);
}

ExtremesInstability instability(const Extremes& extremes, std::size_t algorithm) {
  ExtremesInstability out;
  const ExtremeAnswers& said = extremes.answers[algorithm];
  for (std::size_t s = 0; s < extremes.rows.size(); ++s) {
    if (said.failed[s]) continue;
    const ExtremeCase& row = extremes.rows[s];
    out.swapped += said.swapped[s] != said.reported[s];
    out.moved += said.moved[s] != said.reported[s] && row.truth_moved == row.truth;
  }
  return out;
}

Product extremes_product() {
  return {.name = "extremes",
          .place = Product::Place::at_end,
          .sign = "/extremes",
          .has = [](const Result& result) { return result.products.find<Extremes>() != nullptr; },
          .lay = lay,
          .read = read,
          .when = "kind = \"extremes\"",
          .sample =
              [](Result& result) {
                ExtremeAnswers said;
                said.reported = said.swapped = said.moved = said.failed = {0, 0};
                result.products.put(Extremes{.rows = {ExtremeCase{}, ExtremeCase{}}, .answers = {said}});
              },
          .take = take,
          .text = text,
          .json = json,
          .plan = plan,
          .cost = cost};
}

}  // namespace pipeline
