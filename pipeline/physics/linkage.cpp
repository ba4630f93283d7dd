#include "pipeline/physics/linkage.hpp"

#include <Simbody.h>

namespace pipeline {

using SimTK::MobilizedBody;
using SimTK::Transform;

struct Linkage::Tree {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  std::vector<LinkJoint::Kind> kinds;
  std::vector<MobilizedBody> bodies;
  SimTK::State state;
};

Linkage::Linkage(const std::vector<LinkJoint>& joints) : tree_(std::make_unique<Tree>()) {
  const SimTK::Body::Rigid body(SimTK::MassProperties(1, SimTK::Vec3(0), SimTK::Inertia(1)));
  for (const LinkJoint& joint : joints) {
    MobilizedBody& above = joint.above < 0 ? static_cast<MobilizedBody&>(tree_->matter.updGround())
                                           : tree_->bodies[std::size_t(joint.above)];
    const auto& q = joint.orientation;
    const auto& p = joint.position;
    const Transform origin(SimTK::Rotation(SimTK::Quaternion(SimTK::Vec4(q[0], q[1], q[2], q[3]))),
                           SimTK::Vec3(p[0], p[1], p[2]));
    const SimTK::UnitVec3 axis(joint.axis[0], joint.axis[1], joint.axis[2]);
    tree_->kinds.push_back(joint.kind);
    switch (joint.kind) {
      case LinkJoint::fixed:
        tree_->bodies.push_back(MobilizedBody::Weld(above, origin, body, Transform()));
        break;
      case LinkJoint::turning: {  // a pin turns about its frame's z
        const Transform turned(SimTK::Rotation(axis, SimTK::ZAxis));
        tree_->bodies.push_back(MobilizedBody::Pin(above, origin * turned, body, turned));
        break;
      }
      case LinkJoint::sliding: {  // a slider goes along its frame's x
        const Transform turned(SimTK::Rotation(axis, SimTK::XAxis));
        tree_->bodies.push_back(MobilizedBody::Slider(above, origin * turned, body, turned));
      }
    }
  }
  tree_->state = tree_->system.realizeTopology();
}

Linkage::~Linkage() = default;

std::vector<LinkPlace> Linkage::places(const std::vector<double>& values) {
  std::vector<LinkPlace> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (tree_->kinds[i] != LinkJoint::fixed) tree_->bodies[i].setOneQ(tree_->state, 0, values[i]);
  tree_->system.realize(tree_->state, SimTK::Stage::Position);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Transform& at = tree_->bodies[i].getBodyTransform(tree_->state);
    const SimTK::Quaternion q = at.R().convertRotationToQuaternion();
    out[i] = {{at.p()[0], at.p()[1], at.p()[2]}, {q[0], q[1], q[2], q[3]}};
  }
  return out;
}

}  // namespace pipeline
