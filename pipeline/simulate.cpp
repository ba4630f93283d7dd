// Motion by Simbody 3.7. The only file that includes it: C++17, and never NDEBUG (CMakeLists.txt says why).
//
// Contact (contact.hpp) is a force of our own: Simbody has no contact of sphere with box, and its broad phase is
// slower.
#include "pipeline/simulate.hpp"

#include <Simbody.h>
#include <limits.h>
#include <link.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "pipeline/contact.hpp"

namespace pipeline {
namespace {

using contact::Box;
using contact::Contact;
using contact::Grid;
using contact::Kinematics;
using contact::Law;
using contact::Sphere;
using SimTK::Integrator;
using SimTK::Rotation;
using SimTK::SpatialVec;
using SimTK::State;
using SimTK::Vec3;
using Clock = std::chrono::steady_clock;

// Free fall would let an integrator take steps in which a body crosses a plate unseen. 0.01 s is also Simbody's first
// step.
constexpr double kGreatestStep = 0.01;

// An explicit method makes at most six evaluations per step, CPodes with Newton many more for its Jacobian.
constexpr std::int64_t kEvaluationsPerStep = 50;

Vec3 vec3(const std::array<double, 3>& v) { return Vec3(v[0], v[1], v[2]); }
bool finite(const Vec3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }
bool positive(double x) { return std::isfinite(x) && x > 0; }
bool not_negative(double x) { return std::isfinite(x) && x >= 0; }

std::int64_t nanoseconds(Clock::duration duration) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

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

// ---------------------------------------------------------------------------------------------------------------------
// The force on the bodies

/// What the force counts and when it gives up. Simbody takes an exception from a force for a step that failed and tries
/// a shorter one, so the force goes on throwing until the integrator gives up; the reason is kept here.
struct Watch {
  std::int64_t evaluations = 0;
  std::int64_t evaluation_limit = std::numeric_limits<std::int64_t>::max();
  std::int64_t contact_time_ns = 0;
  Clock::time_point deadline = Clock::time_point::max();
  std::string evaluation_reason, deadline_reason;
  std::string reason;
};

class ContactForce : public SimTK::Force::Custom::Implementation {
 public:
  struct Moving {
    int body;
    SimTK::MobilizedBodyIndex index;
    double mass;
    Vec3 inertia;  // principal, in the body's frame
  };

  ContactForce(const SimTK::SimbodyMatterSubsystem& matter, const std::vector<RigidBody>& bodies,
               const Physics& physics, const std::vector<BodyState>& states, const std::vector<Moving>& moving,
               Watch& watch)
      : matter_(matter),
        moving_(moving),
        law_(physics.material),
        linear_damping_(physics.linear_damping),
        angular_damping_(physics.angular_damping),
        watch_(watch),
        index_(bodies.size(), SimTK::GroundIndex),
        kinematics_(bodies.size()) {
    for (const Moving& body : moving) index_[body.body] = body.index;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto& q = states[i].orientation;
      kinematics_[i].position = vec3(states[i].position);
      kinematics_[i].orientation = Rotation(SimTK::Quaternion(q[0], q[1], q[2], q[3]));
      if (bodies[i].sphere)
        spheres_.push_back({static_cast<int>(i), bodies[i].fixed, bodies[i].radius});
      else
        boxes_.push_back({static_cast<int>(i), bodies[i].fixed, vec3(bodies[i].half_extents)});
    }
  }

  void calcForce(const State& state, SimTK::Vector_<SpatialVec>& forces, SimTK::Vector_<Vec3>&,
                 SimTK::Vector&) const override {
    const auto start = Clock::now();
    if (watch_.reason.empty()) {
      if (++watch_.evaluations > watch_.evaluation_limit) watch_.reason = watch_.evaluation_reason;
      if (start > watch_.deadline) watch_.reason = watch_.deadline_reason;
    }
    if (!watch_.reason.empty()) throw std::runtime_error(watch_.reason);

    read(state);
    find_contacts();
    for (const Contact& c : contacts_) {
      const Kinematics& a = kinematics_[c.a];
      const Kinematics& b = kinematics_[c.b];
      const Vec3 arm_a = c.point - a.position, arm_b = c.point - b.position;
      const Vec3 velocity = (b.velocity + b.angular_velocity % arm_b) - (a.velocity + a.angular_velocity % arm_a);
      const Vec3 force = law_.force(c, velocity);
      // Ground takes its part too, without effect.
      forces[index_[c.a]] -= SpatialVec(arm_a % force, force);
      forces[index_[c.b]] += SpatialVec(arm_b % force, force);
    }
    if (linear_damping_ != 0 || angular_damping_ != 0) {
      for (const Moving& body : moving_) {
        const Kinematics& k = kinematics_[body.body];
        const Rotation& r = k.orientation;
        const Vec3 momentum = isotropic(body) ? body.inertia[0] * k.angular_velocity
                                              : r * (~r * k.angular_velocity).elementwiseMultiply(body.inertia);
        forces[body.index] -= SpatialVec(angular_damping_ * momentum, linear_damping_ * body.mass * k.velocity);
      }
    }
    watch_.contact_time_ns += nanoseconds(Clock::now() - start);
  }

  /// Only the contacts' part: who asks wants the sample's energy and takes it from `measure`.
  SimTK::Real calcPotentialEnergy(const State& state) const override {
    PhysicsSample sample;
    return measure(state, sample);
  }

  /// Elastic energy J of the contacts at a state of Velocity stage; fills in the sample's contacts and penetration.
  double measure(const State& state, PhysicsSample& sample) const {
    read(state);
    find_contacts();
    double energy = 0;
    for (const Contact& c : contacts_) {
      energy += law_.elastic_energy(c);
      sample.greatest_penetration = std::max(sample.greatest_penetration, c.depth);
    }
    sample.contacts = static_cast<std::int64_t>(contacts_.size());
    return energy;
  }

 private:
  static bool isotropic(const Moving& body) {
    return body.inertia[0] == body.inertia[1] && body.inertia[1] == body.inertia[2];
  }

  void read(const State& state) const {
    for (const Moving& body : moving_) {
      const SimTK::MobilizedBody& mobod = matter_.getMobilizedBody(body.index);
      Kinematics& k = kinematics_[body.body];
      const SimTK::Transform& pose = mobod.getBodyTransform(state);
      const SpatialVec& velocity = mobod.getBodyVelocity(state);
      k.position = pose.p();
      k.orientation = pose.R();
      k.angular_velocity = velocity[0];
      k.velocity = velocity[1];
      if (!finite(k.position)) throw std::runtime_error("a position is not finite");
    }
  }

  /// In a defined order, since sums of doubles depend on it: spheres by their numbers, then each box's spheres.
  void find_contacts() const {
    contacts_.clear();
    Contact contact;
    grid_.find(spheres_, kinematics_, 0, pairs_);
    for (const auto& [i, j] : pairs_) {
      const Sphere& a = spheres_[i];
      const Sphere& b = spheres_[j];
      if (touch(a, kinematics_[a.body], b, kinematics_[b.body], contact)) contacts_.push_back(contact);
    }
    for (const Box& box : boxes_)
      for (const Sphere& sphere : spheres_)
        if (!(box.fixed && sphere.fixed) &&
            touch(box, kinematics_[box.body], sphere, kinematics_[sphere.body], contact))
          contacts_.push_back(contact);
  }

  const SimTK::SimbodyMatterSubsystem& matter_;
  std::vector<Moving> moving_;
  std::vector<Sphere> spheres_;
  std::vector<Box> boxes_;
  Law law_;
  double linear_damping_, angular_damping_;
  Watch& watch_;
  std::vector<SimTK::MobilizedBodyIndex> index_;  // of each body; a fixed one is ground
  // Scratch. Simbody's interface is const and this force is not parallel.
  mutable std::vector<Kinematics> kinematics_;
  mutable Grid grid_;
  mutable std::vector<std::pair<int, int>> pairs_;
  mutable std::vector<Contact> contacts_;
};

// ---------------------------------------------------------------------------------------------------------------------
// Integrators

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

struct IntegratorRow {
  const char* name;
  std::shared_ptr<Integrator> (*create)(const SimTK::System&, double fixed_step);
  bool fixed_step;
};

const IntegratorRow kIntegrators[] = {
    {"RungeKuttaMerson", create<SimTK::RungeKuttaMersonIntegrator>, false},
    {"RungeKutta3", create<SimTK::RungeKutta3Integrator>, false},
    {"RungeKutta2", create<SimTK::RungeKutta2Integrator>, false},
    {"RungeKuttaFeldberg", create<SimTK::RungeKuttaFeldbergIntegrator>, false},
    {"Verlet", create<SimTK::VerletIntegrator>, false},
    {"SemiExplicitEuler", create<SimTK::SemiExplicitEulerIntegrator>, true},
    {"SemiExplicitEuler2", create<SimTK::SemiExplicitEuler2Integrator>, false},
    {"ExplicitEuler", create<SimTK::ExplicitEulerIntegrator>, false},
    {"CPodesBDF", create_cpodes<SimTK::CPodes::BDF, SimTK::CPodes::Newton>, false},
    {"CPodesAdams", create_cpodes<SimTK::CPodes::Adams, SimTK::CPodes::Functional>, false},
};

std::shared_ptr<Integrator> make_integrator(const SimTK::System& system, const Physics& physics) {
  for (const IntegratorRow& row : kIntegrators) {
    if (physics.integrator != row.name) continue;
    auto integrator = row.create(system, std::min(physics.accuracy, kGreatestStep));
    if (!row.fixed_step) integrator->setMaximumStepSize(kGreatestStep);
    // CPodes would take its first step from the time first asked for: looking must not change the motion.
    if (physics.integrator.rfind("CPodes", 0) == 0) integrator->setInitialStepSize(kGreatestStep * physics.accuracy);
    integrator->setAccuracy(physics.accuracy);
    // The mean over all bodies, Simbody's default, would dilute the error of one that bounces among many at rest.
    integrator->setUseInfinityNorm(true);
    integrator->setReturnEveryInternalStep(true);
    return integrator;
  }
  throw std::invalid_argument("unknown integrator '" + physics.integrator + "'");
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
    require(body.fixed || !body.sphere || positive(body.inertia), who + "the inertia must be positive");
    const BodyState& s = states[i];
    require(finite(vec3(s.position)) && finite(vec3(s.velocity)) && finite(vec3(s.angular_velocity)),
            who + "position and velocity must be finite");
    double norm = 0;
    for (const double q : s.orientation) norm += q * q;
    require(std::isfinite(norm) && norm > 0.25 && norm < 4, who + "the orientation must be a unit quaternion");
  }
  require(any_moves, "no body moves");
}

Vec3 principal_inertia(const RigidBody& body) {
  if (body.sphere) return Vec3(body.inertia);
  const auto& h = body.half_extents;
  return body.mass / 3 * Vec3(h[1] * h[1] + h[2] * h[2], h[0] * h[0] + h[2] * h[2], h[0] * h[0] + h[1] * h[1]);
}

}  // namespace

// ---------------------------------------------------------------------------------------------------------------------

struct Simulation::Implementation {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  Physics physics;
  std::vector<BodyState> initial;
  std::vector<ContactForce::Moving> moving;
  Watch watch;
  const ContactForce* contact_force = nullptr;  // the force subsystem owns it
  std::shared_ptr<Integrator> integrator;
  double reference_energy = 0;
  std::int64_t spent_ns = 0;
  std::string failure;

  Implementation(const std::vector<RigidBody>& bodies, const Physics& physics_in, const std::vector<BodyState>& states,
                 double time, double reference)
      : physics(physics_in), initial(states) {
    check(bodies, physics, states, time);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const RigidBody& body = bodies[i];
      if (body.fixed) continue;
      const Vec3 inertia = principal_inertia(body);
      const SimTK::Body::Rigid rigid(SimTK::MassProperties(body.mass, Vec3(0), SimTK::Inertia(inertia)));
      const SimTK::MobilizedBody::Free mobod(matter.Ground(), SimTK::Transform(), rigid, SimTK::Transform());
      moving.push_back({static_cast<int>(i), mobod.getMobilizedBodyIndex(), body.mass, inertia});
    }
    const Vec3 gravity = vec3(physics.gravity);
    if (gravity != Vec3(0)) SimTK::Force::Gravity(forces, matter, gravity);
    auto* force = new ContactForce(matter, bodies, physics, states, moving, watch);
    SimTK::Force::Custom(forces, force);
    contact_force = force;
    system.realizeTopology();

    State state = system.getDefaultState();
    system.realizeModel(state);
    state.setTime(time);
    for (const auto& body : moving) {
      const BodyState& s = states[body.body];
      const SimTK::MobilizedBody& mobod = matter.getMobilizedBody(body.index);
      const int q = mobod.getFirstQIndex(state), u = mobod.getFirstUIndex(state);
      for (int i = 0; i < 4; ++i) state.updQ()[q + i] = s.orientation[i];
      for (int i = 0; i < 3; ++i) {
        state.updQ()[q + 4 + i] = s.position[i];
        state.updU()[u + i] = s.angular_velocity[i];
        state.updU()[u + 3 + i] = s.velocity[i];
      }
    }
    integrator = make_integrator(system, physics);
    integrator->initialize(state);

    reference_energy = reference;
    if (!(reference > 0)) {
      PhysicsSample now;
      measure(now);
      double weight = 0;
      for (const auto& body : moving) {
        const RigidBody& b = bodies[body.body];
        const double size = b.sphere ? b.radius : vec3(b.half_extents).norm();
        weight += body.mass * (std::fabs(~gravity * vec3(states[body.body].position)) + gravity.norm() * size);
      }
      reference_energy = std::max(now.kinetic_energy + elastic + weight, std::numeric_limits<double>::min());
    }
  }

  double elastic = 0;  // J, of the last measurement

  /// Energies and contacts at the present time.
  void measure(PhysicsSample& sample) {
    const State& state = integrator->getState();
    system.realize(state, SimTK::Stage::Velocity);
    elastic = contact_force->measure(state, sample);
    sample.kinetic_energy = matter.calcKineticEnergy(state);
    double gravity_energy = 0;
    for (const auto& body : moving)
      gravity_energy -=
          body.mass * (~vec3(physics.gravity) * matter.getMobilizedBody(body.index).getBodyOriginLocation(state));
    sample.energy = sample.kinetic_energy + gravity_energy + elastic;
  }

  bool state_is_finite() const {
    const SimTK::Vector& y = integrator->getState().getY();
    for (int i = 0; i < y.size(); ++i)
      if (!std::isfinite(y[i])) return false;
    return true;
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
      measure(sample);
    } catch (const std::exception& error) {
      return failure = one_line(error.what());
    }
    if (!std::isfinite(sample.energy) || sample.energy > physics.energy_bound * reference_energy)
      failure = "energy grew to " + text(sample.energy) + " J, beyond " + text(physics.energy_bound) +
                " times the reference of " + text(reference_energy) + " J" + at();
    return failure;
  }

  std::vector<BodyState> states() const {
    std::vector<BodyState> out = initial;
    const State& state = integrator->getState();
    const SimTK::Vector& q = state.getQ();
    const SimTK::Vector& u = state.getU();
    for (const auto& body : moving) {
      const SimTK::MobilizedBody& mobod = matter.getMobilizedBody(body.index);
      const int qi = mobod.getFirstQIndex(state), ui = mobod.getFirstUIndex(state);
      BodyState& s = out[body.body];
      for (int i = 0; i < 4; ++i) s.orientation[i] = q[qi + i];
      for (int i = 0; i < 3; ++i) {
        s.position[i] = q[qi + 4 + i];
        s.angular_velocity[i] = u[ui + i];
        s.velocity[i] = u[ui + 3 + i];
      }
    }
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
  implementation_->measure(out);
  return out;
}

std::string Simulation::advance_to(double time, PhysicsSample& sample) {
  return implementation_->advance_to(time, sample);
}

std::vector<BodyState> Simulation::states() const { return implementation_->states(); }

double Simulation::reference_energy() const { return implementation_->reference_energy; }

const std::vector<std::string>& integrator_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const IntegratorRow& row : kIntegrators) out.emplace_back(row.name);
    return out;
  }();
  return names;
}

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
