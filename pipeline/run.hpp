// One run, from a configuration to a file: the only place that connects the stages.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/result.hpp"

namespace pipeline {

struct RunOptions {
  std::filesystem::path output;  // empty: results/<config name>.h5 under the current folder
  int threads = 0;               // of the truth stage; 0: all cores
  bool force = false;            // replace an existing output, discard another run's part
  bool quiet = false;            // no progress
};

/// What a run would be, and how large. Bytes are estimates from above for what grows with the configuration.
struct Plan {
  std::uint64_t bodies = 0, meshes = 0, triangles = 0, pairs = 0, passes = 0, case_sets = 0;
  std::uint64_t cases = 0;  // of a study, which has nothing of the above
  std::uint64_t file_bytes = 0, memory_bytes = 0;
};
Plan plan(const Config& config);

std::filesystem::path output_path(const Config& config, const RunOptions& options);

/// Throws Error(kInput) when the plan does not fit this machine's memory or the disk at `output`.
void refuse_if_too_large(const Plan& plan, const std::filesystem::path& output);

/// Simulates, decides, detects, scores and stores. Resumes an unfinished run of the same configuration and build.
/// Throws Error.
Result run(const Config& config, const RunOptions& options);

/// Answers and times algorithms on the motion and truth of an existing file, and replaces the file by one that has them.
/// `arguments` are --algorithm arguments; none means those of the file's own configuration. A label that exists is
/// refused without options.force, which replaces its answers. Throws Error.
Result detect_again(const std::filesystem::path& file, const std::vector<std::string>& arguments,
                    const RunOptions& options);

/// One line each: promises broken, an integration that failed. Empty: the run is good.
std::vector<std::string> failures(const Result& result);

}  // namespace pipeline
