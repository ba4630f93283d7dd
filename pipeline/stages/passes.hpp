// The passes stage: how early or late an algorithm first and last reports a body that moves straight through another.
//
// Source: Příbyl 2022, section 5.3, where a capsule steered by hand passes through obstacles. Here samples find the
// steps between which an answer changes for the first and the last time; bisection of the answer itself then finds
// where. A contact or a report that begins and ends between two samples is not seen.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/decision/meet.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/scene/script.hpp"
#include "pipeline/stages/choice.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {

/// How near positions are found, in metres: not further than this before the first or after the last change.
constexpr double kTruthTolerance = 1e-9;
constexpr double kAlgorithmTolerance = 1e-6;

/// The passes with what is true of them. `poses` is S x B, the motion that holds the passes; `truth` belongs to it.
std::vector<PassRow> pass_rows(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                               const Truth& truth, const std::vector<Pass>& passes, Progress& progress);

/// What an algorithm said about them: `answers` are its own at every step of the motion, `choice` says how to ask
/// again. The algorithm first reports at the first sample that it reports, or in the step before; if that is the pass's
/// first sample, there: it may well have reported earlier. Likewise the last.
PassAnswers pass_answers(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                         const Truth& truth, const std::vector<Pass>& passes, const std::vector<PassRow>& rows,
                         const Answers& answers, const AlgorithmChoice& choice, Progress& progress);

/// The same of answers that cannot be asked for again: a change between two samples counts as half way between them.
PassAnswers sampled_pass_answers(const std::vector<Pass>& passes, const Truth& truth, const std::vector<PassRow>& rows,
                                 const Answers& answers);

/// What an algorithm said about the passes through one target.
struct TargetSummary {
  std::uint64_t passes = 0, met = 0;            // how many, and how many of them truly meet
  std::uint64_t missed = 0;                     // truly meet and are never reported
  std::uint64_t false_positives = 0;               // never meet and are reported
  std::uint64_t flicker = 0;                    // over all of them
  double median = 0, earliest = 0, latest = 0;  // of PassAnswers::first, m; NaN when there is none
};
TargetSummary summarise(const std::vector<PassRow>& rows, const PassAnswers& answers, const std::string& target);

/// The targets in the order of their first pass.
std::vector<std::string> targets(const std::vector<PassRow>& rows);

}  // namespace pipeline
