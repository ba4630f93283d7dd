// Files of others (results, baselines, manifests): opened only when they are regular files, read whole only up to what
// their kind can hold, their JSON only to a depth.
#pragma once
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "pipeline/system/file_bytes.hpp"

namespace pipeline {

/// A regular file, open for reading until the end of this object.
class InputFile {
 public:
  /// Never waits, whatever stands at `path`. Throws Error(kFile) when it is missing, no regular file or unreadable;
  /// `remedy` ends the line.
  InputFile(const std::filesystem::path& path, const std::string& remedy);

  int descriptor() const { return file_.number(); }
  std::uint64_t size() const { return static_cast<std::uint64_t>(status_.st_size); }
  /// A path by which libraries open this very file, whatever stands at its own path by now.
  std::filesystem::path opened_path() const;
  /// Whether its own path still leads to it.
  bool in_place() const;
  /// Whether both are the same file, unchanged.
  bool same_as(const InputFile& other) const;

 private:
  std::filesystem::path path_;
  Descriptor file_;
  struct stat status_ = {};
};

/// The whole content of a text file of at most `most` bytes. Throws Error(kFile) as InputFile, and when it is longer or
/// cannot be read.
std::string text_of_file(const std::filesystem::path& path, std::uint64_t most, const std::string& remedy);

/// Whether no array or object of a JSON text lies deeper than `most`: what is deeper overflows the stack of whoever
/// walks it (a baseline nested 100,000 deep ended the program by signal 11). Ours have at most 3.
bool is_shallow(std::string_view json, int most = 32);

}  // namespace pipeline
