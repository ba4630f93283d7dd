// Truth: which bodies meet.
//
// Two bodies meet when some triangle of one meets some triangle of the other, triangles being closed sets: touching
// counts. The answer is exact for the world vertices as rounded by to_world. A body wholly inside another has no
// crossing triangles and does not meet it.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/decision/broad_phase.hpp"
#include "geometry/decision/bvh.hpp"
#include "geometry/decision/contain.hpp"
#include "geometry/decision/placed.hpp"

namespace geometry {

/// Decides step after step. Holds scratch memory and what the step before taught: one object per thread. What it
/// remembers tells where to look first: it decides how fast an answer comes, never which.
///
///     decision.prepare(poses);
///     decision.hits(runs, hits);
///     decision.remember();
///
/// hits() starts from the memory as last remembered, so that asking twice is the same work.
class Decision {
 public:
  /// `bodies`, `bvhs` and `solids` (one per distinct mesh) must outlive this object. `solids` are needed for
  /// containment only.
  Decision(const Bodies& bodies, std::span<const Bvh> bvhs, std::span<const Solid> solids = {});

  /// The step that hits() is about: one pose per body.
  void prepare(std::span<const Pose> poses);

  /// Appends the pairs among `runs` that meet, sorted, to `out`. When `contained` is given, appends to it the sorted
  /// pairs of which one body is contained in the other (geometry/decision/contain.hpp): none of them meets, and open
  /// meshes hold nothing. No allocation once the vectors have grown.
  void hits(std::span<const PairRun> runs, std::vector<Pair>& out, std::vector<Contained>* contained = nullptr);

  /// Makes what the last hits() learned the memory that the next ones start from.
  void remember() { std::swap(memory_, learned_); }

  /// Empties the memory.
  void forget() { memory_.clear(); }

  /// Elementary tests made by the last hits(): of pairs of bodies, nodes and triangles.
  std::uint64_t operations() const { return operations_; }

  /// One step alone: prepare() and hits(). `contained`, when given, is replaced.
  std::vector<Pair> hits(std::span<const Pose> poses, std::span<const PairRun> runs,
                         std::vector<Contained>* contained = nullptr);

  /// One pair alone, without memory; the poses of other bodies are not read.
  bool meet(std::span<const Pose> poses, Pair pair);

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// What a near pair taught: two facets that met (of the hierarchies' order), or else a direction that separated or
  /// was the best known.
  struct Lesson {
    Pair pair;
    std::uint32_t a_facet = kNone, b_facet = kNone;
    std::array<float, 3> direction{};  // of the world, unit to rounding; 0: none known
  };
  Body body(std::uint32_t body, const Enclosure& around, const Placement& at) const {
    return {bodies_.mesh_of(body), bvhs_[bodies_.mesh[body]], around, at};
  }
  bool decide(const Body& a, const Body& b, const Margin& close, Lesson& lesson);
  bool facets_meet(const Body& a, const Body& b, Lesson& lesson);
  bool separated(const Body& a, const Body& b, const Margin& margin, Lesson& lesson);
  bool descend(const Body& a, const Body& b, const Relative& relative, NodePair from, Lesson& lesson);
  bool leaves_meet(const Body& a, const Body& b, NodePair leaves, Lesson& lesson);
  bool is_contained(const Body& a, std::uint32_t a_index, const Body& b, std::uint32_t b_index);

  const Bodies& bodies_;
  std::span<const Bvh> bvhs_;
  std::span<const Solid> solids_;
  BroadPhase broad_;
  std::vector<Pair> near_;
  std::vector<Lesson> memory_, learned_;  // sorted by pair
  NodePairs placed_stack_;
  std::array<Placed, 3> placed_;  // two bodies, and the closed surface of one
  std::uint64_t operations_ = 0;
};

std::vector<Bvh> build_bvhs(const Bodies& bodies);

/// Bytes of build_bvhs, about; `greatest` while it builds.
struct BvhsBytes {
  std::uint64_t held = 0, greatest = 0;
};
BvhsBytes bvhs_bytes(const Bodies& bodies);

}  // namespace geometry
