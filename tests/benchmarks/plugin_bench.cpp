// What the way through a shared library costs: bounding spheres of the last steps of a motion by the built-in method
// and by the examples of algorithms/plugin/, in this process, in turn, so that whatever slows one slows the other. The
// ratio is the median over the repetitions of neighbours in time; at most 1.1 is promised.
//
// The motion is results/padani.h5 (or the file that PLUGIN_BENCH names), as scripts/bench makes it.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "algorithms/contract/algorithm.hpp"
#include "pipeline/result/store.hpp"
#include "tests/support/plugins.hpp"

namespace {

using algorithms::Algorithm;
using algorithms::Method;
using geometry::Pair;

struct Step {
  std::vector<geometry::Pose> poses;
  std::vector<geometry::PairRun> runs;
};

struct Motion {
  geometry::Bodies bodies;
  std::vector<Step> steps;
};

constexpr std::size_t kSteps = 50;  // the last of the motion

Motion recorded(const std::string& path) {
  pipeline::Result result = pipeline::read_result(path);
  Motion out{std::move(result.bodies), {}};
  const std::size_t first = result.motion.size() > kSteps ? result.motion.size() - kSteps : 0;
  for (std::size_t s = first; s < result.motion.size(); ++s) {
    auto runs = geometry::pair_runs(out.bodies, result.motion[s]);
    out.steps.push_back({std::move(result.motion[s]), std::move(runs)});
  }
  return out;
}

double ns(Method& method, const Step& step, std::vector<Pair>& hits) {
  using Clock = std::chrono::steady_clock;
  hits.clear();
  const auto start = Clock::now();
  method.prepare(step.poses);
  method.answer(step.runs, hits);
  return double(std::chrono::nanoseconds(Clock::now() - start).count());
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The two in turn, the first of them changing, step by step.
void against_built_in(benchmark::State& state, const Algorithm& row, const Motion& motion) {
  const Algorithm& own_row = *algorithms::find("bounding_sphere");
  const auto own = own_row.make(motion.bodies, algorithms::presets(own_row));
  const auto other = row.make(motion.bodies, algorithms::presets(row));
  std::vector<Pair> own_hits, other_hits;
  std::vector<double> ratios, own_ns, other_ns;
  std::size_t i = 0;
  for (auto _ : state) {
    const Step& step = motion.steps[i % motion.steps.size()];
    double a, b;
    if (i / motion.steps.size() % 2 == 0) {
      a = ns(*own, step, own_hits);
      b = ns(*other, step, other_hits);
    } else {
      b = ns(*other, step, other_hits);
      a = ns(*own, step, own_hits);
    }
    if (own_hits != other_hits) {
      state.SkipWithError("the answers differ");
      return;
    }
    own_ns.push_back(a);
    other_ns.push_back(b);
    ratios.push_back(b / a);
    state.SetIterationTime(b * 1e-9);
    ++i;
  }
  state.counters["built_in_us"] = median(own_ns) * 1e-3;
  state.counters["plugin_us"] = median(other_ns) * 1e-3;
  state.counters["ratio"] = median(ratios);
}

}  // namespace

int main(int argc, char** argv) {
  const char* given = std::getenv("PLUGIN_BENCH");
  const std::string path = given ? given : "results/padani.h5";
  const Motion motion = recorded(path);
  plugins::add_examples();
  std::vector<std::string> names = {"bounding_sphere"};  // against itself: what the measurement is worth
  for (const std::string& name : plugins::examples()) names.push_back(name);
  for (const std::string& name : names)
    benchmark::RegisterBenchmark(
        ("plugin/" + name).c_str(),
        [&motion, row = algorithms::find(name)](benchmark::State& state) { against_built_in(state, *row, motion); })
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
