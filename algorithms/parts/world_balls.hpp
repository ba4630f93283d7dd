// Balls of a mesh's frame where a pose puts them, larger by every rounding on the way.
#pragma once
#include <cmath>

#include "algorithms/parts/enclosing_ball.hpp"
#include "geometry/pose.hpp"

namespace algorithms {

/// How much larger than in the mesh's frame a radius must be in the world, for what keeps within a ball of that frame,
/// no farther than `reach` from its origin, when its points become world vertices; and for the comparison of two such
/// balls by squares.
///
/// With u = 2^-53, v a point of the mesh, c the centre, r the radius, R as computed from the stored quaternion q:
///   e = | |q|^2 - 1 |,   |R w| <= (1 + 2 e + 20 u) |w|: its formula shows e twice, and its entries round (1) |fl(R v +
///   t) - (R v + t)| <= 16 u |v| + 2 u |t|, and so of c                                                    (2) |V - C|
///   <= r + (2 e + 20 u) r + 16 u (|v| + |c|) + 4 u |t|, with r <= 2 reach, |v| and |c| <= reach              (3)
/// The squares, sums and differences of a comparison err by at most 6 u of the sum of the radii, of which each body
/// takes its own part: 12 u reach.                                                                                  (4)
/// (3) and (4) are below (2^-46 + 4 e) reach + 2^-50 |t|; e is computed to within 4 u. `enlarge` as Method::prepare has
/// it.
inline double world_slack(double reach, const geometry::Pose& pose, double enlarge) {
  const geometry::Quaternion& q = pose.q;
  const geometry::Vec3& t = pose.t;
  const double e = std::fabs((((q.w * q.w + q.x * q.x) + q.y * q.y) + q.z * q.z) - 1);
  const double far = std::sqrt((t.x() * t.x() + t.y() * t.y()) + t.z() * t.z());
  return (0x1p-45 + enlarge) * (reach + far) + 4 * e * reach;
}

/// No point of the ball is farther from the origin.
inline double reach_of(const Ball& ball) {
  const geometry::Vec3& c = ball.centre;
  return (std::sqrt((c.x() * c.x() + c.y() * c.y()) + c.z() * c.z()) + ball.radius) * (1 + 0x1p-49);
}

}  // namespace algorithms
