// facet_triangles: the 11-axis test on triangles between sampled, inflated facet points.
//
// Most triangles of a body are cleared at once: when a triangle's plane misses the ball around all points of the other
// body, the normal, which is one of the eleven axes, parts it from every triangle there. Only an axis of the test
// itself may clear a pair: a test of boxes or balls would deny coplanar triangles, which the published test reports
// however far apart they are. The plane must miss the ball by 1e-9 of all lengths involved, where the test's own sums
// err by some 1e-15 of them, so the test as rounded parts the pair too.
#include "algorithms/thesis/facet_triangles.hpp"

#include <cmath>
#include <vector>

#include "algorithms/contract/prefilter.hpp"
#include "algorithms/parts/eleven_axes.hpp"
#include "algorithms/parts/facet_knobs.hpp"
#include "algorithms/parts/facets.hpp"

namespace algorithms {
namespace {

using geometry::Ball;
using geometry::dot;
using geometry::EdgedTriangle;
using geometry::Points;

struct FacetTriangles {
  FacetTriangles(const Bodies& bodies, const Knobs& knobs) : placed(bodies, inflated_points(bodies, knobs)) {
    ball.resize(bodies.size());
    triangles.resize(bodies.size());
    normal_length.resize(bodies.size());
    std::size_t most = 0;
    for (std::uint32_t body = 0; body < bodies.size(); ++body) {
      first.push_back(geometry::sampled_triangles(placed[body].size(), triangulation(knobs)));
      triangles[body].resize(first[body].size());
      normal_length[body].resize(first[body].size());
      most = std::max(most, first[body].size());
    }
    near_b.reserve(most);
  }

  static Memory memory(const Bodies& bodies, const Knobs& knobs) {
    constexpr std::size_t kTriangle = sizeof(std::uint32_t) + sizeof(EdgedTriangle) + sizeof(double);
    return sampled_memory(bodies, knobs, [&](std::size_t points) {
      return sizeof(Ball) + 3 * sizeof(first) + kTriangle * geometry::triangle_count(points, triangulation(knobs));
    });
  }

  void prepare(std::span<const Pose> poses, double) { placed.prepare(poses); }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    if (first[a].empty() || first[b].empty()) return false;
    place(a);
    place(b);
    const geometry::Vec3 between = ball[b].centre - ball[a].centre;
    const double slack = 1e-9 * (std::sqrt(dot(between, between)) + 2 * (ball[a].radius + ball[b].radius));
    near_b.clear();
    count += triangles[b].size();
    for (std::uint32_t k = 0; k < triangles[b].size(); ++k)
      if (!plane_misses(b, k, ball[a], slack)) near_b.push_back(k);
    if (near_b.empty()) return false;
    for (std::uint32_t i = 0; i < triangles[a].size(); ++i) {
      count += 1;
      if (plane_misses(a, i, ball[b], slack)) continue;
      for (const std::uint32_t k : near_b) {
        count += 1;
        if (geometry::meet_by_eleven_axes(triangles[a][i], triangles[b][k])) return true;
      }
    }
    return false;
  }

  void place(std::uint32_t body) {
    if (!placed.place(body)) return;
    const Points& p = placed[body];
    ball[body] = geometry::ball_around(p);
    for (std::size_t t = 0; t < first[body].size(); ++t) {
      const std::size_t i = first[body][t];
      triangles[body][t] = geometry::edged(p.at(i), p.at(i + 1), p.at(i + 2));
      normal_length[body][t] = std::sqrt(dot(triangles[body][t].normal, triangles[body][t].normal));
    }
  }

  /// Does the plane of the body's triangle surely miss the ball? Never for a triangle without a usable normal.
  bool plane_misses(std::uint32_t body, std::size_t triangle, const Ball& other, double slack) const {
    const EdgedTriangle& t = triangles[body][triangle];
    const double length = normal_length[body][triangle];
    // Below 1e-100 the products underflow and the lengths say nothing.
    return length > 1e-100 && std::fabs(dot(t.normal, other.centre - t.corner)) > length * (other.radius + slack);
  }

  geometry::PlacedPoints placed;
  std::vector<std::vector<std::uint32_t>> first;      // per body, the first point of each triangle
  std::vector<std::vector<EdgedTriangle>> triangles;  // per body, placed
  std::vector<std::vector<double>> normal_length;     // of those
  std::vector<Ball> ball;                             // per body, around its placed points
  std::vector<std::uint32_t> near_b;                  // scratch
};

}  // namespace

Algorithm facet_triangles() {
  return {.name = "facet_triangles",
          .thesis_key = "I",
          .what = "triangles between inflated facet points pass the 11-axis test",
          .operations_unit = with_prefilter("planes and triangle pairs"),
          .promise = Promise::none,
          .knobs = {stride_knob(), inflate_knob(), triangles_knob(), prefilter_knob(), densify_knob()},
          .make = make_filtered<FacetTriangles>,
          .memory = filtered_memory<FacetTriangles>};
}

}  // namespace algorithms
