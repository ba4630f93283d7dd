// A worker on an unfinished run: fills chunks of truth and answers that nobody holds, beside other workers and beside
// the run itself, on this machine and on others that see the same folder.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/system/lease.hpp"

namespace pipeline {

struct WorkOptions {
  std::filesystem::path config;            // by hand; empty: what the part keeps of its run
  std::vector<std::string> sets, plugins;  // of that
  int threads = 0;                         // of the truth; 0: all cores
  Lease::Seconds lease;
  bool quiet = false;
};

struct WorkDone {
  std::size_t truth = 0, answers = 0;  // chunks made here
  bool assembled = false;              // the result is there already, or about to be
};

/// Works until nothing is missing: it waits for chunks that others hold, since those may die, and for a motion that a
/// run makes. Throws Error: kFile also when the part is of another configuration, build or inputs, has no motion that
/// anybody makes, or becomes another run's.
WorkDone work(const std::filesystem::path& part, const WorkOptions& options);

}  // namespace pipeline
