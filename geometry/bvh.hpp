// A bounding-volume hierarchy over the facets of a mesh, built once in the mesh's own frame.
//
// Every node has a box and a slab across its mean normal, which is thin where the surface is smooth. Both are single
// precision, rounded outward: they serve to reject, with the margins that geometry/frames.hpp proves. For bodies to
// which these margins are no use, refit() gives every node the box of the very world vertices: no inflation, nothing to
// prove.
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
  /// Around the vertices v of a node, in the mesh's frame: |v - centre| <= half per coordinate, and |normal . v -
  /// middle| <= thickness. The normal is unit to rounding, or 0. Four lanes each, as the tests load them.
  struct alignas(16) Bound {
    float centre[3] = {}, middle = 0;
    float half[3] = {}, thickness = 0;
    float normal[3] = {}, unused = 0;
  };
  static constexpr std::uint32_t kLeafSize = 2;   // facets at most; measured: tests/benchmarks/truth_bench.cpp
  static constexpr std::size_t kMostDepth = 128;  // no path from the root is longer, whatever the mesh
  std::vector<Node> nodes;                        // node 0 is the root; children come after their parent
  std::vector<Bound> bounds;                      // #nodes
  std::vector<std::uint32_t> order;               // #facets, a permutation
};

Bvh build_bvh(const Mesh& mesh);

/// The box of every node for these world vertices. `boxes` has the size of `bvh.nodes`.
void refit(const Bvh& bvh, const Mesh& mesh, std::span<const Vec3> world, std::span<Box> boxes);

}  // namespace geometry
