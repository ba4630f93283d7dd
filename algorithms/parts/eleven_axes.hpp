// The 11-axis triangle test, as published: part of approximate algorithms, not the truth (geometry/decision/exact.hpp
// is).
//
// Source: the triangle demo of three.js that the thesis (Příbyl 2022, section 4.1) adapted. Axes are the two normals
// and the nine cross products of edges. No axis lies in the plane of coplanar triangles: those are "yes", however far
// apart, for turned and rounded ones as the rounding falls. A triangle without area has no normal and is judged by the
// other axes.
//
// Answers are defined by this arithmetic in doubles: E0 = A1 - A0, E1 = A2 - A0, E2 = E1 - E0, N = E0 x E1, likewise F
// and M of the other triangle, D = B0 - A0. On an axis L the triangles project to {0, L.E0, L.E1} and
// {L.D, L.D + L.F0, L.D + L.F1}; products of an axis with an edge that it is made of (N.E, M.F, and for L = Ei x Fj
// L.Ei and L.Fj) are exactly 0. Dot products add as (x + y) + z.
#pragma once
#include "geometry/pose.hpp"
#include "geometry/vec.hpp"

namespace geometry {

/// A triangle made ready: first corner, edges E0, E1, E2 = E1 - E0, and E0 x E1. Metres.
struct EdgedTriangle {
  Vec3 corner;
  Vec3 edge[3];
  Vec3 normal;
};

namespace eleven_axes {

/// True when {0, p, q} and {d, d + r, d + s} are strictly apart.
inline bool apart(double p, double q, double d, double r, double s) {
  const double least_a = p < q ? (p < 0 ? p : 0) : (q < 0 ? q : 0);
  const double most_a = p > q ? (p > 0 ? p : 0) : (q > 0 ? q : 0);
  const double u = d + r, v = d + s;
  const double least_b = u < v ? (u < d ? u : d) : (v < d ? v : d);
  const double most_b = u > v ? (u > d ? u : d) : (v > d ? v : d);
  return (most_a < least_b) | (most_b < least_a);
}

}  // namespace eleven_axes

inline EdgedTriangle edged(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 e0 = b - a, e1 = c - a;
  return {a, {e0, e1, e1 - e0}, cross(e0, e1)};
}

/// True when no axis of the eleven separates the triangles strictly: touching is "yes".
inline bool meet_by_eleven_axes(const EdgedTriangle& a, const EdgedTriangle& b) {
  using namespace eleven_axes;
  const Vec3 d = b.corner - a.corner;
  const Vec3 *e = a.edge, *f = b.edge;
  if (apart(0, 0, dot(a.normal, d), dot(a.normal, f[0]), dot(a.normal, f[1]))) return false;
  if (apart(dot(b.normal, e[0]), dot(b.normal, e[1]), dot(b.normal, d), 0, 0)) return false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vec3 axis = cross(e[i], f[j]);
      if (apart(i == 0 ? 0 : dot(axis, e[0]), i == 1 ? 0 : dot(axis, e[1]), dot(axis, d), j == 0 ? 0 : dot(axis, f[0]),
                j == 1 ? 0 : dot(axis, f[1])))
        return false;
    }
  return true;
}

}  // namespace geometry
