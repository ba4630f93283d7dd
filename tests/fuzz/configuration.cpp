// Any text as a configuration, what follows its first NUL as --set arguments, one a line: refused in one line, or a
// configuration whose effective text is read again as the same.
#include <string>
#include <vector>

#include "fuzz.hpp"
#include "pipeline/config.hpp"
#include "pipeline/terminal/error.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string text(fuzz::text_of(data, size));
  std::vector<std::string> sets;
  if (const std::size_t end = text.find('\0'); end != std::string::npos) {
    std::string_view rest = std::string_view(text).substr(end + 1);
    while (!rest.empty()) {
      const std::string_view line = rest.substr(0, rest.find('\n'));
      sets.emplace_back(line);
      rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    }
    text.resize(end);
  }
  std::string effective;
  try {
    effective = pipeline::parse_config(text, "a.toml", sets).effective;
  } catch (const pipeline::Error& error) {
    fuzz::require(error.code() == pipeline::kInput || (error.code() == pipeline::kUsage && !sets.empty()),
                  "what the user wrote is code 3, a --set without '=' code 2");
    fuzz::require_one_line(error.what());
    return 0;
  }
  try {
    fuzz::require(pipeline::parse_config(effective, "effective.toml").effective == effective,
                  "an effective configuration is its own");
  } catch (const pipeline::Error& error) {
    std::fprintf(stderr, "%s\n%s\n", effective.c_str(), error.what());
    fuzz::require(false, "an effective configuration can be read");
  }
  return 0;
}
