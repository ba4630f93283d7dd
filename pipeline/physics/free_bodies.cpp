#include "pipeline/physics/free_bodies.hpp"

#include <SimTKcommon/internal/SystemGuts.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pipeline {
namespace {

using contact::Kinematics;
using SimTK::ProjectOptions;
using SimTK::ProjectResults;
using SimTK::Rotation;
using SimTK::SpatialVec;
using SimTK::Stage;
using SimTK::State;
using SimTK::SymMat33;
using SimTK::Value;
using SimTK::Vec3;
using SimTK::Vec4;
using SimTK::Vector;

// Of each moving body: q is the quaternion (w x y z) of its frame and the place of its centre of mass; u is its angular
// velocity and that of its centre of mass, both in ground. The same as in the tree, but for the centre of mass.
constexpr int kQ = 7, kU = 6;

// Vector::operator[] is a function of the library, called for each number.
const double* numbers(const Vector& v) {
  assert(v.hasContiguousData());
  return v.size() ? v.getContiguousScalarData() : nullptr;
}
double* numbers(Vector& v) {
  assert(v.hasContiguousData());
  return v.size() ? v.updContiguousScalarData() : nullptr;
}

/// q' of the quaternion q of a frame that turns by w: half the product of (0, w) and q. As Simbody has it, with q as it
/// is, not of unit length.
void turn(const double* q, const double* w, double* rate) {
  const double a = w[0] / 2, b = w[1] / 2, c = w[2] / 2;
  rate[0] = -q[1] * a - q[2] * b - q[3] * c;
  rate[1] = q[0] * a + q[3] * b - q[2] * c;
  rate[2] = -q[3] * a + q[0] * b + q[1] * c;
  rate[3] = q[2] * a - q[1] * b + q[0] * c;
}

/// The least-squares inverse of `turn` for a unit quaternion.
void turned_by(const double* q, const double* rate, double* w) {
  w[0] = 2 * (-q[1] * rate[0] + q[0] * rate[1] - q[3] * rate[2] + q[2] * rate[3]);
  w[1] = 2 * (-q[2] * rate[0] + q[3] * rate[1] + q[0] * rate[2] - q[1] * rate[3]);
  w[2] = 2 * (-q[3] * rate[0] - q[2] * rate[1] + q[1] * rate[2] + q[0] * rate[3]);
}

/// By cofactors: Simbody 3.7's own inverse of a SymMat33 ends in an assertion of its own (SymMat::lowerIx).
SymMat33 inverse(const SymMat33& m) {
  const double xx = m(0, 0), yy = m(1, 1), zz = m(2, 2), xy = m(1, 0), xz = m(2, 0), yz = m(2, 1);
  const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
  const double determinant = xx * a + xy * b + xz * c;
  return SymMat33(a, b, xx * zz - xz * xz, c, xy * xz - xx * yz, xx * yy - xy * xy) / determinant;
}

class FreeGuts : public SimTK::System::Guts {
 public:
  FreeGuts(const std::vector<RigidBody>& bodies, const Physics& physics, const std::vector<BodyState>& states,
           Watch& watch)
      : forces_(bodies, physics, states, watch) {
    for (const Moving& body : forces_.moving()) inverse_inertia_.push_back(inverse(body.inertia));
  }

  void live_in(SimTK::SubsystemIndex subsystem) { subsystem_ = subsystem; }
  int count() const { return static_cast<int>(forces_.moving().size()); }
  const std::vector<Moving>& moving() const { return forces_.moving(); }

  /// The forces with the kinematics of a state.
  Forces& at(const State& state) const {
    const double* q = numbers(state.getQ());
    const double* u = numbers(state.getU());
    for (const Moving& body : forces_.moving()) {
      Kinematics& k = forces_.kinematics()[body.body];
      k.position = Vec3(q[4], q[5], q[6]);
      k.angular_velocity = Vec3(u[0], u[1], u[2]);
      k.velocity = Vec3(u[3], u[4], u[5]);
      if (body.needs_orientation) k.orientation = Rotation(SimTK::Quaternion(q[0], q[1], q[2], q[3]));
      if (!body.centred) {
        const Vec3 arm = k.orientation * body.centre;
        k.position -= arm;
        k.velocity -= k.angular_velocity % arm;
      }
      q += kQ;
      u += kU;
    }
    return forces_;
  }

  const Loads& loads(const State& state) const {
    return Value<Loads>::downcast(state.getCacheEntry(subsystem_, loads_));
  }

  std::array<double, kBesides> beside(const State& state) const {
    std::array<double, kBesides> out{};
    if (forces_.balance().tracked)
      for (int i = 0; i < kBesides; ++i) out[i] = state.getZ()[i] / kBesideScale;
    return out;
  }

 protected:
  FreeGuts* cloneImpl() const override { return new FreeGuts(*this); }

  int realizeTopologyImpl(State& state) const override {
    Vector q(kQ * count(), 0.);
    for (int b = 0; b < count(); ++b) q[kQ * b] = 1;
    state.allocateQ(subsystem_, q);
    state.allocateU(subsystem_, Vector(kU * count(), 0.));
    if (forces_.balance().tracked) state.allocateZ(subsystem_, Vector(kBesides, 0.));
    loads_ = state.allocateCacheEntry(subsystem_, Stage::Acceleration, new Value<Loads>());
    return 0;
  }

  int realizeInstanceImpl(const State& state) const override {
    state.allocateQErr(subsystem_, count());
    return 0;
  }

  int realizePositionImpl(const State& state) const override {
    const double* q = numbers(state.getQ());
    double* error = numbers(state.updQErr());
    for (int b = 0; b < count(); ++b, q += kQ)
      error[b] = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]) - 1;
    return 0;
  }

  int realizeVelocityImpl(const State& state) const override {
    times_n(numbers(state.getQ()), numbers(state.getU()), numbers(state.updQDot()));
    return 0;
  }

  int realizeAccelerationImpl(const State& state) const override {
    Loads& loads = Value<Loads>::updDowncast(state.updCacheEntry(subsystem_, loads_));
    const std::vector<SpatialVec>& on = at(state).evaluate(loads);
    const double* u = numbers(state.getU());
    const double* q = numbers(state.getQ());
    const double* q_dot = numbers(state.getQDot());
    double* u_dot = numbers(state.updUDot());
    double* q_dot_dot = numbers(state.updQDotDot());
    for (int b = 0; b < count(); ++b) {
      const Moving& body = forces_.moving()[b];
      const Kinematics& k = forces_.kinematics()[body.body];
      Vec3 moment = on[body.body][0], turning;
      const Vec3 force = on[body.body][1], acceleration = force / body.mass;
      if (!body.centred) moment -= (k.orientation * body.centre) % force;
      if (body.isotropic) {
        turning = moment / body.inertia.getDiag()[0];
      } else {
        const Vec3 spin = ~k.orientation * k.angular_velocity;
        turning = k.orientation * (inverse_inertia_[b] * (~k.orientation * moment - spin % (body.inertia * spin)));
      }
      for (int i = 0; i < 3; ++i) {
        u_dot[i] = turning[i];
        u_dot[3 + i] = q_dot_dot[4 + i] = acceleration[i];
      }
      // q'' = N u' + N' u, and N is linear in q.
      double by_rate[4], by_speed[4];
      turn(q, u_dot, by_rate);
      turn(q_dot, u, by_speed);
      for (int i = 0; i < 4; ++i) q_dot_dot[i] = by_rate[i] + by_speed[i];
      q += kQ, q_dot += kQ, q_dot_dot += kQ;
      u += kU, u_dot += kU;
    }
    if (forces_.balance().tracked) {
      const std::array<double, kBesides> rates = beside_rates(loads, forces_.balance());
      std::copy(rates.begin(), rates.end(), numbers(state.updZDot()));
    }
    return 0;
  }

  void multiplyByNImpl(const State& state, const Vector& u, Vector& q_dot) const override {
    q_dot.resize(kQ * count());
    times_n(numbers(state.getQ()), numbers(u), numbers(q_dot));
  }

  void multiplyByNPInvImpl(const State& state, const Vector& q_dot_in, Vector& u_out) const override {
    u_out.resize(kU * count());
    const double* q = numbers(state.getQ());
    const double* q_dot = numbers(q_dot_in);
    double* u = numbers(u_out);
    for (int b = 0; b < count(); ++b, q += kQ, q_dot += kQ, u += kU) {
      turned_by(q, q_dot, u);
      std::copy(q_dot + 4, q_dot + 7, u + 3);
    }
  }

  /// As the tree does: when one quaternion is further from unit length than is asked for, all are normalised, and what
  /// lies along them is taken out of the error estimate.
  void projectQImpl(State& state, Vector& estimate, const ProjectOptions& options,
                    ProjectResults& results) const override {
    results.clear();
    const Vector& error = state.getQErr();
    const bool greatest = options.isOptionSet(ProjectOptions::UseInfinityNorm);
    const double norm = greatest ? error.normInf() : error.normRMS();
    results.setNormOnEntrance(norm, -1);
    results.setNormOnExit(norm);
    if (norm > options.getProjectionLimit()) {
      results.setProjectionLimitExceeded(true);
      results.setExitStatus(ProjectResults::FailedToConverge);
      return;
    }
    results.setExitStatus(ProjectResults::Succeeded);
    if (norm <= options.getRequiredAccuracy() && !options.isOptionSet(ProjectOptions::ForceProjection)) return;
    double* q = numbers(state.updQ());
    double* e = numbers(estimate);
    for (int b = 0; b < count(); ++b, q += kQ) {
      Vec4& turned = Vec4::updAs(q);
      turned /= turned.norm();
      if (e) {
        Vec4& wrong = Vec4::updAs(e);
        wrong -= (~wrong * turned) * turned;
        e += kQ;
      }
    }
    results.setAnyChangeMade(true);
    results.setNumIterations(1);
    getSystem().realize(state, Stage::Position);
    results.setNormOnExit(greatest ? state.getQErr().normInf() : state.getQErr().normRMS());
  }

 private:
  void times_n(const double* q, const double* u, double* q_dot) const {
    for (int b = 0; b < count(); ++b, q += kQ, u += kU, q_dot += kQ) {
      turn(q, u, q_dot);
      std::copy(u + 3, u + 6, q_dot + 4);
    }
  }

  mutable Forces forces_;                  // scratch; Simbody's interface is const
  std::vector<SymMat33> inverse_inertia_;  // of each moving body
  SimTK::SubsystemIndex subsystem_;
  mutable SimTK::CacheEntryIndex loads_;
};

class FreeBodies : public Mechanics {
 public:
  explicit FreeBodies(FreeGuts* guts) : guts_(guts) {
    system_.adoptSystemGuts(guts);
    guts->live_in(SimTK::DefaultSystemSubsystem(system_).getMySubsystemIndex());
    guts->setHasTimeAdvancedEvents(false);
    system_.realizeTopology();
  }

  const SimTK::System& system() const override { return system_; }

  State start(const std::vector<BodyState>& states, double time) const override {
    State state = system_.getDefaultState();
    system_.realizeModel(state);
    state.setTime(time);
    double* q = numbers(state.updQ());
    double* u = numbers(state.updU());
    for (const Moving& body : guts_->moving()) {
      const BodyState& s = states[body.body];
      const Vec3 w = vec3(s.angular_velocity), arm = lever(body, s);
      const Vec3 position = vec3(s.position) + arm, velocity = vec3(s.velocity) + w % arm;
      std::copy(s.orientation.begin(), s.orientation.end(), q);
      for (int i = 0; i < 3; ++i) {
        q[4 + i] = position[i];
        u[i] = w[i];
        u[3 + i] = velocity[i];
      }
      q += kQ;
      u += kU;
    }
    return state;
  }

  void write(const State& state, std::vector<BodyState>& states) const override {
    const double* q = numbers(state.getQ());
    const double* u = numbers(state.getU());
    for (const Moving& body : guts_->moving()) {
      BodyState& s = states[body.body];
      std::copy(q, q + 4, s.orientation.begin());
      std::copy(u, u + 3, s.angular_velocity.begin());
      const Vec3 arm = lever(body, s), moved = vec3(s.angular_velocity) % arm;
      for (int i = 0; i < 3; ++i) {
        s.position[i] = q[4 + i] - arm[i];
        s.velocity[i] = u[3 + i] - moved[i];
      }
      q += kQ;
      u += kU;
    }
  }

  Forces& at(const State& state) const override { return guts_->at(state); }
  const Loads& loads(const State& state) const override { return guts_->loads(state); }
  std::array<double, kBesides> beside(const State& state) const override { return guts_->beside(state); }

 private:
  /// From the origin of a body's frame to its centre of mass, in ground.
  static Vec3 lever(const Moving& body, const BodyState& s) {
    if (body.centred) return Vec3(0);
    const auto& q = s.orientation;
    return Rotation(SimTK::Quaternion(q[0], q[1], q[2], q[3])) * body.centre;
  }

  FreeGuts* guts_;  // the system owns it
  SimTK::System system_;
};

}  // namespace

std::unique_ptr<Mechanics> free_bodies(const std::vector<RigidBody>& bodies, const Physics& physics,
                                       const std::vector<BodyState>& states, Watch& watch) {
  return std::make_unique<FreeBodies>(new FreeGuts(bodies, physics, states, watch));
}

}  // namespace pipeline
