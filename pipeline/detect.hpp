// The detect stage: asks every algorithm about every pair of every step, and times it.
#pragma once
#include <memory>
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/part.hpp"
#include "pipeline/progress.hpp"
#include "pipeline/result.hpp"

namespace pipeline {

/// Answers, operations, times and scores of every algorithm of `choices`, in their order. Single-threaded.
///
/// Per step and algorithm one pass counts operations, untimed; then `repeats` passes are timed by a monotonic clock
/// around prepare and answer, memory being reserved before. The order of the algorithms is reversed at every other step.
/// Chunks that `part` holds are taken from it; `part` may be null.
std::vector<Answers> detect(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                            const Truth& truth, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
                            const Machine& machine, const Part* part, Progress& progress);

}  // namespace pipeline
