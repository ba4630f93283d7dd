#include "pipeline/stages/detect.hpp"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>

#include "pipeline/result/answer_chunk.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/system/heap.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using algorithms::Method;
using geometry::Bodies;
using geometry::Pair;
using geometry::PairRun;
using geometry::Pose;

/// A miss of a conservative method that it finds with boxes and radii this much larger (times size + |t|) is a rounding
/// miss (pipeline/FILE.md, "Definitions").
constexpr double kRoundingEnlargement = 0x1p-40;

struct Entry {
  const algorithms::Algorithm* row;
  std::unique_ptr<Method> method;
  HeapCount heap = {};
};

double known(std::int64_t heap_bytes) { return counts_heap() ? double(heap_bytes) : Costs::kUnknown; }

/// `costs`, where given, become those of this set-up.
Entry set_up(const Bodies& bodies, const AlgorithmChoice& choice, Costs* costs = nullptr) {
  using Clock = std::chrono::steady_clock;
  Entry entry{algorithms::find(choice.name), nullptr};
  try {
    {
      const CountingHeap now(entry.heap);
      const auto start = Clock::now();
      entry.method = entry.row->make(bodies, choice.knobs);
      const std::chrono::nanoseconds spent = Clock::now() - start;
      if (costs) costs->setup_ns = double(spent.count());
    }
    if (costs) costs->memory_bytes = costs->memory_greatest_bytes = known(entry.heap.held);
    return entry;
  } catch (const std::invalid_argument& error) {
    throw Error(kInput, "algorithm '" + choice.label + "': " + error.what());
  } catch (const std::bad_alloc&) {
    throw OutOfMemory(choice, bodies);
  }
}

std::uint64_t rounding_misses(Method& method, std::span<const Pose> poses, std::span<const Pair> missed) {
  if (missed.empty()) return 0;
  method.prepare(poses, kRoundingEnlargement);
  std::vector<PairRun> runs;
  for (const Pair& pair : missed) runs.push_back({pair.a, pair.b, pair.b + 1});
  std::vector<Pair> found;
  method.answer(runs, found);
  return found.size();
}

struct Timing {
  std::int64_t total_ns, prepare_ns, processor_ns;
};

/// Nanoseconds of processor time that this thread has spent.
std::int64_t processor_ns() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// What looking at the clocks itself takes of it.
std::int64_t clocks_ns() {
  static const std::int64_t least = [] {
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (int i = 0; i < 1000; ++i) {
      const std::int64_t before = processor_ns();
      for (int clock = 0; clock < 3; ++clock) std::chrono::steady_clock::now();
      least = std::min(least, processor_ns() - before);
    }
    return least;
  }();
  return least;
}

Timing timed_pass(Method& method, std::span<const Pose> poses, std::span<const PairRun> runs, std::vector<Pair>& hits) {
  using Clock = std::chrono::steady_clock;
  using std::chrono::nanoseconds;
  hits.clear();
  const std::int64_t before = processor_ns();
  const auto start = Clock::now();
  method.prepare(poses);
  const auto prepared = Clock::now();
  method.answer(runs, hits);
  const auto answered = Clock::now();
  const std::int64_t spent = processor_ns() - before - clocks_ns();
  return {nanoseconds(answered - start).count(), nanoseconds(prepared - start).count(),
          std::max<std::int64_t>(spent, 1)};
}

void answer_step(Entry& entry, std::span<const Pose> poses, std::span<const PairRun> runs, const Truth& all_truth,
                 std::size_t step, std::int64_t repeats, std::vector<Pair>& timed_hits, Answers& out) {
  Method& method = *entry.method;
  std::vector<Pair> hits;
  {
    const CountingHeap now(entry.heap);
    method.prepare(poses);
  }
  HeapCount counting;  // apart, as the list of hits that grows is not the method's
  std::uint64_t operations = 0;
  {
    const CountingHeap now(counting);
    operations = method.count(runs, hits);
  }
  entry.heap.held += counting.held - std::int64_t(heap_bytes(hits.data()));
  out.operations.push_back(operations);
  timed_hits.reserve(hits.size());

  std::vector<Timing> timings;
  timings.reserve(std::size_t(repeats));
  for (std::int64_t i = 0; i < repeats; ++i) {
    {
      const CountingHeap now(entry.heap);
      timings.push_back(timed_pass(method, poses, runs, timed_hits));
    }
    if (timed_hits != hits)
      throw std::logic_error(out.label + ": the timed pass answers otherwise than the counting pass");
  }
  out.costs.memory_greatest_bytes = std::fmax(out.costs.memory_greatest_bytes, known(entry.heap.greatest));
  method.remember();  // before the enlarged boxes, of which nothing is to be learned
  std::sort(timings.begin(), timings.end(), [](const Timing& a, const Timing& b) { return a.total_ns < b.total_ns; });
  out.time_ns.push_back(timings.front().total_ns);
  out.prepare_ns.push_back(timings.front().prepare_ns);
  out.processor_ns.push_back(timings.front().processor_ns);
  const std::size_t middle = timings.size() / 2;
  out.time_median_ns.push_back(timings.size() % 2 ? timings[middle].total_ns
                                                  : (timings[middle - 1].total_ns + timings[middle].total_ns) / 2);

  std::sort(hits.begin(), hits.end());  // a sweep reports in its own order
  try {
    check_hits(hits, runs);
  } catch (const std::logic_error& error) {
    throw std::logic_error(out.label + ": step " + std::to_string(step) + ": " + error.what());
  }
  const std::vector<Pair> missed = judge(hits, all_truth, step, out);
  out.rounding_miss.push_back(
      entry.row->promise == algorithms::Promise::conservative ? rounding_misses(method, poses, missed) : 0);
}

}  // namespace

std::vector<Pair> judge(std::span<const Pair> hits, const Truth& all_truth, std::size_t step, Answers& out) {
  const std::vector<Pair> truth = all_truth.scoring(step);
  std::vector<Pair> missed = without(truth, hits);
  std::vector<Pair> wrong = without(hits, truth);
  if (all_truth.containment == Containment::record) {
    const std::size_t reported = wrong.size();
    wrong = without(wrong, all_truth.contained.at(step));
    out.contained_hit.push_back(reported - wrong.size());
  }
  out.true_positive.push_back(truth.size() - missed.size());
  out.false_positive.push_back(wrong.size());
  out.false_negative.push_back(missed.size());
  out.hits.append(hits);
  return missed;
}

void check_hits(std::span<const Pair> hits, std::span<const PairRun> runs) {
  auto run = runs.begin();
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const auto [a, b] = hits[i];
    while (run != runs.end() && (run->a < a || (run->a == a && run->last <= b))) ++run;
    const char* mistake = nullptr;
    if (run == runs.end() || run->a != a || b < run->first) mistake = "was not asked about";
    if (i > 0 && hits[i] == hits[i - 1]) mistake = "was reported before";
    if (mistake)
      throw std::logic_error("the reported pair " + std::to_string(a) + ", " + std::to_string(b) + " " + mistake +
                             "; answer with pairs of `runs`, a < b, each once");
  }
}

OutOfMemory::OutOfMemory(const AlgorithmChoice& choice, const Bodies& bodies)
    : Error(kInput, "algorithm '" + choice.label + "': out of memory; it takes about " +
                        bytes_text(algorithms::memory(*algorithms::find(choice.name), bodies, choice.knobs).greatest) +
                        ": sample fewer facets, or take fewer bodies or segments") {}

void refuse_unfit(const Bodies& bodies, const std::vector<AlgorithmChoice>& choices) {
  constexpr std::uint64_t kLarge = 64 << 20;  // bytes; making more takes too long to be done only to ask
  for (const AlgorithmChoice& choice : choices) {
    try {
      if (algorithms::memory(*algorithms::find(choice.name), bodies, choice.knobs).greatest > kLarge) continue;
    } catch (const std::invalid_argument& error) {
      throw Error(kInput, "algorithm '" + choice.label + "': " + error.what());
    }
    set_up(bodies, choice);
  }
}

std::vector<Answers> detect(const Bodies& bodies, const std::vector<std::vector<Pose>>& poses, const Truth& truth,
                            const std::vector<AlgorithmChoice>& asked, std::int64_t repeats, const Machine& machine,
                            const Checkpoint* part, Progress& progress, bool noise) {
  std::vector<AlgorithmChoice> choices = asked;
  if (noise && !asked.empty()) choices.push_back(asked.front());  // like any other, but with no label of its own
  std::vector<Answers> all;
  for (const AlgorithmChoice& choice : choices) {
    const algorithms::Algorithm& row = *algorithms::find(choice.name);
    Answers answers;
    answers.label = choice.label;
    answers.name = row.name;
    answers.knobs = knobs_json(choice.knobs);
    answers.promise = algorithms::text(row.promise);
    answers.thesis_key = row.thesis_key;
    answers.operations_unit = row.operations_unit;
    answers.scope = algorithms::text(row.scope);
    if (!row.library.name.empty()) answers.library = row.library.name + " " + row.library.version;
    answers.machine = machine;
    all.push_back(std::move(answers));
  }

  std::vector<Entry> entries;  // made when the first chunk needs them
  std::vector<Pair> timed_hits;
  const std::int64_t steps = std::int64_t(poses.size());
  for (std::int64_t first = 0; first < steps; first += kChunkSteps) {
    const std::int64_t last = std::min(first + kChunkSteps, steps);
    const std::string name = chunk_name("answers", first);
    if (const auto kept = part ? part->load(name) : std::nullopt) {
      ChunkReader in(*kept);
      for (Answers& answers : all) append_steps(get_steps(in, last - first, bodies.size()), answers);
      progress.add(std::uint64_t(last - first), false);
      continue;
    }

    if (entries.empty())
      for (std::size_t a = 0; a < choices.size(); ++a) {
        Costs costs;
        entries.push_back(set_up(bodies, choices[a], &costs));
        if (std::isnan(all[a].costs.setup_ns)) all[a].costs = costs;  // else those of the run that is resumed
      }
    for (Entry& entry : entries) entry.method->forget();  // a resumed run starts here
    for (std::int64_t step = first; step < last; ++step) {
      stop_if_wanted();
      const std::vector<PairRun> runs = geometry::pair_runs(bodies, poses[step]);
      for (std::size_t i = 0; i < entries.size(); ++i) {
        const std::size_t a = step % 2 ? entries.size() - 1 - i : i;
        try {
          answer_step(entries[a], poses[step], runs, truth, std::size_t(step), repeats, timed_hits, all[a]);
        } catch (const std::bad_alloc&) {
          throw OutOfMemory(choices[a], bodies);
        }
        progress.tick();
      }
      progress.add(1);
    }
    if (part) {
      ChunkWriter out;
      for (const Answers& answers : all) put_steps(answers, first, last, out);
      part->save(name, out.bytes);
    }
  }
  return all;
}

}  // namespace pipeline
