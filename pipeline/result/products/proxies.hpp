// What methods test in place of meshes: /proxies, a row per label and mesh, and /meshes/<mesh>/proxies/<label>.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh.hpp"

namespace pipeline {

/// What a label tests in place of a mesh, in the mesh's frame, metres.
struct MeshProxy {
  std::string label, mesh;
  std::string kind = "none";                       // balls, capsule (of two balls and what is between), solids; none
  std::string reason;                              // why there is none
  std::uint64_t parts = 0;                         // balls or solids
  double outside_share = 0, outside_greatest = 0;  // of the mesh's vertices (geometry/decision/wrapping.hpp); none: NaN
  std::vector<geometry::ContactBall> balls;
  std::vector<geometry::Vec3> vertices;  // of all solids, one after another
  std::vector<geometry::Facet> triangles;
  std::vector<std::uint64_t> solid_offset;  // those of solid i are triangles solid_offset[i] to solid_offset[i + 1] - 1
};

/// Label by label in the order of the answers, of each the meshes in theirs.
struct Proxies {
  std::vector<MeshProxy> rows;
};

}  // namespace pipeline
