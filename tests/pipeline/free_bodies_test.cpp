// Bodies that nothing joins move as Simbody's multibody tree moves them, and as closed forms say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/study/reference.hpp"
#include "pipeline/study/study.hpp"
#include "tests/support/rigid.hpp"

namespace {

using namespace rigid;
using pipeline::BodyModel;

using rigid::operator*;                // beside that of matrices below
using Matrix = std::array<Vector, 3>;  // rows

Matrix rotation(const std::array<double, 4>& q) {
  const auto& [w, x, y, z] = q;
  return {Vector{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
          Vector{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
          Vector{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

Vector operator*(const Matrix& m, const Vector& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }

Matrix transposed(const Matrix& m) {
  Matrix out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out[i][j] = m[j][i];
  return out;
}

std::array<double, 4> product(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Vector principal(const RigidBody& box) {
  const auto& h = box.half_extents;
  return box.mass / 3 * Vector{h[1] * h[1] + h[2] * h[2], h[0] * h[0] + h[2] * h[2], h[0] * h[0] + h[1] * h[1]};
}

/// The box in a frame that lies at `place` and is turned by `turn`, both as the box sees them. Its contact is still
/// that of a box along the frame, so it is for flights only.
RigidBody in_another_frame(const RigidBody& box, const Vector& place, const std::array<double, 4>& turn) {
  const Matrix to_frame = transposed(rotation(turn));
  const Vector moments = principal(box);
  Matrix inertia{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) inertia[i][j] += to_frame[i][k] * moments[k] * to_frame[j][k];
  RigidBody out = box;
  out.centre_of_mass = -1 * (to_frame * place);
  out.inertia_matrix = {inertia[0][0], inertia[1][1], inertia[2][2], inertia[0][1], inertia[0][2], inertia[1][2]};
  return out;
}

BodyState in_another_frame(const BodyState& s, const Vector& place, const std::array<double, 4>& turn) {
  const Vector arm = rotation(s.orientation) * place;
  BodyState out = s;
  out.position = s.position + arm;
  out.velocity = s.velocity + cross(s.angular_velocity, arm);
  out.orientation = product(s.orientation, turn);
  return out;
}

double distance(const BodyState& a, const BodyState& b) {
  double out = std::max(length(a.position - b.position), length(a.velocity - b.velocity));
  out = std::max(out, length(a.angular_velocity - b.angular_velocity));
  double along = 0;  // q and -q are one orientation
  for (int i = 0; i < 4; ++i) along += a.orientation[i] * b.orientation[i];
  for (int i = 0; i < 4; ++i)
    out = std::max(out, std::fabs(a.orientation[i] - std::copysign(1, along) * b.orientation[i]));
  return out;
}

/// A plate, a ball that lands on it, one above it and one of uneven density beside, and a box that tumbles.
struct Scene {
  std::vector<RigidBody> bodies{box({9, 1, 9}, true), ball(), ball(0.6), ball(0.8), box({0.5, 1, 1.5}, false)};
  std::vector<BodyState> states{at({0, -1, 0}), at({0, 1.2, 0}, {0.3, -2, 0.1}), at({0.2, 3.1, 0.1}, {0, -1, 0}),
                                at({4, 0.9, 4}), at({0, 30, 0}, {1, 2, 3})};
  Scene() {
    const double m = bodies[3].mass;
    bodies[3].inertia_matrix = {0.25 * m, 0.3 * m, 0.35 * m, 0.02 * m, -0.03 * m, 0.01 * m};
    states[1].angular_velocity = {1, 2, 3};
    states[3].angular_velocity = {0.5, 0, 1};
    states[4].angular_velocity = {0.2, 3, 0.3};
  }
};

struct Outcome {
  std::vector<BodyState> states;
  PhysicsSample sample;
};

Outcome outcome(const Scene& scene, Physics physics, BodyModel model, double time) {
  physics.bodies = model;
  Simulation simulation(scene.bodies, physics, scene.states, 0);
  Outcome out;
  EXPECT_EQ(simulation.advance_to(time, out.sample), "");
  out.states = simulation.states();
  return out;
}

// ---- the multibody tree as yardstick

class FreeBodiesBy : public testing::TestWithParam<std::string> {};

// Nothing touches: the motion is smooth, and rounding decides no step. Only the Jacobian of CPodesBDF, made by
// differences, has half as many digits: its motions agree to a fraction of the accuracy.
TEST_P(FreeBodiesBy, FlyAsTheTreeDoes) {
  Scene scene;
  for (std::size_t b = 1; b < scene.states.size(); ++b)
    scene.states[b].position = scene.states[b].position + Vector{0, 50, 7. * double(b)};
  Physics physics;
  physics.integrator = GetParam();
  const double tolerance = GetParam() == "CPodesBDF" ? 0.1 * physics.accuracy : 1e-10;
  const Outcome free = outcome(scene, physics, BodyModel::free, 0.5);
  const Outcome tree = outcome(scene, physics, BodyModel::tree, 0.5);
  for (std::size_t b = 0; b < scene.states.size(); ++b) {
    EXPECT_LT(distance(free.states[b], tree.states[b]), tolerance) << "body " << b;
    EXPECT_TRUE(b == 0 || distance(free.states[b], scene.states[b]) > 0.1) << "body " << b << " should have moved";
  }
  EXPECT_EQ(free.sample.integrator_steps, tree.sample.integrator_steps);
  EXPECT_EQ(free.sample.rejected_steps, tree.sample.rejected_steps);
  EXPECT_EQ(free.sample.force_evaluations, tree.sample.force_evaluations);
  EXPECT_NEAR(free.sample.energy, tree.sample.energy, tolerance * std::fabs(tree.sample.energy));
}

// Contacts begin, slide and end. From there on the steps of CPodes and of RungeKuttaFeldberg follow the last bits (of a
// Jacobian, of iterations, of an estimate that nearly cancels), so that their motions only agree to the error they
// make.
TEST_P(FreeBodiesBy, TouchAsTheTreeDoes) {
  Physics physics;
  physics.integrator = GetParam();
  physics.accuracy = 1e-4;
  const bool by_rounding = GetParam().rfind("CPodes", 0) == 0 || GetParam() == "RungeKuttaFeldberg";
  const Scene scene;
  const Outcome free = outcome(scene, physics, BodyModel::free, 0.25);
  const Outcome tree = outcome(scene, physics, BodyModel::tree, 0.25);
  for (std::size_t b = 0; b < scene.states.size(); ++b)
    EXPECT_LT(distance(free.states[b], tree.states[b]), by_rounding ? 0.05 : 1e-8) << "body " << b;
  EXPECT_EQ(free.sample.contacts, tree.sample.contacts);
  EXPECT_GT(length(free.states[1].velocity - scene.states[1].velocity), 2) << "it should have bounced";
}

// The tree integrates the place of a body's frame, the free body that of its centre of mass, whose flight is a
// parabola: they are two discretisations, and agree when both are accurate.
TEST(FreeBodies, ALopsidedBallRollsAsTheTreeSays) {
  Scene scene;
  scene.bodies[3].centre_of_mass = {0.2, -0.1, 0.15};
  scene.states[3].position = {4, 0.85, 4};
  Physics physics;
  physics.accuracy = 1e-10;
  const Outcome free = outcome(scene, physics, BodyModel::free, 0.2);
  const Outcome tree = outcome(scene, physics, BodyModel::tree, 0.2);
  EXPECT_LT(distance(free.states[3], tree.states[3]), 1e-7);
  EXPECT_GT(distance(free.states[3], scene.states[3]), 0.1);
}

// Normalised when they are further from unit length than a tenth of the accuracy, as the tree's are.
TEST_P(FreeBodiesBy, KeepQuaternionsOfUnitLength) {
  Physics physics = lossless();
  physics.integrator = GetParam();
  physics.accuracy = 1e-2;
  BodyState tumbling;
  tumbling.angular_velocity = {0.2, 9, 0.3};
  Simulation simulation({box({0.5, 1, 1.5}, false)}, physics, {tumbling}, 0);
  double drift = 0;
  for (int i = 1; i <= 100; ++i) {
    advance(simulation, i / 50.);
    const auto q = simulation.states()[0].orientation;
    drift = std::max(drift, std::fabs(std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) - 1));
  }
  EXPECT_LE(drift, 1.001 * physics.accuracy / 10);
}

INSTANTIATE_TEST_SUITE_P(Integrators, FreeBodiesBy, testing::ValuesIn(pipeline::integrator_names()),
                         [](const auto& info) { return info.param; });

// ---- closed forms and symmetries, without the tree

// The same body seen from another frame moves alike: the centre of mass off the origin, products of inertia.
TEST(FreeBodies, MoveAlikeInEveryFrame) {
  const RigidBody plain = box({0.5, 1, 1.5}, false);
  BodyState start = at({1, 2, 3}, {4, 5, 6});
  start.orientation = {0.5, -0.5, 0.5, 0.5};
  start.angular_velocity = {0.2, 3, 0.3};
  const Vector place{0.7, -0.3, 0.2};
  const std::array<double, 4> turn{0.8, 0.36, 0, 0.48};
  Physics physics;
  physics.accuracy = 1e-11;
  for (const BodyModel model : {BodyModel::free, BodyModel::tree}) {
    physics.bodies = model;
    Simulation here({plain}, physics, {start}, 0);
    Simulation there({in_another_frame(plain, place, turn)}, physics, {in_another_frame(start, place, turn)}, 0);
    EXPECT_NEAR(there.sample().energy, here.sample().energy, 1e-12 * std::fabs(here.sample().energy));
    advance(here, 1);
    advance(there, 1);
    EXPECT_LT(distance(there.states()[0], in_another_frame(here.states()[0], place, turn)), 1e-9);
    EXPECT_NEAR(there.sample().energy, here.sample().energy, 1e-9 * std::fabs(here.sample().energy));
  }
}

TEST(FreeBodies, TumbleAsJacobisFunctionsSay) {
  const RigidBody body = box({0.5, 1, 1.5}, false);
  const Vector spin{0.2, 3, 0.3}, place{0.4, 0.1, -0.2};
  const std::array<double, 4> turn{0.6, 0, 0.8, 0};
  BodyState start;
  start.angular_velocity = spin;
  BodyState end = start;
  end.orientation = pipeline::top_orientation(principal(body), spin, 8);
  Physics physics = lossless();
  physics.accuracy = 1e-11;
  Simulation simulation({in_another_frame(body, place, turn)}, physics, {in_another_frame(start, place, turn)}, 0);
  advance(simulation, 8);
  BodyState expected = in_another_frame(end, place, turn);
  // The closed form has no velocity.
  expected.velocity = simulation.states()[0].velocity;
  expected.angular_velocity = simulation.states()[0].angular_velocity;
  EXPECT_LT(distance(simulation.states()[0], expected), 1e-8);
}

// A ball whose centre of mass is below its middle rolls back and forth on a plate without losing energy, about an
// equilibrium with the centre of mass lowest.
TEST(FreeBodies, ALopsidedBallRocks) {
  Physics physics = lossless();
  physics.gravity = {0, -kGravity, 0};
  physics.accuracy = 1e-7;
  RigidBody body = ball();
  body.centre_of_mass = {0.3, 0, 0};
  Simulation simulation({box({9, 1, 9}, true), body}, physics, {at({0, -1, 0}), at({0, 1, 0})}, 0);
  const double energy = simulation.sample().energy;
  double lowest = 0, highest = -1;
  for (int i = 1; i <= 60; ++i) {
    advance(simulation, i / 20.);
    const auto q = simulation.states()[1].orientation;
    const double height = (rotation(q) * Vector{0.3, 0, 0})[1];
    lowest = std::min(lowest, height);
    if (lowest < -0.29) highest = std::max(highest, height);
  }
  EXPECT_LT(lowest, -0.29) << "the centre of mass swings below the middle";
  EXPECT_GT(highest, -0.05) << "and up again";
  EXPECT_NEAR(simulation.sample().energy, energy, 1e-5 * std::fabs(energy));
}

// Bodies that only fly do not know of each other, and a fixed one does not move.
TEST(FreeBodies, TakeTheirOwnRows) {
  Physics physics;
  physics.integrator = "RungeKutta3";
  physics.fixed_step = 1e-3;
  const std::vector bodies{ball(), box({1, 1, 1}, true), ball(0.5), box({0.5, 1, 2}, false)};
  std::vector states{at({0, 9, 0}, {1, 0, 0}), at({0, -50, 0}), at({9, 9, 0}, {0, 1, 0}), at({0, 9, 9}, {0, 0, 1})};
  states[3].angular_velocity = {1, 2, 3};
  Simulation all(bodies, physics, states, 0);
  advance(all, 0.3);
  for (const int b : {0, 2, 3}) {
    Simulation alone({bodies[b]}, physics, {states[b]}, 0);
    advance(alone, 0.3);
    EXPECT_LT(distance(alone.states()[0], all.states()[b]), 1e-14) << b;
  }
  EXPECT_EQ(all.states()[1].position, states[1].position);
}

TEST(FreeBodies, RefuseAnInertiaThatNoBodyHas) {
  const auto refused = [](const std::array<double, 6>& inertia) {
    RigidBody body = ball();
    body.inertia_matrix = inertia;
    try {
      Simulation(std::vector{body}, Physics(), {at({0, 0, 0})}, 0);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused({2, 3, 4, 0.1, 0.2, 0.3}), "");
  EXPECT_EQ(refused({1, 1, 2, 0, 0, 0}), "") << "a disc is flat";
  for (const std::array<double, 6>& wrong : {std::array<double, 6>{-1, 1, 1, 0, 0, 0},
                                             {1, 1, 2.1, 0, 0, 0},
                                             {1, 1, 1, 1, 0, 0},
                                             {0, 0, 0, 1, 0, 0},
                                             {1, 1, std::nan(""), 0, 0, 0}})
    EXPECT_NE(refused(wrong).find("inertia"), std::string::npos) << wrong[0] << ' ' << wrong[2] << ' ' << wrong[3];
}

// ---- the problems of the studies

pipeline::StudyRow row(const std::string& problem, const std::string& integrator, const std::string& value,
                       const std::string& model) {
  const pipeline::Config config =
      pipeline::parse_config("study = \"integration\"\nbodies = \"" + model + "\"\n[[sweep]]\nproblem = \"" + problem +
                                 "\"\nintegrator = [\"" + integrator + "\"]\n" + value + "\n",
                             "s.toml");
  return pipeline::study_row(*config.study, pipeline::study_cases(*config.study).at(0));
}

// At every accuracy and with all integrators: tests/benchmarks/free_against_tree.py.
class FreeBodiesOf : public testing::TestWithParam<std::string> {};

TEST_P(FreeBodiesOf, AreAsNearTheReferenceAsTheTree) {
  for (const std::string accuracy : {"1e-2", "1e-4", "1e-6"}) {
    const auto free = row(GetParam(), "RungeKuttaMerson", "accuracy = " + accuracy, "free");
    const auto tree = row(GetParam(), "RungeKuttaMerson", "accuracy = " + accuracy, "tree");
    SCOPED_TRACE("accuracy " + accuracy);
    EXPECT_EQ(free.status, "finished") << free.reason;
    EXPECT_LE(free.error, 1.0001 * tree.error + 1e-12);
    EXPECT_LE(std::fabs(free.energy_error), 1.0001 * std::fabs(tree.energy_error) + 1e-12);
    EXPECT_EQ(free.force_evaluations, tree.force_evaluations);
  }
}

INSTANTIATE_TEST_SUITE_P(Problems, FreeBodiesOf, testing::Values("free_flight", "top", "bounce", "damped_bounce"),
                         [](const auto& info) { return info.param; });

TEST(FreeBodies, KeepMomentum) {
  for (const std::string model : {"free", "tree"}) {
    const auto out = row("two_balls", "RungeKutta3", "accuracy = 1e-4", model);
    EXPECT_EQ(out.status, "finished") << out.reason;
    EXPECT_LT(out.momentum_drift, 1e-12) << model;
  }
}

// The slope of the error between two fixed steps is the order (Hairer, Norsett & Wanner, chapter II).
TEST(FreeBodies, TumbleWithTheTextbookOrders) {
  const auto order = [](const std::string& integrator, double step) {
    const auto error = [&](double h) {
      const auto out = row("top", integrator, "duration = 1\nfixed_step = " + std::to_string(h), "free");
      EXPECT_EQ(out.status, "finished") << out.reason;
      return out.error;
    };
    return std::log2(error(step) / error(step / 2));
  };
  EXPECT_NEAR(order("ExplicitEuler", 0.005), 1, 0.2);
  EXPECT_NEAR(order("SemiExplicitEuler", 0.005), 1, 0.2);
  EXPECT_NEAR(order("RungeKutta2", 0.01), 2, 0.2);
  EXPECT_NEAR(order("Verlet", 0.005), 2, 0.2);
  EXPECT_NEAR(order("RungeKutta3", 0.02), 3, 0.2);
  EXPECT_NEAR(order("RungeKuttaMerson", 0.02), 4, 0.3);
}

}  // namespace
