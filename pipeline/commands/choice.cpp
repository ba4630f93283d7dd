#include "pipeline/commands/choice.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "pipeline/result/products/noise.hpp"
#include "pipeline/stages/interval.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using Json = nlohmann::ordered_json;

std::string timed_on(const Machine& machine) {
  return machine.host + '\n' + machine.processor + '\n' + machine.build + '\n' + std::to_string(machine.pinned);
}

bool has_time(const Result& result, std::size_t a) {
  return !failed(result.answers[a]) && result.summary[a].time_mean_ns > 0 && !std::isnan(result.summary[a].error);
}

/// Whether no difference of two labels' times is told.
class Equality {
 public:
  explicit Equality(const Result& result) : answers_(result.answers) {
    const Noise* noise = result.products.find<Noise>();
    if (noise && noise->low <= noise->high) floor_ = std::max(noise->high, 1 / noise->low);
  }

  bool operator()(std::size_t a, std::size_t b) const {
    const Interval ratio = ratio_interval(answers_[a].time_ns, answers_[b].time_ns);
    if (!(ratio.low <= ratio.high)) return false;
    return (ratio.low <= 1 && 1 <= ratio.high) || (1 / floor_ <= ratio.low && ratio.high <= floor_);
  }

 private:
  const std::vector<Answers>& answers_;
  double floor_ = 1;
};

}  // namespace

Advice advice(const Result& result) {
  const std::vector<Summary>& summary = result.summary;
  std::map<std::string, std::vector<std::size_t>> machines;
  for (std::size_t a = 0; a < result.answers.size(); ++a)
    if (has_time(result, a)) machines[timed_on(result.answers[a].machine)].push_back(a);
  Advice out;
  std::vector<std::size_t> labels;  // that compare, the fastest first
  for (const auto& [machine, timed] : machines)
    if (timed.size() > labels.size()) labels = timed;
  for (std::size_t a = 0; a < result.answers.size(); ++a)
    if (!std::ranges::count(labels, a)) out.left_out.push_back(a);
  std::ranges::stable_sort(labels, {}, [&](std::size_t a) { return summary[a].time_mean_ns; });
  const Equality equal(result);

  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::size_t a = labels[i];
    if (!out.front.empty() && summary[a].error >= summary[out.front.back().label].error) continue;
    // One that errs less and is as fast makes those before it pointless.
    while (!out.front.empty() && equal(a, out.front.back().label)) out.front.pop_back();
    out.front.push_back({a, {}});
  }
  for (Taken& taken : out.front)
    for (const std::size_t a : labels)
      if (a != taken.label && summary[a].error == summary[taken.label].error && equal(a, taken.label))
        taken.equals.push_back(a);

  out.fastest = {{"error at most 0.1", 0.1, true, {}},
                 {"error at most 0.01", 0.01, true, {}},
                 {"no error", 0, true, {}},
                 {"no false negative", 1, false, {}}};
  for (Fastest& fastest : out.fastest)
    for (const std::size_t a : labels) {
      if (summary[a].error > fastest.most_error || (!fastest.misses && summary[a].false_negative > 0)) continue;
      if (fastest.taken.empty())
        fastest.taken.push_back({a, {}});
      else if (equal(a, fastest.taken[0].label))
        fastest.taken[0].equals.push_back(a);
    }
  return out;
}

std::string advice_text(const Result& result) {
  const Advice found = advice(result);
  if (result.answers.size() - found.left_out.size() < 2) return {};
  const auto names = [&](const std::vector<std::size_t>& labels) {
    std::string text;
    for (const std::size_t a : labels) text += (text.empty() ? "" : ", ") + result.answers[a].label;
    return text.empty() ? std::string("-") : text;
  };
  const auto row = [&](const std::string& asked, const Taken& taken) -> std::vector<std::string> {
    const Summary& is = result.summary[taken.label];
    return {asked, result.answers[taken.label].label, share_text(is.error), time_text(is.time_mean_ns),
            names(taken.equals)};
  };
  std::vector<std::vector<std::string>> rows = {{"which one to take", "label", "error", "mean time", "as fast"}};
  for (const Taken& taken : found.front)
    rows.push_back(row("from " + time_text(result.summary[taken.label].time_mean_ns) + " on", taken));
  for (const Fastest& fastest : found.fastest)
    rows.push_back(fastest.taken.empty() ? std::vector<std::string>{fastest.allowed, "none", "-", "-", "-"}
                                         : row(fastest.allowed, fastest.taken[0]));
  std::string text = aligned(rows);
  if (!found.left_out.empty())
    text += "not compared (no time, failed, or timed by another machine or build): " + names(found.left_out) + "\n";
  return text + "\n";
}

std::string advice_json(const Result& result) {
  const Advice found = advice(result);
  const auto names = [&](const std::vector<std::size_t>& labels) {
    Json list = Json::array();
    for (const std::size_t a : labels) list.push_back(result.answers[a].label);
    return list;
  };
  const auto told = [&](const Taken& taken) {
    const Summary& is = result.summary[taken.label];
    return Json{{"label", result.answers[taken.label].label},
                {"error", is.error},
                {"false_negative", is.false_negative},
                {"time_mean_ns", is.time_mean_ns},
                {"as_fast", names(taken.equals)}};
  };
  Json json = {{"front", Json::array()}, {"fastest", Json::array()}, {"left_out", names(found.left_out)}};
  for (const Taken& taken : found.front) json["front"].push_back(told(taken));
  for (const Fastest& fastest : found.fastest) {
    Json one = {{"allowed", fastest.allowed}};
    one.update(fastest.taken.empty() ? Json{{"label", nullptr}} : told(fastest.taken[0]));
    json["fastest"].push_back(one);
  }
  return json.dump();
}

}  // namespace pipeline
