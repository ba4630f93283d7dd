// How far a mean over the steps can be trusted, and a ratio of two: 95 % intervals by a block bootstrap.
//
// Times of neighbouring steps are not independent: steps are like their neighbours, disturbances last, and the order of
// the algorithms alternates. Hence blocks of kBlockSteps steps, the chunks that begin with empty memories, are drawn
// instead of steps. A run has few of them (12 of 600 steps), and with 12 the plain percentiles hold the true ratio in
// 90 % of trials, not 95. So the bootstrap is studentised (Efron and Tibshirani 1993, section 12.5) and symmetric (Hall
// 1988): of the logarithm of a ratio of sums, whose standard error s comes from the blocks,
//
//     theta = log(A / B),   u_j = k (a_j / A - b_j / B),   s^2 = sum u_j^2 / (k (k - 1))                          (1)
//
// for sums a_j, b_j of block j of k, A and B of all; resamples of k blocks give theta* and s*; the interval is
// theta -+ q s, q being the 95 % quantile of |theta* - theta| / s*. With fewer than kBootstrapBlocks blocks many
// resamples have two or three different ones and next to no s*: q can be any number (3,000 was seen). There q is
// Student's, of k - 1 degrees of freedom, as of batch means (Law 2015, section 9.5.3). tests/interval_trials.py has the
// trials.
//
// analysis/tables/intervals.py computes the same from the same draws.
#pragma once
#include <cstdint>
#include <limits>
#include <span>

namespace pipeline {

constexpr std::size_t kBlockSteps = 50;
/// With fewer blocks there is no interval.
constexpr std::size_t kLeastBlocks = 5;
/// With fewer blocks the quantile of (1) is wild.
constexpr std::size_t kBootstrapBlocks = 12;
/// Longer runs have longer blocks.
constexpr std::size_t kMostBlocks = 1000;

struct Interval {
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN(), high = std::numeric_limits<double>::quiet_NaN();
};

/// The mean of `times` and its interval; without the latter (NaN) for fewer than kLeastBlocks blocks of steps, or when
/// a block's times are all 0. Needs a time.
Interval mean_interval(std::span<const std::int64_t> times);

/// The mean of `times` over that of `others`, of the same steps.
Interval ratio_interval(std::span<const std::int64_t> times, std::span<const std::int64_t> others);

}  // namespace pipeline
