#include "pipeline/stages/detect.hpp"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "pipeline/result/answer_chunk.hpp"
#include "pipeline/result/columns.hpp"
#include "pipeline/stages/chunks.hpp"
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
  std::unique_ptr<Method> method;  // null: of others, and it has failed
  algorithms::Promise promise = algorithms::Promise::none;
  ForeignMethod* foreign = nullptr;  // the method, where it is one of others
  HeapCount heap = {};               // of a method of this program
  Costs costs = {};                  // of this set-up
};

double known(std::int64_t heap_bytes) { return counts_heap() ? double(heap_bytes) : Costs::kUnknown; }

/// By the word of a method of others.
Costs costs_of(const About& about) {
  return {.setup_ns = double(about.setup_ns),
          .memory_bytes = about.memory_bytes < 0 ? Costs::kUnknown : double(about.memory_bytes)};
}

/// Throws Fault for a method of others.
Entry set_up(const Bodies& bodies, const AlgorithmChoice& choice) {
  using Clock = std::chrono::steady_clock;
  try {
    Entry entry;
    entry.promise = algorithms::promise(row_of(choice), choice.knobs);
    std::chrono::nanoseconds spent;
    {
      const CountingHeap now(entry.heap);
      const auto start = Clock::now();
      entry.method = make_method(choice, bodies);
      spent = Clock::now() - start;
    }
    entry.foreign = dynamic_cast<ForeignMethod*>(entry.method.get());
    if (entry.foreign) entry.promise = entry.foreign->about().promise;
    const double held = known(entry.heap.held);
    entry.costs = entry.foreign ? costs_of(entry.foreign->about()) : Costs{double(spent.count()), held, held};
    return entry;
  } catch (const std::invalid_argument& error) {
    throw Error(kInput, whose(choice) + error.what());
  } catch (const std::bad_alloc&) {
    throw OutOfMemory(choice, bodies);
  }
}

/// What a method of others says of itself.
void adopt(const About& about, Answers& answers) {
  answers.name = about.name;
  answers.promise = algorithms::text(about.promise);
  answers.scope = algorithms::text(about.scope);
  answers.operations_unit = about.operations_unit;
  ForeignFacts& facts = *answers.foreign;
  facts.version = about.version;
  facts.language = about.language;
  facts.precision = about.precision;
  facts.tests = about.tests;
  facts.licence = about.licence;
  facts.threads = about.threads;
}

/// A method of others, warmed up by the first step that it will be asked about; or one that failed there, and why.
/// `waited` s were for answers of it before.
Entry set_up_foreign(const Bodies& bodies, const AlgorithmChoice& choice, std::span<const Pose> poses,
                     std::int64_t first, double waited, Answers& answers) {
  ForeignFacts& facts = *answers.foreign;
  try {
    Entry entry = set_up(bodies, choice);
    adopt(entry.foreign->about(), answers);
    entry.foreign->about().takes_them();
    entry.foreign->add_waited(waited);
    entry.foreign->at(std::uint32_t(first));
    entry.foreign->warm_up(poses, geometry::pair_runs(bodies, poses), choice.foreign->warm_up);
    return entry;
  } catch (const Fault& fault) {
    facts.reason = fault.what();
    return {};
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
  std::int64_t total_ns, prepare_ns;
  std::int64_t processor_ns = 0, exchange_ns = 0;
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

Timing timed_pass(Entry& entry, std::span<const Pose> poses, std::span<const PairRun> runs, std::vector<Pair>& hits) {
  using Clock = std::chrono::steady_clock;
  using std::chrono::nanoseconds;
  Method& method = *entry.method;
  hits.clear();
  if (entry.foreign) {
    method.prepare(poses);
    method.answer(runs, hits);
    const ForeignTime& time = entry.foreign->time();
    return {.total_ns = time.time_ns, .prepare_ns = time.prepare_ns, .exchange_ns = time.exchange_ns};
  }
  const CountingHeap counting(entry.heap);
  const std::int64_t before = processor_ns();
  const auto start = Clock::now();
  method.prepare(poses);
  const auto prepared = Clock::now();
  method.answer(runs, hits);
  const auto answered = Clock::now();
  const std::int64_t spent = processor_ns() - before - clocks_ns();
  return {.total_ns = nanoseconds(answered - start).count(),
          .prepare_ns = nanoseconds(prepared - start).count(),
          .processor_ns = std::max<std::int64_t>(spent, 1)};
}

/// Elementary tests, untimed. The memory of the method is counted, but not the list of hits, which is the caller's.
std::uint64_t counted(Entry& entry, std::span<const Pose> poses, std::span<const PairRun> runs,
                      std::vector<Pair>& hits) {
  {
    const CountingHeap now(entry.heap);
    entry.method->prepare(poses);
  }
  HeapCount with_hits;
  std::uint64_t operations = 0;
  {
    const CountingHeap now(with_hits);
    operations = entry.method->count(runs, hits);
  }
  entry.heap.held += with_hits.held - std::int64_t(heap_bytes(hits.data()));
  return operations;
}

/// A step of a chunk that begins at step `first` of the run. All or nothing: what throws leaves `out` as it was.
void answer_step(Entry& entry, std::span<const Pose> poses, std::span<const PairRun> runs, const Truth& all_truth,
                 std::int64_t first, std::size_t step, std::int64_t repeats, std::vector<Pair>& timed_hits,
                 Answers& out) {
  Method& method = *entry.method;
  if (entry.foreign) entry.foreign->at(std::uint32_t(first) + std::uint32_t(step));
  std::vector<Pair> hits;
  const std::uint64_t operations = counted(entry, poses, runs, hits);
  timed_hits.reserve(hits.size());

  std::vector<Timing> timings;
  for (std::int64_t i = 0; i < repeats; ++i) {
    timings.push_back(timed_pass(entry, poses, runs, timed_hits));
    if (timed_hits == hits) continue;
    if (entry.foreign) throw Fault("it answers otherwise when it is asked again");
    throw std::logic_error(out.label + ": the timed pass answers otherwise than the counting pass");
  }
  method.remember();  // before the enlarged boxes, of which nothing is to be learned
  std::sort(timings.begin(), timings.end(), [](const Timing& a, const Timing& b) { return a.total_ns < b.total_ns; });

  std::sort(hits.begin(), hits.end());  // a sweep reports in its own order
  try {
    check_hits(hits, runs);
  } catch (const std::logic_error& error) {
    throw std::logic_error(out.label + ": step " + std::to_string(first + std::int64_t(step)) + ": " + error.what());
  }
  const std::vector<Pair> missed = without(all_truth.scoring(step), hits);
  const std::uint64_t rounding =
      entry.promise == algorithms::Promise::conservative ? rounding_misses(method, poses, missed) : 0;

  judge(hits, all_truth, step, out);
  out.rounding_miss.push_back(rounding);
  out.operations.push_back(operations);
  out.processor_ns.push_back(timings.front().processor_ns);
  if (!entry.foreign)
    out.costs.memory_greatest_bytes = std::fmax(out.costs.memory_greatest_bytes, known(entry.heap.greatest));
  out.time_ns.push_back(timings.front().total_ns);
  out.prepare_ns.push_back(timings.front().prepare_ns);
  if (entry.foreign) out.exchange_ns.push_back(timings.front().exchange_ns);
  const std::size_t middle = timings.size() / 2;
  out.time_median_ns.push_back(timings.size() % 2 ? timings[middle].total_ns
                                                  : (timings[middle - 1].total_ns + timings[middle].total_ns) / 2);
}

/// Does what may end a method of others, and ends it then.
template <class Act>
void guarded(Entry& entry, Answers& answers, Act act) {
  if (!entry.method) return;
  try {
    act();
  } catch (const Fault& fault) {
    answers.foreign->reason = fault.what();
    entry = {};
  }
}

}  // namespace

void judge(std::span<const Pair> hits, const Truth& all_truth, std::size_t step, Answers& out) {
  const std::vector<Pair> truth = all_truth.scoring(step);
  const std::vector<Pair> missed = without(truth, hits);
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
                        bytes_text(algorithms::memory(row_of(choice), bodies, choice.knobs).greatest) +
                        ": sample fewer facets, or take fewer bodies or segments") {}

Heard refuse_unfit(const Bodies& bodies, const std::vector<AlgorithmChoice>& choices) {
  constexpr std::uint64_t kLarge = 64 << 20;  // bytes; making more takes too long to be done only to ask
  Heard heard;
  for (const AlgorithmChoice& choice : choices) {
    try {
      if (!choice.foreign) {
        const algorithms::Algorithm& row = row_of(choice);
        if (algorithms::memory(row, bodies, choice.knobs).greatest > kLarge || row.fits_all) continue;
      }
    } catch (const std::invalid_argument& error) {
      throw Error(kInput, whose(choice) + error.what());
    }
    try {
      const Entry entry = set_up(bodies, choice);
      if (entry.foreign) heard.abouts[choice.label] = entry.foreign->about();
    } catch (const Fault& fault) {
      if (choice.optional) {
        heard.silent[choice.label] = fault.what();
        continue;
      }
      const std::string command = text_of(choice.foreign->command);
      throw Error(kInput,
                  "algorithm '" + choice.label + "': " +
                      (command.empty() ? "cannot be set up: "
                                       : choice.foreign->transport + " \"" + command + "\" does not say hello: ") +
                      fault.what());
    }
  }
  return heard;
}

struct Detector::Asked {
  const Bodies& bodies;
  std::vector<AlgorithmChoice> choices;
  std::int64_t repeats;
  std::vector<Entry> entries = {};           // made when a chunk is
  std::vector<std::int64_t> failed_at = {};  // per choice the first step of the first chunk in which it failed
  std::vector<double> waited = {};           // per choice, s
  std::set<std::int64_t> looked_at = {};     // chunks, for what failed in them
  std::vector<Pair> timed_hits = {};

  /// Learns from the chunks before `first`, where there are methods of others.
  void look_back(std::int64_t first, const Checkpoint* part) {
    if (!part || std::ranges::none_of(choices, [](const AlgorithmChoice& choice) { return bool(choice.foreign); }))
      return;
    for (std::int64_t before = 0; before < first; before += kChunkSteps) {
      if (looked_at.contains(before) || !part->has(chunk_name("answers", before))) continue;
      if (const auto bytes = part->load(chunk_name("answers", before))) learn(before, kChunkSteps, *bytes);
    }
  }

  void learn(std::int64_t first, std::int64_t steps, const std::string& bytes) {
    looked_at.insert(first);
    ChunkReader in(bytes);
    for (std::size_t a = 0; a < choices.size(); ++a) {
      const Answers found = get_steps(in, steps, bodies.size());
      if (failed(found)) failed_at[a] = std::min(failed_at[a], first);
      if (found.foreign) waited[a] = std::max(waited[a], found.foreign->waited);
    }
  }

  /// All set up for the chunk, memories empty; what has failed before it is not.
  void get_ready(std::int64_t first, std::span<const Pose> poses, std::vector<Answers>& all) {
    entries.resize(choices.size());
    for (std::size_t a = 0; a < choices.size(); ++a) {
      Entry& entry = entries[a];
      if (failed_at[a] < first) {
        entry = {};
        all[a].foreign->reason = "it failed before";
      } else if (!entry.method) {
        entry = choices[a].foreign ? set_up_foreign(bodies, choices[a], poses, first, waited[a], all[a])
                                   : set_up(bodies, choices[a]);
      } else if (entry.foreign) {
        adopt(entry.foreign->about(), all[a]);
      }
      all[a].costs = entry.costs;
      guarded(entry, all[a], [&] { entry.method->forget(); });
    }
  }
};

Detector::Detector(const Bodies& bodies, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats, bool noise)
    : asked_(new Asked{bodies, choices, repeats}) {
  if (noise && !choices.empty()) asked_->choices.push_back(choices.front());  // like any other, but with no label
  asked_->failed_at.assign(asked_->choices.size(), std::numeric_limits<std::int64_t>::max());
  asked_->waited.assign(asked_->choices.size(), 0);
}

Detector::~Detector() = default;

std::vector<Answers> Detector::none() const {
  std::vector<Answers> all;
  for (const AlgorithmChoice& choice : asked_->choices) {
    const algorithms::Algorithm& row = row_of(choice);
    Answers answers;
    answers.label = choice.label;
    answers.name = row.name;
    answers.knobs = knobs_json(choice.knobs);
    answers.promise = algorithms::text(algorithms::promise(row, choice.knobs));
    answers.thesis_key = row.thesis_key;
    answers.operations_unit = row.operations_unit;
    answers.scope = algorithms::text(row.scope);
    if (!row.library.name.empty())
      answers.library = row.library.name + (row.library.version.empty() ? "" : " " + row.library.version);
    if (choice.foreign) {
      answers.foreign.emplace().transport = choice.foreign->transport;
      answers.foreign->command = text_of(choice.foreign->command);
      answers.foreign->files = nlohmann::json(choice.foreign->files).dump();
    }
    all.push_back(std::move(answers));
  }
  return all;
}

std::string Detector::make(std::int64_t first, std::span<const std::vector<Pose>> poses, const Truth& truth,
                           const Machine& machine, const Checkpoint* part, Progress& progress) {
  const Bodies& bodies = asked_->bodies;
  std::vector<Entry>& entries = asked_->entries;
  std::vector<Answers> all = none();
  asked_->look_back(first, part);
  asked_->get_ready(first, poses[0], all);
  for (std::size_t step = 0; step < poses.size(); ++step) {
    stop_if_wanted();
    const std::vector<PairRun> runs = geometry::pair_runs(bodies, poses[step]);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const std::size_t a = (std::size_t(first) + step) % 2 ? entries.size() - 1 - i : i;
      try {
        guarded(entries[a], all[a], [&] {
          answer_step(entries[a], poses[step], runs, truth, first, step, asked_->repeats, asked_->timed_hits, all[a]);
          if (entries[a].foreign) ++all[a].foreign->steps_done;
        });
      } catch (const std::bad_alloc&) {
        throw OutOfMemory(asked_->choices[a], bodies);
      }
      if (!entries[a].method) leave_out_step(truth.containment == Containment::record, all[a]);
      progress.tick();
    }
    progress.add(1);
  }
  ChunkWriter out;
  for (std::size_t a = 0; a < entries.size(); ++a) {
    if (entries[a].foreign) asked_->waited[a] = entries[a].foreign->waited();
    if (all[a].foreign) all[a].foreign->waited = asked_->waited[a];
    if (failed(all[a])) asked_->failed_at[a] = std::min(asked_->failed_at[a], first);
    put_steps(all[a], 0, std::int64_t(poses.size()), out);
  }
  put_machine(machine, out);
  asked_->looked_at.insert(first);
  return std::move(out.bytes);
}

void Detector::append(const std::string& bytes, std::size_t steps, std::vector<Answers>& all) const {
  ChunkReader in(bytes);
  std::vector<Answers> chunk;
  for (std::size_t a = 0; a < all.size(); ++a)
    chunk.push_back(get_steps(in, std::int64_t(steps), asked_->bodies.size()));
  const Machine machine = get_machine(in);
  for (std::size_t a = 0; a < all.size(); ++a) append_chunk(chunk[a], machine, all[a]);
}

std::vector<Answers> detect(const Bodies& bodies, const std::vector<std::vector<Pose>>& poses, const Truth& truth,
                            const std::vector<AlgorithmChoice>& choices, std::int64_t repeats, const Machine& machine,
                            const Checkpoint* part, Progress& progress, bool noise) {
  Detector detector(bodies, choices, repeats, noise);
  const auto steps = std::int64_t(poses.size());
  ChunkStage stage{.name = "answers", .steps = steps, .make = [&](ChunkSteps at) {
                     const auto some = std::span(poses).subspan(std::size_t(at.first), at.count());
                     return detector.make(at.first, some, truth.some(std::size_t(at.first), std::size_t(at.last)),
                                          machine, part, progress);
                   }};
  std::vector<std::string> chunks = all_chunks(std::move(stage), part, progress);
  std::vector<Answers> all = detector.none();
  for (Answers& answers : all) answers.machine = machine;
  for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk) {
    const std::string bytes = std::move(chunks[chunk]);  // freed here: not all is there twice
    detector.append(bytes, steps_of_chunk(chunk, steps).count(), all);
  }
  return all;
}

}  // namespace pipeline
