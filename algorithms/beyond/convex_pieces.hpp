// Convex pieces that together hold a mesh: its facets and, of a closed mesh, its inside.
//
// The box around the mesh is cut into cells by planes, one cut after another; a piece is the hull of what of the mesh
// is in a cell (cells.hpp). Always that piece is cut which holds most that the mesh does not, where the cut leaves the
// least volume of hulls: at planes through vertices where the mesh has few, else at quarters.
//
// Tried beside it: V-HACD is not in Debian 12. HACD (libbullet-extras-dev) takes 2 to 5 s for 1 to 2 thousand facets,
// and weighs its clusters by the C library's `pow`, which is another function on processors with fused multiply-add:
// its pieces would not be the same on every machine. Clusters of whole facets, as HACD has them, cannot cut the large
// facets of a plate.
#pragma once
#include <cstdint>
#include <vector>

#include "geometry/mesh.hpp"

namespace algorithms {

/// The points of each piece, 1 to `count` pieces: its hull is the piece. Every vertex of the mesh is one of them, as it
/// is. Cut on while the pieces hold more than `concavity` of the mesh's volume beyond it; an open mesh, and one whose
/// facets face different ways, has none, so that all its pieces hold is beyond it.
std::vector<std::vector<geometry::Vec3>> convex_pieces(const geometry::Mesh& mesh, std::size_t count, double concavity,
                                                       double closed_within);

}  // namespace algorithms
