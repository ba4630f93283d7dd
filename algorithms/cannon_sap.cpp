#include "algorithms/cannon_sap.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/spheres.hpp"

namespace algorithms {
namespace {

using geometry::Spheres;

/// Sweep and prune along x.
class CannonSap final : public Method {
 public:
  CannonSap(const Bodies& bodies, const Knobs&) : fixed_(bodies.fixed), radius_(geometry::nominal_radii(bodies)) {
    order_.reserve(bodies.size());
    lower_.reserve(bodies.size());
    upper_.reserve(bodies.size());
    first_run_.resize(bodies.size() + 1);
  }

  static Memory memory(const Bodies& bodies, const Knobs&) {
    return memory_by_body(bodies, 1 + 7 * sizeof(double) + sizeof(Entry) + sizeof(std::size_t));
  }

  void prepare(std::span<const Pose> poses, double enlarge) override {
    order_.clear();
    for (std::uint32_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;
      const double radius = geometry::enlarged(radius_[body], poses[body].t, enlarge), x = poses[body].t.x();
      // The bounds give way by their rounding, so that a gap between them is one between the spheres: the sweep then
      // finds all that the naive phase finds.
      order_.push_back({(x - radius) - 0x1p-50 * (std::fabs(x) + radius), radius, body});
    }
    std::sort(order_.begin(), order_.end(), [](const Entry& p, const Entry& q) {
      return p.lower < q.lower || (p.lower == q.lower && p.body < q.body);
    });
    spheres_.resize(order_.size());
    lower_.resize(order_.size());
    upper_.resize(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const auto& [lower, radius, body] = order_[i];
      const double x = poses[body].t.x();
      spheres_.set(i, poses[body].t, radius);
      lower_[i] = lower;
      upper_[i] = (x + radius) + 0x1p-50 * (std::fabs(x) + radius);
    }
  }

  void answer(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    NoCount none;
    sweep(runs, hits, none);
  }

  std::uint64_t count(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    Counter counter;
    sweep(runs, hits, counter);
    return counter.total;
  }

 private:
  struct Entry {
    double lower, radius;
    std::uint32_t body;
  };

  template <class Count>
  void sweep(std::span<const PairRun> runs, std::vector<Pair>& hits, Count& count) {
    index(runs);
    constexpr std::uint32_t block = 1024;
    std::array<std::uint8_t, block> hit;
    const auto size = static_cast<std::uint32_t>(order_.size());
    for (std::uint32_t i = 0; i < size; ++i) {
      const auto gap =
          std::upper_bound(lower_.begin() + i + 1, lower_.end(), upper_[i], [&](double upper, double lower) {
            count += 1;
            return upper < lower;
          });
      const auto end = static_cast<std::uint32_t>(gap - lower_.begin());
      count += end - i - 1;  // the spheres
      for (std::uint32_t first = i + 1; first < end; first += block) {
        const std::uint32_t last = std::min(end, first + block);
        geometry::overlap_row(spheres_, i, first, last, hit.data());
        for (std::uint32_t k = first; k < last; ++k)
          if (hit[k - first]) report(runs, i, k, hits);
      }
    }
  }

  /// Where each body's runs begin.
  void index(std::span<const PairRun> runs) {
    std::size_t next = 0;
    for (std::uint32_t body = 0; body < first_run_.size(); ++body) {
      while (next < runs.size() && runs[next].a < body) ++next;
      first_run_[body] = next;
    }
  }

  /// Appends the pair of the bodies at i and k of the order, if it is asked about.
  void report(std::span<const PairRun> runs, std::uint32_t i, std::uint32_t k, std::vector<Pair>& hits) const {
    const auto [a, b] = std::minmax({order_[i].body, order_[k].body});
    if (fixed_[a] && fixed_[b]) return;
    const auto begin = runs.begin() + first_run_[a], end = runs.begin() + first_run_[a + 1];
    const auto run =
        std::upper_bound(begin, end, b, [](std::uint32_t body, const PairRun& r) { return body < r.last; });
    if (run != end && run->first <= b) hits.push_back({a, b});
  }

  std::vector<std::uint8_t> fixed_;
  std::vector<double> radius_;  // metres, not enlarged
  std::vector<Entry> order_;    // of the step: born bodies by lower bound
  std::vector<double> lower_, upper_;
  Spheres spheres_;  // in that order
  std::vector<std::size_t> first_run_;
};

}  // namespace

Algorithm cannon_sap() {
  return {.name = "cannon_sap",
          .thesis_key = "",
          .what = "Cannon.js: sweep and prune along x, bounding spheres overlap",
          .operations_unit = "comparisons of bounds, and distances",
          .promise = Promise::conservative,
          .scope = Scope::scene,
          .make = [](const Bodies& bodies, const Knobs& knobs) -> std::unique_ptr<Method> {
            return std::make_unique<CannonSap>(bodies, knobs);
          },
          .memory = CannonSap::memory};
}

}  // namespace algorithms
