// proxy: people's own solids in place of the meshes, from files: solid against solid, decided exactly.
//
// Source  Hulls of V-HACD or CoACD, simplified meshes, hand-made ones: one or more closed components a file.
// Cost    That of `exact` on the proxies, every component a body: with a broad phase and a memory of its own.
// Misses  What lies outside the proxies: how much of a mesh does is measured (/meshes/<mesh>/proxies). Where they wrap
// it,
//         facets included, nothing that meets. Touching is a hit.
// Extra   What lies in the proxies and outside the meshes. A body inside another is a hit: proxies are solid. A
// component
//         inside another of one file is no cavity: the solids of a file are taken together.
#pragma once
#include "algorithms/contract/proxy_files.hpp"

namespace algorithms {

/// The row without files: every mesh is its own proxy, component by component; of an open one only the surface counts.
Algorithm proxy();

}  // namespace algorithms
