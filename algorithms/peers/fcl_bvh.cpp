// The only file that sees FCL.
#include "algorithms/peers/fcl_bvh.hpp"

#ifdef PEER_VERSION  // CMakeLists.txt found it
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/traversal/collision/mesh_collision_traversal_node.h>
#include <fcl/narrowphase/detail/traversal/collision_node.h>

#include <algorithm>
#include <utility>

#include "geometry/decision/broad_phase.hpp"

namespace algorithms {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSS<double>>;
using Transform = fcl::Transform3<double>;
using geometry::Vec3;

std::unique_ptr<Model> model_of(const geometry::Mesh& mesh) {
  auto model = std::make_unique<Model>();
  std::vector<fcl::Triangle> triangles;
  for (const geometry::Facet& facet : mesh.triangles) triangles.emplace_back(facet[0], facet[1], facet[2]);
  const bool built =
      model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size())) == fcl::BVH_OK &&
      model->addSubModel(mesh.vertices, triangles) == fcl::BVH_OK && model->endModel() == fcl::BVH_OK;
  if (!built) throw std::invalid_argument("FCL cannot build a hierarchy of mesh '" + mesh.name + "'; leave it out");
  return model;
}

class FclBvh final : public Method {
 public:
  FclBvh(const Bodies& bodies, const Knobs&) : bodies_(bodies), transforms_(bodies.size()), broad_phase_(bodies) {
    for (const geometry::Mesh& mesh : bodies.meshes) models_.push_back(model_of(mesh));
  }

  static Memory memory(const Bodies& bodies, const Knobs&) {
    std::uint64_t held = bodies.size() * sizeof(Transform) + geometry::broad_phase_bytes(bodies), greatest = held;
    for (const geometry::Mesh& mesh : bodies.meshes) {
      // Two nodes a facet but one, with an oriented box and a swept sphere; facets as three size_t and their order.
      const std::uint64_t facets = mesh.triangles.size(), vertices = sizeof(Vec3) * mesh.vertices.size();
      const std::uint64_t kept =
          facets * (2 * sizeof(fcl::BVNode<fcl::OBBRSS<double>>) + sizeof(fcl::Triangle) + sizeof(unsigned int)) +
          vertices;
      greatest = std::max(greatest, held + kept + 2 * facets * sizeof(fcl::Triangle) + vertices);
      held += kept;
    }
    return {held, greatest};
  }

  void prepare(std::span<const Pose> poses, double /*enlarge*/) override {
    broad_phase_.prepare(poses);
    for (std::size_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;
      transforms_[body].linear() = geometry::rotation(poses[body].q);
      transforms_[body].translation() = poses[body].t;
    }
  }

  void answer(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    const fcl::CollisionRequest<double> one_contact;
    broad_phase_.pairs(runs, near_);
    for (const Pair& pair : near_) {
      result_.clear();
      if (fcl::collide(&model(pair.a), transforms_[pair.a], &model(pair.b), transforms_[pair.b], one_contact, result_))
        hits.push_back(pair);
    }
  }

  /// By the traversal that fcl::collide makes, with its counters on.
  std::uint64_t count(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    const fcl::CollisionRequest<double> one_contact;
    std::uint64_t tests = 0;
    broad_phase_.pairs(runs, near_);
    for (const Pair& pair : near_) {
      result_.clear();
      fcl::detail::MeshCollisionTraversalNodeOBBRSS<double> node;
      fcl::detail::initialize(node, model(pair.a), std::as_const(transforms_[pair.a]), model(pair.b),
                              std::as_const(transforms_[pair.b]), one_contact, result_);
      node.enable_statistics = true;
      fcl::detail::collide(&node);
      tests += 1 + static_cast<std::uint64_t>(node.num_bv_tests) + static_cast<std::uint64_t>(node.num_leaf_tests);
      if (result_.isCollision()) hits.push_back(pair);
    }
    return tests;
  }

 private:
  const Model& model(std::uint32_t body) const { return *models_[bodies_.mesh[body]]; }

  const Bodies& bodies_;
  std::vector<std::unique_ptr<Model>> models_;  // one per distinct mesh
  std::vector<Transform> transforms_;           // of the step, one per body
  geometry::BroadPhase broad_phase_;
  std::vector<Pair> near_;
  fcl::CollisionResult<double> result_;
};

}  // namespace
}  // namespace algorithms
#endif

namespace algorithms {

Algorithm fcl_bvh() {
  Algorithm row{.name = "fcl_bvh",
                .what = "FCL 0.7, hierarchies of oriented boxes (BVHModel<OBBRSS>), behind the broad phase of exact",
                .operations_unit = "pairs of boxes and triangles that FCL tests",
                .promise = Promise::none,
                .scope = Scope::scene,
                .library = {.name = "FCL", .package = "libfcl-dev"}};
#ifdef PEER_VERSION
  row.library.version = PEER_VERSION;
  row.make = [](const Bodies& bodies, const Knobs& knobs) -> std::unique_ptr<Method> {
    return std::make_unique<FclBvh>(bodies, knobs);
  };
  row.memory = FclBvh::memory;
#endif
  return row;
}

}  // namespace algorithms
