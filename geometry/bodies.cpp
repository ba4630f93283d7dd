// The pairs of a step as runs.
//
// Whether (a, b) counts depends on a only through two bits, fixed and chosen. So there are at most four different
// lists of runs over all b, each made once; a body's own runs are those of its kind beyond itself. A step with B bodies
// and k interruptions takes O(B + runs) time, where runs <= B (k + 1).
#include "geometry/bodies.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace geometry {
namespace {

struct Range {
  std::uint32_t first = 0, last = 0;  // first <= b < last
};

}  // namespace

std::vector<PairRun> pair_runs(const Bodies& bodies, std::span<const Pose> poses) {
  assert(poses.size() == bodies.size() && "one pose per body");
  assert(bodies.fixed.size() == bodies.size() && "one flag `fixed` per body");
  assert((bodies.chosen.empty() || bodies.chosen.size() == bodies.size()) && "`chosen` is empty or has every body");
  const auto count = static_cast<std::uint32_t>(bodies.size());
  const auto is_chosen = [&](std::uint32_t body) { return bodies.chosen.empty() || bodies.chosen[body]; };

  std::vector<std::uint8_t> born(count);
  for (std::uint32_t b = 0; b < count; ++b) born[b] = is_born(poses[b]);

  std::array<std::vector<Range>, 4> partners;  // by 2 fixed + chosen of a
  for (unsigned kind = 0; kind < 4; ++kind)
    for (std::uint32_t b = 0; b < count; ++b) {
      if (!born[b] || ((kind & 2) && bodies.fixed[b]) || (!(kind & 1) && !is_chosen(b))) continue;
      if (partners[kind].empty() || partners[kind].back().last != b)
        partners[kind].push_back({b, b + 1});
      else
        partners[kind].back().last = b + 1;
    }

  std::vector<PairRun> runs;
  std::array<std::size_t, 4> next{};  // ranges before it end at or before a + 1
  for (std::uint32_t a = 0; a < count; ++a) {
    if (!born[a]) continue;
    const unsigned kind = (bodies.fixed[a] ? 2 : 0) + (is_chosen(a) ? 1 : 0);
    const std::vector<Range>& ranges = partners[kind];
    std::size_t& start = next[kind];
    while (start < ranges.size() && ranges[start].last <= a + 1) ++start;
    for (std::size_t i = start; i < ranges.size(); ++i)
      runs.push_back({a, std::max(ranges[i].first, a + 1), ranges[i].last});
  }
  return runs;
}

std::uint64_t pair_count(std::span<const PairRun> runs) {
  std::uint64_t pairs = 0;
  for (const PairRun& run : runs) pairs += run.last - run.first;
  return pairs;
}

}  // namespace geometry
