// Bodies of many contact spheres against closed forms, a rigid body integrated by hand, and the multibody tree.
#include "pipeline/scene/solid_body.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "geometry/bodies.hpp"
#include "geometry/meshes/shapes.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/rigid.hpp"

namespace {

using namespace rigid;
using pipeline::Ended;
using pipeline::Trace;

RigidBody solid(geometry::Mesh mesh, int most, bool fixed = false) {
  pipeline::place_contact_spheres(mesh, most, geometry::kClosedWithin, "here", "it");
  RigidBody out = pipeline::solid_body(mesh, 1000, geometry::kClosedWithin);
  out.fixed = fixed;
  return out;
}

RigidBody brick(int most = 24) { return solid(geometry::box("box", {1.6, 1, 1.2}), most); }

/// N / m^(3/2): force = hertz * depth^(3/2), of a sphere on a face.
double hertz(const Physics& physics, double radius) {
  const double k = std::pow(physics.material.stiffness, 2. / 3.) / 2;
  return 4. / 3. * std::pow(k, 1.5) * std::sqrt(radius);
}

RigidBody floor_box() { return box({20, 1, 20}, true); }
BodyState floor_state() { return at({0, -1, 0}); }

// ---- at rest

// The box sinks until its lowest spheres carry it: a sum of Hertz forces over two tilts and a depth, solved by Newton.
TEST(SolidBody, BoxAtRestSinksByWhatItsSpheresSay) {
  Physics physics;
  physics.linear_damping = physics.angular_damping = 20;
  physics.accuracy = 1e-6;
  const RigidBody body = brick();
  Simulation simulation({floor_box(), body}, physics, {floor_state(), at({0, 0.5, 0})}, 0);
  advance(simulation, 3);

  const double weight = body.mass * kGravity;
  double p[3] = {0.499, 0, 0};  // height of the frame, its slopes along x and z
  const auto residual = [&](const double* at, double* out) {
    out[0] = -weight, out[1] = out[2] = 0;
    for (const auto& s : body.spheres) {
      const double depth = s.radius - (at[0] + s.centre[1] + at[1] * s.centre[0] + at[2] * s.centre[2]);
      if (depth <= 0) continue;
      const double force = hertz(physics, s.radius) * std::pow(depth, 1.5);
      out[0] += force, out[1] += force * s.centre[0], out[2] += force * s.centre[2];
    }
  };
  for (int i = 0; i < 200; ++i) {
    double r[3], m[3][3];
    residual(p, r);
    for (int j = 0; j < 3; ++j) {
      double moved[3] = {p[0], p[1], p[2]}, rj[3];
      moved[j] += 1e-9;
      residual(moved, rj);
      for (int k = 0; k < 3; ++k) m[k][j] = (rj[k] - r[k]) / 1e-9;
    }
    const auto det = [](const double(*a)[3]) {
      return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
             a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    };
    double step[3];
    for (int j = 0; j < 3; ++j) {
      double with[3][3];
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) with[k][l] = l == j ? r[k] : m[k][l];
      step[j] = det(with) / det(m);
    }
    for (int j = 0; j < 3; ++j) p[j] -= 0.5 * step[j];
  }
  const double height = simulation.states()[1].position[1];
  EXPECT_LT(p[0], 0.5 - 1e-4) << "it should sink";
  EXPECT_NEAR(height, p[0], 0.01 * (0.5 - p[0]));
  EXPECT_GE(simulation.sample().contacts, 3);
}

// ---- rolling

// On a slope gravity has a part g' along it. A body with the moment I about its axis, touched at the distance r from
// it, rolls without sliding at g' / (1 + I / (m r^2)). A capsule lies on the spheres along its axis.
TEST(SolidBody, CapsuleRollsDownASlope) {
  Physics physics;
  physics.linear_damping = physics.angular_damping = 0;
  physics.gravity = {0.5, -kGravity, 0};
  physics.material.transition_velocity = 0.01;  // it creeps less
  physics.accuracy = 1e-4;
  RigidBody body = solid(geometry::capsule("c", 2, 0.4, 0.4, 14), 12);
  // The meshes' balls are off its axis by the facets' roundings: lay them on it, as those of a round capsule are.
  double r = 0;
  for (const auto& s : body.spheres) r = std::max(r, s.radius);
  std::erase_if(body.spheres, [&](const auto& s) { return s.radius < 0.98 * r; });
  for (auto& s : body.spheres) s.centre[0] = s.centre[2] = 0, s.radius = r;
  ASSERT_GE(body.spheres.size(), 4u);
  BodyState state = at({0, r, 0});
  state.orientation = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // its axis y along z
  Simulation simulation({floor_box(), body}, physics, {floor_state(), state}, 0);
  advance(simulation, 0.5);
  const double before = simulation.states()[1].velocity[0];
  advance(simulation, 1.5);
  const BodyState end = simulation.states()[1];
  const double expected = 0.5 / (1 + body.inertia_matrix[1] / (body.mass * r * r));
  EXPECT_NEAR(end.velocity[0] - before, expected, 0.01 * expected);
  EXPECT_NEAR(end.angular_velocity[2], -end.velocity[0] / r, 0.02 * end.velocity[0] / r);
}

// ---- interlocking

// A ring falls over a peg and is pushed: without the peg it slides away, with it it stays about it.
TEST(SolidBody, RingStaysOnItsPeg) {
  const RigidBody ring = solid(geometry::torus("t", 1.6, 0.4, 24), 24);
  const RigidBody peg = solid(geometry::capsule("p", 3, 0.2, 0.2, 8), 40, true);
  const auto final_place = [&](bool with_peg) {
    std::vector<RigidBody> bodies{floor_box(), ring};
    std::vector<BodyState> states{floor_state(), at({0.1, 2.2, 0}, {2, 0, 0})};
    if (with_peg) bodies.push_back(peg), states.push_back(at({0, 1, 0}));
    Simulation simulation(bodies, Physics(), states, 0);
    advance(simulation, 2.5);
    return simulation.states()[1].position;
  };
  const Vector there = final_place(true), away = final_place(false);
  const double hole = 0.8 - 0.2;  // its radius
  EXPECT_LT(std::hypot(there[0], there[2]), hole - 0.2 + 0.05);
  EXPECT_NEAR(there[1], 0.2, 0.05) << "it should lie on the floor";
  EXPECT_GT(std::hypot(away[0], away[2]), 1);
}

// ---- balances

/// The worst energy error and momentum drift of two bodies that meet in free space.
Trace meeting(const RigidBody& a, const RigidBody& b, double accuracy) {
  Physics physics = lossless();
  physics.accuracy = accuracy;
  physics.final_time = 1;
  BodyState first = at({-1.2, 0.1, 0.05}, {4, 0, 0}), second = at({1.2, 0, 0}, {-4, 0.3, 0});
  first.angular_velocity = {1, 2, 0.5};
  const double momentum = a.mass * 4, energy = (a.mass + b.mass) * 8;
  physics.balance.energy = energy, physics.balance.momentum = momentum, physics.balance.angular_momentum = momentum;
  Simulation simulation({a, b}, physics, {first, second}, 0);
  return simulation.run_to_end(1000000);
}

TEST(SolidBody, BalancesAreNoWorseThanThoseOfSpheres) {
  const RigidBody knot = solid(geometry::torus_knot("k", 0.7, 0.18, 40, 8, 2, 3), 40);
  for (const double accuracy : {1e-3, 1e-6}) {
    const Trace spheres = meeting(ball(0.8), ball(0.8), accuracy), solids = meeting(brick(), knot, accuracy);
    for (const Trace& trace : {spheres, solids}) ASSERT_EQ(trace.ended, Ended::finished) << trace.reason;
    EXPECT_GT(solids.greatest_penetration, 1e-3) << "they should have met";
    EXPECT_LT(std::fabs(solids.energy_error), std::max(2 * std::fabs(spheres.energy_error), accuracy));
    // Of spheres only contact changes the spin; that of other bodies is integrated all the time.
    EXPECT_LT(spheres.momentum_drift, 0.01 * accuracy);
    EXPECT_LT(solids.momentum_drift, 0.01 * accuracy);
  }
}

// ---- a corner

/// A rigid body under the same laws, by the classical Runge-Kutta method: rotation as a matrix, all in ground.
struct ByHand {
  Vector x, v, w;
  std::array<Vector, 3> r;  // columns: the body's axes

  Vector turned(const Vector& p) const { return p[0] * r[0] + p[1] * r[1] + p[2] * r[2]; }
};

ByHand sum(const ByHand& a, double h, const ByHand& d) {
  ByHand out{a.x + h * d.x, a.v + h * d.v, a.w + h * d.w, {}};
  for (int k = 0; k < 3; ++k) out.r[k] = a.r[k] + h * d.r[k];
  return out;
}

/// A body with its centre of mass in its origin and its principal axes along its frame, above a floor at y = 0.
ByHand rate(const ByHand& s, const RigidBody& body, const Physics& physics) {
  const auto& m = physics.material;
  Vector force = -physics.linear_damping * body.mass * s.v, moment{};
  force[1] -= body.mass * kGravity;
  Vector spin{};
  for (int k = 0; k < 3; ++k) spin = spin + (body.inertia_matrix[k] * dot(s.r[k], s.w)) * s.r[k];
  moment = moment - physics.angular_damping * spin;
  for (const auto& sphere : body.spheres) {
    const Vector centre = s.x + s.turned(sphere.centre);
    const double depth = sphere.radius - centre[1];
    if (depth <= 0) continue;
    const Vector point{centre[0], centre[1] - sphere.radius + depth / 2, centre[2]};
    const Vector velocity = s.v + cross(s.w, point - s.x);
    const double normal =
        hertz(physics, sphere.radius) * std::pow(depth, 1.5) * (1 - 1.5 * m.dissipation * velocity[1]);
    if (normal <= 0) continue;
    const double slip = std::hypot(velocity[0], velocity[2]), u = slip / m.transition_velocity;
    const auto smooth = [](double t) { return t * t * t * (10 + t * (6 * t - 15)); };
    const double mu = u < 1   ? m.static_friction * smooth(u)
                      : u < 3 ? m.static_friction - (m.static_friction - m.dynamic_friction) * smooth((u - 1) / 2)
                              : m.dynamic_friction;
    Vector on{0, normal, 0};
    if (slip > 0) on[0] -= normal * mu * velocity[0] / slip, on[2] -= normal * mu * velocity[2] / slip;
    force = force + on;
    moment = moment + cross(point - s.x, on);
  }
  ByHand d;
  d.x = s.v;
  d.v = (1 / body.mass) * force;
  for (int k = 0; k < 3; ++k) d.r[k] = cross(s.w, s.r[k]);
  const Vector torque = moment - cross(s.w, spin);
  d.w = {};
  for (int k = 0; k < 3; ++k) d.w = d.w + (dot(s.r[k], torque) / body.inertia_matrix[k]) * s.r[k];
  return d;
}

TEST(SolidBody, TiltedBoxLandsOnItsCornerAsIntegratedByHand) {
  Physics physics;
  physics.accuracy = 1e-9;
  const RigidBody body = brick();
  for (int k = 0; k < 3; ++k) ASSERT_NEAR(body.centre_of_mass[k], 0, 1e-15);
  BodyState start = at({0, 1.3, 0}, {0.5, -2, 0.1});
  const double n = std::sqrt(0.9 * 0.9 + 0.3 * 0.3 + 0.2 * 0.2 + 0.25 * 0.25);
  const double w = 0.9 / n, x = 0.3 / n, y = 0.2 / n, z = 0.25 / n;
  start.orientation = {w, x, y, z};
  start.angular_velocity = {0.3, -0.2, 0.5};
  Simulation simulation({floor_box(), body}, physics, {floor_state(), start}, 0);
  constexpr double kTime = 0.4;
  PhysicsSample sample;
  ASSERT_EQ(simulation.advance_to(kTime, sample), "");
  const BodyState found = simulation.states()[1];

  ByHand s{start.position, start.velocity, start.angular_velocity, {}};
  s.r = {Vector{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
         Vector{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
         Vector{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
  constexpr int kSteps = 20000;
  const double h = kTime / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const ByHand a = rate(s, body, physics), b = rate(sum(s, h / 2, a), body, physics);
    const ByHand c = rate(sum(s, h / 2, b), body, physics), d = rate(sum(s, h, c), body, physics);
    s = sum(sum(sum(sum(s, h / 6, a), h / 3, b), h / 3, c), h / 6, d);
  }
  EXPECT_GT(found.velocity[1], -2) << "it should have landed";
  EXPECT_GT(length(found.angular_velocity - start.angular_velocity), 0.5) << "the corner should have turned it";
  EXPECT_LT(length(found.position - s.x), 1e-6);
  EXPECT_LT(length(found.velocity - s.v), 1e-5);
  EXPECT_LT(length(found.angular_velocity - s.w), 1e-5);
}

// ---- the multibody tree

// A body whose centre of mass is not its origin, and whose axes are not its frame's, meets others.
TEST(SolidBody, MovesFreeAsInTheTree) {
  geometry::Mesh far = geometry::capsule("c", 2, 0.5, 0.3, 6);
  const geometry::Mesh upright = far;
  geometry::to_world({geometry::normalised({0.8, 0.3, 0.4, 0.1}), {0.3, -0.2, 0.1}}, upright.vertices, far.vertices);
  const std::vector<RigidBody> bodies{floor_box(), solid(far, 16), brick(),
                                      solid(geometry::torus("t", 1.6, 0.4, 16), 16)};
  const std::vector<BodyState> states{floor_state(), at({0, 1.4, 0}, {0.3, -2, 0}), at({0.4, 3.1, 0.2}, {0, -3, 0}),
                                      at({-0.2, 4.6, 0}, {0, -4, 0})};
  EXPECT_GT(length(bodies[1].centre_of_mass), 0.1);
  EXPECT_GT(std::fabs(bodies[1].inertia_matrix[3]), 1);
  std::vector<BodyState> end[2];
  std::int64_t contacts = 0;
  for (const auto model : {pipeline::BodyModel::free, pipeline::BodyModel::tree}) {
    Physics physics;
    physics.bodies = model;
    physics.accuracy = 1e-7;  // one integrates the centre of mass, one the origin: their steps differ
    Simulation simulation(bodies, physics, states, 0);
    advance(simulation, 0.4);
    end[model == pipeline::BodyModel::tree] = simulation.states();
    contacts += simulation.sample().contacts;
  }
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    EXPECT_LT(length(end[0][b].position - end[1][b].position), 1e-6) << b;
    EXPECT_LT(length(end[0][b].velocity - end[1][b].velocity), 1e-5) << b;
    EXPECT_GT(length(end[0][b].velocity - states[b].velocity), 0.5) << b;
  }
  EXPECT_GT(contacts, 0);
}

// ---- rules

std::string refusal(geometry::Mesh mesh, int most = 16) {
  return tests::refusal_of(
      [&] { pipeline::place_contact_spheres(mesh, most, geometry::kClosedWithin, "here", "\"it\""); });
}

TEST(SolidBody, RefusesWhatIsNoSolid) {
  const geometry::Mesh cube = geometry::box("box", {1, 1, 1});
  EXPECT_EQ(refusal(cube), "");
  geometry::Mesh mesh = cube;
  mesh.triangles.pop_back();
  EXPECT_NE(refusal(mesh).find("here must be a solid body, not \"it\": the surface is open, the edge from ("),
            std::string::npos);
  mesh = cube;
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  EXPECT_NE(refusal(mesh).find("its facets face both ways"), std::string::npos);
  mesh = cube;
  for (auto& facet : mesh.triangles) std::swap(facet[0], facet[1]);
  EXPECT_NE(refusal(mesh).find("its facets face inward"), std::string::npos);
  mesh = geometry::box("sheet", {1, 0, 1});
  EXPECT_NE(refusal(mesh).find("it has no volume"), std::string::npos);
  mesh = geometry::box("plate", {1, 1e-3, 1});
  EXPECT_NE(refusal(mesh, 4).find("leave its surface up to "), std::string::npos);
  EXPECT_NE(refusal(mesh, 4).find("raise contact_spheres, or make it thicker"), std::string::npos);
}

}  // namespace
