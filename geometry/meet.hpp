// Truth: which bodies meet.
//
// Two bodies meet when some triangle of one meets some triangle of the other, triangles being closed sets: touching
// counts. The answer is exact for the world vertices as rounded by to_world. A body wholly inside another has no
// crossing triangles and does not meet it.
#pragma once
#include <cstdint>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/bvh.hpp"
#include "geometry/contain.hpp"
#include "geometry/exact.hpp"

namespace geometry {

/// A facet in the world.
struct PlacedFacet {
  Triangle triangle;
  Box box;
};

/// Pairs of nodes of two hierarchies.
using NodePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Decides a step. Holds the hierarchies' scratch memory: one object per thread. Answers do not depend on what was
/// asked before.
class Decision {
 public:
  /// `bodies`, `bvhs` and `solids` (one per distinct mesh) must outlive this object. `solids` are needed for
  /// containment only.
  Decision(const Bodies& bodies, std::span<const Bvh> bvhs, std::span<const Solid> solids = {});

  /// The pairs among `runs` that meet, sorted. `poses` has one pose per body; those of bodies in no run are not read.
  /// When `contained` is given it becomes the sorted pairs of which one body is contained in the other
  /// (geometry/contain.hpp): none of them meets. All meshes must then be closed.
  std::vector<Pair> hits(std::span<const Pose> poses, std::span<const PairRun> runs,
                         std::vector<Pair>* contained = nullptr);

  /// The same for one pair alone.
  bool meet(std::span<const Pose> poses, Pair pair);

 private:
  /// A body in the world. Fixed bodies stay placed while their pose keeps its bits; the others only while they can
  /// still meet a body, and then leave their memory to the next.
  struct Placed {
    Pose pose;
    std::vector<Vec3> world;  // #vertices
    std::vector<Box> boxes;   // #nodes
  };

  const Placed& place(std::span<const Pose> poses, std::uint32_t body);
  void release(std::uint32_t body);
  Box world_box(std::span<const Pose> poses, std::uint32_t body);
  bool meet_placed(std::uint32_t a, const Placed& a_placed, std::uint32_t b, const Placed& b_placed);
  bool is_contained(std::uint32_t a, const Placed& a_placed, std::uint32_t b, const Placed& b_placed) const;

  const Bodies& bodies_;
  std::span<const Bvh> bvhs_;
  std::span<const Solid> solids_;
  std::deque<Placed> placed_;        // references stay valid while it grows
  std::vector<std::uint32_t> free_;  // indices into placed_
  std::vector<std::uint32_t> slot_;  // #bodies, index into placed_ or kNone
  std::vector<Vec3> scratch_;
  NodePairs stack_;
  std::vector<PlacedFacet> a_cap_, b_cap_;
};

std::vector<Bvh> build_bvhs(const Bodies& bodies);

}  // namespace geometry
