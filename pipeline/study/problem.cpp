#include "pipeline/study/problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pipeline/study/reference.hpp"

namespace pipeline {
namespace {

using Vector = std::array<double, 3>;

constexpr double kGravity = 9.81;  // m/s^2
constexpr double kDensity = 1000;  // kg/m^3
constexpr double kDeep = 1000;     // radii: half the extents of a floor that nothing falls through or past

Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector operator*(double s, const Vector& a) { return {s * a[0], s * a[1], s * a[2]}; }

double ball_mass(double radius) { return kDensity * 4 / 3 * std::numbers::pi * radius * radius * radius; }

RigidBody ball(double radius, double mass) {
  RigidBody out;
  out.radius = radius;
  out.mass = mass;
  out.inertia = 0.4 * mass * radius * radius;
  return out;
}

RigidBody plate(const Vector& half_extents) {
  RigidBody out;
  out.fixed = true;
  out.sphere = false;
  out.half_extents = half_extents;
  return out;
}

BodyState at(const Vector& position, const Vector& velocity = {}) {
  BodyState out;
  out.position = position;
  out.velocity = velocity;
  return out;
}

/// No gravity, damping, friction or dissipation, and the energies and momenta that go with `energy` J.
Setting calm(const StudyRow& row, double energy, double mass, double length) {
  Setting out;
  out.physics.gravity = {0, 0, 0};
  out.physics.linear_damping = out.physics.angular_damping = 0;
  out.physics.material = {.stiffness = 1e8, .dissipation = 0, .static_friction = 0, .dynamic_friction = 0};
  if (!std::isnan(row.stiffness)) out.physics.material.stiffness = row.stiffness;
  if (!std::isnan(row.dissipation)) out.physics.material.dissipation = row.dissipation;
  if (!std::isnan(row.greatest_step)) out.physics.greatest_step = row.greatest_step;
  out.physics.final_time = row.duration;
  out.physics.balance.energy = energy;
  out.physics.balance.momentum = std::sqrt(2 * energy * mass);
  out.physics.balance.angular_momentum = out.physics.balance.momentum * length;
  out.length = length;
  out.mass = mass;
  return out;
}

/// Everything that far from the origin along each axis.
void shift(Setting& setting, double offset) {
  if (std::isnan(offset) || offset == 0) return;
  const Vector by{offset, offset, offset};
  for (BodyState& state : setting.states) state.position = state.position + by;
  setting.physics.balance.about = setting.physics.balance.about + by;
  setting.floor += offset;
  if (setting.reference)
    setting.reference = [near = setting.reference, by] {
      std::vector<BodyState> states = near();
      for (BodyState& state : states) state.position = state.position + by;
      return states;
    };
}

Setting free_flight(const StudyRow& row) {
  const double mass = ball_mass(row.radius);
  Setting out = calm(row, mass * row.speed * row.speed / 2, mass, row.speed * row.duration);
  out.time = row.duration;
  out.physics.gravity = {0, -kGravity, 0};
  out.bodies = {ball(row.radius, mass)};
  out.states = {at({0, 0, 0}, row.speed * Vector{0.6, 0.8, 0})};
  out.states[0].angular_velocity = {3, 2, 1};
  out.reference = [start = out.states[0], gravity = out.physics.gravity, time = row.duration] {
    return std::vector{thrown(start, gravity, time)};
  };
  shift(out, row.offset);
  return out;
}

/// A ball that meets a floor head on; `dissipation` absent means 0.
Setting bounce(const StudyRow& row) {
  const double mass = ball_mass(row.radius), gap = 0.4 * row.speed * row.duration;
  Setting out = calm(row, mass * row.speed * row.speed / 2, mass, row.radius);
  out.time = row.radius / row.speed;
  out.bodies = {plate({kDeep * row.radius, kDeep * row.radius, kDeep * row.radius}), ball(row.radius, mass)};
  out.states = {at({0, -kDeep * row.radius, 0}), at({0, row.radius + gap, 0}, {0, -row.speed, 0})};
  out.physics.balance.tracked = row.dissipation > 0;
  out.reference = [row, mass, gap, states = out.states]() mutable {
    const bool lossless = !(row.dissipation > 0);
    const double parted =
        lossless ? gap_after_bounce(gap, row.speed, hertz_stiffness(row.stiffness, row.radius), mass, row.duration)
                 : std::numeric_limits<double>::quiet_NaN();
    // No closed form with loss, nor while they touch.
    states[1].position[1] = std::isnan(parted) ? column_heights({{mass},
                                                                 {row.radius},
                                                                 {row.radius + gap},
                                                                 {-row.speed},
                                                                 row.stiffness,
                                                                 lossless ? 0 : row.dissipation},
                                                                row.duration)[0]
                                               : row.radius + parted;
    return states;
  };
  shift(out, row.offset);
  return out;
}

/// A box of 1 x 2 x 3 m that turns nearly about its middle axis, and so tumbles.
Setting top(const StudyRow& row) {
  RigidBody box = plate({0.5, 1, 1.5});
  box.fixed = false;
  box.mass = kDensity * 6;
  const auto& h = box.half_extents;
  const Vector inertia =
      box.mass / 3 * Vector{h[1] * h[1] + h[2] * h[2], h[0] * h[0] + h[2] * h[2], h[0] * h[0] + h[1] * h[1]};
  const Vector spin{0.2, 3, 0.3};
  double energy = 0;
  for (int i = 0; i < 3; ++i) energy += inertia[i] * spin[i] * spin[i] / 2;
  Setting out = calm(row, energy, box.mass, 1.5);
  out.time = 1. / 3;
  out.bodies = {box};
  out.states = {at({0, 0, 0})};
  out.states[0].angular_velocity = spin;
  out.reference = [inertia, spin, time = row.duration, states = out.states]() mutable {
    states[0].orientation = top_orientation(inertia, spin, time);
    return states;
  };
  return out;
}

/// A ball of 0.1 m on a rod of 1 m that is let go at 2 rad. Within 1 s methods of even order still err in one sense:
/// later their errors of phase and of amplitude, of neighbouring orders, cancel at some step.
Setting pendulum(const StudyRow& row) {
  constexpr double kRod = 1, kAngle = 2;
  const double radius = 0.1, mass = ball_mass(radius);
  RigidBody bob = ball(radius, mass);
  bob.hung = true;
  Setting out = calm(row, mass * kGravity * kRod * (1 - std::cos(kAngle)), mass, kRod);
  out.physics.gravity = {0, -kGravity, 0};
  out.time = std::sqrt(kRod / kGravity);
  const auto hanging = [](double angle) {
    BodyState state = at(kRod * Vector{std::sin(angle), -std::cos(angle), 0});
    state.orientation = {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
    return state;
  };
  const double frequency = std::sqrt(mass * kGravity * kRod / (bob.inertia + mass * kRod * kRod));
  out.bodies = {bob};
  out.states = {hanging(kAngle)};
  out.reference = [hanging, frequency, time = row.duration] {
    return std::vector{hanging(pendulum_angle(kAngle, frequency, time))};
  };
  return out;
}

/// Two balls of 1 and 0.7 radii in free space, head on along a skew line.
Setting two_balls(const StudyRow& row) {
  const double r1 = row.radius, r2 = 0.7 * row.radius, m1 = ball_mass(r1), m2 = ball_mass(r2);
  const double gap = 0.4 * row.speed * row.duration, reduced = m1 * m2 / (m1 + m2);
  const Vector line{1. / 3, 2. / 3, 2. / 3};
  Setting out = calm(row, reduced * row.speed * row.speed / 2, m1 + m2, row.radius);
  out.time = row.radius / row.speed;
  out.bodies = {ball(r1, m1), ball(r2, m2)};
  // The first at rest, so that the centre of mass moves.
  out.states = {at({0, 0, 0}), at((r1 + r2 + gap) * line, -row.speed * line)};
  out.reference = [=, time = row.duration, stiffness = row.stiffness, speed = row.speed,
                   states = out.states]() mutable {
    const double hertz = hertz_stiffness(stiffness, r1 * r2 / (r1 + r2));
    double apart = r1 + r2 + gap_after_bounce(gap, speed, hertz, reduced, time);
    // No closed form while they touch, nor when they are so soft that they pass through each other.
    if (std::isnan(apart) || hertz_depth(hertz, reduced, speed) >= r1 + r2) {
      const auto heights =
          column_heights({{m1, m2}, {r1, r2}, {0, r1 + r2 + gap}, {0, -speed}, stiffness, 0, 0, false}, time);
      apart = heights[1] - heights[0];
    }
    const double centre = m2 / (m1 + m2) * (r1 + r2 + gap - speed * time);  // of mass, along the line
    states[0].position = (centre - m2 / (m1 + m2) * apart) * line;
    states[1].position = (centre + m1 / (m1 + m2) * apart) * line;
    return states;
  };
  shift(out, row.offset);
  return out;
}

/// Balls one on the other, touching without load, on a floor: they sink into each other and settle.
Setting stack(const StudyRow& row) {
  const int count = static_cast<int>(row.balls);
  BallColumn column;
  double mass = 0, energy = 0;
  for (int i = 0; i < count; ++i) {
    const double one = ball_mass(row.radius) * (i == count - 1 ? row.mass_ratio : 1);
    column.mass.push_back(one);
    column.radius.push_back(row.radius);
    column.height.push_back((2 * i + 1) * row.radius);
    column.speed.push_back(0);
    mass += one;
    energy += one * kGravity * column.height.back();
  }
  Setting out = calm(row, energy, mass, row.radius);
  out.time = std::sqrt(row.radius / kGravity);
  out.physics.gravity = {0, -kGravity, 0};
  out.physics.balance.tracked = true;
  out.physics.material.static_friction = 0.5;
  out.physics.material.dynamic_friction = 0.4;
  out.bodies = {plate({kDeep * row.radius, kDeep * row.radius, kDeep * row.radius})};
  out.states = {at({0, -kDeep * row.radius, 0})};
  for (int i = 0; i < count; ++i) {
    out.bodies.push_back(ball(row.radius, column.mass[i]));
    out.states.push_back(at({0, column.height[i], 0}));
  }
  column.stiffness = row.stiffness;
  column.dissipation = row.dissipation;
  column.gravity = kGravity;
  out.reference = [column, time = row.duration, states = out.states]() mutable {
    const std::vector<double> heights = column_heights(column, time);
    for (std::size_t i = 0; i < heights.size(); ++i) states[i + 1].position[1] = heights[i];
    return states;
  };
  shift(out, row.offset);
  return out;
}

/// A ball that falls five radii onto a floor while it flies along it, and goes on bouncing, sliding and rolling.
Setting drop(const StudyRow& row) {
  const double mass = row.mass, fall = 5 * row.radius;
  Setting out = calm(row, mass * (kGravity * fall + row.speed * row.speed / 2), mass, row.radius);
  out.time = std::sqrt(row.radius / kGravity);
  out.physics.gravity = {0, -kGravity, 0};
  out.physics.balance.tracked = true;
  out.physics.material.static_friction = 0.5;
  out.physics.material.dynamic_friction = 0.4;
  out.physics.material.transition_velocity = row.transition_velocity;
  out.bodies = {plate({kDeep * row.radius, kDeep * row.radius, kDeep * row.radius}), ball(row.radius, mass)};
  out.bodies[1].inertia = row.inertia;
  out.states = {at({0, -kDeep * row.radius, 0}), at({0, row.radius + fall, 0}, {row.speed, 0, 0})};
  shift(out, row.offset);
  return out;
}

/// A fast ball and a thin plate.
Setting thin_plate(const StudyRow& row) {
  const double mass = ball_mass(row.radius), half = row.thickness / 2;
  Setting out = calm(row, mass * row.speed * row.speed / 2, mass, row.radius);
  out.time = row.radius / row.speed;
  out.bodies = {plate({kDeep * row.radius, half, kDeep * row.radius}), ball(row.radius, mass)};
  out.states = {at({0, -half, 0}), at({0, 6 * row.radius, 0}, {0, -row.speed, 0})};
  out.floor = -half;
  return out;
}

/// Two balls in the same place: the force has no direction there, and the law of contact chooses one.
Setting coincident(const StudyRow& row) {
  const double mass = ball_mass(row.radius);
  const double hertz = hertz_stiffness(row.stiffness, row.radius / 2);
  Setting out = calm(row, 2. / 5. * hertz * std::pow(2 * row.radius, 2.5), 2 * mass, row.radius);
  out.time = std::sqrt(mass / (hertz * std::sqrt(row.radius)));
  out.bodies = {ball(row.radius, mass), ball(row.radius, mass)};
  out.states = {at({0, 0, 0}), at({0, 0, 0})};
  return out;
}

}  // namespace

const std::vector<Problem>& problems() {
  static const std::vector<Problem> all = {
      {"free_flight",
       "a spinning ball thrown under gravity; reference: closed form",
       {{"duration", 1}, {"radius", 1}, {"speed", 10}, {"offset", 0}, {"greatest_step", 0.1}},
       free_flight},
      {"bounce",
       "a ball bounces off a floor without loss, no gravity; reference: closed form of Hertz",
       {{"duration", 1}, {"radius", 1}, {"speed", 5}, {"offset", 0}, {"greatest_step", 0.01}, {"stiffness", 1e8}},
       bounce},
      {"damped_bounce",
       "the same with Hunt and Crossley's dissipation; reference: an independent solver",
       {{"duration", 1},
        {"radius", 1},
        {"speed", 5},
        {"offset", 0},
        {"greatest_step", 0.01},
        {"stiffness", 1e8},
        {"dissipation", 0.1}},
       bounce},
      {"top",
       "a free box tumbles; reference: Jacobi's elliptic functions",
       {{"duration", 8}, {"greatest_step", 0.1}},
       top},
      {"pendulum",
       "a ball on a rod swings from 2 rad; reference: an elliptic function",
       {{"duration", 1}, {"greatest_step", 0.1}},
       pendulum},
      {"two_balls",
       "two balls meet head on in free space without loss; reference: closed form of Hertz and momentum",
       {{"duration", 1}, {"radius", 1}, {"speed", 5}, {"offset", 0}, {"greatest_step", 0.01}, {"stiffness", 1e8}},
       two_balls},
      {"stack",
       "balls on each other settle on a floor; no closed form, reference: an independent solver of the column",
       {{"duration", 1},
        {"radius", 1},
        {"offset", 0},
        {"greatest_step", 0.01},
        {"balls", 10},
        {"mass_ratio", 1},
        {"stiffness", 1e8},
        {"dissipation", 0.1}},
       stack},
      {"drop",
       "a ball falls five radii onto a floor, bounces, slides and rolls; no reference, energy and momentum balance",
       {{"duration", 4},
        {"radius", 1},
        {"mass", StudyRow::kNone},
        {"inertia", StudyRow::kNone},
        {"speed", 1},
        {"offset", 0},
        {"greatest_step", 0.01},
        {"transition_velocity", 0.5},
        {"stiffness", 1e8},
        {"dissipation", 0.1}},
       drop},
      {"thin_plate",
       "a fast ball meets a thin plate, no gravity: does it pass, and which greatest step stops it?",
       {{"duration", 0.004},
        {"radius", 1},
        {"thickness", 0.2},
        {"speed", 5000},
        {"greatest_step", 0.01},
        {"stiffness", 1e12}},
       thin_plate},
      {"coincident",
       "two balls with one centre, at rest: they part along y; no reference, energy and momentum are conserved",
       {{"duration", 0.5}, {"radius", 1}, {"greatest_step", 0.01}, {"stiffness", 1e8}},
       coincident},
  };
  return all;
}

void complete(StudyRow& row) {
  if (row.problem != "drop") return;
  if (std::isnan(row.mass)) row.mass = ball_mass(row.radius);
  if (std::isnan(row.inertia)) row.inertia = 0.4 * row.mass * row.radius * row.radius;
}

ParameterRule parameter_rule(const std::string& problem, const std::string& name) {
  if (name == "offset") return {.range = {.least = -1e12, .most = 1e12}};
  if (name == "dissipation") return {.range = {.least = 0, .most = 1e12}};
  // Only what falls meets anything without a speed of its own.
  if (name == "speed") return {.range = {.least = 0, .most = 1e12, .above = problem != "drop"}};
  if (name == "balls") return {.range = {.least = 1, .most = 1000}, .whole = true};
  return {.range = {.least = 0, .most = 1e30, .above = true}};
}

Setting in_units(Setting setting, double length, double mass, double time) {
  const double velocity = length / time, energy = mass * velocity * velocity;
  for (RigidBody& body : setting.bodies) {
    body.radius /= length;
    body.half_extents = 1 / length * body.half_extents;
    body.mass /= mass;
    body.inertia /= mass * length * length;
    body.centre_of_mass = 1 / length * body.centre_of_mass;
    for (double& moment : body.inertia_matrix) moment /= mass * length * length;
    body.pivot = 1 / length * body.pivot;
  }
  for (BodyState& state : setting.states) {
    state.position = 1 / length * state.position;
    state.velocity = 1 / velocity * state.velocity;
    state.angular_velocity = time * state.angular_velocity;
  }
  Physics& p = setting.physics;
  p.greatest_step /= time;
  p.fixed_step /= time;
  p.final_time /= time;
  p.gravity = time / velocity * p.gravity;
  p.linear_damping *= time;
  p.angular_damping *= time;
  p.material.stiffness /= energy / (length * length * length);
  p.material.dissipation *= velocity;
  p.material.viscous_friction *= velocity;
  p.material.transition_velocity /= velocity;
  p.balance.energy /= energy;
  p.balance.momentum /= mass * velocity;
  p.balance.angular_momentum /= mass * velocity * length;
  p.balance.about = 1 / length * p.balance.about;
  setting.floor /= length;
  return setting;
}

}  // namespace pipeline
