#include "pipeline/scene/script.hpp"

#include <cmath>

namespace pipeline {

double length(const Pass& pass) {
  const geometry::Vec3 d = pass.to - pass.from;
  return std::sqrt((d.x() * d.x() + d.y() * d.y()) + d.z() * d.z());
}

double position(const Pass& pass, std::int64_t sample) {
  return length(pass) * (double(sample) / double(pass.samples - 1));
}

geometry::Pose pose_at(const Pass& pass, double metres) {
  const double part = metres / length(pass);
  const geometry::Vec3 d = pass.to - pass.from;
  return {pass.q, {pass.from.x() + part * d.x(), pass.from.y() + part * d.y(), pass.from.z() + part * d.z()}};
}

}  // namespace pipeline
