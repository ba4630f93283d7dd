// The result file: HDF5, laid out as README's "The file" says. The only place, with h5.hpp, that knows HDF5.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "pipeline/result.hpp"
#include "pipeline/target.hpp"

namespace pipeline {

/// Grows when a name, unit or meaning in the file changes. A newer one is refused.
constexpr int kSchemaVersion = 1;

/// Writes the whole result at its place. Fills in `result.digest`. Throws Error(kFile).
void write_result(Result& result, Target& target);

/// Writes a result at once; an existing file is replaced.
void write_result(Result& result, const std::filesystem::path& path);

/// Reads a whole result. Throws Error(kFile) when the file is missing, not HDF5, not ours, truncated, damaged (its
/// content does not have its digest) or newer.
Result read_result(const std::filesystem::path& path);

/// The digests of a result: "/motion", "/truth", "/answers/<label>" and "/" (README, "The digest").
std::map<std::string, std::string> digests(const Result& result);

}  // namespace pipeline
