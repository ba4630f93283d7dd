// The steps of a table: rows of a column `step`, which counts from 0 and leaves none out, or of a column `time`, which
// increases and begins a step whenever it changes. Where both are there, the step counts and the time is checked.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/scene/csv.hpp"

namespace pipeline {

constexpr std::size_t kNoColumn = std::size_t(-1);

/// Which columns say when, by their place in the header.
struct WhenColumns {
  std::size_t step = kNoColumn, time = kNoColumn;
  double time_unit = 1;          // s
  bool time_unit_named = false;  // else seconds are meant

  bool any() const { return step != kNoColumn || time != kNoColumn; }
};

class StepClock {
 public:
  /// `csv` is to outlive it.
  explicit StepClock(const CsvReader& csv) : csv_(csv) {}

  WhenColumns columns;

  /// Of the row: whether it begins a step. Throws Error(kInput) for a step or time that cannot follow.
  bool begins();

  std::int64_t steps() const { return steps_; }
  /// s, of the steps; empty where there is no such column.
  const std::vector<double>& times() const { return times_; }

 private:
  void check_time(double time, bool fresh) const;

  const CsvReader& csv_;
  std::int64_t steps_ = 0;
  std::vector<double> times_;
};

}  // namespace pipeline
