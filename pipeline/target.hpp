// Where a result goes: half a file never looks whole, and nothing is overwritten unasked.
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>

namespace pipeline {

/// The place of a file, taken before the work, so that one that cannot be written is said at once. While it is held
/// no other program of ours writes there. All throw Error(kFile).
class Target {
 public:
  /// Without `replace` an existing file is never overwritten, also when it appears later.
  Target(const std::filesystem::path& path, bool replace);
  ~Target();
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  /// Writes the whole file beside its place, syncs and renames it. Once.
  void write(std::span<const std::byte> bytes);

 private:
  void rename_into_place();
  [[noreturn]] void fail() const;

  std::filesystem::path path_, temporary_;
  bool replace_, made_folder_ = false;
  int file_ = -1;
  bool done_ = false;
};

}  // namespace pipeline
