#include "pipeline/scene/csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "geometry/text.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  text.remove_suffix(text.size() - std::min(text.find_last_not_of(kBlank) + 1, text.size()));
  return text;
}

std::string_view unquoted(std::string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return text;
}

std::string joined(const std::vector<std::string_view>& columns) {
  std::string out;
  for (const std::string_view column : columns) out += (out.empty() ? "" : ",") + std::string(column);
  return out;
}

}  // namespace

std::string quoted(std::string_view text) { return in_quotes(one_line(text, 50)); }

CsvReader::CsvReader(std::string_view text, std::string file, std::vector<std::string_view> columns)
    : rest_(text), file_(std::move(file)), columns_(std::move(columns)), fields_(columns_.size()) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  std::string_view line;
  while (line.empty() && !rest_.empty()) {
    line = trimmed(geometry::take_line(rest_));
    ++line_;
  }
  if (line.empty()) fail("is empty; it must begin with " + joined(columns_));
  std::vector<std::string_view> names;
  split(line, names);
  if (!std::ranges::is_permutation(names, columns_)) fail("must be " + joined(columns_) + ", not " + quoted(line));
  for (const std::string_view name : names)
    place_.push_back(std::size_t(std::ranges::find(columns_, name) - columns_.begin()));
}

void CsvReader::split(std::string_view line, std::vector<std::string_view>& fields) const {
  fields.clear();
  for (;;) {
    const std::size_t comma = std::min(line.find(','), line.size());
    fields.push_back(unquoted(line.substr(0, comma)));
    if (comma == line.size()) return;
    line.remove_prefix(comma + 1);
  }
}

bool CsvReader::next() {
  while (!rest_.empty()) {
    const std::string_view line = trimmed(geometry::take_line(rest_));
    ++line_;
    if (line.empty()) continue;
    split(line, as_written_);
    if (as_written_.size() != columns_.size())
      fail("must have " + std::to_string(columns_.size()) + " columns, not " + std::to_string(as_written_.size()));
    for (std::size_t i = 0; i < as_written_.size(); ++i) fields_[place_[i]] = as_written_[i];
    return true;
  }
  return false;
}

std::uint64_t CsvReader::integer(std::size_t column) const {
  const std::string_view text = fields_[column];
  std::uint64_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size())
    fail(std::string(columns_[column]) + " must be an integer of at least 0, not " + quoted(text));
  return value;
}

double CsvReader::real(std::size_t column, double most, const std::string& rule) const {
  const std::string_view text = fields_[column];
  double value = 0;
  const auto [stop, error] = geometry::nearest_double(text.data(), text.data() + text.size(), value);
  const bool number = error == std::errc() && stop == text.data() + text.size();
  if (!number || !(std::abs(value) <= most))
    fail(std::string(columns_[column]) + " must be " + rule + ", not " + quoted(text));
  return value;
}

void CsvReader::fail(const std::string& what) const {
  throw Error(kInput, file_ + ":" + std::to_string(std::max<std::size_t>(line_, 1)) + ": " + what);
}

}  // namespace pipeline
