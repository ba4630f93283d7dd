// The facts about a mesh that need exact arithmetic; apart from mesh.cpp so that whoever wants only a mesh does not
// link CGAL's kernel.
#include <algorithm>

#include "geometry/decision/exact.hpp"
#include "geometry/mesh.hpp"

namespace geometry {

std::size_t degenerate_facets(const Mesh& mesh) {
  return std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Facet& f) {
    return is_degenerate({mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]});
  });
}

}  // namespace geometry
