// A result in memory: what the HDF5 file holds (pipeline/FILE.md). S steps, B bodies, A algorithms.
#pragma once
#include <any>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>
#include <vector>

#include "geometry/bodies.hpp"

namespace pipeline {

using geometry::Pair;

/// One list of pairs per step: those of step s are pair[offset[s]] ... pair[offset[s + 1] - 1]; sorted, unique, a < b.
struct PairLists {
  std::vector<std::uint64_t> offset{0};  // S + 1
  std::vector<Pair> pair;

  std::size_t steps() const { return offset.size() - 1; }
  void append(std::span<const Pair> step) {
    pair.insert(pair.end(), step.begin(), step.end());
    offset.push_back(pair.size());
  }
  void append_steps(const PairLists& steps) {
    for (std::size_t s = 0; s < steps.steps(); ++s) append(steps.at(s));
  }
  std::span<const Pair> at(std::size_t step) const {
    return std::span(pair).subspan(offset[step], offset[step + 1] - offset[step]);
  }
};

/// Whether offsets and pairs are in order, those of `steps` steps with `bodies` bodies.
bool sound(const PairLists& lists, std::uint64_t steps, std::uint64_t bodies);

/// The pairs of `from` that are not among `these`; all sorted.
std::vector<Pair> without(std::span<const Pair> from, std::span<const Pair> these);

/// What becomes of pairs of which one body lies wholly inside the other: not looked for, listed and counted apart, or
/// counted as meeting.
enum class Containment { ignore, record, meet };

/// Containment as configurations and files spell it.
std::string_view text_of(Containment containment);
std::optional<Containment> containment_of(std::string_view text);

/// The machine and build that timed something.
struct Machine {
  std::string host, processor, build, date;  // processor: and what changes its frequency, if something does
  std::int64_t pinned = -1;                  // the one processor that was allowed, by number; -1: all
};

/// What a label costs besides its time per step; NaN: not known. Of several set-ups (of extremes, of a resumed run) the
/// greatest counts.
struct Costs {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  double setup_ns = kUnknown;               // of its construction for the bodies of the run
  double memory_bytes = kUnknown;           // of heap that it holds after that
  double memory_greatest_bytes = kUnknown;  // and the most at any time
};

/// What is known of a method of others beside its answers.
struct ForeignFacts {
  std::string transport;                     // "program", "library", ...: how it was asked
  std::string command;                       // of a program, its words
  std::string files = "{}";                  // JSON object: file -> SHA-256, of what it is made of
  std::string version, language, precision;  // by its own word
  std::string tests, licence;                // likewise; empty: it does not say
  std::int64_t threads = 1;
  std::string reason;           // why it failed; empty: it did not
  std::int64_t steps_done = 0;  // steps that it answered before; of those after it nothing is known
  double waited = 0;            // s, for all its answers together; in no file but checkpoints
};

/// What one algorithm said: a group of /answers and a column of /results.
struct Answers {
  std::string label, name, knobs, promise, thesis_key, operations_unit, scope;  // knobs: JSON
  std::string library;                  // name and version of somebody else's that answered; empty: none
  std::optional<ForeignFacts> foreign;  // of a method of others
  Machine machine;
  std::vector<Machine> timed_on;  // of every chunk of kChunkSteps steps, where they are not all `machine`'s
  Costs costs;
  PairLists hits;
  // columns, S
  std::vector<std::int64_t> time_ns, time_median_ns, prepare_ns;
  std::vector<std::int64_t> processor_ns;  // S where it was taken, else empty
  std::vector<std::int64_t> exchange_ns;   // S of a method in a process of its own, else empty
  std::vector<std::uint64_t> operations, true_positive, false_positive, false_negative, rounding_miss;
  std::vector<std::uint64_t> contained_hit;  // S with Containment::record, else empty
};

/// The processors that it was timed on, each once, in the order of the chunks. Times of unlike ones are no times of one
/// machine: such a label has a time per step, but none of the run.
std::vector<std::string> processors(const Answers& answers);
inline bool timed_on_unlike(const Answers& answers) { return processors(answers).size() > 1; }

/// Whether it failed at some step.
inline bool failed(const Answers& answers) { return answers.foreign && !answers.foreign->reason.empty(); }

/// One row of /summary. A ratio 0/0 is NaN, but the error is then 0. hits = true_positive + false_positive +
/// contained_hit. Times are NaN of what was not timed; what is absent was not known to the program that wrote it.
struct Summary {
  std::uint64_t hits = 0, true_positive = 0, false_positive = 0, false_negative = 0, operations = 0;
  double error = 0, precision = 0, recall = 0, matthews = 0;
  double time_mean_ns = 0, time_median_ns = 0, time_p95_ns = 0;
  std::optional<double> time_mean_low_ns = std::nullopt,
                        time_mean_high_ns = std::nullopt;  // a 95 % interval of the mean
  std::optional<double> processor_mean_ns = std::nullopt;
  std::optional<double> setup_ns = std::nullopt, memory_bytes = std::nullopt, memory_greatest_bytes = std::nullopt;
  bool promise_kept = true;
  std::optional<std::uint64_t> contained_hit = std::nullopt;  // with Containment::record
};

/// Distances of pairs that do not meet, in metres: lower <= distance <= upper, one of each per entry of `pairs`.
struct GapLists {
  double margin = 0;  // m; pairs that are certainly farther apart are left out
  PairLists pairs;
  std::vector<double> lower, upper;
};

struct Truth {
  PairLists hits;                        // by surface
  std::vector<std::int64_t> time_ns;     // S
  Machine machine = {};                  // that decided it; not in files
  std::vector<Machine> decided_on = {};  // of every chunk of kChunkSteps steps, where they are not all `machine`'s
  Containment containment = Containment::ignore;
  PairLists contained;  // disjoint from hits; without steps when ignored
  // Where `contained` has steps: of each of its pairs the body that is inside. Absent in files older than it.
  std::optional<std::vector<std::uint32_t>> contained_inside;
  // Likewise, per distinct mesh: the distance of corners taken for one so that it is closed, m; NaN: open.
  std::vector<double> closed_within;
  std::optional<GapLists> gaps;  // only where asked for

  bool lists_contained() const { return containment != Containment::ignore; }
  /// Hits and contained pairs of steps `first` up to, not including, `last`.
  Truth some(std::size_t first, std::size_t last) const;
  /// The pairs by which the answers of a step are scored: sorted.
  std::vector<Pair> scoring(std::size_t step) const;
};

/// Where a result comes from; attributes of the root and of /run.
struct Provenance {
  std::string creator, git_commit, build_type, compiler, flags;
  std::string library_versions;       // JSON object
  std::string config_sha256;          // of the configuration's text
  std::string inputs_sha256;          // JSON object: file -> SHA-256, every mesh and CSV read
  std::string date, host, processor;  // of the run
  double wall_time_s = 0;
};

/// What some results hold besides, at most one value of each type: passes, cases of extremes, … Rows of products()
/// say what becomes of each (pipeline/result/product.hpp).
class Products {
 public:
  /// Null when there is none.
  template <class T>
  T* find() {
    const auto at = all_.find(typeid(T));
    return at == all_.end() ? nullptr : std::any_cast<T>(&at->second);
  }
  template <class T>
  const T* find() const {
    const auto at = all_.find(typeid(T));
    return at == all_.end() ? nullptr : std::any_cast<T>(&at->second);
  }
  template <class T>
  T& put(T value) {
    return std::any_cast<T&>(all_[typeid(T)] = std::move(value));
  }
  /// Takes all that is in `more`, in the place of what is here.
  void join(Products more) {
    more.all_.merge(all_);
    all_ = std::move(more.all_);
  }
  template <class T>
  void drop() {
    all_.erase(typeid(T));
  }

 private:
  std::map<std::type_index, std::any> all_;
};

/// A study of the integrators has nothing of it but title, configuration, its product and provenance.
struct Result {
  std::string title;
  std::string config_text, config_effective;
  double rate = 60;  // samples per second; time = step / rate
  geometry::Bodies bodies;
  std::vector<std::int64_t> first_step;             // B; -1 if never born
  std::vector<std::vector<geometry::Pose>> motion;  // S x B
  Truth truth;
  std::vector<Answers> answers;  // A
  std::vector<Summary> summary;  // A
  Products products;
  Provenance provenance;
  std::string digest;   // of the root; filled in by write and read
  bool vouched = true;  // false: read although its seal did not hold, so what is written of it gets none
  std::vector<std::string>
      foreign;  // objects at the root of the file read that are not this program's: not written again

  std::size_t steps() const { return motion.size(); }
};

}  // namespace pipeline
