// FILE.part: where a run keeps what it has while it is not finished.
//
// A folder of checksummed chunks, each written beside its place, synced and renamed, so that after kill -9 every chunk
// is either whole or absent. An exclusive lock keeps a second writer out. Nothing is ever erased but files with names
// of our making in a folder whose manifest is ours.
#pragma once
#include <atomic>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "pipeline/system/file_bytes.hpp"

namespace pipeline {

struct Product;

/// Steps per chunk. The integrator is restarted and all memories of algorithms are emptied at these boundaries in
/// every run alike, so that a resumed run has the same bits as one that was never interrupted.
constexpr std::int64_t kChunkSteps = 50;

/// What a part belongs to: resumed only when all of it is equal.
struct CheckpointKey {
  std::string config_sha256;       // of the effective configuration
  std::string program_sha256;      // of the program's own file
  std::string inputs_sha256 = {};  // of the list of all other files read, with their hashes
  bool operator==(const CheckpointKey&) const = default;
};

/// What is in a part, without locking it; for `show`.
struct CheckpointStatus {
  std::string title;
  std::int64_t steps = 0;
  std::int64_t motion_steps = 0, truth_steps = 0, answered_steps = 0;
  const Product* alone = nullptr;  // what is made instead of a scene: then `steps` are its cases
  std::int64_t cases = 0;          // finished
};
CheckpointStatus checkpoint_status(const std::filesystem::path& folder);

class Checkpoint {
 public:
  /// Opens or makes the folder. Throws Error(kFile) when another run holds it, when it belongs to another configuration
  /// or build and `force` is false (with force its files are erased), when it is no folder of ours (also with force),
  /// or when it cannot be written. Of a product that stands `alone`, named so, `steps` are its cases.
  Checkpoint(const std::filesystem::path& folder, const CheckpointKey& key, const std::string& title,
             std::int64_t steps, bool force, const std::string& alone = {});
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  bool resumed() const { return resumed_; }  // it was there before, with chunks

  /// Removes a folder whose run was complete when it was killed (mark_complete), unless another run holds it. For when
  /// the result exists.
  static void remove_complete(const std::filesystem::path& folder);

  /// Notes that nothing is missing but the result's own place.
  void mark_complete() const;

  /// A chunk's content, or nothing when it is absent or damaged. Safe from several threads. Throws Error(kFile) when it
  /// is there and cannot be read.
  std::optional<std::string> load(const std::string& name) const;

  /// Writes a chunk: when this returns it survives a kill and a power cut. Safe from several threads.
  void save(const std::string& name, const std::string& content) const;

  /// Removes the folder; the run is complete. One that cannot be removed is told on stderr.
  void remove();

 private:
  explicit Checkpoint(const std::filesystem::path& folder) : folder_(folder) {}

  bool has(const std::string& name) const;

  std::filesystem::path folder_;
  std::optional<MadeFolders> made_;
  Descriptor opened_, lock_;
  bool resumed_ = false;
  bool worthless_ = false;  // it was begun here: unless something is saved nothing of it stays
  mutable std::atomic<bool> saved_ = false;
  std::string seal_;  // the manifest: part of every chunk's checksum, so that no other run's chunk is ever taken
};

/// Name of the chunk of `stage` that begins at `step`: "truth-0000050".
std::string chunk_name(const std::string& stage, std::int64_t step);

/// Values to bytes, in order. Only for chunks: read again by the same build on the same kind of machine.
class ChunkWriter {
 public:
  template <class T>
  void put(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::uint64_t count = values.size();
    bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
    bytes.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
  }
  void put(const std::string& text) { put(std::vector<char>(text.begin(), text.end())); }

  std::string bytes;
};

/// The counterpart. The checksum has vouched for the bytes: what is too short was made by a programmer's error or by
/// hand; either way nothing is allocated for it.
class ChunkReader {
 public:
  explicit ChunkReader(const std::string& bytes) : bytes_(bytes) {}

  template <class T>
  std::vector<T> get() {
    static_assert(std::is_trivially_copyable_v<T>);
    std::uint64_t count = 0;
    take(&count, sizeof count);
    if (count > (bytes_.size() - at_) / sizeof(T)) take(nullptr, ~std::size_t{0});  // it cannot be there: throws
    std::vector<T> values(count);
    take(values.data(), count * sizeof(T));
    return values;
  }
  /// `count` of them.
  template <class T>
  std::vector<T> get(std::size_t count) {
    std::vector<T> values = get<T>();
    require(values.size() == count);
    return values;
  }
  /// What was read can be what a run of this size keeps.
  void require(bool holds) const {
    if (!holds) throw std::logic_error("a chunk does not hold what a run of this size keeps");
  }
  std::string text() {
    const std::vector<char> letters = get<char>();
    return {letters.begin(), letters.end()};
  }

 private:
  void take(void* to, std::size_t size);

  const std::string& bytes_;
  std::size_t at_ = 0;
};

}  // namespace pipeline
