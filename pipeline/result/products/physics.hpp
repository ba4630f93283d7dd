// /physics: what the integrator tells of every step; only of integrated scenes.
#pragma once
#include <limits>
#include <string>
#include <vector>

#include "pipeline/physics/simulate.hpp"

namespace pipeline {

struct PhysicsRows {
  std::vector<PhysicsSample> rows;  // S
  std::string status;               // "complete", or "failed at step K: why"
  // Greatest | |q| - 1 | of the integrator's quaternions at samples, before they become poses; NaN: not known.
  double quaternion_drift = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace pipeline
