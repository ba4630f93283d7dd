#include "pipeline/terminal/step_range.hpp"

#include <charconv>
#include <optional>
#include <utility>

#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

using Ends = std::pair<std::optional<std::uint64_t>, std::optional<std::uint64_t>>;

Ends ends_of(const std::string& text) {
  const auto bad = [&] {
    return Error(kUsage,
                 "--steps '" + text + "': must be A:B, from step A up to, not including, B; see pipeline --help");
  };
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) throw bad();
  const auto number = [&](std::size_t from, std::size_t to) -> std::optional<std::uint64_t> {
    if (from == to) return std::nullopt;
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data() + from, text.data() + to, value);
    if (error != std::errc() || end != text.data() + to) throw bad();
    return value;
  };
  return {number(0, colon), number(colon + 1, text.size())};
}

}  // namespace

void check_step_range(const std::string& text) { ends_of(text); }

StepRange step_range(const std::string& text, std::uint64_t steps, const std::string& file) {
  const Ends ends = ends_of(text);
  const StepRange range{ends.first.value_or(0), ends.second.value_or(steps)};
  if (range.first >= range.last || range.last > steps)
    throw Error(kInput, "--steps '" + text + "': " + (range.first >= range.last ? "is empty" : "goes beyond the file") +
                            "; " + file + " has the steps 0:" + std::to_string(steps));
  return range;
}

}  // namespace pipeline
