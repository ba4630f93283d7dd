// The detect stage: asks every algorithm about every pair of every step, and times it.
#pragma once
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/stages/choice.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {

/// No memory was left while a label was set up or answered: names it and what it takes.
struct OutOfMemory : Error {
  OutOfMemory(const AlgorithmChoice& choice, const geometry::Bodies& bodies);
};

/// What methods of others say before a run, by label.
struct Heard {
  std::map<std::string, About> abouts;
  std::map<std::string, std::string> silent;  // why, of optional ones that do not say hello
};

/// Throws Error(kInput) when the knobs of a choice do not fit these meshes, for instance a density of facets that needs
/// billions of them: said before the run rather than after the motion. So are methods of others that do not even say
/// hello, to which each is started and ended, unless they are optional.
Heard refuse_unfit(const geometry::Bodies& bodies, const std::vector<AlgorithmChoice>& choices);

/// Throws std::logic_error that names the first of `hits` that is no pair of `runs` or is there twice: a mistake of
/// the method that would be scored as false positives. Both sorted.
void check_hits(std::span<const geometry::Pair> hits, std::span<const geometry::PairRun> runs);

/// Adds a step's answer, sorted pairs that were asked about, and its score to `out`.
void judge(std::span<const geometry::Pair> hits, const Truth& truth, std::size_t step, Answers& out);

/// Asks every algorithm of `choices`, chunk by chunk of steps, in any order: all memories are emptied before each.
/// Single-threaded.
class Detector {
 public:
  /// All must outlive it. With `noise` the first algorithm is asked a second time, as if it were the last of all.
  Detector(const geometry::Bodies& bodies, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
           bool noise);
  ~Detector();

  /// Answers of no steps, in the order of the choices: one more with `noise`.
  std::vector<Answers> none() const;

  /// The bytes of the chunk from step `first` on, whose poses and truth these are. Chunks of `part` before it, which
  /// may be null, tell which methods of others have failed: those are asked no more.
  std::string make(std::int64_t first, std::span<const std::vector<geometry::Pose>> poses, const Truth& truth,
                   const Machine& machine, const Checkpoint* part, Progress& progress);

  /// Adds the steps of a chunk.
  void append(const std::string& bytes, std::size_t steps, std::vector<Answers>& all) const;

 private:
  struct Asked;
  std::unique_ptr<Asked> asked_;
};

/// Answers, operations, times and scores of every algorithm of `choices`, in their order. Single-threaded.
///
/// Per step and algorithm one pass counts operations, untimed; then `repeats` passes are timed by a monotonic clock
/// around prepare and answer, memory being reserved before. The order of the algorithms is reversed at every other
/// step. What an algorithm remembers of the steps before is the same in all passes of a step, and is emptied before
/// every chunk of kChunkSteps, so that repeating and resuming change nothing. Chunks that `part` holds are taken from
/// it, those that others make are waited for; `part` may be null. With `noise` the first algorithm is asked and timed a
/// second time, as if it were the last of all: one Answers more, at the end.
///
/// What a method of others does is data (Answers::foreign): one that fails at a step is ended, and answers nothing at
/// that step and at those after it. Its times are its own, and bounded by those of the exchange. Before its first step
/// counts, that step is asked some times, so that engines have compiled what they run.
std::vector<Answers> detect(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                            const Truth& truth, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
                            const Machine& machine, const Checkpoint* part, Progress& progress, bool noise = false);

}  // namespace pipeline
