// Text as other people's programs write it: line ends of every kind, numbers of every size.
#pragma once
#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>

namespace geometry {

/// Takes the first line off `rest` and gives it without its end: LF, CR LF, or CR alone. With `lone_cr` an LF behind a
/// CR begins the next line.
inline std::string_view take_line(std::string_view& rest, bool lone_cr = false) {
  const auto ends = [](char c) { return c == '\n' || c == '\r'; };
  const std::size_t end = std::size_t(std::find_if(rest.begin(), rest.end(), ends) - rest.begin());
  const std::string_view line = rest.substr(0, end);
  const bool two = !lone_cr && rest.substr(end).starts_with("\r\n");
  rest.remove_prefix(std::min(end + (two ? 2 : 1), rest.size()));
  return line;
}

/// std::from_chars that also takes a plus sign, and gives the nearest double of what no double holds: 0 or an infinity.
inline std::from_chars_result nearest_double(const char* first, const char* last, double& value) {
  const bool plus = last - first > 1 && *first == '+' && first[1] != '-';
  const char* digits = plus ? first + 1 : first;
  auto result = std::from_chars(digits, last, value);
  if (result.ec != std::errc::result_out_of_range) return result;
  const std::string_view text(digits, std::size_t(result.ptr - digits));
  const std::size_t e = text.find_first_of("eE");
  const bool small =
      e != std::string_view::npos ? text[e + 1] == '-' : text.find_first_of("123456789") > text.find('.');
  value = small ? 0 : (text[0] == '-' ? -1 : 1) * std::numeric_limits<double>::infinity();
  result.ec = {};
  return result;
}

}  // namespace geometry
