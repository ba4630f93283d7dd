// Our contact against Simbody's own CompliantContactSubsystem: the same accelerations from the same states. What only
// shows inside: neighbours kept from one evaluation to the next, and results kept in the state they belong to.
// The only test that includes Simbody: C++17 with assertions (CMakeLists.txt).
#include <Simbody.h>
#include <gtest/gtest.h>

#include <random>

#include "pipeline/physics/contact.hpp"
#include "pipeline/physics/free_bodies.hpp"
#include "pipeline/physics/simulate.hpp"
#include "pipeline/physics/tree.hpp"

namespace {

using pipeline::BodyState;
using pipeline::Physics;
using pipeline::RigidBody;
using SimTK::SpatialVec;
using SimTK::Vec3;

// A step of semi-explicit Euler: u(t + h) = u + h u'(t). Its difference quotient is the acceleration but for rounding.
constexpr double kStep = 1e-3;

Vec3 vec3(const std::array<double, 3>& v) { return Vec3(v[0], v[1], v[2]); }

std::vector<SpatialVec> our_accelerations(const std::vector<RigidBody>& bodies, Physics physics,
                                          const std::vector<BodyState>& states) {
  physics.integrator = "SemiExplicitEuler";
  physics.accuracy = kStep;
  physics.energy_bound = 1e300;
  pipeline::Simulation simulation(bodies, physics, states, 0);
  pipeline::PhysicsSample sample;
  EXPECT_EQ(simulation.advance_to(kStep, sample), "");
  EXPECT_EQ(sample.integrator_steps, 1);
  const auto after = simulation.states();
  std::vector<SpatialVec> out;
  for (std::size_t i = 0; i < states.size(); ++i)
    out.emplace_back((vec3(after[i].angular_velocity) - vec3(states[i].angular_velocity)) / kStep,
                     (vec3(after[i].velocity) - vec3(states[i].velocity)) / kStep);
  return out;
}

struct Reference {
  std::vector<SpatialVec> accelerations;
  double elastic_energy = 0;
};

/// Simbody's contact of spheres with each other, and with the half-space y < 0 where `floor`.
Reference simbody(const std::vector<RigidBody>& bodies, const Physics& physics, const std::vector<BodyState>& states,
                  bool floor) {
  using namespace SimTK;
  MultibodySystem system;
  SimbodyMatterSubsystem matter(system);
  ContactTrackerSubsystem tracker(system);
  CompliantContactSubsystem contact(system, tracker);
  contact.setTransitionVelocity(physics.material.transition_velocity);
  const ContactMaterial material(physics.material.stiffness, physics.material.dissipation,
                                 physics.material.static_friction, physics.material.dynamic_friction,
                                 physics.material.viscous_friction);
  if (floor)
    matter.Ground().updBody().addContactSurface(Rotation(-Pi / 2, ZAxis),
                                                ContactSurface(ContactGeometry::HalfSpace(), material));
  std::vector<MobilizedBody::Free> mobods;
  for (const RigidBody& body : bodies) {
    Body::Rigid rigid(MassProperties(body.mass, Vec3(0), Inertia(body.inertia)));
    rigid.addContactSurface(Transform(), ContactSurface(ContactGeometry::Sphere(body.radius), material));
    mobods.emplace_back(matter.Ground(), Transform(), rigid, Transform());
  }
  system.realizeTopology();
  State state = system.getDefaultState();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyState& s = states[i];
    mobods[i].setQToFitTranslation(state, vec3(s.position));
    mobods[i].setU(state, Vec6(s.angular_velocity[0], s.angular_velocity[1], s.angular_velocity[2], s.velocity[0],
                               s.velocity[1], s.velocity[2]));
  }
  system.realize(state, Stage::Acceleration);
  Reference out;
  for (const auto& mobod : mobods) out.accelerations.push_back(mobod.getBodyAcceleration(state));
  out.elastic_energy = system.calcPotentialEnergy(state);
  return out;
}

void expect_equal(const std::vector<SpatialVec>& ours, const std::vector<SpatialVec>& theirs, double speed) {
  for (std::size_t i = 0; i < theirs.size(); ++i)
    for (int part = 0; part < 2; ++part) {
      // Relative to what went into it: the acceleration, and the velocity whose last bits the quotient divides by
      // kStep.
      const double scale = theirs[i][part].norm() + speed / kStep * 1e-3;
      EXPECT_LT((ours[i][part] - theirs[i][part]).norm(), 1e-12 * scale)
          << "body " << i << " part " << part << ": " << ours[i][part] << " for " << theirs[i][part];
    }
}

class SimbodyContact : public testing::Test {
 protected:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  std::array<double, 3> vector(double length) {
    return {uniform(-length, length), uniform(-length, length), uniform(-length, length)};
  }
  RigidBody ball() {
    RigidBody out;
    out.radius = uniform(0.3, 2);
    out.mass = uniform(100, 5000);
    out.inertia = 0.4 * out.mass * out.radius * out.radius;
    return out;
  }
  Physics physics() {
    Physics out;
    out.gravity = {0, 0, 0};
    out.linear_damping = out.angular_damping = 0;
    out.material.stiffness = std::pow(10, uniform(4, 9));
    out.material.dissipation = uniform(0, 0.5);
    out.material.dynamic_friction = uniform(0, 0.5);
    out.material.static_friction = out.material.dynamic_friction + uniform(0, 0.5);
    out.material.viscous_friction = uniform(0, 0.2);
    out.material.transition_velocity = uniform(0.05, 1);
    return out;
  }
  static constexpr unsigned kSeed = 20240607;
  std::mt19937 random_{kSeed};
};

// Speeds from 0.01 to 10 m/s reach approach, separation (also so quick that the force would pull) and all three pieces
// of the friction curve.
TEST_F(SimbodyContact, SpheresAccelerateTheSame) {
  int pulled = 0, pushed = 0;
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " trial " << trial);
    const std::vector<RigidBody> bodies{ball(), ball()};
    const double speed = std::pow(10, uniform(-2, 1));
    std::vector<BodyState> states(2);
    const Vec3 direction = vec3(vector(1)).normalize();
    const double distance = (bodies[0].radius + bodies[1].radius) * uniform(0.8, 1.01);
    states[0].position = vector(5);
    for (int axis = 0; axis < 3; ++axis)
      states[1].position[axis] = states[0].position[axis] + distance * direction[axis];
    for (BodyState& state : states) {
      state.velocity = vector(speed);
      state.angular_velocity = vector(speed);
    }
    const Physics law = physics();

    const Reference theirs = simbody(bodies, law, states, false);
    expect_equal(our_accelerations(bodies, law, states), theirs.accelerations, speed);

    const bool overlap = distance < bodies[0].radius + bodies[1].radius;
    const bool force = theirs.accelerations[0][1].norm() > 0;
    pulled += overlap && !force;
    pushed += force;
    pipeline::Simulation simulation(bodies, law, states, 0);
    const auto sample = simulation.sample();
    EXPECT_EQ(sample.contacts, overlap ? 1 : 0);
    // Simbody forgets the elastic energy of a contact that would pull; ours is a function of positions alone.
    if (force) {
      EXPECT_NEAR(sample.energy - sample.kinetic_energy, theirs.elastic_energy, 1e-9 * theirs.elastic_energy);
    }
  }
  EXPECT_GT(pushed, 50);
  EXPECT_GT(pulled, 2);
}

TEST_F(SimbodyContact, SphereOnPlateAcceleratesAsOnHalfSpace) {
  RigidBody plate;
  plate.fixed = true;
  plate.sphere = false;
  plate.half_extents = {50, 5, 50};
  BodyState below;
  below.position = {0, -5, 0};
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " trial " << trial);
    const RigidBody body = ball();
    const double speed = std::pow(10, uniform(-2, 1));
    BodyState state;
    state.position = vector(5);
    state.position[1] = body.radius * uniform(0.8, 1.01);
    state.velocity = vector(speed);
    state.angular_velocity = vector(speed);
    const Physics law = physics();

    const auto ours = our_accelerations({plate, body}, law, {below, state});
    const auto theirs = simbody({body}, law, {state}, true).accelerations;
    expect_equal({ours[1]}, theirs, speed);
  }
}

// ---- Inside

// Spheres of all sizes and boxes, fixed and not, wander; each time all pairs are tried.
TEST(Neighbours, KeptOnesAreThoseOfEveryPair) {
  using namespace pipeline::contact;
  constexpr unsigned kSeed = 5;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  // One after another, as arguments are evaluated in an order of the compiler's choice.
  const auto within = [&](double low, double high) {
    const double z = uniform(low, high), y = uniform(low, high), x = uniform(low, high);
    return Vec3(x, y, z);
  };
  std::vector<Sphere> spheres;
  std::vector<Box> boxes;
  std::vector<Kinematics> bodies(160);
  for (int i = 0; i < 160; ++i) {
    bodies[i].position = within(-4, 4);
    bodies[i].orientation.setRotationFromAngleAboutX(uniform(0, 6));
    if (i % 40 == 0)
      boxes.push_back({i, i % 80 == 0, within(0.5, 2)});
    else
      spheres.push_back({i, i % 7 == 0, uniform(0.2, 1)});
    // Every third body has more of them, down to small ones.
    for (int k = 0; i % 40 != 0 && i % 3 == 0 && k < 4; ++k) {
      const double radius = uniform(0.01, 0.3), y = uniform(-1, 1), x = uniform(-1, 1);
      spheres.push_back({i, i % 7 == 0, radius, Vec3(x, y, 0), false});
    }
  }
  const auto centre = [&](const Sphere& s) { return bodies[s.body].position + bodies[s.body].orientation * s.centre; };
  Neighbours neighbours(spheres, boxes);
  std::vector<Contact> found;
  std::size_t most = 0, least = 1000;
  for (int step = 0; step < 60; ++step) {
    // Now and then all jump, as a step that is tried and rejected throws them.
    const double length = step % 20 == 13 ? 3 : 0.03;
    for (const Sphere& s : spheres) {
      if (s.fixed) continue;
      bodies[s.body].position += length * within(-1, 1);
      bodies[s.body].orientation.setRotationFromAngleAboutZ(uniform(0, step % 20 == 13 ? 6 : 0.05));
    }
    for (const Box& b : boxes)
      if (!b.fixed) bodies[b.body].orientation.setRotationFromAngleAboutX(uniform(0, 6));
    std::vector<Contact> expected;
    Contact contact;
    for (std::size_t i = 0; i < spheres.size(); ++i)
      for (std::size_t j = i + 1; j < spheres.size(); ++j)
        if (spheres[i].body != spheres[j].body && !(spheres[i].fixed && spheres[j].fixed) &&
            touch(spheres[i], centre(spheres[i]), spheres[j], centre(spheres[j]), contact))
          expected.push_back(contact);
    for (const Box& b : boxes)
      for (const Sphere& s : spheres)
        if (!(b.fixed && s.fixed) && touch(b, bodies[b.body], s, centre(s), contact)) expected.push_back(contact);
    neighbours.find(bodies, found);
    ASSERT_EQ(found.size(), expected.size()) << "step " << step;
    for (std::size_t i = 0; i < found.size(); ++i)
      ASSERT_TRUE(found[i].a == expected[i].a && found[i].b == expected[i].b && found[i].depth == expected[i].depth)
          << "step " << step << " contact " << i;
    most = std::max(most, found.size());
    least = std::min(least, found.size());
  }
  EXPECT_GT(least, 50u);
  EXPECT_GT(most, least);
}

// A ball that presses on a plate, and the same far above: asked for in turn, each state has its own depth.
TEST(Mechanics, WhatAStateGaveStaysWithIt) {
  RigidBody plate, ball;
  plate.fixed = true;
  plate.sphere = false;
  plate.half_extents = {5, 1, 5};
  ball.mass = 1000;
  ball.inertia = 400;
  std::vector<BodyState> low(2), high(2);
  low[0].position = high[0].position = {0, -1, 0};
  low[1].position = {0, 0.9, 0};
  high[1].position = {0, 9, 0};
  for (const auto& model : {pipeline::free_bodies, pipeline::multibody_tree}) {
    pipeline::Watch watch;
    Physics physics;
    physics.balance.tracked = true;
    const auto mechanics = model({plate, ball}, physics, low, watch);
    const SimTK::State a = mechanics->start(low, 0), b = mechanics->start(high, 0);
    mechanics->system().realize(a, SimTK::Stage::Acceleration);
    mechanics->system().realize(b, SimTK::Stage::Acceleration);
    EXPECT_NEAR(mechanics->loads(a).depth, 0.1, 1e-12);
    EXPECT_EQ(mechanics->loads(b).depth, 0);
    EXPECT_GT(mechanics->loads(a).outer_force[1], 0);
    EXPECT_NEAR(mechanics->loads(b).outer_force[1], -9.81 * 1000, 1e-9);
    EXPECT_EQ(watch.evaluations, 2);
  }
}

}  // namespace
