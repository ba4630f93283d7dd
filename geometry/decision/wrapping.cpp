// Distances are those to a point of the proxy that was computed, hence upper bounds but for the place of that point: it
// is a combination of vertices with weights that add up to 1, off the facet by at most 16 u times the greatest
// coordinate, u = 2^-53. So
//   outside_greatest = distance (1 + 2^-50) + 2^-48 (greatest coordinate of both)                                   (1)
// is certified. Underflow is below the least normal double, which is added.
#include "geometry/decision/wrapping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/decision/contain.hpp"
#include "geometry/decision/exact.hpp"
#include "geometry/vec.hpp"

namespace geometry {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// The greatest |coordinate|.
double greatest(std::span<const Vec3> points) {
  double most = 0;
  for (const Vec3& p : points) most = std::fmax(most, p.cwiseAbs().maxCoeff());
  return most;
}

double length(const Vec3& v) { return std::hypot(v.x(), v.y(), v.z()); }  // of scaled squares: nothing overflows

/// Of distances by which vertices are outside; 0 or less: not.
template <class Outside>
Wrapping wrapping(const Mesh& mesh, Outside outside) {
  Wrapping out;
  std::size_t count = 0;
  for (const Vec3& v : mesh.vertices) {
    const double by = outside(v);
    if (!(by > 0)) continue;
    ++count;
    out.outside_greatest = std::fmax(out.outside_greatest, by);
  }
  if (count > 0) out.outside_share = double(count) / double(mesh.vertices.size());
  return out;
}

/// Of a distance from the centre or axis as computed from coordinates up to `size`: how far outside at most, or 0 when
/// rounding leaves it open.
double beyond(double distance, double radius, double size) {
  const double slack = 0x1p-50 * (distance + size) + std::numeric_limits<double>::min();
  return distance - slack > radius ? distance - radius + slack : 0;
}

/// The point of a triangle that is nearest to p, by the regions of its plane (C. Ericson, "Real-time collision
/// detection", 2005, 5.1.5). A triangle without area is asked edge by edge.
Vec3 nearest_on_edge(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 e = b - a;
  const double square = dot(e, e);
  const double t = square > 0 ? std::clamp(dot(p - a, e) / square, 0.0, 1.0) : 0;
  return a + t * e;
}

Vec3 nearest_on(const Vec3& p, const Triangle& t) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], n = cross(ab, ac), ap = p - t[0];
  const double square = dot(n, n);
  if (square > 0) {
    const double v = dot(cross(ap, ac), n) / square, w = dot(cross(ab, ap), n) / square;
    if (v >= 0 && w >= 0 && v + w <= 1) return t[0] + (v * ab + w * ac);
  }
  Vec3 best = t[0];
  double least = kFar;
  for (int k = 0; k < 3; ++k) {
    const Vec3 q = nearest_on_edge(p, t[k], t[(k + 1) % 3]), away = q - p;
    if (const double now = dot(away, away); now < least) best = q, least = now;
  }
  return best;
}

/// The distance of a point from a box, from below but for rounding.
double distance(const Vec3& p, const Box& box) {
  return length((box.min - p).cwiseMax(p - box.max).cwiseMax(Vec3::Zero()));
}

/// A solid in its own frame.
class Placed {
 public:
  Placed(const Mesh& mesh, double closed_within)
      : mesh_(mesh), bvh_(build_bvh(mesh)), boxes_(bvh_.nodes.size()), solid_(solid_of(mesh, closed_within)) {
    refit(bvh_, mesh_, mesh_.vertices, boxes_);
    if (!solid_.surface) return;
    surface_boxes_.resize(solid_.surface->bvh.nodes.size());
    refit(solid_.surface->bvh, solid_.surface->mesh, solid_.surface->mesh.vertices, surface_boxes_);
  }

  bool holds(const Vec3& p) const {
    if (on_surface(p)) return true;
    if (!solid_.closed) return false;
    if (!solid_.surface) return is_inside(p, mesh_, bvh_, mesh_.vertices, boxes_);
    const Solid::Surface& closed = *solid_.surface;
    return is_inside(p, closed.mesh, closed.bvh, closed.mesh.vertices, surface_boxes_);
  }

  /// The distance of the nearest facet, or `least` when none is nearer.
  double distance_of(const Vec3& p, double least) const {
    visit([&](const Box& box) { return distance(p, box) < least; },
          [&](const Triangle& t) {
            least = std::fmin(least, length(nearest_on(p, t) - p));
            return false;
          });
    return least;
  }

  double size() const { return greatest(mesh_.vertices); }

 private:
  bool on_surface(const Vec3& p) const {
    const Box at{p, p};
    bool on = false;
    visit([&](const Box& box) { return !on && touch(box, at); },
          [&](const Triangle& t) {
            return on = triangles_meet(t, {p, p, p});
          });
    return on;
  }

  /// The facets of nodes that are `near`, until one of them is the `last`.
  template <class Near, class Last>
  void visit(Near near, Last last) const {
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
      const std::uint32_t i = stack.back();
      stack.pop_back();
      if (!near(boxes_[i])) continue;
      const Bvh::Node& node = bvh_.nodes[i];
      if (node.count == 0) stack.insert(stack.end(), {node.second, i + 1});
      for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
        const auto& [a, b, c] = mesh_.triangles[bvh_.order[k]];
        if (last({mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]})) return;
      }
    }
  }

  const Mesh& mesh_;
  Bvh bvh_;
  std::vector<Box> boxes_, surface_boxes_;
  Solid solid_;
};

}  // namespace

Wrapping outside_balls(const Mesh& mesh, std::span<const ContactBall> balls) {
  const double size = greatest(mesh.vertices);
  return wrapping(mesh, [&](const Vec3& v) {
    double least = kFar;
    for (const ContactBall& ball : balls)
      least = std::fmin(least, beyond(length(v - ball.centre), ball.radius, size + ball.centre.cwiseAbs().maxCoeff()));
    return least;
  });
}

Wrapping outside_capsule(const Mesh& mesh, const ContactBall& from, const ContactBall& to) {
  const double size = greatest(mesh.vertices) + from.centre.cwiseAbs().maxCoeff() + to.centre.cwiseAbs().maxCoeff();
  return wrapping(mesh, [&](const Vec3& v) {
    return beyond(length(v - nearest_on_edge(v, from.centre, to.centre)), from.radius, 16 * size);
  });
}

Wrapping outside_solids(const Mesh& mesh, std::span<const Mesh> solids, double closed_within) {
  std::vector<Placed> placed;
  double size = greatest(mesh.vertices);
  placed.reserve(solids.size());
  for (const Mesh& solid : solids) {
    if (solid.triangles.empty()) continue;
    placed.emplace_back(solid, closed_within);
    size = std::fmax(size, placed.back().size());
  }
  return wrapping(mesh, [&](const Vec3& v) {
    if (std::ranges::any_of(placed, [&](const Placed& solid) { return solid.holds(v); })) return 0.0;
    double least = kFar;
    for (const Placed& solid : placed) least = solid.distance_of(v, least);
    return least * (1 + 0x1p-50) + 0x1p-48 * size + std::numeric_limits<double>::min();  // (1)
  });
}

}  // namespace geometry
