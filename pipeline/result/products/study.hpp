// /study: cases of a study of the integrators, instead of a scene. pipeline/study/study.hpp makes them.
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/result/columns.hpp"

namespace pipeline {

/// One case of a study of the integrators: a row of /study. A parameter that its problem does not have is NaN.
struct StudyRow {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  // What is integrated, and how.
  std::string sweep, problem, integrator;
  std::string units = "SI";                        // or "scaled": in units of the problem's own length, mass and time
  double accuracy = kNone;                         // NaN with a fixed step
  double fixed_step = kNone;                       // s; NaN when the accuracy chooses the steps
  double nominal_order = kNone;                    // NaN: it varies
  double duration = kNone, greatest_step = kNone;  // s
  double radius = kNone, thickness = kNone, offset = kNone;  // m
  double mass = kNone, inertia = kNone;                      // kg, kg m^2
  double balls = kNone, mass_ratio = kNone;                  // 1
  double speed = kNone, transition_velocity = kNone;         // m/s
  double stiffness = kNone;                                  // Pa
  double dissipation = kNone;                                // s/m

  // What came of it. `status` is one of configs/README.md's, `reason` says in words why it did not finish, or
  // why its error is not known.
  std::string status = "not run", reason;
  double reached = kNone;                                                   // s
  double error = kNone, position_error = kNone, orientation_error = kNone;  // 1, m, rad
  double energy_error = kNone, momentum_drift = kNone;                      // 1
  double greatest_penetration = kNone, smallest_step = kNone;               // m, s
  double preventing_step = kNone;                                           // s
  std::uint64_t steps = 0, rejected_steps = 0, force_evaluations = 0;
  bool finished = false;
  std::int64_t time_ns = 0;  // of processor
};

using StudyRows = std::vector<StudyRow>;

inline constexpr Column<StudyRow, std::string> kStudyTexts[] = {
    {"sweep", &StudyRow::sweep, "1", "name of the [[sweep]] of the configuration"},
    {"problem", &StudyRow::problem, "1", "what is integrated (pipeline list problems)"},
    {"integrator", &StudyRow::integrator, "1", "name of the integrator"},
    {"units", &StudyRow::units, "1", "SI, or scaled: integrated in units of the problem's own length, mass and time"},
    {"status", &StudyRow::status, "1",
     "finished, exception, not_finite, energy, evaluations, time, tunnelled or aborted"},
    {"reason", &StudyRow::reason, "1", "why it did not finish, or why its error is not known"}};
/// What a case is made of; NaN where its problem has no such parameter.
inline constexpr Column<StudyRow, double> kStudyParameters[] = {
    {"accuracy", &StudyRow::accuracy, "1", "accuracy asked of the integrator; NaN: the step is fixed"},
    {"fixed_step", &StudyRow::fixed_step, "s", "length of every step; NaN: chosen by the accuracy"},
    {"nominal_order", &StudyRow::nominal_order, "1", "order of the integrator by its documentation; NaN: it varies"},
    {"duration", &StudyRow::duration, "s", "simulated time"},
    {"greatest_step", &StudyRow::greatest_step, "s", "steps are at most of this length, unless fixed"},
    {"radius", &StudyRow::radius, "m", "radius of the ball"},
    {"thickness", &StudyRow::thickness, "m", "thickness of the plate"},
    {"offset", &StudyRow::offset, "m", "everything is moved that far along x, y and z"},
    {"mass", &StudyRow::mass, "kg", "mass of the ball"},
    {"inertia", &StudyRow::inertia, "kg m^2", "moment of inertia of the ball"},
    {"balls", &StudyRow::balls, "1", "balls in the stack"},
    {"mass_ratio", &StudyRow::mass_ratio, "1", "mass of the topmost ball over that of each other"},
    {"speed", &StudyRow::speed, "m/s", "speed of approach or of the throw"},
    {"transition_velocity", &StudyRow::transition_velocity, "m/s", "slip at which friction is greatest"},
    {"stiffness", &StudyRow::stiffness, "Pa", "plane-strain modulus of the surfaces"},
    {"dissipation", &StudyRow::dissipation, "s/m", "Hunt and Crossley's"}};
inline constexpr Column<StudyRow, double> kStudyReals[] = {
    {"reached", &StudyRow::reached, "s", "simulated time reached"},
    {"error", &StudyRow::error, "1",
     "greatest over the bodies at the end: position error over the problem's length, or orientation error in rad; NaN: "
     "no reference"},
    {"position_error", &StudyRow::position_error, "m", "greatest error of a position at the end"},
    {"orientation_error", &StudyRow::orientation_error, "rad", "greatest error of an orientation at the end"},
    {"energy_error", &StudyRow::energy_error, "1",
     "energy gained (positive) or lost against its balance, over the problem's energy: the worst of 256 looks"},
    {"momentum_drift", &StudyRow::momentum_drift, "1",
     "worst deviation of linear or angular momentum from its balance, over the problem's; NaN: no balance is known"},
    {"greatest_penetration", &StudyRow::greatest_penetration, "m", "greatest depth of a contact after a step"},
    {"smallest_step", &StudyRow::smallest_step, "s", "shortest step but the last"},
    {"preventing_step", &StudyRow::preventing_step, "s",
     "where the ball tunnelled: the greatest step (to 2 %) that stops it from each of 64 phases; NaN: none was found"}};
inline constexpr Column<StudyRow, std::uint64_t> kStudyCounts[] = {
    {"steps", &StudyRow::steps, "1", "internal steps"},
    {"rejected_steps", &StudyRow::rejected_steps, "1", "internal steps tried and rejected"},
    {"force_evaluations", &StudyRow::force_evaluations, "1", "evaluations of forces"}};
inline constexpr Column<StudyRow, bool, std::uint8_t> kStudyFinished{"finished", &StudyRow::finished, "1",
                                                                     "1 when the end was reached"};
inline constexpr Column<StudyRow, std::int64_t> kStudyTime{
    "time_ns", &StudyRow::time_ns, "ns", "processor time of the integration; the fastest of up to five"};

/// Tells `each` every column of /study, in the file's order.
template <typename Each>
void each_study_column(const Each& each) {
  for (const auto& column : kStudyTexts) each(column);
  for (const auto& column : kStudyParameters) each(column);
  for (const auto& column : kStudyReals) each(column);
  for (const auto& column : kStudyCounts) each(column);
  each(kStudyFinished);
  each(kStudyTime);
}

}  // namespace pipeline
