// Meshes from files: OBJ, OFF, STL and PLY, the last two as text or binary.
//
// Vertices and triangles are kept as the file has them, in its order: nothing is welded, dropped or turned, because
// facets are counted in file order. Polygons are cut into triangles (geometry/decision/polygon.hpp). Text may begin
// with a byte order mark and end its lines with LF, CR LF or CR; OFF and PLY that do not come out by lines are read by
// words. What the formats hold beside corners (normals, colours, textures) may hold anything. What has no surface
// (faces of fewer than three corners, curves) or is not known (words of a header, what follows the announced elements)
// is left out, and counted.
//
// STL has no shared vertices: there every facet brings three of its own, so that is_closed(), which goes by index, is
// always false for it. That is the truth about the mesh as kept; whether the surface is closed as a set of points,
// which is what containment needs, is asked by coordinates (geometry/decision/contain.hpp).
#pragma once
#include <stdexcept>
#include <string>
#include <string_view>

#include "geometry/mesh.hpp"

namespace geometry {

/// A file that is no mesh; what() is one line, "file:line: ..." or, for binary parts, "file: byte N: ...".
class MeshFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Coordinates beyond this are refused: sums and products with them could overflow. Metres.
constexpr double kGreatestCoordinate = 1e15;

/// The mesh that `bytes` hold, the content of `file`, whose extension (.obj, .off, .stl, .ply, in any case) names the
/// format. `shape` is left empty. `said` becomes what was left out or guessed, and which polygons cross themselves or
/// are far from flat, in one line; empty when nothing is to be said. Throws MeshFileError for what cannot be read, is
/// truncated, has an index out of range, a coordinate that is not finite or too great, or no triangle.
Mesh parse_mesh(std::string_view bytes, const std::string& file, const std::string& name, std::string* said = nullptr);

}  // namespace geometry
