// Results as text: printf into a string, and JSON as every command prints it.
#pragma once
#include <string>
#include <vector>

#include "pipeline/terminal/words.hpp"

namespace pipeline {

std::string print(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// Rows as aligned columns; the first is flush left, the rest flush right.
std::string aligned(const std::vector<std::vector<std::string>>& rows);

/// Nanoseconds in the unit that they need.
std::string time_text(double ns);

/// Four places; "-" for NaN.
std::string share_text(double value);

/// Two blanks a level and a line end. Bytes that are no UTF-8 become the replacement character.
template <class Json>
std::string dumped(const Json& json) {
  return with_controls_escaped(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
}

}  // namespace pipeline
