#include "pipeline/plan.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "geometry/decision/bvh.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/study/study.hpp"
#include "pipeline/system/threads.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/words.hpp"
#include "pipeline/trial.hpp"

namespace pipeline {
namespace {

using Json = nlohmann::ordered_json;

// ---- What runs were measured to take --------------------------------------------------------------------------------
//
// Bytes of the files of configs/ (and of smaller ones) by their datasets, h5py's get_storage_size; of memory by
// VmHWM. What the fits leave over is below a quarter for those; a motion that never comes to rest, or hits in far
// greater numbers than one a body, make more of it.

constexpr double kMiB = 1 << 20;
constexpr double kProgram = 28 * kMiB, kHdf5 = 8 * kMiB;  // program and libraries; more of them once HDF5 writes
constexpr double kImage = 16 * kMiB;                      // HDF5's file in memory grows by so much at a time
constexpr double kParts = 8 * kMiB;                       // of the motion, while it is written
constexpr double kFreeBody = 4 * 1024;                    // in integration, a body; in a multibody tree
constexpr double kTreeBody = 16 * 1024;
constexpr double kContactSphere = 500;  // of a body that has several: itself, in integration, and those near it
constexpr double kGrown = 1.5;          // a vector that grew, on average

constexpr double kObject = 1900;                // a group or dataset with its attributes
constexpr double kName = 150;                   // a body's names
constexpr double kChanged = 6.6, kKept = 0.09;  // a coordinate that changed since the step before, or did not
constexpr double kChangedRow = 4;               // a step at which any did
constexpr double kStep = 4;                     // a step's truth and time
constexpr double kAnswer = 10, kScripted = 4;   // a step of an algorithm: times, operations, counts
constexpr double kHit = 0.33;                   // a reported pair
constexpr double kMeshes = 0.4;                 // of a mesh larger than a few KiB, else all of it
constexpr double kHeaped = 2.7;                 // pairs more a solid in a heap and step: heap.toml and cup.toml

/// What the poses of a run are: coordinates that change from a step to the next, steps at which any do, bodies that
/// are there, and pairs that a method reports, over all steps. Those are about as many as bodies that move are there,
/// and more of solids in a heap: each has more neighbours, and boxes and balls about it have more than it has.
struct Poses {
  double changed = 0, rows = 0, moving = 0, heaped = 0;

  double pairs() const { return moving + kHeaped * heaped; }
};

/// Foreseen: those to whom something happened change all seven, others that are there fall: one.
Poses foreseen_poses(const Config& config, const SceneSize& size) {
  Poses out{.rows = double(config.steps)};
  const double steps = double(config.steps);
  double lively = 0;
  bool born_later = false;
  for (const Ahead& event : config.scene_kind->ahead(config)) {
    born_later = born_later || event.times > 1;
    for (std::uint64_t t = 0; t < event.before(steps); ++t) {
      lively += double(event.bodies) * (steps - event.step(t));
      if (size.contact_spheres > 0)
        out.heaped += double(event.bodies) * std::max(0.0, steps - event.step(t) - event.lasts / 2);
    }
  }
  out.moving = born_later ? lively : double(size.bodies) * steps;
  // Without friction nothing begins to turn, and the quaternion stays.
  const Material& material = config.physics.material;
  const bool turns = material.static_friction > 0 || material.dynamic_friction > 0 || material.viscous_friction > 0;
  out.changed = (turns ? 7 : 3) * lively + (out.moving - lively);
  return out;
}

/// Of a script they are counted.
Poses counted_poses(const std::vector<std::vector<geometry::Pose>>& script, const geometry::Bodies& bodies) {
  Poses out;
  for (std::size_t s = 0; s < script.size(); ++s) {
    const double before = out.changed;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const geometry::Pose& pose = script[s][b];
      if (!geometry::is_born(pose)) continue;
      out.moving += bodies.fixed[b] ? 0 : 1;
      if (s == 0) continue;
      const geometry::Pose& last = script[s - 1][b];
      for (int i = 0; i < 3; ++i) out.changed += pose.t[i] != last.t[i];
      out.changed += (pose.q.w != last.q.w) + (pose.q.x != last.q.x) + (pose.q.y != last.q.y) + (pose.q.z != last.q.z);
    }
    out.rows += out.changed > before;
  }
  return out;
}

double motion_values(const Config& config, const Plan& plan) {
  return 7.0 * double(config.steps) * double(plan.bodies);
}

Cost cost_of_products(const Plan& plan, const Extent& extent) {
  Cost all;
  for (const Product& product : products()) {
    if (!product.cost) continue;
    const Cost cost = product.cost(plan.asked, extent);
    all.objects += cost.objects;
    all.bytes += cost.bytes;
  }
  return all;
}

double file_bytes(const Config& config, const SceneSize& size, const Plan& plan, const Poses& poses) {
  const double steps = double(config.steps), labels = double(config.algorithms.size());
  const bool integrated = config.scene_kind->integrated;
  const Extent extent{.steps = steps, .labels = labels, .moving = poses.moving};
  const Cost products = cost_of_products(plan, extent);
  const double objects = 50 + 4 * labels + 7 * double(plan.meshes) + products.objects;
  double bytes = kObject * objects + kName * double(plan.bodies) + 2 * double(config.text.size());
  bytes += kChanged * poses.changed + kChangedRow * poses.rows + kKept * (motion_values(config, plan) - poses.changed);
  bytes += steps * kStep + steps * labels * (integrated ? kAnswer : kScripted);
  bytes += kHit * poses.moving * (1 + labels);
  const double meshes = 24 * double(size.mesh_vertices) + 12 * double(size.mesh_triangles);
  bytes += meshes > 8192 * double(plan.meshes) ? kMeshes * meshes : meshes;
  return bytes + products.bytes;
}

/// The greatest of what the stages need, one after the other.
double memory_bytes(const Config& config, const SceneSize& size, const Plan& plan, const Poses& poses, int threads) {
  const double steps = double(config.steps), labels = double(config.algorithms.size());
  const double motion = steps * (double(plan.bodies) * sizeof(geometry::Pose) + 40);
  const double meshes = 24 * double(size.mesh_vertices) + 12 * double(size.mesh_triangles);
  double result = kProgram + meshes + motion;

  const double moving = config.scene_kind->integrated ? double(plan.bodies) : 0;
  const double spheres = kContactSphere * double(size.contact_spheres);
  const double placing = kProgram + meshes + double(size.placing_bytes);
  // The states of a chunk's samples, and the chunk as it is kept; their poses come after them.
  const double chunk = std::min(steps, double(kChunkSteps));
  const double integrating = result - motion * chunk / steps + 2 * chunk * double(sizeof(BodyState)) * moving +
                             (config.physics.bodies == BodyModel::tree ? kTreeBody : kFreeBody) * moving + spheres;
  result += steps * (config.scene_kind->integrated ? sizeof(PhysicsSample) : 0) + 32 * steps + 12 * poses.pairs();

  const double chunks = std::ceil(steps / double(kChunkSteps));
  double hierarchies = 0;
  hierarchies += double(geometry::bvh_bytes(size.mesh_triangles));
  double deciding = result + hierarchies + std::min(double(threads), chunks) * 400 * double(plan.bodies);
  // On every thread the world vertices (24 bytes) and boxes (48 bytes, up to four a vertex) of all bodies.
  if (config.gap_margin) deciding += std::min(double(threads), chunks) * (24 + 4 * 48) * double(size.body_vertices);

  // Gaps, about a pair a body with its two reals, are there twice while the chunks are joined.
  if (config.gap_margin) result += 2 * kGrown * (sizeof(geometry::Pair) + 2 * sizeof(double)) * poses.moving;
  result += labels * steps * 80 + kGrown * sizeof(geometry::Pair) * poses.pairs() * labels;
  double held = 0, methods = 0;  // set up one after another; of extremes one is there at a time
  for (const LabelPlan& label : plan.labels) {
    methods = std::max(methods, held + double(label.memory.greatest));
    if (!plan.count("case_sets")) held += double(label.memory.held);
  }
  methods = std::max(methods, held);
  // A chunk of answers while it is written: it grows as a text.
  methods +=
      2 * std::min(steps, double(kChunkSteps)) / steps * labels * (sizeof(geometry::Pair) * poses.pairs() + 80 * steps);

  // Beside the result the columns, the file's image and a part of the motion at a time, as read from the result and as
  // HDF5 takes it.
  const double columns = labels * steps * 88 + (plan.count("case_sets") ? steps * (100 + 3 * labels) : 0);
  const double file = double(plan.file_bytes);
  const double writing = result + kHdf5 + columns + kImage * std::ceil(file / kImage + 0.01) + std::min(motion, kParts);
  return std::max({placing, integrating, deciding, result + methods, writing});
}

algorithms::Memory memory_of(const AlgorithmChoice& choice, const geometry::Bodies& bodies) {
  return algorithms::memory(row_of(choice), bodies, choice.knobs);
}

std::vector<LabelPlan> labels_of(const geometry::Bodies& bodies, const std::vector<AlgorithmChoice>& choices) {
  std::vector<LabelPlan> out;
  for (const AlgorithmChoice& choice : choices) {
    try {
      out.push_back({choice.label, memory_of(choice, bodies)});
    } catch (const std::invalid_argument& error) {
      throw Error(kInput, whose(choice) + error.what());
    }
  }
  return out;
}

/// What methods take of two bodies alone. One that refuses the second mesh has taken what the first needs.
void count_alone(const Config& config, const std::vector<geometry::Bodies>& pairs, Plan& plan) {
  for (const AlgorithmChoice& choice : config.algorithms) {
    LabelPlan label{choice.label, {}};
    const auto take = [&](const geometry::Bodies& bodies) {
      const algorithms::Memory memory = memory_of(choice, bodies);
      label.memory.held = std::max(label.memory.held, memory.held);
      label.memory.greatest = std::max(label.memory.greatest, memory.greatest);
      plan.alone_bytes += double(memory.greatest) / double(pairs.size());
    };
    for (const geometry::Bodies& two : pairs) {
      try {
        take(two);
      } catch (const std::invalid_argument&) {
        try {
          take({.meshes = {two.meshes[0]}, .name = {"a"}, .mesh = {0}, .fixed = {0}, .chosen = {}});
        } catch (const std::invalid_argument&) {
        }
      }
    }
    plan.labels.push_back(std::move(label));
  }
}

Plan sizes(const Config& config, const SceneSize& size) {
  Plan plan{.bodies = size.bodies, .meshes = size.meshes, .triangles = size.mesh_triangles};
  plan.pairs = size.pairs.value_or(size.bodies * (size.bodies - 1) / 2);
  for (const auto& [key, count] : size.asked) plan.asked[key] = count;
  if (config.gap_margin) plan.asked["gap_margin"] = *config.gap_margin;
  if (config.scene_kind->integrated)
    plan.asked["physics"] = {{"integrator", config.physics.integrator}, {"accuracy", config.physics.accuracy}};
  plan.restarts = double((config.steps + kChunkSteps - 1) / kChunkSteps);
  if (config.scene_kind->events)
    for (const Ahead& event : config.scene_kind->ahead(config))
      if (event.bodies > 0) plan.restarts += double(event.every > 0 ? event.before(double(config.steps)) : 1);
  return plan;
}

void add_bytes(const Config& config, const SceneSize& size, const Poses& poses, int threads, Plan& plan) {
  const double labels = double(config.algorithms.size());
  plan.result_bytes =
      std::uint64_t(8 * motion_values(config, plan) + double(config.steps) * labels * 96 + 8 * poses.pairs() * labels);
  plan.file_bytes = std::uint64_t(file_bytes(config, size, plan, poses));
  plan.memory_bytes = std::uint64_t(memory_bytes(config, size, plan, poses, threads));
}

}  // namespace

Plan plan(const Config& config) {
  if (config.study) {
    const Study& study = *config.study;
    const std::uint64_t cases = study_cases(study).size();
    Plan plan;
    plan.asked = {
        {"study", "integration"},
        {"cases", cases},
        {"every", study.every},
        {"budget", {{"force_evaluations", study.force_evaluations}, {"processor_time", study.processor_time}}},
        {"sweeps", OrderedJson::array()}};
    for (const Sweep& s : study.sweeps)
      plan.asked["sweeps"].push_back({{"name", s.name}, {"problem", s.problem}, {"integrators", s.integrators.size()}});
    plan.file_bytes = std::uint64_t(cost_of_products(plan, {}).bytes);
    plan.result_bytes = cases * sizeof(StudyRow);
    plan.memory_bytes = std::uint64_t(kProgram + kHdf5 + kImage) + 3 * plan.result_bytes;
    return plan;
  }
  const SceneSize size = config.scene_kind->size(config);
  Plan plan = sizes(config, size);
  Poses poses{.rows = double(config.steps)};
  if (config.scene_kind->integrated) poses = foreseen_poses(config, size);
  if (const std::uint64_t sets = plan.count("case_sets")) {
    // At a step one of two bodies moves along an axis; a set begins with two others.
    poses.changed = double(config.steps) + 14 * double(sets);
    poses.moving = double(config.steps);
    count_alone(config, size.alone, plan);
  }
  add_bytes(config, size, poses, thread_count(0), plan);
  return plan;
}

Plan plan(const geometry::Bodies& bodies, std::uint64_t steps, const std::vector<AlgorithmChoice>& choices) {
  Plan plan{.bodies = bodies.size()};
  plan.labels = labels_of(bodies, choices);
  plan.result_bytes = steps * (56 * bodies.size() + choices.size() * (96 + 8 * bodies.size()));
  return plan;
}

Plan plan(const Config& config, const Scene& scene, int threads) {
  if (!scene.case_sets.empty()) return plan(config);
  SceneSize size = config.scene_kind->size(config);
  size.contact_spheres = 0;  // as many as found place
  for (const RigidBody& body : scene.rigid) size.contact_spheres += body.spheres.size();
  Plan plan = sizes(config, size);
  plan.labels = labels_of(scene.bodies, config.algorithms);
  add_bytes(config, size,
            scene.script.empty() ? foreseen_poses(config, size) : counted_poses(scene.script, scene.bodies), threads,
            plan);
  return plan;
}

namespace {

/// What bodies of files are: all in which something looks wrong, of the others the first.
std::string facts_text(const std::vector<BodyFacts>& bodies) {
  constexpr std::size_t kMostLines = 40;
  std::string text;
  std::size_t lines = 0, more = 0;
  for (const BodyFacts& body : bodies) {
    if (body.doubt.empty() && lines >= kMostLines) {
      ++more;
      continue;
    }
    ++lines;
    text += print("body        %s: %llu facets, %s, %.4g x %.4g x %.4g m, ", body.name.c_str(),
                  static_cast<unsigned long long>(body.facets), body.closed ? "closed" : "open", body.size.x(),
                  body.size.y(), body.size.z());
    text += body.fixed ? "fixed" : print("over %.4g m", body.path);
    text += body.doubt.empty() ? "\n" : "\n            " + body.name + " " + body.doubt + "\n";
  }
  if (more > 0) text += print("            and %zu bodies more\n", more);
  return text;
}

/// Who wants most of it, where that is a method.
std::string largest_text(const Plan& plan) {
  const auto largest =
      std::ranges::max_element(plan.labels, {}, [](const LabelPlan& label) { return label.memory.greatest; });
  if (largest == plan.labels.end() || 2 * largest->memory.greatest < plan.memory_bytes) return "";
  return " (algorithm '" + largest->label + "' about " + mebibytes_text(largest->memory.greatest) +
         ": sampling fewer facets takes less)";
}

/// What a method of others is, and what it says of itself where it was asked.
std::string foreign_text(const AlgorithmChoice& choice, const Plan& plan) {
  if (!choice.foreign) return "";
  const Foreign& foreign = *choice.foreign;
  std::string text = "            a " + foreign.transport;
  if (!foreign.command.words.empty()) text += ": " + text_of(foreign.command);
  if (const auto found = plan.abouts.find(choice.label); found != plan.abouts.end()) {
    const About& about = found->second;
    text += "; " + about.name + (about.version.empty() ? "" : " " + about.version) +
            (about.language.empty() ? "" : ", " + about.language) + ", " + about.precision + " precision, promise " +
            std::string(algorithms::text(about.promise)) + ", scope " + std::string(algorithms::text(about.scope));
  }
  return text + print("\n            at most %g s a step, %g s in all, %s; how long it takes is not foreseen\n",
                      foreign.budget.step, foreign.budget.all, mebibytes_text(foreign.budget.memory).c_str());
}

Json foreign_json(const AlgorithmChoice& choice, const Plan& plan) {
  const Foreign& foreign = *choice.foreign;
  Json json = {{"transport", foreign.transport},    {"command", foreign.command.words},
               {"files_sha256", foreign.files},     {"step_budget", foreign.budget.step},
               {"time_budget", foreign.budget.all}, {"memory_budget", foreign.budget.memory >> 20}};
  if (const auto found = plan.abouts.find(choice.label); found != plan.abouts.end())
    json["says"] = Json::parse(text_of(found->second));
  return json;
}

}  // namespace

void refuse_if_too_large(const Plan& plan, const std::filesystem::path& output) {
  if (plan.memory_bytes > machine_memory())
    throw Error(kInput, "the run needs about " + mebibytes_text(plan.memory_bytes) + " of memory, this machine has " +
                            mebibytes_text(machine_memory()) + largest_text(plan) +
                            "; fewer steps, bodies, segments or contact_spheres make it smaller");
  // Twice: the part and the file exist together for a moment.
  if (2 * plan.file_bytes > free_disk(output))
    throw Error(kInput, output.string() + ": the run needs about " + mebibytes_text(2 * plan.file_bytes) +
                            " of disk, there is " + mebibytes_text(free_disk(output)) +
                            " free; choose another -o or fewer steps");
}

std::string plan_text(const Config& config, const Plan& plan, const Seconds& time, const std::string& output) {
  const std::string takes = "takes       " +
                            (time.most < 1 ? "less than a second"
                                           : "about " + duration_text(time.least) + " to " + duration_text(time.most)) +
                            ", " + bytes_text(plan.memory_bytes) + " of memory\n";
  const std::string output_line = "output      " + output + ", about " + bytes_text(plan.file_bytes) + "\n";
  std::string of_products;
  for (const Product& product : products())
    if (product.plan && (product.place == Product::Place::alone) == config.study.has_value())
      of_products += product.plan(plan.asked);
  if (config.study) return config.title + "\n" + of_products + takes + output_line;
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
  text += of_products;
  if (config.scene_kind->facts) text += facts_text(config.scene_kind->facts(config));
  const bool facets = std::ranges::any_of(config.algorithms, [](const AlgorithmChoice& choice) {
    return algorithms::samples_facets(row_of(choice), choice.knobs);
  });
  if (!facets) text += "facets      no chosen algorithm samples them, so no facet points are computed\n";
  for (const auto& [file, hash] : config.inputs) text += "input       " + file + "\n";
  for (const std::string& line : config.understood) text += "read        " + one_line(line, 4096) + "\n";
  for (const AlgorithmChoice& choice : config.algorithms)
    text += "algorithm   " + choice.label + (choice.label == choice.name ? "" : " = " + choice.name) + " " +
            knobs_json(choice.knobs) + "\n" + foreign_text(choice, plan);
  text += print("timing      %lld repeats", static_cast<long long>(config.repeats));
  if (config.noise && !config.algorithms.empty())
    text += ", " + config.algorithms.front().label + " a second time for the noise floor";
  text += config.pin ? print(", on processor %lld\n", static_cast<long long>(*config.pin)) : "\n";
  // Who takes much of it: a tenth, or more than the program itself.
  for (const LabelPlan& label : plan.labels)
    if (label.memory.greatest > std::uint64_t(16 * kMiB) && 10 * label.memory.greatest > plan.memory_bytes)
      text += "            " + label.label + " alone about " + bytes_text(label.memory.greatest) + "\n";
  return text + takes + output_line;
}

std::string plan_json(const Config& config, const Plan& plan, const Seconds& time, const std::string& output) {
  Json json = {{"title", config.title},
               {"output", output},
               {"file_bytes", plan.file_bytes},
               {"memory_bytes", plan.memory_bytes},
               {"seconds", {time.least, time.most}}};
  json.update(plan.asked);
  json["effective"] = config.effective;
  if (config.study) return dumped(json);
  json.update(Json{{"scene", config.scene_kind->name},
                   {"steps", config.steps},
                   {"rate", config.rate},
                   {"bodies", plan.bodies},
                   {"pairs", plan.pairs},
                   {"meshes", plan.meshes},
                   {"triangles", plan.triangles},
                   {"repeats", config.repeats}});
  json["containment"] = text_of(config.containment);
  json["inputs_sha256"] = config.inputs;
  json["understood"] = config.understood;
  if (config.scene_kind->facts)
    for (const BodyFacts& body : config.scene_kind->facts(config))
      json["bodies_read"].push_back({{"name", body.name},
                                     {"mesh", body.mesh},
                                     {"fixed", body.fixed},
                                     {"facets", body.facets},
                                     {"closed", body.closed},
                                     {"size", {body.size.x(), body.size.y(), body.size.z()}},
                                     {"path", body.path},
                                     {"doubt", body.doubt}});
  json["algorithms"] = Json::array();
  for (const AlgorithmChoice& choice : config.algorithms)
    json["algorithms"].push_back(
        {{"label", choice.label}, {"name", choice.name}, {"knobs", Json::parse(knobs_json(choice.knobs))}});
  for (const AlgorithmChoice& choice : config.algorithms)
    if (choice.foreign) json["foreign"][choice.label] = foreign_json(choice, plan);
  for (std::size_t i = 0; i < plan.labels.size(); ++i)
    json["algorithms"][i]["memory_bytes"] = plan.labels[i].memory.greatest;
  return dumped(json);
}

}  // namespace pipeline
