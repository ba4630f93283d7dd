// Results and unfinished runs as text for people and as JSON for programs.
#pragma once
#include <string>

#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

/// What is in a result: title, size, summary table, provenance, the digest of all of it; with `digests` those of its
/// groups too.
std::string result_text(const Result& result, bool digests = false);
std::string result_json(const Result& result, const std::string& path);

/// How far an unfinished run is.
std::string checkpoint_text(const CheckpointStatus& status, const std::string& path);
std::string checkpoint_json(const CheckpointStatus& status, const std::string& path);

}  // namespace pipeline
