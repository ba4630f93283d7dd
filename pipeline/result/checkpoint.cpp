#include "pipeline/result/checkpoint.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "pipeline/result/product.hpp"
#include "pipeline/system/input_file.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace fs = std::filesystem;
namespace {

constexpr char kMagic[8] = {'C', 'D', 'C', 'H', 'U', 'N', 'K', '2'};
constexpr const char* kManifest = "manifest.json";
constexpr const char* kLock = "lock";
constexpr const char* kComplete = "complete";  // in the manifest: nothing is missing but the result's own place
constexpr const char* kKind = "collision benchmark checkpoint";
constexpr const char* kStages[] = {"motion", "truth", "answers"};
constexpr std::int64_t kMostSteps = 10000000;      // as the configuration's
constexpr std::uint64_t kMostManifest = 64 << 10;  // bytes; ours have less than 6 KiB

[[noreturn]] void cannot(const fs::path& path, const FileFailure& failure) {
  throw Error(kFile, path.string() + ": " + failure.what() +
                         "; what was finished is kept: free or allow the place and run again");
}

Error in_the_way(const fs::path& folder, const std::string& what) {
  return {kFile, folder.string() + ": is in the way and " + what + "; remove it or choose another -o"};
}

/// Null when there is none; discarded when it is no JSON or cannot be read.
nlohmann::json manifest_of(int folder) {
  try {
    const std::string text = read_regular(folder, kManifest, false, kMostManifest);
    return nlohmann::json::parse(is_shallow(text) ? text : "", nullptr, /*allow_exceptions=*/false);
  } catch (const FileFailure& failure) {
    if (failure.error() == ENOENT) return nullptr;
    return nlohmann::json(nlohmann::json::value_t::discarded);
  }
}

std::string text_in(const nlohmann::json& manifest, const char* name) {
  const bool there = manifest.is_object() && manifest.contains(name) && manifest[name].is_string();
  return there ? manifest[name].get<std::string>() : "";
}

bool is_ours(const nlohmann::json& manifest) { return text_in(manifest, "kind") == kKind; }

bool is_chunk(std::string_view name) {
  const auto of = [&](std::string_view stage) {
    return name.size() >= stage.size() + 8 && name.starts_with(stage) && name[stage.size()] == '-' &&
           name.find_first_not_of("0123456789", stage.size() + 1) == std::string_view::npos;
  };
  return std::ranges::any_of(kStages, of) ||
         std::ranges::any_of(products(), [&](const Product& product) { return product.chunks && of(product.chunks); });
}

/// A file that a kill left behind while it was made.
bool is_leftover(std::string_view name) {
  const auto of = new_file_of(name);
  return of && (*of == kManifest || is_chunk(*of));
}

/// Whether a folder without manifest is one: just begun, or all but removed, when the kill came.
bool is_bare(int folder) {
  return std::ranges::all_of(names_in(folder), [](const std::string& name) {
    return name == kLock || new_file_of(name) == std::string(kManifest);
  });
}

void erase_chunks(int folder) {
  for (const std::string& name : names_in(folder))
    if (is_chunk(name) || is_leftover(name)) remove_regular(folder, name);
}

/// The manifest goes when all else is gone, so that what a kill leaves is still known as ours; the lock goes last.
void erase(int folder) {
  erase_chunks(folder);
  remove_regular(folder, kManifest);
  remove_regular(folder, kLock);
}

std::string checksum(std::string_view seal, std::string_view name, std::string_view content) {
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(), &XXH3_freeState);
  if (!state) throw std::bad_alloc();
  XXH3_128bits_reset(state.get());
  for (const std::string_view part : {seal, name, content}) {
    const std::uint64_t size = part.size();
    XXH3_128bits_update(state.get(), &size, sizeof size);
    XXH3_128bits_update(state.get(), part.data(), part.size());
  }
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state.get()));
  return {reinterpret_cast<const char*>(canonical.digest), sizeof canonical.digest};
}

bool exists(int folder, const std::string& name) {
  return faccessat(folder, name.c_str(), F_OK, AT_SYMLINK_NOFOLLOW) == 0;
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

CheckpointStatus checkpoint_status(const fs::path& folder) {
  Descriptor opened;
  try {
    opened = open_folder(folder);
  } catch (const FileFailure& failure) {
    throw Error(kFile,
                folder.string() + ": " + failure.what() + "; name a result, or the FILE.part of an unfinished run");
  }
  const int in = opened.number();
  const nlohmann::json manifest = manifest_of(in);
  const bool whole = is_ours(manifest) && manifest.contains("steps") && manifest["steps"].is_number_integer();
  CheckpointStatus status{.title = text_in(manifest, "title"),
                          .steps = whole ? manifest["steps"].get<std::int64_t>() : 0};
  if (status.steps < 1 || status.steps > kMostSteps)
    throw Error(kFile, folder.string() + ": is not an unfinished run of this program (no readable " + kManifest + ")");
  for (const Product& product : products())
    if (product.place == Product::Place::alone && manifest.contains(product.name)) status.alone = &product;
  // What is there is counted, not what might be: a manifest can speak of millions.
  for (const std::string& name : names_in(in)) {
    const auto chunk = chunk_of(name);
    if (!chunk || chunk->step >= status.steps) continue;
    if (status.alone) {
      status.cases += chunk->stage == status.alone->chunks;
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

Checkpoint::Checkpoint(const fs::path& folder, const CheckpointKey& key, const std::string& title, std::int64_t steps,
                       bool force, const std::string& alone)
    : Checkpoint(folder) {
  nlohmann::json mine = {{"kind", kKind},
                         {"config_sha256", key.config_sha256},
                         {"inputs_sha256", key.inputs_sha256},
                         {"program_sha256", key.program_sha256},
                         {"title", title},
                         {"steps", steps}};
  if (!alone.empty()) mine[alone] = true;
  seal_ = mine.dump();
  try {
    made_.emplace(folder);
    opened_ = open_folder(folder, /*follow_links=*/false);
    sync_folder(open_folder(folder.parent_path()).number());
    const int in = opened_.number();
    // Before anything is touched: what is not known as ours may be somebody's data.
    if (const auto found = manifest_of(in); found.is_null() ? !is_bare(in) : !is_ours(found))
      throw in_the_way(folder, "not an unfinished run of this program");
    worthless_ = made_->any();
    lock_ = take_lock(in, kLock);
    if (!lock_) {
      worthless_ = false;  // it is the other's
      throw Error(kFile, folder.string() + ": is being written by another run; wait for it or choose another -o");
    }
    for (const std::string& name : names_in(in))
      if (is_leftover(name)) remove_regular(in, name);

    nlohmann::json found = manifest_of(in);
    if (found.is_object()) found.erase(kComplete);
    if (found == mine) {
      resumed_ = !alone.empty() ? checkpoint_status(folder).cases > 0
                                : has(chunk_name("motion", 0)) || has(chunk_name("truth", 0));
      return;
    }
    if (!found.is_null() && !force)
      throw Error(kFile, folder.string() + ": is an unfinished run of " +
                             (text_in(found, "config_sha256") != key.config_sha256   ? "another configuration"
                              : text_in(found, "inputs_sha256") != key.inputs_sha256 ? "other input files"
                                                                                     : "another build or machine") +
                             "; --force discards it, or choose another -o");
    worthless_ = true;
    erase_chunks(in);
    put_file(in, kManifest, {mine.dump(1)});
  } catch (const FileFailure& failure) {
    if (failure.error() == ENOTDIR) throw in_the_way(folder, "not a folder");
    cannot(folder, failure);
  }
}

Checkpoint::~Checkpoint() {
  if (!worthless_ || saved_) return;
  erase(opened_.number());
  rmdir(folder_.c_str());
}

bool Checkpoint::has(const std::string& name) const { return exists(opened_.number(), name); }

std::optional<std::string> Checkpoint::load(const std::string& name) const {
  std::string bytes;
  try {
    bytes = read_regular(opened_.number(), name, /*follow_links=*/false);
  } catch (const FileFailure& failure) {
    if (failure.error() == ENOENT) return std::nullopt;
    throw Error(kFile, (folder_ / name).string() + ": " + failure.what() +
                           "; remove it and run again: its steps are computed anew");
  }
  constexpr std::size_t kHead = sizeof kMagic + 16;
  const bool whole =
      bytes.size() >= kHead && bytes.compare(0, sizeof kMagic, kMagic, sizeof kMagic) == 0 &&
      bytes.compare(sizeof kMagic, 16, checksum(seal_, name, std::string_view(bytes).substr(kHead))) == 0;
  if (!whole) {
    std::fprintf(stderr, "warning: %s: is damaged; its steps are computed again\n", (folder_ / name).c_str());
    return std::nullopt;
  }
  bytes.erase(0, kHead);
  return bytes;
}

void Checkpoint::save(const std::string& name, const std::string& content) const {
  if (!is_chunk(name)) throw std::logic_error(name + ": is no chunk's name");
  try {
    put_file(opened_.number(), name,
             {std::string_view(kMagic, sizeof kMagic), checksum(seal_, name, content), content});
    saved_ = true;
  } catch (const FileFailure& failure) {
    cannot(folder_ / name, failure);
  }
}

void Checkpoint::remove() {
  erase(opened_.number());
  worthless_ = false;
  if (rmdir(folder_.c_str()) == 0) return;
  std::string why = std::strerror(errno);
  const std::vector<std::string> left = names_in(opened_.number());
  if (!left.empty()) why = one_line(left.front()).append(" is in it");
  std::fprintf(stderr, "warning: %s: cannot be removed (%s); it is of no more use: remove it\n", folder_.c_str(),
               why.c_str());
}

void Checkpoint::mark_complete() const {
  nlohmann::json manifest = nlohmann::json::parse(seal_);
  manifest[kComplete] = true;
  saved_ = true;
  try {
    put_file(opened_.number(), kManifest, {manifest.dump(1)});
  } catch (const FileFailure& failure) {
    cannot(folder_, failure);
  }
}

void Checkpoint::remove_complete(const fs::path& folder) {
  try {
    const Descriptor opened = open_folder(folder, /*follow_links=*/false);
    const int in = opened.number();
    const nlohmann::json manifest = manifest_of(in);
    if (manifest.is_null() ? !is_bare(in) : !is_ours(manifest) || !manifest.contains(kComplete)) return;
    const Descriptor lock = take_lock(in, kLock);
    if (!lock) return;
    erase(in);
    rmdir(folder.c_str());
  } catch (const FileFailure&) {  // it is not there, or the run says what is wrong with it
  }
}

}  // namespace pipeline
