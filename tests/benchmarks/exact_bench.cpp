// What exactness costs: `exact` with and without memory beside FCL's inexact answer and obb_sat, on recorded motion.
//
//   build/exact_bench [RESULT.h5] [--per_step=FILE.csv] [options of Google Benchmark]
//
// The motion is that of a result file, results/padani.h5 unless another is given (scripts/bench makes it), with its own
// spheres, with finer ones and with torus knots in their place. All methods answer the same steps in one process, in
// turns, as the detect stage asks them: the fastest of three passes, preparation included, memories emptied every 50
// steps. Time is that of the processor, not of the wall: on a busy machine the wall would charge the slow methods with
// interruptions that the short passes of the fast ones escape. A scene is measured once, when its first row is asked
// for; rows are windows of its steps. Columns:
//   Time        ms of all steps of the window
//   median      ms of a step
//   cold        ms of a step that starts with an empty memory, mean
//   worst       ms of the dearest step
//   fcl_ratio   FCL's time over this one's, of all steps
//   obb_ratio   this time over obb_sat's
//   differ      answers that differ from exact's
// and the hits with a hash of them, so that a speed-up cannot quietly change an answer.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "algorithms/contract/algorithm.hpp"
#include "geometry/meshes/shapes.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/terminal/error.hpp"

namespace {

using namespace pipeline;
using geometry::Bodies;
using geometry::Mesh;
using Poses = std::vector<std::vector<geometry::Pose>>;

constexpr const char* kMethods[] = {"fcl_bvh", "exact", "exact_cold", "obb_sat"};
constexpr std::size_t kFcl = 0, kExact = 1, kObb = 3;
constexpr double kLanded = 3.9;         // s: the last sphere of configs/padani.toml lies
constexpr std::size_t kLiveliest = 60;  // steps
constexpr int kRepeats = 3;

/// Steps of the motion, first <= step < last.
struct Window {
  std::size_t first, last;
};

/// What one method answered and took.
struct Answered {
  PairLists hits;
  std::vector<double> ms;  // of each step: the fastest pass
};

struct Scene {
  std::string name;
  Bodies bodies;
  std::vector<Answered> answers = {};  // of kMethods; empty: not measured yet
};

/// The consecutive steps in which bodies that meet another one travel farthest, summed: impacts, not free fall.
Window liveliest(const Result& result) {
  const std::size_t steps = result.steps(), length = std::min(kLiveliest, steps);
  std::vector<double> travelled(steps, 0);  // m since the step before
  for (std::size_t s = 1; s < steps; ++s) {
    std::vector<std::uint8_t> counted(result.bodies.size(), 0);
    for (const Pair& pair : result.truth.hits.at(s))
      for (const std::uint32_t body : {pair.a, pair.b}) {
        const geometry::Vec3 way = result.motion[s][body].t - result.motion[s - 1][body].t;
        if (!std::exchange(counted[body], 1) && way.allFinite()) travelled[s] += way.norm();
      }
  }
  std::size_t best = 0;
  double most = -1;
  for (std::size_t first = 0; first + length <= steps; ++first) {
    const double sum = std::accumulate(travelled.begin() + std::ptrdiff_t(first),
                                       travelled.begin() + std::ptrdiff_t(first + length), 0.0);
    if (sum > most) most = sum, best = first;
  }
  return {best, best + length};
}

/// The bodies with other meshes in the place of spheres.
template <class Shape>
Bodies with_spheres_as(Bodies bodies, Shape shape) {
  for (Mesh& mesh : bodies.meshes)
    if (mesh.sphere_radius > 0) mesh = shape(mesh);
  return bodies;
}

Mesh finer(const Mesh& sphere) { return geometry::sphere(sphere.name, sphere.sphere_radius, 64); }

/// Babylon.js's torus knot of 2048 facets, so large that it reaches `reach` of the sphere's radius.
Mesh knot(const Mesh& sphere, double reach) {
  Mesh mesh = geometry::torus_knot(sphere.name, 3, 0.5, 32, 32, 2, 3);
  double greatest = 0;
  for (const geometry::Vec3& v : mesh.vertices) greatest = std::max(greatest, v.norm());
  for (geometry::Vec3& v : mesh.vertices) v *= reach * sphere.sphere_radius / greatest;
  return mesh;
}

double cpu_ms() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * double(now.tv_sec) + 1e-6 * double(now.tv_nsec);
}

void measure(Scene& scene, const Poses& motion) {
  std::vector<std::unique_ptr<algorithms::Method>> methods;
  for (const char* name : kMethods) {
    const algorithms::Algorithm& row = *algorithms::find(name);
    methods.push_back(row.make(scene.bodies, algorithms::presets(row)));
  }
  scene.answers.resize(methods.size());
  std::vector<Pair> found;
  for (std::size_t s = 0; s < motion.size(); ++s) {
    const std::vector<geometry::PairRun> runs = geometry::pair_runs(scene.bodies, motion[s]);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      const std::size_t m = s % 2 ? methods.size() - 1 - i : i;
      if (s % kChunkSteps == 0) methods[m]->forget();
      double fastest = std::numeric_limits<double>::infinity();
      for (int repeat = 0; repeat < kRepeats; ++repeat) {
        found.clear();
        const double start = cpu_ms();
        methods[m]->prepare(motion[s]);
        methods[m]->answer(runs, found);
        fastest = std::min(fastest, cpu_ms() - start);
      }
      methods[m]->remember();
      std::ranges::sort(found);
      scene.answers[m].hits.append(found);
      scene.answers[m].ms.push_back(fastest);
    }
  }
}

double total_ms(const Answered& answers, Window window) {
  const auto begin = answers.ms.begin();
  return std::accumulate(begin + std::ptrdiff_t(window.first), begin + std::ptrdiff_t(window.last), 0.0);
}

PairLists hits_of(const Answered& answers, Window window) {
  PairLists hits;
  for (std::size_t s = window.first; s < window.last; ++s) hits.append(answers.hits.at(s));
  return hits;
}

/// FNV-1a over the pairs' numbers and where the steps end.
std::uint64_t hash(const PairLists& hits) {
  std::uint64_t h = 14695981039346656037u;
  const auto add = [&h](std::uint64_t n) { h = (h ^ n) * 1099511628211u; };
  for (const Pair& p : hits.pair) add(p.a), add(p.b);
  for (const std::uint64_t end : hits.offset) add(end);
  return h;
}

std::uint64_t differences(const PairLists& some, const PairLists& others) {
  std::uint64_t count = 0;
  for (std::size_t s = 0; s < some.steps(); ++s) {
    std::vector<Pair> rest;
    std::ranges::set_symmetric_difference(some.at(s), others.at(s), std::back_inserter(rest));
    count += rest.size();
  }
  return count;
}

void row(benchmark::State& state, Scene& scene, Window window, std::size_t method, const Poses& poses) {
  if (scene.answers.empty()) measure(scene, poses);
  const Answered& answers = scene.answers[method];
  const double total = total_ms(answers, window);
  for (auto _ : state) state.SetIterationTime(1e-3 * total);

  std::vector<double> times, cold;
  for (std::size_t s = window.first; s < window.last; ++s) {
    times.push_back(answers.ms[s]);
    if (s % kChunkSteps == 0) cold.push_back(times.back());
  }
  std::ranges::sort(times);
  state.counters["median"] = times[times.size() / 2];
  if (!cold.empty()) state.counters["cold"] = std::accumulate(cold.begin(), cold.end(), 0.0) / double(cold.size());
  state.counters["worst"] = times.back();
  state.counters["fcl_ratio"] = total_ms(scene.answers[kFcl], window) / total;
  state.counters["obb_ratio"] = total / total_ms(scene.answers[kObb], window);
  const PairLists hits = hits_of(answers, window);
  state.counters["differ"] = double(differences(hits, hits_of(scene.answers[kExact], window)));
  char text[96];
  std::snprintf(text, sizeof text, "steps %zu:%zu, %zu hits, hash %016llx", window.first, window.last, hits.pair.size(),
                static_cast<unsigned long long>(hash(hits)));
  state.SetLabel(text);
}

/// One line per scene and step that were measured.
void write_steps(const std::string& path, const std::vector<Scene>& scenes) {
  std::ofstream out(path);
  out << "scene,step,memory,hits";
  for (const char* name : kMethods) out << ',' << name << "_ms";
  out << '\n';
  for (const Scene& scene : scenes)
    for (std::size_t s = 0; !scene.answers.empty() && s < scene.answers[kExact].ms.size(); ++s) {
      out << scene.name << ',' << s << ',' << (s % kChunkSteps ? "kept" : "empty") << ','
          << scene.answers[kExact].hits.at(s).size();
      for (const Answered& answers : scene.answers) out << ',' << answers.ms[s];
      out << '\n';
    }
  if (!out.flush()) throw Error(kFile, path + ": cannot be written; choose another --per_step");
}

void run(int argc, char** argv) {
  std::string file = "results/padani.h5", per_step;
  constexpr std::string_view kPerStep = "--per_step=";
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.starts_with(kPerStep))
      per_step = argument.substr(kPerStep.size());
    else if (argument.starts_with("--"))
      throw Error(kUsage, argument + ": must be --per_step=FILE or an option of Google Benchmark");
    else
      file = argument;
  }
  if (const algorithms::Algorithm* row = algorithms::find_missing(kMethods[kFcl])) {
    std::fprintf(stderr, "exact_bench: skipped: %s needs %s\n", kMethods[kFcl], algorithms::remedy(*row).c_str());
    return;
  }
  const Result result = read_result(file);
  const std::size_t steps = result.steps(), landed = std::size_t(kLanded * result.rate);
  std::vector<std::pair<std::string, Window>> windows = {{"all", {0, steps}}, {"liveliest", liveliest(result)}};
  if (landed < steps) windows.push_back({"landed", {landed, steps}});
  std::vector<Scene> scenes = {
      {"recorded", result.bodies},
      {"spheres_64", with_spheres_as(result.bodies, finer)},
      {"knots", with_spheres_as(result.bodies, [](const Mesh& m) { return knot(m, 1); })},
      {"knots_crossing", with_spheres_as(result.bodies, [](const Mesh& m) { return knot(m, 1.5); })}};
  for (Scene& scene : scenes)
    for (const auto& [name, window] : windows)
      for (std::size_t method = 0; method < std::size(kMethods); ++method)
        benchmark::RegisterBenchmark((scene.name + '/' + name + '/' + kMethods[method]).c_str(),
                                     [&scene, &result, window, method](benchmark::State& state) {
                                       row(state, scene, window, method, result.motion);
                                     })
            ->Iterations(1)
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
  if (!per_step.empty()) write_steps(per_step, scenes);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  try {
    run(argc, argv);
  } catch (const Error& error) {
    std::fprintf(stderr, "exact_bench: %s\n", error.what());
    return error.code();
  }
}
