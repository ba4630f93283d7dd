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
// Notes in the manifest, no part of the seal: the motion is made; nothing is missing but the result's own place.
constexpr const char* kMoved = "moved";
constexpr const char* kComplete = "complete";
constexpr const char* kKind = "collision benchmark checkpoint";
constexpr const char* kMachine = "machine_sha256";
constexpr const char* kDescription = "configuration";
constexpr const char* kStages[] = {"motion", "truth", "answers", kDescription};
constexpr std::string_view kClaim = ".claim";
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
    if (failure.error() == ENOENT || failure.error() == ESTALE) return nullptr;
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

bool is_claim(std::string_view name) {
  return name.ends_with(kClaim) && is_chunk(name.substr(0, name.size() - kClaim.size()));
}

std::string claim_of(const std::string& chunk) { return chunk + std::string(kClaim); }

/// A file that a kill left behind while it was made, unless it is being made.
bool is_leftover(std::string_view name) {
  const auto of = new_file_of(name);
  return of && (*of == kManifest || is_chunk(*of) || is_claim(*of));
}

/// What a manifest says of its run, without what was noted later.
nlohmann::json without_notes(nlohmann::json manifest) {
  if (manifest.is_object())
    for (const char* note : {kMoved, kComplete}) manifest.erase(note);
  return manifest;
}

nlohmann::json without_machine(nlohmann::json manifest) {
  if (manifest.is_object()) manifest.erase(kMachine);
  return manifest;
}

bool notes(const nlohmann::json& manifest, const char* note) {
  return manifest.is_object() && manifest.contains(note) && manifest[note] == true;
}

/// Removes claims of the dead, and what they left unfinished. What belongs to a claim that may be alive stays, and one
/// that cannot be read: whoever needs its chunk says so.
void sweep(int folder, Lease::Seconds lease) {
  const std::vector<std::string> names = names_in(folder);
  const auto taken = [&](const std::string& chunk) {
    return std::ranges::find(names, claim_of(chunk)) != names.end() && is_leased(folder, claim_of(chunk), lease);
  };
  for (const std::string& name : names) {
    try {
      if (is_claim(name)) take_lease(folder, name, lease);  // and gives it back, where its holder is dead
      if (!is_leftover(name)) continue;
      const std::string of = *new_file_of(name);
      const bool of_claim = is_claim(of);
      if (of == kManifest || !taken(of_claim ? of.substr(0, of.size() - kClaim.size()) : of))
        remove_regular(folder, name);
    } catch (const FileFailure&) {
    }
  }
}

/// Whether a folder without manifest is one: just begun, or all but removed, when the kill came.
bool is_bare(int folder) {
  return std::ranges::all_of(names_in(folder), [](const std::string& name) {
    return name == kLock || new_file_of(name) == std::string(kManifest);
  });
}

void erase_chunks(int folder) {
  for (const std::string& name : names_in(folder))
    if (is_chunk(name) || is_claim(name) || is_leftover(name)) remove_regular(folder, name);
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
  status.moved = notes(manifest, kMoved);
  // What is there is counted, not what might be: a manifest can speak of millions.
  for (const std::string& name : names_in(in)) {
    if (is_claim(name))
      if (const std::string who = holder_text(in, name); !who.empty())
        status.held.push_back(name.substr(0, name.size() - kClaim.size()) + " by " + who);
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
    : Checkpoint(folder, Begun{}) {
  steps_ = steps;
  nlohmann::json mine = {{"kind", kKind},
                         {"config_sha256", key.config_sha256},
                         {"inputs_sha256", key.inputs_sha256},
                         {"program_sha256", key.program_sha256},
                         {kMachine, key.machine_sha256},
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
    sweep(in, lease_);

    nlohmann::json found = manifest_of(in);
    moved_ = notes(found, kMoved);
    found = without_notes(std::move(found));
    if (found == mine || (moved_ && without_machine(found) == without_machine(mine))) {
      moved_elsewhere_ = found != mine;
      seal_ = found.dump();
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
    moved_ = false;
    erase_chunks(in);
    put_file(in, kManifest, {mine.dump(1)});
  } catch (const FileFailure& failure) {
    if (failure.error() == ENOTDIR) throw in_the_way(folder, "not a folder");
    cannot(folder, failure);
  }
}

Checkpoint::Checkpoint(const fs::path& folder, Lease::Seconds lease) : Checkpoint(folder, Begun{}) {
  const CheckpointStatus status = checkpoint_status(folder);
  if (status.alone)
    throw Error(kFile, folder.string() + ": is an unfinished " + status.alone->name +
                           ", which has no chunks to share; the same `pipeline run` resumes it");
  lease_ = lease;
  steps_ = status.steps;
  try {
    opened_ = open_folder(folder);
    const nlohmann::json found = manifest_of(opened_.number());
    moved_ = notes(found, kMoved);
    seal_ = without_notes(found).dump();
  } catch (const FileFailure& failure) {
    cannot(folder, failure);
  }
}

Checkpoint::~Checkpoint() {
  if (!worthless_ || saved_) return;
  const auto of_worth = [](const std::string& name) { return is_chunk(name) && !name.starts_with(kDescription); };
  if (std::ranges::any_of(names_in(opened_.number()), of_worth)) return;  // workers were quicker
  erase(opened_.number());
  rmdir(folder_.c_str());
}

void Checkpoint::require(const CheckpointKey& key, const std::string& given) const {
  const auto found = nlohmann::json::parse(seal_, nullptr, false);
  const char* other = text_in(found, "config_sha256") != key.config_sha256     ? "another configuration"
                      : text_in(found, "inputs_sha256") != key.inputs_sha256   ? "other input files"
                      : text_in(found, "program_sha256") != key.program_sha256 ? "another build"
                                                                               : nullptr;
  if (!other) return;
  throw Error(kFile, folder_.string() + ": is an unfinished run of " + other + " than " + given +
                         "; work on it with what it was begun with");
}

Checkpoint::State Checkpoint::state() const {
  const nlohmann::json now = manifest_of(opened_.number());
  if (now.is_null() || notes(now, kComplete)) return State::complete;
  return without_notes(now).dump() == seal_ ? State::open : State::another;
}

void Checkpoint::describe(const std::string& configuration, const fs::path& from) const {
  const std::string content = nlohmann::json{{"configuration", configuration}, {"from", from.string()}}.dump(
      -1, ' ', false, nlohmann::json::error_handler_t::replace);
  const std::string name = chunk_name(kDescription, 0);
  if (whole(name, /*warn=*/false) != content) put(name, content, /*replace=*/true);
}

std::optional<Checkpoint::Description> Checkpoint::description() const {
  const auto json = nlohmann::json::parse(whole(chunk_name(kDescription, 0), true).value_or(""), nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return Description{text_in(json, "configuration"), text_in(json, "from")};
}

void Checkpoint::mark_moved() {
  if (moved_) return;
  note(kMoved);
  moved_ = true;
}

bool Checkpoint::moved() const { return moved_ || notes(manifest_of(opened_.number()), kMoved); }

bool Checkpoint::has(const std::string& name) const { return exists(opened_.number(), name); }

std::unique_ptr<Lease> Checkpoint::claim(const std::string& name) const {
  try {
    return take_lease(opened_.number(), claim_of(name), lease_);
  } catch (const FileFailure& failure) {
    cannot(folder_ / claim_of(name), failure);
  }
}

bool Checkpoint::claimed(const std::string& name) const {
  try {
    return is_leased(opened_.number(), claim_of(name), lease_);
  } catch (const FileFailure& failure) {
    cannot(folder_ / claim_of(name), failure);
  }
}

std::string Checkpoint::claimant(const std::string& name) const {
  return holder_text(opened_.number(), claim_of(name));
}

std::optional<std::string> Checkpoint::load(const std::string& name) const { return whole(name, /*warn=*/true); }

std::optional<std::string> Checkpoint::whole(const std::string& name, bool warn) const {
  std::string bytes;
  try {
    bytes = read_regular(opened_.number(), name, /*follow_links=*/false);
  } catch (const FileFailure& failure) {
    if (failure.error() == ENOENT || failure.error() == ESTALE) return std::nullopt;
    throw Error(kFile, (folder_ / name).string() + ": " + failure.what() +
                           "; remove it and run again: its steps are computed anew");
  }
  constexpr std::size_t kHead = sizeof kMagic + 16;
  const bool holds =
      bytes.size() >= kHead && bytes.compare(0, sizeof kMagic, kMagic, sizeof kMagic) == 0 &&
      bytes.compare(sizeof kMagic, 16, checksum(seal_, name, std::string_view(bytes).substr(kHead))) == 0;
  if (!holds) {
    if (warn) std::fprintf(stderr, "warning: %s: is damaged; its steps are computed again\n", (folder_ / name).c_str());
    return std::nullopt;
  }
  bytes.erase(0, kHead);
  return bytes;
}

void Checkpoint::save(const std::string& name, const std::string& content) const {
  if (!is_chunk(name)) throw std::logic_error(name + ": is no chunk's name");
  put(name, content, /*replace=*/false);
  saved_ = true;
}

void Checkpoint::put(const std::string& name, const std::string& content, bool replace) const {
  const auto there = [&] {
    try {
      return whole(name, /*warn=*/false).has_value();
    } catch (const Error&) {  // a link, say, is not followed
      return false;
    }
  };
  try {
    NewFile file(opened_.number(), name);
    file.write({std::string_view(kMagic, sizeof kMagic), checksum(seal_, name, content), content});
    try {
      file.place(replace);
    } catch (const FileFailure& failure) {
      if (there()) return;
      if (failure.error() != EEXIST) throw;
      file.place(true);  // what is there is damaged
    }
  } catch (const FileFailure& failure) {
    cannot(folder_ / name, failure);
  }
}

void Checkpoint::remove() {
  // A worker that was stopped beyond its lease may put something there yet.
  constexpr int kTries = 3;
  for (int i = 0; i < kTries; ++i) {
    erase(opened_.number());
    worthless_ = false;
    if (rmdir(folder_.c_str()) == 0) return;
  }
  std::string why = std::strerror(errno);
  const std::vector<std::string> left = names_in(opened_.number());
  if (!left.empty()) why = one_line(left.front()).append(" is in it");
  std::fprintf(stderr, "warning: %s: cannot be removed (%s); it is of no more use: remove it\n", folder_.c_str(),
               why.c_str());
}

void Checkpoint::note(const char* what) const {
  nlohmann::json manifest = nlohmann::json::parse(seal_);
  if (moved_) manifest[kMoved] = true;
  manifest[what] = true;
  try {
    put_file(opened_.number(), kManifest, {manifest.dump(1)});
  } catch (const FileFailure& failure) {
    cannot(folder_, failure);
  }
}

void Checkpoint::mark_complete() const {
  saved_ = true;
  note(kComplete);
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
