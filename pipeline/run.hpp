// One run, from a configuration to a file: the only place that connects the stages.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

struct RunOptions {
  std::filesystem::path output;           // empty: results/<config name>.h5 under the current folder
  int threads = 0;                        // of the truth stage; 0: all cores
  bool force = false;                     // replace an existing output, discard another run's part
  bool quiet = false;                     // no progress
  std::vector<std::string> plugins = {};  // libraries of the command line
  bool motion_only = false;               // of a run: only its motion, for workers that fill in the rest
  bool unsealed = false;                  // of an existing file: read it although its seal does not hold
};

std::filesystem::path output_path(const Config& config, const RunOptions& options);

/// What an unfinished run of this configuration, build and machine belongs to.
CheckpointKey checkpoint_key(const Config& config, const Provenance& from);

/// Simulates, decides, detects, scores and stores. Resumes an unfinished run of the same configuration and build, and
/// shares its chunks with workers (pipeline/work.hpp). With options.motion_only it ends when the motion is made, with
/// an empty result. Throws Error.
Result run(const Config& config, const RunOptions& options);

/// Answers and times algorithms on the motion and truth of an existing file, and replaces the file by one that has
/// them. `arguments` are --algorithm arguments; none means those of the file's own configuration. A label that exists
/// is refused without options.force, which replaces its answers. Throws Error.
Result detect_again(const std::filesystem::path& file, const std::vector<std::string>& arguments,
                    const RunOptions& options);

/// One line each: promises broken, an integration that failed. Empty: the run is good.
std::vector<std::string> failures(const Result& result);

}  // namespace pipeline
