#include "algorithms/cannon_sap.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/spheres.hpp"

namespace algorithms {
namespace {

using geometry::Spheres;

using geometry::Vec3;

/// The lower bound along x of a body's box about its position, by the engine's own arithmetic: bounds that are equal
/// there are equal here.
double lower_bound(const Vec3& half, const Pose& pose) {
  const geometry::Quaternion& q = pose.q;
  double least = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    const double x = corner & 1 ? half.x() : -half.x(), y = corner & 2 ? half.y() : -half.y(),
                 z = corner & 4 ? half.z() : -half.z();
    const double ix = q.w * x + q.y * z - q.z * y, iy = q.w * y + q.z * x - q.x * z, iz = q.w * z + q.x * y - q.y * x,
                 iw = -q.x * x - q.y * y - q.z * z;
    least = std::min(least, pose.t.x() + (ix * q.w + iw * -q.x + iy * -q.z - iz * -q.y));
  }
  return least;
}

/// Sweep and prune along x.
class CannonSap final : public Method {
 public:
  CannonSap(const Bodies& bodies, const Knobs&) : bodies_(bodies), radius_(geometry::nominal_radii(bodies)) {
    for (const geometry::Mesh& mesh : bodies.meshes) half_.push_back(geometry::half_extents(mesh));
    order_.reserve(bodies.size());
    moving_.reserve(bodies.size());
    for (auto* column : {&upper_, &farthest_, &farthest_moving_}) column->reserve(bodies.size());
    first_run_.resize(bodies.size() + 1);
  }

  static Memory memory(const Bodies& bodies, const Knobs&) {
    return memory_by_body(bodies, 8 * sizeof(double) + sizeof(std::uint32_t) + sizeof(Entry) + sizeof(std::size_t));
  }

  void prepare(std::span<const Pose> poses, double /*enlarge*/) override {
    order_.clear();
    for (std::uint32_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;
      const bool ball = bodies_.mesh_of(body).sphere_radius > 0;
      order_.push_back(
          {ball ? poses[body].t.x() - radius_[body] : lower_bound(half_[bodies_.mesh[body]], poses[body]), body});
    }
    std::sort(order_.begin(), order_.end(), [](const Entry& p, const Entry& q) {
      return p.lower < q.lower || (p.lower == q.lower && p.body < q.body);
    });
    spheres_.resize(order_.size());
    for (auto* column : {&upper_, &farthest_, &farthest_moving_}) column->resize(order_.size());
    moving_.clear();
    double farthest = -std::numeric_limits<double>::infinity(), farthest_moving = farthest;
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const std::uint32_t body = order_[i].body;
      const double x = poses[body].t.x(), radius = radius_[body];
      spheres_.set(i, poses[body].t, radius);
      upper_[i] = x + radius;
      farthest = std::max(farthest, x - radius);
      if (!bodies_.fixed[body]) {
        farthest_moving = std::max(farthest_moving, x - radius);
        moving_.push_back(static_cast<std::uint32_t>(i));
      }
      farthest_[i] = farthest;
      farthest_moving_[i] = farthest_moving;
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
    double lower;  // of the box, along x
    std::uint32_t body;
  };

  template <class Count>
  void sweep(std::span<const PairRun> runs, std::vector<Pair>& hits, Count& count) {
    index(runs);
    constexpr std::uint32_t block = 1024;
    std::array<std::uint8_t, block> hit;
    const auto size = static_cast<std::uint32_t>(order_.size());
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint32_t end = first_apart(i, count);
      if (is_fixed(i)) {
        for (auto k = std::upper_bound(moving_.begin(), moving_.end(), i); k != moving_.end() && *k < end; ++k) {
          count += 1;
          if (spheres_.overlap(i, *k)) report(runs, i, *k, hits);
        }
        continue;
      }
      count += end - i - 1;  // the spheres
      for (std::uint32_t first = i + 1; first < end; first += block) {
        const std::uint32_t last = std::min(end, first + block);
        geometry::overlap_row(spheres_, i, first, last, hit.data());
        for (std::uint32_t k = first; k < last; ++k)
          if (hit[k - first]) report(runs, i, k, hits);
      }
    }
  }

  bool is_fixed(std::uint32_t place) const { return bodies_.fixed[order_[place].body]; }

  /// Where the engine breaks: at the first place after i whose ball is apart from that of i along x. Pairs of two fixed
  /// bodies are passed over before they are looked at. Balls do not begin in the order of the boxes, but the farthest
  /// beginning so far does rise: the first place where it is apart is found by halving.
  template <class Count>
  std::uint32_t first_apart(std::uint32_t i, Count& count) const {
    const std::vector<double>& begin = is_fixed(i) ? farthest_moving_ : farthest_;
    const double upper = upper_[i];
    if (begin[i] < upper) {  // but for rounding always: a ball begins before its box
      const auto apart = [&](double limit, double lower) {
        count += 1;
        return !(lower < limit);
      };
      return static_cast<std::uint32_t>(std::upper_bound(begin.begin() + i + 1, begin.end(), upper, apart) -
                                        begin.begin());
    }
    std::uint32_t k = i + 1;
    for (; k < order_.size(); ++k) {
      count += 1;
      const bool passed_over = is_fixed(i) && is_fixed(k);
      if (!passed_over && !(spheres_.x[k] - spheres_.r[k] < upper)) break;
    }
    return k;
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
    const auto begin = runs.begin() + first_run_[a], end = runs.begin() + first_run_[a + 1];
    const auto run =
        std::upper_bound(begin, end, b, [](std::uint32_t body, const PairRun& r) { return body < r.last; });
    if (run != end && run->first <= b) hits.push_back({a, b});
  }

  const Bodies& bodies_;
  std::vector<double> radius_;  // metres, of each body
  std::vector<Vec3> half_;      // of each mesh
  std::vector<Entry> order_;    // of the step: born bodies by lower bound
  // In that order: where each ball ends, and the farthest beginning of a ball so far, of all and of those that move.
  std::vector<double> upper_, farthest_, farthest_moving_;
  std::vector<std::uint32_t> moving_;  // places of bodies that move
  Spheres spheres_;                    // in that order
  std::vector<std::size_t> first_run_;
};

}  // namespace

Algorithm cannon_sap() {
  return {.name = "cannon_sap",
          .thesis_key = "",
          .what = "Cannon.js: sweep along x that ends at the first ball apart, bounding spheres overlap",
          .operations_unit = "comparisons of bounds, and distances",
          .scope = Scope::scene,
          .make = [](const Bodies& bodies, const Knobs& knobs) -> std::unique_ptr<Method> {
            return std::make_unique<CannonSap>(bodies, knobs);
          },
          .memory = CannonSap::memory};
}

}  // namespace algorithms
