// The cases of a scene of extremes: what is true of them, and what algorithms say besides their answer.
//
// At every step two bodies are there and no other. Each set of steps is answered as a run of its own of two bodies, so
// that an algorithm that refuses a mesh, or throws, loses the steps of that mesh and nothing else: it becomes data.
#pragma once
#include <cstdint>
#include <memory>
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

/// Asks every algorithm of `choices` about every case of a chunk of steps, in any order of chunks. A method of others
/// stays for all cases of its two bodies, as to start it takes longer than its answers. Single-threaded.
class ExtremesDetector {
 public:
  /// All must outlive it. `poses` is S x B.
  ExtremesDetector(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                   const std::vector<CaseSet>& sets, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats);
  ~ExtremesDetector();

  /// Answers of no steps, in the order of the choices.
  std::vector<Answers> none() const;

  /// The bytes of the chunk from step `first` up to `last`; of `truth` those steps are looked at.
  std::string make(const Truth& truth, std::int64_t first, std::int64_t last, const Machine& machine,
                   Progress& progress);

  struct Stretch;

 private:
  struct Foreign;

  std::uint8_t answer(const Stretch& range, const CaseSet& set, std::size_t choice, const Machine& machine,
                      Answers& answers, ExtremeAnswers& cases);
  void answer_all(const Stretch& range, const CaseSet& set, std::size_t choice, const Machine& machine,
                  Answers& answers, ExtremeAnswers& cases);

  const geometry::Bodies& bodies_;
  const std::vector<std::vector<geometry::Pose>>& poses_;
  const std::vector<CaseSet>& sets_;
  const std::vector<AlgorithmChoice>& choices_;
  std::int64_t repeats_;
  std::vector<std::unique_ptr<Foreign>> foreign_;  // A; null where none is there
};

/// Asks every algorithm of `choices` about every case: as detect does, then in the other order, and moved. A NaN on an
/// algorithm's way shows in its answers only: the processor's flags do not tell, SLEEF raises them for an asin(0).
/// Single-threaded. Chunks that `part` holds are taken from it; `part` may be null.
ExtremesDetected detect_extremes(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                                 const Truth& truth, const std::vector<CaseSet>& sets,
                                 const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
                                 const Machine& machine, const Checkpoint* part, Progress& progress);

}  // namespace pipeline
