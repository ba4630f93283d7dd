#include "algorithms/parts/simplified.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <queue>
#include <vector>

#include "geometry/decision/contain.hpp"
#include "geometry/vec.hpp"

namespace geometry {
namespace {

/// The sum of w (n . p - d)^2: p A p - 2 b . p + c. A is symmetric: xx, xy, xz, yy, yz, zz.
struct Quadric {
  std::array<double, 6> a{};
  Vec3 b = Vec3::Zero();
  double c = 0;

  void add(const Vec3& n, double d, double w) {
    const Vec3 m = w * n;
    a = {a[0] + m.x() * n.x(), a[1] + m.x() * n.y(), a[2] + m.x() * n.z(),
         a[3] + m.y() * n.y(), a[4] + m.y() * n.z(), a[5] + m.z() * n.z()};
    b += d * m;
    c += w * d * d;
  }
  void add(const Quadric& other) {
    for (std::size_t i = 0; i < 6; ++i) a[i] += other.a[i];
    b += other.b;
    c += other.c;
  }
  Vec3 times(const Vec3& p) const {
    return {dot({a[0], a[1], a[2]}, p), dot({a[1], a[3], a[4]}, p), dot({a[2], a[4], a[5]}, p)};
  }
  double at(const Vec3& p) const { return std::fmax(0, dot(p, times(p)) - 2 * dot(b, p) + c); }

  /// Where it is least, by Cramer's rule; false where planes leave that open.
  bool least(Vec3& p) const {
    const Vec3 x{a[0], a[1], a[2]}, y{a[1], a[3], a[4]}, z{a[2], a[4], a[5]};
    const Vec3 yz = cross(y, z);
    const double det = dot(x, yz), trace = a[0] + a[3] + a[5];
    if (!(det > 1e-6 * trace * trace * trace)) return false;
    p = (b.x() * yz + b.y() * cross(z, x) + b.z() * cross(x, y)) / det;
    return true;
  }
};

struct Collapse {
  double cost;
  std::uint32_t keep, go;          // the vertices, keep < go
  std::uint32_t keep_age, go_age;  // when it was thought of: a vertex that moved since makes it void
  Vec3 to;

  /// The queue's top is the cheapest; of equals the first.
  bool operator<(const Collapse& other) const {
    return cost != other.cost ? cost > other.cost : std::pair(keep, go) > std::pair(other.keep, other.go);
  }
};

class Simplifier {
 public:
  explicit Simplifier(const Mesh& mesh) : middle_(local_box(mesh).centre()) {
    const std::vector<std::uint32_t> joined = joined_by_coordinates(mesh.vertices);
    for (const Vec3& v : mesh.vertices) vertices_.push_back(v - middle_);
    for (const Facet& f : mesh.triangles) {
      const Facet g = {joined[f[0]], joined[f[1]], joined[f[2]]};
      if (g[0] != g[1] && g[1] != g[2] && g[2] != g[0]) facets_.push_back(g);
    }
    around_.resize(vertices_.size());
    quadrics_.resize(vertices_.size());
    age_.resize(vertices_.size());
    for (std::uint32_t f = 0; f < facets_.size(); ++f)
      for (const std::uint32_t v : facets_[f]) around_[v].push_back(f);
    for (const Facet& f : facets_) {
      const Vec3 n = normal(f);
      const double length = std::sqrt(dot(n, n));
      if (!(length > 0)) continue;
      const Vec3 unit = n / length;
      for (const std::uint32_t v : f) quadrics_[v].add(unit, dot(unit, vertices_[f[0]]), length);
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t p = f[k], q = f[(k + 1) % 3];
        if (shared(p, q) != 1) continue;  // no border
        const Vec3 edge = vertices_[q] - vertices_[p], across = cross(edge, unit);
        const double square = dot(across, across);
        if (!(square > 0)) continue;
        const Vec3 out = across / std::sqrt(square);
        for (const std::uint32_t v : {p, q}) quadrics_[v].add(out, dot(out, vertices_[p]), square);
      }
    }
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) think_of(v, true);
  }

  Mesh to(std::size_t wanted) {
    std::size_t left = facets_.size();
    while (left > wanted && !queue_.empty()) {
      const Collapse next = queue_.top();
      queue_.pop();
      if (age_[next.keep] != next.keep_age || age_[next.go] != next.go_age || !allowed(next)) continue;
      left -= make(next);
    }
    Mesh out;
    std::vector<std::uint32_t> place(vertices_.size(), 0);
    for (const Facet& f : facets_)
      if (f[0] != f[1])
        for (const std::uint32_t v : f) place[v] = 1;
    for (std::uint32_t v = 0; v < vertices_.size(); ++v)
      if (place[v]) {
        place[v] = static_cast<std::uint32_t>(out.vertices.size());
        out.vertices.push_back(vertices_[v] + middle_);
      }
    for (const Facet& f : facets_)
      if (f[0] != f[1]) out.triangles.push_back({place[f[0]], place[f[1]], place[f[2]]});
    return out;
  }

 private:
  Vec3 normal(const Facet& f) const {
    return cross(vertices_[f[1]] - vertices_[f[0]], vertices_[f[2]] - vertices_[f[0]]);
  }

  static bool has(const Facet& f, std::uint32_t v) { return f[0] == v || f[1] == v || f[2] == v; }

  /// The facets at both.
  std::size_t shared(std::uint32_t p, std::uint32_t q) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(around_[p], [&](std::uint32_t f) { return has(facets_[f], q); }));
  }

  std::vector<std::uint32_t> neighbours(std::uint32_t v) const {
    std::vector<std::uint32_t> out;
    for (const std::uint32_t f : around_[v])
      for (const std::uint32_t other : facets_[f])
        if (other != v) out.push_back(other);
    std::ranges::sort(out);
    const auto [same, end] = std::ranges::unique(out);
    out.erase(same, end);
    return out;
  }

  /// The collapses of the edges at a vertex; `once`: only those to vertices after it.
  void think_of(std::uint32_t v, bool once) {
    for (const std::uint32_t other : neighbours(v)) {
      if (once && other < v) continue;
      const std::uint32_t keep = std::min(v, other), go = std::max(v, other);
      Quadric both = quadrics_[keep];
      both.add(quadrics_[go]);
      const Vec3 &p = vertices_[keep], &q = vertices_[go];
      Vec3 best = 0.5 * (p + q);
      if (Vec3 there; both.least(there) && (there - best).squaredNorm() <= 4 * (p - q).squaredNorm())
        best = there;
      else
        for (const Vec3& end : {p, q})
          if (both.at(end) < both.at(best)) best = end;
      queue_.push({both.at(best), keep, go, age_[keep], age_[go], best});
    }
  }

  /// No facet is turned over, nor is the surface pinched: the two have no neighbour in common but across their facets.
  bool allowed(const Collapse& c) const {
    const std::vector<std::uint32_t> p = neighbours(c.keep), q = neighbours(c.go);
    std::vector<std::uint32_t> common;
    std::ranges::set_intersection(p, q, std::back_inserter(common));
    const std::size_t facets = shared(c.keep, c.go);
    if (common.size() != facets || facets > 2 || p.size() + q.size() < 6 + facets) return false;
    for (const std::uint32_t end : {c.keep, c.go})
      for (const std::uint32_t f : around_[end]) {
        const Facet& facet = facets_[f];
        if (has(facet, c.keep) && has(facet, c.go)) continue;
        std::array<Vec3, 3> moved;
        for (int k = 0; k < 3; ++k) moved[k] = facet[k] == end ? c.to : vertices_[facet[k]];
        const Vec3 before = normal(facet), after = cross(moved[1] - moved[0], moved[2] - moved[0]);
        const double along = dot(before, after);
        if (!(along > 0 && along * along > 0.04 * dot(before, before) * dot(after, after))) return false;
      }
    return true;
  }

  /// How many facets went.
  std::size_t make(const Collapse& c) {
    std::size_t gone = 0;
    for (const std::uint32_t f : around_[c.go]) {
      Facet& facet = facets_[f];
      if (has(facet, c.keep)) {
        for (const std::uint32_t v : facet)
          if (v != c.go) std::erase(around_[v], f);
        facet = {0, 0, 0};
        ++gone;
        continue;
      }
      for (std::uint32_t& v : facet)
        if (v == c.go) v = c.keep;
      around_[c.keep].push_back(f);
    }
    around_[c.go].clear();
    vertices_[c.keep] = c.to;
    quadrics_[c.keep].add(quadrics_[c.go]);
    ++age_[c.go];
    ++age_[c.keep];
    think_of(c.keep, false);
    return gone;
  }

  Vec3 middle_;
  std::vector<Vec3> vertices_;                      // about the middle
  std::vector<Facet> facets_;                       // gone: one vertex three times
  std::vector<std::vector<std::uint32_t>> around_;  // #vertices: facets
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> age_;  // #vertices: how often it changed
  std::priority_queue<Collapse> queue_;
};

}  // namespace

Mesh simplified(const Mesh& mesh, std::size_t facets) {
  if (mesh.triangles.size() <= facets) return mesh;
  Mesh out = Simplifier(mesh).to(facets);
  out.name = mesh.name;
  return out;
}

}  // namespace geometry
