#include "pipeline/work.hpp"

#include <cstdio>
#include <optional>
#include <string_view>
#include <utility>

#include "pipeline/config.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/run.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/chunks.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/stages/evaluate.hpp"
#include "pipeline/stages/extremes.hpp"
#include "pipeline/stages/motion.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/system/threads.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kPart = ".part";

/// FILE of FILE.part.
fs::path result_of(const fs::path& part) {
  const std::string name = part.has_filename() ? part.string() : part.parent_path().string();
  return name.ends_with(kPart) ? name.substr(0, name.size() - kPart.size()) : name;
}

bool is_assembled(const fs::path& part) {
  std::error_code none;
  return !fs::exists(part, none) && fs::is_regular_file(result_of(part), none);
}

/// Less what is optional and not here, as the run's.
Config config_of(const Checkpoint& part, const fs::path& folder, const WorkOptions& options) {
  const auto kept = part.description();
  if (options.config.empty() && !kept)
    throw Error(kFile, folder.string() +
                           ": does not say what is run (no readable configuration in it); the same "
                           "`pipeline run` mends it");
  Config config = options.config.empty() ? kept_config(kept->configuration, kept->from, folder.string())
                                         : read_config(options.config, options.sets, options.plugins);
  if (config.study) throw Error(kInput, options.config.string() + ": is a study, which has no chunks to share");
  const Scene scene = make_scene(config);
  if (scene.case_sets.empty())
    for (const std::string& note : leave_out(refuse_unfit(scene.bodies, config.algorithms).silent, config))
      std::fprintf(stderr, "warning: %s\n", note.c_str());
  part.require(checkpoint_key(config, provenance()), options.config.empty()
                                                         ? "what " + kept->from.string() + " and this program make"
                                                         : options.config.string());
  return config;
}

/// Fills what can be filled, in turns.
class Worker {
 public:
  Worker(const Checkpoint& part, const fs::path& folder, const Config& config, const WorkOptions& options)
      : part_(part),
        folder_(folder),
        config_(config),
        scene_(make_scene(config)),
        truths_(scene_.bodies, {config.containment, config.gap_margin}),
        detector_(scene_.bodies, config.algorithms, config.repeats, config.noise),
        case_detector_(scene_.bodies, scene_.script, scene_.case_sets, config.algorithms, config.repeats),
        progress_("work", 2 * std::uint64_t(config.steps), options.quiet),
        quiet_(options.quiet),
        truth_there_(chunk_count(config.steps)),
        answers_there_(truth_there_.size()) {
    truth_ = {.name = "truth",
              .steps = config.steps,
              .threads = thread_count(options.threads),
              .make = [this](ChunkSteps at) { return truths_.make(poses(at), progress_); },
              .ready = [this](std::size_t chunk) { return has_poses(config_, part_, first_of(chunk)); }};
    answers_ = {.name = "answers",
                .steps = config.steps,
                .make = [this](ChunkSteps at) { return answer(at); },
                .ready = [this](std::size_t chunk) { return truth_there_[chunk] != 0; }};
  }

  WorkDone until_complete() {
    for (;;) {
      refuse_another();
      if (part_.state() == Checkpoint::State::complete) return after_the_run();
      const Look truth = look_after(truth_, part_, truth_there_, progress_);
      done_.truth += truth.made;
      const Look answers =
          look_after(answers_, part_, answers_there_, progress_, 1);  // then truth again, if there is more
      done_.answers += answers.made;
      if (truth.missing + answers.missing == 0) return done_;
      if (truth.made + answers.made > 0) continue;
      refuse_orphan();
      say_once(!truth.held.empty() ? truth.held : answers.held);
      wait_a_moment();
    }
  }

  void refuse_another() const {
    if (part_.state() == Checkpoint::State::another)
      throw Error(kFile, folder_.string() +
                             ": is another run's by now (its own was begun anew with --force); "
                             "work on that");
  }

  /// The run has ended: its part is gone, or about to be.
  WorkDone after_the_run() const {
    if (!is_assembled(folder_) && !fs::exists(folder_))
      throw Error(kFile, folder_.string() + ": is gone, and there is no " + result_of(folder_).string());
    WorkDone done = done_;
    done.assembled = true;
    return done;
  }

 private:
  std::int64_t first_of(std::size_t chunk) const { return steps_of_chunk(chunk, config_.steps).first; }

  std::vector<std::vector<geometry::Pose>> poses(ChunkSteps at) const {
    if (auto found = kept_poses(config_, scene_, part_, at.first)) return std::move(*found);
    throw Error(kFile, folder_.string() + ": lacks the motion from step " + std::to_string(at.first) +
                           " on; the same `pipeline run` makes it again");
  }

  std::string answer(ChunkSteps at) {
    Truth truth = truths_.none();
    const bool cases = !scene_.case_sets.empty();
    for (std::int64_t step = 0; cases && step < at.first; ++step) {  // those of extremes go by the run's own steps
      truth.hits.append({});
      if (truth.lists_contained()) truth.contained.append({});
    }
    const std::string name = chunk_name("truth", at.first);
    const auto bytes = part_.load(name);
    if (!bytes) throw Error(kFile, (folder_ / name).string() + ": is gone or damaged; work again");
    truths_.append(*bytes, at.count(), truth);
    const Pinned pinned(config_.pin);
    const Machine here = machine_of(pinned, config_.pin, std::exchange(quiet_, true));
    if (cases) return case_detector_.make(truth, at.first, at.last, here, progress_);
    return detector_.make(at.first, poses(at), truth, here, &part_, progress_);
  }

  /// Nothing is to be done, and nobody makes what would be.
  void refuse_orphan() {
    const std::string name = chunk_name("motion", 0);
    if (part_.moved() || !config_.scene_kind->integrated || part_.claimed(name)) {
      orphan_ = 0;
      return;
    }
    constexpr int kLooks = 6;  // of half a second: a run may be about to begin
    if (++orphan_ < kLooks || part_.state() != Checkpoint::State::open) return;
    throw Error(kFile, folder_.string() +
                           ": its motion is not finished and no run is making it; `pipeline run CONFIG` "
                           "does, or with --motion-only nothing else");
  }

  void say_once(const std::string& held) {
    if (std::exchange(said_, true)) return;
    progress_.say(held.empty() ? "waiting for the motion"
                               : held + " is made by " + part_.claimant(held) + "; waiting, as it may die");
  }

  const Checkpoint& part_;
  const fs::path& folder_;
  const Config& config_;
  Scene scene_;
  TruthChunks truths_;
  Detector detector_;
  ExtremesDetector case_detector_;  // in place of it where there are cases
  Progress progress_;
  bool quiet_, said_ = false;
  int orphan_ = 0;
  std::vector<char> truth_there_, answers_there_;
  ChunkStage truth_, answers_;
  WorkDone done_;
};

}  // namespace

WorkDone work(const fs::path& folder, const WorkOptions& options) {
  if (is_assembled(folder)) return {.assembled = true};
  const Checkpoint part(folder, options.lease);
  if (part.state() == Checkpoint::State::complete) return {.assembled = true};
  const Config config = config_of(part, folder, options);
  Worker worker(part, folder, config, options);
  try {
    return worker.until_complete();
  } catch (const Error& error) {
    if (error.code() != kFile || part.state() == Checkpoint::State::open) throw;
    worker.refuse_another();  // whatever went wrong, it went wrong because the run has ended or is another
    return worker.after_the_run();
  }
}

}  // namespace pipeline
