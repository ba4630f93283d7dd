// Solid against solid, exactly: some solid of one body shares a point with some solid of the other.
//
// By the project's own decision: two closed surfaces meet, or one lies wholly inside the other. Exact for the solids'
// world vertices as rounded by to_world. Each solid is asked by itself, so that where two of one body overlap is
// inside.
#pragma once
#include <memory>
#include <vector>

#include "algorithms/contract/proxy_files.hpp"

namespace algorithms {

/// The solids of each distinct mesh of `bodies`, each one connected closed surface; an open one is its surface alone.
std::unique_ptr<Method> make_solids(const Bodies& bodies, const std::vector<std::vector<geometry::Mesh>>& solids);

Memory solids_memory(const Bodies& bodies, const std::vector<std::vector<geometry::Mesh>>& solids);

/// The mesh's connected surfaces by the numbers of its vertices; open or not.
std::vector<geometry::Mesh> components(const geometry::Mesh& mesh);

}  // namespace algorithms
