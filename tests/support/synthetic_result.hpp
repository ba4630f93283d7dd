// A made-up result of any size that uses every part of the file: numbers from a fixed sequence, no physics behind them.
#pragma once
#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "geometry/meshes/shapes.hpp"
#include "pipeline/result/products/physics.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

/// Sorted pairs a < b < bodies, neighbours by number: about `wanted` every 20 steps, one fewer at each step between.
inline PairLists synthetic_pairs(std::mt19937_64& random, std::uint64_t steps, std::uint32_t bodies,
                                 std::uint64_t wanted) {
  constexpr std::uint32_t kReach = 20;
  const double chance = static_cast<double>(wanted) / (static_cast<double>(bodies) * kReach);
  PairLists lists;
  std::vector<Pair> step;  // heaps change slowly: most pairs stay from step to step
  for (std::uint64_t s = 0; s < steps; ++s) {
    if (s % 20 == 0) {
      step.clear();
      for (std::uint32_t a = 0; a < bodies; ++a)
        for (std::uint32_t b = a + 1; b < std::min(bodies, a + 1 + kReach); ++b)
          if (static_cast<double>(random() >> 11) * 0x1p-53 < chance) step.push_back({a, b});
    } else if (!step.empty()) {
      step.erase(step.begin() + static_cast<std::ptrdiff_t>(random() % step.size()));
    }
    lists.append(step);
  }
  return lists;
}

/// S steps of B bodies (at least 3) with A algorithms and about `hits` hits each at every step. Body 0 is fixed, the
/// last body is born half-way. Integrated, every pair asked about.
inline Result synthetic_result(std::uint64_t steps = 7, std::uint32_t bodies = 5, std::uint64_t algorithms = 3,
                               std::uint64_t hits = 4) {
  std::mt19937_64 random(1);
  const auto real = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const auto counts = [&](std::uint64_t below) {
    std::vector<std::uint64_t> out(steps);
    for (auto& value : out) value = random() % below;
    return out;
  };
  const auto times = [&] {
    std::vector<std::int64_t> out(steps);
    for (auto& value : out) value = static_cast<std::int64_t>(100'000 + random() % 10'000);
    return out;
  };

  Result result;
  result.title = "Made up: koule, žluťoučký kůň";
  result.config_text = "title = \"Made up\"\n# commentary\nsteps = 7\n";
  result.config_effective = "title = \"Made up\"\nsteps = 7\nrate = 60\n";
  result.rate = 60;
  // Not in order of their names: the order of meshes is kept.
  result.bodies.meshes = {geometry::sphere("sphere_16", 1, 16), geometry::box("plate", {60, 2, 60})};
  for (std::uint32_t body = 0; body < bodies; ++body) {
    result.bodies.add(body == 0 ? "plate" : "sphere_" + std::to_string(body), body == 0 ? 1 : 0, body == 0);
    result.first_step.push_back(body + 1 == bodies ? static_cast<std::int64_t>(steps / 2) : 0);
  }
  for (std::uint64_t s = 0; s < steps; ++s) {
    std::vector<geometry::Pose> poses(bodies);
    for (std::uint32_t body = 0; body < bodies; ++body) {
      const bool born = static_cast<std::int64_t>(s) >= result.first_step[body];
      poses[body] =
          born ? geometry::Pose{{real(), real(), real(), real()}, {real(), real() * 50, real()}} : geometry::unborn();
      if (body == 0) poses[body] = {{1, 0, 0, 0}, {0, -1, 0}};
    }
    result.motion.push_back(poses);
  }

  result.products.put<PhysicsRows>({});
  result.products.find<PhysicsRows>()->status = "complete";
  for (std::uint64_t s = 0; s < steps; ++s) {
    const auto count = [&] { return static_cast<std::int64_t>(random() % 1000); };
    result.products.find<PhysicsRows>()->rows.push_back(
        {real(), real(), real(), count(), count(), count(), count(), count(), count()});
  }
  result.truth.hits = synthetic_pairs(random, steps, bodies, hits);
  result.truth.time_ns = times();

  for (std::uint64_t a = 0; a < algorithms; ++a) {
    Answers answers;
    answers.label = "method_" + std::to_string(algorithms - a);  // not in order of their names
    answers.name = "method";
    answers.knobs = "{\"stride\":" + std::to_string(a) + "}";
    answers.promise = a == 0 ? "conservative" : "none";
    answers.thesis_key = a == 0 ? "" : "L";
    answers.operations_unit = "axis projections";
    answers.scope = a == 0 ? "scene" : "pair";
    answers.machine = {"host", "processor", "Release", "2026-01-02T03:04:05Z"};
    answers.hits = synthetic_pairs(random, steps, bodies, hits);
    answers.time_ns = times();
    answers.time_median_ns = times();
    answers.prepare_ns = times();
    answers.processor_ns = answers.time_median_ns;
    answers.operations = counts(100'000);
    answers.true_positive = counts(900);
    answers.false_positive = counts(50);
    answers.false_negative = counts(50);
    answers.rounding_miss = counts(2);
    result.answers.push_back(std::move(answers));
    result.summary.push_back({random() % 1000, random() % 1000, random() % 1000, random() % 1000, random() % 1000,
                              real(), real(), real(), a == 1 ? std::numeric_limits<double>::quiet_NaN() : real(),
                              real() * 1e6, real() * 1e6, real() * 1e6});
    Summary& row = result.summary.back();
    row.promise_kept = a != 1;
    row.time_mean_low_ns = row.time_mean_ns / 2;
    row.time_mean_high_ns = a == 1 ? std::numeric_limits<double>::quiet_NaN() : row.time_mean_ns * 2;
    row.setup_ns = result.answers.back().costs.setup_ns = 1000 + double(a);
    row.memory_bytes = result.answers.back().costs.memory_bytes = 4096;
  }
  result.provenance = {"pipeline 0.1.0",
                       "0123456789abcdef",
                       "Release",
                       "g++ 12.2",
                       "-O3",
                       "{\"hdf5\":\"1.10.8\"}",
                       std::string(64, 'a'),
                       "{\"plate.obj\":\"" + std::string(64, 'b') + "\"}",
                       "2026-01-02T03:04:05Z",
                       "host",
                       "processor",
                       12.5};
  return result;
}

}  // namespace pipeline
