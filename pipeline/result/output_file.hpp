// Where a result goes: half a file never looks whole, and nothing is overwritten unasked.
#pragma once
#include <sys/stat.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "pipeline/system/file_bytes.hpp"

namespace pipeline {

/// What may become of a file that stands at the place already.
enum class Existing {
  refuse,   // nothing is ever overwritten, also not what appears later
  replace,  // whatever stands there in the end
  update,   // only what stood there when the place was taken, unchanged; or nothing, if nothing did
};

/// The place of a file, taken before the work, so that one that cannot be written is said at once. While it is held
/// no other program of ours writes there; what killed ones left behind is cleared away. A new file has the mode and
/// owner of the one that it replaces. All throw Error(kFile).
class OutputFile {
 public:
  OutputFile(const std::filesystem::path& path, Existing existing);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Writes the whole file, `bytes` and then `end`, beside its place, reads it back and renames it. Once.
  void write(std::span<const std::byte> bytes, std::string_view end = {});

 private:
  /// An empty file beside the place, locked; the same name for all, and gone when nobody writes.
  class Lock {
   public:
    Lock(int folder, const std::string& name);
    ~Lock();
    bool held() const { return bool(file_); }  // else another has it

   private:
    int folder_;
    std::string name_;
    Descriptor file_;
  };

  void look();
  void refuse_changed() const;

  std::filesystem::path path_;
  std::string name_;
  Existing existing_;
  std::optional<MadeFolders> made_;
  Descriptor folder_;
  std::optional<struct stat> before_;  // of what stood there
  std::optional<Lock> lock_;
  std::optional<NewFile> file_;
};

}  // namespace pipeline
