#include "pipeline/stages/evaluate.hpp"

#include <cstdio>

#include "pipeline/result/products/noise.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/stages/extremes.hpp"
#include "pipeline/stages/interval.hpp"
#include "pipeline/stages/passes.hpp"
#include "pipeline/stages/proxies.hpp"
#include "pipeline/stages/summary.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {
namespace {

/// Of extremes every case is answered by itself, besides as everywhere.
Evaluation of_cases(const Question& question, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
                    const Machine& machine, const Checkpoint* part, bool quiet, Forecast& forecast) {
  const auto& [bodies, poses, truth, scene, known] = question;
  Extremes extremes;
  if (!known.find<Extremes>()) {
    Progress progress("cases", poses.size(), quiet, &forecast, "case");
    extremes.rows = extreme_rows(bodies, poses, truth, scene.case_sets, scene.cases, progress);
  }
  Progress progress("detect", poses.size(), quiet, &forecast);
  ExtremesDetected found =
      detect_extremes(bodies, poses, truth, scene.case_sets, choices, repeats, machine, part, progress);
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

/// From the answers of the first label and of the same once more; none where a method of others failed.
std::optional<Noise> noise_of(const Answers& first, const Answers& again) {
  if (failed(first) || failed(again)) return std::nullopt;
  const Interval ratio = ratio_interval(again.time_ns, first.time_ns);
  return Noise{first.label, ratio.value, ratio.low, ratio.high, again.time_ns};
}

}  // namespace

Machine machine_of(const Pinned& pinned, const std::optional<std::int64_t>& pin, bool quiet) {
  Machine here = machine();
  here.pinned = pinned.processor();
  if (pin && here.pinned < 0)
    std::fprintf(stderr, "warning: there is no processor %lld here, as the configuration has it; timed on any\n",
                 static_cast<long long>(*pin));
  else if (pin && !quiet)
    std::fprintf(stderr, "timed on processor %lld\n", static_cast<long long>(here.pinned));
  return here;
}

Evaluation evaluate(const Question& question, const std::vector<AlgorithmChoice>& choices, const TimingRules& timing,
                    const Checkpoint* part, bool quiet, Forecast& forecast) {
  const auto& [bodies, poses, truth, scene, known] = question;
  Evaluation out;
  {
    const Pinned pinned(timing.pin);
    const Machine here = machine_of(pinned, timing.pin, quiet);
    if (!scene.case_sets.empty()) {
      out = of_cases(question, choices, timing.repeats, here, part, quiet, forecast);
    } else {
      const bool noise = timing.noise && !choices.empty();
      Progress progress("detect", poses.size(), quiet, &forecast);
      out.answers = detect(bodies, poses, truth, choices, timing.repeats, here, part, progress, noise);
      if (noise) {
        if (auto floor = noise_of(out.answers.front(), out.answers.back())) out.products.put(std::move(*floor));
        out.answers.pop_back();
      }
    }
  }
  if (!scene.passes.empty() || known.find<Passes>())
    out.products.put(of_passes(question, choices, out.answers, quiet, forecast));
  if (Proxies proxies = proxies_of(bodies, choices); !proxies.rows.empty()) out.products.put(std::move(proxies));
  const std::uint64_t pairs = judged_pairs(bodies, poses, truth);
  for (const Answers& answers : out.answers) out.summary.push_back(summarise(answers, pairs));
  return out;
}

}  // namespace pipeline
