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
#include "pipeline/result/products/passes.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/scene/script.hpp"
#include "pipeline/stages/choice.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {

/// The passes with what is true of them. `poses` is S x B, the motion that holds the passes; `truth` belongs to it.
std::vector<PassRow> pass_rows(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                               const Truth& truth, const std::vector<Pass>& passes, Progress& progress);

/// What an algorithm said about them: `answers` are its own at every step of the motion, `choice` says how to ask
/// again. The algorithm first reports at the first sample that it reports, or in the step before; if that is the pass's
/// first sample, there: it may well have reported earlier. Likewise the last. Of a method of others that has failed, or
/// fails at this (which `answers` then say), nothing is known: NaN and 0.
PassAnswers pass_answers(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                         const Truth& truth, const std::vector<Pass>& passes, const std::vector<PassRow>& rows,
                         Answers& answers, const AlgorithmChoice& choice, Progress& progress);

/// The same of answers that cannot be asked for again: a change between two samples counts as half way between them.
PassAnswers sampled_pass_answers(const std::vector<Pass>& passes, const Truth& truth, const std::vector<PassRow>& rows,
                                 const Answers& answers);

}  // namespace pipeline
