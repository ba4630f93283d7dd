#include "pipeline/system/input_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "pipeline/terminal/error.hpp"

namespace pipeline {

using std::filesystem::path;

InputFile::InputFile(const path& path, const std::string& remedy) : path_(path) {
  const auto refuse = [&](const std::string& why) { return Error(kFile, path.string() + ": " + why + "; " + remedy); };
  const auto cannot = [&] { return refuse(std::string("cannot be read (") + std::strerror(errno) + ")"); };
  const auto check_kind = [&] {
    if (S_ISDIR(status_.st_mode)) throw refuse("is a folder, not a file");
    if (!S_ISREG(status_.st_mode)) throw refuse("is not a regular file");
  };
  // Before it is opened, as opening a device may do something; and again after, as it may be another file by then.
  if (stat(path.c_str(), &status_) != 0) throw cannot();
  check_kind();
  descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor_ < 0) throw cannot();
  try {
    if (fstat(descriptor_, &status_) != 0) throw cannot();
    check_kind();
  } catch (...) {
    close(descriptor_);  // a constructor that throws has no destructor
    throw;
  }
}

InputFile::~InputFile() { close(descriptor_); }

path InputFile::opened_path() const {
  const path link = "/proc/self/fd/" + std::to_string(descriptor_);
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
  const InputFile file(path, remedy);
  const auto refuse = [&](const std::string& why) { return Error(kFile, path.string() + ": " + why + "; " + remedy); };
  if (file.size() > most)
    throw refuse("has " + std::to_string(file.size()) + " bytes, at most " + std::to_string(most) + " are possible");
  std::string text(file.size(), '\0');
  std::size_t filled = 0;
  while (filled < text.size()) {
    const ssize_t got = read(file.descriptor(), text.data() + filled, text.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw refuse(std::string("cannot be read (") + std::strerror(errno) + ")");
    if (got == 0) break;  // shorter by now: its content is judged as any other
    filled += static_cast<std::size_t>(got);
  }
  text.resize(filled);
  return text;
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
