// CSV as other people's programs write it: a header that names the columns, in any order, then rows.
//
// UTF-8 with or without byte order mark; lines end with LF, CR LF or CR; blank ones are skipped. Blanks around a field
// and quotes around all of it, which some writers put around every text, are no part of it; there is no separator
// within one.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pipeline {

/// Reads row by row. Throws Error(kInput), one line "file:line: ...". `text` must outlive it.
class CsvReader {
 public:
  /// `columns` are those that there must be, no other.
  CsvReader(std::string_view text, std::string file, std::vector<std::string_view> columns);

  /// Columns of any name, with commas, semicolons, tabs or else blanks between them, as the first line has it. Lines
  /// before it that begin with '#' are comments; the last of them is the header where the first line is of numbers and
  /// it has as many words. Where there is none either, header() is empty, and `name` names the columns.
  CsvReader(std::string_view text, std::string file);
  const std::vector<std::string_view>& header() const { return columns_; }
  /// Of the first line, whether it is the header or not.
  std::size_t width() const { return width_; }
  char separator() const { return separator_; }  // ' ' for any blanks
  void name(std::vector<std::string_view> columns);

  /// Goes on to the next row; false when there is none.
  bool next();

  /// A field of the row, by the place of its column in `columns`.
  std::string_view operator[](std::size_t column) const { return fields_[column]; }
  /// The same as an integer of at least 0.
  std::uint64_t integer(std::size_t column) const;
  /// The same as a finite number of at most that size.
  double real(std::size_t column, double most, const std::string& rule) const;

  std::size_t line() const { return line_; }
  /// Throws `what` at the line read last.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  void split(std::string_view line, std::vector<std::string_view>& fields) const;
  void split_at_blanks(std::string_view line, std::vector<std::string_view>& fields) const;

  std::string_view rest_;
  std::string file_;
  std::vector<std::string_view> columns_;
  std::vector<std::size_t> place_;  // of the file's columns: where in `columns` each is
  std::vector<std::string_view> fields_, as_written_;
  std::size_t line_ = 0, width_ = 0;
  char separator_ = ',';
};

/// A text of a file as messages show it.
std::string quoted(std::string_view text);

}  // namespace pipeline
