// The smallest ball around points: the same bits on every machine.
#pragma once
#include <limits>
#include <span>
#include <vector>

#include "geometry/mesh.hpp"

namespace algorithms {

using Ball = geometry::ContactBall;

/// A frame in which points are of size 1: p = (v - middle) / 2^exponent, each coordinate within [-1, 1]. So nothing
/// that is computed there overflows or underflows that matters.
struct UnitFrame {
  explicit UnitFrame(std::span<const geometry::Vec3> points);

  geometry::Vec3 to_unit(const geometry::Vec3& v) const;
  std::vector<geometry::Vec3> to_unit(std::span<const geometry::Vec3> points) const;
  /// Rounded: see `slack`.
  geometry::Vec3 from_unit(const geometry::Vec3& p) const;
  double from_unit(double length) const;
  /// The ball, `more` larger in the unit frame, with the rounding of both ways.
  Ball from_unit(const Ball& ball, double more = 0) const;

  /// What is within d of a point in the unit frame is in the mesh's frame within d 2^exponent + slack of it: the
  /// rounding of both ways. With M the greatest |coordinate| of points and u = 2^-53 a coordinate on the way there errs
  /// by at most 2 u M, on the way back by 2 u (M + 2^exponent); sqrt(3) (6 u) < 2^-49. Below the least normal double
  /// both ways err by half of the least one a coordinate.
  double slack() const {
    return 0x1p-49 * (greatest_ + from_unit(1.0)) + 8 * std::numeric_limits<double>::denorm_min();
  }

 private:
  geometry::Vec3 middle_ = geometry::Vec3::Zero();
  double greatest_ = 0;
  int exponent_ = 0;
};

/// The smallest ball around points of a unit frame, at least one, to about 2^-45: none of them is outside, rounding
/// included. By pivoting on the farthest point (B. Gärtner, "Fast and robust smallest enclosing balls", 1999).
Ball enclosing_ball(std::span<const geometry::Vec3> points);

/// The smallest ball around points of any frame: none of them is outside, rounding included.
Ball ball_around(std::span<const geometry::Vec3> points);

/// No point is farther from the centre than this, rounding included. Points of a unit frame.
double greatest_distance(const geometry::Vec3& centre, std::span<const geometry::Vec3> points);

}  // namespace algorithms
