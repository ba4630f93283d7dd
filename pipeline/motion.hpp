// The motion stage: where every body is at every step.
#pragma once
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/part.hpp"
#include "pipeline/progress.hpp"
#include "pipeline/result.hpp"
#include "pipeline/scene.hpp"

namespace pipeline {

struct Motion {
  std::vector<std::vector<geometry::Pose>> poses;  // S x B
  PhysicsRows physics;
};

/// Integrates the scene, chunk by chunk; chunks that `part` holds are taken from it. A failure of the integration is
/// data: from its step on moving bodies have NaN poses, and physics.status says why.
Motion integrate(const Config& config, const Scene& scene, const Part& part, Progress& progress);

}  // namespace pipeline
