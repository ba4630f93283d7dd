// The truth stage: which bodies meet, exactly, at every step (geometry/decision/meet.hpp says what that means), and
// which lie wholly inside others (geometry/decision/contain.hpp); where asked, how far apart near pairs are
// (geometry/decision/gap.hpp).
#pragma once
#include <memory>
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

/// How the truth is asked for.
struct TruthRules {
  Containment containment = Containment::ignore;
  std::optional<double> gap_margin = {};  // m; with it the gaps of pairs within it are found too, outside time_ns
};

/// The truth by chunks of steps, in any order and on any thread.
class TruthChunks {
 public:
  /// `bodies` must outlive it. Throws Error(kInput) when containment counts and every mesh is open.
  TruthChunks(const geometry::Bodies& bodies, const TruthRules& rules);
  ~TruthChunks();

  /// The bytes of a chunk whose poses these are.
  std::string make(std::span<const std::vector<geometry::Pose>> poses, Progress& progress);

  /// A truth of no steps.
  Truth none() const;

  /// Adds the steps of a chunk.
  void append(const std::string& bytes, std::size_t steps, Truth& truth) const;

 private:
  struct Deciding;
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

/// Decides every step of the motion on `threads` threads, each taking ranges of steps; the answers do not depend on how
/// many. Chunks that `part` holds are taken from it, those that others make are waited for. `poses` is S x B. Throws as
/// TruthChunks.
Truth decide(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses, int threads,
             const Checkpoint& part, Progress& progress, Containment containment = Containment::ignore,
             std::optional<double> gap_margin = {});

}  // namespace pipeline
