// Which bodies can meet at all: boxes that certainly hold every world vertex, and the pairs whose boxes touch.
//
// A box is made from the pose and four facts of the mesh, no vertex is placed. The pairs are found by a sweep along one
// axis inside strips that the other two axes are halved into: O(n log n + pairs) for bodies of like size, and a body
// that spans many others costs one place in every strip it crosses.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/box.hpp"

namespace geometry {

/// What bounds a mesh whatever its pose. Every vertex v satisfies the three, exactly.
struct Enclosure {
  Vec3 centre = Vec3::Zero(), half = Vec3::Zero();  // |v - centre| <= half, per coordinate
  double radius = 0;                                // |v - centre| <= radius
  double reach = 0;                                 // |v| <= reach
};

Enclosure enclosure(const Mesh& mesh);

/// A body at a step.
struct Placement {
  Mat3 r;         // rotation(q)
  Vec3 t;         // of the pose
  Vec3 middle;    // to_world of the enclosure's centre
  double length;  // at least |t|
  bool rigid;     // |r v| <= (1 + kDefect) |v| for every v, and r^T r = 1 + E with |E| <= kDefect
  bool born;
};

/// How far the rotation made of a quaternion within 1e-15 of unit can be from orthonormal: (9) of the source.
constexpr double kDefect = 0x1p-46;

/// The box that holds every world vertex of a body, as rounded by to_world. The whole space where a bound overflows.
Box world_box(const Enclosure& mesh, const Placement& at);

/// The placement of a pose. NaN throughout for a body that is not born.
Placement placement(const Enclosure& mesh, const Pose& pose);

/// Bytes of a BroadPhase, about: of a body its placement, its box, its places in the sweep and about two near pairs.
inline std::uint64_t broad_phase_bytes(const Bodies& bodies) {
  constexpr std::uint64_t kSweep = 160;
  return bodies.size() * (sizeof(Placement) + sizeof(Box) + kSweep) + bodies.meshes.size() * sizeof(Enclosure);
}

/// Boxes and near pairs of one step after another. What it keeps from the step before makes it faster and decides
/// nothing. No allocation once the vectors have grown.
class BroadPhase {
 public:
  /// `bodies` must outlive this object; their number and meshes stay.
  explicit BroadPhase(const Bodies& bodies);

  /// Places all bodies: one pose each. Bodies that are not born have no box.
  void prepare(std::span<const Pose> poses);

  /// The pairs among `runs` whose boxes touch, sorted, in place of what `out` held.
  void pairs(std::span<const PairRun> runs, std::vector<Pair>& out);

  // Of the step prepared last:
  const Placement& at(std::uint32_t body) const { return at_[body]; }
  const Box& box(std::uint32_t body) const { return box_[body]; }
  const Enclosure& mesh_of(std::uint32_t body) const { return enclosures_[bodies_.mesh[body]]; }
  std::uint64_t comparisons() const { return comparisons_; }  // of two boxes, by the last pairs()

 private:
  /// Places in the sweep's order with the region of the two other axes that a set answers for.
  struct Region {
    std::array<double, 2> low, high;
  };
  void sort_along(int axis);
  void halve(std::size_t first, std::size_t last, const Region& region);
  void sweep(std::size_t first, std::size_t last, const Region& region);
  void sort_found(std::vector<Pair>& out);

  const Bodies& bodies_;
  std::vector<Enclosure> enclosures_;  // #meshes
  std::vector<Placement> at_;          // #bodies
  std::vector<Box> box_;               // #bodies

  int axis_ = 0;                                   // of the sweep
  std::vector<std::uint32_t> order_;               // born bodies, ascending along the axis
  std::vector<double> key_;                        // #order
  std::vector<std::uint32_t> sets_;                // a stack of sets of places in `order_`, each ascending
  std::array<std::vector<double>, 3> low_, high_;  // #set: columns of the boxes in one set
  std::vector<std::uint32_t> who_;                 // #set: their bodies
  std::vector<std::int64_t> touch_;                // #set
  std::vector<Pair> found_, by_b_;
  std::vector<std::uint32_t> begin_;  // #bodies + 1
  std::uint64_t comparisons_ = 0;
};

}  // namespace geometry
