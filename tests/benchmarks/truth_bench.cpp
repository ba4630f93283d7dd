// What the truth of a step costs: a pile of spheres as in the falling scene, one core.
//
// The first argument is the gap between neighbours in thousandths of the diameter: negative ones interpenetrate. Beside
// the time stand the hits and a hash of them, so that a speed-up cannot quietly change an answer.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/decision/broad_phase.hpp"
#include "geometry/decision/meet.hpp"
#include "geometry/meshes/shapes.hpp"
#include "pipeline/result/store.hpp"

namespace {

using namespace geometry;

/// Layers of a hexagonal packing, each shifted over the hollows of the one below: up to twelve neighbours per sphere.
/// Spheres have radius 1 m and any orientation; places are jittered by a thousandth of the gap.
struct Pile {
  Bodies bodies;
  std::vector<Pose> poses;

  Pile(int side, double gap, std::int64_t segments) {
    std::mt19937_64 bits(20220801);
    const auto real = [&] { return static_cast<double>(static_cast<std::int64_t>(bits())) * 0x1p-63; };
    bodies.meshes = {sphere("sphere", 1, segments), box("plate", Vec3(1000, 1, 1000))};
    const auto add = [&](std::uint32_t mesh, bool fixed, const Pose& pose) {
      bodies.add(std::to_string(bodies.size()), mesh, fixed);
      poses.push_back(pose);
    };
    const double step = 2 + gap;
    add(1, true, {{}, Vec3(0, -0.5, 0)});
    for (int layer = 0; layer < side; ++layer)
      for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) {
          Quaternion q{real(), real(), real(), real()};
          const Vec3 jitter = 0.001 * gap * Vec3(real(), real(), real());
          const double x = column + 0.5 * (row % 2) + 0.5 * (layer % 2);
          const double z = (row + (layer % 2) / 3.0) * std::sqrt(0.75);
          const double y = 1 + 0.5 * gap + layer * step * std::sqrt(2.0 / 3.0);
          add(0, false, {normalised(q), Vec3(x * step, y, z * step) + jitter});
        }
  }
};

/// FNV-1a over the pairs' numbers.
std::uint64_t hash(const std::vector<Pair>& pairs) {
  std::uint64_t h = 14695981039346656037u;
  for (const Pair& p : pairs)
    for (const std::uint32_t n : {p.a, p.b}) h = (h ^ n) * 1099511628211u;
  return h;
}

void near_pairs_of_a_pile(benchmark::State& state) {
  Pile pile(static_cast<int>(state.range(0)), 2e-3, 4);
  std::vector<Pose> moved = pile.poses;
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i].t.x() += 0.01 * std::sin(static_cast<double>(i));
  const std::vector<PairRun> runs = pair_runs(pile.bodies, pile.poses);
  BroadPhase broad(pile.bodies);
  std::vector<Pair> pairs;
  double prepare_us = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    broad.prepare(pile.poses);
    prepare_us +=
        1e-3 * static_cast<double>(std::chrono::nanoseconds(std::chrono::steady_clock::now() - start).count());
    broad.pairs(runs, pairs);
    std::swap(pile.poses, moved);
  }
  state.counters["bodies"] = static_cast<double>(pile.poses.size());
  state.counters["near"] = static_cast<double>(pairs.size());
  state.counters["compared"] = static_cast<double>(broad.comparisons());
  state.counters["prepare_us"] = prepare_us / static_cast<double>(state.iterations());
}
BENCHMARK(near_pairs_of_a_pile)->ArgName("side")->Arg(6)->Arg(14)->Arg(30)->Arg(65)->Unit(benchmark::kMicrosecond);

void truth_of_a_pile(benchmark::State& state) {
  const Pile pile(7, 2e-3 * static_cast<double>(state.range(0)), state.range(1));
  const std::vector<Bvh> bvhs = build_bvhs(pile.bodies);
  const std::vector<PairRun> runs = pair_runs(pile.bodies, pile.poses);
  Decision decision(pile.bodies, bvhs);
  std::vector<Pair> hits;
  for (auto _ : state) hits = decision.hits(pile.poses, runs);
  char text[64];
  std::snprintf(text, sizeof text, "%zu spheres, hash %016llx", pile.bodies.size() - 1,
                static_cast<unsigned long long>(hash(hits)));
  state.SetLabel(text);
  state.counters["hits"] = static_cast<double>(hits.size());
}
BENCHMARK(truth_of_a_pile)
    ->ArgNames({"gap", "segments"})
    ->ArgsProduct({{-10, 1, 10, 1000}, {16, 32}})
    ->Args({-100, 16})
    ->Args({-3, 16})
    ->Args({0, 16})
    ->Unit(benchmark::kMillisecond);

void placing_a_sphere(benchmark::State& state) {
  const Pile pile(1, 0, state.range(0));
  const Mesh& mesh = pile.bodies.meshes[0];
  const Bvh bvh = build_bvh(mesh);
  std::vector<Vec3> world(mesh.vertices.size());
  std::vector<Box> boxes(bvh.nodes.size());
  for (auto _ : state) {
    to_world(pile.poses[1], mesh.vertices, world);
    refit(bvh, mesh, world, boxes);
    benchmark::DoNotOptimize(boxes.data());
  }
}
BENCHMARK(placing_a_sphere)->ArgName("segments")->Arg(16)->Arg(32)->Unit(benchmark::kMicrosecond);

void building_a_hierarchy(benchmark::State& state) {
  const Mesh mesh = sphere("sphere", 1, state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(build_bvh(mesh).nodes.data());
  state.SetLabel(std::to_string(mesh.triangles.size()) + " facets");
}
BENCHMARK(building_a_hierarchy)->ArgName("segments")->Arg(16)->Arg(700)->Unit(benchmark::kMillisecond);

/// Every step of a recorded motion, with its memory of the step before and without, beside the broad phase alone.
/// Usage: truth_bench FILE.h5 [SEGMENTS [ROUNDS]]. `segments` > 0 puts spheres of that many in the place of the file's.
int replay(const char* path, std::int64_t segments, int rounds) {
  pipeline::Result recorded = pipeline::read_result(path);
  for (Mesh& mesh : recorded.bodies.meshes)
    if (segments > 0 && mesh.sphere_radius > 0) mesh = sphere(mesh.name, mesh.sphere_radius, segments);
  const Bodies& bodies = recorded.bodies;
  const std::vector<Bvh> bvhs = build_bvhs(bodies);
  std::vector<std::vector<PairRun>> runs;
  for (const auto& poses : recorded.motion) runs.push_back(pair_runs(bodies, poses));
  const std::size_t steps = recorded.steps();
  // Of this thread: other programs take none of it.
  const auto now_ms = [] {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
  };
  std::vector<double> broad_ms(steps, 1e9), warm_ms(steps, 1e9), cold_ms(steps, 1e9);
  std::vector<Pair> pairs;
  std::vector<std::size_t> near(steps), hits(steps);
  std::vector<std::uint64_t> warm_work(steps), cold_work(steps);
  std::uint64_t warm_hash = 0, cold_hash = 0;
  const bool recorded_truth = segments == 0 && recorded.truth.hits.steps() == steps;
  std::size_t different = 0;
  for (int round = 0; round < rounds; ++round) {
    BroadPhase broad(bodies);
    Decision warm(bodies, bvhs), cold(bodies, bvhs);
    warm_hash = cold_hash = 0;
    for (std::size_t s = 0; s < steps; ++s) {
      double start = now_ms();
      broad.prepare(recorded.motion[s]);
      broad.pairs(runs[s], pairs);
      broad_ms[s] = std::min(broad_ms[s], now_ms() - start);
      near[s] = pairs.size();
      for (auto* decision : {&warm, &cold}) {
        pairs.clear();
        start = now_ms();
        if (decision == &cold) cold.forget();
        decision->prepare(recorded.motion[s]);
        decision->hits(runs[s], pairs);
        decision->remember();
        double& ms = (decision == &warm ? warm_ms : cold_ms)[s];
        ms = std::min(ms, now_ms() - start);
        (decision == &warm ? warm_work : cold_work)[s] = decision->operations();
        std::uint64_t& h = decision == &warm ? warm_hash : cold_hash;
        h = 31 * h + hash(pairs);
        hits[s] = pairs.size();
        if (recorded_truth && !std::ranges::equal(pairs, recorded.truth.hits.at(s))) ++different;
      }
    }
  }
  std::printf("%s: %zu steps, %zu bodies; fastest of %d rounds, CPU ms per step\n", path, steps, bodies.size(), rounds);
  std::printf("%12s %8s %8s %10s %10s %10s %12s %12s\n", "steps", "near", "hits", "broad", "warm", "cold", "warm tests",
              "cold tests");
  const auto row = [&](std::size_t first, std::size_t last) {
    const auto mean = [&](const auto& values) {
      double sum = 0;
      for (std::size_t s = first; s < last; ++s) sum += static_cast<double>(values[s]);
      return sum / static_cast<double>(std::max<std::size_t>(last - first, 1));
    };
    std::printf("%5zu..%-5zu %8.1f %8.1f %10.4f %10.4f %10.4f %12.0f %12.0f\n", first, last, mean(near), mean(hits),
                mean(broad_ms), mean(warm_ms), mean(cold_ms), mean(warm_work), mean(cold_work));
  };
  for (std::size_t s = 0; s < steps; s += 60) row(s, std::min(steps, s + 60));
  row(0, steps);
  std::printf("hash of all hits: warm %016llx, cold %016llx\n", static_cast<unsigned long long>(warm_hash),
              static_cast<unsigned long long>(cold_hash));
  std::printf("steps that differ from the recorded truth: %zu\n", different);
  return warm_hash == cold_hash && different == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]).ends_with(".h5"))
    return replay(argv[1], argc > 2 ? std::strtoll(argv[2], nullptr, 10) : 0,
                  argc > 3 ? static_cast<int>(std::strtol(argv[3], nullptr, 10)) : 3);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
