#include "pipeline/stages/chunks.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>

#include "pipeline/system/threads.hpp"

namespace pipeline {

ChunkSteps steps_of_chunk(std::size_t chunk, std::int64_t steps) {
  const std::int64_t first = std::int64_t(chunk) * kChunkSteps;
  return {first, std::min(first + kChunkSteps, steps)};
}

std::size_t chunk_count(std::int64_t steps) { return std::size_t((steps + kChunkSteps - 1) / kChunkSteps); }

Look look_after(const ChunkStage& stage, const Checkpoint& part, std::vector<char>& there, Progress& progress,
                std::size_t most) {
  std::mutex mutex;  // of what follows
  Look look;
  const auto missing = [&](const std::string& held) {
    const std::scoped_lock lock(mutex);
    ++look.missing;
    if (!held.empty()) look.held = held;
  };
  const auto found = [&](std::size_t chunk, std::string bytes, bool made) {
    if (!made) progress.add(steps_of_chunk(chunk, stage.steps).count(), false);
    const std::scoped_lock lock(mutex);
    there[chunk] = 1;
    look.made += made;
    if (stage.keep) stage.keep(std::move(bytes), chunk);
  };
  std::atomic<std::size_t> next = 0, begun = 0;
  const auto after = [&](std::size_t chunk) {
    const std::string name = chunk_name(stage.name, steps_of_chunk(chunk, stage.steps).first);
    if (auto kept = part.load(name)) return found(chunk, std::move(*kept), false);
    if (stage.ready && !stage.ready(chunk)) return missing("");
    if (begun++ >= most) return missing("");
    const auto lease = part.claim(name);
    if (!lease) {
      --begun;
      return missing(name);
    }
    if (part.has(name))  // by now
      if (auto kept = part.load(name)) return found(chunk, std::move(*kept), false);
    std::string bytes = stage.make(steps_of_chunk(chunk, stage.steps));
    part.save(name, bytes);
    found(chunk, std::move(bytes), true);
  };
  const auto work = [&] {
    for (std::size_t chunk = next++; chunk < there.size(); chunk = next++)
      if (!there[chunk]) after(chunk);
  };
  const auto left = std::size_t(std::ranges::count(there, char{0}));
  on_threads(std::clamp<std::size_t>(std::min(left, most), 1, std::size_t(std::max(stage.threads, 1))), work,
             [&] { next = there.size(); });  // the others finish their chunk and stop
  return look;
}

std::vector<std::string> all_chunks(ChunkStage stage, const Checkpoint* part, Progress& progress) {
  std::vector<std::string> all(chunk_count(stage.steps));
  if (!part) {
    for (std::size_t chunk = 0; chunk < all.size(); ++chunk)
      all[chunk] = stage.make(steps_of_chunk(chunk, stage.steps));
    return all;
  }
  stage.keep = [&](std::string bytes, std::size_t chunk) { all[chunk] = std::move(bytes); };
  std::vector<char> there(all.size());
  bool said = false;
  for (;;) {
    const Look look = look_after(stage, *part, there, progress);
    if (look.missing == 0) return all;
    if (look.held.empty() || look.made > 0) continue;
    if (!said) progress.say(look.held + " is made by " + part->claimant(look.held) + "; waiting for it");
    said = true;
    wait_a_moment();
  }
}

void wait_a_moment() {
  constexpr std::chrono::milliseconds kLook{50};
  constexpr int kLooks = 10;
  for (int i = 0; i < kLooks; ++i) {
    stop_if_wanted();
    std::this_thread::sleep_for(kLook);
  }
}

}  // namespace pipeline
