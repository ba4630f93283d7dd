#include "pipeline/system/input_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include "pipeline/terminal/error.hpp"

namespace pipeline {

using std::filesystem::path;

namespace {

Error refusal(const path& path, const FileFailure& failure, const std::string& remedy) {
  return Error(kFile, path.string() + ": " + failure.what() + "; " + remedy);
}

}  // namespace

InputFile::InputFile(const path& path, const std::string& remedy) : path_(path) {
  try {
    file_ = open_regular(AT_FDCWD, path, /*follow_links=*/true, status_);
  } catch (const FileFailure& failure) {
    throw refusal(path, failure, remedy);
  }
}

path InputFile::opened_path() const {
  const path link = "/proc/self/fd/" + std::to_string(descriptor());
  return access(link.c_str(), R_OK) == 0 ? link : path_;  // a system without /proc
}

bool InputFile::in_place() const {
  struct stat there;
  return stat(path_.c_str(), &there) == 0 && there.st_dev == status_.st_dev && there.st_ino == status_.st_ino;
}

bool InputFile::same_as(const InputFile& other) const {
  const struct stat &a = status_, &b = other.status_;
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino && a.st_size == b.st_size &&
         a.st_mtim.tv_sec == b.st_mtim.tv_sec && a.st_mtim.tv_nsec == b.st_mtim.tv_nsec;
}

std::string text_of_file(const path& path, std::uint64_t most, const std::string& remedy) {
  try {
    return read_regular(AT_FDCWD, path, /*follow_links=*/true, most);
  } catch (const FileFailure& failure) {
    throw refusal(path, failure, remedy);
  }
}

bool is_shallow(std::string_view json, int most) {
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_text && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_text = !in_text;
    } else if (!in_text && (c == '[' || c == '{')) {
      if (++depth > most) return false;
    } else if (!in_text && (c == ']' || c == '}')) {
      --depth;
    }
  }
  return true;
}

}  // namespace pipeline
