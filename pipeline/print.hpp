// Results as text: printf into a string, and JSON as every command prints it.
#pragma once
#include <string>

namespace pipeline {

std::string print(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// Two blanks a level and a line end. Bytes of a file name that are no UTF-8 become the replacement character.
template <class Json>
std::string dumped(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace pipeline
