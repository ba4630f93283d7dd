// The references of the integrators' test problems, against each other, conservation laws and textbook figures. None of
// it uses Simbody.
#include "pipeline/study/reference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace {

using pipeline::column_heights;
using pipeline::gap_after_bounce;
using pipeline::hertz_contact_time;
using pipeline::hertz_stiffness;
using pipeline::pendulum_angle;
using pipeline::top_orientation;
using pipeline::top_spin;
using Vector = std::array<double, 3>;

double angle_between(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  // Through the vector part of conj(a) b, which has all digits at small angles.
  const double x = a[0] * b[1] - a[1] * b[0] - a[2] * b[3] + a[3] * b[2];
  const double y = a[0] * b[2] - a[2] * b[0] - a[3] * b[1] + a[1] * b[3];
  const double z = a[0] * b[3] - a[3] * b[0] - a[1] * b[2] + a[2] * b[1];
  return 2 * std::asin(std::min(1.0, std::sqrt(x * x + y * y + z * z)));
}

Vector turned(const std::array<double, 4>& q, const Vector& v) {
  const auto& [w, x, y, z] = q;
  const Vector t{2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])};
  return {v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2],
          v[2] + w * t[2] + x * t[1] - y * t[0]};
}

TEST(Reference, HertzContactLastsAsTheLiteratureSays) {
  // 2.94 greatest depths over the speed: Landau & Lifshitz, Theory of Elasticity, § 9, and Hertz himself.
  const double hertz = 3e7, mass = 4189, speed = 5;
  const double depth = std::pow(1.25 * mass * speed * speed / hertz, 0.4);
  EXPECT_NEAR(hertz_contact_time(hertz, mass, speed) * speed / depth, 2.94, 0.005);
  // Twice the mass lasts 2^(2/5) as long, twice the speed 2^(-1/5), twice the stiffness 2^(-2/5).
  const double one = hertz_contact_time(hertz, mass, speed);
  EXPECT_NEAR(hertz_contact_time(hertz, 2 * mass, speed) / one, std::pow(2, 0.4), 1e-12);
  EXPECT_NEAR(hertz_contact_time(hertz, mass, 2 * speed) / one, std::pow(2, -0.2), 1e-12);
  EXPECT_NEAR(hertz_contact_time(2 * hertz, mass, speed) / one, std::pow(2, -0.4), 1e-12);
}

TEST(Reference, ALosslessBounceByStepsIsTheClosedForm) {
  const double mass = 4189, radius = 1, speed = 5, gap = 2, time = 1;
  const auto heights = column_heights({{mass}, {radius}, {radius + gap}, {-speed}, 1e8, 0, 0, true}, time);
  const double closed = gap_after_bounce(gap, speed, hertz_stiffness(1e8, radius), mass, time);
  EXPECT_NEAR(heights[0] - radius, closed, 1e-12);
}

TEST(Reference, ADampedBounceLosesWhatItsFirstIntegralSays) {
  // m v dv = -K x^(3/2) (1 + a v) dx over x from 0 to 0 gives u + ln(1 - a u) / a = -v... : with a = 1.5 dissipation,
  // v - ln(1 + a v) / a = -u - ln(1 - a u) / a for speeds v before and u after.
  const double speed = 5, dissipation = 0.1, a = 1.5 * dissipation, time = 1, gap = 2;
  pipeline::BallColumn column{{4189}, {1}, {1 + gap}, {-speed}, 1e8, dissipation, 0, true};
  const double later = column_heights(column, time)[0], still_later = column_heights(column, time + 0.5)[0];
  const double out = (still_later - later) / 0.5;
  EXPECT_LT(out, speed);
  EXPECT_NEAR(speed - std::log1p(a * speed) / a, -out - std::log1p(-a * out) / a, 1e-10);
}

TEST(Reference, TwoBallsInAColumnSwapSpeedsOfEqualMasses) {
  const pipeline::BallColumn column{{10, 10}, {0.5, 0.5}, {0, 3}, {2, -4}, 1e7, 0, 0, false};
  const double first = 1, last = 1.5;
  const auto a = column_heights(column, first), b = column_heights(column, last);
  EXPECT_NEAR((b[0] - a[0]) / (last - first), -4, 1e-11);
  EXPECT_NEAR((b[1] - a[1]) / (last - first), 2, 1e-11);
}

TEST(Reference, AColumnAtRestStaysUnderItsHertzianLoad) {
  const double mass = 4189, gravity = 9.81, stiffness = 1e8;
  const double depth = std::pow(mass * gravity / hertz_stiffness(stiffness, 1), 2. / 3.);
  const auto heights = column_heights({{mass}, {1}, {1 - depth}, {0}, stiffness, 0.1, gravity, true}, 0.5);
  EXPECT_NEAR(heights[0], 1 - depth, 1e-14);
}

TEST(Reference, BallsThatPassThroughEachOtherHaveNone) {
  const pipeline::BallColumn soft{{10, 10}, {0.5, 0.5}, {0, 3}, {2, -4}, 1e2, 0, 0, false};
  EXPECT_THROW(column_heights(soft, 1), std::range_error);
  // So stiff that steps that are tried, and refused, throw them past each other: that is no passing.
  const pipeline::BallColumn stiff{{4189, 4189, 4189}, {1, 1, 1}, {1, 3, 5}, {0, 0, 0}, 1e30, 0.1, 9.81};
  try {
    column_heights(stiff, 1, 10'000);
    FAIL() << "a second of it takes more";
  } catch (const std::range_error& error) {
    EXPECT_STREQ(error.what(), "its reference would take more than 10000 forces");
  }
}

TEST(Reference, AColumnThatTakesTooLongIsGivenUp) {
  const pipeline::BallColumn column{{4189}, {1}, {3}, {-5}, 1e8, 0.1};
  EXPECT_THROW(column_heights(column, 1, 1000), std::range_error);
  EXPECT_EQ(column_heights(column, 1, 100'000), column_heights(column, 1));
}

TEST(Reference, ThePendulumIsHarmonicWhenSmallAndReturnsAfterItsPeriod) {
  EXPECT_NEAR(pendulum_angle(1e-4, 3, 0.7), 1e-4 * std::cos(2.1), 1e-12);
  // Period of 90 degrees: 1.18034 times that of small angles (textbook table).
  const double period = 1.1803405990160963 * 2 * std::numbers::pi / 3;
  EXPECT_NEAR(pendulum_angle(std::numbers::pi / 2, 3, period), std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(pendulum_angle(std::numbers::pi / 2, 3, period / 4), 0, 1e-12);
  EXPECT_NEAR(pendulum_angle(-2, 3, 0.4), -pendulum_angle(2, 3, 0.4), 1e-15);
}

// Every order of the axes, turning about the least or the greatest, forwards or backwards.
TEST(Reference, TheFreeTopKeepsEnergyAndMomentumAndAgreesWithSteps) {
  const double sizes[3] = {1, 2, 3.5};
  int order[3] = {0, 1, 2};
  do {
    const Vector inertia{sizes[order[0]], sizes[order[1]], sizes[order[2]]};
    for (const Vector& spin : {Vector{2, 0.5, -0.7}, Vector{-0.3, -0.4, 2.5}, Vector{0.3, -3, 0.2}, Vector{1, 2, -3}}) {
      for (const double time : {0.0, 0.3, 7.0}) {
        SCOPED_TRACE(testing::Message() << inertia[0] << ' ' << inertia[1] << ' ' << inertia[2] << " spin " << spin[0]
                                        << ' ' << spin[1] << ' ' << spin[2] << " at " << time);
        const Vector w = top_spin(inertia, spin, time);
        double energy = 0, energy0 = 0;
        Vector momentum, momentum0;
        for (int i = 0; i < 3; ++i) {
          energy += inertia[i] * w[i] * w[i];
          energy0 += inertia[i] * spin[i] * spin[i];
          momentum[i] = inertia[i] * w[i];
          momentum0[i] = inertia[i] * spin[i];
        }
        EXPECT_NEAR(energy, energy0, 1e-12 * energy0);
        const auto q = top_orientation(inertia, spin, time);
        const Vector now = turned(q, momentum);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(now[i], momentum0[i], 1e-11);
        EXPECT_LT(angle_between(q, pipeline::top_orientation_by_steps(inertia, spin, time)), 1e-11);
      }
    }
  } while (std::next_permutation(order, order + 3));
}

TEST(Reference, AThrownBallTurnsAboutItsSpin) {
  pipeline::BodyState start;
  start.velocity = {1, 2, 3};
  start.angular_velocity = {0, 0, std::numbers::pi};
  const auto after = pipeline::thrown(start, {0, -10, 0}, 0.5);
  EXPECT_NEAR(after.position[1], 1 - 1.25, 1e-15);
  EXPECT_NEAR(after.velocity[1], -3, 1e-15);
  EXPECT_NEAR(after.orientation[0], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(after.orientation[3], std::sqrt(0.5), 1e-15);
}

}  // namespace
