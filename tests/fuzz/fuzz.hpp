// What the fuzz targets share (libFuzzer; scripts/fuzz). A target is one .cpp with LLVMFuzzerTestOneInput, one line in
// CMakeLists.txt and a folder of tests/fuzz/corpus with an input or two of each kind.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace fuzz {

/// Ends the program where a promise does not hold: the input is then a finding.
inline void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "not kept: %s\n", promise);
  std::abort();
}

/// A user's error is one line.
inline void require_one_line(std::string_view text) {
  require(!text.empty(), "an error has a text");
  for (const char c : text) require(c != '\n' && c != '\r', "an error is one line");
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace fuzz
