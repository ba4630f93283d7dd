// /machines: which machine decided and timed which chunk of steps, of a run that several worked on.
#pragma once
#include <string>
#include <vector>

#include "pipeline/result/result.hpp"

namespace pipeline {

/// The processors that a label was timed on, each with its steps and their mean time: in the order of the chunks.
struct TimesOf {
  std::string processor;
  std::vector<std::string> hosts;  // each once
  std::size_t steps = 0;
  double mean_ns = 0;
};
std::vector<TimesOf> times_by_processor(const Answers& answers);

}  // namespace pipeline
