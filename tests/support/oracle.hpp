// The tests' exact answers: the product's oracle (geometry/decision/oracle.hpp), and a second one that checks it.
#pragma once
#include <CGAL/Gmpq.h>

#include <array>
#include <cstddef>

#include "geometry/decision/oracle.hpp"

namespace oracle {

using namespace geometry::brute_force;
using geometry::brute_force::triangles_meet;

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

/// Another method and another arithmetic: common points are solutions of the linear programme
///
///     sum l_i a_i = sum m_j b_j,   sum l_i = sum m_j = 1,   l, m >= 0
///
/// and the first phase of the simplex method, by Bland's rule, which always ends, finds one or none. Degenerate
/// triangles are no special case. Number is an exact field.
template <class Number>
bool triangles_meet(const geometry::Triangle& a, const geometry::Triangle& b) {
  constexpr std::size_t kRows = 5, kColumns = 6;
  std::array<std::array<Number, kColumns + 1>, kRows + 1> table;  // the last column is the right side
  for (auto& row : table) row.fill(Number(0));
  for (std::size_t i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      table[std::size_t(k)][i] = Number(a[i][k]);
      table[std::size_t(k)][3 + i] = -Number(b[i][k]);
    }
    table[3][i] = table[4][3 + i] = Number(1);
  }
  table[3][kColumns] = table[4][kColumns] = Number(1);
  // The last row is what the artificial variables, one a row, still add up to.
  for (std::size_t c = 0; c <= kColumns; ++c)
    for (std::size_t r = 0; r < kRows; ++r) table[kRows][c] += table[r][c];
  std::array<std::size_t, kRows> basis{6, 7, 8, 9, 10};

  for (;;) {
    std::size_t enter = 0;
    while (enter < kColumns && table[kRows][enter] <= 0) ++enter;
    if (enter == kColumns) return table[kRows][kColumns] == 0;
    std::size_t leave = kRows;
    for (std::size_t r = 0; r < kRows; ++r) {
      if (table[r][enter] <= 0) continue;
      if (leave == kRows) {
        leave = r;
        continue;
      }
      const Number mine = table[r][kColumns] * table[leave][enter], least = table[leave][kColumns] * table[r][enter];
      if (mine < least || (mine == least && basis[r] < basis[leave])) leave = r;
    }
    // Never kRows: a positive entry of the last row is a sum with a positive entry above it.
    const Number pivot = table[leave][enter];
    for (Number& value : table[leave]) value /= pivot;
    for (std::size_t r = 0; r <= kRows; ++r) {
      if (r == leave) continue;
      const Number factor = table[r][enter];
      if (factor == 0) continue;
      for (std::size_t c = 0; c <= kColumns; ++c) table[r][c] -= factor * table[leave][c];
    }
    basis[leave] = enter;
  }
}

}  // namespace oracle
