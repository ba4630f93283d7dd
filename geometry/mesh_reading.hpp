// What the readers of mesh files share: the mesh in the making, text by lines and words, numbers of binary files.
// CGAL and others read these formats too, but repair what they read: they weld or reorder vertices, skip facets and
// lose the line of an error.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/mesh_file.hpp"

namespace geometry::mesh_reading {

inline constexpr std::uint64_t kMostVertices = std::numeric_limits<std::uint32_t>::max();

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f' || c == '\n'; }

inline char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

inline bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

/// What the file says, for a message: printable and short.
inline std::string quoted(std::string_view word) {
  std::string out = "'";
  for (const char c : word.substr(0, 40)) out += c < 0x20 || c == 0x7F ? '?' : c;
  return out + (word.size() > 40 ? "...'" : "'");
}

/// A mesh in the making. Indices are checked against the vertices that are there in the end.
class Builder {
 public:
  explicit Builder(const std::string& file) : file_(file) {}

  Mesh mesh;

  [[noreturn]] void fail(const std::string& place, const std::string& what) const {
    throw MeshFileError(file_ + place + ": " + what);
  }

  /// `source` knows the place of the vertex.
  template <class Source>
  void add_vertex(const Vec3& v, const Source& source) {
    for (int k = 0; k < 3; ++k)
      if (!(std::fabs(v[k]) <= kGreatestCoordinate))
        fail(source.place(), "a coordinate must be a finite number between -1e15 and 1e15");
    if (mesh.vertices.size() == kMostVertices) fail(source.place(), "a mesh must have less than 2^32 vertices");
    mesh.vertices.push_back(v);
  }

  /// A polygon as a fan from its first corner.
  void add_fan(const std::vector<std::uint32_t>& corners) {
    for (std::size_t k = 2; k < corners.size(); ++k) mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
  }

  Mesh finished(const std::string& name) {
    if (mesh.triangles.empty()) fail("", "has no triangle; a body needs a surface");
    mesh.name = name;
    return std::move(mesh);
  }

 private:
  std::string file_;
};

/// Text line by line, and the words of the current line.
class Lines {
 public:
  Lines(std::string_view text, Builder& builder, char comment) : rest_(text), builder_(builder), comment_(comment) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  }

  /// To the next line that is not blank; false at the end. With `continued` a line that ends with a backslash goes on
  /// in the next.
  bool next(bool continued = false) {
    while (!rest_.empty()) {
      last_ = ++next_number_;
      std::size_t end = std::min(rest_.find('\n'), rest_.size());
      while (continued && end < rest_.size() && backslash_at(end)) {
        ++next_number_;
        end = std::min(rest_.find('\n', end + 1), rest_.size());
      }
      line_ = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      if (comment_) line_ = line_.substr(0, line_.find(comment_));
      continued_ = continued;
      skip_blanks();
      if (!line_.empty()) return true;
    }
    return false;
  }

  /// The next word of the line; empty at its end.
  std::string_view word() {
    skip_blanks();
    return rest_of_word();
  }

  /// What follows directly, up to the next blank.
  std::string_view rest_of_word() {
    std::size_t end = 0;
    while (end < line_.size() && !blank(line_[end])) ++end;
    const std::string_view out = line_.substr(0, end);
    line_.remove_prefix(end);
    return out;
  }

  bool at_end() {
    skip_blanks();
    return line_.empty();
  }

  double real() {
    skip_blanks();
    double value = 0;
    // from_chars takes no plus sign, which printf-like writers may give.
    const char *begin = line_.data(), *end = begin + line_.size();
    const char* digits = begin != end && *begin == '+' ? begin + 1 : begin;
    const auto [stop, error] = std::from_chars(digits, end, value);
    if (error == std::errc::result_out_of_range) {
      value = tiny(std::string_view(digits, stop)) ? 0 : std::numeric_limits<double>::infinity();
    } else if (error != std::errc() || (stop != end && !blank(*stop))) {
      const std::string_view wrong = word();
      fail(wrong.empty() ? "a number is missing" : quoted(wrong) + " is not a number");
    }
    line_.remove_prefix(static_cast<std::size_t>(stop - line_.data()));
    return value;
  }

  Vec3 point() {
    const double x = real(), y = real(), z = real();
    return {x, y, z};
  }

  /// An integer at the start of the word; `after` may follow it directly.
  std::int64_t integer(const char* what, char after = 0) {
    skip_blanks();
    std::int64_t value = 0;
    const char* end = line_.data() + line_.size();
    const auto [stop, error] = std::from_chars(line_.data(), end, value);
    if (error != std::errc() || (stop != end && !blank(*stop) && *stop != after)) {
      const std::string_view wrong = word();
      fail(wrong.empty() ? std::string(what) + " is missing" : quoted(wrong) + " is not " + what);
    }
    line_.remove_prefix(static_cast<std::size_t>(stop - line_.data()));
    return value;
  }

  // append: g++ 12 warns falsely of "+".
  std::string place() const { return std::string(":").append(std::to_string(last_)); }
  [[noreturn]] void fail(const std::string& what) const { builder_.fail(place(), what); }
  std::size_t line() const { return last_; }
  std::size_t left() const { return rest_.size(); }  // bytes after the line

 private:
  bool blank(char c) const { return is_blank(c) || (continued_ && c == '\\'); }
  void skip_blanks() {
    std::size_t k = 0;
    while (k < line_.size() && blank(line_[k])) ++k;
    line_.remove_prefix(k);
  }
  bool backslash_at(std::size_t end) const {
    if (end > 0 && rest_[end - 1] == '\r') --end;
    return end > 0 && rest_[end - 1] == '\\';
  }
  /// Whether a number that no double holds is too small rather than too great.
  static bool tiny(std::string_view digits) {
    const std::size_t e = digits.find_first_of("eE");
    if (e != std::string_view::npos) return digits[e + 1] == '-';
    return digits.find_first_of("123456789") > digits.find('.');
  }

  std::string_view rest_, line_;
  Builder& builder_;
  char comment_;
  bool continued_ = false;
  std::size_t next_number_ = 0, last_ = 1;
};

/// Numbers at a place of the file, in its byte order.
class Bytes {
 public:
  Bytes(std::string_view all, std::size_t at, bool little, const Builder& builder)
      : all_(all), at_(at), swap_(little != (std::endian::native == std::endian::little)), builder_(&builder) {}

  template <typename T>
  T get(std::string_view what) {
    std::array<char, sizeof(T)> raw;
    need(sizeof(T), what);
    std::memcpy(raw.data(), all_.data() + at_, sizeof(T));
    if (swap_) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }
  void skip(std::size_t count, std::string_view what) {
    need(count, what);
    at_ += count;
  }
  std::size_t left() const { return all_.size() - at_; }
  std::size_t at() const { return at_; }
  std::string place() const { return std::string(": byte ").append(std::to_string(at_)); }
  [[noreturn]] void fail(const std::string& what) const { builder_->fail(place(), what); }

 private:
  void need(std::size_t count, std::string_view what) const {
    if (count > left()) fail("the file ends within " + std::string(what) + "; it is truncated");
  }

  std::string_view all_;
  std::size_t at_;
  bool swap_;
  const Builder* builder_;
};

// One reader per format; each in its own file.
Mesh parse_obj(std::string_view text, Builder& out, const std::string& name);
Mesh parse_off(std::string_view text, Builder& out, const std::string& name);
Mesh parse_stl(std::string_view bytes, Builder& out, const std::string& name);
Mesh parse_ply(std::string_view bytes, Builder& out, const std::string& name);

}  // namespace geometry::mesh_reading
