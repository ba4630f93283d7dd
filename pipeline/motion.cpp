#include "pipeline/motion.hpp"

#include <algorithm>
#include <limits>

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
    out.put(samples);
    out.put(rows);
    out.put(failure);
    out.put(std::vector<double>{reference_energy});
    return out.bytes;
  }
  static MotionChunk from(const std::string& bytes) {
    ChunkReader in(bytes);
    MotionChunk chunk;
    chunk.samples = in.get<BodyState>();
    chunk.rows = in.get<PhysicsSample>();
    chunk.failure = in.text();
    chunk.reference_energy = in.get<double>().at(0);
    return chunk;
  }
};

MotionChunk integrate_chunk(const Config& config, const Scene& scene, const std::vector<BodyState>& from,
                            double reference_energy, double seconds_spent, std::int64_t first, std::int64_t last,
                            Progress& progress) {
  Physics physics = config.physics;
  physics.time_budget = std::max(0.0, physics.time_budget - seconds_spent);
  MotionChunk chunk;
  try {
    // Chunk 0 begins with the initial poses; any other continues from the last sample of the chunk before.
    Simulation simulation(scene.rigid, physics, from, double(std::max<std::int64_t>(first - 1, 0)) / config.rate,
                          reference_energy);
    chunk.reference_energy = simulation.reference_energy();
    for (std::int64_t step = first; step < last; ++step) {
      stop_if_wanted();
      PhysicsSample row;
      if (step == 0)
        row = simulation.sample();
      else if (const std::string why = simulation.advance_to(double(step) / config.rate, row); !why.empty()) {
        chunk.failure = "failed at step " + std::to_string(step) + ": " + why;
        break;
      }
      const std::vector<BodyState> states = step == 0 ? from : simulation.states();
      chunk.samples.insert(chunk.samples.end(), states.begin(), states.end());
      chunk.rows.push_back(row);
      progress.add(1);
    }
  } catch (const std::invalid_argument& error) {
    // The states themselves cannot be integrated further, for instance after an overflow.
    chunk.failure = "failed at step " + std::to_string(first) + ": " + error.what();
  }
  return chunk;
}

}  // namespace

Motion integrate(const Config& config, const Scene& scene, const Part& part, Progress& progress) {
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
      chunk = MotionChunk::from(*kept);
      progress.add(chunk.rows.size(), false);
    } else {
      chunk = integrate_chunk(config, scene, states, reference_energy, seconds_spent, first, last, progress);
      part.save(name, chunk.bytes());
    }
    reference_energy = chunk.reference_energy;
    for (std::size_t s = 0; s < chunk.rows.size(); ++s) {
      std::vector<geometry::Pose> poses(bodies);
      for (std::size_t b = 0; b < bodies; ++b) poses[b] = pose_of(chunk.samples[s * bodies + b]);
      motion.poses.push_back(std::move(poses));
      motion.physics.rows.push_back(chunk.rows[s]);
      seconds_spent += double(chunk.rows[s].time_ns) * 1e-9;
    }
    if (!chunk.failure.empty()) {
      motion.physics.status = chunk.failure;
      failed = true;
    } else {
      states.assign(chunk.samples.end() - std::ptrdiff_t(bodies), chunk.samples.end());
    }
  }

  // The rest of a failed motion: fixed bodies stay, the others are nowhere.
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  while (std::int64_t(motion.poses.size()) < config.steps) {
    std::vector<geometry::Pose> poses(bodies, geometry::unborn());
    for (std::size_t b = 0; b < bodies; ++b)
      if (scene.bodies.fixed[b]) poses[b] = pose_of(scene.states[b]);
    motion.poses.push_back(std::move(poses));
    PhysicsSample row;
    row.energy = row.kinetic_energy = row.greatest_penetration = kNaN;
    motion.physics.rows.push_back(row);
  }
  return motion;
}

}  // namespace pipeline
