// FILE.part: where a run keeps what it has while it is not finished.
//
// A folder of checksummed chunks, each written beside its place, synced and renamed, so that after kill -9 every chunk
// is either whole or absent. An exclusive lock keeps a second run out; workers (`pipeline work`) fill chunks beside the
// run and beside each other, each under a lease of its own (pipeline/system/lease.hpp): "truth-0000050.claim". Two that
// make the same chunk, since the lease of one that was stopped ran out, make the same but for times: the first stays.
// Nothing is ever erased but files with names of our making in a folder whose manifest is ours.
#pragma once
#include <atomic>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "pipeline/system/file_bytes.hpp"
#include "pipeline/system/lease.hpp"

namespace pipeline {

struct Product;

/// Steps per chunk. The integrator is restarted and all memories of algorithms are emptied at these boundaries in
/// every run alike, so that a resumed run has the same bits as one that was never interrupted.
constexpr std::int64_t kChunkSteps = 50;

/// How long a chunk stays that of a worker that does not renew its lease.
constexpr Lease::Seconds kLease{60};

/// What a part belongs to: resumed only when all of it is equal; the machine no more once the motion is made, which
/// alone depends on it.
struct CheckpointKey {
  std::string config_sha256;        // of the effective configuration
  std::string program_sha256;       // of the program's own file
  std::string inputs_sha256 = {};   // of the list of all other files read, with their hashes
  std::string machine_sha256 = {};  // of the libraries and the processor that the motion is made by
  bool operator==(const CheckpointKey&) const = default;
};

/// What is in a part, without locking it; for `show`.
struct CheckpointStatus {
  std::string title;
  std::int64_t steps = 0;
  std::int64_t motion_steps = 0, truth_steps = 0, answered_steps = 0;
  bool moved = false;                  // the motion is made
  std::vector<std::string> held = {};  // "answers-0000050 by process 4711 on n2": chunks that are being made
  const Product* alone = nullptr;      // what is made instead of a scene: then `steps` are its cases
  std::int64_t cases = 0;              // finished
};
CheckpointStatus checkpoint_status(const std::filesystem::path& folder);

class Checkpoint {
 public:
  /// Opens or makes the folder. Throws Error(kFile) when another run holds it, when it belongs to another configuration
  /// or build and `force` is false (with force its files are erased), when it is no folder of ours (also with force),
  /// or when it cannot be written. Of a product that stands `alone`, named so, `steps` are its cases.
  Checkpoint(const std::filesystem::path& folder, const CheckpointKey& key, const std::string& title,
             std::int64_t steps, bool force, const std::string& alone = {});

  /// Opens one that is there as a worker, without the lock. Throws Error(kFile) when it is none, or a product's that
  /// stands alone.
  explicit Checkpoint(const std::filesystem::path& folder, Lease::Seconds lease = kLease);
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  bool resumed() const { return resumed_; }  // it was there before, with chunks

  /// Removes a folder whose run was complete when it was killed (mark_complete), unless another run holds it. For when
  /// the result exists.
  static void remove_complete(const std::filesystem::path& folder);

  /// Of a worker's: throws Error(kFile) that says so when it does not belong to `key`, whatever the machine. `given`:
  /// what the key was made of, to be named.
  void require(const CheckpointKey& key, const std::string& given) const;

  /// Steps, as the manifest of a worker's has them.
  std::int64_t steps() const { return steps_; }

  /// What has become of a worker's part.
  enum class State {
    open,
    complete,  // nothing is missing, or it is gone, as it is when the run has ended
    another,   // it is another run's now
  };
  State state() const;

  /// Keeps what a worker has to know: the effective configuration, and where it was read from.
  void describe(const std::string& configuration, const std::filesystem::path& from) const;
  struct Description {
    std::string configuration;
    std::filesystem::path from;
  };
  std::optional<Description> description() const;

  /// Its motion was made by another kind of machine: what is missing of it cannot be made here.
  bool moved_elsewhere() const { return moved_elsewhere_; }

  /// Notes that the motion is made: of an integrated scene all its chunks are there, up to the one that failed.
  void mark_moved();
  bool moved() const;

  /// It stays, though no chunk is saved.
  void keep() { saved_ = true; }

  /// Notes that nothing is missing but the result's own place.
  void mark_complete() const;

  /// Whether there is a chunk of that name, whole or not.
  bool has(const std::string& name) const;

  /// Takes the making of a chunk, and keeps it while the lease lives; null when another makes it. Safe from several
  /// threads. Throws Error(kFile).
  std::unique_ptr<Lease> claim(const std::string& name) const;
  /// Whether another does, who may be alive.
  bool claimed(const std::string& name) const;
  /// "process 4711 on n2", of who does; may be empty.
  std::string claimant(const std::string& name) const;

  /// A chunk's content, or nothing when it is absent or damaged. Safe from several threads. Throws Error(kFile) when it
  /// is there and cannot be read.
  std::optional<std::string> load(const std::string& name) const;

  /// Writes a chunk: when this returns it survives a kill and a power cut. Where a whole one is already, another's that
  /// was quicker, that one stays. Safe from several threads.
  void save(const std::string& name, const std::string& content) const;

  /// Removes the folder; the run is complete. One that cannot be removed is told on stderr.
  void remove();

 private:
  struct Begun {};
  Checkpoint(const std::filesystem::path& folder, Begun) : folder_(folder) {}

  std::optional<std::string> whole(const std::string& name, bool warn) const;
  void put(const std::string& name, const std::string& content, bool replace) const;
  void note(const char* what) const;

  std::filesystem::path folder_;
  std::optional<MadeFolders> made_;
  Descriptor opened_, lock_;
  Lease::Seconds lease_ = kLease;
  std::int64_t steps_ = 0;
  bool moved_ = false, moved_elsewhere_ = false;
  bool resumed_ = false;
  bool worthless_ = false;  // it was begun here: unless something is saved nothing of it stays
  mutable std::atomic<bool> saved_ = false;
  std::string seal_;  // the manifest, but for what is noted in it later: part of every chunk's checksum, so that no
                      // other run's chunk is ever taken
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
