// Where a result comes from: build, libraries, machine; and what a reader should be warned of.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/result/result.hpp"

namespace pipeline {

/// "0.1.0 (commit, Release, GNU 12.2.0)".
std::string version_line();

/// Everything about build, libraries and machine; hashes of the inputs are left empty.
Provenance provenance();

/// The machine and build as kept with timings.
Machine machine();

/// One line each: a debug build, a processor that changes its frequency, an OpenBLAS under Simbody.
std::vector<std::string> suspicions();

/// SHA-256 as 64 hex digits.
std::string sha256(std::string_view bytes);

/// SHA-256 of this program's own file.
std::string program_sha256();

/// Bytes of memory of this machine, and bytes free on the disk that holds `path` (its nearest existing folder).
std::uint64_t machine_memory();
std::uint64_t free_disk(const std::filesystem::path& path);

}  // namespace pipeline
