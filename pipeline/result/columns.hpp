// The columns of /results and /summary, each in one place: name, unit, meaning and the member that it is kept in.
// Whoever writes, reads, checkpoints, appends or prints them loops: a new column is a member (result.hpp), a row here,
// and the value that is put into it (stages/detect.cpp, stages/summary.cpp).
#pragma once
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "pipeline/result/result.hpp"

namespace pipeline {

/// A column of the file and the member it comes from. `Stored` are the values of the dataset.
template <typename Row, typename T, typename Stored = T>
struct Column {
  const char* name;
  T Row::*member;
  const char* units;
  const char* long_name;
  /// Of tables per algorithm: not in a file of which no algorithm has values of it, nor in files older than the column;
  /// an algorithm without values has zeros beside others that have some. A column of rows is optional when T is.
  bool optional = false;
};

template <typename T>
inline constexpr bool is_optional = false;
template <typename T>
inline constexpr bool is_optional<std::optional<T>> = true;

inline constexpr Column<Answers, std::vector<std::int64_t>> kAnswerTimes[] = {
    {"time_ns", &Answers::time_ns, "ns", "fastest repeat of the step, preparation included"},
    {"time_median_ns", &Answers::time_median_ns, "ns", "median repeat of the step, preparation included"},
    {"prepare_ns", &Answers::prepare_ns, "ns",
     "part of the fastest repeat: what is made ready for all bodies before the first pair"},
    {"processor_ns", &Answers::processor_ns, "ns",
     "processor time of the fastest repeat; where time_ns is more, the processor did other work; 0: not taken",
     /*optional=*/true},
    {"exchange_ns", &Answers::exchange_ns, "ns",
     "of the fastest repeat, wall time of question and answer of a method in a process of its own; 0: of no such "
     "method",
     /*optional=*/true}};
inline constexpr Column<Answers, std::vector<std::uint64_t>> kAnswerCounts[] = {
    {"true_positive", &Answers::true_positive, "1", "pairs reported that truly meet"},
    {"false_positive", &Answers::false_positive, "1",
     "pairs reported that do not meet; contained_hit is counted apart"},
    {"false_negative", &Answers::false_negative, "1", "pairs that meet and were not reported"},
    {"rounding_miss", &Answers::rounding_miss, "1",
     "misses of a conservative method that vanish when enlarged by 2^-40"},
    {"operations", &Answers::operations, "1", "elementary tests made; what is counted: operations_unit of /answers"},
    {"contained_hit", &Answers::contained_hit, "1",
     "pairs reported whose surfaces do not meet, one body being inside the other", /*optional=*/true}};

template <class T>
T total(const std::vector<T>& column) {
  return std::accumulate(column.begin(), column.end(), T{0});
}

/// Of at least one value, sorted.
template <class T>
double median(const std::vector<T>& sorted) {
  const std::size_t n = sorted.size();
  return n % 2 ? double(sorted[n / 2]) : 0.5 * (double(sorted[n / 2 - 1]) + double(sorted[n / 2]));
}

/// Tells `each` the columns of /results that hold times, in the file's order.
template <typename Each>
void each_answer_time(const Each& each) {
  for (const auto& column : kAnswerTimes) each(column);
}

/// The others but `hits`, which follows from the lists of pairs and stands between the two.
template <typename Each>
void each_answer_count(const Each& each) {
  for (const auto& column : kAnswerCounts) each(column);
}

/// All of them.
template <typename Each>
void each_answer_column(const Each& each) {
  each_answer_time(each);
  each_answer_count(each);
}

inline constexpr Column<Summary, std::uint64_t> kSummaryCounts[] = {
    {"hits", &Summary::hits, "1", "pairs reported, over all steps"},
    {"true_positive", &Summary::true_positive, "1", "pairs reported that truly meet"},
    {"false_positive", &Summary::false_positive, "1",
     "pairs reported that do not meet; contained_hit is counted apart"},
    {"false_negative", &Summary::false_negative, "1", "pairs that meet and were not reported"},
    {"operations", &Summary::operations, "1", "elementary tests made; what is counted: operations_unit of /answers"}};
inline constexpr Column<Summary, double> kSummaryReals[] = {
    {"error", &Summary::error, "1",
     "(FP + FN) / (TP + FP + FN); 0 when nothing is to be found and nothing was reported"},
    {"precision", &Summary::precision, "1", "TP / (TP + FP)"},
    {"recall", &Summary::recall, "1", "TP / (TP + FN)"},
    {"matthews", &Summary::matthews, "1", "Matthews' correlation coefficient over pairs of born bodies"},
    {"time_mean_ns", &Summary::time_mean_ns, "ns", "mean over steps of the fastest repeat"},
    {"time_median_ns", &Summary::time_median_ns, "ns", "median over steps of the fastest repeat"},
    {"time_p95_ns", &Summary::time_p95_ns, "ns", "95th percentile over steps of the fastest repeat"}};
inline constexpr Column<Summary, std::optional<double>, double> kSummaryOptionalReals[] = {
    {"time_mean_low_ns", &Summary::time_mean_low_ns, "ns",
     "lower end of a 95 % interval of time_mean_ns, by a block bootstrap over steps; NaN: too few steps"},
    {"time_mean_high_ns", &Summary::time_mean_high_ns, "ns",
     "upper end of a 95 % interval of time_mean_ns, by a block bootstrap over steps; NaN: too few steps"},
    {"processor_mean_ns", &Summary::processor_mean_ns, "ns", "mean over steps of processor_ns; NaN: not taken"},
    {"setup_ns", &Summary::setup_ns, "ns", "construction for the bodies of the run; NaN: not known"},
    {"memory_bytes", &Summary::memory_bytes, "B", "heap held after construction; NaN: not known"},
    {"memory_greatest_bytes", &Summary::memory_greatest_bytes, "B", "heap held at the most; NaN: not known"}};
inline constexpr Column<Summary, bool, std::uint8_t> kSummaryKept{"promise_kept", &Summary::promise_kept, "1",
                                                                  "0 when a promise was broken"};

inline constexpr Column<Summary, std::optional<std::uint64_t>, std::uint64_t> kSummaryOptionalCounts[] = {
    {"contained_hit", &Summary::contained_hit, "1",
     "pairs reported whose surfaces do not meet, one body being inside the other"}};

/// Tells `each` every column of /summary, in the file's order.
template <typename Each>
void each_summary_column(const Each& each) {
  for (const auto& column : kSummaryCounts) each(column);
  for (const auto& column : kSummaryReals) each(column);
  for (const auto& column : kSummaryOptionalReals) each(column);
  each(kSummaryKept);
  for (const auto& column : kSummaryOptionalCounts) each(column);
}

}  // namespace pipeline
