#include "pipeline/stages/passes.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <optional>

#include "pipeline/stages/detect.hpp"
#include "pipeline/stages/summary.hpp"

namespace pipeline {
namespace {

using geometry::Pose;
using Poses = std::vector<std::vector<Pose>>;

Pair pair_of(const Pass& pass) { return {std::min(pass.hero, pass.target), std::max(pass.hero, pass.target)}; }

/// For every sample of the pass, whether its pair is in `lists`.
std::vector<bool> samples_in(const PairLists& lists, const Pass& pass) {
  std::vector<bool> in;
  for (std::int64_t i = 0; i < pass.samples; ++i)
    in.push_back(std::ranges::binary_search(lists.at(std::size_t(pass.first_step + i)), pair_of(pass)));
  return in;
}

/// A position where `says` is true, at most `tolerance` from one where it is false, between `no` where it is false and
/// `yes` where it is true.
template <class Says>
double edge(double no, double yes, double tolerance, Says says) {
  while (std::fabs(yes - no) > tolerance) {
    const double middle = 0.5 * (no + yes);
    if (middle == no || middle == yes) break;
    (says(middle) ? yes : no) = middle;
  }
  return yes;
}

struct Span {
  double first, last;  // m from the pass's start
};

/// Where `says` is first and last true, given at which samples it is.
template <class Says>
std::optional<Span> span_of(const Pass& pass, const std::vector<bool>& samples, double tolerance, Says says) {
  const auto first = std::ranges::find(samples, true) - samples.begin();
  if (first == pass.samples) return std::nullopt;
  auto last = pass.samples - 1;
  while (!samples[std::size_t(last)]) --last;
  Span span{position(pass, first), position(pass, last)};
  if (first > 0) span.first = edge(position(pass, first - 1), span.first, tolerance, says);
  if (last + 1 < pass.samples) span.last = edge(position(pass, last + 1), span.last, tolerance, says);
  return span;
}

std::uint64_t count(const std::vector<bool>& samples) {
  return std::uint64_t(std::count(samples.begin(), samples.end(), true));
}

/// The counts of samples, and where `span_in` says that reports of a pass begin and end.
template <class SpanIn>
PassAnswers answers_of(const std::vector<Pass>& passes, const Truth& truth, const std::vector<PassRow>& rows,
                       const Answers& answers, SpanIn span_in) {
  assert(rows.size() == passes.size() && "a row per pass");
  PassAnswers out;
  for (std::size_t p = 0; p < passes.size(); ++p) {
    const std::vector<bool> meets = samples_in(truth.hits, passes[p]), reported = samples_in(answers.hits, passes[p]);
    out.hits.push_back(count(reported));
    std::uint64_t flicker = 0;
    for (std::size_t i = 1; i < meets.size(); ++i)
      flicker += meets[i - 1] && meets[i] && reported[i - 1] != reported[i];
    out.flicker.push_back(flicker);
    std::optional<Span> span;
    if (rows[p].truth_hits > 0) span = span_in(passes[p], reported);
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    out.first.push_back(span ? rows[p].truth_first - span->first : kNaN);
    out.last.push_back(span ? rows[p].truth_last - span->last : kNaN);
  }
  return out;
}

/// Of a method that has not failed. Throws Fault.
PassAnswers answered(const geometry::Bodies& bodies, const Poses& poses, const Truth& truth,
                     const std::vector<Pass>& passes, const std::vector<PassRow>& rows, const Answers& answers,
                     const AlgorithmChoice& choice, Progress& progress) {
  std::unique_ptr<algorithms::Method> method;
  try {
    method = make_method(choice, bodies);
  } catch (const std::bad_alloc&) {
    throw OutOfMemory(choice, bodies);
  }
  std::vector<Pair> found;
  return answers_of(passes, truth, rows, answers, [&](const Pass& pass, const std::vector<bool>& reported) {
    stop_if_wanted();
    progress.add(1);
    const Pair pair = pair_of(pass);
    const geometry::PairRun run{pair.a, pair.b, pair.b + 1};
    std::vector<Pose> at = poses[std::size_t(pass.first_step)];
    return span_of(pass, reported, kAlgorithmTolerance, [&](double metres) {
      at[pass.hero] = pose_at(pass, metres);
      found.clear();
      method->prepare(at);
      method->answer({&run, 1}, found);
      return !found.empty();
    });
  });
}

}  // namespace

std::vector<PassRow> pass_rows(const geometry::Bodies& bodies, const Poses& poses, const Truth& truth,
                               const std::vector<Pass>& passes, Progress& progress) {
  const std::vector<geometry::Bvh> bvhs = geometry::build_bvhs(bodies);
  geometry::Decision decision(bodies, bvhs);
  std::vector<PassRow> rows;
  for (const Pass& pass : passes) {
    stop_if_wanted();
    PassRow row{.target = bodies.name[pass.target],
                .path = pass.path,
                .orientation = pass.orientation,
                .offset = pass.offset,
                .first_step = std::uint64_t(pass.first_step),
                .samples = std::uint64_t(pass.samples)};
    const std::vector<bool> samples = samples_in(truth.hits, pass);
    row.truth_hits = count(samples);
    std::vector<Pose> at = poses[std::size_t(pass.first_step)];
    const auto span = span_of(pass, samples, kTruthTolerance, [&](double metres) {
      at[pass.hero] = pose_at(pass, metres);
      return decision.meet(at, pair_of(pass));
    });
    if (span) row.truth_first = span->first, row.truth_last = span->last;
    rows.push_back(std::move(row));
    progress.add(1);
  }
  return rows;
}

PassAnswers pass_answers(const geometry::Bodies& bodies, const Poses& poses, const Truth& truth,
                         const std::vector<Pass>& passes, const std::vector<PassRow>& rows, Answers& answers,
                         const AlgorithmChoice& choice, Progress& progress) {
  try {
    if (!failed(answers)) return answered(bodies, poses, truth, passes, rows, answers, choice, progress);
  } catch (const Fault& fault) {
    answers.foreign->reason = std::string("between the samples of a pass: ") + fault.what();
  }
  PassAnswers unknown;
  unknown.first.assign(rows.size(), std::numeric_limits<double>::quiet_NaN());
  unknown.last = unknown.first;
  unknown.flicker.assign(rows.size(), 0);
  unknown.hits = unknown.flicker;
  return unknown;
}

PassAnswers sampled_pass_answers(const std::vector<Pass>& passes, const Truth& truth, const std::vector<PassRow>& rows,
                                 const Answers& answers) {
  return answers_of(passes, truth, rows, answers, [](const Pass& pass, const std::vector<bool>& reported) {
    std::optional<Span> span =
        span_of(pass, reported, std::numeric_limits<double>::infinity(), [](double) { return true; });
    if (!span) return span;
    const double half = 0.5 * (position(pass, 1) - position(pass, 0));
    if (!reported.front()) span->first -= half;
    if (!reported.back()) span->last += half;
    return span;
  });
}

}  // namespace pipeline
