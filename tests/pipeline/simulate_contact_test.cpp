// Contact against closed forms, conservation laws and brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/rigid.hpp"

namespace {

using namespace rigid;

/// N / m^(3/2): force = hertz * depth^(3/2) of a ball on a plate of the same material.
double hertz(const Physics& physics, double radius) {
  const double k = std::pow(physics.material.stiffness, 2. / 3.) / 2;
  return 4. / 3. * std::pow(k, 1.5) * std::sqrt(radius);
}

/// One step of semi-explicit Euler has u(t + h) = u + h u'(t).
std::vector<Vector> accelerations(const std::vector<RigidBody>& bodies, Physics physics,
                                  const std::vector<BodyState>& states) {
  physics.integrator = "SemiExplicitEuler";
  physics.accuracy = 1e-3;
  physics.energy_bound = 1e300;
  Simulation simulation(bodies, physics, states, 0);
  advance(simulation, 1e-3);
  std::vector<Vector> out;
  for (std::size_t i = 0; i < states.size(); ++i)
    out.push_back(1e3 * (simulation.states()[i].velocity - states[i].velocity));
  return out;
}

// ---- contact with a plate

TEST(Simulate, BallComesToRestAtHertzDepth) {
  Physics physics;
  physics.linear_damping = 20;
  physics.accuracy = 1e-5;
  const RigidBody body = ball(0.985);
  Simulation simulation({box({5, 1, 5}, true), body}, physics, {at({0, -1, 0}), at({0, 0.985, 0})}, 0);
  advance(simulation, 3);
  const double depth = std::pow(body.mass * kGravity / hertz(physics, 0.985), 2. / 3.);
  EXPECT_NEAR(simulation.sample().greatest_penetration, depth, 1e-4 * depth);
  EXPECT_EQ(simulation.sample().contacts, 1);
}

// m v^2 / 2 = 2/5 H x^(5/2) at the deepest point x; the time is 2 x / v times the integral of 1 / sqrt(1 - s^(5/2))
// over 0..1, which is 2/5 B(2/5, 1/2): 2.943 x / v in all.
TEST(Simulate, LosslessBounceTakesHertzTimeAndKeepsEnergy) {
  Physics physics = lossless();
  physics.accuracy = 1e-9;
  const RigidBody body = ball();
  const double speed = 5, gap = 1;
  Simulation simulation({box({5, 1, 5}, true), body}, physics, {at({0, -1, 0}), at({0, 1 + gap, 0}, {0, -speed, 0})},
                        0);
  const double energy = simulation.sample().energy;

  const double deepest = std::pow(1.25 * body.mass * speed * speed / hertz(physics, 1), 0.4);
  const double time = 0.8 * deepest / speed * std::tgamma(0.4) * std::tgamma(0.5) / std::tgamma(0.9);
  EXPECT_NEAR(time * speed / deepest, 2.943, 1e-3);

  PhysicsSample sample;
  ASSERT_EQ(simulation.advance_to(gap / speed + time / 2, sample), "");
  EXPECT_NEAR(sample.greatest_penetration, deepest, 1e-5 * deepest);
  EXPECT_NEAR(sample.energy, energy, 1e-6 * energy);
  EXPECT_NEAR(sample.kinetic_energy, 0, 1e-6 * energy);

  const double end = 1;
  ASSERT_EQ(simulation.advance_to(end, sample), "");
  const auto after = simulation.states()[1];
  const double contact_time = end - gap / speed - (after.position[1] - 1) / speed;
  EXPECT_NEAR(contact_time, time, 1e-5 * time);
  EXPECT_NEAR(after.velocity[1], speed, 1e-6);
  EXPECT_EQ(sample.contacts, 0);
}

// While the slip exceeds three transition velocities the dynamic friction decelerates and spins the ball.
TEST(Simulate, SlidingBallDeceleratesByDynamicFriction) {
  Physics physics = lossless();
  physics.gravity = {0, -kGravity, 0};
  physics.material.static_friction = 0.5;
  physics.material.dynamic_friction = 0.4;
  physics.accuracy = 1e-7;
  const RigidBody body = ball();
  const double depth = std::pow(body.mass * kGravity / hertz(physics, 1), 2. / 3.);
  Simulation simulation({box({50, 1, 50}, true), body}, physics, {at({0, -1, 0}), at({0, 1 - depth, 0}, {20, 0, 0})},
                        0);
  advance(simulation, 0.5);
  const auto state = simulation.states()[1];
  EXPECT_NEAR(state.velocity[0], 20 - 0.4 * kGravity * 0.5, 1e-5);
  // The force acts half way between the undeformed surfaces.
  const double torque = 0.4 * body.mass * kGravity * (1 - depth / 2);
  EXPECT_NEAR(state.angular_velocity[2], -torque / body.inertia * 0.5, 1e-5);
  EXPECT_NEAR(state.position[1], 1 - depth, 1e-9);
}

TEST(Simulate, BallThatLeavesThePlateFalls) {
  Physics physics;
  Simulation simulation({box({2, 1, 2}, true), ball()}, physics, {at({0, -1, 0}), at({0, 1, 0}, {5, 0, 0})}, 0);
  PhysicsSample sample;
  ASSERT_EQ(simulation.advance_to(0.1, sample), "");
  EXPECT_EQ(sample.contacts, 1);
  ASSERT_EQ(simulation.advance_to(3, sample), "");
  EXPECT_EQ(sample.contacts, 0);
  EXPECT_LT(simulation.states()[1].position[1], -15);
}

// ---- contact with edges, corners, inside, turned and moving boxes

TEST(Simulate, EdgesAndCornersPushFromTheClosestPoint) {
  const Vector half{1, 2, 3};
  // Turned by a third of a turn about (1 1 1): x -> y -> z -> x.
  BodyState turned = at({5, 6, 7});
  turned.orientation = {0.5, 0.5, 0.5, 0.5};
  const auto to_ground = [](const Vector& v) { return Vector{v[2], v[0], v[1]}; };
  struct Case {
    Vector centre, closest;  // in the box's frame
  };
  const std::vector<Case> cases{{{0.2, 2.9, 1}, {0.2, 2, 1}},      // face
                                {{1.5, 2.5, 1}, {1, 2, 1}},        // edge
                                {{1.5, 0, -3.6}, {1, 0, -3}},      // edge
                                {{-1.3, 2.4, -3.5}, {-1, 2, -3}},  // corner
                                {{1.5, 2.5, 3.5}, {1, 2, 3}}};     // corner
  for (const Case& c : cases) {
    const Vector centre = turned.position + to_ground(c.centre);
    const auto a = accelerations({box(half, true), ball()}, lossless(), {turned, at(centre)})[1];
    const Vector out = to_ground(c.centre - c.closest);
    const double depth = 1 - length(out);
    const double expected = hertz(lossless(), 1) * std::pow(depth, 1.5) / ball().mass;
    EXPECT_NEAR(length(a), expected, 1e-10 * expected);
    EXPECT_NEAR(dot(a, out), length(a) * length(out), 1e-10 * length(a));
  }
  // Just beyond the corner, though within the box enlarged by the radius.
  const Vector beyond = turned.position + to_ground({1.6, 2.6, 3.6});
  EXPECT_EQ(length(accelerations({box(half, true), ball()}, lossless(), {turned, at(beyond)})[1]), 0);
}

TEST(Simulate, CentreInsideABoxLeavesThroughTheNearestFace) {
  const auto bodies = std::vector{box({1, 2, 3}, true), ball(0.5)};
  const auto a = accelerations(bodies, lossless(), {at({0, 0, 0}), at({0.5, -1.9, 0.5})})[1];
  const double expected = hertz(lossless(), 0.5) * std::pow(0.6, 1.5) / ball(0.5).mass;
  EXPECT_NEAR(a[1], -expected, 1e-10 * expected);
  EXPECT_EQ(a[0], 0);
  EXPECT_EQ(a[2], 0);
}

TEST(Simulate, MovingBoxTakesTheOppositeForce) {
  const auto bodies = std::vector{box({1, 1, 1}, false), ball()};
  const auto a = accelerations(bodies, lossless(), {at({0, 0, 0}), at({1.5, 1.4, 1.3})});
  EXPECT_GT(length(a[1]), 1);
  EXPECT_LT(length(bodies[0].mass * a[0] + bodies[1].mass * a[1]), 1e-10 * bodies[1].mass * length(a[1]));
}

// ---- spheres with spheres

TEST(Simulate, CollidingBallsConserveMomentum) {
  Physics physics = lossless();
  physics.material = {};
  physics.accuracy = 1e-7;
  const std::vector bodies{ball(1), ball(0.5)};
  std::vector states{at({0, 0, 0}, {1, 0, 0}), at({3, 0.4, 0.2}, {-9, 0, 0})};
  states[1].angular_velocity = {5, 6, 7};
  const auto momentum = [&](const std::vector<BodyState>& now) {
    Vector linear{}, angular{};
    for (std::size_t i = 0; i < now.size(); ++i) {
      linear = linear + bodies[i].mass * now[i].velocity;
      angular = angular + bodies[i].inertia * now[i].angular_velocity +
                bodies[i].mass * cross(now[i].position, now[i].velocity);
    }
    return std::pair(linear, angular);
  };
  Simulation simulation(bodies, physics, states, 0);
  advance(simulation, 1);
  const auto after = simulation.states();
  const auto [linear, angular] = momentum(states);
  const auto [linear_after, angular_after] = momentum(after);
  EXPECT_GT(length(after[1].velocity - states[1].velocity), 5) << "they should have met";
  EXPECT_LT(length(linear_after - linear), 1e-11 * length(linear));
  EXPECT_LT(length(angular_after - angular), 1e-6 * length(angular));
}

// Simbody's HuntCrossleyForce drops every contact after one that separates; ours must not.
TEST(Simulate, SeparatingPairLeavesOtherContactsAlone) {
  const std::vector bodies(6, ball());
  // The first pair parts so quickly that it would pull.
  const auto a = accelerations(bodies, Physics(),
                               {at({0, 0, 0}, {-50, 0, 0}), at({1.9, 0, 0}, {50, 0, 0}), at({10, 0, 0}),
                                at({11.9, 0, 0}), at({20, 0, 0}), at({21.9, 0, 0})});
  for (const std::size_t i : {3, 5}) EXPECT_GT(a[i][0], 100) << i;
  for (const std::size_t i : {2, 4}) EXPECT_LT(a[i][0], -100) << i;
  EXPECT_NEAR(a[1][0], -0.1 * 50, 1e-9) << "only damping";
}

TEST(Simulate, CoincidentCentresPart) {
  const auto a = accelerations({ball(), ball()}, lossless(), {at({1, 2, 3}), at({1, 2, 3})});
  EXPECT_GT(length(a[1] - a[0]), 100);
}

TEST(Simulate, GridFindsWhatBruteForceFinds) {
  for (const unsigned seed : {1u, 2u}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> coordinate(-9, 9), radius(0.2, 1), far(-1e15, 1e15);
    std::vector<RigidBody> bodies;
    std::vector<BodyState> states;
    for (int i = 0; i < 1500; ++i) {
      bodies.push_back(ball(radius(random)));
      bodies.back().fixed = i % 7 == 0;
      states.push_back(at({coordinate(random), coordinate(random), coordinate(random)}));
    }
    // Far from the others, beyond the grid's limits, and two of them in touch.
    for (int i = 0; i < 20; ++i) states[i].position = {far(random), far(random), far(random)};
    states[21].position = {4e12, -4e12, 1};
    states[22].position = {4e12, -4e12, 1 + bodies[21].radius};

    std::int64_t expected = 0;
    double deepest = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (bodies[i].fixed && bodies[j].fixed) continue;
        const double depth = bodies[i].radius + bodies[j].radius - length(states[i].position - states[j].position);
        expected += depth > 0;
        deepest = std::max(deepest, depth);
      }
    Simulation simulation(bodies, lossless(), states, 0);
    EXPECT_EQ(simulation.sample().contacts, expected);
    EXPECT_NEAR(simulation.sample().greatest_penetration, deepest, 1e-12);
    EXPECT_GT(expected, 1000);
  }
}

}  // namespace
