// Built-in shapes as a configuration writes them: `shape` and its parameters, checked; and the way back to TOML.
//
//   shape = "box"         size = [x, y, z]
//   shape = "sphere"      radius, segments (32)
//   shape = "capsule"     height, radius or radius_bottom and radius_top, segments (8)
//   shape = "torus"       diameter, thickness, segments (16)
//   shape = "torus_knot"  radius, tube, radial_segments (32), tubular_segments (32), p (2), q (3)
//
// Lengths in metres, as geometry/meshes/shapes.hpp means them. Presets in parentheses are Babylon.js's, with which the
// thesis made its scenes; a capsule has 440 facets where Babylon.js's preset has 416 (its caps are cut otherwise: 16
// columns and 6 bands a cap there, 20 columns and 5 bands here).
#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "geometry/mesh.hpp"
#include "pipeline/scene/document.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {

struct BoxShape {
  geometry::Vec3 size = geometry::Vec3::Zero();
};
struct SphereShape {
  double radius = 0;
  std::int64_t segments = 32;
};
struct CapsuleShape {
  double height = 0, radius_bottom = 0, radius_top = 0;
  std::int64_t segments = 8;
};
struct TorusShape {
  double diameter = 0, thickness = 0;
  std::int64_t segments = 16;
};
struct TorusKnotShape {
  double radius = 0, tube = 0;
  std::int64_t radial_segments = 32, tubular_segments = 32, p = 2, q = 3;
};
using Shape = std::variant<BoxShape, SphereShape, CapsuleShape, TorusShape, TorusKnotShape>;

/// Reads `shape` and its parameters. Any other key of the section must be among `others`. Throws Error(kInput) with the
/// place for a missing, unknown or wrong key, and for a parameter that leaves no body (a size of zero, a capsule whose
/// one cap holds the other, a torus without a hole, p and q with a common factor).
Shape read_shape(const Section& section, const std::vector<std::string>& others = {});

/// The keys with their values; reading them gives `shape`.
void write_shape(const Shape& shape, TomlText& out);

geometry::Mesh make_mesh(const Shape& shape, const std::string& name);

/// Vertices and triangles of make_mesh, without making it.
struct MeshSize {
  std::uint64_t vertices = 0, triangles = 0;
};
MeshSize mesh_size(const Shape& shape);

}  // namespace pipeline
