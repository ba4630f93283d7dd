// The bodies of a Simulation as a system that Simbody's integrators advance. There are two: bodies that nothing joins
// (free_bodies.hpp), and Simbody's multibody tree (tree.hpp). Includes Simbody: only the target that integrates sees it
// (CMakeLists.txt says why).
#pragma once
#include <SimTKcommon.h>

#include <array>
#include <vector>

#include "pipeline/physics/forces.hpp"

namespace pipeline {

class Mechanics {
 public:
  virtual ~Mechanics() = default;
  Mechanics() = default;
  Mechanics(const Mechanics&) = delete;
  Mechanics& operator=(const Mechanics&) = delete;

  virtual const SimTK::System& system() const = 0;

  /// Of Model stage, with the bodies at `states` (one each).
  virtual SimTK::State start(const std::vector<BodyState>& states, double time) const = 0;

  /// The states of the bodies that move; those of the others are left as they are.
  virtual void write(const SimTK::State& state, std::vector<BodyState>& states) const = 0;

  /// The forces, with the kinematics of a state of Velocity stage.
  virtual Forces& at(const SimTK::State& state) const = 0;

  /// Of a state of Acceleration stage.
  virtual const Loads& loads(const SimTK::State& state) const = 0;

  /// What was integrated beside the motion since the start, in units of the scales; zero when it is not tracked.
  virtual std::array<double, kBesides> beside(const SimTK::State& state) const = 0;
};

}  // namespace pipeline
