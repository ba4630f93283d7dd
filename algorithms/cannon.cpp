#include "algorithms/cannon.hpp"

#include <algorithm>
#include <cmath>

#include "algorithms/pairwise.hpp"
#include "geometry/kernel.hpp"

namespace algorithms {
namespace {

/// Bounding spheres by coordinate, metres.
struct Spheres {
  std::vector<double> x, y, z, r;

  void resize(std::size_t size) {
    for (auto* column : {&x, &y, &z, &r}) column->resize(size);
  }
  void set(std::size_t i, const geometry::Vec3& centre, double radius) {
    x[i] = centre.x();
    y[i] = centre.y();
    z[i] = centre.z();
    r[i] = radius;
  }
  bool overlap(std::size_t i, std::size_t k) const {
    const double dx = x[i] - x[k], dy = y[i] - y[k], dz = z[i] - z[k], reach = r[i] + r[k];
    return dx * dx + dy * dy + dz * dz < reach * reach;
  }
};

/// Spheres::overlap of sphere i with first ... last - 1.
PROCESSOR_CLONES void overlap_row(const double* x, const double* y, const double* z, const double* r, std::uint32_t i,
                                  std::uint32_t first, std::uint32_t last, std::uint8_t* hit) {
  const double ix = x[i], iy = y[i], iz = z[i], ir = r[i];
  for (std::uint32_t k = first; k < last; ++k) {
    const double dx = ix - x[k], dy = iy - y[k], dz = iz - z[k], reach = ir + r[k];
    hit[k - first] = dx * dx + dy * dy + dz * dz < reach * reach;
  }
}

void overlap_row(const Spheres& s, std::uint32_t i, std::uint32_t first, std::uint32_t last, std::uint8_t* hit) {
  overlap_row(s.x.data(), s.y.data(), s.z.data(), s.r.data(), i, first, last, hit);
}

std::vector<double> nominal_radii(const Bodies& bodies) {
  std::vector<double> radii;
  for (std::uint32_t body = 0; body < bodies.size(); ++body) {
    const geometry::Mesh& mesh = bodies.mesh_of(body);
    const geometry::Vec3 h = geometry::half_extents(mesh);
    radii.push_back(mesh.sphere_radius > 0 ? mesh.sphere_radius
                                           : std::sqrt(h.x() * h.x() + h.y() * h.y() + h.z() * h.z()));
  }
  return radii;
}

double enlarged(double radius, const geometry::Vec3& t, double enlarge) {
  return enlarge > 0 ? radius + enlarge * (radius + t.norm()) : radius;
}

struct CannonNaive {
  CannonNaive(const Bodies& bodies, const Knobs&) : radius(nominal_radii(bodies)) { spheres.resize(bodies.size()); }

  void prepare(std::span<const Pose> poses, double enlarge) {
    for (std::size_t body = 0; body < poses.size(); ++body)
      spheres.set(body, poses[body].t, enlarged(radius[body], poses[body].t, enlarge));
  }

  // The second phase is done already: `runs` hold no two fixed bodies.
  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    count += 1;
    return spheres.overlap(a, b);
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    overlap_row(spheres, a, first, last, out);
  }

  std::vector<double> radius;  // metres, not enlarged
  Spheres spheres;             // of the step
};

/// Sweep and prune along x.
class CannonSap final : public Method {
 public:
  CannonSap(const Bodies& bodies, const Knobs&) : fixed_(bodies.fixed), radius_(nominal_radii(bodies)) {
    order_.reserve(bodies.size());
    lower_.reserve(bodies.size());
    upper_.reserve(bodies.size());
    first_run_.resize(bodies.size() + 1);
  }

  void prepare(std::span<const Pose> poses, double enlarge) override {
    order_.clear();
    for (std::uint32_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;
      const double radius = enlarged(radius_[body], poses[body].t, enlarge), x = poses[body].t.x();
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
        overlap_row(spheres_, i, first, last, hit.data());
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

Algorithm cannon_naive() {
  return {.name = "cannon_naive",
          .thesis_key = "",
          .what = "Cannon.js: all pairs, bounding spheres overlap",
          .operations_unit = "distances",
          .promise = Promise::conservative,
          .make = make_pairwise<CannonNaive>};
}

Algorithm cannon_sap() {
  return {.name = "cannon_sap",
          .thesis_key = "",
          .what = "Cannon.js: sweep and prune along x, bounding spheres overlap",
          .operations_unit = "comparisons of bounds, and distances",
          .promise = Promise::conservative,
          .scope = Scope::scene,
          .make = [](const Bodies& bodies, const Knobs& knobs) -> std::unique_ptr<Method> {
            return std::make_unique<CannonSap>(bodies, knobs);
          }};
}

}  // namespace algorithms
