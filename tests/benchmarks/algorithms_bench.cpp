// Time of every algorithm of the table, per pair and per step, with a hash of its answers beside it: a speed-up that
// changes the hash changed the answers.
//
// The step is a synthetic frame like one of the falling scene: a plate and 274 spheres of 16 segments, two thirds of
// them in a pile and the rest in the air. Everything comes from one generator with a fixed seed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

#include "algorithms/algorithm.hpp"
#include "geometry/shapes.hpp"

namespace {

using namespace geometry;
using algorithms::Algorithm;

constexpr std::uint32_t kSeed = 20221;

/// A number in [-1, 1) with the same bits everywhere; the standard's distributions differ between libraries.
double uniform(std::mt19937& random) { return static_cast<double>(random()) * 0x1p-31 - 1; }

Quaternion any_turn(std::mt19937& random) {
  Quaternion q;
  double square;
  do {
    q = {uniform(random), uniform(random), uniform(random), uniform(random)};
    square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  } while (square > 1 || square < 0.01);
  return normalised(q);
}

struct Frame {
  Bodies bodies;
  std::vector<Pose> poses;
  std::vector<PairRun> runs;

  void add(std::uint32_t mesh, bool fixed, const Pose& pose) {
    bodies.name.push_back("body" + std::to_string(poses.size()));
    bodies.mesh.push_back(mesh);
    bodies.fixed.push_back(fixed);
    poses.push_back(pose);
  }
};

const Frame& falling_frame() {
  static const Frame frame = [] {
    Frame out;
    std::mt19937 random(kSeed);
    out.bodies.meshes = {box("plate", {40, 1, 40}), sphere("sphere", 1, 16)};
    out.add(0, true, {{}, {0, -0.5, 0}});
    for (int i = 0; i < 274; ++i) {
      const int column = i % 7, row = i / 7 % 7, layer = i / 49;
      const Vec3 jitter(uniform(random), uniform(random), uniform(random));
      const bool in_pile = layer < 4;
      const Vec3 place = in_pile ? Vec3(2.0 * column - 6, 1 + 1.9 * layer, 2.0 * row - 6) + 0.06 * jitter
                                 : Vec3(15 * jitter.x(), 30 + 20 * jitter.y(), 15 * jitter.z());
      out.add(1, false, {any_turn(random), place});
    }
    out.runs = pair_runs(out.bodies, out.poses);
    return out;
  }();
  return frame;
}

/// 64 pairs of spheres of radius 1, each pair `distance` metres wide and far from the others; one run per pair.
Frame pairs_frame(double distance) {
  Frame out;
  std::mt19937 random(kSeed);
  out.bodies.meshes = {sphere("sphere", 1, 16)};
  for (std::uint32_t i = 0; i < 64; ++i) {
    const Vec3 place(20.0 * i, 0, 0);
    const Vec3 off(uniform(random), uniform(random), uniform(random));
    out.add(0, false, {any_turn(random), place});
    out.add(0, false, {any_turn(random), place + off * (distance / off.norm())});
    out.runs.push_back({2 * i, 2 * i + 1, 2 * i + 2});
  }
  return out;
}

/// FNV-1a of the sorted hits, and their number.
std::string digest(std::vector<Pair> hits) {
  std::sort(hits.begin(), hits.end());
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const Pair& pair : hits)
    for (const std::uint32_t body : {pair.a, pair.b}) hash = (hash ^ body) * 0x100000001b3;
  char text[64];
  std::snprintf(text, sizeof text, "%zu hits %016llx", hits.size(), static_cast<unsigned long long>(hash));
  return text;
}

/// One step: the bodies' own work and all pairs.
void step(benchmark::State& state, const Algorithm& algorithm, const Frame& frame, bool answers) {
  const auto method = algorithm.make(frame.bodies, algorithms::presets(algorithm));
  std::vector<Pair> hits;
  for (auto _ : state) {
    hits.clear();
    method->prepare(frame.poses);
    if (answers) method->answer(frame.runs, hits);
    benchmark::DoNotOptimize(hits.data());
  }
  if (answers) state.SetLabel(digest(hits));
}

/// The pairs alone, after one preparation.
void pairs(benchmark::State& state, const Algorithm& algorithm, double distance) {
  const Frame frame = pairs_frame(distance);
  const auto method = algorithm.make(frame.bodies, algorithms::presets(algorithm));
  std::vector<Pair> hits;
  method->prepare(frame.poses);
  for (auto _ : state) {
    hits.clear();
    method->answer(frame.runs, hits);
    benchmark::DoNotOptimize(hits.data());
  }
  state.counters["per_pair"] =
      benchmark::Counter(static_cast<double>(pair_count(frame.runs)),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.SetLabel(digest(hits));
}

}  // namespace

int main(int argc, char** argv) {
  for (const Algorithm& algorithm : algorithms::all()) {
    const std::string name = algorithm.name;
    benchmark::RegisterBenchmark((name + "/step").c_str(), [&algorithm](benchmark::State& state) {
      step(state, algorithm, falling_frame(), true);
    })->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark((name + "/prepare").c_str(), [&algorithm](benchmark::State& state) {
      step(state, algorithm, falling_frame(), false);
    })->Unit(benchmark::kMillisecond);
    for (const auto& [what, distance] :
         {std::pair{"apart", 5.0}, std::pair{"near", 2.1}, std::pair{"overlapping", 1.5}})
      benchmark::RegisterBenchmark((name + "/pair/" + what).c_str(),
                                   [&algorithm, d = distance](benchmark::State& state) { pairs(state, algorithm, d); });
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
