// The force on the bodies of a Simulation: contacts (contact.hpp) and damping. C++17 with Simbody: only simulate.cpp
// includes it.
#pragma once
#include <Simbody.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/physics/contact.hpp"
#include "pipeline/physics/simulate.hpp"

namespace pipeline::contact {

using SimTK::SpatialVec;
using SimTK::State;
using Clock = std::chrono::steady_clock;

inline Vec3 vec3(const std::array<double, 3>& v) { return Vec3(v[0], v[1], v[2]); }
inline bool finite(const Vec3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }
inline std::int64_t nanoseconds(Clock::duration duration) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

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

  ContactForce(const SimTK::SimbodyMatterSubsystem& matter, const SimTK::GeneralForceSubsystem& forces,
               const std::vector<RigidBody>& bodies, const Physics& physics, const std::vector<BodyState>& states,
               const std::vector<Moving>& moving, Watch& watch)
      : matter_(matter),
        forces_(forces),
        balance_(physics.balance),
        gravity_(vec3(physics.gravity)),
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
    lost_power_ = 0;
    outer_force_ = outer_moment_ = Vec3(0);
    depth_ = 0;
    for (const Contact& c : contacts_) {
      depth_ = std::max(depth_, c.depth);
      const Kinematics& a = kinematics_[c.a];
      const Kinematics& b = kinematics_[c.b];
      const Vec3 arm_a = c.point - a.position, arm_b = c.point - b.position;
      const Vec3 velocity = (b.velocity + b.angular_velocity % arm_b) - (a.velocity + a.angular_velocity % arm_a);
      const Vec3 force = law_.force(c, velocity);
      // Ground takes its part too, without effect.
      forces[index_[c.a]] -= SpatialVec(arm_a % force, force);
      forces[index_[c.b]] += SpatialVec(arm_b % force, force);
      if (balance_.tracked) {
        lost_power_ += ~(law_.elastic_force(c) * c.normal - force) * velocity;
        if (index_[c.a] == SimTK::GroundIndex) add_outer(c.point, force);
        if (index_[c.b] == SimTK::GroundIndex) add_outer(c.point, -force);
      }
    }
    if (linear_damping_ != 0 || angular_damping_ != 0) {
      for (const Moving& body : moving_) {
        const Kinematics& k = kinematics_[body.body];
        const Rotation& r = k.orientation;
        const Vec3 momentum = isotropic(body) ? body.inertia[0] * k.angular_velocity
                                              : r * (~r * k.angular_velocity).elementwiseMultiply(body.inertia);
        forces[body.index] -= SpatialVec(angular_damping_ * momentum, linear_damping_ * body.mass * k.velocity);
        if (balance_.tracked) {
          lost_power_ +=
              angular_damping_ * ~momentum * k.angular_velocity + linear_damping_ * body.mass * k.velocity.normSqr();
          add_outer(k.position, -linear_damping_ * body.mass * k.velocity);
          outer_moment_ -= angular_damping_ * momentum;
        }
      }
    }
    if (balance_.tracked)
      for (const Moving& body : moving_) add_outer(kinematics_[body.body].position, body.mass * gravity_);
    watch_.contact_time_ns += nanoseconds(Clock::now() - start);
  }

  // What a balance of energy and momentum needs is integrated beside the motion: energy lost, impulse and angular
  // impulse from outside. In units of the scales times kBesideScale, so that it never decides a step.
  void realizeTopology(State& state) const override {
    if (balance_.tracked) first_beside_ = forces_.allocateZ(state, SimTK::Vector(7, 0.));
  }

  void realizeAcceleration(const State& state) const override {
    if (!balance_.tracked) return;
    SimTK::Vector& rate = forces_.updZDot(state);
    rate[first_beside_] = kBesideScale * lost_power_ / balance_.energy;
    for (int i = 0; i < 3; ++i) {
      rate[first_beside_ + 1 + i] = kBesideScale * outer_force_[i] / balance_.momentum;
      rate[first_beside_ + 4 + i] = kBesideScale * outer_moment_[i] / balance_.angular_momentum;
    }
  }

  /// Energy lost (1), impulse (3) and angular impulse (3) from outside since the start, in units of the scales.
  std::array<double, 7> beside(const State& state) const {
    std::array<double, 7> out{};
    if (balance_.tracked)
      for (int i = 0; i < 7; ++i) out[i] = forces_.getZ(state)[first_beside_ + i] / kBesideScale;
    return out;
  }

  /// Greatest depth m of a contact at the last evaluation.
  double depth() const { return depth_; }

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
  static constexpr double kBesideScale = 1e-9;

  void add_outer(const Vec3& point, const Vec3& force) const {
    outer_force_ += force;
    outer_moment_ += (point - vec3(balance_.about)) % force;
  }

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
  const SimTK::GeneralForceSubsystem& forces_;
  Balance balance_;
  Vec3 gravity_;
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
  mutable double lost_power_ = 0, depth_ = 0;
  mutable Vec3 outer_force_{0}, outer_moment_{0};
  mutable SimTK::ZIndex first_beside_;
};

}  // namespace pipeline::contact
