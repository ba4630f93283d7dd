// The test problems of the integrators: bodies and states from a few parameters, what is conserved, and what the end
// should be.
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/physics/simulate.hpp"
#include "pipeline/result/products/study.hpp"
#include "pipeline/scene/document.hpp"

namespace pipeline {

/// A problem with its parameters filled in.
struct Setting {
  std::vector<RigidBody> bodies;
  std::vector<BodyState> states;                            // one per body
  Physics physics;                                          // all but integrator, accuracy, fixed step and budgets
  double length = 1;                                        // m; what an error of position is divided by
  double mass = 1, time = 1;                                // kg, s; with `length` the units of a scaled integration
  double floor = -std::numeric_limits<double>::infinity();  // m; a ball whose centre is lower went through a plate
  std::function<std::vector<BodyState>()> reference;        // states of all bodies at the end; empty: not known
};

/// One problem, as data.
struct Problem {
  std::string name, what;
  std::vector<std::pair<std::string, double>> presets;  // its parameters by their column of /study; NaN: see complete
  Setting (*make)(const StudyRow& row);
};

const std::vector<Problem>& problems();

/// Fills in the parameters that follow from others: a ball's mass and inertia when not given are those of a solid one
/// of 1000 kg/m^3.
void complete(StudyRow& row);

/// What values of a problem's parameter are allowed. `whole`: only integers.
struct ParameterRule {
  Range range;
  bool whole = false;
};
ParameterRule parameter_rule(const std::string& problem, const std::string& name);

/// The same problem in other units: lengths in `length` m, masses in `mass` kg, times in `time` s.
Setting in_units(Setting setting, double length, double mass, double time);

}  // namespace pipeline
