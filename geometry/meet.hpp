// Truth: which bodies meet.
//
// Two bodies meet when some triangle of one meets some triangle of the other, triangles being closed sets: touching
// counts. The answer is exact for the world vertices as rounded by to_world. A body wholly inside another has no
// crossing triangles and does not meet it.
#pragma once
#include <span>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/bvh.hpp"

namespace geometry {

/// Decides a step. Holds the hierarchies' scratch memory: one object per thread. Answers do not depend on what was
/// asked before.
class Decision {
 public:
  /// `bodies` and `bvhs` (one per distinct mesh) must outlive this object.
  Decision(const Bodies& bodies, std::span<const Bvh> bvhs);

  /// The pairs among `runs` that meet, sorted. `poses` has one pose per body.
  std::vector<Pair> hits(std::span<const Pose> poses, std::span<const PairRun> runs);

  /// The same for one pair alone.
  bool meet(std::span<const Pose> poses, Pair pair);

 private:
  void place(std::span<const Pose> poses, std::uint32_t body);
  bool meet_placed(std::uint32_t a, std::uint32_t b);

  const Bodies& bodies_;
  std::span<const Bvh> bvhs_;
  std::vector<std::vector<Vec3>> world_;  // #bodies x #vertices
  std::vector<std::vector<Box>> boxes_;   // #bodies x #nodes
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack_;
};

std::vector<Bvh> build_bvhs(const Bodies& bodies);

}  // namespace geometry
