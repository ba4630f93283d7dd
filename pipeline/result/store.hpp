// The result file: HDF5, laid out as pipeline/FILE.md says. What knows HDF5 is in pipeline/result/hdf5/.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "pipeline/result/layout.hpp"
#include "pipeline/result/output_file.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

/// The attribute of the root that says that there is a seal (seal.hpp).
constexpr char kSealed[] = "sealed";

/// Writes the whole result at its place. Fills in `result.digest`. Throws Error(kFile).
void write_result(Result& result, OutputFile& target);

/// Writes a result at once; an existing file is replaced.
void write_result(Result& result, const std::filesystem::path& path);

/// Reads a whole result, which may be anybody's: its seal and its digests hold before anything is returned, and a child
/// process reads it first. Throws Error(kFile) when the file is missing, not regular, not HDF5, not ours, truncated,
/// damaged or newer. With `unsealed` a seal that is missing or does not hold is said on stderr, digests are compared
/// all the same; so are files from before there were seals. To be called while this process has one thread.
Result read_result(const std::filesystem::path& path, bool unsealed = false);

/// What the child process of read_result does, in this one and whatever the seal; without `compare_digests` as if
/// somebody had made digests that hold. For tests/fuzz.
Result read_unguarded(const std::filesystem::path& path, bool compare_digests);

/// The digests of a result: "/motion", "/truth", "/answers/<label>" and "/" (pipeline/result/digest.hpp).
std::map<std::string, std::string> digests(const Result& result);

}  // namespace pipeline
