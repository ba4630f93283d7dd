// The result file: HDF5, laid out as README's "The file" says. The only place, with h5.hpp, that knows HDF5.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "pipeline/result.hpp"

namespace pipeline {

/// Grows when a name, unit or meaning in the file changes. A newer one is refused.
constexpr int kSchemaVersion = 1;

/// The place of a result, taken before the work, so that one that cannot be written is said at once. While it is held
/// no other program of ours writes there. All throw Error(kFile).
class Target {
 public:
  /// Without `replace` an existing file is never overwritten, also when it appears later.
  Target(const std::filesystem::path& path, bool replace);
  ~Target();
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  /// Writes the whole result beside its place, synced, and renames it. Fills in `result.digest`. Once.
  void write(Result& result);

 private:
  void put(std::span<const std::byte> bytes);
  void rename_into_place();
  [[noreturn]] void fail() const;

  std::filesystem::path path_, temporary_;
  bool replace_, made_folder_ = false;
  int file_ = -1;
  bool done_ = false;
};

/// Writes a result at once; an existing file is replaced.
void write_result(Result& result, const std::filesystem::path& path);

/// Reads a whole result. Throws Error(kFile) when the file is missing, not HDF5, not ours, truncated, damaged (its
/// content does not have its digest) or newer.
Result read_result(const std::filesystem::path& path);

/// The digests of a result: "/motion", "/truth", "/answers/<label>" and "/" (README, "The digest").
std::map<std::string, std::string> digests(const Result& result);

/// Estimated bytes of the file before deflate, at 4 hits per body, step and algorithm. `mesh_bytes` are those of the
/// distinct meshes: 24 a vertex and 12 a triangle.
std::uint64_t estimated_bytes(std::uint64_t steps, std::uint64_t bodies, std::uint64_t algorithms,
                              std::uint64_t mesh_bytes);

}  // namespace pipeline
