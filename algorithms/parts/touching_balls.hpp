// The tightest balls around bodies: what certainly keeps two of them apart, a row at a time.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/parts/enclosing_ball.hpp"
#include "geometry/bodies.hpp"

namespace algorithms {

/// Whether balls by coordinate touch: touching counts, and what overflows.
inline bool balls_touch(double dx, double dy, double dz, double reach) {
  return !(dx * dx + dy * dy + dz * dz > reach * reach);
}

/// One ball a body, which surely holds its world vertices.
class TouchingBalls {
 public:
  /// Around the vertices of each mesh.
  explicit TouchingBalls(const geometry::Bodies& bodies);
  /// Around balls that are given, one a distinct mesh.
  TouchingBalls(const geometry::Bodies& bodies, std::vector<Ball> balls);

  /// `enlarge` as Method::prepare has it.
  void prepare(std::span<const geometry::Pose> poses, double enlarge);

  /// How much radii in the frame of the body's mesh are larger at the step (world_balls.hpp), m.
  double slack(std::uint32_t body) const { return slack_[body]; }

  bool touch(std::uint32_t a, std::uint32_t b) const {
    return balls_touch(x_[a] - x_[b], y_[a] - y_[b], z_[a] - z_[b], r_[a] + r_[b]);
  }
  /// Of a with first ... last - 1: hit[b - first] is 0 or 1.
  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* hit) const;

  /// Whether a ball of radius r about p, metres of the world, touches the body's.
  bool touch(const geometry::Vec3& p, double r, std::uint32_t body) const {
    return balls_touch(p.x() - x_[body], p.y() - y_[body], p.z() - z_[body], r + r_[body]);
  }

 private:
  const geometry::Bodies& bodies_;
  std::vector<Ball> balls_;                    // one a distinct mesh
  std::vector<double> reach_;                  // likewise, m
  std::vector<double> x_, y_, z_, r_, slack_;  // of the step, one a body
};

/// Bytes of it, a body.
constexpr std::uint64_t touching_balls_bytes() { return 5 * sizeof(double); }

}  // namespace algorithms
