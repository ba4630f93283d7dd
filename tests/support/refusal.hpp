// The user's errors that code throws, as texts to be compared.
#pragma once
#include <gtest/gtest.h>

#include <string>

#include "pipeline/terminal/error.hpp"

namespace tests {

/// The Error that `act` throws, "CODE line"; "" when it throws none.
template <class Act>
std::string coded_refusal_of(Act act) {
  try {
    act();
  } catch (const pipeline::Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return std::to_string(error.code()) + ' ' + error.what();
  }
  return "";
}

/// Its line, when it must have this code.
template <class Act>
std::string refusal_of(Act act, pipeline::ExitCode code = pipeline::kInput) {
  const std::string text = coded_refusal_of(act), start = std::to_string(code) + ' ';
  if (text.empty()) return text;
  EXPECT_TRUE(text.starts_with(start)) << text << ", not code " << code;
  return text.substr(text.find(' ') + 1);
}

}  // namespace tests
