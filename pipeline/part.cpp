#include "pipeline/part.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "pipeline/error.hpp"
#include "pipeline/foreign.hpp"

namespace pipeline {
namespace fs = std::filesystem;
namespace {

constexpr char kMagic[8] = {'C', 'D', 'C', 'H', 'U', 'N', 'K', '1'};
constexpr const char* kManifest = "manifest.json";
constexpr const char* kLock = "lock";
constexpr const char* kComplete = "complete";
constexpr std::int64_t kMostSteps = 10000000;  // as the configuration's

[[noreturn]] void cannot(const std::string& action, const fs::path& path, int error) {
  throw Error(kFile, path.string() + ": cannot " + action + ": " + std::strerror(error) +
                         "; what was finished is kept: free or allow the place and run again");
}

void sync_folder(const fs::path& folder) {
  const int fd = open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (fd < 0) cannot("open", folder, errno);
  const int error = fsync(fd) == 0 || errno == EINVAL ? 0 : errno;  // EINVAL: folders cannot be synced there
  close(fd);
  if (error) cannot("sync", folder, error);
}

void write_all(const fs::path& path, std::initializer_list<std::string_view> pieces) {
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) cannot("write", path, errno);
  for (std::string_view piece : pieces) {
    while (!piece.empty()) {
      const ssize_t written = write(fd, piece.data(), piece.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) {
        const int error = written < 0 ? errno : ENOSPC;
        close(fd);
        unlink(path.c_str());
        cannot("write", path, error);
      }
      piece.remove_prefix(std::size_t(written));
    }
  }
  if (fsync(fd) != 0) {
    const int error = errno;
    close(fd);
    unlink(path.c_str());
    cannot("sync", path, error);
  }
  close(fd);
}

void replace(const fs::path& folder, const std::string& name, std::initializer_list<std::string_view> pieces) {
  const fs::path place = folder / name, beside = folder / (name + ".new");
  write_all(beside, pieces);
  if (rename(beside.c_str(), place.c_str()) != 0) cannot("rename to", place, errno);
  sync_folder(folder);
}

constexpr std::uint64_t kMostManifest = 64 << 10;  // bytes; a title has at most 1024 characters, all else is short

std::optional<std::string> read_all(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) return std::nullopt;
  return bytes;
}

nlohmann::json manifest_of(const fs::path& folder) {
  std::error_code none;
  if (!fs::exists(folder / kManifest, none)) return nullptr;
  const std::string text = text_of_file(folder / kManifest, kMostManifest, "name an unfinished run of this program");
  if (!is_shallow(text)) return nullptr;
  return nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
}

std::string text_in(const nlohmann::json& manifest, const char* name) {
  const bool there = manifest.is_object() && manifest.contains(name) && manifest[name].is_string();
  return there ? manifest[name].get<std::string>() : "";
}

/// The manifest goes first, so that what is left by a kill belongs to nobody and is emptied; the lock goes last.
void empty(const fs::path& folder) {
  std::error_code ignored;
  fs::remove(folder / kManifest, ignored);
  std::vector<fs::path> chunks;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().filename() != kLock) chunks.push_back(entry.path());
  for (const fs::path& chunk : chunks) fs::remove_all(chunk, ignored);
}

std::string checksum(std::string_view seal, std::string_view content) {
  std::string bytes(seal);
  bytes += content;
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, hash);
  return {reinterpret_cast<const char*>(canonical.digest), sizeof canonical.digest};
}

}  // namespace

std::string chunk_name(const std::string& stage, std::int64_t step) {
  std::string digits = std::to_string(step);
  digits.insert(0, digits.size() < 7 ? 7 - digits.size() : 0, '0');
  return stage + "-" + digits;
}

namespace {

struct ChunkName {
  std::string stage;
  std::int64_t step;
};

/// What chunk_name made a name of.
std::optional<ChunkName> chunk_of(const std::string& name) {
  const std::size_t dash = name.find('-');
  if (dash == std::string::npos) return std::nullopt;
  ChunkName out{name.substr(0, dash), 0};
  std::from_chars(name.data() + dash + 1, name.data() + name.size(), out.step);
  if (out.step < 0 || chunk_name(out.stage, out.step) != name) return std::nullopt;
  return out;
}

}  // namespace

void ChunkReader::take(void* to, std::size_t size) {
  if (size > bytes_.size() - at_) throw std::logic_error("a chunk is shorter than what is read from it");
  if (size) std::memcpy(to, bytes_.data() + at_, size);
  at_ += size;
}

PartStatus part_status(const fs::path& folder) {
  const nlohmann::json manifest = manifest_of(folder);
  const bool whole = manifest.is_object() && manifest.contains("steps") && manifest["steps"].is_number_integer();
  PartStatus status{.title = text_in(manifest, "title"), .steps = whole ? manifest["steps"].get<std::int64_t>() : 0};
  if (status.steps < 1 || status.steps > kMostSteps)
    throw Error(kFile, folder.string() + ": is not an unfinished run of this program (no readable " + kManifest + ")");
  status.study = manifest.contains("study");
  // What is there is counted, not what might be: a manifest can speak of millions.
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename();
    const auto chunk = chunk_of(name);
    if (!chunk || chunk->step >= status.steps) continue;
    if (status.study) {
      status.cases += chunk->stage == "case";
      continue;
    }
    if (chunk->step % kChunkSteps != 0) continue;
    const std::int64_t count = std::min(kChunkSteps, status.steps - chunk->step);
    if (chunk->stage == "motion") status.motion_steps += count;
    if (chunk->stage == "truth") status.truth_steps += count;
    if (chunk->stage == "answers") status.answered_steps += count;
  }
  return status;
}

Part::Part(const fs::path& folder, const PartKey& key, const std::string& title, std::int64_t steps, bool force,
           bool study)
    : folder_(folder) {
  std::error_code error;
  if (folder.has_parent_path()) fs::create_directories(folder.parent_path(), error);
  if (error) cannot("make the folder of", folder, error.value());
  const bool existed = fs::exists(folder, error);
  if (existed && !fs::is_directory(folder))
    throw Error(kFile, folder.string() + ": is in the way and not a folder; remove it or choose another -o");
  // Whatever --force empties must be ours: a folder without our manifest may be somebody's data.
  if (existed && !fs::is_empty(folder) && !fs::exists(folder / kManifest) && !fs::exists(folder / kLock))
    throw Error(kFile, folder.string() + ": is in the way and not an unfinished run; remove it or choose another -o");
  if (!existed) {
    if (!fs::create_directory(folder, error) && error) cannot("make", folder, error.value());
    sync_folder(folder.has_parent_path() ? folder.parent_path() : fs::path("."));
  }

  lock_ = open((folder / kLock).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) cannot("write", folder / kLock, errno);
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    close(lock_);
    throw Error(kFile, folder.string() + ": is being written by another run; wait for it or choose another -o");
  }

  nlohmann::json mine = {{"config_sha256", key.config_sha256},
                         {"inputs_sha256", key.inputs_sha256},
                         {"program_sha256", key.program_sha256},
                         {"title", title},
                         {"steps", steps}};
  if (study) mine["study"] = true;
  seal_ = mine.dump();
  const nlohmann::json found = manifest_of(folder);
  if (found == mine) {
    resumed_ = study ? part_status(folder).cases > 0
                     : fs::exists(folder / chunk_name("motion", 0)) || fs::exists(folder / chunk_name("truth", 0));
    return;
  }
  if (fs::exists(folder / kManifest) && !force) {
    close(lock_);
    throw Error(kFile, folder.string() + ": is an unfinished run of " +
                           (text_in(found, "config_sha256") != key.config_sha256   ? "another configuration"
                            : text_in(found, "inputs_sha256") != key.inputs_sha256 ? "other input files"
                                                                                   : "another build or machine") +
                           "; --force discards it, or choose another -o");
  }
  empty(folder);
  replace(folder, kManifest, {mine.dump(1)});
}

Part::~Part() {
  if (lock_ >= 0) close(lock_);
}

std::optional<std::string> Part::load(const std::string& name) const {
  std::optional<std::string> bytes = read_all(folder_ / name);
  constexpr std::size_t kHead = sizeof kMagic + 16;
  if (!bytes || bytes->size() < kHead || bytes->compare(0, sizeof kMagic, kMagic, sizeof kMagic) != 0)
    return std::nullopt;
  const std::string_view content = std::string_view(*bytes).substr(kHead);
  if (bytes->compare(sizeof kMagic, 16, checksum(seal_, content)) != 0) {
    std::fprintf(stderr, "warning: %s: is damaged; its steps are computed again\n", (folder_ / name).c_str());
    return std::nullopt;
  }
  bytes->erase(0, kHead);
  return bytes;
}

void Part::save(const std::string& name, const std::string& content) const {
  replace(folder_, name, {std::string_view(kMagic, sizeof kMagic), checksum(seal_, content), content});
}

void Part::remove() {
  empty(folder_);
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void Part::mark_complete() const { replace(folder_, kComplete, {}); }

void Part::remove_complete(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(folder / kComplete, ignored)) return;
  const int lock = open((folder / kLock).c_str(), O_RDWR | O_CLOEXEC);
  if (lock < 0) return;
  if (flock(lock, LOCK_EX | LOCK_NB) == 0) {
    empty(folder);
    fs::remove_all(folder, ignored);
  }
  close(lock);
}

}  // namespace pipeline
