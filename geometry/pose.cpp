// Quaternions, Babylon.js's Euler angles and the placing of vertices.
//
// Truth is defined by these roundings: every sum and product is written out in its order, and no library may choose
// another one.
#include "geometry/pose.hpp"

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/portable_math.hpp"

namespace geometry {
namespace {

constexpr double kUnitTolerance = 1e-15;  // of the squared norm; about four units in the last place
// Beyond these the squared norm loses digits to underflow or is infinite.
constexpr double kLeastSquare = 1e-200, kMostSquare = 1e200;

double squared_norm(const Quaternion& q) { return ((q.w * q.w + q.x * q.x) + q.y * q.y) + q.z * q.z; }

Quaternion divided(const Quaternion& q, double by) { return {q.w / by, q.x / by, q.y / by, q.z / by}; }

}  // namespace

Pose unborn() {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  return {{nan, nan, nan, nan}, Vec3::Constant(nan)};
}

bool is_born(const Pose& pose) {
  const Quaternion& q = pose.q;
  for (const double value : {q.w, q.x, q.y, q.z, pose.t.x(), pose.t.y(), pose.t.z()})
    if (std::isnan(value)) return false;
  return true;
}

double norm(const Quaternion& q) { return std::sqrt(squared_norm(q)); }

Quaternion normalised(const Quaternion& q) {
  double square = squared_norm(q);
  if (std::abs(square - 1) <= kUnitTolerance) return q;
  Quaternion unit = q;
  if (!(square > kLeastSquare && square < kMostSquare)) {
    const double largest = std::fmax(std::fmax(std::abs(q.w), std::abs(q.x)), std::fmax(std::abs(q.y), std::abs(q.z)));
    unit = divided(q, largest);
    square = squared_norm(unit);
  }
  return divided(unit, std::sqrt(square));
}

Quaternion turn_about(const Vec3& axis, double angle) {
  const double s = portable::sin(0.5 * angle);
  return {portable::cos(0.5 * angle), s * axis.x(), s * axis.y(), s * axis.z()};
}

Quaternion operator*(const Quaternion& p, const Quaternion& q) {
  return {((p.w * q.w - p.x * q.x) - p.y * q.y) - p.z * q.z, ((p.w * q.x + p.x * q.w) + p.y * q.z) - p.z * q.y,
          ((p.w * q.y - p.x * q.z) + p.y * q.w) + p.z * q.x, ((p.w * q.z + p.x * q.y) - p.y * q.x) + p.z * q.w};
}

Mat3 rotation(const Quaternion& q) {
  const auto& [w, x, y, z] = q;
  Mat3 r;
  r << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
  return r;
}

EulerAngles euler_angles(const Quaternion& q) {
  constexpr double kGimbal = 0.4999999;  // Babylon.js's limit; asin's argument below stays under 1 because of it
  constexpr double quarter_turn = std::numbers::pi / 2;
  const auto& [w, x, y, z] = q;
  const double s = y * z - x * w;
  if (s < -kGimbal) return {quarter_turn, 2 * portable::atan2(y, w), 0};
  if (s > kGimbal) return {-quarter_turn, 2 * portable::atan2(y, w), 0};
  const double xx = x * x, yy = y * y, zz = z * z, ww = w * w;
  return {portable::asin(-2 * s), portable::atan2(2 * (z * x + y * w), ((zz - xx) - yy) + ww),
          portable::atan2(2 * (x * y + z * w), ((-zz - xx) + yy) + ww)};
}

void to_world(const Pose& pose, std::span<const Vec3> local, std::span<Vec3> out) {
  assert(local.size() == out.size() && "one world vertex per local vertex");
  const Mat3 r = rotation(pose.q);
  for (std::size_t i = 0; i < local.size(); ++i) out[i] = to_world(r, pose.t, local[i]);
}

}  // namespace geometry
