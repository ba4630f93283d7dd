#include "pipeline/stages/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "pipeline/system/threads.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

/// What a motion chunk holds: its samples, and the state from which the next one is integrated.
struct MotionChunk {
  std::vector<BodyState> samples;   // steps x B; absent from the failed step on
  std::vector<PhysicsSample> rows;  // one per sample
  std::string failure;              // empty: none
  double reference_energy = 0;

  std::string bytes() const {
    ChunkWriter out;
    out.bytes.reserve(samples.size() * sizeof(BodyState) + rows.size() * sizeof(PhysicsSample) + 4096);
    out.put(samples);
    out.put(rows);
    out.put(failure);
    out.put(std::vector<double>{reference_energy});
    return std::move(out.bytes);  // a member: it would be copied
  }
  static MotionChunk from(const std::string& bytes, std::size_t steps, std::size_t bodies) {
    ChunkReader in(bytes);
    MotionChunk chunk;
    chunk.samples = in.get<BodyState>();
    chunk.rows = in.get<PhysicsSample>();
    in.require(chunk.samples.size() == chunk.rows.size() * bodies);
    chunk.failure = in.text();
    in.require(chunk.failure.empty() ? chunk.rows.size() == steps : chunk.rows.size() < steps);
    chunk.reference_energy = in.get<double>().at(0);
    return chunk;
  }
};

/// The born bodies of a scene and their integration. Simbody's bodies are fixed once it has begun, so this is made
/// again after every event, and at every chunk.
class Integration {
 public:
  /// At `time` s from `states`, B of them. reference_energy as Simulation's.
  Integration(const Scene& scene, const Physics& physics, const std::vector<BodyState>& states, double time,
              double reference_energy)
      : reference_energy_(reference_energy) {
    std::vector<RigidBody> rigid;
    std::vector<BodyState> present;
    bool any_moves = false;
    for (std::size_t b = 0; b < states.size(); ++b) {
      if (!is_born(states[b])) continue;
      any_moves = any_moves || !scene.rigid[b].fixed;
      born_.push_back(b);
      rigid.push_back(scene.rigid[b]);
      present.push_back(states[b]);
    }
    if (!any_moves) return;
    simulation_ = std::make_unique<Simulation>(rigid, physics, present, time, reference_energy);
    reference_energy_ = simulation_->reference_energy();
  }

  /// All zero when no body moves.
  PhysicsSample sample() { return simulation_ ? simulation_->sample() : PhysicsSample(); }

  /// Integrates to `time` s and updates the states of the born. Returns why it failed, or nothing.
  std::string advance_to(double time, PhysicsSample& row, std::vector<BodyState>& states) {
    if (!simulation_) return "";
    if (std::string why = simulation_->advance_to(time, row); !why.empty()) return why;
    const std::vector<BodyState> present = simulation_->states();
    for (std::size_t i = 0; i < born_.size(); ++i) states[born_[i]] = present[i];
    return "";
  }

  double reference_energy() const { return reference_energy_; }

 private:
  std::vector<std::size_t> born_;           // bodies, in order
  std::unique_ptr<Simulation> simulation_;  // none before the first birth of a body that moves
  double reference_energy_;
};

MotionChunk integrate_chunk(const SceneConfig& config, const Scene& scene, const std::vector<BodyState>& from,
                            double reference_energy, double seconds_spent, std::int64_t first, std::int64_t last,
                            Progress& progress) {
  const SceneKind& kind = *config.scene_kind;
  Physics physics = config.physics;  // with the time that is left
  const auto begin = [&](const std::vector<BodyState>& states, std::int64_t step, double reference) {
    physics.time_budget = std::max(0.0, config.physics.time_budget - seconds_spent);
    return std::make_unique<Integration>(scene, physics, states, double(step) / config.rate, reference);
  };
  MotionChunk chunk;
  chunk.samples.reserve(std::size_t(last - first) * from.size());
  std::vector<BodyState> states = from;
  std::int64_t step = first;
  try {
    // Chunk 0 begins with the initial states; any other continues from the last sample of the chunk before.
    auto integration = begin(states, std::max<std::int64_t>(first - 1, 0), reference_energy);
    for (; step < last; ++step) {
      stop_if_wanted();
      PhysicsSample row;
      std::string why;
      if (step == 0)
        row = integration->sample();
      else
        why = integration->advance_to(double(step) / config.rate, row, states);
      seconds_spent += double(row.time_ns) * 1e-9;
      if (why.empty() && kind.breach) why = kind.breach(config, states);
      if (!why.empty()) {
        chunk.failure = "failed at step " + std::to_string(step) + ": " + why;
        break;
      }
      if (kind.events && kind.events(config, step, states)) {
        integration = begin(states, step, 0);
        // What was counted on the way here stays; what holds is that after the events, from where the motion goes on.
        const PhysicsSample now = integration->sample();
        row.energy = now.energy;
        row.kinetic_energy = now.kinetic_energy;
        row.greatest_penetration = now.greatest_penetration;
        row.contacts = now.contacts;
      }
      chunk.reference_energy = integration->reference_energy();
      chunk.samples.insert(chunk.samples.end(), states.begin(), states.end());
      chunk.rows.push_back(row);
      progress.add(1);
    }
  } catch (const std::invalid_argument& error) {
    // The states themselves cannot be integrated further, for instance after an overflow.
    chunk.failure = "failed at step " + std::to_string(step) + ": " + error.what();
  }
  return chunk;
}

std::vector<std::vector<geometry::Pose>> poses_of(const MotionChunk& chunk, std::size_t bodies) {
  std::vector<std::vector<geometry::Pose>> all(chunk.rows.size(), std::vector<geometry::Pose>(bodies));
  for (std::size_t s = 0; s < all.size(); ++s)
    for (std::size_t b = 0; b < bodies; ++b) all[s][b] = pose_of(chunk.samples[s * bodies + b]);
  return all;
}

/// Where bodies are when the motion has failed: fixed ones stay, the others are nowhere.
std::vector<geometry::Pose> nowhere(const Scene& scene) {
  std::vector<geometry::Pose> poses(scene.bodies.size(), geometry::unborn());
  for (std::size_t b = 0; b < poses.size(); ++b)
    if (scene.bodies.fixed[b]) poses[b] = pose_of(scene.states[b]);
  return poses;
}

}  // namespace

bool has_poses(const SceneConfig& config, const Checkpoint& part, std::int64_t first) {
  return !config.scene_kind->integrated || part.has(chunk_name("motion", first)) || part.moved();
}

std::optional<std::vector<std::vector<geometry::Pose>>> kept_poses(const SceneConfig& config, const Scene& scene,
                                                                   const Checkpoint& part, std::int64_t first) {
  const auto count = std::size_t(std::min(kChunkSteps, config.steps - first));
  if (!config.scene_kind->integrated) {
    const auto from = scene.script.begin() + first;
    return std::vector(from, from + std::ptrdiff_t(count));
  }
  std::vector<std::vector<geometry::Pose>> poses;
  const auto kept = [&](std::int64_t at) -> std::optional<MotionChunk> {
    const auto steps = std::size_t(std::min(kChunkSteps, config.steps - at));
    if (const auto bytes = part.load(chunk_name("motion", at)))
      return MotionChunk::from(*bytes, steps, scene.bodies.size());
    return std::nullopt;
  };
  if (const auto chunk = kept(first)) {
    poses = poses_of(*chunk, scene.bodies.size());
  } else {  // it failed before, or is not there
    std::int64_t before = first - kChunkSteps;
    while (before >= 0 && !part.has(chunk_name("motion", before))) before -= kChunkSteps;
    const auto last = before < 0 ? std::nullopt : kept(before);
    if (!last || last->failure.empty()) return std::nullopt;
  }
  poses.resize(count, nowhere(scene));
  return poses;
}

MotionTrial try_motion(const SceneConfig& config, const Scene& scene, std::vector<BodyState> states, double seconds) {
  constexpr double kPart = 0.25;  // of a step; a whole one may take long
  MotionTrial out;
  try {
    const double start = processor_seconds();
    Integration integration(scene, config.physics, states, 0, 0);
    out.begin = processor_seconds() - start;
    const double before = processor_seconds();
    double steps = 0, inner_steps = 0;
    PhysicsSample row;
    while (steps < 20 && processor_seconds() - before < seconds) {
      steps += kPart;
      if (!integration.advance_to(steps / config.rate, row, states).empty()) break;
      inner_steps += double(row.integrator_steps);
    }
    const double spent = processor_seconds() - before;
    out.step = spent / steps;
    out.inner = spent / std::max(1.0, inner_steps);
  } catch (const std::invalid_argument&) {  // said by the run itself
  }
  for (const BodyState& state : states) out.poses.push_back(pose_of(state));
  return out;
}

Motion integrate(const SceneConfig& config, const Scene& scene, const Checkpoint& part, Progress& progress,
                 const AfterChunk& after_chunk) {
  const std::size_t bodies = scene.bodies.size();
  Motion motion;
  motion.physics.status = "complete";
  motion.poses.reserve(std::size_t(config.steps));
  std::vector<BodyState> states = scene.states;
  double reference_energy = 0, seconds_spent = 0;
  bool failed = false;

  for (std::int64_t first = 0; first < config.steps && !failed; first += kChunkSteps) {
    const std::int64_t last = std::min(first + kChunkSteps, config.steps);
    const std::string name = chunk_name("motion", first);
    MotionChunk chunk;
    if (const auto kept = part.load(name)) {
      chunk = MotionChunk::from(*kept, std::size_t(last - first), bodies);
      progress.add(chunk.rows.size(), false);
    } else if (part.moved_elsewhere()) {
      throw Error(kFile, name +
                             ": is gone or damaged, and the rest of the motion was made on another kind of machine; "
                             "resume there, or begin anew with --force");
    } else {
      chunk = integrate_chunk(config, scene, states, reference_energy, seconds_spent, first, last, progress);
      part.save(name, chunk.bytes());
    }
    reference_energy = chunk.reference_energy;
    for (std::vector<geometry::Pose>& poses : poses_of(chunk, bodies)) motion.poses.push_back(std::move(poses));
    for (std::size_t s = 0; s < chunk.rows.size(); ++s) {
      for (std::size_t b = 0; b < bodies; ++b) {
        const BodyState& state = chunk.samples[s * bodies + b];
        if (!is_born(state)) continue;
        double norm = 0;
        for (const double part_of_q : state.orientation) norm += part_of_q * part_of_q;
        motion.physics.quaternion_drift = std::fmax(motion.physics.quaternion_drift, std::fabs(std::sqrt(norm) - 1));
      }
      motion.physics.rows.push_back(chunk.rows[s]);
      seconds_spent += double(chunk.rows[s].time_ns) * 1e-9;
    }
    if (!chunk.failure.empty()) {
      motion.physics.status = chunk.failure;
      failed = true;
    } else {
      states.assign(chunk.samples.end() - std::ptrdiff_t(bodies), chunk.samples.end());
    }
    if (after_chunk) after_chunk(motion.poses);
  }

  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  while (std::int64_t(motion.poses.size()) < config.steps) {
    motion.poses.push_back(nowhere(scene));
    PhysicsSample row;
    row.energy = row.kinetic_energy = row.greatest_penetration = kNaN;
    motion.physics.rows.push_back(row);
  }
  return motion;
}

}  // namespace pipeline
