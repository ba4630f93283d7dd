// Time of every algorithm of the table, per pair and per step, and of the triangle tests, each with a hash of its
// answers beside it: a speed-up that changes the hash changed the answers.
//
// The steps are the last ones of recorded motions in tests/data (run from the project's folder, as scripts/bench does).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <random>

#include "algorithms/contract/algorithm.hpp"
#include "algorithms/parts/eleven_axes.hpp"
#include "geometry/decision/exact.hpp"
#include "geometry/meshes/shapes.hpp"
#include "pipeline/result/store.hpp"
#include "tests/support/setting.hpp"

namespace {

using namespace geometry;
using algorithms::Algorithm;
using setting::uniform, setting::uniform_turn;

constexpr std::uint32_t kSeed = 20221;

struct Frame {
  Bodies bodies;
  std::vector<Pose> poses;
  std::vector<PairRun> runs;

  void add(std::uint32_t mesh, bool fixed, const Pose& pose) {
    bodies.add("body" + std::to_string(poses.size()), mesh, fixed);
    poses.push_back(pose);
  }
};

/// The last step of a recorded motion.
Frame recorded_frame(const std::string& path) {
  pipeline::Result result = pipeline::read_result(path);
  Frame out;
  out.bodies = std::move(result.bodies);
  out.poses = std::move(result.motion.back());
  out.runs = pair_runs(out.bodies, out.poses);
  return out;
}

/// 64 pairs of spheres of radius 1, each pair `distance` metres wide and far from the others; one run per pair.
Frame pairs_frame(double distance) {
  Frame out;
  std::mt19937 random(kSeed);
  out.bodies.meshes = {sphere("sphere", 1, 16)};
  for (std::uint32_t i = 0; i < 64; ++i) {
    const Vec3 place(20.0 * i, 0, 0);
    const Vec3 off(uniform(random), uniform(random), uniform(random));
    out.add(0, false, {uniform_turn(random), place});
    out.add(0, false, {uniform_turn(random), place + off * (distance / off.norm())});
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

/// 1000 pairs of random triangles in a cube of 2 m, the second moved `apart` metres along x.
void triangle_pairs(benchmark::State& state, bool exact, double apart) {
  std::mt19937 random(kSeed);
  const auto point = [&](double x) { return Vec3(uniform(random) + x, uniform(random), uniform(random)); };
  std::vector<std::pair<Triangle, Triangle>> pairs(1000);
  for (auto& [a, b] : pairs) {
    a = {point(0), point(0), point(0)};
    b = {point(apart), point(apart), point(apart)};
  }
  std::vector<Pair> hits;
  for (auto _ : state) {
    hits.clear();
    for (std::uint32_t i = 0; i < pairs.size(); ++i) {
      const auto& [a, b] = pairs[i];
      if (exact ? triangles_meet(a, b) : meet_by_eleven_axes(edged(a[0], a[1], a[2]), edged(b[0], b[1], b[2])))
        hits.push_back({i, i + 1});
    }
    benchmark::DoNotOptimize(hits.data());
  }
  state.counters["per_pair"] =
      benchmark::Counter(1000, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.SetLabel(digest(hits));
}

}  // namespace

int main(int argc, char** argv) {
  const std::map<std::string, Frame> frames = {{"falling", recorded_frame("tests/data/falling.h5")},
                                               {"box", recorded_frame("tests/data/box.h5")}};
  for (const Algorithm& algorithm : algorithms::all()) {
    const std::string name = algorithm.name;
    for (const auto& [scene, frame] : frames) {
      benchmark::RegisterBenchmark((name + "/step/" + scene).c_str(), [&algorithm,
                                                                       f = &frame](benchmark::State& state) {
        step(state, algorithm, *f, true);
      })->Unit(benchmark::kMillisecond);
      benchmark::RegisterBenchmark((name + "/prepare/" + scene).c_str(), [&algorithm,
                                                                          f = &frame](benchmark::State& state) {
        step(state, algorithm, *f, false);
      })->Unit(benchmark::kMillisecond);
    }
    for (const auto& [what, distance] :
         {std::pair{"apart", 5.0}, std::pair{"near", 2.1}, std::pair{"overlapping", 1.5}})
      benchmark::RegisterBenchmark((name + "/pair/" + what).c_str(),
                                   [&algorithm, d = distance](benchmark::State& state) { pairs(state, algorithm, d); });
  }
  for (const bool exact : {false, true})
    for (const auto& [what, apart] : {std::pair{"apart", 3.0}, std::pair{"near", 1.0}, std::pair{"overlapping", 0.0}})
      benchmark::RegisterBenchmark((std::string("triangle_pair/") + (exact ? "exact/" : "eleven_axes/") + what).c_str(),
                                   [exact, d = apart](benchmark::State& state) { triangle_pairs(state, exact, d); })
          ->Unit(benchmark::kMicrosecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
