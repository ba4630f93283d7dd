#include "pipeline/target.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "pipeline/error.hpp"

namespace pipeline {

using std::filesystem::path;

Target::Target(const path& target, bool replace) : path_(target), replace_(replace) {
  std::error_code ignored;
  if (target.has_parent_path()) made_folder_ = std::filesystem::create_directories(target.parent_path(), ignored);
  if (!target.has_filename()) throw Error(kFile, target.string() + ": is a folder; choose another -o");
  struct stat status;
  if (lstat(target.c_str(), &status) == 0) {
    if (!replace) throw Error(kFile, target.string() + ": exists; --force replaces it, or choose another -o");
    if (!S_ISREG(status.st_mode)) throw Error(kFile, target.string() + ": is not a regular file; choose another -o");
  }
  // One name for all: what a kill left behind is taken over by the next writer.
  temporary_ = target.parent_path() / std::string(".").append(target.filename().string()).append(".new");
  for (;;) {
    file_ = open(temporary_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0) fail();
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
      close(file_);
      done_ = true;  // it is another writer's
      throw Error(kFile, target.string() + ": is being written by another run; wait for it or choose another -o");
    }
    // Between open and lock another writer may have renamed the file into place: then this is its result.
    struct stat mine, there;
    if (fstat(file_, &mine) == 0 && stat(temporary_.c_str(), &there) == 0 && mine.st_ino == there.st_ino) break;
    close(file_);
  }
  if (ftruncate(file_, 0) != 0) fail();
}

Target::~Target() {
  if (!done_) unlink(temporary_.c_str());
  if (file_ >= 0) close(file_);
  if (!done_ && made_folder_) rmdir(path_.parent_path().c_str());  // unless something is in it
}

void Target::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) fail();
    if (written > 0) bytes = bytes.subspan(std::size_t(written));
  }
  rename_into_place();
}

void Target::rename_into_place() {
  if (fsync(file_) != 0) fail();
  const unsigned keep = replace_ ? 0 : RENAME_NOREPLACE;
  int renamed = renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), keep);
  if (renamed != 0 && errno == EINVAL && keep)  // a file system without this flag: link refuses as well
    renamed = link(temporary_.c_str(), path_.c_str()) == 0 ? unlink(temporary_.c_str()) : -1;
  if (renamed != 0 && errno == EEXIST)
    throw Error(kFile, path_.string() + ": exists by now; the same command with --force replaces it");
  if (renamed != 0) fail();
  done_ = true;
  const path folder = path_.has_parent_path() ? path_.parent_path() : path(".");
  const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;  // a folder that cannot be read can still be written to
  fsync(opened);           // EINVAL where folders cannot be synced: nothing more can be done
  close(opened);
}

void Target::fail() const {
  const int error = errno;
  throw Error(kFile, path_.string() + ": cannot be written (" + std::strerror(error) +
                         "); free or allow the place, or choose another");
}

}  // namespace pipeline
