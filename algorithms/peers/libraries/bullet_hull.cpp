// bullet_hull: Bullet's convex hulls of the meshes' vertices, btConvexHullShape.
//
// Source  Bullet 3.24, GJK and EPA; in single precision, as Debian and games have it, and in double
// (bullet_hull_double). Cost    The broad phase of `exact`; then per near pair a few tens of support points, each a
// look at every vertex. Misses  Hulls that only just touch, as GJK's tolerances fall. Extra   What a hull adds to a
// body that is not convex; bodies inside others; with a margin (Bullet's own is 0.04 m)
//         bodies that are nearer than twice that.
#include "algorithms/peers/libraries/bullet.hpp"

namespace peers {
namespace {

class Hull {
 public:
  Hull(const Mesh& mesh, btScalar margin) {
    for (const Vec3& v : mesh.vertices) shape_.addPoint(bullet_vector(v), false);
    shape_.setMargin(margin);
    shape_.recalcLocalAabb();
    shape_.optimizeConvexHull();
  }

  btCollisionShape& shape() { return shape_; }
  static void register_with(btCollisionDispatcher&) {}

 private:
  btConvexHullShape shape_;
};

}  // namespace
}  // namespace peers

COLLISION_EXPORT const collision_table* collision_plugin() {
  static const collision_knob knobs[] = {peers::margin_knob("around each hull; Bullet's own default is 0.04")};
  return peers::table<peers::Bullet<peers::Hull>>({.name = BULLET_NAME("bullet_hull"),
                                                   .what = "Bullet, convex hulls of the vertices by GJK and EPA",
                                                   .precision = peers::kBulletPrecision,
                                                   .knobs = knobs});
}
