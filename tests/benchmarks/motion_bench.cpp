// What the motion costs: a block of spheres that touch, on a plate, as free bodies and as Simbody's multibody tree in
// turn, one core. Times are of the processor, medians over the repetitions, per moving body and evaluation of the
// forces; the ratio is that of neighbours in time. Beside them stand evaluations, rejected steps and the share of
// contact, of free bodies.
//
// The argument is the number of spheres.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pipeline/physics/simulate.hpp"

namespace {

using namespace pipeline;

constexpr double kTime = 0.1;  // s of motion

/// Spheres of radius 1 m in a cubic lattice, jittered by millimetres, that begin a little closer than they rest.
struct Block {
  std::vector<RigidBody> bodies;
  std::vector<BodyState> states;

  explicit Block(int count) {
    std::mt19937_64 bits(20220801);
    const auto real = [&] { return static_cast<double>(static_cast<std::int64_t>(bits())) * 0x1p-63; };
    const int side = static_cast<int>(std::ceil(std::cbrt(count)));
    RigidBody plate;
    plate.fixed = true;
    plate.sphere = false;
    plate.half_extents = {4.0 * side, 1, 4.0 * side};
    BodyState below;
    below.position = {0, -1, 0};
    bodies.push_back(plate);
    states.push_back(below);
    RigidBody ball;
    ball.mass = 1000 * 4. / 3. * std::numbers::pi;
    ball.inertia = 0.4 * ball.mass;
    for (int i = 0; i < count; ++i) {
      BodyState state;
      const double cell[] = {double(i % side), double(i / side / side), double(i / side % side)};
      for (int axis = 0; axis < 3; ++axis) {
        state.position[axis] = (axis == 1 ? 0.99 : -side) + 1.99 * cell[axis] + 0.003 * real();
        state.velocity[axis] = real();
      }
      bodies.push_back(ball);
      states.push_back(state);
    }
  }
};

std::int64_t processor_ns() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

struct Cost {
  double ns = 0;  // per moving body and evaluation
  PhysicsSample sample;
};

Cost motion(const Block& block, BodyModel model) {
  Physics physics;
  physics.bodies = model;
  Simulation simulation(block.bodies, physics, block.states, 0);
  Cost out;
  const std::int64_t start = processor_ns();
  const std::string why = simulation.advance_to(kTime, out.sample);
  out.ns = double(processor_ns() - start) / double(block.bodies.size() - 1) / double(out.sample.force_evaluations);
  if (!why.empty()) {
    std::fprintf(stderr, "the motion failed: %s\n", why.c_str());
    std::exit(1);
  }
  return out;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void free_against_tree(benchmark::State& state) {
  const Block block(static_cast<int>(state.range(0)));
  std::vector<double> free_ns, tree_ns, ratio;
  PhysicsSample sample;
  for (auto _ : state) {
    const Cost tree = motion(block, BodyModel::tree), free = motion(block, BodyModel::free);
    tree_ns.push_back(tree.ns);
    free_ns.push_back(free.ns);
    ratio.push_back(free.ns / tree.ns);
    sample = free.sample;
  }
  state.counters["free_ns"] = median(free_ns);
  state.counters["tree_ns"] = median(tree_ns);
  state.counters["ratio"] = median(ratio);
  state.counters["evaluations"] = double(sample.force_evaluations);
  state.counters["rejected"] = double(sample.rejected_steps);
  state.counters["contacts"] = double(sample.contacts);
  state.counters["contact_share"] = double(sample.contact_time_ns) / double(sample.time_ns);
}

BENCHMARK(free_against_tree)->Arg(274)->Iterations(15)->Unit(benchmark::kMillisecond);
BENCHMARK(free_against_tree)->Arg(2744)->Iterations(3)->Unit(benchmark::kMillisecond);
BENCHMARK(free_against_tree)->Arg(27000)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
