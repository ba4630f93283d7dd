// Bodies as Simbody's multibody tree: what joints need, and the yardstick for bodies without any.
#pragma once
#include <memory>

#include "pipeline/physics/mechanics.hpp"

namespace pipeline {

/// `watch` is to outlive it.
std::unique_ptr<Mechanics> multibody_tree(const std::vector<RigidBody>& bodies, const Physics& physics,
                                          const std::vector<BodyState>& states, Watch& watch);

}  // namespace pipeline
