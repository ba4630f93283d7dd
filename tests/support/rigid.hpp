// Rigid bodies put together by hand, for the tests of the motion.
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "pipeline/physics/simulate.hpp"

namespace rigid {

using pipeline::BodyState;
using pipeline::Physics;
using pipeline::PhysicsSample;
using pipeline::RigidBody;
using pipeline::Simulation;
using Vector = std::array<double, 3>;

constexpr double kGravity = 9.81;

inline Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector operator*(double s, const Vector& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double length(const Vector& a) { return std::sqrt(dot(a, a)); }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Solid, of density 1000 kg/m^3.
inline RigidBody ball(double radius = 1) {
  RigidBody out;
  out.radius = radius;
  out.mass = 1000 * 4. / 3. * std::numbers::pi * radius * radius * radius;
  out.inertia = 0.4 * out.mass * radius * radius;
  return out;
}

inline RigidBody box(const Vector& half_extents, bool fixed) {
  RigidBody out;
  out.fixed = fixed;
  out.sphere = false;
  out.half_extents = half_extents;
  out.mass = 8000 * half_extents[0] * half_extents[1] * half_extents[2];
  return out;
}

inline BodyState at(const Vector& position, const Vector& velocity = {}) {
  BodyState out;
  out.position = position;
  out.velocity = velocity;
  return out;
}

/// No gravity, damping, friction, dissipation: energy is conserved.
inline Physics lossless() {
  Physics out;
  out.gravity = {};
  out.linear_damping = out.angular_damping = 0;
  out.material.dissipation = 0;
  out.material.static_friction = out.material.dynamic_friction = 0;
  return out;
}

inline void advance(Simulation& simulation, double time) {
  PhysicsSample sample;
  ASSERT_EQ(simulation.advance_to(time, sample), "");
}

}  // namespace rigid
