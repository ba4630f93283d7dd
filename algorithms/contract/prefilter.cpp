#include "algorithms/contract/prefilter.hpp"

namespace algorithms {

Knob prefilter_knob() {
  return {.name = "prefilter",
          .preset = "rotated_aabb",
          .unit = "1",
          .what = "the pair goes on only if this algorithm, with its presets, reports it",
          .choices = {"none"},  // and the pairwise rows, which `all` adds
          .role = Role::prefilter};
}

std::string with_prefilter(std::string_view unit) { return std::string(unit) + ", and the prefilter's operations"; }

std::unique_ptr<Method> make_prefilter(const Bodies& bodies, const Knobs& knobs) {
  const auto& name = value_of<std::string>(knobs, "prefilter");
  if (name == "none") return nullptr;
  const Algorithm* algorithm = find(name);
  if (!algorithm) throw std::invalid_argument("no algorithm '" + name + "' to filter with");
  return algorithm->make(bodies, presets(*algorithm));
}

Memory prefilter_memory(const Bodies& bodies, const Knobs& knobs) {
  const Algorithm* algorithm = find(value_of<std::string>(knobs, "prefilter"));
  return algorithm ? memory(*algorithm, bodies, presets(*algorithm)) : Memory{};
}

}  // namespace algorithms
