// What a run would be, and how large: `pipeline check`, and the refusal of what does not fit.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/result/product.hpp"

namespace pipeline {

struct Scene;
struct Seconds;

/// What a label's method takes.
struct LabelPlan {
  std::string label;
  algorithms::Memory memory;
};

/// Bytes are estimates, meant to be right within a factor of 1.5: tests/commands/test_estimates.py runs and compares.
struct Plan {
  std::uint64_t bodies = 0, meshes = 0, triangles = 0, pairs = 0;
  OrderedJson asked = OrderedJson::object();  // of products, as their rows read it (pipeline/result/product.hpp)
  std::uint64_t file_bytes = 0, memory_bytes = 0;
  std::uint64_t result_bytes = 0;      // of the result in memory: what is written, before deflate
  std::vector<LabelPlan> labels = {};  // of the algorithms, in their order; of extremes what two bodies take at most
  std::map<std::string, About> abouts =
      {};                  // by label, what methods of others say of themselves, where they were asked
  double alone_bytes = 0;  // of extremes: what all methods together take of two bodies, the mean over meshes
  double restarts = 0;     // of the integrator

  /// How many passes, case_sets, cases of a study, …
  std::uint64_t count(const char* key) const { return asked.value(key, std::uint64_t{0}); }
};

/// Of the scene, once it is made. `threads` of the truth stage. Throws Error(kInput) that names the label whose knobs
/// do not fit the meshes.
Plan plan(const Config& config, const Scene& scene, int threads);

/// Of algorithms that are added to a motion that is there: their labels and the result's bytes.
Plan plan(const geometry::Bodies& bodies, std::uint64_t steps, const std::vector<AlgorithmChoice>& choices);

/// By sizes alone, before a scene is made that may not fit either: methods are counted for extremes only.
Plan plan(const Config& config);

/// Throws Error(kInput) when the plan does not fit this machine's memory or the disk at `output`.
void refuse_if_too_large(const Plan& plan, const std::filesystem::path& output);

/// `time` is what a run would take.
std::string plan_text(const Config& config, const Plan& plan, const Seconds& time, const std::string& output);
std::string plan_json(const Config& config, const Plan& plan, const Seconds& time, const std::string& output);

}  // namespace pipeline
