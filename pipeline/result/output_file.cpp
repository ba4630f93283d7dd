#include "pipeline/result/output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "pipeline/terminal/error.hpp"

namespace pipeline {

using std::filesystem::path;

namespace {

Error refusal(const path& place, const FileFailure& failure) {
  return {kFile, place.string() + ": " + failure.what() + "; free or allow the place, or choose another"};
}

std::optional<struct stat> standing(int folder, const std::string& name) {
  struct stat status;
  if (fstatat(folder, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) return std::nullopt;
  return status;
}

/// The same file with the same content; its mode may be another by now.
bool unchanged(const struct stat& before, const struct stat& now) {
  return before.st_dev == now.st_dev && before.st_ino == now.st_ino && before.st_size == now.st_size &&
         before.st_mtim.tv_sec == now.st_mtim.tv_sec && before.st_mtim.tv_nsec == now.st_mtim.tv_nsec;
}

}  // namespace

OutputFile::OutputFile(const path& target, Existing existing)
    : path_(target), name_(target.filename().string()), existing_(existing) {
  const std::string place = target.string();
  if (!target.has_filename()) throw Error(kFile, place + ": is a folder; choose another place");
  try {
    made_.emplace(target.parent_path());
    folder_ = open_folder(target.parent_path());
    const int folder = folder_.number();
    const std::string lock = "." + name_ + ".lock";
    if (!standing(folder, lock)) look();  // else a killed writer's things may be cleared away before it is refused
    lock_.emplace(folder, lock);
    if (!lock_->held())
      throw Error(kFile, place + ": is being written by another run; wait for it or choose another place");
    // Nobody else is writing now: what has the name of a file in the making was left behind by a kill.
    for (const std::string& entry : names_in(folder))
      if (new_file_of(entry) == name_) remove_regular(folder, entry);
    look();  // again: another may have finished just before
    file_.emplace(folder, name_, before_ ? before_->st_mode & 0777 : 0666);
    if (before_) file_->take_after(*before_);
  } catch (const FileFailure& failure) {
    throw refusal(target, failure);
  }
}

OutputFile::Lock::Lock(int folder, const std::string& name)
    : folder_(folder), name_(name), file_(take_lock(folder, name)) {}

OutputFile::Lock::~Lock() {
  if (file_ && is_at(folder_, name_, file_.number())) unlinkat(folder_, name_.c_str(), 0);
}

/// Finds what stands there, and refuses what may not be replaced.
void OutputFile::look() {
  before_ = standing(folder_.number(), name_);
  if (before_ && !S_ISREG(before_->st_mode))  // first: --force would not help
    throw Error(kFile, path_.string() + ": is not a regular file; choose another place");
  if (before_ && existing_ == Existing::refuse)
    throw Error(kFile, path_.string() + ": exists; --force replaces it, or choose another -o");
}

void OutputFile::refuse_changed() const {
  const auto now = standing(folder_.number(), name_);
  if (before_ ? now && unchanged(*before_, *now) : !now) return;
  throw Error(kFile, path_.string() +
                         ": was replaced or changed by another program meanwhile, and is kept as it is; "
                         "run the same command again");
}

void OutputFile::write(std::span<const std::byte> bytes, std::string_view end) {
  try {
    file_->write({{reinterpret_cast<const char*>(bytes.data()), bytes.size()}, end});
    if (existing_ == Existing::update) refuse_changed();
    file_->place(existing_ == Existing::replace || before_);
  } catch (const FileFailure& failure) {
    if (failure.error() == EEXIST && existing_ == Existing::update) refuse_changed();
    if (failure.error() == EEXIST)
      throw Error(kFile, path_.string() + ": exists by now; the same command with --force replaces it");
    throw refusal(path_, failure);
  }
  made_->keep();
}

}  // namespace pipeline
