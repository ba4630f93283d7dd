// Steps as a command line names them: A:B is A and what follows up to, not including, B, as in Python.
#pragma once
#include <cstdint>
#include <string>

namespace pipeline {

struct StepRange {
  std::uint64_t first = 0, last = 0;  // not including last
  std::uint64_t size() const { return last - first; }
};

/// Reads "A:B", "A:", ":B" or ":" for a file of so many steps. Throws Error(kUsage) for another form, Error(kInput)
/// when the range is empty or goes beyond the file.
StepRange step_range(const std::string& text, std::uint64_t steps, const std::string& file);

/// Throws Error(kUsage) when the text has not that form; before a file is read.
void check_step_range(const std::string& text);

}  // namespace pipeline
