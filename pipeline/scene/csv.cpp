#include "pipeline/scene/csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
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

bool is_number(std::string_view text) {
  double value = 0;
  const auto [stop, error] = geometry::nearest_double(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size();
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

CsvReader::CsvReader(std::string_view text, std::string file) : rest_(text), file_(std::move(file)) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  std::string_view line, comment, before = rest_;
  std::size_t comment_line = 0;
  while (!rest_.empty()) {
    before = rest_;
    line = trimmed(geometry::take_line(rest_));
    ++line_;
    if (!line.empty() && line[0] != '#') break;
    if (!line.empty()) {
      comment = trimmed(line.substr(std::min(line.find_first_not_of('#'), line.size())));
      comment_line = line_;
    }
    line = {};
  }
  if (line.empty()) fail("is empty; it must begin with a header");
  const bool comma = line.find(',') != line.npos, semicolon = line.find(';') != line.npos;
  if (comma && semicolon) fail("both ',' and ';' stand in " + quoted(line) + "; use one of them between the columns");
  separator_ = comma ? ',' : semicolon ? ';' : line.find('\t') != line.npos ? '\t' : ' ';
  std::vector<std::string_view> names;
  split(line, names);
  width_ = names.size();
  if (std::ranges::all_of(names, is_number)) {  // no header: the line is the first row
    rest_ = before;
    --line_;
    names.clear();
    if (comment_line > 0) split(comment, names);
    if (names.size() != width_) return;
  }
  name(std::move(names));
}

void CsvReader::name(std::vector<std::string_view> columns) {
  columns_ = std::move(columns);
  fields_.resize(columns_.size());
  place_.resize(columns_.size());
  std::iota(place_.begin(), place_.end(), std::size_t(0));
}

void CsvReader::split_at_blanks(std::string_view line, std::vector<std::string_view>& fields) const {
  while (!(line = trimmed(line)).empty()) {
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    fields.push_back(unquoted(line.substr(0, end)));
    line.remove_prefix(end);
  }
}

void CsvReader::split(std::string_view line, std::vector<std::string_view>& fields) const {
  fields.clear();
  if (separator_ == ' ') return split_at_blanks(line, fields);
  for (;;) {
    const std::size_t comma = std::min(line.find(separator_), line.size());
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
    fail(std::string(columns_[column]) + " must be " + rule + ", not " + quoted(text) +
         (separator_ != ',' && text.find(',') != text.npos ? "; write decimals with a point" : ""));
  return value;
}

void CsvReader::fail(const std::string& what) const {
  throw Error(kInput, file_ + ":" + std::to_string(std::max<std::size_t>(line_, 1)) + ": " + what);
}

}  // namespace pipeline
