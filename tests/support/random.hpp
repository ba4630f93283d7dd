// Random numbers, points and triangles of the tests of geometry: the same everywhere.
#pragma once
#include <cstdint>
#include <random>

#include "geometry/decision/exact.hpp"
#include "geometry/pose.hpp"

namespace tests {

constexpr unsigned kSeed = 20220801;

struct Random {
  std::mt19937_64 bits;

  explicit Random(unsigned seed = kSeed) : bits(seed) {}

  /// Uniform in [-1, 1).
  double real() { return static_cast<double>(static_cast<std::int64_t>(bits())) * 0x1p-63; }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits() % n); }
  int integer(int from, int to) { return from + int(bits() % std::uint64_t(to - from + 1)); }
  // Braces, unlike brackets, draw from left to right.
  geometry::Vec3 point() { return {real(), real(), real()}; }
  /// Small integers: contact, coplanarity and degeneracy happen often, and exactly.
  geometry::Vec3 grid_point(int n) { return {double(integer(-n, n)), double(integer(-n, n)), double(integer(-n, n))}; }
  geometry::Quaternion turn() { return geometry::normalised({real(), real(), real(), real()}); }
  geometry::Triangle triangle() { return {point(), point(), point()}; }
  geometry::Triangle grid_triangle(int n) { return {grid_point(n), grid_point(n), grid_point(n)}; }
};

}  // namespace tests
