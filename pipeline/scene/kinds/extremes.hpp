// The keys of kind = "extremes".
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/scene/scene.hpp"

namespace pipeline {

/// kind = "extremes": pairs around exact touching, at every scale and offset that go together.
struct ExtremesScene {
  std::vector<std::string> pairs;                                  // names; all there are
  std::vector<double> scales{1e-9, 1e-6, 1e-3, 1, 1e3, 1e6, 1e9};  // m, half the extent of a body, about
  std::vector<double> offsets{0, 1e3, 1e6, 1e9};                   // m, of each coordinate
  std::int64_t orientations = 1;                                   // random ones of each pair, scale and offset
};

SceneKind extremes_kind();

}  // namespace pipeline
