// Numbers and words as text: shortest, in one line, and nearest to what is known.
#include "pipeline/terminal/words.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>

#include "pipeline/terminal/print.hpp"

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

// U+202E turns the rest of the line around, U+200B is not seen, U+2028 ends a line, tags from U+E0000 on hide text.
TEST(Words, MarksThatTurnOrHideTextAreControls) {
  for (const char* mark : {"\u00AD", "\u061C", "\u200B", "\u200F", "\u2028", "\u202A", "\u202E", "\u2060", "\u2066",
                           "\u2069", "\uFEFF", "\U000E0041"}) {
    EXPECT_EQ(visible(std::string("a") + mark + "b\n"), "a?b\n") << mark;
    EXPECT_EQ(one_line(std::string("a") + mark + "b"), "a?b") << mark;
    const std::string json = dumped(nlohmann::json{{"title", mark}});
    EXPECT_EQ(visible(json), json) << mark;
    EXPECT_EQ(nlohmann::json::parse(json)["title"], mark);
  }
  for (const char* letter :
       {"\u00AC", "\u00AE", "\u0627", "\u2010", "\u202F", "\u2070", "\u20AC", "\uFFFD", "\U0001F600", "\U000E0100"})
    EXPECT_EQ(visible(letter), letter);
}

TEST(Words, WhatIsShownKeepsItsLinesAndNoControls) {
  EXPECT_EQ(visible("a\x1b]0;x\x07\nb\r\xC2\x9B"
                    "2J\xff\n"),
            "a?]0;x?\nb??2J?\n");
  EXPECT_EQ(visible("žluťoučký\n"), "žluťoučký\n");
}

// What JSON leaves as it is and terminals obey: DEL, and CSI in one character. The document says the same.
TEST(Words, JsonReachesATerminalWithoutControls) {
  const nlohmann::json json = {{"title",
                                "\x7F\xC2\x9B"
                                "2Já\x1b\xff"}};
  const std::string text = dumped(json);
  EXPECT_EQ(visible(text), text);
  EXPECT_EQ(nlohmann::json::parse(text)["title"],
            "\x7F\xC2\x9B"
            "2Já\x1b\xEF\xBF\xBD");
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
