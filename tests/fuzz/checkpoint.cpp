// Any bytes as what an unfinished run kept: the first byte says as what. Chunks get a checksum that holds, as only
// somebody gives them who means to: refused (std::logic_error is what the program says of a chunk that is not its
// own), or taken for what a run of this size could have kept.
#include "pipeline/result/checkpoint.hpp"

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "fuzz.hpp"
#include "geometry/meshes/shapes.hpp"
#include "pipeline/config.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/stages/extremes.hpp"
#include "pipeline/stages/motion.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/study/study.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace pipeline;
using fuzz::require;

constexpr std::int64_t kSteps = 3;
const CheckpointKey kKey{"c", "p"};

struct Replayed {
  geometry::Bodies bodies;
  std::vector<std::vector<geometry::Pose>> poses;
};

/// Two boxes, one inside the other at step 0, leaving it, and far.
Replayed replayed() {
  Replayed out;
  out.bodies.meshes = {geometry::box("great", {2, 2, 2}), geometry::box("small", {1, 1, 1})};
  out.bodies.name = {"great", "small"};
  out.bodies.mesh = {0, 1};
  out.bodies.fixed = {0, 0};
  for (const double x : {0.0, 1.0, 1.6})
    out.poses.push_back({geometry::Pose{{1, 0, 0, 0}, {0, 0, 0}}, geometry::Pose{{1, 0, 0, 0}, {x, 0, 0}}});
  return out;
}

void require_lists(const PairLists& lists, std::size_t bodies) {
  require(lists.steps() == kSteps && lists.offset.back() == lists.pair.size(), "one list per step");
  for (std::size_t s = 0; s < lists.steps(); ++s) {
    const auto step = lists.at(s);
    for (std::size_t i = 0; i < step.size(); ++i)
      require(step[i].a < step[i].b && step[i].b < bodies && (i == 0 || step[i - 1] < step[i]), "pairs are sorted");
  }
}

void ask_motion(const Checkpoint& part, Progress& progress) {
  static const Config config =
      parse_config("steps = 3\n[scene]\nkind = \"box\"\n[scene.births]\ncount = 2\n", "a.toml");
  static const Scene scene = make_scene(config);
  const Motion motion = integrate(config, scene, part, progress);
  require(motion.poses.size() == kSteps && motion.physics.rows.size() == kSteps, "every step has its row");
}

void ask_truth(const Checkpoint& part, Progress& progress, const Replayed& scene, bool gaps) {
  const Truth truth = decide(scene.bodies, scene.poses, 1, part, progress, Containment::record,
                             gaps ? std::optional(1.0) : std::nullopt);
  require_lists(truth.hits, scene.bodies.size());
  require_lists(truth.contained, scene.bodies.size());
  require(truth.time_ns.size() == kSteps, "every step has its time");
  require(truth.contained_inside->size() == truth.contained.pair.size(), "of every pair the body inside");
  for (std::size_t i = 0; i < truth.contained.pair.size(); ++i) {
    const std::uint32_t inside = (*truth.contained_inside)[i];
    require(inside == truth.contained.pair[i].a || inside == truth.contained.pair[i].b, "inside is one of the pair");
  }
  if (!gaps) return;
  require_lists(truth.gaps->pairs, scene.bodies.size());
  require(
      truth.gaps->lower.size() == truth.gaps->pairs.pair.size() && truth.gaps->upper.size() == truth.gaps->lower.size(),
      "of every pair its gap");
}

void ask_answers(const Checkpoint& part, Progress& progress, const Replayed& scene) {
  static const Truth truth = [&] {
    Truth out;
    for (int s = 0; s < kSteps; ++s) out.hits.append({});
    return out;
  }();
  const std::vector<AlgorithmChoice> choices = {parse_algorithm("aabb"), parse_algorithm("obb_sat")};
  for (const Answers& answers : detect(scene.bodies, scene.poses, truth, choices, 1, {}, &part, progress)) {
    require_lists(answers.hits, scene.bodies.size());
    require(answers.time_ns.size() == kSteps && answers.operations.size() == kSteps, "every step has its row");
  }
}

void ask_extremes(const Checkpoint& part, Progress& progress, const Replayed& scene) {
  static const Truth truth = [&] {
    Truth out;
    for (int s = 0; s < kSteps; ++s) out.hits.append({});
    return out;
  }();
  const std::vector<CaseSet> sets;
  const std::vector<AlgorithmChoice> choices = {parse_algorithm("aabb")};
  const ExtremesDetected out = detect_extremes(scene.bodies, scene.poses, truth, sets, choices, 1, {}, &part, progress);
  require_lists(out.answers[0].hits, scene.bodies.size());
  require(out.cases[0].reported.size() == kSteps && out.cases[0].failed.size() == kSteps, "every step has its flags");
}

void ask_study(const Checkpoint& part, Progress& progress) {
  static const Study study =
      *parse_config("study = \"integration\"\n[[sweep]]\nname = \"a\"\nproblem = \"drop\"\n", "a.toml").study;
  static const std::vector<StudyRow> cases = {study_cases(study).at(0)};
  require(study_rows(study, cases, 1, part, progress).size() == 1, "every case has its row");
}

void ask_status(const std::filesystem::path& folder) {
  const CheckpointStatus status = checkpoint_status(folder);
  require(status.steps >= 1 && status.motion_steps <= status.steps && status.cases <= status.steps,
          "no more is done than there is");
  Checkpoint(folder, kKey, "title", kSteps, /*force=*/false);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const TemporaryFolder place;
  static const Replayed scene = replayed();
  const char kind = static_cast<char>(data[0]);
  const std::string content(fuzz::text_of(data + 1, size - 1));
  const std::filesystem::path folder = place / "a.h5.part";
  std::filesystem::remove_all(folder);
  Progress progress("", 0, /*quiet=*/true);
  try {
    if (kind == 'j') {
      std::filesystem::create_directory(folder);
      std::ofstream(folder / "manifest.json", std::ios::binary) << content;
      return ask_status(folder), 0;
    }
    const Checkpoint part(folder, kKey, "title", kSteps, /*force=*/true, kind == 'c' ? "study" : "");
    const char* stage = kind == 'm'                  ? "motion"
                        : kind == 't' || kind == 'g' ? "truth"
                        : kind == 'c'                ? "case"
                                                     : "answers";
    part.save(chunk_name(stage, 0), content);
    if (kind == 'm') ask_motion(part, progress);
    if (kind == 't' || kind == 'g') ask_truth(part, progress, scene, kind == 'g');
    if (kind == 'a') ask_answers(part, progress, scene);
    if (kind == 'e') ask_extremes(part, progress, scene);
    if (kind == 'c') ask_study(part, progress);
  } catch (const Error& error) {
    fuzz::require(error.code() == kFile, "an unfinished run is code 4");
    fuzz::require_one_line(error.what());
  } catch (const std::logic_error& error) {
    fuzz::require_one_line(error.what());
  }
  return 0;
}
