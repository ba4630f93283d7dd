// Simbody's integrators by name. Includes Simbody: only simulate.cpp sees this header (CMakeLists.txt says why).
#pragma once
#include <Simbody.h>

#include <memory>

#include "pipeline/physics/simulate.hpp"

namespace pipeline {

/// Ready for initialize(). Throws std::invalid_argument for an unknown name, or for a fixed step where the integrator
/// chooses its own.
std::shared_ptr<SimTK::Integrator> make_integrator(const SimTK::System& system, const Physics& physics);

}  // namespace pipeline
