// Bodies whose every vertex is placed: the form of the decision that needs no bound on any rounding.
//
// All boxes are the least and greatest of the very doubles that the truth is defined by: they reject only what is
// apart. Slow, and used where the margins of geometry/decision/frames.hpp are no use (bodies far from the origin in
// units of their size, denormals, the ends of the range of doubles) and for containment.
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/decision/contain.hpp"
#include "geometry/decision/frames.hpp"

namespace geometry {

/// A body's world vertices and the boxes of its hierarchy's nodes.
class Placed {
 public:
  /// Places the body, unless it is the mesh at the very pose that was placed last.
  void place(const Body& body);

  /// Places anew the next time.
  void forget() { mesh_ = nullptr; }

  std::span<const Vec3> world() const { return world_; }
  std::span<const Box> boxes() const { return boxes_; }

 private:
  const Mesh* mesh_ = nullptr;
  Mat3 r_ = Mat3::Zero();
  Vec3 t_ = Vec3::Zero();
  std::vector<Vec3> world_;  // #vertices
  std::vector<Box> boxes_;   // #nodes
};

/// Pairs of nodes of two hierarchies.
using NodePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Whether two placed bodies meet: descends both hierarchies at once, deepest overlap first. Counts the pairs of nodes
/// and of triangles into `operations`.
bool placed_meet(const Body& a, const Placed& a_placed, const Body& b, const Placed& b_placed, NodePairs& stack,
                 std::uint64_t& operations);

/// Whether the box of a lies in that of b: it does when a lies inside b.
bool placed_nested(const Placed& a_placed, const Placed& b_placed);

/// Whether a lies inside b, which is closed; their surfaces share no point.
bool placed_inside(const Solid& a_solid, const Placed& a_placed, const Body& b, const Placed& b_placed);

}  // namespace geometry
