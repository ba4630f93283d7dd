#include "pipeline/physics/tree.hpp"

#include <Simbody.h>

#include <cmath>

namespace pipeline {
namespace {

using contact::Kinematics;
using SimTK::MobilizedBodyIndex;
using SimTK::SpatialVec;
using SimTK::Stage;
using SimTK::State;
using SimTK::Value;
using SimTK::Vec3;

/// Forces in Simbody's form. What one state gave is kept in that state's cache.
class TreeForce : public SimTK::Force::Custom::Implementation {
 public:
  TreeForce(const SimTK::SimbodyMatterSubsystem& matter, const SimTK::GeneralForceSubsystem& subsystem,
            const std::vector<MobilizedBodyIndex>& index, Forces& forces)
      : matter_(matter), subsystem_(subsystem), index_(index), forces_(forces) {}

  Forces& at(const State& state) const {
    for (const Moving& body : forces_.moving()) {
      const SimTK::MobilizedBody& mobod = matter_.getMobilizedBody(index_[body.body]);
      Kinematics& k = forces_.kinematics()[body.body];
      const SimTK::Transform& pose = mobod.getBodyTransform(state);
      const SpatialVec& velocity = mobod.getBodyVelocity(state);
      k.position = pose.p();
      k.orientation = pose.R();
      k.angular_velocity = velocity[0];
      k.velocity = velocity[1];
    }
    return forces_;
  }

  void calcForce(const State& state, SimTK::Vector_<SpatialVec>& forces, SimTK::Vector_<Vec3>&,
                 SimTK::Vector&) const override {
    Loads& loads = Value<Loads>::updDowncast(subsystem_.updCacheEntry(state, loads_));
    const std::vector<SpatialVec>& on = at(state).evaluate(loads);
    for (const Moving& body : forces_.moving()) forces[index_[body.body]] += on[body.body];
  }

  void realizeTopology(State& state) const override {
    loads_ = subsystem_.allocateCacheEntry(state, Stage::Dynamics, new Value<Loads>());
    if (forces_.balance().tracked) first_beside_ = subsystem_.allocateZ(state, SimTK::Vector(kBesides, 0.));
  }

  void realizeAcceleration(const State& state) const override {
    if (!forces_.balance().tracked) return;
    const std::array<double, kBesides> rates = beside_rates(loads(state), forces_.balance());
    SimTK::Vector& rate = subsystem_.updZDot(state);
    for (int i = 0; i < kBesides; ++i) rate[first_beside_ + i] = rates[i];
  }

  /// Nobody asks: a sample takes its energy from Forces.
  SimTK::Real calcPotentialEnergy(const State&) const override { return SimTK::NaN; }

  const Loads& loads(const State& state) const {
    return Value<Loads>::downcast(subsystem_.getCacheEntry(state, loads_));
  }

  std::array<double, kBesides> beside(const State& state) const {
    std::array<double, kBesides> out{};
    if (forces_.balance().tracked)
      for (int i = 0; i < kBesides; ++i) out[i] = subsystem_.getZ(state)[first_beside_ + i] / kBesideScale;
    return out;
  }

 private:
  const SimTK::SimbodyMatterSubsystem& matter_;
  const SimTK::GeneralForceSubsystem& subsystem_;
  const std::vector<MobilizedBodyIndex>& index_;
  Forces& forces_;  // scratch of its own; Simbody's interface is const and this force is not parallel
  mutable SimTK::CacheEntryIndex loads_;
  mutable SimTK::ZIndex first_beside_;
};

class Tree : public Mechanics {
 public:
  Tree(const std::vector<RigidBody>& bodies, const Physics& physics, const std::vector<BodyState>& states, Watch& watch)
      : forces_(bodies, physics, states, watch), index_(bodies.size(), SimTK::GroundIndex) {
    for (const Moving& body : forces_.moving()) {
      const RigidBody& b = bodies[body.body];
      const SimTK::Inertia central(body.inertia);
      const SimTK::Body::Rigid rigid(
          SimTK::MassProperties(body.mass, body.centre, central.shiftFromMassCenter(body.centre, body.mass)));
      hung_.push_back(b.hung);
      if (b.hung) {
        const Vec3 rod(0, (vec3(states[body.body].position) - vec3(b.pivot)).norm(), 0);
        index_[body.body] =
            SimTK::MobilizedBody::Pin(matter_.Ground(), vec3(b.pivot), rigid, rod).getMobilizedBodyIndex();
      } else {
        index_[body.body] = SimTK::MobilizedBody::Free(matter_.Ground(), SimTK::Transform(), rigid, SimTK::Transform())
                                .getMobilizedBodyIndex();
      }
    }
    force_ = new TreeForce(matter_, subsystem_, index_, forces_);
    SimTK::Force::Custom(subsystem_, force_);
    system_.realizeTopology();
  }

  const SimTK::System& system() const override { return system_; }

  State start(const std::vector<BodyState>& states, double time) const override {
    State state = system_.getDefaultState();
    system_.realizeModel(state);
    state.setTime(time);
    for (std::size_t m = 0; m < hung_.size(); ++m) {
      const BodyState& s = states[forces_.moving()[m].body];
      const auto [q, u] = coordinates(m, state);
      if (hung_[m]) {
        state.updQ()[q] = 2 * std::atan2(s.orientation[3], s.orientation[0]);
        state.updU()[u] = s.angular_velocity[2];
        continue;
      }
      for (int i = 0; i < 4; ++i) state.updQ()[q + i] = s.orientation[i];
      for (int i = 0; i < 3; ++i) {
        state.updQ()[q + 4 + i] = s.position[i];
        state.updU()[u + i] = s.angular_velocity[i];
        state.updU()[u + 3 + i] = s.velocity[i];
      }
    }
    return state;
  }

  void write(const State& state, std::vector<BodyState>& states) const override {
    for (std::size_t m = 0; m < hung_.size(); ++m) {
      BodyState& s = states[forces_.moving()[m].body];
      if (hung_[m]) {
        s = hanging(m, state);
        continue;
      }
      const auto [q, u] = coordinates(m, state);
      for (int i = 0; i < 4; ++i) s.orientation[i] = state.getQ()[q + i];
      for (int i = 0; i < 3; ++i) {
        s.position[i] = state.getQ()[q + 4 + i];
        s.angular_velocity[i] = state.getU()[u + i];
        s.velocity[i] = state.getU()[u + 3 + i];
      }
    }
  }

  Forces& at(const State& state) const override { return force_->at(state); }
  const Loads& loads(const State& state) const override { return force_->loads(state); }
  std::array<double, kBesides> beside(const State& state) const override { return force_->beside(state); }

 private:
  const SimTK::MobilizedBody& mobod(std::size_t moving) const {
    return matter_.getMobilizedBody(index_[forces_.moving()[moving].body]);
  }

  /// The first q and the first u of a moving body.
  std::pair<int, int> coordinates(std::size_t moving, const State& state) const {
    return {mobod(moving).getFirstQIndex(state), mobod(moving).getFirstUIndex(state)};
  }

  /// Of a body on a pin, whose coordinate is an angle.
  BodyState hanging(std::size_t moving, const State& state) const {
    system_.realize(state, Stage::Velocity);
    BodyState out;
    const SimTK::Quaternion turn = mobod(moving).getBodyRotation(state).convertRotationToQuaternion();
    const Vec3 position = mobod(moving).getBodyOriginLocation(state);
    const SpatialVec velocity = mobod(moving).getBodyVelocity(state);
    for (int i = 0; i < 4; ++i) out.orientation[i] = turn[i];
    for (int i = 0; i < 3; ++i) {
      out.position[i] = position[i];
      out.angular_velocity[i] = velocity[0][i];
      out.velocity[i] = velocity[1][i];
    }
    return out;
  }

  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_{system_};
  SimTK::GeneralForceSubsystem subsystem_{system_};
  mutable Forces forces_;
  std::vector<MobilizedBodyIndex> index_;  // of each body; a fixed one is ground
  std::vector<bool> hung_;                 // of each moving body
  TreeForce* force_ = nullptr;             // the subsystem owns it
};

}  // namespace

std::unique_ptr<Mechanics> multibody_tree(const std::vector<RigidBody>& bodies, const Physics& physics,
                                          const std::vector<BodyState>& states, Watch& watch) {
  return std::make_unique<Tree>(bodies, physics, states, watch);
}

}  // namespace pipeline
