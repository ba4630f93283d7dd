// /passes: how early or late algorithms report bodies that pass straight through others; only of scripted scenes that
// have such passes. pipeline/stages/passes.hpp makes them.
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace pipeline {

/// How near positions are found, in metres: not further than this before the first or after the last change.
constexpr double kTruthTolerance = 1e-9;
constexpr double kAlgorithmTolerance = 1e-6;

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

/// What an algorithm said about the passes through one target.
struct TargetSummary {
  std::uint64_t passes = 0, met = 0;            // how many, and how many of them truly meet
  std::uint64_t missed = 0;                     // truly meet and are never reported
  std::uint64_t false_positives = 0;            // never meet and are reported
  std::uint64_t flicker = 0;                    // over all of them
  double median = 0, earliest = 0, latest = 0;  // of PassAnswers::first, m; NaN when there is none
};
TargetSummary summarise(const std::vector<PassRow>& rows, const PassAnswers& answers, const std::string& target);

/// The targets in the order of their first pass.
std::vector<std::string> targets(const std::vector<PassRow>& rows);

}  // namespace pipeline
