// How truth and `exact` grow with the number of bodies: heaps of the six shapes of configs/heap.toml, from 275 to
// 100,000 bodies, one core.
//
//   build/growth_bench [options of Google Benchmark]               in the project's folder: one shape is a file
//
// A heap is made, not simulated: bodies in any orientation on a jittered lattice, so narrow that a body meets about
// four others, on a plate. They quiver from step to step, each along a way of its own, by a few millimetres. Numbered
// along the lattice, as scenes number theirs, or shuffled: neighbours then lie far apart in memory. Columns:
//   Time      ms of a step: of the truth with what it makes for a step, of a method with its preparation; the processor's
//   us_body, us_hit   the same a body and a hit
//   slope     of log time over log bodies, from the next smaller heap of the same row
//   hits, tests       a body
//   B_body, B_hit     bytes that the allocator gave out for hierarchies, decision or method, after the steps
//   scene_B   a body, for meshes, bodies, a step of poses, where they rest and their ways
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/contract/algorithm.hpp"
#include "geometry/decision/meet.hpp"
#include "geometry/meshes/mesh_file.hpp"
#include "geometry/meshes/shapes.hpp"
#include "geometry/random.hpp"
#include "pipeline/system/input_file.hpp"

namespace {

using namespace geometry;

constexpr double kSpacing = 1.42;   // m between places
constexpr double kJitter = 0.15;    // m along each axis, at most
constexpr double kQuiver = 0.003;   // m
constexpr std::size_t kPhases = 8;  // steps of a quiver

std::vector<Mesh> shapes() {
  const std::string file = "configs/meshes/notched_l.obj";
  return {box("box", {1.6, 1.0, 1.2}),
          capsule("capsule", 2.2, 0.45, 0.45, 16),
          torus("torus", 1.5, 0.5, 24),
          torus_knot("knot", 0.7, 0.18, 64, 12, 2, 3),
          parse_mesh(pipeline::text_of_file(file, 1 << 20, "run this in the project's folder"), file, "notched_l"),
          sphere("sphere", 0.7, 16)};
}

struct Heap {
  Bodies bodies;
  std::vector<Pose> rest;  // of the bodies
  std::vector<Vec3> way;   // m, of its quiver

  Heap(std::size_t count, bool shuffled) {
    bodies.meshes = shapes();
    const std::size_t kinds = bodies.meshes.size();
    const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(count))));
    const double wide = kSpacing * static_cast<double>(side);
    bodies.meshes.push_back(box("plate", {2 * wide, 1, 2 * wide}));
    bodies.add("plate", static_cast<std::uint32_t>(kinds), true);
    rest.push_back({{}, Vec3(wide / 2, -0.5, wide / 2)});
    way.push_back(Vec3::Zero());
    std::vector<std::size_t> place(count - 1);
    for (std::size_t i = 0; i < place.size(); ++i) place[i] = i;
    Random order(20220801);
    for (std::size_t i = place.size(); shuffled && i > 1; --i) std::swap(place[i - 1], place[order.next() % i]);
    for (const std::size_t i : place) {
      Random random = Random::of(1, i);  // the same heap, however it is numbered
      const auto vector = [&](double most) {
        return Vec3{most * random.signed_unit(), most * random.signed_unit(), most * random.signed_unit()};
      };
      const Vec3 lattice(double(i / side % side), 0.5 + double(i / side / side), double(i % side));
      bodies.add(std::to_string(bodies.size()), static_cast<std::uint32_t>(random.next() % kinds));
      rest.push_back({random.rotation(), kSpacing * lattice + vector(kJitter)});
      way.push_back(vector(kQuiver));
    }
  }

  std::vector<Pose> at(std::size_t step) const {
    std::vector<Pose> poses = rest;
    for (std::size_t b = 0; b < poses.size(); ++b)
      poses[b].t += std::sin(2 * std::numbers::pi * double(step % kPhases) / kPhases + double(b)) * way[b];
    return poses;
  }
};

double now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double given_out() { return double(mallinfo2().uordblks + mallinfo2().hblkhd); }

/// What answers step after step, and the tests that it made for the last.
struct Asked {
  std::function<void(const std::vector<Pose>&, std::vector<Pair>&)> step;
  std::function<void()> remember;
  std::function<std::uint64_t(const std::vector<Pose>&)> tests;
};

void grow(benchmark::State& state, const std::string& row, const std::function<Asked(const Bodies&)>& make) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const double empty = given_out();
  const Heap heap(count, state.range(1) != 0);
  std::vector<Pose> poses = heap.at(0);
  const double scene = given_out() - empty, before = given_out();
  double held = 0;
  std::vector<Pair> hits;
  double seconds = 0, found = 0, tests = 0;
  {
    const Asked asked = make(heap.bodies);
    std::size_t step = 0;
    const auto ask = [&] {
      poses = heap.at(step++);
      hits.clear();
      const double start = now();
      asked.step(poses, hits);
      const double took = now() - start;
      asked.remember();
      return took;
    };
    for (std::size_t i = 0; i < 2; ++i) ask();  // the memory is filled, the vectors have grown
    for (auto _ : state) {
      const double took = ask();
      state.SetIterationTime(took);
      seconds += took;
      found += double(hits.size());
    }
    tests = double(asked.tests(poses));
    held = given_out() - before;
  }
  const double steps = double(state.iterations()), n = double(count);
  const double step_seconds = seconds / steps, each = found / steps;
  static std::map<std::pair<std::string, bool>, std::map<double, double>> measured;  // by row: seconds by bodies
  std::map<double, double>& sizes = measured[{row, state.range(1) != 0}];
  sizes[n] = step_seconds;
  if (const auto here = sizes.find(n); here != sizes.begin()) {
    const auto& [fewer, faster] = *std::prev(here);
    state.counters["slope"] = std::log(step_seconds / faster) / std::log(n / fewer);
  }
  state.counters["us_body"] = 1e6 * step_seconds / n;
  state.counters["us_hit"] = 1e6 * step_seconds / each;
  state.counters["hits"] = each / n;
  state.counters["tests"] = tests / n;
  state.counters["B_body"] = held / n;
  state.counters["B_hit"] = held / each;
  state.counters["scene_B"] = scene / n;
}

void truth(benchmark::State& state) {
  grow(state, "truth", [](const Bodies& bodies) {
    const auto bvhs = std::make_shared<std::vector<Bvh>>(build_bvhs(bodies));
    const auto decision = std::make_shared<Decision>(bodies, *bvhs);
    return Asked{[&bodies, bvhs, decision](const std::vector<Pose>& poses, std::vector<Pair>& hits) {
                   const std::vector<PairRun> runs = pair_runs(bodies, poses);
                   decision->prepare(poses);
                   decision->hits(runs, hits);
                 },
                 [decision] { decision->remember(); },
                 [decision](const std::vector<Pose>&) { return decision->operations(); }};
  });
}

void method(benchmark::State& state, const std::string& name) {
  grow(state, name, [&](const Bodies& bodies) {
    const algorithms::Algorithm& row = *algorithms::find(name);
    const std::shared_ptr<algorithms::Method> made = row.make(bodies, algorithms::presets(row));
    const auto runs = std::make_shared<std::vector<PairRun>>();
    return Asked{[&bodies, made, runs](const std::vector<Pose>& poses, std::vector<Pair>& hits) {
                   if (runs->empty()) *runs = pair_runs(bodies, poses);  // all are there at all steps
                   made->prepare(poses);
                   made->answer(*runs, hits);
                 },
                 [made] { made->remember(); },
                 [made, runs](const std::vector<Pose>& poses) {
                   std::vector<Pair> again;
                   made->prepare(poses);
                   return made->count(*runs, again);
                 }};
  });
}

void sizes(benchmark::internal::Benchmark* row) {
  row->ArgNames({"bodies", "shuffled"})->ArgsProduct({{275, 2750, 27500, 100000}, {0, 1}});
  row->UseManualTime()->Unit(benchmark::kMillisecond);
}
BENCHMARK(truth)->Apply(sizes);
BENCHMARK_CAPTURE(method, exact, "exact")->Apply(sizes);
BENCHMARK_CAPTURE(method, exact_cold, "exact_cold")->Apply(sizes);

}  // namespace

BENCHMARK_MAIN();
