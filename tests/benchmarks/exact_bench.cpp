// What exactness costs: `exact` with and without memory beside FCL's inexact answer and obb_sat, on recorded motion.
//
//   build/exact_bench [RESULT.h5] [--per_step=FILE.csv] [options of Google Benchmark]
//
// The motion is that of a result file, results/padani.h5 unless another is given (scripts/bench makes it). All methods
// answer the same steps in one process, in turns, timed by the detect stage itself: the fastest of three passes,
// preparation included, memories emptied at the first step and every 50. A case is measured once, when its first row is
// asked for. Columns of a row:
//   Time        ms of all steps of the case
//   median      ms of a step
//   cold        ms of the steps that start with an empty memory, mean
//   worst       ms of the dearest step
//   fcl_ratio   FCL's time over this one's, of all steps
//   obb_ratio   this time over obb_sat's
//   differ      answers that differ from exact's
// and the hits with a hash of them, so that a speed-up cannot quietly change an answer.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "geometry/shapes.hpp"
#include "pipeline/detect.hpp"
#include "pipeline/error.hpp"
#include "pipeline/provenance.hpp"
#include "pipeline/store.hpp"

namespace {

using namespace pipeline;
using geometry::Bodies;
using geometry::Mesh;
using Poses = std::vector<std::vector<geometry::Pose>>;

constexpr const char* kMethods[] = {"fcl_bvh", "exact", "exact_cold", "obb_sat"};
constexpr double kLanded = 3.9;         // s: the last sphere of configs/padani.toml lies
constexpr std::size_t kLiveliest = 60;  // steps
constexpr std::int64_t kRepeats = 3;

/// Steps of the motion, first <= step < last.
struct Window {
  std::size_t first, last;
};

struct Case {
  std::string name;
  Bodies bodies;
  Window window;
  std::vector<Answers> answers = {};  // of kMethods; empty: not measured yet
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

/// Babylon.js's torus knot of 2048 facets, scaled so that it just fits into the sphere.
Mesh knot(const Mesh& sphere) {
  Mesh mesh = geometry::torus_knot(sphere.name, 3, 0.5, 32, 32, 2, 3);
  double reach = 0;
  for (const geometry::Vec3& v : mesh.vertices) reach = std::max(reach, v.norm());
  for (geometry::Vec3& v : mesh.vertices) v *= sphere.sphere_radius / reach;
  return mesh;
}

void measure(Case& c, const Poses& motion) {
  const Poses poses(motion.begin() + std::ptrdiff_t(c.window.first), motion.begin() + std::ptrdiff_t(c.window.last));
  Truth none;  // answers are compared with one another
  for (std::size_t s = 0; s < poses.size(); ++s) none.hits.append({});
  std::vector<AlgorithmChoice> choices;
  for (const char* name : kMethods) choices.push_back(parse_algorithm(name));
  Progress quiet("detect", poses.size(), true);
  c.answers = detect(c.bodies, poses, none, choices, kRepeats, machine(), nullptr, quiet);
}

double total_ms(const Answers& answers) {
  return 1e-6 * double(std::accumulate(answers.time_ns.begin(), answers.time_ns.end(), std::int64_t{0}));
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

void row(benchmark::State& state, Case& c, std::size_t method, const Poses& motion) {
  if (c.answers.empty()) measure(c, motion);
  const Answers& answers = c.answers[method];
  for (auto _ : state) state.SetIterationTime(1e-3 * total_ms(answers));

  std::vector<std::int64_t> times = answers.time_ns;
  double cold = 0;
  for (std::size_t s = 0; s < times.size(); s += kChunkSteps) cold += double(times[s]);
  const std::size_t chunks = (times.size() + kChunkSteps - 1) / kChunkSteps;
  std::ranges::sort(times);
  state.counters["median"] = 1e-6 * double(times[times.size() / 2]);
  state.counters["cold"] = 1e-6 * cold / double(chunks);
  state.counters["worst"] = 1e-6 * double(times.back());
  state.counters["fcl_ratio"] = total_ms(c.answers[0]) / total_ms(answers);
  state.counters["obb_ratio"] = total_ms(answers) / total_ms(c.answers[3]);
  state.counters["differ"] = double(differences(answers.hits, c.answers[1].hits));
  char text[96];
  std::snprintf(text, sizeof text, "steps %zu:%zu, %zu hits, hash %016llx", c.window.first, c.window.last,
                answers.hits.pair.size(), static_cast<unsigned long long>(hash(answers.hits)));
  state.SetLabel(text);
}

/// One line per case and step that were measured.
void write_steps(const std::string& path, const std::vector<Case>& cases) {
  std::ofstream out(path);
  out << "case,step,memory,hits";
  for (const char* name : kMethods) out << ',' << name << "_ms";
  out << '\n';
  for (const Case& c : cases)
    for (std::size_t s = 0; !c.answers.empty() && s < c.window.last - c.window.first; ++s) {
      out << c.name << ',' << c.window.first + s << ',' << (s % kChunkSteps ? "kept" : "empty") << ','
          << c.answers[1].hits.at(s).size();
      for (const Answers& answers : c.answers) out << ',' << 1e-6 * double(answers.time_ns[s]);
      out << '\n';
    }
  if (!out.flush()) throw Error(kFile, path + ": cannot be written; choose another --per_step");
}

void run(int argc, char** argv) {
  std::string file = "results/padani.h5", per_step;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.starts_with("--per_step="))
      per_step = argument.substr(argument.find('=') + 1);
    else
      file = argument;
  }
  const Result result = read_result(file);
  const std::size_t landed = std::min(std::size_t(kLanded * result.rate), result.steps() - 1);
  const Window all{0, result.steps()}, after{landed, result.steps()}, lively = liveliest(result);
  const Bodies fine = with_spheres_as(result.bodies, finer), knots = with_spheres_as(result.bodies, knot);
  std::vector<Case> cases = {{"spheres_16/landed", result.bodies, after},
                             {"spheres_16/liveliest", result.bodies, lively},
                             {"spheres_16/all", result.bodies, all},
                             {"spheres_64/landed", fine, after},
                             {"spheres_64/liveliest", fine, lively},
                             {"spheres_64/all", fine, all},
                             {"knots/landed", knots, after},
                             {"knots/liveliest", knots, lively},
                             {"knots/all", knots, all}};
  for (Case& c : cases)
    for (std::size_t method = 0; method < std::size(kMethods); ++method)
      benchmark::RegisterBenchmark(
          (c.name + '/' + kMethods[method]).c_str(),
          [&c, &result, method](benchmark::State& state) { row(state, c, method, result.motion); })
          ->Iterations(1)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
  if (!per_step.empty()) write_steps(per_step, cases);
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
