// Numbers and words as text: shortest, in one line, and nearest to what is known.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <random>

#include "pipeline/words.hpp"

namespace pipeline {
namespace {

TEST(Words, RealsAreShortAndRoundTrip) {
  EXPECT_EQ(real_text(60), "60.0");
  EXPECT_EQ(real_text(0.1), "0.1");
  EXPECT_EQ(real_text(1e8), "1e8");
  EXPECT_EQ(real_text(1e-5), "1e-5");
  EXPECT_EQ(real_text(-0.0), "-0.0");
  EXPECT_EQ(real_text(5e-324), "5e-324");
  EXPECT_EQ(real_text(-1.7976931348623157e308), "-1.7976931348623157e308");
  EXPECT_EQ(real_text(1e100), "1e100");
  EXPECT_EQ(real_text(1e-10), "1e-10");
  std::mt19937_64 random(7);
  for (int i = 0; i < 10000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(std::strtod(real_text(value).c_str(), nullptr), value) << "seed 7, case " << i;
  }
}

TEST(Words, OneLineHasNoControlCharacters) {
  EXPECT_EQ(one_line("a\x1b[31m\n\x7f"), "a?[31m??");
  EXPECT_EQ(one_line("á\xff\xC2"), "á??");
  EXPECT_EQ(one_line("\xC2\x9B"), "?");  // CSI in one character
  EXPECT_EQ(one_line("ááá", 2), "áá...");
  EXPECT_EQ(one_line("ááá", 3), "ááá");
}

TEST(Words, NearestForgivesOneEditInThree) {
  const std::vector<std::string> known{"steps", "seed", "rate", "RungeKuttaMerson"};
  EXPECT_EQ(nearest("step", known), "steps");
  EXPECT_EQ(nearest("setps", known), "steps");  // neighbours swapped
  EXPECT_EQ(nearest("SEED", known), "seed");
  EXPECT_EQ(nearest("runge_kutta_merson", known), "RungeKuttaMerson");
  EXPECT_EQ(nearest("", known), "");
  EXPECT_EQ(nearest("x", known), "");
  EXPECT_EQ(nearest("threshold", known), "");
  EXPECT_EQ(nearest(std::string(10000000, 'x'), known), "");
  EXPECT_EQ(nearest("steps", {}), "");
}

}  // namespace
}  // namespace pipeline
