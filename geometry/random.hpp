// Random numbers of a run, all made from its seed: the same on every machine.
//
// SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA 2014) and explicit
// conversions: the distributions of <random> differ between standard libraries. A stream belongs to one purpose, for
// instance the birth of one body, so that what is drawn depends neither on what was drawn before nor on where a run was
// resumed.
#pragma once
#include <cstdint>

#include "geometry/pose.hpp"

namespace geometry {

/// A sequence of 64-bit numbers. Integers only, all arithmetic modulo 2^64.
class Random {
 public:
  explicit Random(std::uint64_t state) : state_(state) {}

  /// Stream number `stream` of a seed: it begins at the sum of the first numbers of both.
  static Random of(std::uint64_t seed, std::uint64_t stream) {
    return Random(Random(seed).next() + Random(stream).next());
  }

  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }

  /// In [0, 1): the upper 53 bits times 2^-53, exact.
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

  /// In [-1, 1), a multiple of 2^-52, exact.
  double signed_unit() { return 2 * unit() - 1; }

  /// A rotation, all equally likely: a point of the unit ball in four dimensions, by rejection, at unit length. No
  /// function of the C library has a part in it.
  Quaternion rotation() {
    for (;;) {
      Quaternion q;
      q.w = signed_unit();
      q.x = signed_unit();
      q.y = signed_unit();
      q.z = signed_unit();
      const double square = ((q.w * q.w + q.x * q.x) + q.y * q.y) + q.z * q.z;
      // Close to the centre few directions can be told apart; a thousandth of the draws.
      if (square <= 1 && square >= 0.03) return normalised(q);
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace geometry
