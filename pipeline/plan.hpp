// What a run would be, and how large: `pipeline check`, and the refusal of what does not fit.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "pipeline/config.hpp"

namespace pipeline {

/// Bytes are estimates from above for what grows with the configuration.
struct Plan {
  std::uint64_t bodies = 0, meshes = 0, triangles = 0, pairs = 0, passes = 0, case_sets = 0;
  std::uint64_t cases = 0;  // of a study, which has nothing of the above
  std::uint64_t file_bytes = 0, memory_bytes = 0;
};
Plan plan(const Config& config);

/// Throws Error(kInput) when the plan does not fit this machine's memory or the disk at `output`.
void refuse_if_too_large(const Plan& plan, const std::filesystem::path& output);

std::string plan_text(const Config& config, const Plan& plan, const std::string& output);
std::string plan_json(const Config& config, const Plan& plan, const std::string& output);

}  // namespace pipeline
