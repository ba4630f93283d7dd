// A result as named arrays: the one description of the file's contents, which the writer puts into HDF5 and the digest
// reads from memory.
#pragma once
#include <vector>

#include "pipeline/result/dataset.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

/// Grows when a name, unit or meaning in the file changes. A newer one is refused.
constexpr int kSchemaVersion = 2;

/// Everything that the file holds but the digests, the root first. Points into `result`, which must outlive it.
std::vector<Group> layout(const Result& result);

}  // namespace pipeline
