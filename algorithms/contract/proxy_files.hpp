// Meshes from files in place of a scene's: how the row `proxy` (beyond/proxy.hpp) gets them.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

/// The connected closed surfaces of a mesh: by the numbers of its vertices or, where some is open then, by their
/// coordinates. Throws std::invalid_argument that names an open edge.
std::vector<geometry::Mesh> closed_components(const geometry::Mesh& mesh, double closed_within);

/// The facets with those vertices alone that they have, in their order.
geometry::Mesh without_unused(const geometry::Mesh& mesh);

/// The row `proxy` with the closed components of each mesh, by its name. Its `make` throws std::invalid_argument for a
/// mesh that has none, and for a name that no mesh has.
Algorithm proxy_of(std::map<std::string, std::vector<geometry::Mesh>> solids);

}  // namespace algorithms
