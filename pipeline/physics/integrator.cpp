// Simbody's integrators by name. C++17, never NDEBUG (CMakeLists.txt says why). Orders: Simbody's own documentation
// (simmath/*Integrator.h); Verlet's there is that of its positions alone, here that of velocity Verlet.
#include "pipeline/physics/integrator.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace pipeline {
namespace {

using SimTK::Integrator;

// Integrator's destructor is not virtual: a shared_ptr remembers the right one.
template <class T>
std::shared_ptr<Integrator> create(const SimTK::System& system, double) {
  return std::make_shared<T>(system);
}

template <>
std::shared_ptr<Integrator> create<SimTK::SemiExplicitEulerIntegrator>(const SimTK::System& system, double step) {
  return std::make_shared<SimTK::SemiExplicitEulerIntegrator>(system, step);
}

/// BDF solves its steps with Newton and a dense Jacobian by differences, Adams by functional iteration.
template <SimTK::CPodes::LinearMultistepMethod method, SimTK::CPodes::NonlinearSystemIterationType iteration>
std::shared_ptr<Integrator> create_cpodes(const SimTK::System& system, double) {
  return std::make_shared<SimTK::CPodesIntegrator>(system, method, iteration);
}

struct Row {
  IntegratorFacts facts;
  std::shared_ptr<Integrator> (*create)(const SimTK::System&, double fixed_step);
};

const Row kRows[] = {
    {{"RungeKuttaMerson", "explicit, five stages", 4, true, true}, create<SimTK::RungeKuttaMersonIntegrator>},
    {{"RungeKutta3", "explicit, three stages", 3, true, true}, create<SimTK::RungeKutta3Integrator>},
    {{"RungeKutta2", "explicit, two stages", 2, true, true}, create<SimTK::RungeKutta2Integrator>},
    {{"RungeKuttaFeldberg", "explicit, six stages", 5, true, true}, create<SimTK::RungeKuttaFeldbergIntegrator>},
    {{"Verlet", "velocity Verlet, for forces that depend on positions", 2, true, true},
     create<SimTK::VerletIntegrator>},
    {{"SemiExplicitEuler", "symplectic Euler, its accuracy is its step in s", 1, false, true},
     create<SimTK::SemiExplicitEulerIntegrator>},
    {{"SemiExplicitEuler2", "symplectic Euler with the error from step doubling", 1, true, true},
     create<SimTK::SemiExplicitEuler2Integrator>},
    {{"ExplicitEuler", "explicit, one stage", 1, true, true}, create<SimTK::ExplicitEulerIntegrator>},
    {{"CPodesBDF", "implicit multistep of varying order 1 to 5, Newton with a dense Jacobian", 0, true, false},
     create_cpodes<SimTK::CPodes::BDF, SimTK::CPodes::Newton>},
    {{"CPodesAdams", "multistep of varying order 1 to 12, functional iteration", 0, true, false},
     create_cpodes<SimTK::CPodes::Adams, SimTK::CPodes::Functional>},
};

}  // namespace

std::shared_ptr<Integrator> make_integrator(const SimTK::System& system, const Physics& physics) {
  for (const Row& row : kRows) {
    if (physics.integrator != row.facts.name) continue;
    const bool fixed = physics.fixed_step > 0;
    if (fixed && !row.facts.fixed_step) throw std::invalid_argument(physics.integrator + " takes no fixed step");
    const double step = fixed ? physics.fixed_step : std::min(physics.accuracy, physics.greatest_step);
    auto integrator = row.create(system, step);
    if (fixed)
      integrator->setFixedStepSize(step);
    else if (row.facts.error_control)
      integrator->setMaximumStepSize(physics.greatest_step);
    // CPodes would take its first step from the time first asked for: looking must not change the motion.
    if (!row.facts.fixed_step) integrator->setInitialStepSize(physics.greatest_step * physics.accuracy);
    if (std::isfinite(physics.final_time)) integrator->setFinalTime(physics.final_time);
    integrator->setAccuracy(physics.accuracy);
    // The mean over all bodies, Simbody's default, would dilute the error of one that bounces among many at rest.
    integrator->setUseInfinityNorm(true);
    integrator->setReturnEveryInternalStep(true);
    return integrator;
  }
  throw std::invalid_argument("unknown integrator '" + physics.integrator + "'");
}

const std::vector<IntegratorFacts>& integrators() {
  static const std::vector<IntegratorFacts> all = [] {
    std::vector<IntegratorFacts> out;
    for (const Row& row : kRows) out.push_back(row.facts);
    return out;
  }();
  return all;
}

const std::vector<std::string>& integrator_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Row& row : kRows) out.emplace_back(row.facts.name);
    return out;
  }();
  return names;
}

}  // namespace pipeline
