// The motion against closed forms where nothing touches; restarts; every way to fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <limits>

#include "tests/support/rigid.hpp"

namespace {

using namespace rigid;

bool same_bits(const std::vector<BodyState>& a, const std::vector<BodyState>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const BodyState& x, const BodyState& y) {
           using Bits = std::array<std::uint64_t, sizeof(BodyState) / 8>;
           return std::bit_cast<Bits>(x) == std::bit_cast<Bits>(y);
         });
}

/// A plate and a few balls that bounce, roll and hit each other.
struct Heap {
  std::vector<RigidBody> bodies{box({10, 1, 10}, true)};
  std::vector<BodyState> states{at({0, -1, 0})};
  Heap() {
    for (int i = 0; i < 4; ++i) {
      bodies.push_back(ball());
      states.push_back(at({0.3 * i, 1 + 2.1 * i, 0.2 * i}, {0.5, -1, 0.1 * i}));
    }
  }
};

// ---- motion without contact

TEST(Simulate, FreeFallFollowsTheParabola) {
  Physics physics = lossless();
  physics.gravity = {0, -kGravity, 0};
  Simulation simulation({ball()}, physics, {at({1, 100, 2}, {3, 4, 5})}, 10);
  advance(simulation, 11.5);
  const auto state = simulation.states()[0];
  EXPECT_NEAR(state.position[0], 1 + 3 * 1.5, 1e-12);
  EXPECT_NEAR(state.position[1], 100 + 4 * 1.5 - kGravity * 1.5 * 1.5 / 2, 1e-11);
  EXPECT_NEAR(state.velocity[1], 4 - kGravity * 1.5, 1e-12);
}

TEST(Simulate, LinearDampingFollowsTheExponential) {
  Physics physics = lossless();
  physics.gravity = {0, -kGravity, 0};
  physics.linear_damping = 0.7;
  physics.accuracy = 1e-8;
  Simulation simulation({ball()}, physics, {at({0, 100, 0})}, 0);
  advance(simulation, 2);
  EXPECT_NEAR(simulation.states()[0].velocity[1], -kGravity / 0.7 * (1 - std::exp(-0.7 * 2)), 1e-8);
}

// The torque -c I w takes the angular momentum of any body to zero as exp(-c t), whatever the body does meanwhile.
TEST(Simulate, AngularDampingTakesMomentumOfATumblingBox) {
  Physics physics = lossless();
  physics.angular_damping = 0.5;
  physics.accuracy = 1e-9;
  const RigidBody body = box({0.5, 1, 2}, false);
  BodyState state;
  state.angular_velocity = {1, 2, 3};
  Simulation simulation({body}, physics, {state}, 0);
  const double energy = simulation.sample().kinetic_energy;
  const double third = body.mass / 3;
  const Vector inertia{third * (1 + 4), third * (0.25 + 4), third * (0.25 + 1)};
  double expected_energy = 0;
  for (int axis = 0; axis < 3; ++axis) expected_energy += inertia[axis] * (axis + 1) * (axis + 1) / 2;
  EXPECT_NEAR(energy, expected_energy, 1e-12 * energy);

  advance(simulation, 1);
  const auto after = simulation.states()[0];
  // Momentum = R I R^T w; only its length and direction in ground matter.
  const auto& [w, x, y, z] = after.orientation;
  const std::array<Vector, 3> columns{Vector{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                                      Vector{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                                      Vector{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
  Vector momentum{};
  for (int axis = 0; axis < 3; ++axis)
    momentum = momentum + inertia[axis] * dot(columns[axis], after.angular_velocity) * columns[axis];
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(momentum[axis], inertia[axis] * (axis + 1) * std::exp(-0.5), 1e-6 * length(momentum));
}

TEST(Simulate, BoxesPassThroughBoxes) {
  Physics physics = lossless();
  Simulation simulation({box({5, 1, 5}, true), box({1, 1, 1}, false)}, physics,
                        {at({0, 0, 0}), at({0, 3, 0}, {0, -3, 0})}, 0);
  advance(simulation, 1);
  EXPECT_EQ(simulation.sample().contacts, 0);
  advance(simulation, 2);
  EXPECT_NEAR(simulation.states()[1].position[1], -3, 1e-12);
}

// ---- integrators, restarts, determinism

class SimulateBy : public testing::TestWithParam<std::string> {};

TEST_P(SimulateBy, DroppedBallBouncesAndSettles) {
  Physics physics;
  physics.integrator = GetParam();
  physics.accuracy = 1e-4;
  Simulation simulation({box({5, 1, 5}, true), ball()}, physics, {at({0, -1, 0}), at({0, 1.5, 0})}, 0);
  PhysicsSample sample;
  double highest_after = 0;
  std::int64_t steps = 0, evaluations = 0;
  for (int i = 1; i <= 60; ++i) {
    ASSERT_EQ(simulation.advance_to(i / 60., sample), "");
    if (i > 30) highest_after = std::max(highest_after, simulation.states()[1].position[1]);
    steps += sample.integrator_steps;
    evaluations += sample.force_evaluations;
    EXPECT_GE(sample.time_ns, sample.contact_time_ns);
    EXPECT_GE(sample.contact_time_ns, 0);
    EXPECT_GE(sample.rejected_steps, 0);
  }
  // It fell 0.5 m in 0.32 s and came back a little less high.
  EXPECT_GT(highest_after, 1.2);
  EXPECT_LT(highest_after, 1.5);
  EXPECT_GE(steps, 60);
  EXPECT_GE(evaluations, steps - 1);  // the first was made when it was constructed
}

// The caller looks at interpolated states; the steps are the same however often it looks.
TEST_P(SimulateBy, LookingDoesNotChangeTheMotion) {
  const Heap heap;
  Physics physics;
  physics.integrator = GetParam();
  Simulation once(heap.bodies, physics, heap.states, 0), often(heap.bodies, physics, heap.states, 0);
  advance(once, 0.25);
  for (int i = 1; i <= 32; ++i) advance(often, i / 128.);
  EXPECT_TRUE(same_bits(once.states(), often.states()));
}

TEST_P(SimulateBy, RestartHasTheSameBits) {
  const Heap heap;
  Physics physics;
  physics.integrator = GetParam();
  // A chain of restarts, run twice; the second time each link is built while others are alive and have run on.
  std::vector<std::vector<BodyState>> links{heap.states};
  double reference = 0;
  for (int link = 0; link < 3; ++link) {
    Simulation simulation(heap.bodies, physics, links.back(), link / 6., reference);
    reference = simulation.reference_energy();
    for (int i = 1; i <= 10; ++i) advance(simulation, (10 * link + i) / 60.);
    links.push_back(simulation.states());
  }
  Simulation first(heap.bodies, physics, heap.states, 0, reference);
  for (int link = 2; link >= 0; --link) {
    advance(first, (3 - link) / 10.);
    Simulation simulation(heap.bodies, physics, links[link], link / 6., reference);
    for (int i = 1; i <= 10; ++i) advance(simulation, (10 * link + i) / 60.);
    EXPECT_TRUE(same_bits(simulation.states(), links[link + 1])) << "link " << link;
  }
}

INSTANTIATE_TEST_SUITE_P(Integrators, SimulateBy, testing::ValuesIn(pipeline::integrator_names()),
                         [](const auto& info) { return info.param; });

TEST(Simulate, RestartBeginsAtTheGivenStates) {
  const Heap heap;
  Simulation simulation(heap.bodies, Physics(), heap.states, 0);
  EXPECT_TRUE(same_bits(simulation.states(), heap.states));
  advance(simulation, 0.5);
  auto states = simulation.states();
  Simulation again(heap.bodies, Physics(), states, 0.5);
  const auto begun = again.states();
  // Simbody normalises the quaternions that have drifted.
  for (std::size_t i = 0; i < states.size(); ++i)
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(begun[i].orientation[k], states[i].orientation[k], 1e-3);
      states[i].orientation[k] = begun[i].orientation[k];
    }
  EXPECT_TRUE(same_bits(begun, states));
  EXPECT_EQ(again.sample().energy, simulation.sample().energy);
}

TEST(Simulate, SampleCountsNothingSince) {
  const Heap heap;
  Simulation simulation(heap.bodies, Physics(), heap.states, 0);
  advance(simulation, 0.1);
  const PhysicsSample sample = simulation.sample();
  EXPECT_EQ(sample.integrator_steps + sample.rejected_steps + sample.force_evaluations, 0);
  EXPECT_EQ(sample.time_ns + sample.contact_time_ns, 0);
}

TEST(Simulate, ReferenceEnergyIsAtLeastThatOfTheStart) {
  const Heap heap;
  Simulation simulation(heap.bodies, Physics(), heap.states, 0);
  EXPECT_GE(simulation.reference_energy(), simulation.sample().energy);
  EXPECT_EQ(Simulation(heap.bodies, Physics(), heap.states, 0, 5).reference_energy(), 5);
  EXPECT_GT(Simulation({ball()}, lossless(), {at({0, 0, 0})}, 0).reference_energy(), 0) << "nothing moves";
}

// ---- failures

TEST(Simulate, StepBudgetEndsTheRun) {
  const Heap heap;
  Physics physics;
  physics.step_budget = 3;
  Simulation simulation(heap.bodies, physics, heap.states, 0);
  PhysicsSample sample;
  const std::string reason = simulation.advance_to(1, sample);
  EXPECT_NE(reason.find("more than 3 steps"), std::string::npos) << reason;
  EXPECT_LE(sample.integrator_steps, 4);
  EXPECT_EQ(simulation.advance_to(2, sample), reason) << "it stays failed";
}

// A step that is rejected again and again returns no control; the force ends it.
TEST(Simulate, ForceEvaluationsEndTheRun) {
  Physics physics;
  physics.integrator = "CPodesBDF";  // 13 evaluations per body for each Jacobian
  physics.step_budget = 1;
  std::vector<RigidBody> bodies(10, ball());
  std::vector<BodyState> states;
  for (int i = 0; i < 10; ++i) states.push_back(at({1.9 * i, 0, 0}));
  Simulation simulation(bodies, physics, states, 0);
  PhysicsSample sample;
  const std::string reason = simulation.advance_to(1, sample);
  EXPECT_NE(reason.find("more than 50 force evaluations"), std::string::npos) << reason;
  EXPECT_LE(sample.force_evaluations, 51);
}

TEST(Simulate, TimeBudgetEndsTheRun) {
  const Heap heap;
  Physics physics;
  PhysicsSample sample;
  for (const double budget : {0., 1e-3}) {
    physics.time_budget = budget;
    Simulation simulation(heap.bodies, physics, heap.states, 0);
    const auto start = std::chrono::steady_clock::now();
    const std::string reason = simulation.advance_to(1000, sample);
    EXPECT_NE(reason.find("wall time"), std::string::npos) << reason;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  }
}

// A fixed step of 10 ms is far too long for this stiffness: the first contact throws the ball away.
TEST(Simulate, EnergyBoundEndsTheRun) {
  Physics physics;
  physics.integrator = "SemiExplicitEuler";
  physics.accuracy = 0.01;
  physics.material.stiffness = 1e12;
  Simulation simulation({box({5, 1, 5}, true), ball()}, physics, {at({0, -1, 0}), at({0, 3, 0})}, 0);
  PhysicsSample sample;
  std::string reason;
  for (int i = 1; i <= 120 && reason.empty(); ++i) reason = simulation.advance_to(i / 60., sample);
  EXPECT_NE(reason.find("energy grew"), std::string::npos) << reason;
  EXPECT_GT(sample.energy, 10 * simulation.reference_energy());
}

// Forces overflow at once: infinities in the state must end as text, in every integrator, not as NaN rows or an abort.
TEST_P(SimulateBy, OverflowEndsAsText) {
  Physics physics;
  physics.integrator = GetParam();
  physics.material.stiffness = 1e308;
  physics.step_budget = 1000;
  Simulation simulation({box({5, 1, 5}, true), ball()}, physics, {at({0, -1, 0}), at({0, 0.5, 0})}, 0);
  PhysicsSample sample;
  const std::string reason = simulation.advance_to(0.1, sample);
  EXPECT_NE(reason, "");
  EXPECT_EQ(reason.find('\n'), std::string::npos) << reason;
}

TEST(Simulate, TimeDoesNotGoBack) {
  const Heap heap;
  PhysicsSample sample;
  Simulation simulation(heap.bodies, Physics(), heap.states, 1);
  EXPECT_EQ(simulation.advance_to(1, sample), "");
  EXPECT_NE(simulation.advance_to(0.5, sample), "");
  Simulation other(heap.bodies, Physics(), heap.states, 1);
  EXPECT_NE(other.advance_to(std::numeric_limits<double>::quiet_NaN(), sample), "");
}

TEST(Simulate, NonsenseIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto refused = [](const char* what, auto change) {
    std::vector bodies{box({1, 1, 1}, true), ball(), box({1, 1, 1}, false)};
    std::vector states{at({0, 0, 0}), at({5, 0, 0}), at({9, 0, 0})};
    Physics physics;
    Simulation(bodies, physics, states, 0);  // is fine before the change
    change(bodies, physics, states);
    EXPECT_THROW(Simulation(bodies, physics, states, 0), std::invalid_argument) << what;
  };
  refused("position", [&](auto&, auto&, auto& s) { s[1].position[2] = nan; });
  refused("fixed position", [&](auto&, auto&, auto& s) { s[0].position[2] = nan; });
  refused("velocity", [&](auto&, auto&, auto& s) { s[1].velocity[0] = infinity; });
  refused("angular velocity", [&](auto&, auto&, auto& s) { s[1].angular_velocity[0] = nan; });
  refused("quaternion", [&](auto&, auto&, auto& s) { s[1].orientation = {0, 0, 0, 0}; });
  refused("NaN quaternion", [&](auto&, auto&, auto& s) { s[1].orientation[3] = nan; });
  refused("number of states", [&](auto&, auto&, auto& s) { s.pop_back(); });
  refused("mass", [&](auto& b, auto&, auto&) { b[1].mass = -1; });
  refused("mass of a box", [&](auto& b, auto&, auto&) { b[2].mass = 0; });
  refused("inertia", [&](auto& b, auto&, auto&) { b[1].inertia = 0; });
  refused("radius", [&](auto& b, auto&, auto&) { b[1].radius = nan; });
  refused("half extents", [&](auto& b, auto&, auto&) { b[0].half_extents[1] = 0; });
  refused("nothing moves", [&](auto& b, auto&, auto&) { b[1].fixed = b[2].fixed = true; });
  refused("integrator", [&](auto&, auto& p, auto&) { p.integrator = "Euler"; });
  refused("accuracy", [&](auto&, auto& p, auto&) { p.accuracy = 0; });
  refused("gravity", [&](auto&, auto& p, auto&) { p.gravity[0] = nan; });
  refused("damping", [&](auto&, auto& p, auto&) { p.linear_damping = -1; });
  refused("stiffness", [&](auto&, auto& p, auto&) { p.material.stiffness = 0; });
  refused("friction", [&](auto&, auto& p, auto&) { p.material.dynamic_friction = 0.6; });
  refused("transition velocity", [&](auto&, auto& p, auto&) { p.material.transition_velocity = 0; });
  refused("step budget", [&](auto&, auto& p, auto&) { p.step_budget = 0; });
}

TEST(Simulate, NamesTheLoadedLibraries) {
  const auto libraries = pipeline::simulation_libraries();
  ASSERT_GE(libraries.size(), 3u);
  EXPECT_EQ(libraries[0].first, "simbody");
  EXPECT_EQ(libraries[0].second.rfind("3.7", 0), 0u) << libraries[0].second;
  for (const std::string name : {"blas", "lapack"}) {
    const auto is_it = [&](const auto& row) {
      return row.first == name && row.second.find(".so") != std::string::npos;
    };
    EXPECT_EQ(std::count_if(libraries.begin(), libraries.end(), is_it), 1) << name;
  }
  for (const auto& [name, version] : libraries) EXPECT_NE(version[0], '/') << version;
}

}  // namespace
