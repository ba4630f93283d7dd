// The 11-axis triangle test, as published: part of approximate algorithms, not the truth (geometry/decision/exact.hpp
// is).
//
// Source: the triangle demo of three.js that the thesis (Příbyl 2022, section 4.1) adapted. Axes are the two normals
// and the nine cross products of edges. No axis lies in the plane of coplanar triangles: those are "yes", however far
// apart, for turned and rounded ones as the rounding falls. A triangle without area has no normal and is judged by the
// other axes.
//
// Answers are defined by this arithmetic in doubles (or floats): E0 = A1 - A0, E1 = A2 - A0, E2 = E1 - E0, N = E0 x E1,
// likewise F and M of the other triangle, D = B0 - A0. On an axis L the triangles project to {0, L.E0, L.E1} and {L.D,
// L.D + L.F0, L.D + L.F1}; products of an axis with an edge that it is made of (N.E, M.F, and for L = Ei x Fj L.Ei and
// L.Fj) are exactly 0. Dot products add as (x + y) + z.
#pragma once
#include "geometry/pose.hpp"
#include "geometry/vec.hpp"

namespace geometry {

/// As dot and cross of geometry/vec.hpp, in single precision.
inline float dot(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return (a.x() * b.x() + a.y() * b.y()) + a.z() * b.z();
}
inline Eigen::Vector3f cross(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

/// A triangle made ready: first corner, edges E0, E1, E2 = E1 - E0, and E0 x E1. Metres.
template <class Vector>
struct EdgedTriangleOf {
  Vector corner;
  Vector edge[3];
  Vector normal;
};
using EdgedTriangle = EdgedTriangleOf<Vec3>;

namespace eleven_axes {

/// True when {0, p, q} and {d, d + r, d + s} are strictly apart.
template <class Number>
bool apart(Number p, Number q, Number d, Number r, Number s) {
  const Number least_a = p < q ? (p < 0 ? p : 0) : (q < 0 ? q : 0);
  const Number most_a = p > q ? (p > 0 ? p : 0) : (q > 0 ? q : 0);
  const Number u = d + r, v = d + s;
  const Number least_b = u < v ? (u < d ? u : d) : (v < d ? v : d);
  const Number most_b = u > v ? (u > d ? u : d) : (v > d ? v : d);
  return (most_a < least_b) | (most_b < least_a);
}

}  // namespace eleven_axes

template <class Vector = Vec3>
EdgedTriangleOf<Vector> edged(const Vector& a, const Vector& b, const Vector& c) {
  const Vector e0 = b - a, e1 = c - a;
  return {a, {e0, e1, e1 - e0}, cross(e0, e1)};
}

/// True when no axis of the eleven separates the triangles strictly: touching is "yes".
template <class Vector>
bool meet_by_eleven_axes(const EdgedTriangleOf<Vector>& a, const EdgedTriangleOf<Vector>& b) {
  using Number = typename Vector::Scalar;
  using eleven_axes::apart;
  constexpr Number none = 0;
  const Vector d = b.corner - a.corner;
  const Vector *e = a.edge, *f = b.edge;
  if (apart(none, none, dot(a.normal, d), dot(a.normal, f[0]), dot(a.normal, f[1]))) return false;
  if (apart(dot(b.normal, e[0]), dot(b.normal, e[1]), dot(b.normal, d), none, none)) return false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vector axis = cross(e[i], f[j]);
      if (apart(i == 0 ? none : dot(axis, e[0]), i == 1 ? none : dot(axis, e[1]), dot(axis, d),
                j == 0 ? none : dot(axis, f[0]), j == 1 ? none : dot(axis, f[1])))
        return false;
    }
  return true;
}

}  // namespace geometry
