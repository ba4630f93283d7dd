#include "algorithms/beyond/facet_gjk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "algorithms/contract/prefilter.hpp"
#include "algorithms/parts/balls_and_boxes.hpp"
#include "algorithms/parts/convex.hpp"
#include "algorithms/parts/facet_knobs.hpp"
#include "geometry/decision/hull.hpp"
#include "geometry/vec.hpp"

namespace algorithms {
namespace {

using geometry::Convex;
using geometry::Mesh;
using geometry::PlacedConvex;
using geometry::Vec3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kLeastPoints = 16, kMostPoints = 64;  // of a piece
constexpr std::size_t kLeastFacets = 32;                    // of a piece that is cut
constexpr int kMostCuts = 3;
constexpr double kHollow = 0.1;  // of half a piece's longest side: facets that lie deeper are in a hollow

/// The planes of a hull's facets.
struct Planes {
  std::vector<Vec3> on, normal;  // of each a point, and the unit vector outwards
  int dimension = -1;            // of the hull

  explicit Planes(std::span<const Vec3> points) {
    const geometry::Hull hull = geometry::convex_hull(points);
    dimension = hull.dimension;
    for (const auto& [i, j, k] : hull.triangles) {
      const Vec3 &p = points[hull.corners[i]], &q = points[hull.corners[j]], &r = points[hull.corners[k]];
      const Vec3 n = geometry::cross(q - p, r - p);
      const double length = std::sqrt(geometry::dot(n, n));
      if (!(length > 0)) continue;
      on.push_back(p);
      normal.push_back(n / length);
    }
  }

  /// How far a point is in front of the plane that it is farthest in front of, m; negative behind all.
  double in_front(const Vec3& point) const {
    double most = -kInfinity;
    for (std::size_t i = 0; i < on.size(); ++i) most = std::fmax(most, geometry::dot(normal[i], point - on[i]));
    return most;
  }
};

/// Corners of a hull that stand for all.
struct Sample {
  std::vector<Vec3> points;
  double distance = 0;  // m: how far what was not taken sticks out
};

/// As many corners as wanted, those that stick out most, one after the other. Of flat hulls all.
Sample sampled(std::span<const Vec3> points, std::size_t wanted) {
  const geometry::Hull hull = geometry::convex_hull(points);
  std::vector<Vec3> corners;
  for (const std::uint32_t i : hull.corners) corners.push_back(points[i]);
  if (hull.dimension < 3 || corners.size() <= wanted) return {corners};
  Sample out;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0})
      out.points.push_back(*std::ranges::max_element(corners, {}, [&](const Vec3& v) { return sign * v[axis]; }));
  // A corner sticks out less and less: what was found for it earlier need only be found anew while it is the most.
  std::vector<double> off(corners.size(), kInfinity);
  for (bool solid = false;;) {
    const Planes planes(out.points);
    if (planes.dimension == 3 && !solid) {
      solid = true;
      std::ranges::fill(off, kInfinity);
    }
    const auto anew = [&](const Vec3& v) {
      if (solid) return planes.in_front(v);
      double nearest = kInfinity;
      for (const Vec3& one : out.points) nearest = std::fmin(nearest, (v - one).squaredNorm());
      return nearest;
    };
    std::size_t farthest = 0;
    for (std::size_t asked = corners.size(); asked != farthest;) {
      asked = farthest = std::size_t(std::ranges::max_element(off) - off.begin());
      off[asked] = anew(corners[asked]);
      farthest = std::size_t(std::ranges::max_element(off) - off.begin());
    }
    if (solid) out.distance = std::fmax(0, off[farthest]);
    if (out.points.size() >= wanted || !(off[farthest] > 0)) return out;
    out.points.push_back(corners[farthest]);
  }
}

struct Piece {
  Convex solid;
  double distance = 0;  // as of its sample
};

/// The pieces of a mesh.
class Cutting {
 public:
  Cutting(const Mesh& mesh, std::size_t stride) : mesh_(mesh), stride_(stride) {
    std::vector<std::uint32_t> facets(mesh.triangles.size());
    std::iota(facets.begin(), facets.end(), 0u);
    for (const geometry::Facet& f : mesh.triangles) points_.push_back(geometry::facet_point(mesh, f));
    cut(facets, kMostCuts);
  }

  std::vector<Piece> pieces;

 private:
  void cut(std::span<std::uint32_t> facets, int cuts) {
    std::vector<Vec3> corners;
    for (const std::uint32_t f : facets)
      for (const std::uint32_t v : mesh_.triangles[f]) corners.push_back(mesh_.vertices[v]);
    const Sample sample = sampled(corners, std::clamp(facets.size() / stride_, kLeastPoints, kMostPoints));
    if (cuts == 0 || facets.size() < kLeastFacets || !is_hollow(sample, facets)) {
      pieces.push_back({geometry::convex_of(sample.points), sample.distance});
      return;
    }
    geometry::Box box;
    for (const std::uint32_t f : facets) box.add(points_[f]);
    int axis = 0;
    (box.max - box.min).maxCoeff(&axis);
    std::ranges::sort(facets, [&](std::uint32_t f, std::uint32_t g) {
      return points_[f][axis] != points_[g][axis] ? points_[f][axis] < points_[g][axis] : f < g;
    });
    cut(facets.first(facets.size() / 2), cuts - 1);
    cut(facets.subspan(facets.size() / 2), cuts - 1);
  }

  bool is_hollow(const Sample& sample, std::span<const std::uint32_t> facets) const {
    const Planes planes(sample.points);
    if (planes.dimension < 3) return false;
    const double deep = kHollow * geometry::bounds(sample.points).half_size().maxCoeff();
    return std::ranges::any_of(facets, [&](std::uint32_t f) { return planes.in_front(points_[f]) < -deep; });
  }

  const Mesh& mesh_;
  std::size_t stride_;
  std::vector<Vec3> points_;  // #facets
};

std::size_t stride_of(const Knobs& knobs) { return static_cast<std::size_t>(value_of<std::int64_t>(knobs, "stride")); }

struct FacetGjk {
  FacetGjk(const Bodies& bodies, const Knobs& knobs)
      : mesh(bodies.mesh), placed(bodies.size()), is(bodies.size()), alone(is_alone(knobs)) {
    for (const Mesh& one : bodies.meshes) {
      pieces.push_back(Cutting(one, stride_of(knobs)).pieces);
      double most = 0;
      Mesh corners;
      for (const Piece& piece : pieces.back()) {
        most = std::fmax(most, piece.distance);
        const std::vector<Vec3>& of_piece = piece.solid.surface.vertices;
        corners.vertices.insert(corners.vertices.end(), of_piece.begin(), of_piece.end());
      }
      reach.push_back(value_of<double>(knobs, "reach") * most);
      around.push_back(geometry::enclosure(corners));
    }
    if (alone) rejecting.resize(bodies.size());
    for (std::size_t body = 0; body < bodies.size(); ++body) placed[body].resize(pieces[mesh[body]].size());
  }

  static bool is_alone(const Knobs& knobs) { return value_of<std::string>(knobs, "prefilter") == "none"; }

  /// As if all bodies were convex: whether they are is not known from sizes, and pieces are small.
  static Memory memory(const Bodies& bodies, const Knobs& knobs) {
    const std::size_t stride = stride_of(knobs);
    Memory out =
        memory_by_body(bodies, sizeof(std::uint32_t) + sizeof(std::vector<PlacedConvex>) + sizeof(PlacedConvex) + 1 +
                                   (is_alone(knobs) ? geometry::BallsAndBoxes::kBytes : 0));
    for (const Mesh& one : bodies.meshes) {
      const std::size_t facets = one.triangles.size(), corners = one.vertices.size();
      const std::size_t making = facets * (sizeof(std::uint32_t) + 4 * sizeof(Vec3));
      out.greatest = std::max(out.greatest, out.held + making + geometry::convex_making_bytes(corners));
      out.held += sizeof(std::vector<Piece>) + sizeof(double) + sizeof(geometry::Enclosure) +
                  geometry::convex_bytes(std::min(corners, std::clamp(facets / stride, kLeastPoints, kMostPoints)));
    }
    out.greatest = std::max(out.greatest, out.held);
    return out;
  }

  void prepare(std::span<const Pose> now, double) {
    poses = now;
    std::fill(is.begin(), is.end(), std::uint8_t{0});
    if (!alone) return;
    for (std::size_t body = 0; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;
      const geometry::Enclosure& all = around[mesh[body]];
      const geometry::Placement at = geometry::placement(all, poses[body]);
      // As of the pieces, whose balls and boxes these hold with their margins.
      const double more = reach[mesh[body]] + 0x1p-44 * (all.reach + at.length);
      geometry::Box box = geometry::world_box(all, at);
      box.min.array() -= more;
      box.max.array() += more;
      rejecting.set(body, at.middle, all.radius + more, box);
    }
  }

  std::vector<PlacedConvex>& place(std::uint32_t body) {
    if (!is[body])
      for (std::size_t i = 0; i < placed[body].size(); ++i) {
        placed[body][i] = geometry::placed(pieces[mesh[body]][i].solid, poses[body]);
        placed[body][i].margin += reach[mesh[body]];
      }
    is[body] = 1;
    return placed[body];
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    if (alone && !rejecting.touch(a, b, count)) return false;
    std::uint64_t corners = 0;
    const bool met = meet(place(a), place(b), corners);
    count += corners;
    return met;
  }

  /// Asked only when no filter is in front.
  void row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* out) {
    rejecting.touch_row(a, first, last, out);
    std::uint64_t corners = 0;
    for (std::uint32_t b = first; b < last; ++b)
      if (out[b - first]) out[b - first] = meet(place(a), place(b), corners);
  }

  /// Of several pieces those first that are near the others' box.
  bool meet(const std::vector<PlacedConvex>& p, const std::vector<PlacedConvex>& q, std::uint64_t& operations) {
    if (p.size() == 1 && q.size() == 1) return geometry::convex_meet(p[0], q[0], operations);
    const auto near = [&](const std::vector<PlacedConvex>& from, const std::vector<PlacedConvex>& to,
                          std::vector<const PlacedConvex*>& out) {
      geometry::Box box;
      for (const PlacedConvex& one : to) {
        const Vec3 r = Vec3::Constant(one.solid->around.radius + one.margin);
        box.add(geometry::Box{one.at.middle - r, one.at.middle + r});
      }
      out.clear();
      for (const PlacedConvex& one : from) {
        const double r = one.solid->around.radius + one.margin;
        const Vec3 off = (box.min - one.at.middle).cwiseMax(one.at.middle - box.max);
        if (off.maxCoeff() <= r) out.push_back(&one);
      }
    };
    near(p, q, near_a);
    near(q, p, near_b);
    operations += p.size() + q.size();
    for (const PlacedConvex* one : near_a)
      for (const PlacedConvex* other : near_b)
        if (geometry::convex_meet(*one, *other, operations)) return true;
    return false;
  }

  std::vector<std::uint32_t> mesh;                // per body
  std::vector<std::vector<Piece>> pieces;         // per distinct mesh
  std::vector<double> reach;                      // likewise, m
  std::vector<geometry::Enclosure> around;        // likewise, of all pieces
  std::span<const Pose> poses;                    // of the step
  std::vector<std::vector<PlacedConvex>> placed;  // per body, its pieces, when `is` has 1
  std::vector<std::uint8_t> is;
  std::vector<const PlacedConvex*> near_a, near_b;
  bool alone;                         // no filter is in front
  geometry::BallsAndBoxes rejecting;  // of the step, when alone
};

/// The pieces without the reach.
std::vector<Proxy> proxies(const Bodies& bodies, const Knobs& knobs) {
  std::vector<Proxy> out;
  for (const Mesh& mesh : bodies.meshes) {
    Proxy& proxy = out.emplace_back(Proxy{.kind = Proxy::Kind::solids, .balls = {}, .solids = {}});
    for (Piece& piece : Cutting(mesh, stride_of(knobs)).pieces)
      proxy.solids.push_back(geometry::surface_with_facets(std::move(piece.solid)));
  }
  return out;
}

}  // namespace

Algorithm facet_gjk() {
  return {.name = "facet_gjk",
          .what = "hulls of sampled facet points are nearer than the sampling distance (GJK), piece by piece",
          .operations_unit = with_prefilter("balls and corners"),
          .promise = Promise::none,
          .knobs = {stride_knob(),
                    {.name = "reach",
                     .preset = 0.5,
                     .unit = "1",
                     .what = "times the sampling distance of the mesh: from where on points count as touching",
                     .least = 0,
                     .most = 1e3},
                    prefilter_knob()},
          .make = make_filtered<FacetGjk>,
          .memory = filtered_memory<FacetGjk>,
          .proxies = proxies};
}

}  // namespace algorithms
