// ode_trimesh: the Open Dynamics Engine's triangle meshes.
//
// Source  ODE 0.16, dCollide of two dTriMesh with CONTACTS_UNIMPORTANT (one contact is enough); OPCODE's trees of
// boxes. Cost    The broad phase of `exact`; then per near pair a descent of two trees and tests of triangles. Misses
// Bodies that only just touch: depths below about 1e-7 m. Bodies wholly inside others. Extra   Bodies that nearly
// touch.
#include <ode/ode.h>

#include "algorithms/peers/libraries/peer.hpp"

namespace peers {
namespace {

// ODE answers nothing for two geoms of one body, and nothing for a geom with itself: each body has its own of both, and
// only the data of meshes are shared. Its globals are not safe among threads: one process is one engine.
class Ode {
 public:
  /// `bodies` must outlive it: ODE keeps pointers to vertices and triangles.
  Ode(const Bodies& bodies, const collision_value*) {
    if (!dInitODE2(0)) throw std::runtime_error("ODE does not start");
    world_ = dWorldCreate();
    for (const Mesh& mesh : bodies.meshes) {
      data_.push_back(dGeomTriMeshDataCreate());
      dGeomTriMeshDataBuildDouble(data_.back(), mesh.vertices.data(), sizeof(Vec3), int(mesh.vertices.size()),
                                  mesh.triangles.data(), int(3 * mesh.triangles.size()), sizeof(Facet));
    }
    for (const std::uint32_t mesh : bodies.mesh) {
      geoms_.push_back(dCreateTriMesh(nullptr, data_[mesh], nullptr, nullptr, nullptr));
      dGeomSetBody(geoms_.back(), dBodyCreate(world_));
    }
  }

  ~Ode() {
    for (dGeomID geom : geoms_) dGeomDestroy(geom);
    for (dTriMeshDataID data : data_) dGeomTriMeshDataDestroy(data);
    dWorldDestroy(world_);
    dCloseODE();
  }

  Ode(const Ode&) = delete;
  Ode& operator=(const Ode&) = delete;

  static double margin(const collision_value*) { return 0; }

  void place(std::uint32_t body, const Pose& pose) {
    const geometry::Mat3 r = geometry::rotation(pose.q);
    const dMatrix3 rows = {r(0, 0), r(0, 1), r(0, 2), 0, r(1, 0), r(1, 1), r(1, 2), 0, r(2, 0), r(2, 1), r(2, 2), 0};
    dGeomSetRotation(geoms_[body], rows);
    dGeomSetPosition(geoms_[body], pose.t.x(), pose.t.y(), pose.t.z());
  }

  bool meet(std::uint32_t a, std::uint32_t b) {
    dContactGeom contact;
    return dCollide(geoms_[a], geoms_[b], 1 | int(CONTACTS_UNIMPORTANT), &contact, sizeof contact) > 0;
  }

 private:
  dWorldID world_;
  std::vector<dTriMeshDataID> data_;
  std::vector<dGeomID> geoms_;
};

}  // namespace
}  // namespace peers

COLLISION_EXPORT const collision_table* collision_plugin() {
  return peers::table<peers::Ode>(
      {.name = "ode_trimesh",
       .what = "Open Dynamics Engine: hierarchies of boxes and triangles, one contact asked for",
       .precision = "double"});
}
