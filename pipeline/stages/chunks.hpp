// The chunks of a stage, made here and by others that work on the same part (pipeline/result/checkpoint.hpp).
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/result/checkpoint.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {

/// Steps of a chunk: first up to, not including, last.
struct ChunkSteps {
  std::int64_t first = 0, last = 0;
  std::size_t count() const { return std::size_t(last - first); }
};

/// Those of chunk number `chunk` of a run of `steps` steps, and how many chunks it has.
ChunkSteps steps_of_chunk(std::size_t chunk, std::int64_t steps);
std::size_t chunk_count(std::int64_t steps);

/// A stage that makes its chunks in any order, each the same whoever makes it, but for times.
struct ChunkStage {
  std::string name;  // of its chunks: "truth"
  std::int64_t steps = 0;
  int threads = 1;                                    // that call `make` at once
  std::function<std::string(ChunkSteps)> make;        // a chunk's bytes
  std::function<bool(std::size_t chunk)> ready = {};  // what it is made from is there; absent: always
  std::function<void(std::string, std::size_t)> keep =
      {};  // is given every chunk, by its number; absent: nobody needs it
};

/// What one look at the chunks of a stage came to.
struct Look {
  std::size_t made = 0;     // here and now
  std::size_t missing = 0;  // still, of them:
  std::string held;         // a chunk that somebody else makes
};

/// Makes the chunks that are not `there` yet, nor made by others, nor unready: at most `most` of them. Marks in `there`
/// (one flag a chunk) what was made or found.
Look look_after(const ChunkStage& stage, const Checkpoint& part, std::vector<char>& there, Progress& progress,
                std::size_t most = std::numeric_limits<std::size_t>::max());

/// Every chunk in order: those that `part` holds are taken from it, others made, or waited for where others make them.
/// `part` may be null.
std::vector<std::string> all_chunks(ChunkStage stage, const Checkpoint* part, Progress& progress);

/// Sleeps a moment for others. Throws Error(kInterrupted).
void wait_a_moment();

}  // namespace pipeline
