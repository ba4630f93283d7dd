// The keys of kind = "box".
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/scene/scene.hpp"

namespace pipeline {

/// kind = "box": spheres are born one by one in a closed cube and pushed again and again.
struct BoxScene {
  std::int64_t segments = 16;  // of the sphere's mesh
  double radius = 0.5;         // m
  double density = 1000;       // kg/m^3
  double half_width = 5;       // of the room inside, m
  double thickness = 1;        // of the six plates around it, m
  struct {
    std::int64_t count = 80, from = 0, every = 5;  // steps; every 0: all at once
  } births;
  struct {
    std::int64_t from = 50, every = 50;                           // steps
    double speed = 5;                                             // m/s, added to the velocity; 0: no pushes
    std::vector<std::string> directions{"+x", "-x", "+z", "-z"};  // of each sphere's own frame, in turn
  } push;
};

SceneKind box_kind();

}  // namespace pipeline
