// The cases of a scene of extremes: what is true of them, and what algorithms say besides their answer.
//
// At every step two bodies are there and no other. Each set of steps is answered as a run of its own of two bodies, so
// that an algorithm that refuses a mesh, or throws, loses the steps of that mesh and nothing else: it becomes data.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/bodies.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/products/extremes.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/scene/script.hpp"
#include "pipeline/stages/choice.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {

/// `cases` with what is true of them: truth, truth_moved and near_touching. `poses` is S x B.
std::vector<ExtremeCase> extreme_rows(const geometry::Bodies& bodies,
                                      const std::vector<std::vector<geometry::Pose>>& poses, const Truth& truth,
                                      const std::vector<CaseSet>& sets, std::vector<ExtremeCase> cases,
                                      Progress& progress);

/// Answers of the algorithms, and what else they said.
struct ExtremesDetected {
  std::vector<Answers> answers;       // A, as detect gives them; where an algorithm failed, nothing is reported
  std::vector<ExtremeAnswers> cases;  // A
};

/// The bytes of the chunk of answers from step `first` up to `last`; of `truth` those steps are looked at.
std::string make_extremes(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                          const Truth& truth, const std::vector<CaseSet>& sets,
                          const std::vector<AlgorithmChoice>& choices, std::int64_t repeats, const Machine& machine,
                          std::int64_t first, std::int64_t last, Progress& progress);

/// Asks every algorithm of `choices` about every case: as detect does, then in the other order, and moved. A NaN on an
/// algorithm's way shows in its answers only: the processor's flags do not tell, SLEEF raises them for an asin(0).
/// Single-threaded. Chunks that `part` holds are taken from it; `part` may be null.
ExtremesDetected detect_extremes(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                                 const Truth& truth, const std::vector<CaseSet>& sets,
                                 const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
                                 const Machine& machine, const Checkpoint* part, Progress& progress);

}  // namespace pipeline
