// facet_vectors: quadrants and the smallest third component of all vectors B_j - A_i, without forming them all.
//
// A rounded difference has the sign of the exact one, so "b - a > 0" is "b > a"; and rounding is monotone, so the
// smallest rounded gap of two intervals that do not overlap is that of their nearest ends. Both hold bit for bit.
// Bounds and outermost points decide most pairs; where they do not, all vectors are looked at.
#include "algorithms/thesis/facet_vectors.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "algorithms/contract/prefilter.hpp"
#include "algorithms/parts/facet_knobs.hpp"
#include "algorithms/parts/facets.hpp"
#include "geometry/processor_clones.hpp"

namespace algorithms {
namespace {

using geometry::Points;

/// The planes of the thesis: the four ways are looked for on axes u and v, the third component is w. xy, yz, zx.
struct Plane {
  int u, v, w;
};
constexpr std::array<Plane, 3> kPlanes = {{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}};

/// A quadrant of a plane: is the component positive? A zero is not.
struct Quadrant {
  bool u, v;
};
constexpr std::array<Quadrant, 4> kQuadrants = {{{true, true}, {true, false}, {false, true}, {false, false}}};

bool on_side(bool positive, double from, double to) { return positive ? to > from : to <= from; }

/// What is known of a body's placed points.
struct Extent {
  std::array<double, 3> min, max;  // per axis, metres
  // Per plane, for the diagonals u + v and u - v: the points farthest down and up.
  std::array<std::array<std::uint32_t, 2>, 3> lowest, highest;
};

const double* column(const Points& points, int axis) {
  return axis == 0 ? points.x.data() : axis == 1 ? points.y.data() : points.z.data();
}

/// True when one of `size` vectors from (u, v) has the signs of the quadrant. No early exit within: it vectorises.
PROCESSOR_CLONES bool any_in_quadrant(bool positive_u, bool positive_v, double u, double v, const double* to_u,
                                      const double* to_v, std::size_t size) {
  std::int64_t found = 0;
  for (std::size_t j = 0; j < size; ++j)
    found |= std::int64_t{(to_u[j] > u) == positive_u} & std::int64_t{(to_v[j] > v) == positive_v};
  return found != 0;
}

PROCESSOR_CLONES bool any_short(double from, const double* to, std::size_t size, double limit) {
  std::int64_t found = 0;
  for (std::size_t j = 0; j < size; ++j) found |= std::int64_t{std::fabs(to[j] - from) < limit};
  return found != 0;
}

struct FacetVectors {
  FacetVectors(const Bodies& bodies, const Knobs& knobs)
      : max_third(value_of<double>(knobs, "max_third")), placed(bodies, sampled_points(bodies, knobs)) {
    extent.resize(bodies.size());
  }

  static Memory memory(const Bodies& bodies, const Knobs& knobs) {
    return sampled_memory(bodies, knobs, [](std::size_t) { return sizeof(Extent); });
  }

  void prepare(std::span<const Pose> poses, double) { placed.prepare(poses); }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    place(a);
    place(b);
    if (placed[a].size() == 0 || placed[b].size() == 0) return false;
    for (const Plane& plane : kPlanes)
      if (faces_all_ways(a, b, plane, count) && third_is_short(a, b, plane.w, count)) return true;
    return false;
  }

  void place(std::uint32_t body) {
    if (!placed.place(body)) return;
    const Points& points = placed[body];
    if (points.size() == 0) return;
    Extent& e = extent[body];
    for (int axis = 0; axis < 3; ++axis) {
      const double* at = column(points, axis);
      double low = at[0], high = at[0];
      for (std::size_t i = 1; i < points.size(); ++i) {
        low = at[i] < low ? at[i] : low;
        high = at[i] > high ? at[i] : high;
      }
      e.min[axis] = low;
      e.max[axis] = high;
    }
    for (std::size_t p = 0; p < kPlanes.size(); ++p) {
      const double *u = column(points, kPlanes[p].u), *v = column(points, kPlanes[p].v);
      for (const int diagonal : {0, 1}) {
        std::uint32_t lowest = 0, highest = 0;
        double low = 0, high = 0;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
          const double along = diagonal == 0 ? u[i] + v[i] : u[i] - v[i];
          if (i == 0 || along < low) low = along, lowest = i;
          if (i == 0 || along > high) high = along, highest = i;
        }
        e.lowest[p][diagonal] = lowest;
        e.highest[p][diagonal] = highest;
      }
    }
  }

  /// Do all four quadrants of the plane occur among the vectors from a to b?
  template <class Count>
  bool faces_all_ways(std::uint32_t a, std::uint32_t b, const Plane& plane, Count& count) const {
    // Each sign must occur on each axis.
    const Extent &ea = extent[a], &eb = extent[b];
    count += 1;
    for (const int axis : {plane.u, plane.v})
      if (!(eb.max[axis] > ea.min[axis]) || !(eb.min[axis] <= ea.max[axis])) return false;
    for (const Quadrant& quadrant : kQuadrants)
      if (!occurs(a, b, plane, quadrant, count)) return false;
    return true;
  }

  template <class Count>
  bool occurs(std::uint32_t a, std::uint32_t b, const Plane& plane, const Quadrant& q, Count& count) const {
    const Points &from = placed[a], &to = placed[b];
    const double *from_u = column(from, plane.u), *from_v = column(from, plane.v);
    const double *to_u = column(to, plane.u), *to_v = column(to, plane.v);

    // The likeliest vector goes between the outermost points against and along the quadrant's diagonal. Planes are
    // numbered by their first axis.
    const int diagonal = q.u == q.v ? 0 : 1;
    const Extent &ea = extent[a], &eb = extent[b];
    const std::uint32_t i0 = q.u ? ea.lowest[plane.u][diagonal] : ea.highest[plane.u][diagonal];
    const std::uint32_t j0 = q.u ? eb.highest[plane.u][diagonal] : eb.lowest[plane.u][diagonal];
    count += 1;
    if (on_side(q.u, from_u[i0], to_u[j0]) && on_side(q.v, from_v[i0], to_v[j0])) return true;

    const double end_u = q.u ? eb.max[plane.u] : eb.min[plane.u], end_v = q.v ? eb.max[plane.v] : eb.min[plane.v];
    for (std::size_t i = 0; i < from.size(); ++i) {
      count += 1;
      if (!on_side(q.u, from_u[i], end_u) || !on_side(q.v, from_v[i], end_v)) continue;
      count += to.size();
      if (any_in_quadrant(q.u, q.v, from_u[i], from_v[i], to_u, to_v, to.size())) return true;
    }
    return false;
  }

  /// Is the smallest |w| of the vectors below max_third?
  template <class Count>
  bool third_is_short(std::uint32_t a, std::uint32_t b, int w, Count& count) const {
    const Extent &ea = extent[a], &eb = extent[b];
    count += 1;
    if (eb.min[w] >= ea.max[w]) return eb.min[w] - ea.max[w] < max_third;
    if (ea.min[w] >= eb.max[w]) return ea.min[w] - eb.max[w] < max_third;
    const double *from = column(placed[a], w), *to = column(placed[b], w);
    for (std::size_t i = 0; i < placed[a].size(); ++i) {
      count += placed[b].size();
      if (any_short(from[i], to, placed[b].size(), max_third)) return true;
    }
    return false;
  }

  double max_third;  // metres
  geometry::PlacedPoints placed;
  std::vector<Extent> extent;  // per body, of its placed points
};

}  // namespace

Algorithm facet_vectors() {
  return {.name = "facet_vectors",
          .thesis_key = "P",
          .what = "vectors between facet points face all four ways in a plane and are short across it",
          .operations_unit = with_prefilter("bounds and vectors"),
          .promise = Promise::none,
          .knobs = {stride_knob(),
                    {.name = "max_third",
                     .preset = 0.5,
                     .unit = "m",
                     .what = "the component across the plane is shorter than this",
                     .least = 0,
                     .most = 1e9},
                    prefilter_knob(),
                    densify_knob()},
          .make = make_filtered<FacetVectors>,
          .memory = filtered_memory<FacetVectors>};
}

}  // namespace algorithms
