// Readers of mesh files. CGAL and others read these formats too, but repair what they read: they weld or reorder
// vertices, skip facets and lose the line of an error.
#include "geometry/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

namespace geometry {
namespace {

constexpr std::uint64_t kMostVertices = std::numeric_limits<std::uint32_t>::max();

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f' || c == '\n'; }

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

/// What the file says, for a message: printable and short.
std::string quoted(std::string_view word) {
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

  std::string place() const { return ":" + std::to_string(last_); }
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

// ---- OBJ ---------------------------------------------------------------------------------------------------------

Mesh parse_obj(std::string_view text, Builder& out, const std::string& name) {
  Lines lines(text, out, '#');
  std::vector<std::uint32_t> corners;
  std::vector<std::pair<std::int64_t, std::size_t>>
      ahead;  // indices of vertices that are yet to come, with their lines
  const auto out_of_range = [&](std::int64_t index, std::size_t line) {
    out.fail(":" + std::to_string(line), "index " + std::to_string(index) + " is out of range, the file has " +
                                             std::to_string(out.mesh.vertices.size()) + " vertices, counted from 1");
  };
  while (lines.next(true)) {
    const std::string_view keyword = lines.word();
    if (keyword == "v") {
      out.add_vertex(lines.point(), lines);
    } else if (keyword == "f") {
      corners.clear();
      while (!lines.at_end()) {
        const std::int64_t index = lines.integer("the index of a vertex", '/');
        lines.rest_of_word();  // "/texture/normal"
        const std::int64_t count = static_cast<std::int64_t>(out.mesh.vertices.size());
        // Negative ones count back from the last vertex so far.
        const std::int64_t from_one = index < 0 ? count + 1 + index : index;
        if (from_one < 1 || from_one > std::int64_t{kMostVertices}) out_of_range(index, lines.line());
        if (from_one > count) ahead.emplace_back(index, lines.line());
        corners.push_back(static_cast<std::uint32_t>(from_one - 1));
      }
      if (corners.size() < 3) lines.fail("a face must have at least 3 corners");
      out.add_fan(corners);
    } else if (keyword == "surf" || keyword == "curv" || keyword == "curv2") {
      lines.fail("free-form curves and surfaces are not read; save the mesh as polygons");
    }
  }
  for (const auto& [index, line] : ahead)
    if (index > static_cast<std::int64_t>(out.mesh.vertices.size())) out_of_range(index, line);
  return out.finished(name);
}

// ---- OFF ---------------------------------------------------------------------------------------------------------

Mesh parse_off(std::string_view text, Builder& out, const std::string& name) {
  Lines lines(text, out, '#');
  if (!lines.next()) lines.fail("is empty");
  const std::string_view header = lines.word();
  const std::size_t off = header.find("OFF");
  if (off == std::string_view::npos || header.substr(0, off).find_first_not_of("STCN") != std::string_view::npos)
    lines.fail(quoted(header) + " is not the start of an OFF file with vertices of 3 coordinates");
  // The counts may follow the word on its line, and in the files of ModelNet do so without a space.
  std::int64_t counts[2];
  const std::string_view glued = header.substr(off + 3);
  int read = 0;
  if (!glued.empty()) {
    const auto [stop, error] = std::from_chars(glued.data(), glued.data() + glued.size(), counts[0]);
    if (error != std::errc() || stop != glued.data() + glued.size())
      lines.fail(quoted(header) + " is not the start of an OFF file");
    read = 1;
  } else if (lines.at_end() && !lines.next()) {
    lines.fail("the numbers of vertices and faces are missing");
  }
  for (; read < 2; ++read) counts[read] = lines.integer("the number of vertices or faces (OFF BINARY is not read)");
  const auto [vertices, faces] = counts;
  if (vertices < 0 || faces < 0 || vertices > std::int64_t{kMostVertices})
    lines.fail("the numbers of vertices and faces must be 0 or more and below 2^32");

  const auto next = [&](const char* what, std::int64_t done, std::int64_t all) {
    if (!lines.next())
      lines.fail("the file ends after " + std::to_string(done) + " of " + std::to_string(all) + " " + what);
  };
  // Announced, not yet seen: memory is reserved for no more than the file can hold.
  out.mesh.vertices.reserve(std::min<std::size_t>(static_cast<std::size_t>(vertices), text.size() / 6));
  for (std::int64_t i = 0; i < vertices; ++i) {
    next("vertices", i, vertices);
    out.add_vertex(lines.point(), lines);
  }
  std::vector<std::uint32_t> corners;
  for (std::int64_t i = 0; i < faces; ++i) {
    next("faces", i, faces);
    const std::int64_t size = lines.integer("the number of corners");
    if (size < 3) lines.fail("a face must have at least 3 corners, not " + std::to_string(size));
    corners.clear();
    for (std::int64_t k = 0; k < size; ++k) {
      const std::int64_t index = lines.integer("the index of a vertex");
      if (index < 0 || index >= vertices)
        lines.fail("index " + std::to_string(index) + " is out of range, the file has " + std::to_string(vertices) +
                   " vertices, counted from 0");
      corners.push_back(static_cast<std::uint32_t>(index));
    }
    out.add_fan(corners);
  }
  if (lines.next()) lines.fail("goes on after the " + std::to_string(faces) + " faces that it announces");
  return out.finished(name);
}

// ---- Binary ------------------------------------------------------------------------------------------------------

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
  std::string place() const { return ": byte " + std::to_string(at_); }
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

// ---- STL ---------------------------------------------------------------------------------------------------------

constexpr std::size_t kStlHead = 84, kStlFacet = 50;

void add_facet(Builder& out) {
  const auto last = static_cast<std::uint32_t>(out.mesh.vertices.size());
  out.mesh.triangles.push_back({last - 3, last - 2, last - 1});
}

Mesh parse_stl_text(std::string_view text, Builder& out, const std::string& name) {
  Lines lines(text, out, 0);
  int vertices = -1;  // of the open facet; -1 outside of one
  bool solid = false;
  while (lines.next()) {
    const std::string_view keyword = lines.word();
    if (same_word(keyword, "vertex")) {
      if (vertices < 0) lines.fail("a vertex outside of a facet");
      if (++vertices > 3) lines.fail("a facet must have 3 vertices, not more");
      out.add_vertex(lines.point(), lines);
    } else if (same_word(keyword, "facet")) {
      if (!solid || vertices >= 0) lines.fail("a facet within another, or outside of a solid");
      vertices = 0;
    } else if (same_word(keyword, "endfacet")) {
      if (vertices != 3) lines.fail("a facet must have 3 vertices, not " + std::to_string(std::max(vertices, 0)));
      add_facet(out);
      vertices = -1;
    } else if (same_word(keyword, "solid") || same_word(keyword, "endsolid")) {
      if (vertices >= 0) lines.fail("a facet is not finished");
      solid = same_word(keyword, "solid");
    } else if (!same_word(keyword, "outer") && !same_word(keyword, "endloop")) {
      lines.fail(quoted(keyword) + " is not a word of STL");
    }
  }
  if (vertices >= 0 || solid) lines.fail("the file ends before 'endsolid'; it is truncated");
  return out.finished(name);
}

Mesh parse_stl(std::string_view bytes, Builder& out, const std::string& name) {
  std::uint64_t facets = 0;
  const bool has_head = bytes.size() >= kStlHead;
  if (has_head) facets = Bytes(bytes, 80, true, out).get<std::uint32_t>("the number of triangles");
  // Headers of binary files may begin with "solid" too: the size decides, and then whether there is a NUL, which
  // the number of triangles nearly always has and text never.
  const bool fits = has_head && bytes.size() == kStlHead + facets * kStlFacet;
  std::string_view start = bytes.substr(0, 1024);
  const bool nul = start.find('\0') != std::string_view::npos;
  if (start.starts_with("\xEF\xBB\xBF")) start.remove_prefix(3);
  while (!start.empty() && is_blank(start[0])) start.remove_prefix(1);
  if (!fits && !nul && start.size() >= 5 && same_word(start.substr(0, 5), "solid"))
    return parse_stl_text(bytes, out, name);

  Bytes in(bytes, 0, true, out);
  in.skip(kStlHead, "the header of a binary STL file");
  if (!fits) {
    const std::uint64_t there = in.left() / kStlFacet;
    if (there < facets)
      out.fail(": byte " + std::to_string(kStlHead + there * kStlFacet),
               "the file ends after " + std::to_string(there) + " of " + std::to_string(facets) +
                   " triangles; it is truncated");
    out.fail(": byte " + std::to_string(kStlHead + facets * kStlFacet),
             "the file goes on after the " + std::to_string(facets) + " triangles that byte 80 announces");
  }
  out.mesh.vertices.reserve(3 * facets);
  out.mesh.triangles.reserve(facets);
  for (std::uint64_t i = 0; i < facets; ++i) {
    in.skip(12, "a normal");
    for (int k = 0; k < 3; ++k) {
      const Bytes start = in;
      const float x = in.get<float>("a vertex"), y = in.get<float>("a vertex"), z = in.get<float>("a vertex");
      out.add_vertex({x, y, z}, start);
    }
    add_facet(out);
    in.skip(2, "a triangle");
  }
  return out.finished(name);
}

// ---- PLY ---------------------------------------------------------------------------------------------------------

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

std::optional<PlyType> ply_type(std::string_view word) {
  constexpr std::pair<std::string_view, PlyType> kNames[] = {
      {"char", PlyType::i8},   {"int8", PlyType::i8},     {"uchar", PlyType::u8},   {"uint8", PlyType::u8},
      {"short", PlyType::i16}, {"int16", PlyType::i16},   {"ushort", PlyType::u16}, {"uint16", PlyType::u16},
      {"int", PlyType::i32},   {"int32", PlyType::i32},   {"uint", PlyType::u32},   {"uint32", PlyType::u32},
      {"float", PlyType::f32}, {"float32", PlyType::f32}, {"double", PlyType::f64}, {"float64", PlyType::f64}};
  for (const auto& [name, type] : kNames)
    if (name == word) return type;
  return std::nullopt;
}

struct PlyProperty {
  std::string name;
  PlyType type;
  std::optional<PlyType> count;  // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  std::ptrdiff_t find(std::string_view property) const {
    const auto at =
        std::find_if(properties.begin(), properties.end(), [&](const PlyProperty& p) { return p.name == property; });
    return at == properties.end() ? -1 : at - properties.begin();
  }
};

/// Values of a text body: an element a line.
struct PlyText {
  Lines& lines;
  void begin(const PlyElement& element, std::uint64_t done) {
    if (!lines.next())
      lines.fail("the file ends after " + std::to_string(done) + " of " + std::to_string(element.count) + " '" +
                 element.name + "'; it is truncated");
  }
  double real(PlyType) { return lines.real(); }
  std::int64_t integer(PlyType) { return lines.integer("an integer"); }
  void end() {
    if (!lines.at_end()) lines.fail("more values than the header announces");
  }
  std::string place() const { return lines.place(); }
  [[noreturn]] void fail(const std::string& what) const { lines.fail(what); }
  bool more() { return lines.next(); }
};

/// Values of a binary body.
struct PlyBinary {
  Bytes in;
  std::string what;
  std::size_t start = 0;  // of the element, the place of its errors

  void begin(const PlyElement& element, std::uint64_t done) {
    start = in.at();
    if (done == 0) what = "the data of '" + element.name + "'";
  }
  double real(PlyType type) {
    if (type == PlyType::f32) return in.get<float>(what);
    if (type == PlyType::f64) return in.get<double>(what);
    return static_cast<double>(integer(type));
  }
  std::int64_t integer(PlyType type) {
    switch (type) {
      case PlyType::i8:
        return in.get<std::int8_t>(what);
      case PlyType::u8:
        return in.get<std::uint8_t>(what);
      case PlyType::i16:
        return in.get<std::int16_t>(what);
      case PlyType::u16:
        return in.get<std::uint16_t>(what);
      case PlyType::i32:
        return in.get<std::int32_t>(what);
      case PlyType::u32:
        return in.get<std::uint32_t>(what);
      case PlyType::f32:
      case PlyType::f64:
        break;
    }
    fail("an index or a count must be of an integer type");
  }
  void end() {}
  std::string place() const { return ": byte " + std::to_string(start); }
  [[noreturn]] void fail(const std::string& text) const { in.fail(text); }
  bool more() const { return in.left() > 0; }
};

template <class Values>
void skip_property(Values& values, const PlyProperty& property) {
  const std::int64_t count = property.count ? values.integer(*property.count) : 1;
  for (std::int64_t k = 0; k < count; ++k) values.real(property.type);
}

template <class Values>
Mesh parse_ply_body(Values values, const std::vector<PlyElement>& elements, Builder& out, const std::string& name) {
  std::uint64_t vertices = 0;
  for (const PlyElement& element : elements)
    if (element.name == "vertex") vertices = element.count;
  std::vector<std::uint32_t> corners;
  for (const PlyElement& element : elements) {
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    const std::ptrdiff_t x = element.find("x"), y = element.find("y"), z = element.find("z");
    std::ptrdiff_t list = element.find("vertex_indices");
    if (list < 0) list = element.find("vertex_index");
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values.begin(element, i);
      Vec3 v = Vec3::Zero();
      for (std::ptrdiff_t p = 0; p < std::ptrdiff_t(element.properties.size()); ++p) {
        const PlyProperty& property = element.properties[std::size_t(p)];
        if (is_vertex && (p == x || p == y || p == z)) {
          v[p == x ? 0 : p == y ? 1 : 2] = values.real(property.type);
        } else if (is_face && p == list) {
          const std::int64_t size = values.integer(*property.count);
          if (size < 3) values.fail("a face must have at least 3 corners, not " + std::to_string(size));
          corners.clear();
          for (std::int64_t k = 0; k < size; ++k) {
            const std::int64_t index = values.integer(property.type);
            if (index < 0 || std::uint64_t(index) >= vertices)
              values.fail("index " + std::to_string(index) + " is out of range, the file has " +
                          std::to_string(vertices) + " vertices, counted from 0");
            corners.push_back(static_cast<std::uint32_t>(index));
          }
          out.add_fan(corners);
        } else {
          skip_property(values, property);
        }
      }
      values.end();
      if (is_vertex) out.add_vertex(v, values);
    }
  }
  if (values.more()) values.fail("the file goes on after what its header announces");
  return out.finished(name);
}

Mesh parse_ply(std::string_view bytes, Builder& out, const std::string& name) {
  Lines lines(bytes, out, 0);
  if (!lines.next() || lines.word() != "ply") lines.fail("is not a PLY file: it does not begin with 'ply'");
  std::vector<PlyElement> elements;
  std::string format;
  bool ended = false;
  while (!ended && lines.next()) {
    const std::string_view keyword = lines.word();
    if (keyword == "format") {
      format = lines.word();
      const std::string_view version = lines.word();
      if (version != "1.0") lines.fail("version " + quoted(version) + " of PLY is not known, only 1.0");
    } else if (keyword == "element") {
      PlyElement element;
      element.name = lines.word();
      const std::int64_t count = lines.integer("the number of elements");
      if (count < 0 || count > std::int64_t{kMostVertices}) lines.fail("a number of elements must be 0 to 2^32 - 1");
      element.count = static_cast<std::uint64_t>(count);
      for (const PlyElement& other : elements)
        if (other.name == element.name) lines.fail("a second element " + quoted(element.name));
      elements.push_back(element);
    } else if (keyword == "property") {
      if (elements.empty()) lines.fail("a property before the first element");
      PlyProperty property{};
      std::string_view word = lines.word();
      if (word == "list") {
        property.count = ply_type(word = lines.word());
        if (!property.count) lines.fail(quoted(word) + " is not a type of PLY");
        word = lines.word();
      }
      const auto type = ply_type(word);
      if (!type) lines.fail(quoted(word) + " is not a type of PLY");
      property.type = *type;
      property.name = lines.word();
      if (property.name.empty()) lines.fail("a property must have a name");
      elements.back().properties.push_back(property);
    } else if (keyword == "end_header") {
      ended = true;
    } else if (keyword != "comment" && keyword != "obj_info") {
      lines.fail(quoted(keyword) + " is not a word of a PLY header");
    }
  }
  if (!ended) lines.fail("the header does not end; the file is truncated");
  bool has_vertices = false, has_faces = false;
  for (const PlyElement& element : elements) {
    const auto plain = [&](const char* p) {
      const std::ptrdiff_t at = element.find(p);
      return at >= 0 && !element.properties[std::size_t(at)].count;
    };
    const auto list = [&](const char* p) {
      const std::ptrdiff_t at = element.find(p);
      return at >= 0 && element.properties[std::size_t(at)].count.has_value();
    };
    if (element.properties.empty()) lines.fail("element " + quoted(element.name) + " has no properties");
    if (element.name == "vertex") has_vertices = plain("x") && plain("y") && plain("z");
    if (element.name == "face")
      has_faces = list("vertex_indices") || (element.find("vertex_indices") < 0 && list("vertex_index"));
  }
  if (!has_vertices || !has_faces)
    lines.fail("the header must announce vertices with x, y, z and faces with a list vertex_indices");
  if (format == "ascii") return parse_ply_body(PlyText{lines}, elements, out, name);
  if (format != "binary_little_endian" && format != "binary_big_endian")
    lines.fail("format " + quoted(format) + " is not ascii, binary_little_endian or binary_big_endian");
  const std::size_t body = bytes.size() - lines.left();
  return parse_ply_body(PlyBinary{Bytes(bytes, body, format == "binary_little_endian", out), {}, 0}, elements, out,
                        name);
}

}  // namespace

Mesh parse_mesh(std::string_view bytes, const std::string& file, const std::string& name) {
  Builder builder(file);
  const std::size_t dot = file.rfind('.');
  const std::string extension = dot == std::string::npos ? "" : file.substr(dot + 1);
  if (same_word(extension, "obj")) return parse_obj(bytes, builder, name);
  if (same_word(extension, "off")) return parse_off(bytes, builder, name);
  if (same_word(extension, "stl")) return parse_stl(bytes, builder, name);
  if (same_word(extension, "ply")) return parse_ply(bytes, builder, name);
  builder.fail("", "is no kind of mesh file that is read; name a file .obj, .off, .stl or .ply");
}

}  // namespace geometry
