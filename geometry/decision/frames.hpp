// Two bodies seen from each other's frame: what certainly separates their world vertices, without placing any.
//
// Everything here only ever rejects, and by margins that cover every rounding: of the world vertices themselves, of the
// matrices that are no exact rotations, and of the tests. The margins are proved in the source.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/decision/broad_phase.hpp"
#include "geometry/decision/bvh.hpp"
#include "geometry/decision/exact.hpp"

namespace geometry {

/// A mesh at a place.
struct Body {
  const Mesh& mesh;
  const Bvh& bvh;
  const Enclosure& around;
  const Placement& at;

  /// A facet of the mesh in the world: the doubles that the truth is defined by.
  Triangle facet(std::uint32_t f) const {
    const auto& [i, j, k] = mesh.triangles[f];
    return {to_world(at.r, at.t, mesh.vertices[i]), to_world(at.r, at.t, mesh.vertices[j]),
            to_world(at.r, at.t, mesh.vertices[k])};
  }
};

/// By how much two bodies must be apart for tests in doubles and in floats to be sure of it.
struct Margin {
  double fine = 0;      // m
  float coarse = 0;     // m, in the frame of either body
  bool useful = false;  // false: the bounds hold for other pairs only, or would reject nothing; ask another way
};

Margin margin(const Body& a, const Body& b);

/// True when the bounding spheres are certainly apart.
bool spheres_apart(const Body& a, const Body& b, const Margin& margin);

/// The vertex farthest along a direction of the mesh's frame.
struct Support {
  double dot;            // direction . vertex, as computed
  std::uint32_t vertex;  // index into the mesh's vertices
};

/// The greatest dot product of `direction`, no longer than 1 + 2^-20, with a vertex, exactly the greatest of those
/// computed. Of a mesh whose margin is useful. Adds the nodes visited to `operations`.
Support support(const Body& body, const Vec3& direction, std::uint64_t& operations);

/// What lies along a direction of the world, no longer than 1 + 2^-20: a's top and b's bottom.
struct Slab {
  double gap;     // how far b's bottom is above a's top along the direction, as computed
  Vec3 from, to;  // world: a's farthest point along the direction and b's farthest against it, rounded
  bool apart;     // certainly
};

Slab find_slab(const Body& a, const Body& b, const Vec3& direction, const Margin& margin, std::uint64_t& operations);

/// A node of either body's hierarchy.
struct NodePair {
  std::uint32_t a, b;
};

/// Body b seen from a's frame, for tests of nodes against nodes. The bodies' hierarchies must outlive it.
class Relative {
 public:
  Relative(const Body& a, const Body& b, const Margin& margin);

  /// Of two pairs of nodes at once, each: negative when no world vertex of a facet in node `a` can be where one of a
  /// facet in node `b` is, nor their hulls touch: the two are certainly apart. Else how deep they overlap where they do
  /// least, metres: a guess at how likely they meet.
  std::array<float, 2> overlap(const std::array<NodePair, 2>& pairs) const;

 private:
  const Bvh::Bound *a_, *b_;
  float c_[3][3];    // C = R_a^T R_b
  float offset_[3];  // T = R_a^T (t_b - t_a)
  float margin_;
};

}  // namespace geometry
