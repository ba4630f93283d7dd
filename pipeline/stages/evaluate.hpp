// The one way in which algorithms are asked and judged, in a run and in answers that are added later.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/choice.hpp"
#include "pipeline/system/pinned.hpp"
#include "pipeline/terminal/forecast.hpp"

namespace pipeline {

/// What algorithms are asked about: where bodies are and what is true of them.
struct Question {
  const geometry::Bodies& bodies;
  const std::vector<std::vector<geometry::Pose>>& poses;  // S x B
  const Truth& truth;
  const Scene& scene;     // of which passes and cases of extremes, where it has some
  const Products& known;  // with what is true of those, where that was found before
};

/// How answers are timed.
struct TimingRules {
  std::int64_t repeats = 3;
  bool noise = false;                    // the first label is timed a second time: the product Noise
  std::optional<std::int64_t> pin = {};  // the one processor that is used; one that is not there is said, and not used
};

/// What they said, each in the order of the choices.
struct Evaluation {
  std::vector<Answers> answers;
  std::vector<Summary> summary;
  Products products;  // with what is true of passes and cases unless it was known
};

/// This machine as it is while `pinned` holds; said, where that was asked for.
Machine machine_of(const Pinned& pinned, const std::optional<std::int64_t>& pin, bool quiet);

/// Asks, times and judges. Chunks that `part` holds are taken from it; it may be null.
Evaluation evaluate(const Question& question, const std::vector<AlgorithmChoice>& choices, const TimingRules& timing,
                    const Checkpoint* part, bool quiet, Forecast& forecast);

}  // namespace pipeline
