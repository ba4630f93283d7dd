#include "pipeline/physics/forces.hpp"

#include <algorithm>
#include <stdexcept>

namespace pipeline {

using contact::Box;
using contact::Contact;
using contact::Kinematics;
using contact::Sphere;
using SimTK::Rotation;
using SimTK::SpatialVec;
using SimTK::SymMat33;
using SimTK::Vec3;

namespace {

SymMat33 inertia_of(const RigidBody& body) {
  const auto& m = body.inertia_matrix;
  if (m != std::array<double, 6>{}) return SymMat33(m[0], m[3], m[1], m[4], m[5], m[2]);
  if (body.sphere) return SymMat33(body.inertia);
  const auto& h = body.half_extents;
  SymMat33 out(0);
  out.updDiag() = body.mass / 3 * Vec3(h[1] * h[1] + h[2] * h[2], h[0] * h[0] + h[2] * h[2], h[0] * h[0] + h[1] * h[1]);
  return out;
}

bool is_isotropic(const SymMat33& m) {
  return m.getDiag()[0] == m.getDiag()[1] && m.getDiag()[1] == m.getDiag()[2] && m.getLower() == Vec3(0);
}

}  // namespace

std::vector<Moving> moving_bodies(const std::vector<RigidBody>& bodies) {
  std::vector<Moving> out;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const RigidBody& body = bodies[i];
    if (body.fixed) continue;
    Moving moving{static_cast<int>(i), body.mass, vec3(body.centre_of_mass), inertia_of(body)};
    moving.centred = moving.centre == Vec3(0);
    moving.isotropic = is_isotropic(moving.inertia);
    moving.needs_orientation = !body.sphere || !body.spheres.empty() || !moving.centred || !moving.isotropic;
    out.push_back(moving);
  }
  return out;
}

std::array<double, kBesides> beside_rates(const Loads& loads, const Balance& balance) {
  std::array<double, kBesides> out;
  out[0] = kBesideScale * loads.lost_power / balance.energy;
  for (int i = 0; i < 3; ++i) {
    out[1 + i] = kBesideScale * loads.outer_force[i] / balance.momentum;
    out[4 + i] = kBesideScale * loads.outer_moment[i] / balance.angular_momentum;
  }
  return out;
}

Forces::Forces(const std::vector<RigidBody>& bodies, const Physics& physics, const std::vector<BodyState>& states,
               Watch& watch)
    : balance_(physics.balance),
      gravity_(vec3(physics.gravity)),
      moving_(moving_bodies(bodies)),
      law_(physics.material),
      linear_damping_(physics.linear_damping),
      angular_damping_(physics.angular_damping),
      watch_(watch),
      kinematics_(bodies.size()),
      on_(bodies.size()) {
  std::vector<Sphere> spheres;
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto& q = states[i].orientation;
    fixed_.push_back(bodies[i].fixed);
    kinematics_[i].position = vec3(states[i].position);
    kinematics_[i].orientation = Rotation(SimTK::Quaternion(q[0], q[1], q[2], q[3]));
    for (const ContactSphere& sphere : bodies[i].spheres) {
      const Vec3 centre = vec3(sphere.centre);
      spheres.push_back({static_cast<int>(i), bodies[i].fixed, sphere.radius, centre, centre == Vec3(0)});
    }
    if (!bodies[i].spheres.empty()) continue;
    if (bodies[i].sphere)
      spheres.push_back({static_cast<int>(i), bodies[i].fixed, bodies[i].radius});
    else
      boxes.push_back({static_cast<int>(i), bodies[i].fixed, vec3(bodies[i].half_extents)});
  }
  neighbours_ = contact::Neighbours(std::move(spheres), std::move(boxes));
}

Vec3 Forces::arm(const Moving& body) const {
  return body.centred ? Vec3(0) : Vec3(kinematics_[body.body].orientation * body.centre);
}

Vec3 Forces::spin(const Moving& body) const {
  const Kinematics& k = kinematics_[body.body];
  if (body.isotropic) return body.inertia.getDiag()[0] * k.angular_velocity;
  return k.orientation * (body.inertia * (~k.orientation * k.angular_velocity));
}

const std::vector<SpatialVec>& Forces::evaluate(Loads& loads) {
  const auto start = Clock::now();
  if (watch_.reason.empty()) {
    if (++watch_.evaluations > watch_.evaluation_limit) watch_.reason = watch_.evaluation_reason;
    if (start > watch_.deadline) watch_.reason = watch_.deadline_reason;
  }
  if (!watch_.reason.empty()) throw std::runtime_error(watch_.reason);
  for (const Moving& body : moving_)
    if (!finite(kinematics_[body.body].position)) throw std::runtime_error("a position is not finite");

  const auto add_outer = [&](const Vec3& point, const Vec3& force) {
    loads.outer_force += force;
    loads.outer_moment += (point - vec3(balance_.about)) % force;
  };
  loads = Loads();
  std::fill(on_.begin(), on_.end(), SpatialVec(Vec3(0), Vec3(0)));
  if (gravity_ != Vec3(0)) fall(loads);
  neighbours_.find(kinematics_, contacts_);
  for (const Contact& c : contacts_) {
    loads.depth = std::max(loads.depth, c.depth);
    const Kinematics& a = kinematics_[c.a];
    const Kinematics& b = kinematics_[c.b];
    const Vec3 arm_a = c.point - a.position, arm_b = c.point - b.position;
    const Vec3 velocity = (b.velocity + b.angular_velocity % arm_b) - (a.velocity + a.angular_velocity % arm_a);
    const Vec3 force = law_.force(c, velocity);
    // Fixed bodies take their part too, without effect.
    on_[c.a] -= SpatialVec(arm_a % force, force);
    on_[c.b] += SpatialVec(arm_b % force, force);
    if (balance_.tracked) {
      loads.lost_power += ~(law_.elastic_force(c) * c.normal - force) * velocity;
      if (fixed_[c.a]) add_outer(c.point, force);
      if (fixed_[c.b]) add_outer(c.point, -force);
    }
  }
  if (linear_damping_ != 0 || angular_damping_ != 0) damp(loads);
  watch_.contact_time_ns += nanoseconds(Clock::now() - start);
  return on_;
}

void Forces::fall(Loads& loads) {
  for (const Moving& body : moving_) {
    const Vec3 lever = arm(body), weight = body.mass * gravity_;
    on_[body.body] = SpatialVec(lever % weight, weight);
    if (!balance_.tracked) continue;
    loads.outer_force += weight;
    loads.outer_moment += (kinematics_[body.body].position + lever - vec3(balance_.about)) % weight;
  }
}

/// Of the centre of mass by -m c v, of the rotation by -I c w.
void Forces::damp(Loads& loads) {
  for (const Moving& body : moving_) {
    const Kinematics& k = kinematics_[body.body];
    const Vec3 lever = arm(body), velocity = k.velocity + k.angular_velocity % lever;
    const Vec3 moment = -angular_damping_ * spin(body), force = -linear_damping_ * body.mass * velocity;
    on_[body.body] += SpatialVec(moment + lever % force, force);
    if (!balance_.tracked) continue;
    loads.lost_power -= ~moment * k.angular_velocity + ~force * velocity;
    loads.outer_force += force;
    loads.outer_moment += moment + (k.position + lever - vec3(balance_.about)) % force;
  }
}

double Forces::measure(PhysicsSample& sample) {
  neighbours_.find(kinematics_, contacts_);
  double elastic = 0, kinetic = 0, height = 0;
  for (const Contact& c : contacts_) {
    elastic += law_.elastic_energy(c);
    sample.greatest_penetration = std::max(sample.greatest_penetration, c.depth);
  }
  for (const Moving& body : moving_) {
    const Kinematics& k = kinematics_[body.body];
    const Vec3 lever = arm(body), velocity = k.velocity + k.angular_velocity % lever;
    kinetic += (body.mass * velocity.normSqr() + ~spin(body) * k.angular_velocity) / 2;
    height -= body.mass * (~gravity_ * (k.position + lever));
  }
  sample.contacts = static_cast<std::int64_t>(contacts_.size());
  sample.kinetic_energy = kinetic;
  sample.energy = kinetic + height + elastic;
  return elastic;
}

std::array<double, 6> Forces::momentum() const {
  Vec3 linear(0), angular(0);
  for (const Moving& body : moving_) {
    const Kinematics& k = kinematics_[body.body];
    const Vec3 lever = arm(body);
    const Vec3 momentum = body.mass * (k.velocity + k.angular_velocity % lever);
    linear += momentum;
    angular += (k.position + lever - vec3(balance_.about)) % momentum + spin(body);
  }
  std::array<double, 6> out;
  for (int i = 0; i < 3; ++i) {
    out[i] = linear[i] / balance_.momentum;
    out[3 + i] = angular[i] / balance_.angular_momentum;
  }
  return out;
}

}  // namespace pipeline
