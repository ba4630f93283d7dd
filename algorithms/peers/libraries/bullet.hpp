// What bullet_gimpact and bullet_hull share: Bullet asked about two bodies alone, through its dispatcher. Both are
// built twice, for Debian's libraries in single and in double precision, whose symbols are the same.
#pragma once
#include <btBulletCollisionCommon.h>

#include "algorithms/peers/libraries/peer.hpp"

namespace peers {

#ifdef BT_USE_DOUBLE_PRECISION
#define BULLET_NAME(name) name "_double"
constexpr const char* kBulletPrecision = "double";
#else
#define BULLET_NAME(name) name
constexpr const char* kBulletPrecision = "single";
#endif

inline btVector3 bullet_vector(const Vec3& v) { return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())}; }

/// Bodies whose shapes are made by `Shape(mesh, margin)`, one per mesh; shape().
template <class Shape>
class Bullet {
 public:
  Bullet(const Bodies& bodies, const collision_value* knobs) : dispatcher_(&configuration_), objects_(bodies.size()) {
    for (const Mesh& mesh : bodies.meshes) shapes_.push_back(std::make_unique<Shape>(mesh, btScalar(margin(knobs))));
    for (std::size_t body = 0; body < bodies.size(); ++body)
      objects_[body].setCollisionShape(&shapes_[bodies.mesh[body]]->shape());
    Shape::register_with(dispatcher_);
  }

  static double margin(const collision_value* knobs) { return knobs[0].real; }

  void place(std::uint32_t body, const Pose& pose) {
    const geometry::Mat3 r = geometry::rotation(pose.q);
    btTransform at;
    at.getBasis().setValue(btScalar(r(0, 0)), btScalar(r(0, 1)), btScalar(r(0, 2)), btScalar(r(1, 0)),
                           btScalar(r(1, 1)), btScalar(r(1, 2)), btScalar(r(2, 0)), btScalar(r(2, 1)),
                           btScalar(r(2, 2)));
    at.setOrigin(bullet_vector(pose.t));
    objects_[body].setWorldTransform(at);
  }

  bool meet(std::uint32_t a, std::uint32_t b) {
    const btCollisionObjectWrapper first(nullptr, objects_[a].getCollisionShape(), &objects_[a],
                                         objects_[a].getWorldTransform(), -1, -1),
        second(nullptr, objects_[b].getCollisionShape(), &objects_[b], objects_[b].getWorldTransform(), -1, -1);
    btCollisionAlgorithm* algorithm = dispatcher_.findAlgorithm(&first, &second, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    Touch touch(&first, &second);
    algorithm->processCollision(&first, &second, info_, &touch);
    algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(algorithm);
    return touch.touches;
  }

 private:
  /// Contacts are told with their distance, those within Bullet's breaking threshold too.
  struct Touch final : btManifoldResult {
    using btManifoldResult::btManifoldResult;
    void addContactPoint(const btVector3&, const btVector3&, btScalar distance) override { touches |= distance <= 0; }
    bool touches = false;
  };

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDispatcherInfo info_;
  std::vector<std::unique_ptr<Shape>> shapes_;
  std::vector<btCollisionObject> objects_;
};

}  // namespace peers
