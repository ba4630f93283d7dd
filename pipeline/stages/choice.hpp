// An algorithm as a run asks it: which, with what knobs, under what name.
#pragma once
#include <string>

#include "algorithms/contract/algorithm.hpp"

namespace pipeline {

/// One [[algorithm]].
struct AlgorithmChoice {
  std::string name;
  std::string label;        // defaults to the name
  algorithms::Knobs knobs;  // all of them, presets filled in
};

/// Knobs as a JSON object, keys sorted.
std::string knobs_json(const algorithms::Knobs& knobs);

}  // namespace pipeline
