// What is left of a run while it goes on, from what was foreseen of its stages.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pipeline {

/// One stage of a run: seconds foreseen for all items (steps, cases, passes) before each, and for all; #items + 1.
struct Stage {
  std::string name;
  std::vector<double> until;

  double seconds() const { return until.back(); }
};

/// What is left of a run while it goes on. The rest is
///
///     k * (foreseen for the rest of the present stage) + busy * (foreseen for the stages after it),
///
/// where k = (A + w P) / (D + w P) tells how wrong the forecast has been: D seconds were foreseen for what was done of
/// the stage, A were taken, and w P = 3 % of the whole stage keeps k still until something is known. D and A fade with
/// what is done, by 1/e in three tenths of the stage, so that k follows the recent rate: a lively half that is slower
/// than foreseen is noticed while it lasts. Forecasts are of processor time; `busy`, at least 1, is how much longer the
/// present stage takes by the clock, since others want the processor too. Stages that nothing is foreseen for count
/// their items alike.
class Forecast {
 public:
  Forecast() = default;
  explicit Forecast(std::vector<Stage> stages) : stages_(std::move(stages)) {}

  /// A stage of that many items begins.
  void begin(const std::string& stage, std::uint64_t items);

  /// That many items more are done, which took that many seconds; not `fresh`: they were taken over and took none.
  /// `busy` 0: not known yet, as it was.
  void done(std::uint64_t items, double seconds, bool fresh, double busy = 0);

  /// The stage of that name as it is foreseen, or null.
  const Stage* find(const std::string& stage) const;

  /// Foresees the stage of that name anew, when it has as many items.
  void improve(const Stage& stage);

  /// Seconds left of the run; of the stage alone where nothing is foreseen; nothing before anything is known.
  std::optional<double> left() const;

  /// Whether stages after the present one are counted.
  bool whole() const { return known_; }

 private:
  double foreseen(std::uint64_t item) const;

  std::vector<Stage> stages_;
  std::size_t present_ = 0;  // in stages_
  bool known_ = false;       // the present stage is one of them
  std::uint64_t items_ = 0, done_ = 0;
  double expected_ = 0, actual_ = 0;  // fading
  double busy_ = 1;
};

}  // namespace pipeline
