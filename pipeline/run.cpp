#include "pipeline/run.hpp"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "pipeline/amended.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/product.hpp"
#include "pipeline/result/products/noise.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/stages/extremes.hpp"
#include "pipeline/stages/interval.hpp"
#include "pipeline/stages/motion.hpp"
#include "pipeline/stages/passes.hpp"
#include "pipeline/stages/summary.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/study/study.hpp"
#include "pipeline/system/pinned.hpp"
#include "pipeline/system/threads.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"
#include "pipeline/terminal/words.hpp"
#include "pipeline/trial.hpp"

namespace pipeline {
namespace fs = std::filesystem;
namespace {

std::vector<std::int64_t> first_steps(const std::vector<std::vector<geometry::Pose>>& poses, std::size_t bodies) {
  std::vector<std::int64_t> first(bodies, -1);
  for (std::size_t step = poses.size(); step-- > 0;)
    for (std::size_t b = 0; b < bodies; ++b)
      if (geometry::is_born(poses[step][b])) first[b] = std::int64_t(step);
  return first;
}

/// What an unfinished run of this configuration, build and machine belongs to. The libraries and the processor belong
/// to the build: Simbody's motion depends on them.
CheckpointKey checkpoint_key(const Config& config, const Provenance& from) {
  return {.config_sha256 = sha256(config.effective),
          .program_sha256 = sha256(program_sha256() + from.library_versions + from.processor),
          .inputs_sha256 = sha256(nlohmann::json(config.inputs).dump())};
}

/// What every result says of itself.
void describe(Result& result, const Config& config, Provenance from, std::chrono::steady_clock::time_point start) {
  result.title = config.title;
  result.config_text = config.text;
  result.config_effective = config.effective;
  result.rate = config.rate;
  result.provenance = std::move(from);
  result.provenance.config_sha256 = sha256(config.text);
  result.provenance.inputs_sha256 = nlohmann::json(config.inputs).dump();
  result.provenance.wall_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The noise floor, from the answers of the first label and of the same once more.
Noise noise_of(const Answers& first, const Answers& again) {
  const Interval ratio = ratio_interval(again.time_ns, first.time_ns);
  return {first.label, ratio.value, ratio.low, ratio.high, again.time_ns};
}

/// What algorithms answer about the motion and truth of `result`, timed as `config` says; of extremes, which have
/// `sets`, also case by case. The noise floor is put into the result, where it is asked for.
ExtremesDetected answered(Result& result, const std::vector<CaseSet>& sets, const std::vector<AlgorithmChoice>& choices,
                          const Config& config, const Checkpoint* part, bool quiet, Forecast& forecast) {
  const Pinned pinned(config.pin);
  Machine here = machine();
  here.pinned = pinned.processor();
  if (config.pin && pinned.processor() < 0)
    std::fprintf(stderr, "warning: there is no processor %lld here, as the configuration has it; timed on any\n",
                 static_cast<long long>(*config.pin));
  else if (config.pin && !quiet)
    std::fprintf(stderr, "timed on processor %lld\n", static_cast<long long>(pinned.processor()));
  Progress progress("detect", result.steps(), quiet, &forecast);
  if (!sets.empty())
    return detect_extremes(result.bodies, result.motion, result.truth, sets, choices, config.repeats, here, part,
                           progress);
  const bool noise = config.noise && !choices.empty();
  std::vector<Answers> answers =
      detect(result.bodies, result.motion, result.truth, choices, config.repeats, here, part, progress, noise);
  if (noise) {
    // A method of others that failed has no times to be compared.
    if (!failed(answers.front()) && !failed(answers.back()))
      result.products.put(noise_of(answers.front(), answers.back()));
    else
      result.products.drop<Noise>();
    answers.pop_back();
  }
  return {std::move(answers), {}};
}

/// Digest, file and its place.
void store(Result& result, OutputFile& target, bool quiet, Forecast& forecast) {
  Progress progress("store", 1, quiet, &forecast, "file");
  write_result(result, target);
  progress.add(1);
}

/// Seconds for a trial of the stages, where somebody looks; little beside what a run takes that is worth it.
constexpr double kTrial = 0.6;

/// A study: cases instead of a scene.
Result run_study(const Config& config, const RunOptions& options, std::chrono::steady_clock::time_point start) {
  const fs::path output = output_path(config, options);
  const fs::path part_path = output.string() + ".part";
  Provenance from = provenance();
  const std::vector<StudyRow> cases = study_cases(*config.study);
  OutputFile target(output, options.force ? Existing::replace : Existing::refuse);
  Checkpoint part(part_path, checkpoint_key(config, from), config.title, std::int64_t(cases.size()), options.force,
                  "study");
  if (part.resumed() && !options.quiet) std::fprintf(stderr, "resuming %s.part\n", output.string().c_str());
  // More would be short of processor, and its budget of wall time could decide.
  const int processes = std::min(thread_count(options.threads), thread_count(0));
  Result result;
  {
    Progress progress("cases", cases.size(), options.quiet, nullptr, "case");
    result.products.put(study_rows(*config.study, cases, processes, part, progress));
  }
  describe(result, config, std::move(from), start);
  part.mark_complete();
  write_result(result, target);
  part.remove();
  return result;
}

/// A run never replaces what it reads, also with --force.
void refuse_own_input(const Config& config, const fs::path& output) {
  std::vector<fs::path> read = {config.path};
  for (const auto& [file, hash] : config.inputs) read.push_back(config.path.parent_path() / file);
  for (const Plugin& plugin : config.plugins) read.push_back(plugin.path);
  for (const fs::path& file : read)
    if (std::error_code none; fs::equivalent(file, output, none))
      throw Error(kFile, output.string() + ": is read by this run; choose another -o");
}

/// What a stage freed goes back to the kernel: the next one has other sizes, and their peaks would add up, since what
/// integrators free is kept while they run (pipeline/physics/simulate.cpp).
void give_back() { malloc_trim(0); }

}  // namespace

fs::path output_path(const Config& config, const RunOptions& options) {
  if (!options.output.empty()) return options.output;
  return fs::path("results") / (config.path.stem().string() + ".h5");
}

Result run(const Config& config, const RunOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const fs::path output = output_path(config, options);
  const fs::path part_path = output.string() + ".part";
  refuse_own_input(config, output);
  std::error_code unreadable;
  if (fs::exists(fs::symlink_status(output, unreadable))) Checkpoint::remove_complete(part_path);
  refuse_if_too_large(plan(config), output);
  if (config.study) return run_study(config, options, start);

  Scene scene = make_scene(config);
  if (!scene.case_sets.empty() && config.containment != Containment::ignore)
    for (const geometry::Mesh& mesh : scene.bodies.meshes)
      if (const geometry::Solid solid = geometry::solid_of(mesh, config.closed_within); !solid.closed)
        std::fprintf(stderr, "warning: mesh '%s': the surface is open, %s; nothing can be inside it\n",
                     mesh.name.c_str(), geometry::open_text(solid).c_str());
  const int threads = thread_count(options.threads);
  const Plan planned = plan(config, scene, threads);
  refuse_if_too_large(planned, output);
  if (scene.case_sets.empty()) refuse_unfit(scene.bodies, config.algorithms);  // of extremes a refusal is an answer

  Provenance from = provenance();
  OutputFile target(output, options.force ? Existing::replace : Existing::refuse);
  Checkpoint part(part_path, checkpoint_key(config, from), config.title, config.steps, options.force);
  if (part.resumed() && !options.quiet) std::fprintf(stderr, "resuming %s.part\n", output.string().c_str());
  Forecast forecast;
  if (!options.quiet) forecast = Forecast(foreseen_stages(config, scene, planned, threads, kTrial));
  const std::uint64_t steps = std::uint64_t(config.steps);

  // While the motion is made, how long its answers will take is looked at where that is worth the time.
  std::optional<Looks> looks;
  AfterChunk after_chunk;
  if (const Stage* detecting = forecast.find("detect");
      detecting && detecting->seconds() > 5 * kTrial && config.scene_kind->integrated) {
    looks.emplace(scene.bodies, config.algorithms, config.repeats, planned, *detecting);
    after_chunk = [&](const auto& poses) { forecast.improve(looks->look(poses)); };
  }
  Result result;
  {
    Progress progress("motion", steps, options.quiet, &forecast);
    if (config.scene_kind->integrated) {
      Motion motion;
      try {
        motion = integrate(config, scene, part, progress, after_chunk);
      } catch (const Error& error) {
        if (error.code() == kInput) part.remove();  // no run of this configuration can ever finish: nothing stays
        throw;
      }
      result.motion = std::move(motion.poses);
      result.products.put(std::move(motion.physics));
    } else {
      result.motion = std::move(scene.script);
      progress.add(steps);
    }
  }
  looks.reset();
  give_back();
  result.bodies = std::move(scene.bodies);
  {
    Progress progress("truth", steps, options.quiet, &forecast);
    result.truth = decide(result.bodies, result.motion, threads, part, progress, config.containment, config.gap_margin);
  }
  give_back();
  if (!scene.case_sets.empty()) {
    Progress progress("cases", steps, options.quiet, &forecast, "case");
    Extremes extremes;
    extremes.rows =
        extreme_rows(result.bodies, result.motion, result.truth, scene.case_sets, std::move(scene.cases), progress);
    result.products.put(std::move(extremes));
  }
  ExtremesDetected found = answered(result, scene.case_sets, config.algorithms, config, &part, options.quiet, forecast);
  result.answers = std::move(found.answers);
  give_back();
  if (Extremes* extremes = result.products.find<Extremes>()) extremes->answers = std::move(found.cases);
  if (!scene.passes.empty()) {
    Progress progress("passes", scene.passes.size() * (1 + result.answers.size()), options.quiet, &forecast, "pass");
    Passes passes;
    passes.rows = pass_rows(result.bodies, result.motion, result.truth, scene.passes, progress);
    for (std::size_t a = 0; a < result.answers.size(); ++a)
      passes.answers.push_back(pass_answers(result.bodies, result.motion, result.truth, scene.passes, passes.rows,
                                            result.answers[a], config.algorithms[a], progress));
    result.products.put(std::move(passes));
  }
  const std::uint64_t pairs = judged_pairs(result);
  for (const Answers& answers : result.answers) result.summary.push_back(summarise(answers, pairs));

  result.first_step = first_steps(result.motion, result.bodies.size());
  make_products(result);
  describe(result, config, std::move(from), start);
  part.mark_complete();
  store(result, target, options.quiet, forecast);
  part.remove();
  return result;
}

Result detect_again(const fs::path& file, const std::vector<std::string>& arguments, const RunOptions& options) {
  add_plugins(options.plugins);
  for (const std::string& argument : arguments) parse_algorithm(argument);  // mistakes are said before the file is read
  Amended amended(file, options.unsealed);
  Result& result = amended.result;
  const Config config = recorded_config(result.config_effective, file.string());
  result.bodies.closed_within = config.closed_within;
  std::vector<AlgorithmChoice> choices;
  for (const std::string& argument : arguments) choices.push_back(parse_algorithm(argument, config.containment));
  if (choices.empty()) {
    choices = config.algorithms;
    for (const std::string& note : config.notes) std::fprintf(stderr, "warning: %s\n", one_line(note, 4096).c_str());
    if (choices.empty())
      throw Error(kInput, file.string() + ": this build has none of its algorithms; name others with --algorithm");
  }
  find_files(choices);

  for (std::size_t i = 0; i < choices.size(); ++i) {
    const std::string& label = choices[i].label;
    if (!options.force) amended.refuse_label(label, "@LABEL");
    for (std::size_t j = 0; j < i; ++j)
      if (choices[j].label == label)
        throw Error(kInput, "--algorithm: the label '" + label + "' is given twice; name another with @LABEL");
  }

  std::vector<CaseSet> sets;
  if (result.products.find<Extremes>()) {
    sets = config.scene_kind->make(config).case_sets;
    if (sets.empty() || std::size_t(sets.back().first_step + sets.back().steps) != result.steps())
      throw Error(kFile, file.string() + ": its cases are not those of its configuration; run again with --force");
  } else {
    refuse_unfit(result.bodies, choices);
  }
  const Passes* passes_before = result.products.find<Passes>();
  Forecast forecast;
  if (!options.quiet && sets.empty()) {
    const Plan planned = plan(result.bodies, result.steps(), choices);
    forecast = Forecast(foreseen_stages(result.bodies, result.motion, choices, config.repeats,
                                        passes_before ? passes_before->rows.size() : 0, planned, kTrial));
  }
  ExtremesDetected found = answered(result, sets, choices, config, nullptr, options.quiet, forecast);
  Products fresh_products;
  if (!sets.empty()) fresh_products.put(Extremes{.rows = {}, .answers = std::move(found.cases)});
  std::vector<Answers>& fresh = found.answers;
  if (passes_before) {
    const std::vector<Pass> passes = amended.passes(config, passes_before->rows);
    Progress progress("passes", passes.size() * fresh.size(), options.quiet, &forecast, "pass");
    Passes said;
    for (std::size_t a = 0; a < fresh.size(); ++a)
      said.answers.push_back(pass_answers(result.bodies, result.motion, result.truth, passes, passes_before->rows,
                                          fresh[a], choices[a], progress));
    fresh_products.put(std::move(said));
  }
  for (std::size_t i = 0; i < fresh.size(); ++i) amended.put(std::move(fresh[i]), fresh_products, i);
  make_products(result);
  for (const AlgorithmChoice& choice : choices)
    if (choice.foreign) amended.add_inputs(nlohmann::json(choice.foreign->files).dump());
  store(result, amended.target, options.quiet, forecast);
  return std::move(result);
}

std::vector<std::string> failures(const Result& result) {
  std::vector<std::string> lines;
  for (const Product& product : products())
    if (product.failure && product.has(result))
      if (const std::string line = product.failure(result); !line.empty()) lines.push_back(line);
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    const Answers& answers = result.answers[a];
    const Summary& row = result.summary[a];
    if (failed(answers))
      lines.push_back(answers.label + " failed after " + std::to_string(answers.foreign->steps_done) + " of " +
                      std::to_string(result.steps()) + " steps: " + answers.foreign->reason);
    if (row.promise_kept) continue;
    std::string line = answers.label + " breaks its promise (" + answers.promise + "): ";
    line += std::to_string(row.false_negative) + " false negatives";
    if (answers.promise == "exact") line += " and " + std::to_string(row.false_positive) + " false positives";
    lines.push_back(line);
  }
  return lines;
}

}  // namespace pipeline
