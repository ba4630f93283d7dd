// The truth stage: which bodies meet, exactly, at every step (geometry/meet.hpp says what that means).
#pragma once
#include <vector>

#include "pipeline/part.hpp"
#include "pipeline/progress.hpp"
#include "pipeline/result.hpp"

namespace pipeline {

/// Decides every step of the motion on `threads` threads, each taking ranges of steps; the answers do not depend on how
/// many. Chunks that `part` holds are taken from it. `poses` is S x B.
Truth decide(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses, int threads,
             const Part& part, Progress& progress);

}  // namespace pipeline
