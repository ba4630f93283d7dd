// What algorithms test in place of meshes, and how far the meshes stick out of it.
#pragma once
#include <optional>
#include <vector>

#include "pipeline/result/products/proxies.hpp"
#include "pipeline/stages/choice.hpp"

namespace pipeline {

/// Of every choice that tests something in place of meshes, made anew: the same bits as its method has.
Proxies proxies_of(const geometry::Bodies& bodies, const std::vector<AlgorithmChoice>& choices);

/// The solids of a row, one by one.
std::vector<geometry::Mesh> solids_of(const MeshProxy& row);

/// Binds a choice of files to the solids that a result holds under its label; false when it has none.
bool bind_recorded(AlgorithmChoice& choice, const Proxies& recorded);

}  // namespace pipeline
