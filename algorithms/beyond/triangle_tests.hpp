// Published triangle-triangle tests in plain floating point, single or double, with their errors: parts of approximate
// algorithms, not the truth (geometry/decision/exact.hpp is). Triangles are arrays of three vectors of Eigen's.
//
// moller   T. Möller, "A fast triangle-triangle intersection test", 1997, with the tolerance of its published program:
//          a distance from the other's plane, times the length of its normal, counts as 0 below 1e-6 - an absolute
//          number, so that small triangles touch what is merely near them. Needles get what their normal gives.
// guigue_devillers  P. Guigue, O. Devillers, "Fast and robust triangle-triangle overlap test using orientation
//          predicates", 2003: signs of determinants and nothing else, here rounded ones.
//
// In one plane both project onto the coordinate plane of the greatest normal, and ask on which sides of each other's
// edges the corners lie: the papers' edges and corners tell the same in exact numbers.
#pragma once
#include <array>
#include <cmath>
#include <utility>

#include "algorithms/parts/eleven_axes.hpp"

namespace algorithms::triangle_tests {

using geometry::cross;
using geometry::dot;

template <class Vector>
using Corners = std::array<Vector, 3>;

/// Triangles in one plane whose normal (either way) is n.
template <class Vector>
bool meet_in_plane(const Vector& n, const Corners<Vector>& s, const Corners<Vector>& t) {
  using Number = typename Vector::Scalar;
  const Vector size = n.cwiseAbs();
  const int w = size.x() > size.y() && size.x() > size.z() ? 0 : size.y() > size.z() ? 1 : 2;
  const int u = (w + 1) % 3, v = (w + 2) % 3;
  const auto side = [&](const Vector& p, const Vector& q, const Vector& r) {
    return (q[u] - p[u]) * (r[v] - p[v]) - (q[v] - p[v]) * (r[u] - p[u]);
  };
  const auto parted = [&](const Corners<Vector>& one, const Corners<Vector>& other) {
    const Number turn = side(one[0], one[1], one[2]);
    for (int i = 0; i < 3; ++i) {
      const Vector &p = one[i], &q = one[(i + 1) % 3];
      bool all = true;
      for (const Vector& r : other) all = all && (turn < 0 ? side(p, q, r) > 0 : side(p, q, r) < 0);
      if (all) return true;
    }
    return false;
  };
  return !parted(s, t) && !parted(t, s);
}

template <class Number>
using Three = std::array<Number, 3>;

template <class Number>
bool one_side(const Three<Number>& d) {
  return d[0] * d[1] > 0 && d[0] * d[2] > 0;
}

/// Möller's distances of t's corners from the plane of s, not normalised.
template <class Vector>
auto moller_distances(const Vector& n, const Vector& on_plane, const Corners<Vector>& t) {
  using Number = typename Vector::Scalar;
  constexpr Number kEpsilon = Number(1e-6);
  const Number offset = -dot(n, on_plane);
  Three<Number> out;
  for (int i = 0; i < 3; ++i) {
    out[i] = dot(n, t[i]) + offset;
    if (std::fabs(out[i]) < kEpsilon) out[i] = 0;
  }
  return out;
}

/// Where the triangle cuts the line of both planes, along one coordinate; false when it lies in the other's plane.
template <class Vector, class Number>
bool moller_interval(const Corners<Vector>& s, const Three<Number>& d, int axis, Number& low, Number& high) {
  int lone;
  if (d[0] * d[1] > 0)
    lone = 2;
  else if (d[0] * d[2] > 0)
    lone = 1;
  else if (d[1] * d[2] > 0 || d[0] != 0)
    lone = 0;
  else if (d[1] != 0)
    lone = 1;
  else if (d[2] != 0)
    lone = 2;
  else
    return false;
  const int j = (lone + 1) % 3, k = (lone + 2) % 3;
  const Number at = s[lone][axis];
  low = at + (s[j][axis] - at) * d[lone] / (d[lone] - d[j]);
  high = at + (s[k][axis] - at) * d[lone] / (d[lone] - d[k]);
  if (low > high) std::swap(low, high);
  return true;
}

template <class Vector>
bool moller(const Corners<Vector>& s, const Corners<Vector>& t) {
  using Number = typename Vector::Scalar;
  const Vector n = cross(Vector(s[1] - s[0]), Vector(s[2] - s[0]));
  const Three<Number> dt = moller_distances(n, s[0], t);
  if (one_side(dt)) return false;
  const Vector m = cross(Vector(t[1] - t[0]), Vector(t[2] - t[0]));
  const Three<Number> ds = moller_distances(m, t[0], s);
  if (one_side(ds)) return false;
  const Vector line = cross(n, m).cwiseAbs();
  const int axis = line.z() > line.x() && line.z() > line.y() ? 2 : line.y() > line.x() ? 1 : 0;
  Number s_low, s_high, t_low, t_high;
  if (!moller_interval(s, ds, axis, s_low, s_high) || !moller_interval(t, dt, axis, t_low, t_high))
    return meet_in_plane(n, s, t);
  return !(s_high < t_low || t_high < s_low);
}

/// ((q - p) x (r - p)) . (x - p): on which side of the plane of p, q, r the point is.
template <class Vector>
auto side(const Vector& p, const Vector& q, const Vector& r, const Vector& x) {
  return dot(cross(Vector(q - p), Vector(r - p)), Vector(x - p));
}

/// The corner that is alone on its side of a plane, and whether that side counts as the negative one.
struct Lone {
  int corner;
  bool negative;
};
template <class Number>
Lone lone(const Three<Number>& d) {
  const int up = (d[0] > 0) + (d[1] > 0) + (d[2] > 0), down = (d[0] < 0) + (d[1] < 0) + (d[2] < 0);
  if (up == 2 || down == 2) {
    int i = 0;
    while (up == 2 ? d[i] > 0 : d[i] < 0) ++i;
    return {i, up == 2};
  }
  int i = 0;
  while (d[i] == 0) ++i;
  return {i, d[i] < 0};
}

template <class Vector>
bool guigue_devillers(const Corners<Vector>& s, const Corners<Vector>& t) {
  using Number = typename Vector::Scalar;
  const Three<Number> ds = {side(t[0], t[1], t[2], s[0]), side(t[0], t[1], t[2], s[1]), side(t[0], t[1], t[2], s[2])};
  if (one_side(ds)) return false;
  const Three<Number> dt = {side(s[0], s[1], s[2], t[0]), side(s[0], s[1], s[2], t[1]), side(s[0], s[1], s[2], t[2])};
  if (one_side(dt)) return false;
  const auto none = [](const Three<Number>& d) { return d[0] == 0 && d[1] == 0 && d[2] == 0; };
  if (none(ds) || none(dt)) return meet_in_plane(cross(Vector(s[1] - s[0]), Vector(s[2] - s[0])), s, t);
  const auto [i, s_negative] = lone(ds);
  const auto [j, t_negative] = lone(dt);
  const Vector &p = s[i], &x = t[j];
  const Vector *q = &s[(i + 1) % 3], *r = &s[(i + 2) % 3], *y = &t[(j + 1) % 3], *z = &t[(j + 2) % 3];
  if (s_negative) std::swap(y, z);
  if (t_negative) std::swap(q, r);
  return !(side(*q, x, p, *y) > 0) && !(side(p, x, *r, *z) > 0);
}

}  // namespace algorithms::triangle_tests
