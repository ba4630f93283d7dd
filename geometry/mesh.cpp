// What a mesh tells of itself without a pose.
#include "geometry/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace geometry {
namespace {

double sum_abs(const Vec3& v) { return (std::abs(v.x()) + std::abs(v.y())) + std::abs(v.z()); }

/// A lower bound of how far the origin lies behind the plane of the triangle; 0 when it is in front, or when
/// rounding leaves it open.
///
/// With u = 2^-53, s = |e|_1 |f|_1 and k = |p|_1, of the computed n = e x f:
///   |error of a component of n| <= 6 u s                                                                         (1)
///   |error of n.p| < (6 + 4) u s k,   |error of |n|| < 11 u s                                                    (2)
///   kSlack = 2^-48 = 32 u                                                                                        (3)
/// covers both of (2) with room, and the last factor the square root, the division and the subtractions.
double distance_behind(const Vec3& p, const Vec3& q, const Vec3& r) {
  constexpr double kSlack = 0x1p-48, kLeast = 1e-250;  // (3); below kLeast products may have underflowed
  const Vec3 e = q - p, f = r - p;
  const Vec3 n(e.y() * f.z() - e.z() * f.y(), e.z() * f.x() - e.x() * f.z(), e.x() * f.y() - e.y() * f.x());
  const double s = sum_abs(e) * sum_abs(f);
  const double numerator = ((n.x() * p.x() + n.y() * p.y()) + n.z() * p.z()) - kSlack * s * sum_abs(p);
  const double square = (n.x() * n.x() + n.y() * n.y()) + n.z() * n.z();
  if (!(numerator > kLeast && square > kLeast)) return 0;
  return numerator / (std::sqrt(square) + kSlack * s) * (1 - 0x1p-48);
}

}  // namespace

Box local_box(const Mesh& mesh) { return bounds(mesh.vertices); }

Vec3 half_extents(const Mesh& mesh) {
  Vec3 half = Vec3::Zero();
  for (const Vec3& v : mesh.vertices) half = half.cwiseMax(v.cwiseAbs());
  return half;
}

bool is_closed(const Mesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Facet& facet : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t from = facet[i], to = facet[(i + 1) % 3];
      if (from == to) return false;
      edges.emplace_back(from, to);
    }
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  return !edges.empty() && std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    return std::binary_search(edges.begin(), edges.end(), std::pair(edge.second, edge.first));
  });
}

double inscribed_radius(const Mesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles)
    least = std::min(least, distance_behind(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
  return least;
}

}  // namespace geometry
