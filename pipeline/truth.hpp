// The truth stage: which bodies meet, exactly, at every step (geometry/meet.hpp says what that means), and which lie
// wholly inside others (geometry/contain.hpp); where asked, how far apart near pairs are (geometry/gap.hpp).
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/contain.hpp"
#include "pipeline/part.hpp"
#include "pipeline/progress.hpp"
#include "pipeline/result.hpp"

namespace pipeline {

/// Decides every step of the motion on `threads` threads, each taking ranges of steps; the answers do not depend on how
/// many. Chunks that `part` holds are taken from it. `poses` is S x B. Throws Error(kInput) when containment counts and
/// every mesh is open. With `gap_margin` (m) the gaps of pairs within it are found too; their time
/// is no part of time_ns.
Truth decide(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses, int threads,
             const Part& part, Progress& progress, Containment containment = Containment::ignore,
             std::optional<double> gap_margin = {});

/// The pairs of `from` that are not among `these`; all sorted.
std::vector<Pair> without(std::span<const Pair> from, std::span<const Pair> these);

/// What is wrong when containment counts and every mesh is open; `mesh` and `solid` are those of the first.
std::string all_open_text(const std::string& mesh, const geometry::Solid& solid);

/// Containment as configurations and files spell it.
std::string_view text_of(Containment containment);
std::optional<Containment> containment_of(std::string_view text);

}  // namespace pipeline
