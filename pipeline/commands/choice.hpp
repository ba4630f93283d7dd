// Which label of a result should be taken: the least error for a time, the least time for an error.
//
// Only labels that one machine and build timed are compared: those of the one that timed the most. Of two labels no
// difference in time is told when the interval of their ratio (stages/interval.hpp) holds 1 or lies within the noise
// floor of the file: they are equals, and said so.
#pragma once
#include <string>
#include <vector>

#include "pipeline/result/result.hpp"

namespace pipeline {

/// A label, by its number, and those that are as good.
struct Taken {
  std::size_t label = 0;
  std::vector<std::size_t> equals;
};

/// The fastest label that is allowed.
struct Fastest {
  std::string allowed;       // in words
  double most_error = 1;     // allowed
  bool misses = true;        // whether false negatives are allowed
  std::vector<Taken> taken;  // one, or none when no label is allowed
};

struct Advice {
  /// The Pareto front of mean time and error, the fastest first: from the mean time of each on, it errs least. Its
  /// equals are as fast and err as much.
  std::vector<Taken> front;
  std::vector<Fastest> fastest;
  std::vector<std::size_t> left_out;  // labels without a time, that failed, or that another machine or build timed
};

Advice advice(const Result& result);

/// The advice as tables; empty where fewer than two labels compare.
std::string advice_text(const Result& result);

/// The advice as JSON.
std::string advice_json(const Result& result);

}  // namespace pipeline
