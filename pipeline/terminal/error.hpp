// The user's errors, and the exit codes of the program.
#pragma once
#include <stdexcept>
#include <string>

namespace pipeline {

/// What the program ends with (README, "Exit codes").
enum ExitCode : int {
  kDone = 0,
  kFailed = 1,  // the run failed, the score or the check differs
  kUsage = 2,   // the command line's grammar
  kInput = 3,   // what the user wrote: configuration, meshes, CSV, --set, --algorithm; too large for this machine
  kFile = 4,    // result and baseline files
  kInterrupted = 130
};

/// One line for the user: place, value, rule, remedy. Thrown where the knowledge is, caught once in main.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& line) : std::runtime_error(line), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace pipeline
