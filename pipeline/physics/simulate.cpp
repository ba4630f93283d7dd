// Motion by Simbody 3.7: C++17, and never NDEBUG (CMakeLists.txt says why).
#include "pipeline/physics/simulate.hpp"

#include <Simbody.h>
#include <limits.h>
#include <link.h>
#include <malloc.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <stdexcept>

#include "pipeline/physics/forces.hpp"
#include "pipeline/physics/free_bodies.hpp"
#include "pipeline/physics/integrator.hpp"
#include "pipeline/physics/tree.hpp"

namespace pipeline {
namespace {

using SimTK::Integrator;
using SimTK::State;
using SimTK::Vec3;

// An explicit method makes at most six evaluations per step, CPodes with Newton many more for its Jacobian.
constexpr std::int64_t kEvaluationsPerStep = 50;

bool positive(double x) { return std::isfinite(x) && x > 0; }
bool not_negative(double x) { return std::isfinite(x) && x >= 0; }

std::string text(double x) {
  char out[32];
  std::snprintf(out, sizeof out, "%.6g", x);
  return out;
}

void require(bool holds, const std::string& rule) {
  if (!holds) throw std::invalid_argument(rule);
}

/// Simbody spreads an exception's text over lines and begins with its own source file.
std::string one_line(const std::string& what) {
  std::string out;
  for (const char c : what) {
    const bool space = c == '\n' || c == '\r' || c == '\t' || c == ' ';
    if (!space) out += c;
    if (space && !out.empty() && out.back() != ' ') out += ' ';
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

/// Whether a symmetric matrix (xx, yy, zz, xy, xz, yz) is positive definite, by its leading minors.
bool positive_definite(const std::array<double, 6>& m) {
  const double minor = m[0] * m[1] - m[3] * m[3];
  const double determinant = m[2] * minor - m[0] * m[5] * m[5] - m[1] * m[4] * m[4] + 2 * m[3] * m[4] * m[5];
  return positive(m[0]) && positive(minor) && positive(determinant);
}

/// Whether masses can have these moments of inertia: tr(I) / 2 - I, their second moments, has no negative value. A flat
/// body has one of zero, which is rounded.
bool is_inertia(const std::array<double, 6>& m) {
  const double half = (m[0] + m[1] + m[2]) / 2 * (1 + 1e-9);
  return positive_definite(m) && positive_definite({half - m[0], half - m[1], half - m[2], -m[3], -m[4], -m[5]});
}

// ---------------------------------------------------------------------------------------------------------------------
// Rules: Simbody accepts some nonsense in silence and aborts the process at other

void check(const std::vector<RigidBody>& bodies, const Physics& physics, const std::vector<BodyState>& states,
           double time) {
  const Material& m = physics.material;
  require(positive(m.stiffness), "stiffness must be positive");
  require(not_negative(m.dissipation), "dissipation must be 0 or more");
  require(not_negative(m.dynamic_friction), "dynamic friction must be 0 or more");
  require(not_negative(m.viscous_friction), "viscous friction must be 0 or more");
  require(std::isfinite(m.static_friction) && m.static_friction >= m.dynamic_friction,
          "static friction must be at least the dynamic friction");
  require(positive(m.transition_velocity), "the transition velocity must be positive");
  require(positive(physics.accuracy) && physics.accuracy < 1, "the accuracy must be between 0 and 1");
  require(positive(physics.greatest_step), "the greatest step must be positive");
  require(not_negative(physics.fixed_step), "the fixed step must be 0 or more");
  const Balance& scale = physics.balance;
  require(positive(scale.energy) && positive(scale.momentum) && positive(scale.angular_momentum),
          "scales of energy and momentum must be positive");
  require(finite(vec3(scale.about)), "the point of the angular momentum must be finite");
  require(finite(vec3(physics.gravity)), "gravity must be finite");
  require(not_negative(physics.linear_damping), "the linear damping must be 0 or more");
  require(not_negative(physics.angular_damping), "the angular damping must be 0 or more");
  require(physics.step_budget > 0, "the step budget must be positive");
  require(physics.time_budget >= 0, "the time budget must be 0 or more");
  require(physics.energy_bound > 0, "the energy bound must be positive");
  require(std::isfinite(time), "the time must be finite");
  require(bodies.size() == states.size(), "there must be one state per body");
  bool any_moves = false;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const RigidBody& body = bodies[i];
    const std::string who = "body " + std::to_string(i) + ": ";
    any_moves = any_moves || !body.fixed;
    if (body.sphere)
      require(positive(body.radius), who + "the radius must be positive");
    else
      for (const double half : body.half_extents) require(positive(half), who + "half extents must be positive");
    require(body.fixed || positive(body.mass), who + "the mass must be positive");
    const bool has_matrix = body.inertia_matrix != std::array<double, 6>{};
    require(body.fixed || !body.sphere || has_matrix || positive(body.inertia), who + "the inertia must be positive");
    require(body.spheres.empty() || body.sphere, who + "a box has no contact spheres");
    require(body.fixed || body.spheres.empty() || has_matrix, who + "several contact spheres need an inertia matrix");
    for (const ContactSphere& sphere : body.spheres)
      require(positive(sphere.radius) && finite(vec3(sphere.centre)),
              who + "contact spheres must have a positive radius and a finite centre");
    require(finite(vec3(body.centre_of_mass)), who + "the centre of mass must be finite");
    require(
        body.fixed || !has_matrix || is_inertia(body.inertia_matrix),
        who +
            "the inertia matrix must be that of a body: positive definite, no principal moment above the sum of the "
            "others");
    require(!body.hung || body.centre_of_mass == std::array<double, 3>{}, who + "a hung body must be centred");
    const BodyState& s = states[i];
    require(finite(vec3(s.position)) && finite(vec3(s.velocity)) && finite(vec3(s.angular_velocity)),
            who + "position and velocity must be finite");
    double norm = 0;
    for (const double q : s.orientation) norm += q * q;
    require(std::isfinite(norm) && norm > 0.25 && norm < 4, who + "the orientation must be a unit quaternion");
    require(!body.hung || finite(vec3(body.pivot)), who + "the pivot must be finite");
  }
  require(any_moves, "no body moves");
}

/// An integrator makes and frees vectors of the length of the state all the time. From glibc's threshold on it would
/// fetch them from the kernel page by page and give them back each time: a third of all the time.
void keep_freed_memory(int state_bytes) {
  constexpr int kThreshold = 128 << 10, kMost = 32 << 20;  // bytes
  if (state_bytes < kThreshold) return;
  mallopt(M_MMAP_THRESHOLD, std::min(2 * state_bytes, kMost));
  mallopt(M_TRIM_THRESHOLD, std::min(64 * static_cast<std::int64_t>(state_bytes), std::int64_t{1} << 30));
}

std::unique_ptr<Mechanics> mechanics_of(const std::vector<RigidBody>& bodies, const Physics& physics,
                                        const std::vector<BodyState>& states, Watch& watch) {
  const bool joined = std::any_of(bodies.begin(), bodies.end(), [](const RigidBody& b) { return !b.fixed && b.hung; });
  return (joined || physics.bodies == BodyModel::tree ? multibody_tree : free_bodies)(bodies, physics, states, watch);
}

}  // namespace

// ---------------------------------------------------------------------------------------------------------------------

struct Simulation::Implementation {
  Physics physics;
  std::vector<BodyState> initial;
  Watch watch;
  std::unique_ptr<Mechanics> mechanics;
  bool isolated = true;  // nothing acts from outside: momentum stays
  std::shared_ptr<Integrator> integrator;
  double reference_energy = 0;
  std::int64_t spent_ns = 0;
  std::string failure;

  Implementation(const std::vector<RigidBody>& bodies, const Physics& physics_in, const std::vector<BodyState>& states,
                 double time, double reference)
      : physics(physics_in), initial(states) {
    check(bodies, physics, states, time);
    const Vec3 gravity = vec3(physics.gravity);
    isolated = gravity == Vec3(0) && physics.linear_damping == 0 && physics.angular_damping == 0;
    for (const RigidBody& body : bodies) isolated = isolated && !body.fixed && !body.hung;
    mechanics = mechanics_of(bodies, physics, states, watch);
    integrator = make_integrator(mechanics->system(), physics);
    integrator->initialize(mechanics->start(states, time));
    keep_freed_memory(integrator->getState().getNY() * static_cast<int>(sizeof(double)));

    reference_energy = reference;
    if (!(reference > 0)) {
      PhysicsSample now;
      const double elastic = forces().measure(now);
      double weight = 0;
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        const RigidBody& b = bodies[i];
        if (b.fixed) continue;
        const double size = b.sphere ? b.radius : vec3(b.half_extents).norm();
        weight += b.mass * (std::fabs(~gravity * vec3(states[i].position)) + gravity.norm() * size);
      }
      reference_energy = std::max(now.kinetic_energy + elastic + weight, std::numeric_limits<double>::min());
    }
  }

  /// The forces at the present time, with its kinematics.
  Forces& forces() const {
    mechanics->system().realize(integrator->getState(), SimTK::Stage::Velocity);
    return mechanics->at(integrator->getState());
  }

  bool state_is_finite() const {
    const SimTK::Vector& y = integrator->getState().getY();
    const double* first = y.getContiguousScalarData();
    return std::all_of(first, first + y.size(), [](double x) { return std::isfinite(x); });
  }

  std::string at() const { return " at t = " + text(integrator->getState().getTime()) + " s"; }

  /// Sets `failure` when something went wrong.
  void integrate(double time) {
    const int attempted_before = integrator->getNumStepsAttempted();
    const std::string steps = std::to_string(physics.step_budget);
    try {
      while (integrator->stepTo(time) != Integrator::ReachedReportTime) {
        if (integrator->isSimulationOver()) {
          failure = "the integrator ended" + at();
          return;
        }
        if (integrator->getNumStepsAttempted() - attempted_before > physics.step_budget) {
          failure = "more than " + steps + " steps in one sample" + at();
          return;
        }
      }
    } catch (const std::exception& error) {
      failure = one_line(error.what());
    } catch (...) {
      failure = "the integrator threw something unknown" + at();
    }
    if (!watch.reason.empty()) failure = watch.reason + at();
  }

  std::string advance_to(double time, PhysicsSample& sample) {
    sample = PhysicsSample();
    if (!failure.empty()) return failure;
    const double now = integrator->getState().getTime();
    // Simbody would abort the process.
    if (!std::isfinite(time) || time < now)
      return failure = "cannot go from t = " + text(now) + " s to " + text(time) + " s";

    const auto start = Clock::now();
    const double seconds_left = physics.time_budget - static_cast<double>(spent_ns) * 1e-9;
    watch = Watch();
    watch.evaluation_limit =
        std::min(physics.step_budget, watch.evaluation_limit / kEvaluationsPerStep) * kEvaluationsPerStep;
    watch.evaluation_reason =
        "more than " + std::to_string(watch.evaluation_limit) + " force evaluations in one sample";
    watch.deadline_reason = "more than " + text(physics.time_budget) + " s of wall time";
    if (seconds_left < 1e9)
      watch.deadline = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds_left));
    const int attempted = integrator->getNumStepsAttempted(), taken = integrator->getNumStepsTaken();
    if (seconds_left <= 0)
      failure = watch.deadline_reason + at();
    else
      integrate(time);
    sample.time_ns = nanoseconds(Clock::now() - start);
    sample.contact_time_ns = watch.contact_time_ns;
    sample.force_evaluations = watch.evaluations;
    sample.integrator_steps = integrator->getNumStepsTaken() - taken;
    sample.rejected_steps =
        std::max<std::int64_t>(0, integrator->getNumStepsAttempted() - attempted - sample.integrator_steps);
    spent_ns += sample.time_ns;
    watch.evaluation_limit = std::numeric_limits<std::int64_t>::max();
    watch.deadline = Clock::time_point::max();

    if (failure.empty() && !state_is_finite()) failure = "positions or velocities are not finite" + at();
    if (!failure.empty()) return failure;
    try {
      forces().measure(sample);
    } catch (const std::exception& error) {
      return failure = one_line(error.what());
    }
    if (!std::isfinite(sample.energy) || sample.energy > physics.energy_bound * reference_energy)
      failure = "energy grew to " + text(sample.energy) + " J, beyond " + text(physics.energy_bound) +
                " times the reference of " + text(reference_energy) + " J" + at();
    return failure;
  }

  /// Energy and momentum less what came from outside and plus what was lost, in units of their scales.
  struct Weighed {
    double energy;
    std::array<double, 6> momentum;
  };
  Weighed weigh() {
    PhysicsSample now;
    Forces& present = forces();
    present.measure(now);
    const std::array<double, kBesides> beside = mechanics->beside(integrator->getState());
    Weighed out{now.energy / physics.balance.energy + beside[0], present.momentum()};
    for (int i = 0; i < 6; ++i) out.momentum[i] -= beside[1 + i];
    return out;
  }

  Trace run_to_end(std::int64_t evaluations, int looks) {
    Trace trace;
    const double start = integrator->getState().getTime(), end = physics.final_time;
    const double between = (end - start) / looks;
    watch = Watch();
    watch.evaluation_limit = evaluations;
    watch.evaluation_reason = "more than " + std::to_string(evaluations) + " force evaluations";
    const std::clock_t begun = std::clock();
    std::int64_t rounds = 0;
    const bool momentum_known = physics.balance.tracked || isolated;
    trace.smallest_step = SimTK::NaN;
    const auto give_up = [&](Ended ended, const std::string& reason) {
      trace.ended = ended;
      trace.reason = reason;
    };
    try {
      const Weighed first = weigh();
      int taken = integrator->getNumStepsTaken();
      double next_look = start + between;
      while (trace.ended == Ended::finished && integrator->getState().getTime() < end) {
        integrator->stepTo(end);
        if (!watch.reason.empty()) break;
        if (++rounds % 64 == 0 && std::clock() - begun > physics.time_budget * CLOCKS_PER_SEC) {
          give_up(Ended::time, "more than " + text(physics.time_budget) + " s of processor time" + at());
          break;
        }
        const State& state = integrator->getState();
        const bool over = state.getTime() >= end;
        if (integrator->getNumStepsTaken() == taken && !over) {
          if (integrator->isSimulationOver()) give_up(Ended::exception, "the integrator ended" + at());
          continue;
        }
        taken = integrator->getNumStepsTaken();
        if (!state_is_finite()) {
          give_up(Ended::not_finite, "positions or velocities are not finite" + at());
          break;
        }
        // The next step begins with it, so it costs nothing.
        mechanics->system().realize(state, SimTK::Stage::Acceleration);
        if (!watch.reason.empty()) break;
        trace.greatest_penetration = std::max(trace.greatest_penetration, mechanics->loads(state).depth);
        if (!over) trace.smallest_step = std::fmin(trace.smallest_step, integrator->getPreviousStepSizeTaken());
        if (state.getTime() < next_look && !over) continue;
        next_look = state.getTime() + between;
        const Weighed now = weigh();
        const double error = now.energy - first.energy;
        if (!(std::fabs(error) <= std::fabs(trace.energy_error))) trace.energy_error = error;
        for (int i = 0; i < 6; ++i)
          trace.momentum_drift = std::max(trace.momentum_drift, std::fabs(now.momentum[i] - first.momentum[i]));
        if (!(error <= physics.energy_bound))
          give_up(Ended::energy, "energy grew by " + text(error) + " times its scale" + at());
      }
    } catch (const std::exception& error) {
      give_up(Ended::exception, one_line(error.what()));
    } catch (...) {
      give_up(Ended::exception, "the integrator threw something unknown" + at());
    }
    if (!watch.reason.empty())
      give_up(watch.reason == watch.evaluation_reason ? Ended::evaluations : Ended::exception, watch.reason + at());
    if (!momentum_known) trace.momentum_drift = SimTK::NaN;
    trace.time = integrator->getState().getTime();
    trace.force_evaluations = std::min(watch.evaluations, evaluations);
    trace.steps = integrator->getNumStepsTaken();
    trace.rejected_steps = std::max<std::int64_t>(0, integrator->getNumStepsAttempted() - trace.steps);
    watch = Watch();
    return trace;
  }

  std::vector<BodyState> states() const {
    std::vector<BodyState> out = initial;
    mechanics->write(integrator->getState(), out);
    return out;
  }
};

Simulation::Simulation(const std::vector<RigidBody>& bodies, const Physics& physics,
                       const std::vector<BodyState>& states, double time, double reference_energy) try
    : implementation_(std::make_unique<Implementation>(bodies, physics, states, time, reference_energy)) {
} catch (const SimTK::Exception::Base& error) {
  // What `check` lets through, such as masses at the limits of double.
  throw std::invalid_argument(one_line(error.what()));
}

Simulation::~Simulation() = default;

PhysicsSample Simulation::sample() {
  PhysicsSample out;
  implementation_->forces().measure(out);
  return out;
}

std::string Simulation::advance_to(double time, PhysicsSample& sample) {
  return implementation_->advance_to(time, sample);
}

Trace Simulation::run_to_end(std::int64_t evaluations, int looks) {
  return implementation_->run_to_end(evaluations, looks);
}

std::vector<BodyState> Simulation::states() const { return implementation_->states(); }

double Simulation::reference_energy() const { return implementation_->reference_energy; }

std::vector<std::pair<std::string, std::string>> simulation_libraries() {
  std::vector<std::pair<std::string, std::string>> out;
  int major = 0, minor = 0, build = 0;
  SimTK_version_simbody(&major, &minor, &build);
  out.emplace_back("simbody", std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(build));
  const auto visit = [](dl_phdr_info* info, std::size_t, void* data) {
    auto& list = *static_cast<std::vector<std::pair<std::string, std::string>>*>(data);
    const std::string loaded = info->dlpi_name ? info->dlpi_name : "";
    const std::string file = loaded.substr(loaded.rfind('/') + 1);
    for (const std::string library : {"blas", "lapack"}) {
      if (file.rfind("lib" + library + ".so", 0) != 0) continue;
      // Debian's alternatives are symbolic links; the target's folder tells Netlib from OpenBLAS.
      char resolved[PATH_MAX];
      const std::string path = realpath(loaded.c_str(), resolved) ? resolved : loaded;
      const std::size_t slash = path.rfind('/');
      const std::size_t parent =
          slash == std::string::npos || slash == 0 ? std::string::npos : path.rfind('/', slash - 1);
      list.emplace_back(library, parent == std::string::npos ? path : path.substr(parent + 1));
    }
    return 0;
  };
  dl_iterate_phdr(visit, &out);
  return out;
}

}  // namespace pipeline
