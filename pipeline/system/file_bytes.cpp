#include "pipeline/system/file_bytes.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <system_error>

namespace pipeline {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20;
constexpr std::string_view kEnd = ".new";
constexpr std::size_t kOwn = 8;  // digits of a name of one's own

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISLNK(mode)) return "a symbolic link";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

void refuse_irregular(const struct stat& status) {
  if (!S_ISREG(status.st_mode))
    throw FileFailure(std::string("is ") + kind_of(status.st_mode) + ", not a regular file");
}

bool same_file(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

/// Whether the disk has what was meant.
bool holds(int file, std::initializer_list<std::string_view> pieces) {
  std::vector<char> block(kBlock);
  off_t at = 0;
  for (std::string_view piece : pieces) {
    while (!piece.empty()) {
      const ssize_t got = pread(file, block.data(), std::min(block.size(), piece.size()), at);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) throw FileFailure("cannot be read back", errno);
      if (got == 0 || std::memcmp(block.data(), piece.data(), std::size_t(got)) != 0) return false;
      piece.remove_prefix(std::size_t(got));
      at += got;
    }
  }
  struct stat status;
  return fstat(file, &status) == 0 && status.st_size == at;
}

}  // namespace

void open_standard_descriptors() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(number, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest free number is this one. Where there is no null device a folder holds it as well.
    const int mode = number == STDERR_FILENO ? O_RDWR : O_RDONLY;
    if (open("/dev/null", mode) == number || open("/", O_RDONLY | O_DIRECTORY) == number) continue;
    _exit(4);  // kFile, and nowhere to say it
  }
}

void Descriptor::close() {
  if (number_ >= 0) ::close(number_);
  number_ = -1;
}

FileFailure::FileFailure(const std::string& action, int error)
    : std::runtime_error(action + " (" + std::strerror(error) + ")"), error_(error) {}

std::string hex(std::span<const unsigned char> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (const unsigned char byte : bytes) {
    out += kDigits[byte >> 4];
    out += kDigits[byte & 15];
  }
  return out;
}

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) return false;
    bytes.remove_prefix(std::size_t(written));
  }
  return true;
}

Descriptor open_regular(int folder, const fs::path& path, bool follow_links, struct stat& status) {
  // Asked by name first: opening a device may already do something. Asked again afterwards: names change.
  if (fstatat(folder, path.c_str(), &status, follow_links ? 0 : AT_SYMLINK_NOFOLLOW) != 0)
    throw FileFailure("cannot be read", errno);
  refuse_irregular(status);
  const int flags = O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC | (follow_links ? 0 : O_NOFOLLOW);
  Descriptor file(openat(folder, path.c_str(), flags));
  if (!file || fstat(file.number(), &status) != 0) throw FileFailure("cannot be read", errno);
  refuse_irregular(status);
  return file;
}

std::string read_regular(int folder, const fs::path& path, bool follow_links, std::uint64_t most) {
  struct stat status;
  const Descriptor file = open_regular(folder, path, follow_links, status);
  const auto too_long = [&](std::uint64_t size) {
    return FileFailure("has " + std::to_string(size) + " bytes; such a file has at most " + std::to_string(most));
  };
  const auto size = std::uint64_t(status.st_size);
  if (size > most) throw too_long(size);
  std::string bytes(size, '\0');
  std::size_t have = 0;
  for (;;) {
    if (have == bytes.size()) {  // of files in /proc the size is not known
      if (have > most) throw too_long(have);
      bytes.resize(have + (have == size ? 1 : kBlock));
    }
    const ssize_t got = read(file.number(), bytes.data() + have, bytes.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FileFailure("cannot be read", errno);
    if (got == 0) break;
    have += std::size_t(got);
  }
  bytes.resize(have);
  if (have > most) throw too_long(have);
  return bytes;
}

Descriptor open_folder(const fs::path& folder, bool follow_links) {
  const int flags = O_PATH | O_DIRECTORY | O_CLOEXEC | (follow_links ? 0 : O_NOFOLLOW);
  Descriptor opened(open(folder.empty() ? "." : folder.c_str(), flags));
  if (!opened) throw FileFailure("the folder cannot be opened", errno);
  return opened;
}

void sync_folder(int folder) {
  const Descriptor readable(openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!readable) return;  // it can be written to all the same
  if (fsync(readable.number()) != 0 && errno != EINVAL) throw FileFailure("cannot be synced", errno);
}

std::vector<std::string> names_in(int folder) {
  std::vector<std::string> names;
  const int readable = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const std::unique_ptr<DIR, int (*)(DIR*)> stream(readable < 0 ? nullptr : fdopendir(readable), &closedir);
  if (!stream) return names;
  while (const dirent* entry = readdir(stream.get())) {
    const std::string_view name = entry->d_name;
    if (name != "." && name != "..") names.emplace_back(name);
  }
  return names;
}

Descriptor take_lock(int folder, const std::string& name) {
  for (;;) {
    constexpr int kFlags = O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
    Descriptor file(openat(folder, name.c_str(), kFlags, 0666));
    struct stat status;
    if (!file || fstat(file.number(), &status) != 0) throw FileFailure(name + " cannot be opened", errno);
    if (!S_ISREG(status.st_mode) || status.st_size != 0)
      throw FileFailure("another program's " + name + " is where the lock must be");
    while (flock(file.number(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) return {};
      if (errno == EINTR) continue;
      const FileFailure none(name + " cannot be locked", errno);
      unlinkat(folder, name.c_str(), 0);
      throw none;
    }
    // Between open and lock another may have removed it, at its end: then it keeps nobody out.
    if (is_at(folder, name, file.number())) return file;
  }
}

bool is_at(int folder, const std::string& name, int file) {
  struct stat mine, there;
  return fstat(file, &mine) == 0 && fstatat(folder, name.c_str(), &there, AT_SYMLINK_NOFOLLOW) == 0 &&
         same_file(mine, there);
}

bool remove_regular(int folder, const std::string& name) {
  struct stat status;
  if (fstatat(folder, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) return errno == ENOENT;
  return S_ISREG(status.st_mode) && (unlinkat(folder, name.c_str(), 0) == 0 || errno == ENOENT);
}

MadeFolders::MadeFolders(const fs::path& folder) {
  std::vector<fs::path> missing;  // innermost first
  std::error_code none;
  for (fs::path level = folder; !level.empty() && !fs::exists(level, none); level = level.parent_path())
    missing.push_back(level);
  for (; !missing.empty(); missing.pop_back()) {
    if (mkdir(missing.back().c_str(), 0777) == 0) {
      made_.push_back(missing.back());
    } else if (errno != EEXIST) {
      const int error = errno;
      for (; !made_.empty(); made_.pop_back()) rmdir(made_.back().c_str());
      throw FileFailure("cannot be made", error);
    }
  }
}

MadeFolders::~MadeFolders() {
  for (; !made_.empty(); made_.pop_back()) rmdir(made_.back().c_str());
}

NewFile::NewFile(int folder, const std::string& name, mode_t mode) : folder_(folder), name_(name) {
  do {
    temporary_ = new_file_name(name);
    file_ = Descriptor(openat(folder, temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode));
  } while (!file_ && errno == EEXIST);
  if (!file_) throw FileFailure("cannot be written", errno);
}

NewFile::~NewFile() {
  if (!placed_ && is_at(folder_, temporary_, file_.number())) unlinkat(folder_, temporary_.c_str(), 0);
}

void NewFile::take_after(const struct stat& other) {
  const int file = file_.number();
  mode_t mode = other.st_mode & 0777;
  struct stat mine;
  if (fstat(file, &mine) != 0) throw FileFailure("cannot be written", errno);
  if (mine.st_uid != other.st_uid && fchown(file, other.st_uid, gid_t(-1)) != 0) errno = 0;  // only root may
  if (mine.st_gid != other.st_gid && fchown(file, uid_t(-1), other.st_gid) != 0)
    mode = (mode & 0707) | (mode & 0007) << 3;  // another group than meant gets what all get
  if (fchmod(file, mode) != 0) throw FileFailure("cannot be given its mode", errno);
}

void NewFile::write(std::initializer_list<std::string_view> pieces) {
  const int file = file_.number();
  for (const std::string_view piece : pieces)
    if (!write_all(file, piece)) throw FileFailure("cannot be written", errno);
  if (fsync(file) != 0) throw FileFailure("cannot be written", errno);
  posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);  // what is read back comes from the disk where that can be had
  if (!holds(file, pieces)) throw FileFailure("does not hold what was written: the disk or another program changed it");
}

void NewFile::place(bool replace) {
  const auto moved = [&] { return FileFailure("another program put its file in place of this one"); };
  if (!is_at(folder_, temporary_, file_.number())) throw moved();
  const unsigned keep = replace ? 0 : RENAME_NOREPLACE;
  int renamed = renameat2(folder_, temporary_.c_str(), folder_, name_.c_str(), keep);
  if (renamed != 0 && errno == EINVAL && keep) {  // a file system without this flag: link refuses as well
    renamed = linkat(folder_, temporary_.c_str(), folder_, name_.c_str(), 0);
    if (renamed == 0) unlinkat(folder_, temporary_.c_str(), 0);
  }
  if (const int error = errno; renamed != 0) {
    // An answer of NFS that was lost is asked for again, and the file is in its own way then.
    if (error != EEXIST || !is_at(folder_, name_, file_.number())) throw FileFailure("cannot be written", error);
    unlinkat(folder_, temporary_.c_str(), 0);
  }
  placed_ = true;
  if (!is_at(folder_, name_, file_.number())) throw moved();
  sync_folder(folder_);
}

void put_file(int folder, const std::string& name, std::initializer_list<std::string_view> pieces) {
  NewFile file(folder, name);
  file.write(pieces);
  file.place(true);
}

std::string new_file_name(const std::string& name) {
  const unsigned own = std::random_device()();
  unsigned char bytes[kOwn / 2];
  for (std::size_t i = 0; i < sizeof bytes; ++i) bytes[i] = static_cast<unsigned char>(own >> (8 * i));
  return "." + name + "." + hex(bytes) + std::string(kEnd);
}

std::optional<std::string> new_file_of(std::string_view entry) {
  constexpr std::size_t kAround = 1 + 1 + kOwn + kEnd.size();
  if (entry.size() <= kAround || entry.front() != '.' || !entry.ends_with(kEnd)) return std::nullopt;
  const std::string_view name = entry.substr(1, entry.size() - kAround), own = entry.substr(name.size() + 2, kOwn);
  if (entry[name.size() + 1] != '.' || own.find_first_not_of("0123456789abcdef") != std::string_view::npos)
    return std::nullopt;
  return std::string(name);
}

}  // namespace pipeline
