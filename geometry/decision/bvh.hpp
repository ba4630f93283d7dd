// A bounding-volume hierarchy over the facets of a mesh, built once in the mesh's own frame.
//
// Every node has an oriented box (S. Gottschalk, M. Lin, D. Manocha, "OBBTree: a hierarchical structure for rapid
// interference detection", 1996) in single precision, rounded outward: it serves to reject, with the margins that
// geometry/decision/frames.hpp proves. For bodies to which these margins are no use, refit() gives every node the box
// of the very world vertices: no inflation, nothing to prove.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/mesh.hpp"

namespace geometry {

struct Bvh {
  /// A leaf holds facets order[first] ... order[first + count - 1]; an inner node has count 0, its children are
  /// the next node and node `second`.
  struct Node {
    std::uint32_t first = 0, count = 0, second = 0;
  };
  /// An oriented box around the vertices v of a node, in the mesh's frame: |axis k . (v - centre)| <= half[k], where
  /// axis k is (row[0][k], row[1][k], row[2][k]) and row[i][3] is coordinate i of the centre. The axes are orthonormal
  /// to rounding. half[3] is the sum of the other three. One line of the processor's cache.
  struct alignas(64) Bound {
    float row[3][4] = {};
    float half[4] = {};
  };
  static constexpr std::uint32_t kLeafSize = 2;   // facets at most; measured: tests/benchmarks/truth_bench.cpp
  static constexpr std::size_t kMostDepth = 128;  // no path from the root is longer, whatever the mesh
  std::vector<Node> nodes;                        // node 0 is the root; children come after their parent
  std::vector<Bound> bounds;                      // #nodes
  std::vector<std::uint32_t> order;               // #facets, a permutation
};

Bvh build_bvh(const Mesh& mesh);

/// Bytes of the hierarchy of that many facets, about: 1.4 nodes a facet (measured: 1.3 to 1.5). While it is built about
/// kBuildingBvh times as many.
inline std::uint64_t bvh_bytes(std::uint64_t facets) {
  return facets * (14 * (sizeof(Bvh::Node) + sizeof(Bvh::Bound)) / 10 + sizeof(std::uint32_t));
}
constexpr double kBuildingBvh = 2.5;

/// The box of every node for these world vertices. `boxes` has the size of `bvh.nodes`.
void refit(const Bvh& bvh, const Mesh& mesh, std::span<const Vec3> world, std::span<Box> boxes);

}  // namespace geometry
