// A bounding-volume hierarchy over the facets of a mesh, built once in the mesh's own frame.
//
// Its boxes are filled in per pose from the world vertices themselves (refit), so that a box holds exactly the
// doubles the truth is defined by: no inflation, nothing to prove. Only the tree's shape comes from the local frame.
#pragma once
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
  std::vector<Node> nodes;           // node 0 is the root; children come after their parent
  std::vector<std::uint32_t> order;  // #facets, a permutation
};

Bvh build_bvh(const Mesh& mesh);

/// The box of every node for these world vertices. `boxes` has the size of `bvh.nodes`.
void refit(const Bvh& bvh, const Mesh& mesh, std::span<const Vec3> world, std::span<Box> boxes);

}  // namespace geometry
