#include "algorithms/parts/touching_balls.hpp"

#include <utility>

#include "algorithms/parts/world_balls.hpp"
#include "geometry/processor_clones.hpp"

namespace algorithms {
namespace {

PROCESSOR_CLONES void touch_columns(const double* x, const double* y, const double* z, const double* r, std::uint32_t a,
                                    std::uint32_t first, std::uint32_t last, std::uint8_t* hit) {
  const double ax = x[a], ay = y[a], az = z[a], ar = r[a];
  for (std::uint32_t b = first; b < last; ++b) {
    const double dx = ax - x[b], dy = ay - y[b], dz = az - z[b], reach = ar + r[b];
    hit[b - first] = !(dx * dx + dy * dy + dz * dz > reach * reach);
  }
}

std::vector<Ball> balls_of(const geometry::Bodies& bodies) {
  std::vector<Ball> out;
  for (const geometry::Mesh& mesh : bodies.meshes) out.push_back(ball_around(mesh.vertices));
  return out;
}

}  // namespace

TouchingBalls::TouchingBalls(const geometry::Bodies& bodies) : TouchingBalls(bodies, balls_of(bodies)) {}

TouchingBalls::TouchingBalls(const geometry::Bodies& bodies, std::vector<Ball> balls)
    : bodies_(bodies), balls_(std::move(balls)) {
  for (const Ball& ball : balls_) reach_.push_back(reach_of(ball));
  for (auto* column : {&x_, &y_, &z_, &r_, &slack_}) column->resize(bodies.size());
}

void TouchingBalls::prepare(std::span<const geometry::Pose> poses, double enlarge) {
  for (std::uint32_t body = 0; body < poses.size(); ++body) {
    const geometry::Pose& pose = poses[body];
    if (!geometry::is_born(pose)) continue;
    const std::uint32_t mesh = bodies_.mesh[body];
    const geometry::Vec3 at = geometry::to_world(geometry::rotation(pose.q), pose.t, balls_[mesh].centre);
    slack_[body] = world_slack(reach_[mesh], pose, enlarge);
    x_[body] = at.x(), y_[body] = at.y(), z_[body] = at.z();
    r_[body] = balls_[mesh].radius + slack_[body];
  }
}

void TouchingBalls::row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* hit) const {
  touch_columns(x_.data(), y_.data(), z_.data(), r_.data(), a, first, last, hit);
}

}  // namespace algorithms
