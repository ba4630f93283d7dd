#include "pipeline/terminal/print.hpp"

#include <cstdarg>
#include <cstdio>

namespace pipeline {

std::string print(const char* format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string text(std::size_t(std::vsnprintf(nullptr, 0, format, arguments)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(arguments);
  return text;
}

std::string with_controls_escaped(std::string json) {
  const auto escape = [](unsigned code) { return print("\\u%04x", code); };
  for (std::size_t at = json.find_first_of("\x7F\xC2"); at != std::string::npos;
       at = json.find_first_of("\x7F\xC2", at + 1)) {
    const unsigned next = at + 1 < json.size() ? static_cast<unsigned char>(json[at + 1]) : 0xFF;
    if (json[at] == '\x7F')
      json.replace(at, 1, escape(0x7F));
    else if (next < 0xA0)  // the second byte of U+0080 to U+009F
      json.replace(at, 2, escape(next));
  }
  return json;
}

}  // namespace pipeline
