#include "pipeline/file_bytes.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace pipeline {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 20;

/// Closes itself.
struct Descriptor {
  int number;
  explicit Descriptor(int n) : number(n) {}
  ~Descriptor() {
    if (number >= 0) close(number);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  explicit operator bool() const { return number >= 0; }
};

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

}  // namespace

FileFailure::FileFailure(const std::string& action, int error)
    : std::runtime_error(action + " (" + std::strerror(error) + ")") {}

std::string read_regular(int folder, const fs::path& path, bool follow_links, std::uint64_t most) {
  // Asked by name first: opening a device may already do something. Asked again afterwards: names change.
  struct stat status;
  if (fstatat(folder, path.c_str(), &status, follow_links ? 0 : AT_SYMLINK_NOFOLLOW) != 0)
    throw FileFailure("cannot be read", errno);
  refuse_irregular(status);
  const int flags = O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC | (follow_links ? 0 : O_NOFOLLOW);
  const Descriptor file(openat(folder, path.c_str(), flags));
  if (!file || fstat(file.number, &status) != 0) throw FileFailure("cannot be read", errno);
  refuse_irregular(status);
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
    const ssize_t got = read(file.number, bytes.data() + have, bytes.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FileFailure("cannot be read", errno);
    if (got == 0) break;
    have += std::size_t(got);
  }
  bytes.resize(have);
  if (have > most) throw too_long(have);
  return bytes;
}

}  // namespace pipeline
