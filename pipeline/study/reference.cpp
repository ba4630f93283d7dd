#include "pipeline/study/reference.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace pipeline {
namespace {

using Vector = std::array<double, 3>;
using Extended = std::vector<long double>;

// ---- Rotations as 3 x 3 matrices ----

using Matrix = std::array<Vector, 3>;

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix out{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) out[i][j] += a[i][k] * b[k][j];
  return out;
}

Matrix transposed(const Matrix& m) {
  Matrix out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out[i][j] = m[j][i];
  return out;
}

Matrix about_z(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
}

Matrix about_x(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
}

/// Shepperd's method: through the greatest of the four parts.
std::array<double, 4> quaternion(const Matrix& r) {
  const double trace = r[0][0] + r[1][1] + r[2][2];
  std::array<double, 4> q{};
  int most = 0;
  for (int i = 1; i < 3; ++i)
    if (r[i][i] > r[most][most]) most = i;
  if (trace >= r[most][most]) {
    q = {1 + trace, r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]};
  } else {
    const int i = most, j = (i + 1) % 3, k = (i + 2) % 3;
    q[0] = r[k][j] - r[j][k];
    q[1 + i] = 1 + 2 * r[i][i] - trace;
    q[1 + j] = r[j][i] + r[i][j];
    q[1 + k] = r[k][i] + r[i][k];
  }
  const double norm = std::sqrt(std::inner_product(q.begin(), q.end(), q.begin(), 0.0));
  for (double& part : q) part /= norm;
  return q;
}

std::array<double, 4> product(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

// ---- The free top ----

/// The top in a right-handed frame along its axes in which the third axis is the one that the angular momentum keeps
/// circling, and the second is the middle one: there w1 = a cn, w2 = b sn, w3 = c dn of (rate t + phase).
struct Top {
  Matrix turn;  // from the body's frame into this one
  Vector inertia;
  double a, b, c, rate, phase, modulus;
  double momentum;

  Top(const Vector& body_inertia, const Vector& body_spin) {
    std::array<int, 3> by_size{0, 1, 2};
    std::ranges::sort(by_size, {}, [&](int axis) { return body_inertia[axis]; });
    double energy2 = 0, momentum2 = 0;
    for (int i = 0; i < 3; ++i) {
      energy2 += body_inertia[i] * body_spin[i] * body_spin[i];
      momentum2 += body_inertia[i] * body_inertia[i] * body_spin[i] * body_spin[i];
    }
    const bool about_greatest = momentum2 > energy2 * body_inertia[by_size[1]];
    const std::array<int, 3> axis{by_size[about_greatest ? 0 : 2], by_size[1], by_size[about_greatest ? 2 : 0]};
    const bool even = (axis[1] - axis[0] + 3) % 3 == 1;
    turn = {};
    for (int i = 0; i < 3; ++i) turn[i][axis[i]] = 1;
    // Half a turn or a reflection more: right-handed, with the angular momentum on the positive side of axis 3.
    const double side = body_spin[axis[2]] < 0 ? -1 : 1;
    turn[2][axis[2]] = side;
    turn[0][axis[0]] = even ? side : -side;

    Vector spin;
    for (int i = 0; i < 3; ++i) {
      inertia[i] = body_inertia[axis[i]];
      spin[i] = turn[i][axis[i]] * body_spin[axis[i]];
    }
    const auto& [i1, i2, i3] = inertia;
    momentum = std::sqrt(momentum2);
    a = std::sqrt((energy2 * i3 - momentum2) / (i1 * (i3 - i1)));
    b = std::sqrt((energy2 * i3 - momentum2) / (i2 * (i3 - i2)));
    c = std::sqrt((momentum2 - energy2 * i1) / (i3 * (i3 - i1)));
    rate = std::sqrt((i3 - i2) * (momentum2 - energy2 * i1) / (i1 * i2 * i3));
    if (i3 < i2) rate = -rate;
    modulus = std::sqrt((i2 - i1) * (energy2 * i3 - momentum2) / ((i3 - i2) * (momentum2 - energy2 * i1)));
    phase = boost::math::ellint_1(modulus, std::atan2(spin[1] / b, spin[0] / a));
  }

  Vector spin(double time) const {
    double cn, dn;
    const double sn = boost::math::jacobi_elliptic(modulus, rate * time + phase, &cn, &dn);
    return {a * cn, b * sn, c * dn};
  }

  /// The rotation by the angles between the angular momentum and the body; the third angle is a quadrature.
  Matrix tilt(double time) const {
    const Vector w = spin(time);
    const double x = inertia[0] * w[0], y = inertia[1] * w[1];
    return about_x(std::atan2(std::hypot(x, y), inertia[2] * w[2])) * about_z(std::atan2(x, y));
  }
  double precession(double time) const {
    const auto speed = [&](double t) {
      const Vector w = spin(t);
      const double x = inertia[0] * w[0], y = inertia[1] * w[1];
      return momentum * (x * w[0] + y * w[1]) / (x * x + y * y);
    };
    // In pieces of a fraction of a period: the integrand is smooth, and 31 points give all digits.
    const int pieces = std::max(1, static_cast<int>(std::ceil(std::fabs(rate) * time)));
    double sum = 0;
    for (int i = 0; i < pieces; ++i)
      sum += boost::math::quadrature::gauss_kronrod<double, 31>::integrate(speed, time * i / pieces,
                                                                           time * (i + 1) / pieces, 5, 1e-14);
    return sum;
  }
};

// ---- Boost.Odeint ----

// Dormand and Prince's 5(4) in extended precision. Fehlberg's 7(8) would take fewer steps, but its estimate of the
// error is zero for what is nearly a quadrature, as a ball that enters a contact at a steady speed is: it missed 1e-8 m
// there.

/// Integrates from 0 to `time`; `greatest` s is the greatest step. `look` is given every state that is kept.
template <class System, class Look>
void integrate(const System& system, Extended& state, double time, double greatest, double tolerance,
               const Look& look) {
  namespace odeint = boost::numeric::odeint;
  using Stepper = odeint::runge_kutta_dopri5<Extended, long double>;
  const auto controlled = odeint::make_controlled<Stepper>(tolerance, tolerance, static_cast<long double>(greatest));
  odeint::integrate_adaptive(controlled, system, state, 0.0L, static_cast<long double>(time),
                             static_cast<long double>(greatest) / 16,
                             [&](const Extended& kept, long double) { look(kept); });
}

}  // namespace

double hertz_stiffness(double stiffness, double radius) {
  // Two surfaces of one material: their plane-strain moduli to the power 2/3 act in series (contact.hpp).
  return 4. / 3. * stiffness / std::pow(2., 1.5) * std::sqrt(radius);
}

double hertz_depth(double hertz, double mass, double speed) {
  return std::pow(5. / 4. * mass * speed * speed / hertz, 2. / 5.);
}

double hertz_contact_time(double hertz, double mass, double speed) {
  const double integral = std::sqrt(boost::math::constants::pi<double>()) * boost::math::tgamma(7. / 5.) /
                          boost::math::tgamma(9. / 10.);  // of 1 / sqrt(1 - x^(5/2)) from 0 to 1
  return 2 * integral * hertz_depth(hertz, mass, speed) / speed;
}

double gap_after_bounce(double gap, double speed, double hertz, double mass, double time) {
  const double touch = gap / speed;
  const double parted = touch + hertz_contact_time(hertz, mass, speed);
  if (time <= touch) return gap - speed * time;
  return time < parted ? std::numeric_limits<double>::quiet_NaN() : speed * (time - parted);
}

BodyState thrown(const BodyState& start, const std::array<double, 3>& gravity, double time) {
  BodyState out = start;
  double speed2 = 0;
  for (int i = 0; i < 3; ++i) {
    out.position[i] += time * (start.velocity[i] + time / 2 * gravity[i]);
    out.velocity[i] += time * gravity[i];
    speed2 += start.angular_velocity[i] * start.angular_velocity[i];
  }
  if (speed2 == 0) return out;
  const double speed = std::sqrt(speed2), half = speed * time / 2;
  std::array<double, 4> turn{std::cos(half)};
  for (int i = 0; i < 3; ++i) turn[1 + i] = std::sin(half) * start.angular_velocity[i] / speed;
  out.orientation = product(turn, start.orientation);
  return out;
}

double pendulum_angle(double angle, double frequency, double time) {
  const double modulus = std::sin(angle / 2);
  double cn, dn;
  boost::math::jacobi_elliptic(std::fabs(modulus), frequency * time, &cn, &dn);
  return 2 * std::asin(modulus * cn / dn);
}

std::array<double, 3> top_spin(const std::array<double, 3>& inertia, const std::array<double, 3>& spin, double time) {
  const Top top(inertia, spin);
  const Vector w = top.spin(time);
  Vector out{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out[i] += top.turn[j][i] * w[j];
  return out;
}

std::array<double, 4> top_orientation(const std::array<double, 3>& inertia, const std::array<double, 3>& spin,
                                      double time) {
  const Top top(inertia, spin);
  const Matrix start = top.tilt(0) * top.turn;
  return quaternion(transposed(start) * about_z(top.precession(time)) * top.tilt(time) * top.turn);
}

std::array<double, 4> top_orientation_by_steps(const std::array<double, 3>& inertia, const std::array<double, 3>& spin,
                                               double time) {
  const auto& [i1, i2, i3] = inertia;
  Extended state{1, 0, 0, 0, spin[0], spin[1], spin[2]};  // quaternion, angular velocity in the body's frame
  const auto system = [&](const Extended& y, Extended& rate, long double) {
    const long double x = y[4], v = y[5], w = y[6];
    rate.resize(7);
    rate[0] = (-y[1] * x - y[2] * v - y[3] * w) / 2;
    rate[1] = (y[0] * x + y[2] * w - y[3] * v) / 2;
    rate[2] = (y[0] * v + y[3] * x - y[1] * w) / 2;
    rate[3] = (y[0] * w + y[1] * v - y[2] * x) / 2;
    rate[4] = (i2 - i3) / i1 * v * w;
    rate[5] = (i3 - i1) / i2 * w * x;
    rate[6] = (i1 - i2) / i3 * x * v;
  };
  integrate(system, state, time, 0.05, 1e-16, [](const Extended&) {});
  std::array<double, 4> out;
  for (int i = 0; i < 4; ++i) out[i] = static_cast<double>(state[i]);
  const double norm = std::sqrt(std::inner_product(out.begin(), out.end(), out.begin(), 0.0));
  for (double& part : out) part /= norm;
  return out;
}

std::vector<double> column_heights(const BallColumn& column, double time, std::size_t most_forces) {
  const std::size_t count = column.mass.size();
  const double greatest = *std::ranges::max_element(column.radius);
  Extended state(2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    state[i] = column.height[i];
    state[count + i] = column.speed[i];
  }
  std::size_t forces = 0;
  const auto system = [&](const Extended& y, Extended& rate, long double) {
    if ((forces += count) > most_forces)
      throw std::range_error("its reference would take more than " + std::to_string(most_forces) + " forces");
    rate.assign(2 * count, 0);
    /// Of Hunt and Crossley, between ball `upper` and what is below it at `height`, with `speed`.
    const auto force = [&](std::size_t upper, long double height, long double speed, double reach, double radius) {
      const long double depth = reach - (y[upper] - height);
      if (depth <= 0) return 0.0L;
      const long double approach = speed - y[count + upper];
      const long double hertz = hertz_stiffness(column.stiffness, radius);
      return std::max(0.0L, hertz * depth * std::sqrt(depth) * (1 + 1.5L * column.dissipation * approach));
    };
    for (std::size_t i = 0; i < count; ++i) {
      const double r = column.radius[i];
      rate[i] = y[count + i];
      rate[count + i] -= column.gravity;
      if (column.floor) rate[count + i] += force(i, 0, 0, r, r) / column.mass[i];
      // Soft ones reach the next but one.
      for (std::size_t j = i; j-- > 0 && y[i] - y[j] < r + greatest;) {
        const double other = column.radius[j];
        const long double push = force(i, y[j], y[count + j], r + other, r * other / (r + other));
        rate[count + i] += push / column.mass[i];
        rate[count + j] -= push / column.mass[j];
      }
    }
  };
  // Only of states that are kept: a step that is tried and refused may throw balls anywhere.
  const auto in_order = [&](const Extended& y) {
    for (std::size_t i = 1; i < count; ++i)
      if (y[i] <= y[i - 1]) throw std::range_error("its balls pass through each other, where no reference is known");
  };
  // No contact may pass between two steps, however calm the flight before it.
  integrate(system, state, time, time / 1024, 1e-16 * greatest, in_order);
  return {state.begin(), state.begin() + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace pipeline
