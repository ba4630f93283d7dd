// Motion by Simbody behind a plain interface. C++17 without Eigen: this header is all that the rest of the program
// sees of the one target that includes Simbody (its headers are not valid C++20).
//
// Contact is our own Force::Custom: Hunt-Crossley (Hertz with dissipation) and Simbody's friction law, sphere with
// sphere on hash grids and sphere with finite box. Box with box has no contact. A body may have several spheres, which
// stand for its surface.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pipeline {

/// The force law of every contact. Both surfaces are of this material.
struct Material {
  double stiffness = 1e8;            // Pa, plane-strain modulus as in Simbody's CompliantContactSubsystem
  double dissipation = 0.1;          // s/m, Hunt-Crossley
  double static_friction = 0.5;      // 1
  double dynamic_friction = 0.4;     // 1
  double viscous_friction = 0;       // s/m
  double transition_velocity = 0.5;  // m/s; a smaller one costs steps
};

/// Where a body is touched: a sphere in its frame, m.
struct ContactSphere {
  std::array<double, 3> centre{};
  double radius = 1;
};

/// A sphere or a box, centred on its frame's origin, of uniform density unless it says otherwise; or any body, touched
/// by several spheres.
struct RigidBody {
  bool fixed = false;
  bool sphere = true;                    // else a box
  double radius = 1;                     // of contact, m (spheres)
  std::array<double, 3> half_extents{};  // m (boxes)
  double mass = 1;                       // kg; ignored when fixed
  double inertia = 1;                    // kg m^2 about every axis (spheres; a box's follows from its mass)
  // Of a body that is not of uniform density: where its centre of mass is in its frame, m, and its moments and products
  // of inertia about that, along the axes of its frame: xx, yy, zz, xy, xz, yz in kg m^2. All zero: as said above.
  std::array<double, 3> centre_of_mass{};
  std::array<double, 6> inertia_matrix{};
  // Where it is touched instead, as a sphere whose `radius` from its origin holds all of them; they do not touch each
  // other. Its moments of inertia are those of the matrix above.
  std::vector<ContactSphere> spheres = {};
  // A pendulum: it only turns about the line through `pivot` m parallel to z, like a door. Its position must be `pivot`
  // less its own y axis times the distance.
  bool hung = false;
  std::array<double, 3> pivot{};
};

/// What changes of a body: position m, orientation (w x y z), velocity m/s, angular velocity rad/s in ground.
struct BodyState {
  std::array<double, 3> position{};
  std::array<double, 4> orientation{1, 0, 0, 0};
  std::array<double, 3> velocity{};
  std::array<double, 3> angular_velocity{};
};

/// What a study weighs errors of energy and momentum by.
struct Balance {
  double energy = 1, momentum = 1, angular_momentum = 1;  // scales: J, N s, N m s
  std::array<double, 3> about{};                          // m; angular momentum is about this point
  // Energy lost to dissipation, friction and damping, and impulses of gravity and of fixed bodies are integrated beside
  // the motion. Without it the energy should stay as it is, and the momentum too when nothing acts from outside.
  bool tracked = false;
};

/// What Simbody's integrators advance. Bodies of their own, each with its equations of Newton and Euler, or one
/// multibody tree, which gives the same motion at several times the cost.
enum class BodyModel { free, tree };

/// How to integrate, and when to give up.
struct Physics {
  BodyModel bodies = BodyModel::free;  // a hung body makes it a tree
  std::string integrator = "RungeKuttaMerson";
  double accuracy = 1e-3;  // of a step, relative; SemiExplicitEuler controls no error: its step in s (at most 0.01)
  double greatest_step = 0.01;  // s; free fall would let steps grow until a body crosses a plate unseen
  double fixed_step = 0;        // s; above 0: every step is of this length, and no error is controlled
  double final_time = std::numeric_limits<double>::infinity();  // s; no internal step goes beyond it
  Balance balance;                                              // of run_to_end
  std::array<double, 3> gravity{0, -9.81, 0};                   // m/s^2; all zero: no gravity force is made
  double linear_damping = 0.1;                                  // 1/s: force -m c v
  double angular_damping = 0.8;                                 // 1/s: torque -I c w
  Material material;
  std::int64_t step_budget = 100000;  // internal steps per sample; more is a failure
  double time_budget = 3600;  // s of wall time of one Simulation (a restart is given what is left); more is a failure
  double energy_bound = 10;   // total energy above this multiple of the reference is a failure
};

/// What the integrator did since the sample before (counts, time) and what holds at the sample.
struct PhysicsSample {
  double energy = 0;                // J, kinetic + gravity + elastic; gravity counted from y = 0
  double kinetic_energy = 0;        // J
  double greatest_penetration = 0;  // m, 0 without contact
  std::int64_t contacts = 0;
  std::int64_t integrator_steps = 0;
  std::int64_t rejected_steps = 0;
  std::int64_t force_evaluations = 0;
  std::int64_t time_ns = 0;          // wall time of the integration
  std::int64_t contact_time_ns = 0;  // of it, spent finding contacts and their forces
};

/// How an integration ended.
enum class Ended { finished, exception, not_finite, energy, evaluations, time };

/// An integration as studies see it, over all its internal steps.
struct Trace {
  Ended ended = Ended::finished;
  std::string reason;               // empty when it finished
  double time = 0;                  // s reached
  double energy_error = 0;          // of the balance, in its energy scale: the worst, with its sign
  double momentum_drift = 0;        // of linear or angular momentum, in its scale: the worst; NaN when not known
  double greatest_penetration = 0;  // m, at the ends of internal steps
  double smallest_step = 0;         // s; without the last one, which is cut to end in time; NaN when there is no other
  std::int64_t steps = 0, rejected_steps = 0, force_evaluations = 0;
};

/// What is known of an integrator.
struct IntegratorFacts {
  const char* name;
  const char* what;    // one line
  int order;           // nominal; 0: it varies
  bool error_control;  // it chooses its steps by the accuracy
  bool fixed_step;     // it can be given a fixed one
};
const std::vector<IntegratorFacts>& integrators();

/// The integrators that Physics::integrator may name.
const std::vector<std::string>& integrator_names();

/// One integration. Constructed again from the states at a sample it continues in the same way as any other object
/// constructed from them: the run restarts it every 50 steps, and at births and pushes, so that a resumed run has the
/// same bits.
class Simulation {
 public:
  /// Starts at `time` s from `states` (one per body); quaternions are normalised. `reference_energy` J is what
  /// energy_bound multiplies; 0 or less: it is made from the states (kinetic + elastic energy + sum of m |g| (|height
  /// over y = 0| + size), so never less than the energy at the start; at least a tiny positive). Steps are at most 0.01
  /// s, so that nothing crosses a plate unseen. Throws std::invalid_argument for values out of range or not finite, an
  /// unknown integrator, or when no body moves.
  Simulation(const std::vector<RigidBody>& bodies, const Physics& physics, const std::vector<BodyState>& states,
             double time, double reference_energy = 0);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// The sample at the present time without integrating (all "since" columns 0).
  PhysicsSample sample();

  /// Integrates to `time` s. Empty when it went well; otherwise why it failed (exception text, NaN, energy, budget):
  /// the object is then of no more use. Never throws for what the integrator does, never hangs. `time` is not before
  /// the present; how often it is called does not change the steps, only which of them are interpolated for the caller.
  std::string advance_to(double time, PhysicsSample& sample);

  /// Integrates to Physics::final_time, where the last internal step ends exactly. At most `evaluations` of the force.
  /// Energy and momentum are looked at after internal steps, at most `looks` times. For an object that has not been
  /// advanced before. Never throws for what the integrator does; physics.time_budget is of processor
  /// time here.
  Trace run_to_end(std::int64_t evaluations, int looks = 256);

  /// States at the present time as the integrator has them: quaternions have drifted from unit length by about the
  /// accuracy, whoever makes poses of them normalises.
  std::vector<BodyState> states() const;

  double reference_energy() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Versions of Simbody and of the BLAS and LAPACK that are loaded (file names), as name -> text.
std::vector<std::pair<std::string, std::string>> simulation_libraries();

}  // namespace pipeline
