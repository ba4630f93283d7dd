#include "pipeline/scene/answers_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <compare>
#include <unordered_map>
#include <utility>

#include "pipeline/scene/csv.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

std::size_t step_of(const CsvReader& csv, std::size_t steps) {
  const std::uint64_t step = csv.integer(0);
  if (step >= steps)
    csv.fail("step " + std::to_string(step) + " is beyond the last of the result, " + std::to_string(steps - 1) +
             "; steps count from 0");
  return std::size_t(step);
}

/// A row, to be put in order.
struct Row {
  std::size_t step;
  Pair pair;
  std::size_t line;
  std::strong_ordering operator<=>(const Row&) const = default;
};

class AnswersReader {
 public:
  AnswersReader(std::string_view text, const std::string& file, const geometry::Bodies& bodies,
                const std::vector<std::vector<geometry::Pose>>& poses)
      : csv_(text, file, {"step", "a", "b"}), bodies_(bodies), poses_(poses) {
    for (std::uint32_t b = 0; b < bodies.size(); ++b) number_.emplace(bodies.name[b], b);
  }

  std::vector<Row> read() {
    std::vector<Row> rows;
    while (csv_.next()) {
      const std::size_t step = step_of(csv_, poses_.size());
      Pair pair{body(1), body(2)};
      refuse_unasked(step, pair);
      if (pair.a > pair.b) std::swap(pair.a, pair.b);
      rows.push_back({step, pair, csv_.line()});
    }
    return rows;
  }

 private:
  std::string name(std::uint32_t body) const { return quoted(bodies_.name[body]); }

  std::uint32_t body(std::size_t column) const {
    const std::string_view text = csv_[column];
    const auto named = number_.find(std::string(text));
    std::uint32_t number = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_number = error == std::errc() && stop == text.data() + text.size();
    if (named == number_.end()) {
      if (is_number && number < bodies_.size()) return number;
      const std::string meant = nearest(text, bodies_.name);
      csv_.fail("there is no body " + quoted(text) + " in the result; " +
                (meant.empty() ? "give names of /body, or numbers from 0 to " + std::to_string(bodies_.size() - 1)
                               : "did you mean " + quoted(meant) + "?"));
    }
    if (is_number && number < bodies_.size() && number != named->second)
      csv_.fail(quoted(text) + " is the name of body " + std::to_string(named->second) +
                " and the number of another; give all bodies by name, and rename those that have a number for one");
    return named->second;
  }

  /// As geometry::pair_runs has it.
  void refuse_unasked(std::size_t step, const Pair& pair) const {
    const auto [a, b] = pair;
    if (a == b) csv_.fail("pairs body " + name(a) + " with itself; name two bodies");
    const std::string never = "bodies " + name(a) + " and " + name(b);
    if (bodies_.fixed[a] && bodies_.fixed[b])
      csv_.fail(never + " are both fixed, and no method is asked about such a pair; leave the row out");
    if (!bodies_.chosen.empty() && !bodies_.chosen[a] && !bodies_.chosen[b])
      csv_.fail(never + " are not among the chosen of the scene, and no method is asked about them; leave the row out");
    for (const std::uint32_t body : {a, b})
      if (!geometry::is_born(poses_[step][body]))
        csv_.fail("body " + name(body) + " is not there at step " + std::to_string(step) + "; leave the row out");
  }

  CsvReader csv_;
  const geometry::Bodies& bodies_;
  const std::vector<std::vector<geometry::Pose>>& poses_;
  std::unordered_map<std::string, std::uint32_t> number_;
};

}  // namespace

PairLists parse_answers(std::string_view text, const std::string& file, const geometry::Bodies& bodies,
                        const std::vector<std::vector<geometry::Pose>>& poses) {
  std::vector<Row> rows = AnswersReader(text, file, bodies, poses).read();
  std::ranges::sort(rows);
  PairLists out;
  std::vector<Pair> pairs;
  auto row = rows.begin();
  for (std::size_t step = 0; step < poses.size(); ++step) {
    pairs.clear();
    for (; row != rows.end() && row->step == step; ++row) {
      if (!pairs.empty() && pairs.back() == row->pair)
        throw Error(kInput, file + ":" + std::to_string(row->line) + ": the pair of bodies " +
                                quoted(bodies.name[row->pair.a]) + " and " + quoted(bodies.name[row->pair.b]) +
                                " is there a second time at step " + std::to_string(step) + ", first in line " +
                                std::to_string((row - 1)->line) + "; give it once, whichever body is first");
      pairs.push_back(row->pair);
    }
    out.append(pairs);
  }
  return out;
}

std::vector<std::int64_t> parse_times(std::string_view text, const std::string& file, std::size_t steps) {
  constexpr double kMostNs = 1e15;  // eleven days for a step
  constexpr char kRule[] = "a time in ns above 0 and at most 1e15";
  CsvReader csv(text, file, {"step", "ns"});
  std::vector<std::int64_t> times(steps, 0);
  std::vector<std::size_t> line(steps, 0);
  while (csv.next()) {
    const std::size_t step = step_of(csv, steps);
    if (line[step] > 0)
      csv.fail("a second time of step " + std::to_string(step) + ", first in line " + std::to_string(line[step]) +
               "; give one for every step");
    line[step] = csv.line();
    times[step] = std::llround(csv.real(1, kMostNs, kRule));
    if (times[step] <= 0) csv.fail("ns must be " + std::string(kRule) + ", not " + quoted(csv[1]));
  }
  for (std::size_t step = 0; step < steps; ++step)
    if (line[step] == 0)
      csv.fail("step " + std::to_string(step) + " has no time; give one for each of the " + std::to_string(steps) +
               " steps");
  return times;
}

}  // namespace pipeline
