#include "pipeline/study/study.hpp"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <type_traits>

#include "pipeline/study/problem.hpp"
#include "pipeline/system/child.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

constexpr double kUnfixedAccuracy = 1e-3;       // of integrators with a fixed step: only quaternions' drift
constexpr std::int64_t kShort_ns = 20'000'000;  // an integration shorter than this is repeated: its time is uneven
constexpr int kMostRepeats = 5;
constexpr double kWallPerProcessor = 20;  // a busy machine gives a process no less than this share

/// Of this thread: under a limit of processor time the clock of the whole process moves by ticks of 4 ms (measured).
std::int64_t processor_ns() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

const char* status_of(Ended ended) {
  constexpr const char* kNames[] = {"finished", "exception", "not_finite", "energy", "evaluations", "time"};
  return kNames[static_cast<int>(ended)];
}

/// The angle between two unit quaternions, through the vector part of one relative to the other: all digits when small.
double angle_between(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  const double w = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const double x = a[0] * b[1] - a[1] * b[0] - a[2] * b[3] + a[3] * b[2];
  const double y = a[0] * b[2] - a[2] * b[0] - a[3] * b[1] + a[1] * b[3];
  const double z = a[0] * b[3] - a[3] * b[0] - a[1] * b[2] + a[2] * b[1];
  return 2 * std::atan2(std::sqrt(x * x + y * y + z * z), std::fabs(w));
}

/// What an integration of a setting gave, in SI units.
struct Run {
  Trace trace;
  std::vector<BodyState> states;
  std::int64_t time_ns = 0;
};

Run integrated(const Study& study, const StudyRow& row, const Setting& si) {
  const bool scaled = row.units == "scaled";
  const double length = scaled ? si.length : 1, mass = scaled ? si.mass : 1, time = scaled ? si.time : 1;
  Setting setting = si;
  setting.physics.bodies = study.bodies;
  setting.physics.integrator = row.integrator;
  setting.physics.accuracy = std::isnan(row.accuracy) ? kUnfixedAccuracy : row.accuracy;
  setting.physics.fixed_step = std::isnan(row.fixed_step) ? 0 : row.fixed_step;
  setting.physics.energy_bound = study.energy_bound;
  setting = in_units(std::move(setting), length, mass, time);
  setting.physics.time_budget = study.processor_time;

  Run run;
  Simulation simulation(setting.bodies, setting.physics, setting.states, 0);
  const std::int64_t start = processor_ns();
  run.trace = simulation.run_to_end(study.force_evaluations);
  run.time_ns = processor_ns() - start;
  run.trace.time *= time;
  run.trace.smallest_step *= time;
  run.trace.greatest_penetration *= length;
  run.states = simulation.states();
  for (BodyState& state : run.states)
    for (double& coordinate : state.position) coordinate *= length;
  return run;
}

/// The body whose centre is on the other side of a plate, or none.
bool went_through(const Setting& setting, const std::vector<BodyState>& states) {
  for (std::size_t b = 0; b < states.size(); ++b)
    if (!setting.bodies[b].fixed && states[b].position[1] < setting.floor) return true;
  return false;
}

/// Whether a plate stops the ball with steps of at most `step` s, from phases all over the first step: of 8 phases,
/// most integrators passed at 2 to 24 % of those between. False when the processor's time is past `deadline` ns.
bool stops(const Study& study, const StudyRow& row, const Setting& setting, double step, std::int64_t deadline) {
  constexpr int kPhases = 64;
  for (int phase = 0; phase < kPhases; ++phase) {
    if (processor_ns() > deadline) return false;
    Setting moved = setting;
    moved.physics.greatest_step = step;
    StudyRow with_step = row;
    if (row.fixed_step > 0) with_step.fixed_step = step;
    for (std::size_t b = 0; b < moved.bodies.size(); ++b)
      if (!moved.bodies[b].fixed) moved.states[b].position[1] -= row.speed * step * phase / kPhases;
    // Not from beyond the plate: a step that long cannot be judged, nor taken.
    if (moved.states.back().position[1] <= row.radius) return false;
    const Run run = integrated(study, with_step, moved);
    if (run.trace.ended != Ended::finished || went_through(moved, run.states)) return false;
  }
  return true;
}

/// By bisection to 2 %; NaN when even 2^-14 of the duration does not stop it, or the search takes as long as a case
/// may.
double preventing_step(const Study& study, const StudyRow& row, const Setting& setting) {
  const std::int64_t deadline = processor_ns() + static_cast<std::int64_t>(1e9 * study.processor_time);
  double passes = row.duration, holds = passes;
  do {
    passes = holds;
    holds /= 2;
    if (holds < std::ldexp(row.duration, -14)) return StudyRow::kNone;
  } while (!stops(study, row, setting, holds, deadline));
  while (passes > 1.02 * holds) {
    const double middle = std::sqrt(passes * holds);
    (stops(study, row, setting, middle, deadline) ? holds : passes) = middle;
  }
  return processor_ns() > deadline ? StudyRow::kNone : holds;
}

void compare(const Setting& setting, const std::vector<BodyState>& states, StudyRow& row) {
  if (!setting.reference) return;
  std::vector<BodyState> right;
  try {
    right = setting.reference();
  } catch (const std::exception& error) {
    row.reason = std::string("finished, but ") + error.what();
    return;
  }
  row.error = row.position_error = row.orientation_error = 0;
  for (std::size_t b = 0; b < states.size(); ++b) {
    if (setting.bodies[b].fixed) continue;
    double squared = 0;
    for (int i = 0; i < 3; ++i) squared += std::pow(states[b].position[i] - right[b].position[i], 2);
    const double position = std::sqrt(squared), angle = angle_between(states[b].orientation, right[b].orientation);
    // Not std::max: an unknown position leaves the error unknown.
    if (!(position <= row.position_error)) row.position_error = position;
    if (!(angle <= row.orientation_error)) row.orientation_error = angle;
  }
  row.error = row.position_error / setting.length;
  if (row.orientation_error > row.error) row.error = row.orientation_error;
}

std::string bytes_of(const StudyRow& row) {
  ChunkWriter out;
  each_study_column([&]<typename T, typename Stored>(const Column<StudyRow, T, Stored>& column) {
    if constexpr (std::same_as<T, std::string>)
      out.put(row.*column.member);
    else
      out.put(std::vector{static_cast<Stored>(row.*column.member)});
  });
  return out.bytes;
}

StudyRow row_of(const std::string& bytes) {
  ChunkReader in(bytes);
  StudyRow row;
  each_study_column([&]<typename T, typename Stored>(const Column<StudyRow, T, Stored>& column) {
    if constexpr (std::same_as<T, std::string>)
      row.*column.member = in.text();
    else
      row.*column.member = in.get<Stored>().at(0);
  });
  return row;
}

}  // namespace

StudyRow study_row(const Study& study, StudyRow row) {
  const Problem& problem = *std::ranges::find(problems(), row.problem, &Problem::name);
  const Setting setting = problem.make(row);
  if (row.fixed_step > 0 && row.duration / row.fixed_step > double(study.force_evaluations)) {
    row.status = status_of(Ended::evaluations);
    row.reason = "not begun: it would take " + real_text(std::ceil(row.duration / row.fixed_step)) + " steps";
    row.reached = 0;
    return row;
  }
  Run run;
  try {
    run = integrated(study, row, setting);
    row.time_ns = run.time_ns;
    for (int i = 1; i < kMostRepeats && run.time_ns < kShort_ns; ++i)
      row.time_ns = std::min(row.time_ns, integrated(study, row, setting).time_ns);
  } catch (const std::invalid_argument& refused) {
    row.status = "exception";
    row.reason = refused.what();
    return row;
  }
  const Trace& trace = run.trace;
  row.status = status_of(trace.ended);
  row.reason = trace.reason;
  if (!row.reason.empty() && row.units == "scaled") row.reason += ", in units of the problem";
  row.finished = trace.ended == Ended::finished;
  row.reached = trace.time;
  row.energy_error = trace.energy_error;
  row.momentum_drift = trace.momentum_drift;
  row.greatest_penetration = trace.greatest_penetration;
  row.smallest_step = trace.smallest_step;
  row.steps = static_cast<std::uint64_t>(trace.steps);
  row.rejected_steps = static_cast<std::uint64_t>(trace.rejected_steps);
  row.force_evaluations = static_cast<std::uint64_t>(trace.force_evaluations);
  if (row.finished && went_through(setting, run.states)) {
    row.finished = false;
    row.status = "tunnelled";
    row.reason = "the ball is on the other side of the plate";
  }
  if (row.finished) compare(setting, run.states, row);
  if (row.status == "tunnelled") row.preventing_step = preventing_step(study, row, setting);
  return row;
}

std::vector<StudyRow> study_rows(const Study& study, const std::vector<StudyRow>& cases, int processes,
                                 const Checkpoint& part, Progress& progress) {
  std::vector<StudyRow> rows = cases;
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto chunk = part.load(chunk_name("case", static_cast<std::int64_t>(i)));
    if (chunk)
      rows[i] = row_of(*chunk);
    else
      missing.push_back(i);
  }
  progress.add(cases.size() - missing.size(), false);
  // Scattered, so that those that are done are like those that are not: the time left is then known from a few.
  std::size_t stride = std::max<std::size_t>(1, std::size_t(0.618 * double(missing.size())));
  while (std::gcd(stride, missing.size()) > 1) ++stride;
  const std::vector<std::size_t> sorted = missing;
  for (std::size_t i = 0; i < missing.size(); ++i) missing[i] = sorted[i * stride % missing.size()];

  // The child stops itself, after the integration, a search for the preventing step and its last integration, and the
  // reference at the latest; from outside it is stopped only where it hangs.
  const ChildLimits limits{3 * study.processor_time + 15, kWallPerProcessor * (study.processor_time + 1)};
  in_children(
      missing.size(), processes, limits, [&](std::size_t i) { return bytes_of(study_row(study, cases[missing[i]])); },
      [&](std::size_t i, const std::string& bytes, const std::string& failure) {
        StudyRow& row = rows[missing[i]];
        if (failure.empty()) {
          row = row_of(bytes);
        } else {
          row.status = failure.starts_with("more than") ? "time" : "aborted";
          row.reason = failure;
        }
        part.save(chunk_name("case", static_cast<std::int64_t>(missing[i])), bytes_of(row));
        progress.add(1);
      });
  return rows;
}

}  // namespace pipeline
