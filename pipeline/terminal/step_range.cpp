#include "pipeline/terminal/step_range.hpp"

#include <charconv>
#include <optional>
#include <utility>

#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

using Ends = std::pair<std::optional<std::uint64_t>, std::optional<std::uint64_t>>;

/// None when the text has not the form.
std::optional<Ends> ends_of(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return std::nullopt;
  const char *begin = text.data(), *middle = begin + colon, *end = begin + text.size();
  std::uint64_t a = 0, b = 0;
  const auto is_number = [](const char* from, const char* to, std::uint64_t& value) {
    const auto [stop, error] = std::from_chars(from, to, value);
    return error == std::errc() && stop == to;
  };
  const bool has_a = begin != middle, has_b = middle + 1 != end;
  if ((has_a && !is_number(begin, middle, a)) || (has_b && !is_number(middle + 1, end, b))) return std::nullopt;
  return Ends{has_a ? std::optional(a) : std::nullopt, has_b ? std::optional(b) : std::nullopt};
}

}  // namespace

std::string step_range_flaw(const std::string& text) {
  return ends_of(text) ? "" : "must be A:B, from step A up to, not including, B, not '" + text + "'";
}

StepRange step_range(const std::string& text, std::uint64_t steps, const std::string& file) {
  const auto ends = ends_of(text);
  if (!ends) throw Error(kUsage, "--steps: " + step_range_flaw(text));
  const StepRange range{ends->first.value_or(0), ends->second.value_or(steps)};
  if (range.first >= range.last || range.last > steps)
    throw Error(kInput, "--steps '" + text + "': " + (range.first >= range.last ? "is empty" : "goes beyond the file") +
                            "; " + file + " has the steps 0:" + std::to_string(steps));
  return range;
}

}  // namespace pipeline
