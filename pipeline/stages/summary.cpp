#include "pipeline/stages/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/result/attributes.hpp"
#include "pipeline/result/columns.hpp"
#include "pipeline/stages/interval.hpp"

namespace pipeline {
namespace {

double ratio(double numerator, double denominator) {
  return denominator == 0 ? std::numeric_limits<double>::quiet_NaN() : numerator / denominator;
}

}  // namespace

Summary summarise(const Answers& answers, std::uint64_t pairs) {
  Summary row;
  row.true_positive = total(answers.true_positive);
  row.false_positive = total(answers.false_positive);
  row.false_negative = total(answers.false_negative);
  if (!answers.contained_hit.empty()) row.contained_hit = total(answers.contained_hit);
  row.hits = row.true_positive + row.false_positive + row.contained_hit.value_or(0);
  row.operations = total(answers.operations);

  const double tp = double(row.true_positive), fp = double(row.false_positive), fn = double(row.false_negative);
  const double tn = double(pairs - row.true_positive - row.false_positive - row.false_negative);
  row.error = tp + fp + fn == 0 ? 0 : (fp + fn) / (tp + fp + fn);
  row.precision = ratio(tp, tp + fp);
  row.recall = ratio(tp, tp + fn);
  // The product of four counts overflows integers, not doubles; its root factor by factor keeps small cases exact.
  const double roots = std::sqrt(tp + fp) * std::sqrt(tp + fn) * std::sqrt(tn + fp) * std::sqrt(tn + fn);
  row.matthews = std::clamp(ratio(tp * tn - fp * fn, roots), -1.0, 1.0);  // roots round; NaN stays

  if (failed(answers)) {  // known of some steps only: no figure of the run
    row.error = row.precision = row.recall = row.matthews = std::numeric_limits<double>::quiet_NaN();
    row.time_mean_ns = row.time_median_ns = row.time_p95_ns = row.error;
    return row;
  }
  std::vector<std::int64_t> times = answers.time_ns;
  std::sort(times.begin(), times.end());
  const std::size_t n = times.size();
  const bool timed = times.back() > 0 && !timed_on_unlike(answers);
  const auto known = [&](double value) { return timed ? value : std::numeric_limits<double>::quiet_NaN(); };
  const Interval mean = mean_interval(answers.time_ns);
  row.time_mean_ns = known(mean.value);
  row.time_mean_low_ns = known(mean.low);
  row.time_mean_high_ns = known(mean.high);
  row.time_median_ns = known(median(times));
  row.time_p95_ns = known(double(times[(95 * n + 99) / 100 - 1]));
  const std::int64_t processor = total(answers.processor_ns);
  row.processor_mean_ns =
      timed && processor > 0 ? double(processor) / double(n) : std::numeric_limits<double>::quiet_NaN();
  for (const auto& [name, cost, column] : kCosts) row.*column = answers.costs.*cost;

  if (answers.promise == "conservative") row.promise_kept = row.false_negative == total(answers.rounding_miss);
  if (answers.promise == "exact") row.promise_kept = row.false_negative == 0 && row.false_positive == 0;
  return row;
}

std::uint64_t judged_pairs(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                           const Truth& truth) {
  std::uint64_t pairs = 0;
  for (const auto& step : poses) pairs += geometry::pair_count(geometry::pair_runs(bodies, step));
  return truth.containment == Containment::record ? pairs - truth.contained.pair.size() : pairs;
}

}  // namespace pipeline
