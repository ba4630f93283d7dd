// The motion stage: where every body is at every step.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/products/physics.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {

struct Motion {
  std::vector<std::vector<geometry::Pose>> poses;  // S x B
  PhysicsRows physics;
};

/// Integrates the scene, chunk by chunk; chunks that `part` holds are taken from it. The scene's events happen at
/// samples: a sample, its row and what follows are those after them. A failure of the integration, or a breach of the
/// scene's rule, is data: from its step on moving bodies have NaN poses, and physics.status says why. Throws what
/// SceneKind::events throws. `after_chunk`, where given, is shown the poses so far after every chunk.
using AfterChunk = std::function<void(const std::vector<std::vector<geometry::Pose>>& poses)>;
Motion integrate(const SceneConfig& config, const Scene& scene, const Checkpoint& part, Progress& progress,
                 const AfterChunk& after_chunk = {});

/// Whether integrate made the steps of the chunk from step `first` on, as far as is known without reading them; and
/// their poses, of a scene that is not integrated its script's. Nothing when they are not there, or damaged.
bool has_poses(const SceneConfig& config, const Checkpoint& part, std::int64_t first);
std::optional<std::vector<std::vector<geometry::Pose>>> kept_poses(const SceneConfig& config, const Scene& scene,
                                                                   const Checkpoint& part, std::int64_t first);

/// What a motion from some states costs at first, found by integrating for about `seconds`.
struct MotionTrial {
  double begin = 0, step = 0;         // s, of beginning (as after every event and chunk) and of a step
  double inner = 0;                   // s, of a step of the integrator
  std::vector<geometry::Pose> poses;  // B, at the end
};
MotionTrial try_motion(const SceneConfig& config, const Scene& scene, std::vector<BodyState> states, double seconds);

}  // namespace pipeline
