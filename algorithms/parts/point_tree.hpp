// A tree of boxes over points that never move in their own frame: made once per mesh, asked at every step.
//
// Cut at the middle of the longest axis by number, so it is balanced whatever the points are: equal, on a line, or far
// apart. Which points share a leaf depends on the points alone, not on the machine.
#pragma once
#include <cstdint>
#include <vector>

#include "algorithms/parts/facets.hpp"

namespace geometry {

struct PointTree {
  static constexpr std::uint32_t kLeaf = 16;  // 8, 16 and 32 cost the same on the falling scene

  struct Node {
    Box box;                   // of its points, mesh frame
    std::uint32_t first = 0;   // of its points
    std::uint32_t size = 0;    // how many, without padding; at most kLeaf in a leaf
    std::uint32_t second = 0;  // its second child, 0 in a leaf; the first child is the next node
  };

  static std::size_t leaf_count(std::size_t points) { return (points + kLeaf - 1) / kLeaf; }

  /// Bytes of a tree of that many points.
  static std::uint64_t bytes(std::size_t points) {
    const std::uint64_t leaves = leaf_count(points);
    return leaves * (kLeaf * sizeof(Vec3) + 2 * sizeof(Node));
  }

  PointTree() = default;

  /// The points must be finite, at most 2^31.
  explicit PointTree(const Points& from);

  Points points;            // leaf by leaf, kLeaf each; the last leaf is filled up with NaN, which is near nothing
  std::vector<Node> nodes;  // the root first; none for no points
};

}  // namespace geometry
