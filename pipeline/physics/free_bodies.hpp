// Rigid bodies that nothing joins, without a multibody tree: each has its own equations of Newton and Euler, so that
// one evaluation costs little more than finding the contacts. The proofs that it moves as the tree does are in
// tests/pipeline/free_bodies_test.cpp.
#pragma once
#include <memory>

#include "pipeline/physics/mechanics.hpp"

namespace pipeline {

/// `watch` is to outlive it. No body may be hung.
std::unique_ptr<Mechanics> free_bodies(const std::vector<RigidBody>& bodies, const Physics& physics,
                                       const std::vector<BodyState>& states, Watch& watch);

}  // namespace pipeline
