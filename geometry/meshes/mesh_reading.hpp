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
#include <cstdio>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/decision/polygon.hpp"
#include "geometry/meshes/mesh_file.hpp"
#include "geometry/text.hpp"

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

/// What a file has in another order than its lines say: read as words, it may be well.
class LayoutError : public MeshFileError {
 public:
  LayoutError(const std::string& what, bool goes_on) : MeshFileError(what), goes_on(goes_on) {}
  bool goes_on;  // all that is announced was read, and there is more
};

/// How text is read: by lines, by words whatever line they are on, or by lines and leaving out what follows.
enum class By { lines, words, lines_and_rest };

/// A place as the readers have it, ":12" or ": byte 134", within a sentence.
inline std::string in_words(const std::string& place) {
  return place.starts_with(": ") ? place.substr(2) : "line " + place.substr(1);
}

/// A mesh in the making, and what is left out or guessed on the way. Indices are checked against the vertices that are
/// there in the end.
class Builder {
 public:
  explicit Builder(const std::string& file) : file_(file) {}

  Mesh mesh;

  [[noreturn]] void fail(const std::string& place, const std::string& what) const {
    throw MeshFileError(file_ + place + ": " + what);
  }
  [[noreturn]] void fail_layout(const std::string& place, const std::string& what, bool goes_on) const {
    throw LayoutError(file_ + place + ": " + what, goes_on);
  }

  /// One more of what is left out or guessed; `source` knows the place. Texts of one and of several.
  template <class Source>
  void note(const char* one, const char* several, const Source& source, std::uint64_t count = 1) {
    for (Note& n : notes_)
      if (n.one == one) {
        n.count += count;
        return;
      }
    notes_.push_back({one, several, count, in_words(source.place())});
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

  /// A polygon of any number of corners. Vertices may come after it.
  template <class Source>
  void add_polygon(const std::vector<std::uint32_t>& corners, const Source& source) {
    if (corners.size() < 3)
      return note("face of fewer than 3 corners left out", "faces of fewer than 3 corners left out", source);
    const std::size_t first = mesh.triangles.size();
    mesh.triangles.resize(first + corners.size() - 2);
    if (corners.size() == 3) {
      mesh.triangles.back() = {corners[0], corners[1], corners[2]};
    } else if (*std::ranges::max_element(corners) < mesh.vertices.size()) {
      cut(corners, first, source);
    } else {
      ahead_.push_back({corners, first, source.place()});
    }
  }

  Mesh finished(const std::string& name) {
    if (mesh.triangles.empty()) fail("", "has no triangle; a body needs a surface" + left_out());
    for (const Ahead& polygon : ahead_) cut(polygon.corners, polygon.first, polygon);
    mesh.name = name;
    return std::move(mesh);
  }

  /// What was left out or guessed, in one line; empty when nothing was.
  std::string said() const {
    std::string out;
    for (const Note& n : notes_)
      out += (out.empty() ? "" : "; ") + std::to_string(n.count) + " " + (n.count == 1 ? n.one : n.several) +
             (n.count == 1 ? " (" : " (the first at ") + n.first + ")";
    if (bent_ > 0) {
      char how_far[80];
      std::snprintf(how_far, sizeof how_far, " by %.3g m, %.3g %% of its size", farthest_, 100 * worst_);
      out += (out.empty() ? "" : "; ") + std::to_string(bent_) + (bent_ == 1 ? " polygon is" : " polygons are") +
             " far from flat, " + (bent_ == 1 ? "" : "most of all that at ") + worst_place_ + (bent_ == 1 ? "," : "") +
             how_far;
    }
    return out.empty() ? "" : file_ + ": " + out;
  }

 private:
  struct Note {
    const char *one, *several;
    std::uint64_t count;
    std::string first;
  };
  struct Ahead {
    std::vector<std::uint32_t> corners;
    std::size_t first;  // of its triangles
    std::string at;
    const std::string& place() const { return at; }
  };

  std::string left_out() const {
    std::string out;
    for (const Note& n : notes_)
      out += (out.empty() ? " (" : "; ") + std::to_string(n.count) + " " + (n.count == 1 ? n.one : n.several);
    return out.empty() ? "" : out + ")";
  }

  template <class Source>
  void cut(const std::vector<std::uint32_t>& corners, std::size_t first, const Source& source) {
    const PolygonFacts facts =
        cut_polygon(corners, mesh.vertices, std::span(mesh.triangles).subspan(first, corners.size() - 2));
    if (facts.crosses_itself)
      note("polygon crosses itself and is read as a fan from its first corner",
           "polygons cross themselves and are read as fans from their first corners", source);
    const double share = facts.off_plane / facts.extent;
    if (!(share > kFarFromFlat)) return;
    ++bent_;
    if (share <= worst_) return;
    worst_ = share;
    farthest_ = facts.off_plane;
    worst_place_ = in_words(source.place());
  }

  std::string file_;
  std::vector<Note> notes_;
  std::vector<Ahead> ahead_;
  std::uint64_t bent_ = 0;           // polygons far from flat, and the worst of them
  double worst_ = 0, farthest_ = 0;  // share of its size; metres
  std::string worst_place_;
};

/// Text line by line, and the words of the current line; or word by word, whatever line they are on.
class Lines {
 public:
  Lines(std::string_view text, Builder& builder, char comment) : rest_(text), builder_(&builder), comment_(comment) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
    if (rest_.starts_with("\xFE\xFF") || rest_.starts_with("\xFF\xFE"))
      fail("is text in UTF-16; save it as ASCII or UTF-8");
    const std::size_t end = rest_.find_first_of("\r\n");
    lone_cr_ = end != std::string_view::npos && rest_.substr(end, 2) != "\r\n" && rest_[end] == '\r';
  }

  /// To the next line that is not blank; false at the end.
  bool next() {
    continues_ = false;
    do {
      if (!load()) return false;
      trim();
    } while (line_.empty());
    return true;
  }

  /// From here on a word may be on any later line.
  void read_words() { across_ = true; }
  /// The current line goes on in the next one where it ends with a backslash.
  void continues() { continues_ = true; }
  void skip_line() { line_ = {}; }

  /// The next word; empty at the end of the line, or of the file when words are read.
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

  /// No word is left: on the line, or in the file when words are read.
  bool at_end() {
    skip_blanks();
    return line_.empty();
  }
  /// No word is left on the line.
  bool line_ends() {
    trim();
    return line_.empty();
  }
  /// The words of the line that are left.
  int words_of_line() const {
    Lines copy = *this;
    copy.across_ = false;
    int count = 0;
    while (!copy.word().empty()) ++count;
    return count;
  }

  double real() {
    skip_blanks();
    double value = 0;
    const char *begin = line_.data(), *end = begin + line_.size();
    const auto [stop, error] = nearest_double(begin, end, value);
    if (error != std::errc() || (stop != end && !blank(*stop))) {
      const std::string_view wrong = word();
      if (wrong.empty()) fail_layout("a number is missing");
      fail(quoted(wrong) + " is not a number");
    }
    line_.remove_prefix(static_cast<std::size_t>(stop - begin));
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
    const char *begin = line_.data(), *end = begin + line_.size();
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc() || (stop != end && !blank(*stop) && *stop != after)) {
      const std::string_view wrong = word();
      if (wrong.empty()) fail_layout(std::string(what) + " is missing");
      fail(quoted(wrong) + " is not " + what);
    }
    line_.remove_prefix(static_cast<std::size_t>(stop - begin));
    return value;
  }

  // append: g++ 12 warns falsely of "+".
  std::string place() const { return std::string(":").append(std::to_string(std::max<std::size_t>(number_, 1))); }
  [[noreturn]] void fail(const std::string& what) const { builder_->fail(place(), what); }
  [[noreturn]] void fail_layout(const std::string& what, bool goes_on = false) const {
    builder_->fail_layout(place(), what, goes_on);
  }
  std::size_t line() const { return number_; }
  std::size_t left() const { return rest_.size(); }  // bytes after the line

 private:
  bool blank(char c) const { return is_blank(c) || (continues_ && c == '\\'); }
  void trim() {
    std::size_t k = 0;
    while (k < line_.size() && is_blank(line_[k])) ++k;
    line_.remove_prefix(k);
  }
  void skip_blanks() {
    while (true) {
      trim();
      const bool more = continues_ && line_.starts_with('\\');
      if (more && line_.size() > 1) {
        line_.remove_prefix(1);
      } else if (!more && !(across_ && line_.empty())) {
        return;
      } else if (!load()) {
        line_ = {};
        return;
      }
    }
  }
  /// The next line, blank or not, without its comment; false at the end.
  bool load() {
    if (rest_.empty()) return false;
    ++number_;
    line_ = take_line(rest_, lone_cr_);
    if (comment_) line_ = line_.substr(0, line_.find(comment_));
    return true;
  }

  std::string_view rest_, line_;
  Builder* builder_;
  char comment_;
  bool lone_cr_ = false;  // the first line ends with CR alone
  bool across_ = false, continues_ = false;
  std::size_t number_ = 0;  // of the line, from 1
};

/// Reads by lines, as nearly everybody writes, and where that does not come out exactly, by words. Where neither does,
/// lines after the announced ones are left out.
template <class Read>
Mesh by_lines_or_words(Builder& out, const Read& read) {
  const Builder empty = out;
  std::string by_lines;
  bool goes_on = false;
  try {
    return read(By::lines);
  } catch (const LayoutError& error) {
    by_lines = error.what();
    goes_on = error.goes_on;
  }
  out = empty;
  try {
    return read(By::words);
  } catch (const MeshFileError& error) {
    if (!goes_on) {
      if (error.what() == by_lines) throw;
      throw MeshFileError(by_lines + "; nor can it be read without regard to lines: " + error.what());
    }
  }
  out = empty;
  return read(By::lines_and_rest);
}

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
