// `pipeline score`: a result's deterministic figures against a recorded baseline, a small JSON file kept beside the
// tests. Motion, truth and answers by digest; counts and operations as numbers, so that a change says how large it is.
//
//   {"algorithms": {LABEL: {"answers": digest, "false_positive": 12, ...}, ...}, "bodies": 275, "kind": ...,
//    "motion": digest, "schema_version": 1, "steps": 8, "truth": {"digest": ..., "hits": 410, ...}}
//
// Keys are sorted, one figure a line: a change reads well in a diff. `time_ratio` of an algorithm, where recorded, is
// its mean time over the median of all algorithms' mean times in the same run: what differs between machines by one
// factor differs by none here.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/result/result.hpp"

namespace pipeline {

/// Grows when a key or its meaning changes. Others are refused.
constexpr int kBaselineSchema = 1;

struct ScoreOptions {
  bool write = false;               // record instead of judging
  bool times = false;               // compare, or record, times
  std::optional<double> tolerance;  // with times: a ratio that changed by more than this factor is a difference
};

/// One figure that changed; an old or new one that is not there is "". Numbers and texts as JSON has them.
struct Change {
  std::string of;  // "motion", "truth", ..., or an algorithm's label
  std::string key, before, now;
  std::optional<std::int64_t> by;  // of numbers
};

struct TimeChange {
  std::string label;
  double before = 0, now = 0;  // time ratios over the algorithms that both have
  // How set-up (over the median of all) and memory have changed, as factors; NaN: not in both. Shown, never judged.
  double setup = Costs::kUnknown, memory = Costs::kUnknown;
};

struct Score {
  std::vector<Change> changes;                // by section, then key
  std::vector<std::string> fresh, missing;    // labels only the result, only the baseline has
  std::vector<TimeChange> times;              // when asked for
  std::vector<std::string> beyond_tolerance;  // labels
  std::vector<std::string> unlike;            // labels that were timed on unlike processors, when times are asked for
  std::size_t algorithms = 0;                 // in both
  bool had_baseline = false, written = false;

  bool same() const { return changes.empty() && fresh.empty() && missing.empty() && beyond_tolerance.empty(); }
};

/// Compares, also with another result; with options.write also records, unless nothing changed. Throws Error(kFile)
/// when the baseline is missing (and is not to be written), is no JSON, no baseline or of another schema, or cannot be
/// written. A file that is no baseline is not replaced.
Score score(const Result& result, const std::filesystem::path& baseline, const ScoreOptions& options);

std::string score_text(const Score& score, const std::string& baseline);
std::string score_json(const Score& score, const std::string& file, const std::string& baseline);

}  // namespace pipeline
