// Quickhull (C. Barber, D. Dobkin, H. Huhdanpaa, "The quickhull algorithm for convex hulls", 1996) by exact
// orientations; which point comes next is a guess in doubles.
//
// A facet sees a point that is strictly in front of its plane. Points in the plane count as not seen, and the facets
// seen are yet one disc: those of a plane are seen together. A new facet joins the point to an edge between a facet
// that is seen and one that is not. It has area, as the point is strictly in front of the one, and its plane lies
// between the two: what was in front of a facet that went and is still outside is in front of a new one. So points need
// to be asked about new facets alone.
#include "geometry/decision/hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "geometry/decision/exact.hpp"
#include "geometry/vec.hpp"

namespace geometry {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

bool before(const Vec3& p, const Vec3& q) {
  return p.x() != q.x() ? p.x() < q.x() : p.y() != q.y() ? p.y() < q.y() : p.z() < q.z();
}

class Builder {
 public:
  explicit Builder(std::span<const Vec3> points) : points_(points) {}

  Hull build() {
    if (points_.empty()) return {};
    std::vector<std::uint32_t> all(points_.size());
    std::iota(all.begin(), all.end(), 0u);
    const auto by_place = [&](std::uint32_t i, std::uint32_t j) { return before(at(i), at(j)); };
    const std::uint32_t first = *std::ranges::min_element(all, by_place),
                        last = *std::ranges::max_element(all, by_place);
    if (at(first) == at(last)) return hull({first}, {}, 0);
    const std::uint32_t third = off_line(first, last);
    if (third == kNone) return hull({first, last}, {}, 1);
    const std::uint32_t fourth = off_plane(first, last, third);
    if (fourth == kNone) return flat(first, last, third);
    return solid({first, last, third, fourth});
  }

 private:
  struct Face {
    Facet corner;                         // indices of points
    std::array<std::uint32_t, 3> beside;  // the face across the edge from corner i to the next
    std::vector<std::uint32_t> outside;   // points in front, each kept by one face that sees it
    bool gone = false;
  };

  const Vec3& at(std::uint32_t i) const { return points_[i]; }

  bool sees(const Face& face, std::uint32_t p) const {
    return orientation(at(face.corner[0]), at(face.corner[1]), at(face.corner[2]), at(p)) > 0;
  }

  /// The point that is off the line by most, as far as doubles tell; kNone when all are on it.
  std::uint32_t off_line(std::uint32_t p, std::uint32_t q) const {
    std::uint32_t best = kNone;
    double most = -1;
    const Vec3 along = at(q) - at(p);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const Vec3 n = cross(along, at(i) - at(p));
      const double off = std::fabs(n.x()) + std::fabs(n.y()) + std::fabs(n.z());
      if ((best == kNone || off > most) && !is_degenerate({at(p), at(q), at(i)})) best = i, most = off;
    }
    return best;
  }

  /// Likewise of the plane.
  std::uint32_t off_plane(std::uint32_t p, std::uint32_t q, std::uint32_t r) const {
    std::uint32_t best = kNone;
    double most = -1;
    const Vec3 normal = cross(at(q) - at(p), at(r) - at(p));
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const double off = std::fabs(dot(normal, at(i) - at(p)));
      if ((best == kNone || off > most) && orientation(at(p), at(q), at(r), at(i)) != 0) best = i, most = off;
    }
    return best;
  }

  /// Points of a plane: the lower and the upper chain by place (A. Andrew, 1979), turns seen from a point off the
  /// plane.
  Hull flat(std::uint32_t p, std::uint32_t q, std::uint32_t r) const {
    // One of the axes leaves the plane, and half the greatest coordinate towards the origin is a step that shows.
    std::array<Vec3, 3> apexes{at(p), at(p), at(p)};
    const double size = 0.5 * std::fmax(at(p).cwiseAbs().maxCoeff(), at(q).cwiseAbs().maxCoeff());
    for (int axis = 0; axis < 3; ++axis) apexes[axis][axis] += at(p)[axis] > 0 ? -size : size;
    const Vec3& apex =
        *std::ranges::find_if(apexes, [&](const Vec3& one) { return orientation(at(p), at(q), at(r), one) != 0; });
    std::vector<std::uint32_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(
        order, [&](std::uint32_t i, std::uint32_t j) { return before(at(i), at(j)) || (at(i) == at(j) && i < j); });
    const auto [same, end] =
        std::ranges::unique(order, [&](std::uint32_t i, std::uint32_t j) { return at(i) == at(j); });
    order.erase(same, end);
    std::vector<std::uint32_t> chain;
    for (int half = 0; half < 2; ++half) {
      const std::size_t from = chain.size();
      for (const std::uint32_t i : order) {
        while (chain.size() >= from + 2 && orientation(at(chain.end()[-2]), at(chain.back()), at(i), apex) >= 0)
          chain.pop_back();
        chain.push_back(i);
      }
      chain.pop_back();  // the other chain begins with it
      std::ranges::reverse(order);
    }
    std::vector<Facet> triangles;
    for (std::size_t i = 1; i + 1 < chain.size(); ++i) {
      triangles.push_back({chain[0], chain[i], chain[i + 1]});
      triangles.push_back({chain[0], chain[i + 1], chain[i]});
    }
    return hull(chain, triangles, 2);
  }

  Hull solid(std::array<std::uint32_t, 4> corner) {
    if (orientation(at(corner[0]), at(corner[1]), at(corner[2]), at(corner[3])) > 0) std::swap(corner[0], corner[1]);
    const auto& [a, b, c, d] = corner;  // d is behind a, b, c
    faces_ = {
        {{a, b, c}, {1, 2, 3}, {}}, {{b, a, d}, {0, 3, 2}, {}}, {{c, b, d}, {0, 1, 3}, {}}, {{a, c, d}, {0, 2, 1}, {}}};
    for (std::uint32_t p = 0; p < points_.size(); ++p) give(p, 0, 4);
    for (std::uint32_t face = 0; face < faces_.size(); ++face)
      if (!faces_[face].gone && !faces_[face].outside.empty()) reach(face);
    std::vector<Facet> triangles;
    std::vector<std::uint32_t> corners;
    for (const Face& face : faces_) {
      if (face.gone) continue;
      triangles.push_back(face.corner);
      corners.insert(corners.end(), face.corner.begin(), face.corner.end());
    }
    return hull(std::move(corners), triangles, 3);
  }

  /// Gives the point to the first of these faces that sees it.
  void give(std::uint32_t p, std::size_t first, std::size_t last) {
    for (std::size_t face = first; face < last; ++face)
      if (sees(faces_[face], p)) {
        faces_[face].outside.push_back(p);
        return;
      }
  }

  /// Makes the farthest point of the face a corner.
  void reach(std::uint32_t face) {
    const Facet& f = faces_[face].corner;
    const Vec3 normal = cross(at(f[1]) - at(f[0]), at(f[2]) - at(f[0]));
    std::uint32_t top = faces_[face].outside[0];
    for (const std::uint32_t p : faces_[face].outside)
      if (dot(normal, at(p) - at(f[0])) > dot(normal, at(top) - at(f[0]))) top = p;

    // The faces that see it, and around them the edges to those that do not, in order.
    gone_.assign(1, face);
    faces_[face].gone = true;
    const auto first_new = static_cast<std::uint32_t>(faces_.size());
    struct Step {
      std::uint32_t face;
      int edge, left;  // where to go on, and how many edges are left
    };
    std::vector<Step> path = {{face, 0, 3}};
    while (!path.empty()) {
      Step& step = path.back();
      if (step.left == 0) {
        path.pop_back();
        continue;
      }
      const std::uint32_t from = step.face, over = faces_[from].beside[step.edge];
      const int edge = step.edge;
      step.edge = (step.edge + 1) % 3;
      --step.left;
      if (faces_[over].gone) continue;
      const int back = edge_to(faces_[over], faces_[from].corner[(edge + 1) % 3], faces_[from].corner[edge]);
      if (sees(faces_[over], top)) {
        faces_[over].gone = true;
        gone_.push_back(over);
        path.push_back({over, (back + 1) % 3, 2});
        continue;
      }
      const auto made = static_cast<std::uint32_t>(faces_.size());
      faces_[over].beside[back] = made;
      const std::uint32_t p = faces_[from].corner[edge], q = faces_[from].corner[(edge + 1) % 3];
      faces_.push_back({{p, q, top}, {over, made + 1, made - 1}, {}});
    }
    faces_[first_new].beside[2] = static_cast<std::uint32_t>(faces_.size()) - 1;
    faces_.back().beside[1] = first_new;

    const std::size_t last_new = faces_.size();
    for (const std::uint32_t old : gone_) {
      const std::vector<std::uint32_t> left = std::move(faces_[old].outside);
      faces_[old].outside = {};
      for (const std::uint32_t p : left) give(p, first_new, last_new);
    }
  }

  /// Which edge of the face runs from p to q.
  static int edge_to(const Face& face, std::uint32_t p, std::uint32_t q) {
    int edge = 0;
    while (!(face.corner[edge] == p && face.corner[(edge + 1) % 3] == q)) ++edge;
    return edge;
  }

  static Hull hull(std::vector<std::uint32_t> corners, std::span<const Facet> triangles, int dimension) {
    std::ranges::sort(corners);
    const auto [same, end] = std::ranges::unique(corners);
    corners.erase(same, end);
    Hull out{std::move(corners), {}, dimension};
    const auto place = [&](std::uint32_t p) {
      return static_cast<std::uint32_t>(std::ranges::lower_bound(out.corners, p) - out.corners.begin());
    };
    for (const auto& [a, b, c] : triangles) out.triangles.push_back({place(a), place(b), place(c)});
    return out;
  }

  std::span<const Vec3> points_;
  std::vector<Face> faces_;          // those that are gone too
  std::vector<std::uint32_t> gone_;  // by the point at hand
};

}  // namespace

Hull convex_hull(std::span<const Vec3> points) { return Builder(points).build(); }

}  // namespace geometry
