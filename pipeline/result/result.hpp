// A result in memory: what the HDF5 file holds (pipeline/FILE.md). S steps, B bodies, A algorithms.
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/bodies.hpp"
#include "pipeline/physics/simulate.hpp"

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
  Costs costs;
  PairLists hits;
  // columns, S
  std::vector<std::int64_t> time_ns, time_median_ns, prepare_ns;
  std::vector<std::int64_t> processor_ns;  // S where it was taken, else empty
  std::vector<std::int64_t> exchange_ns;   // S of a method in a process of its own, else empty
  std::vector<std::uint64_t> operations, true_positive, false_positive, false_negative, rounding_miss;
  std::vector<std::uint64_t> contained_hit;  // S with Containment::record, else empty
};

/// Whether it failed at some step.
inline bool failed(const Answers& answers) { return answers.foreign && !answers.foreign->reason.empty(); }

/// The first label timed a second time: what times of the same differ by.
struct Noise {
  std::string label;
  std::vector<std::int64_t> time_ns;    // S
  double ratio = 0, low = 0, high = 0;  // of its mean to the label's own, with a 95 % interval; NaN: too few steps
};

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
  PairLists hits;                     // by surface
  std::vector<std::int64_t> time_ns;  // S
  Containment containment = Containment::ignore;
  PairLists contained;  // disjoint from hits; without steps when ignored
  // Where `contained` has steps: of each of its pairs the body that is inside. Absent in files older than it.
  std::optional<std::vector<std::uint32_t>> contained_inside;
  // Likewise, per distinct mesh: the distance of corners taken for one so that it is closed, m; NaN: open.
  std::vector<double> closed_within;
  std::optional<GapLists> gaps;  // only where asked for

  bool lists_contained() const { return containment != Containment::ignore; }
  /// The pairs by which the answers of a step are scored: sorted.
  std::vector<Pair> scoring(std::size_t step) const;
};

/// One straight pass of a scripted scene: a row of /passes. Positions are metres from the start of its path.
struct PassRow {
  std::string target, path, orientation;  // name of the obstacle, of the path, of the hero's orientation
  double offset = 0;                      // m, of the path from the target's position
  std::uint64_t first_step = 0, samples = 0;
  // Where the surfaces first and last meet; NaN when they never do. Samples at which they do.
  double truth_first = std::numeric_limits<double>::quiet_NaN();
  double truth_last = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t truth_hits = 0;
};

/// What one algorithm said about the passes: a column of /passes. P values each.
struct PassAnswers {
  std::vector<double> first, last;     // m before (negative: after) the truth's; NaN where one has none
  std::vector<std::uint64_t> flicker;  // changes of the answer between neighbouring samples that both truly meet
  std::vector<std::uint64_t> hits;     // samples reported
};

struct Passes {
  std::vector<PassRow> rows;         // P
  std::vector<PassAnswers> answers;  // A
};

/// One step of a scene of extremes: a row of /extremes.
struct ExtremeCase {
  std::string pair, gap_class;     // the two shapes; the gap as it was asked for: "+10 ulp", "-1e-3"
  double gap = 0;                  // m along the approach from exact touching, positive: apart
  std::int64_t gap_ulps = 0;       // the same in units of `ulp`
  double ulp = 0;                  // m, the spacing of doubles at the greatest coordinate of the step's bodies
  double scale = 0, offset = 0;    // m
  std::uint64_t orientation = 0;   // which stream of the seed turned the two
  std::uint8_t truth = 0;          // 1: they meet
  std::uint8_t truth_moved = 0;    // 1: they meet when both are moved by an exactly representable step
  std::uint8_t near_touching = 0;  // 1: within 1000 ulps of touching, or the truth changes within 1000 ulps
};

/// What one algorithm said about the cases: a column of /extremes. S flags each.
struct ExtremeAnswers {
  std::vector<std::uint8_t> reported, swapped, moved;  // as placed, in the other order, both moved
  std::vector<std::uint8_t> failed;  // 1: it refused the bodies, 2: it threw at the step; then nothing is reported
  std::string reason;                // of the first failure
};

struct Extremes {
  std::vector<ExtremeCase> rows;        // S
  std::vector<ExtremeAnswers> answers;  // A
};

struct PhysicsRows {
  std::vector<PhysicsSample> rows;  // S
  std::string status;               // "complete", or "failed at step K: why"
  // Greatest | |q| - 1 | of the integrator's quaternions at samples, before they become poses; NaN: not known.
  double quaternion_drift = std::numeric_limits<double>::quiet_NaN();
};

/// One case of a study of the integrators: a row of /study. A parameter that its problem does not have is NaN.
struct StudyRow {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  // What is integrated, and how.
  std::string sweep, problem, integrator;
  std::string units = "SI";                        // or "scaled": in units of the problem's own length, mass and time
  double accuracy = kNone;                         // NaN with a fixed step
  double fixed_step = kNone;                       // s; NaN when the accuracy chooses the steps
  double nominal_order = kNone;                    // NaN: it varies
  double duration = kNone, greatest_step = kNone;  // s
  double radius = kNone, thickness = kNone, offset = kNone;  // m
  double mass = kNone, inertia = kNone;                      // kg, kg m^2
  double balls = kNone, mass_ratio = kNone;                  // 1
  double speed = kNone, transition_velocity = kNone;         // m/s
  double stiffness = kNone;                                  // Pa
  double dissipation = kNone;                                // s/m

  // What came of it. `status` is one of configs/README.md's, `reason` says in words why it did not finish, or
  // why its error is not known.
  std::string status = "not run", reason;
  double reached = kNone;                                                   // s
  double error = kNone, position_error = kNone, orientation_error = kNone;  // 1, m, rad
  double energy_error = kNone, momentum_drift = kNone;                      // 1
  double greatest_penetration = kNone, smallest_step = kNone;               // m, s
  double preventing_step = kNone;                                           // s
  std::uint64_t steps = 0, rejected_steps = 0, force_evaluations = 0;
  bool finished = false;
  std::int64_t time_ns = 0;  // of processor
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

struct Result {
  std::string title;
  std::string config_text, config_effective;
  double rate = 60;  // samples per second; time = step / rate
  geometry::Bodies bodies;
  std::vector<std::int64_t> first_step;             // B; -1 if never born
  std::vector<std::vector<geometry::Pose>> motion;  // S x B
  std::optional<PhysicsRows> physics;               // only when integrated
  Truth truth;
  std::vector<Answers> answers;      // A
  std::vector<Summary> summary;      // A
  std::optional<Noise> noise;        // only where asked for
  std::optional<Passes> passes;      // only of scenes that have some
  std::optional<Extremes> extremes;  // only of scenes of extremes
  // Of studies of the integrators, which have nothing of the above but title and configuration.
  std::optional<std::vector<StudyRow>> study;
  Provenance provenance;
  std::string digest;   // of the root; filled in by write and read
  bool vouched = true;  // false: read although its seal did not hold, so what is written of it gets none
  std::vector<std::string>
      foreign;  // objects at the root of the file read that are not this program's: not written again

  std::size_t steps() const { return motion.size(); }
};

}  // namespace pipeline
