// Bytes of files that others name.
#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>

namespace pipeline {

/// What could not be done with a file, and why: "cannot be read (Permission denied)". Whoever catches it knows the
/// place, the exit code and the remedy.
class FileFailure : public std::runtime_error {
 public:
  explicit FileFailure(const std::string& what) : std::runtime_error(what) {}
  FileFailure(const std::string& action, int error);
};

/// The whole content of a regular file of at most `most` bytes. Anything else (a device, a pipe, a folder) is refused
/// before a byte is read, and never waited for. `folder` is an open folder, or AT_FDCWD. Throws FileFailure.
std::string read_regular(int folder, const std::filesystem::path& path, bool follow_links = true,
                         std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

}  // namespace pipeline
