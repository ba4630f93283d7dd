// /extremes: pairs placed around exact touching, what is true of them and what algorithms say; only of scenes of
// extremes. pipeline/stages/extremes.hpp makes them.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/result/columns.hpp"

namespace pipeline {

/// Within that many ulps of touching a pair is counted apart: methods that round elsewhere are not charged with our
/// convention.
constexpr std::int64_t kNearUlps = 1000;

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

inline constexpr Column<ExtremeAnswers, std::vector<std::uint8_t>> kCaseAnswerFlags[] = {
    {"reported", &ExtremeAnswers::reported, "1", "1 when the algorithm reported the pair"},
    {"swapped", &ExtremeAnswers::swapped, "1", "its answer with the two bodies in the other order"},
    {"moved", &ExtremeAnswers::moved, "1", "its answer with both bodies moved by an exactly representable step"},
    {"failed", &ExtremeAnswers::failed, "1", "1: it refused the bodies, 2: it threw; then its other flags are 0"}};
/// Tells `each` every column of what an algorithm said about the cases of /extremes.
template <typename Each>
void each_case_answer_column(const Each& each) {
  for (const auto& column : kCaseAnswerFlags) each(column);
}

/// One algorithm over some cases.
struct ExtremesCount {
  std::uint64_t cases = 0, true_positive = 0, false_positive = 0, false_negative = 0, failed = 0;

  double error() const;  // of the cases that did not fail; NaN when there is none
};

/// Counts the cases that `chosen` says.
template <class Chosen>
ExtremesCount count(const Extremes& extremes, std::size_t algorithm, Chosen chosen) {
  ExtremesCount out;
  const ExtremeAnswers& said = extremes.answers[algorithm];
  for (std::size_t s = 0; s < extremes.rows.size(); ++s) {
    const ExtremeCase& row = extremes.rows[s];
    if (!chosen(row)) continue;
    ++out.cases;
    out.failed += said.failed[s] != 0;
    if (said.failed[s]) continue;
    out.true_positive += said.reported[s] && row.truth;
    out.false_positive += said.reported[s] && !row.truth;
    out.false_negative += !said.reported[s] && row.truth;
  }
  return out;
}

/// What an algorithm's answers are worth besides being right; over all cases that did not fail.
struct ExtremesInstability {
  std::uint64_t swapped = 0;  // answers that change with the order of the pair
  std::uint64_t moved = 0;    // that change when both are moved, while the truth does not
};
ExtremesInstability instability(const Extremes& extremes, std::size_t algorithm);

}  // namespace pipeline
