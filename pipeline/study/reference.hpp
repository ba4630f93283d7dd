// What the test problems of the integrators should give, without Simbody: closed forms where there are some, and an
// independent solver for balls in a column. The .cpp is the only file that includes Boost.
//
// Sources: Hertz's contact and its duration 2.94 (m^2 / (k^2 v))^(1/5): Landau & Lifshitz, Theory of Elasticity, § 9;
// the free top and its Jacobi elliptic functions: Landau & Lifshitz, Mechanics, § 37; the pendulum: § 11 there.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "pipeline/physics/simulate.hpp"

namespace pipeline {

/// N / m^(3/2): the force of a contact is this times depth^(3/2). `stiffness` Pa as Material's, `radius` m effective.
double hertz_stiffness(double stiffness, double radius);

/// m, the greatest depth of a lossless contact that `mass` kg (reduced) begins at `speed` m/s; `hertz` as above.
double hertz_depth(double hertz, double mass, double speed);

/// s that a lossless contact lasts when `mass` kg (reduced) meets it at `speed` m/s; `hertz` as above.
double hertz_contact_time(double hertz, double mass, double speed);

/// Distance m between two undeformed surfaces `time` s after it was `gap` m and shrank by `speed` m/s, through one
/// lossless contact. NaN while they touch.
double gap_after_bounce(double gap, double speed, double hertz, double mass, double time);

/// A ball thrown at `start`, `time` s later: a parabola, and a constant angular velocity.
BodyState thrown(const BodyState& start, const std::array<double, 3>& gravity, double time);

/// Angle rad of a pendulum `time` s after it hung at rest at `angle` rad; `frequency` rad/s is that of small angles.
double pendulum_angle(double angle, double frequency, double time);

/// Orientation (w x y z) of a free top `time` s after it was (1, 0, 0, 0) and turned by `spin` rad/s. `inertia` kg m^2
/// is that of its axes, all different; the motion must not be the separatrix of its middle axis.
std::array<double, 4> top_orientation(const std::array<double, 3>& inertia, const std::array<double, 3>& spin,
                                      double time);
/// Its angular velocity rad/s along its own axes.
std::array<double, 3> top_spin(const std::array<double, 3>& inertia, const std::array<double, 3>& spin, double time);

/// The same by steps of Boost.Odeint, to test the elliptic functions.
std::array<double, 4> top_orientation_by_steps(const std::array<double, 3>& inertia, const std::array<double, 3>& spin,
                                               double time);

/// Balls one above the other on a line, the lowest first, above a floor at height 0 where `floor`.
struct BallColumn {
  std::vector<double> mass, radius, height, speed;  // kg, m, m (of the centre), m/s upwards
  double stiffness = 1e8, dissipation = 0;          // as Material's
  double gravity = 0;                               // m/s^2 downwards
  bool floor = true;
};

/// Heights m of the centres `time` s later. Soft balls also touch the next but one, and the floor through each other.
/// Boost.Odeint in extended precision with a tolerance of 1e-16 per step, relative and of the greatest radius. That
/// gives 1e-13 m at the end where the motion allows it (measured against 1e-18: a second of the stack of ten up to 1e12
/// Pa); at 1e13 Pa ten balls part and meet so often that every rounding grows to 4e-6 m, and no solver knows better.
/// Throws std::range_error when it would take more than `most_forces` (a million take 0.04 s), or when two centres
/// meet: Simbody's balls pass through each other then, and their force jumps.
std::vector<double> column_heights(const BallColumn& column, double time, std::size_t most_forces = 200'000'000);

}  // namespace pipeline
