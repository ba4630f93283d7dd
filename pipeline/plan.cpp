#include "pipeline/plan.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pipeline/error.hpp"
#include "pipeline/part.hpp"
#include "pipeline/passes.hpp"
#include "pipeline/print.hpp"
#include "pipeline/provenance.hpp"
#include "pipeline/scene.hpp"
#include "pipeline/store.hpp"
#include "pipeline/study.hpp"
#include "pipeline/threads.hpp"
#include "pipeline/truth.hpp"

namespace pipeline {
namespace {

using Json = nlohmann::ordered_json;

std::string mebibytes_text(std::uint64_t bytes) {
  return bytes < (1u << 30) ? print("%.1f MiB", double(bytes) / (1 << 20))
                            : print("%.1f GiB", double(bytes) / (1 << 30));
}

std::string bytes_text(std::uint64_t bytes) {
  return bytes < (1u << 20) ? print("%.0f KiB", double(bytes) / 1024) : mebibytes_text(bytes);
}

}  // namespace

Plan plan(const Config& config) {
  if (config.study) {
    constexpr std::uint64_t kCaseBytes = 1024, kNames = 1 << 16;  // of a row with its texts; of attributes and names
    const std::uint64_t cases = study_cases(*config.study).size();
    Plan plan;
    plan.cases = cases;
    plan.file_bytes = kNames + cases * kCaseBytes;
    plan.memory_bytes = 4 * cases * kCaseBytes;
    return plan;
  }
  const SceneSize size = config.scene_kind->size(config);
  Plan plan{.bodies = size.bodies, .meshes = size.meshes, .triangles = size.mesh_triangles};
  plan.pairs = size.pairs.value_or(size.bodies * (size.bodies - 1) / 2);
  plan.passes = size.passes;
  plan.case_sets = size.case_sets;
  const std::uint64_t steps = std::uint64_t(config.steps), algorithms = config.algorithms.size();
  const std::uint64_t mesh_bytes = 24 * size.mesh_vertices + 12 * size.mesh_triangles;
  plan.file_bytes = estimated_bytes(steps, size.bodies, algorithms, mesh_bytes);
  if (plan.case_sets > 0) {  // two bodies a step make lists; of the others there are only poses
    constexpr std::uint64_t kPose = 7 * 8, kRow = 80, kFlags = 5;
    plan.file_bytes =
        estimated_bytes(steps, 2, algorithms, mesh_bytes) + steps * (size.bodies * kPose + kRow + kFlags * algorithms);
  }
  // Gaps: about as many pairs as an algorithm reports, each with two reals.
  if (config.gap_margin) plan.file_bytes += steps * (4 * size.bodies * 24 + 8);
  // In memory: the result and, while it is written, once more its datasets; of every distinct mesh the hierarchies and
  // sampled facets (about 200 bytes a triangle) of the truth and of each algorithm. Gaps: on every thread the world
  // vertices (24 bytes) and boxes (48 bytes, up to four a vertex) of all bodies.
  plan.memory_bytes = 2 * plan.file_bytes + (1 + algorithms) * 200 * size.mesh_triangles;
  if (config.gap_margin) {
    const std::uint64_t chunks = (steps + kChunkSteps - 1) / kChunkSteps;
    plan.memory_bytes += std::min(std::uint64_t(thread_count(0)), chunks) * (24 + 4 * 48) * size.body_vertices;
  }
  if (plan.case_sets > 0) plan.memory_bytes += plan.file_bytes;  // nearly all is motion, there once more for a moment
  return plan;
}

void refuse_if_too_large(const Plan& plan, const std::filesystem::path& output) {
  if (plan.memory_bytes > machine_memory())
    throw Error(kInput, "the run needs about " + mebibytes_text(plan.memory_bytes) + " of memory, this machine has " +
                            mebibytes_text(machine_memory()) + "; fewer steps, bodies or segments make it smaller");
  // Twice: the part and the file exist together for a moment.
  if (2 * plan.file_bytes > free_disk(output))
    throw Error(kInput, output.string() + ": the run needs about " + mebibytes_text(2 * plan.file_bytes) +
                            " of disk, there is " + mebibytes_text(free_disk(output)) +
                            " free; choose another -o or fewer steps");
}

std::string plan_text(const Config& config, const Plan& plan, const std::string& output) {
  if (config.study) {
    const Study& study = *config.study;
    std::string text = config.title + "\n";
    for (const Sweep& s : study.sweeps)
      text += "sweep       " + s.name + ": " + s.problem + print(", %zu integrators\n", s.integrators.size());
    text += print("cases       %llu%s, each in a process of its own\n", static_cast<unsigned long long>(plan.cases),
                  study.every > 1 ? print(", one of every %lld", static_cast<long long>(study.every)).c_str() : "");
    text += print("budget      %lld force evaluations and %g s of processor time for each case\n",
                  static_cast<long long>(study.force_evaluations), study.processor_time);
    return text + "output      " + output + ", about " + bytes_text(plan.file_bytes) + "\n";
  }
  std::string text = config.title + "\n";
  text += "scene       " + config.scene_kind->name;
  text += print(": %llu bodies, %llu pairs a step, %llu distinct meshes with %llu triangles\n",
                static_cast<unsigned long long>(plan.bodies), static_cast<unsigned long long>(plan.pairs),
                static_cast<unsigned long long>(plan.meshes), static_cast<unsigned long long>(plan.triangles));
  text += "motion      ";
  text += config.scene_kind->integrated ? config.physics.integrator + print(" at accuracy %g", config.physics.accuracy)
                                        : "scripted, no integrator is built and no /physics written";
  text += print(", %lld steps at %g per second\n", static_cast<long long>(config.steps), config.rate);
  if (config.scene_kind->integrated) {
    const Physics& p = config.physics;
    const bool gravity = p.gravity != std::array<double, 3>{},
               damping = p.linear_damping != 0 || p.angular_damping != 0;
    text += std::string("            ") + (gravity ? "gravity" : "no gravity force is made") + ", " +
            (damping ? "damping" : "no damping") + "\n";
  }
  if (plan.passes > 0)
    text += print("passes      %llu, early or late found by bisection: truth to %g m, algorithms to %g m\n",
                  static_cast<unsigned long long>(plan.passes), kTruthTolerance, kAlgorithmTolerance);
  if (plan.case_sets > 0)
    text += print("cases       %llu sets of gaps, each answered as two bodies alone, in both orders and moved\n",
                  static_cast<unsigned long long>(plan.case_sets));
  text += "truth       exact, by surface; ";
  switch (config.containment) {
    case Containment::ignore:
      text += "containment is not asked for, so it is not computed\n";
      break;
    case Containment::record:
      text += "bodies wholly inside others are listed, and hits on them counted apart\n";
      break;
    case Containment::meet:
      text += "bodies wholly inside others are listed and count as meeting\n";
      break;
  }
  text += "gaps        ";
  text += config.gap_margin
              ? print("a lower and an upper bound on the distance of pairs within %g m that do not meet\n",
                      *config.gap_margin)
              : "not asked for, so no distance is computed\n";
  const bool facets = std::ranges::any_of(config.algorithms, [](const AlgorithmChoice& choice) {
    return choice.knobs.contains("densify") ||
           (choice.knobs.contains("prefilter") &&
            std::get<std::string>(choice.knobs.at("prefilter")).starts_with("facet_"));
  });
  if (!facets) text += "facets      no chosen algorithm samples them, so no facet points are computed\n";
  for (const auto& [file, hash] : config.inputs) text += "input       " + file + "\n";
  for (const AlgorithmChoice& choice : config.algorithms)
    text += "algorithm   " + choice.label + (choice.label == choice.name ? "" : " = " + choice.name) + " " +
            knobs_json(choice.knobs) + "\n";
  text += print("timing      %lld repeats\n", static_cast<long long>(config.repeats));
  text += "output      " + output + ", at most about " + bytes_text(plan.file_bytes) + "; memory about " +
          bytes_text(plan.memory_bytes) + "\n";
  return text;
}

std::string plan_json(const Config& config, const Plan& plan, const std::string& output) {
  if (config.study)
    return dumped(Json{{"title", config.title},
                       {"study", "integration"},
                       {"cases", plan.cases},
                       {"output", output},
                       {"file_bytes", plan.file_bytes},
                       {"memory_bytes", plan.memory_bytes},
                       {"effective", config.effective}});
  Json json = {{"title", config.title},         {"scene", config.scene_kind->name},
               {"steps", config.steps},         {"rate", config.rate},
               {"bodies", plan.bodies},         {"pairs", plan.pairs},
               {"meshes", plan.meshes},         {"triangles", plan.triangles},
               {"repeats", config.repeats},     {"output", output},
               {"file_bytes", plan.file_bytes}, {"memory_bytes", plan.memory_bytes}};
  if (plan.passes > 0) json["passes"] = plan.passes;
  if (plan.case_sets > 0) json["case_sets"] = plan.case_sets;
  json["containment"] = text_of(config.containment);
  if (config.gap_margin) json["gap_margin"] = *config.gap_margin;
  json["inputs_sha256"] = config.inputs;
  if (config.scene_kind->integrated)
    json["physics"] = {{"integrator", config.physics.integrator}, {"accuracy", config.physics.accuracy}};
  json["algorithms"] = Json::array();
  for (const AlgorithmChoice& choice : config.algorithms)
    json["algorithms"].push_back(
        {{"label", choice.label}, {"name", choice.name}, {"knobs", Json::parse(knobs_json(choice.knobs))}});
  json["effective"] = config.effective;
  return dumped(json);
}

}  // namespace pipeline
