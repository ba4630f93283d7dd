// simbody_mesh: Simbody's contact of triangle meshes.
//
// Source  Simbody 3.7, CollisionDetectionAlgorithm::TriangleMeshTriangleMesh: trees of oriented boxes, then every pair
//         of triangles that crosses.
// Cost    The broad phase of `exact`; then per near pair a descent of two trees to all crossings, and the triangles
//         inside the other body. Trees are slow to make.
// Misses  Bodies that graze, as its tolerances fall. Bodies wholly inside others.
// Extra   Bodies that nearly touch. Meshes must be closed and connected manifolds.
#include "algorithms/peers/libraries/peer.hpp"
#include "algorithms/peers/libraries/simbody_meshes.hpp"

namespace peers {
namespace {

class Simbody {
 public:
  Simbody(const Bodies& bodies, const collision_value*) : bodies_(bodies), places_(bodies.size()) {
    for (const Mesh& mesh : bodies.meshes)
      meshes_.add(mesh.vertices.front().data(), mesh.vertices.size(), mesh.triangles.front().data(),
                  mesh.triangles.size());
  }

  static double margin(const collision_value*) { return 0; }

  void place(std::uint32_t body, const Pose& pose) { places_[body] = {geometry::rotation(pose.q), pose.t}; }

  bool meet(std::uint32_t a, std::uint32_t b) {
    return meshes_.meet(bodies_.mesh[a], places_[a].rows.data(), places_[a].t.data(), bodies_.mesh[b],
                        places_[b].rows.data(), places_[b].t.data());
  }

 private:
  struct Place {
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows;
    Vec3 t;
  };

  const Bodies& bodies_;
  SimbodyMeshes meshes_;
  std::vector<Place> places_;
};

}  // namespace
}  // namespace peers

COLLISION_EXPORT const collision_table* collision_plugin() {
  return peers::table<peers::Simbody>(
      {.name = "simbody_mesh",
       .what = "Simbody: hierarchies of oriented boxes and triangles, every crossing sought",
       .precision = "double"});
}
