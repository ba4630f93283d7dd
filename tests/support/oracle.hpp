// The tests' exact answers: the product's oracle (geometry/decision/oracle.hpp), which tests/support/programming.hpp
// checks, and exact vectors.
#pragma once
#include <array>
#include <cstddef>

#include "geometry/decision/oracle.hpp"

namespace oracle {

using namespace geometry::brute_force;

/// Vectors of exact numbers, for tests that compute with them.
template <class Number>
struct Vec {
  Number x, y, z;
  bool zero() const { return x == 0 && y == 0 && z == 0; }
};
template <class N>
Vec<N> operator-(const Vec<N>& a, const Vec<N>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class N>
Vec<N> cross(const Vec<N>& a, const Vec<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class N>
N dot(const Vec<N>& a, const Vec<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class N>
std::array<Vec<N>, 3> corners(const geometry::Triangle& t) {
  std::array<Vec<N>, 3> out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = {N(t[i].x()), N(t[i].y()), N(t[i].z())};
  return out;
}

}  // namespace oracle
