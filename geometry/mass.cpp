// Every facet makes a tetrahedron with a point in the middle of the vertices, its volume with the sign of the side from
// which that point sees the facet; what is outside cancels. For a tetrahedron 0 a b c of volume V, with s = a + b + c:
//
//     integral of x      =  V/4  s
//     integral of x x^T  =  V/20 (a a^T + b b^T + c c^T + s s^T)
#include "geometry/mass.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/vec.hpp"

namespace geometry {

MassProperties mass_properties(std::span<const Vec3> vertices, std::span<const Facet> facets) {
  Box box;
  for (const Facet& facet : facets)
    for (const std::uint32_t v : facet) box.add(vertices[v]);
  MassProperties out;
  if (facets.empty()) return out;
  const Vec3 middle = box.centre();
  double volume = 0, first[3] = {}, second[3][3] = {};
  for (const Facet& facet : facets) {
    const Vec3 a = vertices[facet[0]] - middle, b = vertices[facet[1]] - middle, c = vertices[facet[2]] - middle;
    const Vec3 s = (a + b) + c;
    const double v = dot(a, cross(b, c)) / 6;
    volume += v;
    for (int i = 0; i < 3; ++i) {
      first[i] += v / 4 * s[i];
      for (int j = 0; j <= i; ++j) second[i][j] += v / 20 * (((a[i] * a[j] + b[i] * b[j]) + c[i] * c[j]) + s[i] * s[j]);
    }
  }
  out.volume = volume;
  if (volume == 0) return out;
  const double to_centre[3] = {first[0] / volume, first[1] / volume, first[2] / volume};
  out.centre = middle + Vec3(to_centre[0], to_centre[1], to_centre[2]);
  const auto moment = [&](int i, int j) { return second[i][j] - first[i] * to_centre[j]; };  // about the centre, j <= i
  const double xx = moment(0, 0), yy = moment(1, 1), zz = moment(2, 2);
  out.inertia = {yy + zz, xx + zz, xx + yy, -moment(1, 0), -moment(2, 0), -moment(2, 1)};
  return out;
}

bool face_one_way(std::span<const Facet> facets) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> forth, back;
  for (const Facet& facet : facets)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = facet[k], to = facet[(k + 1) % 3];
      if (from == to) continue;
      (from < to ? forth : back).emplace_back(std::minmax({from, to}));
    }
  std::sort(forth.begin(), forth.end());
  std::sort(back.begin(), back.end());
  return forth == back;
}

}  // namespace geometry
