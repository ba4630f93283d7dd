// The forces on the bodies of a Simulation: gravity, contacts (contact.hpp) and damping; and what a balance of
// energy and momentum needs of them. They know nothing of how the bodies are integrated. Includes Simbody: only the
// target that integrates sees it (CMakeLists.txt says why).
#pragma once
#include <SimTKcommon.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/physics/contact.hpp"
#include "pipeline/physics/simulate.hpp"

namespace pipeline {

using Clock = std::chrono::steady_clock;

inline SimTK::Vec3 vec3(const std::array<double, 3>& v) { return SimTK::Vec3(v[0], v[1], v[2]); }
inline bool finite(const SimTK::Vec3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }
inline std::int64_t nanoseconds(Clock::duration duration) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

/// What the forces count and when they give up. Simbody takes an exception from a force for a step that failed and
/// tries a shorter one, so the forces go on throwing until the integrator gives up; the reason is kept here.
struct Watch {
  std::int64_t evaluations = 0;
  std::int64_t evaluation_limit = std::numeric_limits<std::int64_t>::max();
  std::int64_t contact_time_ns = 0;
  Clock::time_point deadline = Clock::time_point::max();
  std::string evaluation_reason, deadline_reason;
  std::string reason;
};

/// A body that is not fixed.
struct Moving {
  int body;
  double mass;
  SimTK::Vec3 centre{0};    // of mass, in its frame
  SimTK::SymMat33 inertia;  // about its centre of mass, along the axes of its frame
  bool centred = true;      // the centre of mass is its frame's origin
  bool isotropic = true;    // its inertia is the same about every axis
  bool needs_orientation = false;
};

/// The bodies that move, in order.
std::vector<Moving> moving_bodies(const std::vector<RigidBody>& bodies);

/// What a balance of energy and momentum needs of one evaluation of the forces.
struct Loads {
  double lost_power = 0;        // W, to dissipation, friction and damping
  SimTK::Vec3 outer_force{0};   // N, of fixed bodies, damping and gravity
  SimTK::Vec3 outer_moment{0};  // N m, of these about Balance::about
  double depth = 0;             // m, of the deepest contact
};

// The balance is integrated beside the motion, as auxiliary states: energy lost (1), impulse (3) and angular impulse
// (3) from outside, in units of the scales times kBesideScale, so that it never decides a step.
constexpr int kBesides = 7;
constexpr double kBesideScale = 1e-9;

/// Rates of the auxiliary states.
std::array<double, kBesides> beside_rates(const Loads& loads, const Balance& balance);

class Forces {
 public:
  /// `watch` is to outlive it.
  Forces(const std::vector<RigidBody>& bodies, const Physics& physics, const std::vector<BodyState>& states,
         Watch& watch);

  const std::vector<Moving>& moving() const { return moving_; }
  const Balance& balance() const { return balance_; }

  /// Of every body, at its frame's origin. Who calls what follows keeps those that move up to date: the orientation
  /// only where Moving::needs_orientation says so.
  std::vector<contact::Kinematics>& kinematics() { return kinematics_; }

  /// The moment about each body's origin, and the force, at the present kinematics. Counts
  /// itself; throws when the budgets are spent or a position is not finite.
  const std::vector<SimTK::SpatialVec>& evaluate(Loads& loads);

  /// Energies, contacts and penetration at the present kinematics. Returns the elastic energy J.
  double measure(PhysicsSample& sample);

  /// Linear and angular momentum at the present kinematics, in units of their scales.
  std::array<double, 6> momentum() const;

 private:
  SimTK::Vec3 arm(const Moving& body) const;   // from its origin to its centre of mass, in ground
  SimTK::Vec3 spin(const Moving& body) const;  // angular momentum about its centre of mass
  void fall(Loads& loads);
  void damp(Loads& loads);

  Balance balance_;
  SimTK::Vec3 gravity_;
  std::vector<Moving> moving_;
  contact::Law law_;
  double linear_damping_, angular_damping_;
  Watch& watch_;
  std::vector<bool> fixed_;  // of each body
  // Scratch: nothing of it but the fixed bodies' kinematics outlives a call.
  std::vector<contact::Kinematics> kinematics_;
  std::vector<SimTK::SpatialVec> on_;
  contact::Neighbours neighbours_;
  std::vector<contact::Contact> contacts_;
};

}  // namespace pipeline
