// What the truth of a step costs: a pile of spheres as in the falling scene, one core.
//
// The first argument is the gap between neighbours in thousandths of the diameter: negative ones interpenetrate. Beside
// the time stand the hits and a hash of them, so that a speed-up cannot quietly change an answer.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "geometry/exact.hpp"
#include "geometry/meet.hpp"
#include "geometry/shapes.hpp"

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
      bodies.name.push_back(std::to_string(bodies.size()));
      bodies.mesh.push_back(mesh);
      bodies.fixed.push_back(fixed);
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

}  // namespace

BENCHMARK_MAIN();
