// Bytes on the disk: descriptors that close themselves, whole files read, and files made where others can write too.
//
// `folder` is an open folder, or AT_FDCWD. What stands at a name is taken for nothing: files are made exclusively under
// a name of one's own, read back, and renamed while that name still leads to them; links are not followed there.
#pragma once
#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pipeline {

/// Opens those of the descriptors 0, 1 and 2 that are closed: the next file that is opened would get their number, and
/// with it what is printed. Output to a closed stdout stays an error, to a closed stderr it is dropped. The first thing
/// that main does.
void open_standard_descriptors();

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { close(); }

  void close();
  int number() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }

 private:
  int number_ = -1;
};

/// What could not be done with a file, and why: "cannot be read (Permission denied)". Whoever catches it knows the
/// place, the exit code and the remedy.
class FileFailure : public std::runtime_error {
 public:
  explicit FileFailure(const std::string& what) : std::runtime_error(what) {}
  FileFailure(const std::string& action, int error);
  int error() const { return error_; }  // an errno, or 0

 private:
  int error_ = 0;
};

/// Lower-case hexadecimal digits, two a byte.
std::string hex(std::span<const unsigned char> bytes);

/// Writes all; false, with errno set, when it cannot.
bool write_all(int file, std::string_view bytes);

/// A regular file, open for reading, and its status. Anything else (a device, a pipe, a folder) is refused before it is
/// opened, and never waited for. Throws FileFailure.
Descriptor open_regular(int folder, const std::filesystem::path& path, bool follow_links, struct stat& status);

/// The whole content of a regular file of at most `most` bytes. Throws FileFailure as open_regular, and for a longer
/// one.
std::string read_regular(int folder, const std::filesystem::path& path, bool follow_links = true,
                         std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

/// A folder for the calls that take one. A folder that may be written to but not read will do. Throws FileFailure.
Descriptor open_folder(const std::filesystem::path& folder, bool follow_links = true);

/// Makes what was renamed in the folder survive a power cut, where folders can be synced. Throws FileFailure.
void sync_folder(int folder);

/// The names in a folder; none when it may not be read.
std::vector<std::string> names_in(int folder);

/// Takes an exclusive lock on an empty file of that name, made if need be; what it gives is false when another has it.
/// Throws FileFailure when the file system gives none, or something else stands there.
Descriptor take_lock(int folder, const std::string& name);

/// Whether `name` in `folder` is the open file itself, not a link to it nor another in its place.
bool is_at(int folder, const std::string& name, int file);

/// Removes `name` from the folder if it is a regular file; false when it is still there.
bool remove_regular(int folder, const std::string& name);

/// The folders that had to be made for one, every level; removed again, where nothing is in them, unless kept.
class MadeFolders {
 public:
  /// Throws FileFailure.
  explicit MadeFolders(const std::filesystem::path& folder);
  ~MadeFolders();
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  bool any() const { return !made_.empty(); }
  void keep() { made_.clear(); }

 private:
  std::vector<std::filesystem::path> made_;  // outermost first
};

/// A file in the making, ".NAME.1f0c66d2.new" in its folder; removed unless it came to its place. Throws FileFailure.
class NewFile {
 public:
  NewFile(int folder, const std::string& name, mode_t mode = 0666);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Gives it the mode and, where that is allowed, the owner of another file.
  void take_after(const struct stat& other);

  /// Writes the content, syncs it, reads it back from the disk. Once.
  void write(std::initializer_list<std::string_view> pieces);

  /// Renames it to NAME; when this returns it stands there. Without `replace` nothing is overwritten: then it throws
  /// with error() == EEXIST.
  void place(bool replace);

 private:
  int folder_;
  std::string name_, temporary_;
  Descriptor file_;
  bool placed_ = false;
};

/// A file of `folder` in one call.
void put_file(int folder, const std::string& name, std::initializer_list<std::string_view> pieces);

/// A name of one's own for a file of that name in the making: ".NAME.1f0c66d2.new".
std::string new_file_name(const std::string& name);

/// NAME when `entry` is the name of a NewFile for it. One that nobody can be writing is what a kill left behind.
std::optional<std::string> new_file_of(std::string_view entry);

}  // namespace pipeline
