// The command line (README, "Command line").
#pragma once

namespace pipeline {

/// Runs the program and returns its exit code. Results go to stdout; progress, warnings and errors to stderr.
int command_line(int argc, const char* const* argv);

}  // namespace pipeline
