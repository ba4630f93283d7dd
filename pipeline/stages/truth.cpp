#include "pipeline/stages/truth.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>

#include "geometry/decision/gap.hpp"
#include "geometry/decision/meet.hpp"
#include "pipeline/result/products/gaps.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/system/threads.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

struct TruthChunk {
  PairLists hits, contained;
  std::vector<std::uint32_t> inside;  // of `contained`
  std::vector<std::int64_t> time_ns;
  std::optional<GapLists> gaps;

  std::string bytes() const {
    ChunkWriter out;
    out.put(hits.offset);
    out.put(hits.pair);
    out.put(contained.offset);
    out.put(contained.pair);
    out.put(inside);
    out.put(time_ns);
    if (gaps) {
      out.put(gaps->pairs.offset);
      out.put(gaps->pairs.pair);
      each_gap_column([&](const auto& column) { out.put((*gaps).*column.member); });
    }
    return out.bytes;
  }
  static TruthChunk from(const std::string& bytes, std::size_t steps, std::size_t bodies, bool lists_contained,
                         bool has_gaps) {
    ChunkReader in(bytes);
    TruthChunk chunk;
    chunk.hits.offset = in.get<std::uint64_t>();
    chunk.hits.pair = in.get<Pair>();
    in.require(sound(chunk.hits, steps, bodies));
    chunk.contained.offset = in.get<std::uint64_t>();
    chunk.contained.pair = in.get<Pair>();
    in.require(sound(chunk.contained, lists_contained ? steps : 0, bodies));
    chunk.inside = in.get<std::uint32_t>(chunk.contained.pair.size());
    for (std::size_t i = 0; i < chunk.inside.size(); ++i)
      in.require(chunk.inside[i] == chunk.contained.pair[i].a || chunk.inside[i] == chunk.contained.pair[i].b);
    chunk.time_ns = in.get<std::int64_t>(steps);
    if (has_gaps) {
      chunk.gaps.emplace();
      chunk.gaps->pairs.offset = in.get<std::uint64_t>();
      chunk.gaps->pairs.pair = in.get<Pair>();
      in.require(sound(chunk.gaps->pairs, steps, bodies));
      each_gap_column(
          [&](const auto& column) { (*chunk.gaps).*column.member = in.get<double>(chunk.gaps->pairs.pair.size()); });
    }
    return chunk;
  }
};

void append(const std::vector<geometry::Gap>& step, GapLists& out) {
  std::vector<Pair> pairs;
  for (const geometry::Gap& gap : step) {
    pairs.push_back(gap.pair);
    out.lower.push_back(gap.metres.lower);
    out.upper.push_back(gap.metres.upper);
  }
  out.pairs.append(pairs);
}

/// `search` is null where no gaps are asked for.
TruthChunk decide_chunk(geometry::Decision& decision, geometry::GapSearch* search, double gap_margin,
                        const geometry::Bodies& bodies, std::span<const std::vector<geometry::Pose>> poses,
                        bool wants_contained, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  TruthChunk chunk;
  if (search) chunk.gaps.emplace();
  std::vector<Pair> hits, pairs;
  std::vector<geometry::Contained> contained;
  decision.forget();  // the chunk decided before need not be the one before in time
  for (const auto& step : poses) {
    stop_if_wanted();
    const auto start = Clock::now();
    const std::vector<geometry::PairRun> runs = geometry::pair_runs(bodies, step);
    hits.clear();
    contained.clear();
    decision.prepare(step);
    decision.hits(runs, hits, wants_contained ? &contained : nullptr);
    decision.remember();
    chunk.hits.append(hits);
    pairs.clear();
    for (const geometry::Contained& one : contained) {
      pairs.push_back(one.pair);
      chunk.inside.push_back(one.inside);
    }
    if (wants_contained) chunk.contained.append(pairs);
    chunk.time_ns.push_back(std::chrono::nanoseconds(Clock::now() - start).count());
    if (search) append(search->near(step, runs, gap_margin, hits), *chunk.gaps);
    progress.add(1);
  }
  return chunk;
}

}  // namespace

Truth decide(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses, int threads,
             const Checkpoint& part, Progress& progress, Containment containment, std::optional<double> gap_margin) {
  Truth truth;
  truth.containment = containment;
  if (gap_margin) truth.gaps.emplace().margin = *gap_margin;
  const std::size_t chunks = (poses.size() + kChunkSteps - 1) / kChunkSteps;
  std::vector<TruthChunk> done(chunks);
  std::vector<std::size_t> open;
  for (std::size_t c = 0; c < chunks; ++c) {
    if (const auto kept = part.load(chunk_name("truth", std::int64_t(c) * kChunkSteps))) {
      const std::size_t steps = std::min<std::size_t>(kChunkSteps, poses.size() - c * kChunkSteps);
      done[c] = TruthChunk::from(*kept, steps, bodies.size(), truth.lists_contained(), gap_margin.has_value());
      progress.add(done[c].time_ns.size(), false);
    } else {
      open.push_back(c);
    }
  }

  std::vector<geometry::Solid> solids;
  if (truth.lists_contained()) {
    truth.contained_inside.emplace();
    for (const geometry::Mesh& mesh : bodies.meshes) {
      solids.push_back(geometry::solid_of(mesh, bodies.closed_within));
      truth.closed_within.push_back(solids.back().closed_within);
    }
    if (std::ranges::none_of(solids, &geometry::Solid::closed))
      throw Error(kInput, all_open_text(bodies.meshes[0].name, solids[0]));
  }
  if (!open.empty()) {
    const std::vector<geometry::Bvh> bvhs = geometry::build_bvhs(bodies);
    const std::size_t workers = std::min<std::size_t>(std::size_t(std::max(threads, 1)), open.size());
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
      geometry::Decision decision(bodies, bvhs, solids);
      std::optional<geometry::GapSearch> search;
      if (gap_margin) search.emplace(bodies, bvhs);
      for (std::size_t i = next++; i < open.size(); i = next++) {
        const std::size_t first = open[i] * kChunkSteps;
        const std::size_t count = std::min<std::size_t>(kChunkSteps, poses.size() - first);
        TruthChunk chunk = decide_chunk(decision, search ? &*search : nullptr, gap_margin.value_or(0), bodies,
                                        std::span(poses).subspan(first, count), truth.lists_contained(), progress);
        part.save(chunk_name("truth", std::int64_t(first)), chunk.bytes());
        done[open[i]] = std::move(chunk);
      }
    };
    on_threads(workers, work, [&] { next = open.size(); });  // the others finish their chunk and stop
  }

  for (TruthChunk& each : done) {
    const TruthChunk chunk = std::move(each);  // freed here: not all is there twice
    truth.hits.append_steps(chunk.hits);
    truth.contained.append_steps(chunk.contained);
    if (truth.contained_inside)
      truth.contained_inside->insert(truth.contained_inside->end(), chunk.inside.begin(), chunk.inside.end());
    truth.time_ns.insert(truth.time_ns.end(), chunk.time_ns.begin(), chunk.time_ns.end());
    if (!truth.gaps) continue;
    GapLists& gaps = *truth.gaps;
    gaps.pairs.append_steps(chunk.gaps->pairs);
    each_gap_column([&](const auto& column) {
      const std::vector<double>& more = (*chunk.gaps).*column.member;
      (gaps.*column.member).insert((gaps.*column.member).end(), more.begin(), more.end());
    });
  }
  return truth;
}

}  // namespace pipeline
