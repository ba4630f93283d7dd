#include "pipeline/stages/evaluate.hpp"

#include "pipeline/result/provenance.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/stages/extremes.hpp"
#include "pipeline/stages/passes.hpp"
#include "pipeline/stages/summary.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {
namespace {

/// Of extremes every case is answered by itself, besides as everywhere.
Evaluation of_cases(const Question& question, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
                    const Checkpoint* part, bool quiet, Forecast& forecast) {
  const auto& [bodies, poses, truth, scene, known] = question;
  Extremes extremes;
  if (!known.find<Extremes>()) {
    Progress progress("cases", poses.size(), quiet, &forecast, "case");
    extremes.rows = extreme_rows(bodies, poses, truth, scene.case_sets, scene.cases, progress);
  }
  Progress progress("detect", poses.size(), quiet, &forecast);
  ExtremesDetected found =
      detect_extremes(bodies, poses, truth, scene.case_sets, choices, repeats, machine(), part, progress);
  Evaluation out;
  out.answers = std::move(found.answers);
  extremes.answers = std::move(found.cases);
  out.products.put(std::move(extremes));
  return out;
}

Passes of_passes(const Question& question, const std::vector<AlgorithmChoice>& choices, std::vector<Answers>& answers,
                 bool quiet, Forecast& forecast) {
  const auto& [bodies, poses, truth, scene, known] = question;
  const Passes* before = known.find<Passes>();
  Progress progress("passes", scene.passes.size() * ((before ? 0 : 1) + answers.size()), quiet, &forecast, "pass");
  Passes out;
  if (!before) out.rows = pass_rows(bodies, poses, truth, scene.passes, progress);
  for (std::size_t a = 0; a < answers.size(); ++a)
    out.answers.push_back(pass_answers(bodies, poses, truth, scene.passes, before ? before->rows : out.rows, answers[a],
                                       choices[a], progress));
  return out;
}

}  // namespace

Evaluation evaluate(const Question& question, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
                    const Checkpoint* part, bool quiet, Forecast& forecast) {
  const auto& [bodies, poses, truth, scene, known] = question;
  Evaluation out;
  if (!scene.case_sets.empty()) {
    out = of_cases(question, choices, repeats, part, quiet, forecast);
  } else {
    Progress progress("detect", poses.size(), quiet, &forecast);
    out.answers = detect(bodies, poses, truth, choices, repeats, machine(), part, progress);
  }
  if (!scene.passes.empty() || known.find<Passes>())
    out.products.put(of_passes(question, choices, out.answers, quiet, forecast));
  const std::uint64_t pairs = judged_pairs(bodies, poses, truth);
  for (const Answers& answers : out.answers) out.summary.push_back(summarise(answers, pairs));
  return out;
}

}  // namespace pipeline
