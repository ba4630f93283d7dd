// Steps as a command line names them: A:B is A and what follows up to, not including, B, as in Python.
#pragma once
#include <cstdint>
#include <string>

namespace pipeline {

struct StepRange {
  std::uint64_t first = 0, last = 0;  // not including last
  std::uint64_t size() const { return last - first; }
};

/// Reads "A:B", "A:", ":B" or ":" for a file of `steps`. Throws Error(kUsage) for another form, Error(kInput)
/// when the range is empty or goes beyond the file.
StepRange step_range(const std::string& text, std::uint64_t steps, const std::string& file);

/// What is wrong with the form of the text, "must be A:B, ..."; empty when nothing is. Before a file is read.
std::string step_range_flaw(const std::string& text);

}  // namespace pipeline
