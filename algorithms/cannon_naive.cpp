#include "algorithms/cannon_naive.hpp"

#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/spheres.hpp"

namespace algorithms {
namespace {

using geometry::Spheres;

struct CannonNaive {
  CannonNaive(const Bodies& bodies, const Knobs&) : radius(geometry::nominal_radii(bodies)) {
    spheres.resize(bodies.size());
  }

  static Memory memory(const Bodies& bodies, const Knobs&) { return memory_by_body(bodies, 5 * sizeof(double)); }

  void prepare(std::span<const Pose> poses, double enlarge) {
    for (std::size_t body = 0; body < poses.size(); ++body)
      spheres.set(body, poses[body].t, geometry::enlarged(radius[body], poses[body].t, enlarge));
  }

  // The second phase is done already: `runs` hold no two fixed bodies.
  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) const {
    count += 1;
    return spheres.overlap(a, b);
  }

  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) const {
    geometry::overlap_row(spheres, a, first, last, out);
  }

  std::vector<double> radius;  // metres, not enlarged
  Spheres spheres;             // of the step
};

}  // namespace

Algorithm cannon_naive() {
  return {.name = "cannon_naive",
          .thesis_key = "",
          .what = "Cannon.js: all pairs, bounding spheres overlap",
          .operations_unit = "distances",
          .promise = Promise::conservative,
          .make = make_pairwise<CannonNaive>,
          .memory = CannonNaive::memory};
}

}  // namespace algorithms
