// The truth stage: which bodies meet, exactly, at every step (geometry/decision/meet.hpp says what that means), and
// which lie wholly inside others (geometry/decision/contain.hpp); where asked, how far apart near pairs are
// (geometry/decision/gap.hpp).
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/decision/contain.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {

/// Decides every step of the motion on `threads` threads, each taking ranges of steps; the answers do not depend on how
/// many. Chunks that `part` holds are taken from it. `poses` is S x B. Throws Error(kInput) when containment counts and
/// every mesh is open. With `gap_margin` (m) the gaps of pairs within it are found too; their time
/// is no part of time_ns.
Truth decide(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses, int threads,
             const Checkpoint& part, Progress& progress, Containment containment = Containment::ignore,
             std::optional<double> gap_margin = {});

}  // namespace pipeline
