#include "pipeline/truth.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <thread>

#include "geometry/meet.hpp"

namespace pipeline {
namespace {

struct TruthChunk {
  PairLists hits;
  std::vector<std::int64_t> time_ns;

  std::string bytes() const {
    ChunkWriter out;
    out.put(hits.offset);
    out.put(hits.pair);
    out.put(time_ns);
    return out.bytes;
  }
  static TruthChunk from(const std::string& bytes) {
    ChunkReader in(bytes);
    TruthChunk chunk;
    chunk.hits.offset = in.get<std::uint64_t>();
    chunk.hits.pair = in.get<Pair>();
    chunk.time_ns = in.get<std::int64_t>();
    return chunk;
  }
};

TruthChunk decide_chunk(geometry::Decision& decision, const geometry::Bodies& bodies,
                        std::span<const std::vector<geometry::Pose>> poses, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  TruthChunk chunk;
  for (const auto& step : poses) {
    stop_if_wanted();
    const auto start = Clock::now();
    chunk.hits.append(decision.hits(step, geometry::pair_runs(bodies, step)));
    chunk.time_ns.push_back(std::chrono::nanoseconds(Clock::now() - start).count());
    progress.add(1);
  }
  return chunk;
}

}  // namespace

Truth decide(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses, int threads,
             const Part& part, Progress& progress) {
  const std::size_t chunks = (poses.size() + kChunkSteps - 1) / kChunkSteps;
  std::vector<TruthChunk> done(chunks);
  std::vector<std::size_t> open;
  for (std::size_t c = 0; c < chunks; ++c) {
    if (const auto kept = part.load(chunk_name("truth", std::int64_t(c) * kChunkSteps))) {
      done[c] = TruthChunk::from(*kept);
      progress.add(done[c].time_ns.size(), false);
    } else {
      open.push_back(c);
    }
  }

  if (!open.empty()) {
    const std::vector<geometry::Bvh> bvhs = geometry::build_bvhs(bodies);
    const std::size_t workers = std::min<std::size_t>(std::size_t(std::max(threads, 1)), open.size());
    std::atomic<std::size_t> next = 0;
    std::vector<std::exception_ptr> errors(workers);
    const auto work = [&](std::size_t worker) {
      try {
        geometry::Decision decision(bodies, bvhs);
        for (std::size_t i = next++; i < open.size(); i = next++) {
          const std::size_t first = open[i] * kChunkSteps;
          const std::size_t count = std::min<std::size_t>(kChunkSteps, poses.size() - first);
          TruthChunk chunk = decide_chunk(decision, bodies, std::span(poses).subspan(first, count), progress);
          part.save(chunk_name("truth", std::int64_t(first)), chunk.bytes());
          done[open[i]] = std::move(chunk);
        }
      } catch (...) {
        errors[worker] = std::current_exception();
        next = open.size();  // the others finish their chunk and stop
      }
    };
    std::vector<std::jthread> others;
    for (std::size_t worker = 1; worker < workers; ++worker) others.emplace_back(work, worker);
    work(0);
    others.clear();  // joins
    for (const auto& error : errors)
      if (error) std::rethrow_exception(error);
  }

  Truth truth;
  for (const TruthChunk& chunk : done) {
    for (std::size_t s = 0; s < chunk.hits.steps(); ++s) truth.hits.append(chunk.hits.at(s));
    truth.time_ns.insert(truth.time_ns.end(), chunk.time_ns.begin(), chunk.time_ns.end());
  }
  return truth;
}

}  // namespace pipeline
