#include "pipeline/run.hpp"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "pipeline/amended.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/product.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/chunks.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/stages/evaluate.hpp"
#include "pipeline/stages/motion.hpp"
#include "pipeline/stages/proxies.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/study/study.hpp"
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

TimingRules timing_of(const Config& config) { return {config.repeats, config.noise, config.pin}; }

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

/// Of extremes every mesh is there without the others, so that each is named.
void warn_of_open_meshes(const Config& config, const Scene& scene) {
  if (scene.case_sets.empty() || config.containment == Containment::ignore) return;
  for (const geometry::Mesh& mesh : scene.bodies.meshes)
    if (const geometry::Solid solid = geometry::solid_of(mesh, config.closed_within); !solid.closed)
      std::fprintf(stderr, "warning: mesh '%s': the surface is open, %s; nothing can be inside it\n", mesh.name.c_str(),
                   geometry::open_text(solid).c_str());
}

/// The motion stage: bodies, poses and, where they are integrated, /physics.
void make_motion(const Config& config, Scene& scene, const Plan& planned, Checkpoint& part, bool quiet,
                 Forecast& forecast, Result& result) {
  Progress progress("motion", std::uint64_t(config.steps), quiet, &forecast);
  if (config.scene_kind->integrated) {
    // Workers see by this that somebody makes it.
    const std::string name = chunk_name("motion", 0);
    std::unique_ptr<Lease> making;
    for (bool said = part.moved(); !part.moved() && !(making = part.claim(name)); wait_a_moment())
      if (!std::exchange(said, true))
        progress.say("the motion is made by " + part.claimant(name) +
                     ", as it seems; waiting for its lease to run out");
    // While the motion is made, how long its answers will take is looked at where that is worth the time.
    std::optional<Looks> looks;
    AfterChunk after_chunk;
    if (const Stage* detecting = forecast.find("detect"); detecting && detecting->seconds() > 5 * kTrial) {
      looks.emplace(scene.bodies, config.algorithms, config.repeats, planned, *detecting);
      after_chunk = [&](const auto& poses) { forecast.improve(looks->look(poses)); };
    }
    try {
      Motion motion = integrate(config, scene, part, progress, after_chunk);
      result.motion = std::move(motion.poses);
      result.products.put(std::move(motion.physics));
    } catch (const Error& error) {
      if (error.code() == kInput) part.remove();  // no run of this configuration can ever finish: nothing stays
      throw;
    }
  } else {
    result.motion = std::move(scene.script);
    progress.add(std::uint64_t(config.steps));
  }
  part.mark_moved();
  result.bodies = std::move(scene.bodies);
  result.first_step = first_steps(result.motion, result.bodies.size());
}

/// Throws Error for a label that is there already, unless forced, or is given twice.
void check_labels(const std::vector<AlgorithmChoice>& choices, const Result& result, const std::string& file,
                  bool force) {
  std::set<std::string> given;
  for (const AlgorithmChoice& choice : choices) {
    if (place_of(choice.label, result) < result.answers.size() && !force)
      throw Error(kFile, file + ": has answers labelled '" + choice.label +
                             "' already; --force replaces them, or give another label with @LABEL");
    if (!given.insert(choice.label).second)
      throw Error(kInput, "--algorithm: the label '" + choice.label + "' is given twice; name another with @LABEL");
  }
}

}  // namespace

// The libraries and the processor are the motion's: Simbody depends on them.
CheckpointKey checkpoint_key(const Config& config, const Provenance& from) {
  return {.config_sha256 = sha256(config.effective),
          .program_sha256 = program_sha256(),
          .inputs_sha256 = sha256(nlohmann::json(config.inputs).dump()),
          .machine_sha256 = sha256(from.library_versions + from.processor)};
}

fs::path output_path(const Config& config, const RunOptions& options) {
  if (!options.output.empty()) return options.output;
  return fs::path("results") / (config.path.stem().string() + ".h5");
}

Result run(const Config& asked, const RunOptions& options) {
  Config config = asked;  // less what is optional and not here
  const auto start = std::chrono::steady_clock::now();
  const fs::path output = output_path(config, options);
  const fs::path part_path = output.string() + ".part";
  refuse_own_input(config, output);
  std::error_code unreadable;
  if (fs::exists(fs::symlink_status(output, unreadable))) Checkpoint::remove_complete(part_path);
  refuse_if_too_large(plan(config), output);
  if (config.study && options.motion_only)
    throw Error(kInput, config.path.string() +
                            ": is a study, which has no motion to be made beforehand; leave "
                            "--motion-only out");
  if (config.study) return run_study(config, options, start);

  Scene scene = make_scene(config);
  warn_of_open_meshes(config, scene);
  const int threads = thread_count(options.threads);
  Plan planned = plan(config, scene, threads);
  refuse_if_too_large(planned, output);
  if (scene.case_sets.empty()) {  // of extremes a refusal is an answer
    for (const std::string& note : leave_out(refuse_unfit(scene.bodies, config.algorithms).silent, config))
      std::fprintf(stderr, "warning: %s\n", note.c_str());
    planned = plan(config, scene, threads);
  }

  Provenance from = provenance();
  OutputFile target(output, options.force ? Existing::replace : Existing::refuse);
  Checkpoint part(part_path, checkpoint_key(config, from), config.title, config.steps, options.force);
  if (part.resumed() && !options.quiet) std::fprintf(stderr, "resuming %s.part\n", output.string().c_str());
  part.describe(config.effective, fs::absolute(config.path));
  Forecast forecast;
  if (!options.quiet && !options.motion_only)
    forecast = Forecast(foreseen_stages(config, scene, planned, threads, kTrial));

  Result result;
  make_motion(config, scene, planned, part, options.quiet, forecast, result);
  if (options.motion_only) return part.keep(), Result();
  give_back();
  {
    Progress progress("truth", result.steps(), options.quiet, &forecast);
    result.truth = decide(result.bodies, result.motion, threads, part, progress, config.containment, config.gap_margin);
  }
  give_back();
  Evaluation found = evaluate({result.bodies, result.motion, result.truth, scene, result.products}, config.algorithms,
                              timing_of(config), &part, options.quiet, forecast);
  give_back();
  result.answers = std::move(found.answers);
  result.summary = std::move(found.summary);
  result.products.join(std::move(found.products));
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
    const Proxies* recorded = result.products.find<Proxies>();
    for (AlgorithmChoice& choice : choices)
      if (!choice.files.empty() && !(recorded && bind_recorded(choice, *recorded)))
        throw Error(kInput, file.string() + ": does not hold what stands for the meshes under the label '" +
                                choice.label + "'; give its files with --algorithm " + choice.name + ":file=...");
  }
  find_files(choices);
  for (const std::string& note : read_proxies(choices, config.closed_within))
    std::fprintf(stderr, "warning: %s\n", one_line(note, 4096).c_str());

  check_labels(choices, result, file.string(), options.force);
  const Scene scene = recorded_scene(result, config, file.string());
  Forecast forecast;
  if (scene.case_sets.empty()) {
    refuse_unfit(result.bodies, choices);
    if (!options.quiet)
      forecast = Forecast(foreseen_stages(result.bodies, result.motion, choices, config.repeats, scene.passes.size(),
                                          plan(result.bodies, result.steps(), choices), kTrial));
  }
  Evaluation found = evaluate({result.bodies, result.motion, result.truth, scene, result.products}, choices,
                              timing_of(config), nullptr, options.quiet, forecast);
  add(std::move(found), result);
  for (const AlgorithmChoice& choice : choices) {
    add_inputs(nlohmann::json(choice.inputs), result);
    if (choice.foreign) add_inputs(nlohmann::json(choice.foreign->files), result);
  }
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
