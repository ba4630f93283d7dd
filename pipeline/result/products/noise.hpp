// /noise: the first label timed a second time, under no label of its own: what times of the same differ by.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace pipeline {

struct Noise {
  std::string label;
  double ratio = 0, low = 0, high = 0;  // of its mean to the label's own, with a 95 % interval; NaN: too few steps
  std::vector<std::int64_t> time_ns;    // S
};

}  // namespace pipeline
