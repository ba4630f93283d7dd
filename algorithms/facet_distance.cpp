// facet_distance: the smallest squared distance of two sets of facet points, against max_distance squared.
//
// The indexed search leaves out points that surely are not near the other body, and asks the same sum
// (dx dx + dy dy) + dz dz < max_distance^2 about the rest, so its answers are those of the exhaustive search bit for
// bit. A point is left out for one of two reasons:
// - On some axis it is max_distance or more outside the box of all the other points, by rounded differences. Rounding
//   is monotone: then every |dx| >= max_distance, dx dx >= max_distance^2 as computed, and adding squares cannot
//   lower the sum.
// - It is max_distance outside the ball around the other points, with a margin of 1e-9 of the ball's reach where the
//   computed distances err by 1e-15 of theirs.
#include "algorithms/facet_distance.hpp"

#include <cmath>

#include "algorithms/prefilter.hpp"
#include "geometry/facets.hpp"
#include "geometry/kernel.hpp"

namespace algorithms {
namespace {

using geometry::Ball;
using geometry::Box;
using geometry::Points;
using geometry::Vec3;

/// A body's sampled facet points in local space, metres.
Points sampled(const geometry::Mesh& mesh, double facets_per_area, bool densify) {
  const geometry::Mesh& dense = densify ? geometry::densified(mesh, facets_per_area) : mesh;
  return facet_points(
      dense, geometry::stride_of_density(dense.triangles.size(), facets_per_area, geometry::box_surface(mesh)));
}

Box bounds(const Points& points, std::size_t size) {
  Box box;
  for (std::size_t i = 0; i < size; ++i) box.add(points.at(i));
  return box;
}

/// True when one of the first `size` points is nearer to p than the root of `limit`. No early exit within the row: it
/// vectorises.
PROCESSOR_CLONES bool any_near(double px, double py, double pz, const double* x, const double* y, const double* z,
                               std::size_t size, double limit) {
  std::int64_t near = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const double dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
    near |= (dx * dx + dy * dy) + dz * dz < limit ? std::int64_t{1} : std::int64_t{0};
  }
  return near != 0;
}

struct FacetDistance {
  FacetDistance(const Bodies& bodies, const Knobs& knobs)
      : max_distance(value_of<double>(knobs, "max_distance")),
        limit(max_distance * max_distance),
        indexed(value_of<std::string>(knobs, "search") == "indexed"),
        placed(bodies, local_points(bodies, knobs)),
        box(bodies.size()),
        ball(bodies.size()) {
    near_a.resize(placed.most());
    near_b.resize(placed.most());
  }

  static std::vector<Points> local_points(const Bodies& bodies, const Knobs& knobs) {
    std::vector<Points> local;
    for (const geometry::Mesh& mesh : bodies.meshes)
      local.push_back(sampled(mesh, value_of<double>(knobs, "facets_per_area"), value_of<bool>(knobs, "densify")));
    return local;
  }

  void prepare(std::span<const Pose> poses, double) { placed.prepare(poses); }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    place(a);
    place(b);
    const Points &points_a = placed[a], &points_b = placed[b];
    if (!indexed) return near(points_a, points_a.size(), points_b, points_b.size(), count);

    if (points_a.size() == 0 || points_b.size() == 0) return false;
    const double reach = (ball[a].radius + ball[b].radius + max_distance) * (1 + 1e-9);
    count += 1;
    const Vec3 between = ball[b].centre - ball[a].centre;
    const double x = between.x(), y = between.y(), z = between.z();
    if ((x * x + y * y) + z * z >= reach * reach) return false;
    count += points_a.size();
    const std::size_t size_a = gather(points_a, box[b], ball[b], near_a);
    if (size_a == 0) return false;
    count += points_b.size();
    const std::size_t size_b = gather(points_b, bounds(near_a, size_a), ball[a], near_b);
    return near(near_a, size_a, near_b, size_b, count);
  }

  void place(std::uint32_t body) {
    if (!placed.place(body) || !indexed || placed[body].size() == 0) return;
    box[body] = bounds(placed[body], placed[body].size());
    ball[body] = ball_around(placed[body]);
  }

  /// The definition, for the first points of each set.
  template <class Count>
  bool near(const Points& a, std::size_t size_a, const Points& b, std::size_t size_b, Count& count) const {
    for (std::size_t i = 0; i < size_a; ++i) {
      count += size_b;
      if (any_near(a.x[i], a.y[i], a.z[i], b.x.data(), b.y.data(), b.z.data(), size_b, limit)) return true;
    }
    return false;
  }

  /// The points that may be near some point in the box and in the ball, to the front of `out`; how many.
  std::size_t gather(const Points& points, const Box& of, const Ball& around, Points& out) const {
    const double reach = (around.radius + max_distance) * (1 + 1e-9), reach_squared = reach * reach;
    const double m = max_distance;
    std::size_t size = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double x = points.x[i], y = points.y[i], z = points.z[i];
      const double dx = x - around.centre.x(), dy = y - around.centre.y(), dz = z - around.centre.z();
      const bool far = (of.min.x() - x >= m) | (of.max.x() - x <= -m) | (of.min.y() - y >= m) | (of.max.y() - y <= -m) |
                       (of.min.z() - z >= m) | (of.max.z() - z <= -m) |
                       ((dx * dx + dy * dy) + dz * dz >= reach_squared);
      out.x[size] = x;
      out.y[size] = y;
      out.z[size] = z;
      size += far ? 0 : 1;  // without a branch: near and far points alternate unpredictably
    }
    return size;
  }

  double max_distance, limit;  // metres, square metres
  bool indexed;
  geometry::PlacedPoints placed;
  std::vector<Box> box;  // per body, of its placed points
  std::vector<Ball> ball;
  Points near_a, near_b;  // scratch
};

}  // namespace

Algorithm facet_distance() {
  return {.name = "facet_distance",
          .thesis_key = "K",
          .what = "the nearest facet points of two bodies are nearer than a limit",
          .operations_unit = "distances",
          .promise = Promise::none,
          .knobs = {{.name = "max_distance",
                     .preset = 0.25,
                     .unit = "m",
                     .what = "a hit when two facet points are nearer than this",
                     .least = 0,
                     .most = 1e9},
                    {.name = "facets_per_area",
                     .preset = geometry::kFacetsPerArea,
                     .unit = "1/m^2",
                     .what = "facets sampled per surface of the local vertex box",
                     .least = 0,
                     .most = 1e9,
                     .valid = [](const Value& value) { return std::get<double>(value) > 0; },
                     .rule = "be greater than 0"},
                    prefilter_knob(),
                    {.name = "densify",
                     .preset = true,
                     .unit = "1",
                     .what = "cut the facets of a mesh that has fewer than facets_per_area"},
                    {.name = "search",
                     .preset = std::string("indexed"),
                     .unit = "1",
                     .what = "leave out points that surely are not near, or compare all; the answers are the same",
                     .choices = {"indexed", "exhaustive"}}},
          .make = make_filtered<FacetDistance>};
}

}  // namespace algorithms
