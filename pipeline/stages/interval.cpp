#include "pipeline/stages/interval.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <vector>

#include "geometry/random.hpp"

namespace pipeline {
namespace {

constexpr std::size_t kResamples = 1999;         // 1900 of them make the quantile exactly
constexpr std::uint64_t kSeed = 0x9d5c0fb3a1e6;  // any

/// Of Student's t with kLeastBlocks - 1, ... kBootstrapBlocks - 2 degrees of freedom, the 97.5 % quantile.
constexpr double kStudent[] = {2.776445105198, 2.570581835636, 2.446911851145, 2.364624251593,
                               2.306004135204, 2.262157162798, 2.228138851986};
static_assert(std::size(kStudent) == kBootstrapBlocks - kLeastBlocks);

/// Sums over blocks: floor(steps / length) of them, the last with what is left over.
std::vector<double> block_sums(std::span<const std::int64_t> values) {
  const std::size_t all = values.size() / kBlockSteps;
  const std::size_t length = kBlockSteps * std::max<std::size_t>(1, (all + kMostBlocks - 1) / kMostBlocks);
  const std::size_t blocks = std::max<std::size_t>(1, values.size() / length);
  std::vector<double> sums(blocks);
  for (std::size_t i = 0; i < values.size(); ++i) sums[std::min(i / length, blocks - 1)] += double(values[i]);
  return sums;
}

struct Estimate {
  double theta = 0, error = 0;  // of (1)
};

/// From the blocks that `block` names, k of them.
template <class Block>
Estimate estimate(const std::vector<double>& a, const std::vector<double>& b, const Block& block) {
  const std::size_t k = a.size();
  double sum_a = 0, sum_b = 0, squares = 0;
  for (std::size_t j = 0; j < k; ++j) {
    sum_a += a[block(j)];
    sum_b += b[block(j)];
  }
  for (std::size_t j = 0; j < k; ++j) {
    const double u = double(k) * (a[block(j)] / sum_a - b[block(j)] / sum_b);
    squares += u * u;
  }
  return {std::log(sum_a / sum_b), std::sqrt(squares / (double(k) * double(k - 1)))};
}

/// q of (1).
double quantile(const std::vector<double>& a, const std::vector<double>& b, const Estimate& all) {
  const std::size_t k = a.size();
  if (k < kBootstrapBlocks) return kStudent[k - kLeastBlocks];
  geometry::Random random(kSeed);
  std::vector<std::size_t> drawn(k);
  std::vector<double> deviations;
  for (std::size_t r = 0; r < kResamples; ++r) {
    for (std::size_t& block : drawn) block = std::size_t(((random.next() >> 32) * k) >> 32);
    const Estimate one = estimate(a, b, [&](std::size_t j) { return drawn[j]; });
    const double off = std::abs(one.theta - all.theta);
    deviations.push_back(off == 0 ? 0 : off / one.error);  // one block drawn k times: infinite
  }
  constexpr std::size_t kQuantile = (kResamples + 1) * 95 / 100 - 1;
  std::ranges::nth_element(deviations, deviations.begin() + kQuantile);
  return deviations[kQuantile];
}

Interval interval(const std::vector<double>& a, const std::vector<double>& b) {
  double sum_a = 0, sum_b = 0;
  for (const double sum : a) sum_a += sum;
  for (const double sum : b) sum_b += sum;
  Interval out{sum_a / sum_b};
  const auto nothing = [](double sum) { return !(sum > 0); };
  if (a.size() < kLeastBlocks || std::ranges::any_of(a, nothing) || std::ranges::any_of(b, nothing)) return out;
  const Estimate all = estimate(a, b, [](std::size_t j) { return j; });
  const double half = all.error == 0 ? 0 : quantile(a, b, all) * all.error;
  out.low = out.value * std::exp(-half);
  out.high = out.value * std::exp(half);
  return out;
}

}  // namespace

Interval mean_interval(std::span<const std::int64_t> times) {
  const std::vector<std::int64_t> ones(times.size(), 1);
  return interval(block_sums(times), block_sums(ones));
}

Interval ratio_interval(std::span<const std::int64_t> times, std::span<const std::int64_t> others) {
  assert(times.size() == others.size() && "times of the same steps");
  return interval(block_sums(times), block_sums(others));
}

}  // namespace pipeline
