// Results as text: printf into a string, and JSON as every command prints it.
#pragma once
#include <string>

#include "pipeline/terminal/words.hpp"

namespace pipeline {

std::string print(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// Two blanks a level and a line end. Bytes that are no UTF-8 become the replacement character.
template <class Json>
std::string dumped(const Json& json) {
  return with_controls_escaped(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
}

}  // namespace pipeline
