// bullet_gimpact: Bullet's triangle meshes that move, btGImpactMeshShape.
//
// Source  Bullet 3.24, btGImpactCollisionAlgorithm on pairs of meshes; in single precision, as Debian and games have
// it,
//         and in double (bullet_gimpact_double).
// Cost    The broad phase of `exact`; then per near pair a descent of two trees of boxes and tests of triangles.
// Misses  Bodies that only just touch: depths below about 1e-5 m, in doubles too. Bodies wholly inside others.
// Extra   With a margin (Bullet's own is 0.01 m) bodies that are nearer than twice that.
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include "algorithms/peers/libraries/bullet.hpp"

namespace peers {
namespace {

class Surface {
 public:
  Surface(const Mesh& mesh, btScalar margin) {
    for (const Vec3& v : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) coordinates_.push_back(btScalar(v[axis]));
    for (const Facet& facet : mesh.triangles) corners_.insert(corners_.end(), facet.begin(), facet.end());
    btIndexedMesh part;
    part.m_numTriangles = int(mesh.triangles.size());
    part.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(corners_.data());
    part.m_triangleIndexStride = 3 * sizeof(int);
    part.m_numVertices = int(mesh.vertices.size());
    part.m_vertexBase = reinterpret_cast<const unsigned char*>(coordinates_.data());
    part.m_vertexStride = 3 * sizeof(btScalar);
    part.m_vertexType = sizeof(btScalar) == sizeof(double) ? PHY_DOUBLE : PHY_FLOAT;
    part.m_indexType = PHY_INTEGER;
    triangles_.addIndexedMesh(part, PHY_INTEGER);
    shape_ = std::make_unique<btGImpactMeshShape>(&triangles_);
    shape_->setMargin(margin);
    shape_->updateBound();
  }

  btCollisionShape& shape() { return *shape_; }

  /// Without it the dispatcher finds an algorithm that answers nothing.
  static void register_with(btCollisionDispatcher& dispatcher) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
  }

 private:
  std::vector<btScalar> coordinates_;
  std::vector<int> corners_;
  btTriangleIndexVertexArray triangles_;
  std::unique_ptr<btGImpactMeshShape> shape_;
};

}  // namespace
}  // namespace peers

COLLISION_EXPORT const collision_table* collision_plugin() {
  static const collision_knob knobs[] = {peers::margin_knob("around each triangle; Bullet's own default is 0.01")};
  return peers::table<peers::Bullet<peers::Surface>>({.name = BULLET_NAME("bullet_gimpact"),
                                                      .what = "Bullet, GImpact: hierarchies of boxes and triangles",
                                                      .precision = peers::kBulletPrecision,
                                                      .knobs = knobs});
}
