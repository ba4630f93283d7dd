#include "pipeline/stages/truth.hpp"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <utility>

#include "geometry/decision/gap.hpp"
#include "geometry/decision/meet.hpp"
#include "pipeline/result/answer_chunk.hpp"
#include "pipeline/result/products/gaps.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/chunks.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

struct TruthChunk {
  PairLists hits, contained;
  std::vector<std::uint32_t> inside;  // of `contained`
  std::vector<std::int64_t> time_ns;
  std::optional<GapLists> gaps;
  Machine machine;

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
    put_machine(machine, out);
    return std::move(out.bytes);  // a member: it would be copied
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
    chunk.machine = get_machine(in);
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

/// What one thread decides with.
struct TruthChunks::Deciding {
  geometry::Decision decision;
  std::optional<geometry::GapSearch> search;

  Deciding(const geometry::Bodies& bodies, const std::vector<geometry::Bvh>& bvhs,
           const std::vector<geometry::Solid>& solids, bool gaps)
      : decision(bodies, bvhs, solids) {
    if (gaps) search.emplace(bodies, bvhs);
  }
};

struct TruthChunks::Shared {
  const geometry::Bodies& bodies;
  TruthRules rules;
  Machine here = machine();
  std::vector<geometry::Solid> solids = {};
  std::vector<geometry::Bvh> bvhs = {};  // made when a chunk is
  std::mutex mutex = {};
  std::vector<std::unique_ptr<Deciding>> idle = {};

  std::unique_ptr<Deciding> taken() {
    const std::scoped_lock lock(mutex);
    if (bvhs.empty()) bvhs = geometry::build_bvhs(bodies);
    if (idle.empty()) return std::make_unique<Deciding>(bodies, bvhs, solids, rules.gap_margin.has_value());
    auto one = std::move(idle.back());
    idle.pop_back();
    return one;
  }
  bool lists_contained() const { return rules.containment != Containment::ignore; }
};

TruthChunks::TruthChunks(const geometry::Bodies& bodies, const TruthRules& rules) : shared_(new Shared{bodies, rules}) {
  if (!shared_->lists_contained()) return;
  for (const geometry::Mesh& mesh : bodies.meshes)
    shared_->solids.push_back(geometry::solid_of(mesh, bodies.closed_within));
  if (std::ranges::none_of(shared_->solids, &geometry::Solid::closed))
    throw Error(kInput, all_open_text(bodies.meshes[0].name, shared_->solids[0]));
}

TruthChunks::~TruthChunks() = default;

std::string TruthChunks::make(std::span<const std::vector<geometry::Pose>> poses, Progress& progress) {
  auto with = shared_->taken();
  TruthChunk chunk =
      decide_chunk(with->decision, with->search ? &*with->search : nullptr, shared_->rules.gap_margin.value_or(0),
                   shared_->bodies, poses, shared_->lists_contained(), progress);
  chunk.machine = shared_->here;
  const std::scoped_lock lock(shared_->mutex);
  shared_->idle.push_back(std::move(with));
  return chunk.bytes();
}

Truth TruthChunks::none() const {
  Truth truth;
  truth.containment = shared_->rules.containment;
  if (shared_->rules.gap_margin) truth.gaps.emplace().margin = *shared_->rules.gap_margin;
  if (!truth.lists_contained()) return truth;
  truth.contained_inside.emplace();
  for (const geometry::Solid& solid : shared_->solids) truth.closed_within.push_back(solid.closed_within);
  return truth;
}

void TruthChunks::append(const std::string& bytes, std::size_t steps, Truth& truth) const {
  const TruthChunk chunk = TruthChunk::from(bytes, steps, shared_->bodies.size(), truth.lists_contained(),
                                            shared_->rules.gap_margin.has_value());
  note_machine(chunk.machine, truth.hits.steps(), truth.machine, truth.decided_on);
  truth.hits.append_steps(chunk.hits);
  truth.contained.append_steps(chunk.contained);
  if (truth.contained_inside)
    truth.contained_inside->insert(truth.contained_inside->end(), chunk.inside.begin(), chunk.inside.end());
  truth.time_ns.insert(truth.time_ns.end(), chunk.time_ns.begin(), chunk.time_ns.end());
  if (!truth.gaps) return;
  GapLists& gaps = *truth.gaps;
  gaps.pairs.append_steps(chunk.gaps->pairs);
  each_gap_column([&](const auto& column) {
    const std::vector<double>& more = (*chunk.gaps).*column.member;
    (gaps.*column.member).insert((gaps.*column.member).end(), more.begin(), more.end());
  });
}

Truth decide(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses, int threads,
             const Checkpoint& part, Progress& progress, Containment containment, std::optional<double> gap_margin) {
  TruthChunks chunks(bodies, {containment, gap_margin});
  ChunkStage stage{
      .name = "truth", .steps = std::int64_t(poses.size()), .threads = threads, .make = [&](ChunkSteps at) {
        return chunks.make(std::span(poses).subspan(std::size_t(at.first), at.count()), progress);
      }};
  std::vector<std::string> all = all_chunks(std::move(stage), &part, progress);
  Truth truth = chunks.none();
  for (std::size_t chunk = 0; chunk < all.size(); ++chunk) {
    const std::string bytes = std::move(all[chunk]);  // freed here: not all is there twice
    chunks.append(bytes, steps_of_chunk(chunk, std::int64_t(poses.size())).count(), truth);
  }
  return truth;
}

}  // namespace pipeline
