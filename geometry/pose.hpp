// Poses: where a body is, and the one place where its vertices become world vertices.
#pragma once
#include <Eigen/Core>
#include <span>

namespace geometry {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// A rotation, scalar first. A unit quaternion unless said otherwise.
struct Quaternion {
  double w = 1, x = 0, y = 0, z = 0;
};

/// p_world = R(q) p_local + t; t in metres.
struct Pose {
  Quaternion q;
  Vec3 t = Vec3::Zero();
};

/// Babylon.js's angles of q (radians), R = Ry(y) Rx(x) Rz(z): z is applied first.
struct EulerAngles {
  double x = 0, y = 0, z = 0;
};

/// The pose of a body that is not born yet, or whose motion failed: NaN throughout.
Pose unborn();

/// False for a pose with a NaN in it. Such a body takes part in no pair.
bool is_born(const Pose& pose);

/// The computed norm: the root of ((ww + xx) + yy) + zz.
double norm(const Quaternion& q);

/// q at unit length; q itself, bit for bit, when its computed squared norm ((ww + xx) + yy) + zz is within 1e-15 of 1.
/// Divides by the root of that norm; components whose squares would overflow or underflow are first divided by the
/// largest. A result is within 7.8e-16 (measured: 80 million random q and a search for worse ones), so that a second
/// time changes nothing. NaN for a zero q, or one with an infinity or NaN.
Quaternion normalised(const Quaternion& q);

/// The quaternion that turns by `angle` (radians) about the unit vector `axis`. Same bits on every machine. Unit to
/// rounding only: whoever makes a pose of it normalises it.
Quaternion turn_about(const Vec3& axis, double angle);

/// The product p q: first q, then p. Not normalised.
Quaternion operator*(const Quaternion& p, const Quaternion& q);

/// R(q), from q as it stands (Eigen's toRotationMatrix gives the same bits).
Mat3 rotation(const Quaternion& q);

/// Babylon.js's Quaternion.toEulerAngles. Same bits on every machine.
EulerAngles euler_angles(const Quaternion& q);

/// The world vertex ((r0 x + r1 y) + r2 z) + t in IEEE doubles, never fused. Truth is defined by this rounding,
/// so nothing else in the project may turn a vertex for a decision that claims to be exact.
inline Vec3 to_world(const Mat3& r, const Vec3& t, const Vec3& v) {
  return {((r(0, 0) * v.x() + r(0, 1) * v.y()) + r(0, 2) * v.z()) + t.x(),
          ((r(1, 0) * v.x() + r(1, 1) * v.y()) + r(1, 2) * v.z()) + t.y(),
          ((r(2, 0) * v.x() + r(2, 1) * v.y()) + r(2, 2) * v.z()) + t.z()};
}

/// to_world for every vertex; `out` has the size of `local`.
void to_world(const Pose& pose, std::span<const Vec3> local, std::span<Vec3> out);

}  // namespace geometry
