// VTP files: XML whatever the labels of a result are.
#include "pipeline/commands/export.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/synthetic_result.hpp"

// Labels of ours are letters and digits; a result of another program's making may hold anything.
TEST(Export, EscapesLabels) {
  pipeline::Result result = pipeline::synthetic_result();
  result.answers.at(0).label = "a\"<b>&\x1b\nc";
  const std::string text = pipeline::vtp(result, 1);
  EXPECT_NE(text.find("Name=\"false_positive_a&quot;&lt;b&gt;&amp;??c\""), std::string::npos);
  EXPECT_NE(text.find("Name=\"false_negative_a&quot;&lt;b&gt;&amp;??c\""), std::string::npos);
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}
