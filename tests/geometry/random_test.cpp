#include "geometry/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

using geometry::Random;

// The published test vector of SplitMix64 for the state 1234567.
TEST(Random, IsSplitMix64) {
  Random random(1234567);
  for (const std::uint64_t expected :
       {6457827717110365317u, 3203168211198807973u, 9817491932198370423u, 4593380528125082431u, 16408922859458223821u})
    EXPECT_EQ(random.next(), expected);
}

TEST(Random, StreamsAndSeedsDiffer) {
  EXPECT_EQ(Random::of(1, 2).next(), Random::of(1, 2).next());
  EXPECT_NE(Random::of(1, 2).next(), Random::of(1, 3).next());
  EXPECT_NE(Random::of(1, 2).next(), Random::of(2, 2).next());
}

TEST(Random, UnitsStayInTheirRangeAndFillIt) {
  Random random(7);
  double least = 1, most = -1, sum = 0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.signed_unit();
    ASSERT_TRUE(x >= -1 && x < 1);
    least = std::fmin(least, x);
    most = std::fmax(most, x);
    sum += x;
  }
  EXPECT_LT(least, -0.999);
  EXPECT_GT(most, 0.999);
  EXPECT_LT(std::fabs(sum / kDraws), 5 / std::sqrt(3.0 * kDraws));  // five standard deviations
}

// Of uniform rotations every direction of the body points everywhere equally: the means of the entries of R are 0, of
// their squares 1/3 (standard deviations sqrt(1/3) and sqrt(4/45) over the root of the draws).
TEST(Random, RotationsAreUniform) {
  Random random(3);
  constexpr int kDraws = 20000;
  geometry::Mat3 mean = geometry::Mat3::Zero(), mean_square = geometry::Mat3::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const geometry::Quaternion q = random.rotation();
    EXPECT_NEAR(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1, 1e-15);
    const geometry::Mat3 r = geometry::rotation(q);
    mean += r / kDraws;
    mean_square += r.cwiseProduct(r) / kDraws;
  }
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT(std::fabs(mean(i, k)), 5 * std::sqrt(1.0 / 3 / kDraws)) << i << k;
      EXPECT_LT(std::fabs(mean_square(i, k) - 1.0 / 3), 5 * std::sqrt(4.0 / 45 / kDraws)) << i << k;
    }
}
