// Whether two hulls, or two triangles, share a point, by linear programming in exact numbers: another method and
// another arithmetic than the project's own.
#pragma once
#include <CGAL/Gmpq.h>

#include <span>
#include <vector>

#include "geometry/pose.hpp"

namespace programming {

/// Common points are solutions of
///
///     sum l_i a_i = sum m_j b_j,   sum l_i = sum m_j = 1,   l, m >= 0
///
/// and the first phase of the simplex method, by Bland's rule, which always ends, finds one or none.
/// Degenerate hulls are no special case.
inline bool hulls_meet(std::span<const geometry::Vec3> a, std::span<const geometry::Vec3> b) {
  using Number = CGAL::Gmpq;
  constexpr std::size_t kRows = 5;
  const std::size_t columns = a.size() + b.size();
  std::vector<std::vector<Number>> table(kRows + 1, std::vector<Number>(columns + 1, Number(0)));
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int k = 0; k < 3; ++k) table[std::size_t(k)][i] = Number(a[i][k]);
    table[3][i] = 1;
  }
  for (std::size_t j = 0; j < b.size(); ++j) {
    for (int k = 0; k < 3; ++k) table[std::size_t(k)][a.size() + j] = -Number(b[j][k]);
    table[4][a.size() + j] = 1;
  }
  table[3][columns] = table[4][columns] = 1;  // the right side
  // The last row is what the artificial variables, one a row, still add up to.
  for (std::size_t c = 0; c <= columns; ++c)
    for (std::size_t r = 0; r < kRows; ++r) table[kRows][c] += table[r][c];
  std::vector<std::size_t> basis;
  for (std::size_t r = 0; r < kRows; ++r) basis.push_back(columns + r);
  for (;;) {
    std::size_t enter = 0;
    while (enter < columns && table[kRows][enter] <= 0) ++enter;
    if (enter == columns) return table[kRows][columns] == 0;
    std::size_t leave = kRows;
    for (std::size_t r = 0; r < kRows; ++r) {
      if (table[r][enter] <= 0) continue;
      if (leave == kRows) {
        leave = r;
        continue;
      }
      const Number mine = table[r][columns] * table[leave][enter], least = table[leave][columns] * table[r][enter];
      if (mine < least || (mine == least && basis[r] < basis[leave])) leave = r;
    }
    // Never kRows: a positive entry of the last row is a sum with a positive entry above it.
    const Number pivot = table[leave][enter];
    for (Number& value : table[leave]) value /= pivot;
    for (std::size_t r = 0; r <= kRows; ++r) {
      if (r == leave || table[r][enter] == 0) continue;
      const Number factor = table[r][enter];
      for (std::size_t c = 0; c <= columns; ++c) table[r][c] -= factor * table[leave][c];
    }
    basis[leave] = enter;
  }
}

}  // namespace programming
