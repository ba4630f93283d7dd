// The table of scene_kinds().
#include "pipeline/scene/kinds/box.hpp"
#include "pipeline/scene/kinds/extremes.hpp"
#include "pipeline/scene/kinds/falling.hpp"
#include "pipeline/scene/kinds/playground.hpp"
#include "pipeline/scene/kinds/replay.hpp"

namespace pipeline {

const std::vector<SceneKind>& scene_kinds() {
  static const std::vector<SceneKind> kinds = {
      falling_kind(), box_kind(), playground_kind(), replay_kind(), extremes_kind(),
  };
  return kinds;
}

}  // namespace pipeline
