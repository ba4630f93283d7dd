// The methods beyond the nine against what they are to be measured by, in one process, in turns.
//
//   build/beyond_bench [RESULT.h5] [options of Google Benchmark]
//
// On every tenth step of a result file, results/padani.h5 unless another is given (scripts/bench makes it); the octree
// on spheres strewn in a cube so that each touches about four others' boxes. Time is the processor's, the fastest of
// three passes of each step, preparation included. Columns:
//   Time       ms of a step, mean
//   reference  ms of a step of the method that stands behind the slash
//   ratio      the former over the latter
//   most       what the ratio is to be at most
//   hits       a step
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/contract/algorithm.hpp"
#include "geometry/meshes/shapes.hpp"
#include "geometry/random.hpp"
#include "pipeline/result/store.hpp"

namespace {

using namespace geometry;
using algorithms::Knobs;
using algorithms::Method;

struct Scene {
  Bodies bodies;
  std::vector<std::vector<Pose>> steps;
};

using Changes = std::vector<std::pair<std::string, algorithms::Value>>;

/// One method, and the one that it is measured by.
struct Row {
  std::string name;
  Changes changes;
  std::string reference;
  double most;
};

std::unique_ptr<Method> made(const std::string& name, const Changes& changes, const Bodies& bodies) {
  const algorithms::Algorithm* row = algorithms::find(name);
  if (!row) return nullptr;  // a library that this build is without
  Knobs knobs = algorithms::presets(*row);
  for (const auto& [knob, value] : changes) knobs.at(knob) = value;
  return row->make(bodies, knobs);
}

double now_ms() {
  timespec at;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &at);
  return 1e3 * static_cast<double>(at.tv_sec) + 1e-6 * static_cast<double>(at.tv_nsec);
}

double step_ms(Method& method, const std::vector<Pose>& poses, const std::vector<PairRun>& runs,
               std::vector<Pair>& hits) {
  double best = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < 3; ++pass) {
    hits.clear();
    const double from = now_ms();
    method.prepare(poses);
    method.answer(runs, hits);
    best = std::min(best, now_ms() - from);
  }
  return best;
}

void against(benchmark::State& state, const Row& row, const Scene& scene) {
  const auto method = made(row.name, row.changes, scene.bodies), reference = made(row.reference, {}, scene.bodies);
  if (!method || !reference) return state.SkipWithError("its library is not in this build");
  double mine = 0, other = 0, hits = 0;
  std::vector<Pair> found, unused;
  for (auto _ : state) {
    mine = other = hits = 0;
    for (const std::vector<Pose>& poses : scene.steps) {
      const std::vector<PairRun> runs = pair_runs(scene.bodies, poses);
      other += step_ms(*reference, poses, runs, unused);
      mine += step_ms(*method, poses, runs, found);
      hits += static_cast<double>(found.size());
    }
    state.SetIterationTime(1e-3 * mine / static_cast<double>(scene.steps.size()));
  }
  const auto steps = static_cast<double>(scene.steps.size());
  state.counters["reference"] = other / steps;
  state.counters["ratio"] = mine / other;
  state.counters["most"] = row.most;
  state.counters["hits"] = hits / steps;
}

Scene every_tenth(const std::string& path) {
  pipeline::Result result = pipeline::read_result(path);
  Scene out{std::move(result.bodies), {}};
  for (std::size_t step = 0; step < result.motion.size(); step += 10)
    out.steps.push_back(std::move(result.motion[step]));
  return out;
}

/// Balls of radius 1 m in a cube, 20 m^3 each.
Scene strewn(std::uint32_t count) {
  Scene out;
  out.bodies.meshes = {sphere("ball", 1, 4)};
  Random random(1);
  const double half = 0.5 * std::cbrt(20.0 * count);
  std::vector<Pose>& poses = out.steps.emplace_back();
  for (std::uint32_t body = 0; body < count; ++body) {
    out.bodies.add("ball_" + std::to_string(body), 0);
    const auto at = [&] { return half * random.signed_unit(); };
    const double x = at(), y = at(), z = at();
    poses.push_back({{}, {x, y, z}});
  }
  return out;
}

const std::string kText[] = {"eleven_axes", "moller", "guigue_devillers"};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const std::string path = argc > 1 ? argv[1] : "results/padani.h5";
  std::vector<Row> rows = {{"convex_hull", {}, "obb_sat", 2},
                           {"facet_surface", {}, "facet_distance", 1},
                           {"facet_gjk", {}, "facet_distance", 0.5},
                           {"facet_gjk", {{"prefilter", std::string("none")}}, "facet_distance", 0.5},
                           {"spheres", {}, "bounding_sphere", 5}};
  for (const std::string& test : kText)
    for (const std::string precision : {"double", "single"})
      rows.push_back({"all_triangles", {{"test", test}, {"precision", precision}}, "fcl_bvh", 1});
  const Scene padani = every_tenth(path);
  for (const Row& row : rows) {
    std::string name = row.name;
    for (const auto& [knob, value] : row.changes) name += ":" + std::get<std::string>(value);
    benchmark::RegisterBenchmark((name + "/" + row.reference).c_str(),
                                 [&row, &padani](benchmark::State& state) { against(state, row, padani); })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
  for (const std::uint32_t count : {300u, 1000u, 3000u, 10000u})
    benchmark::RegisterBenchmark(("octree/obb_sat/" + std::to_string(count)).c_str(),
                                 [count](benchmark::State& state) {
                                   const Row row{"octree", {{"then", std::string("obb_sat")}}, "obb_sat", 1};
                                   against(state, row, strewn(count));
                                 })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
}
