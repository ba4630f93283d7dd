// PLY, as text or binary of either byte order.
#include <optional>
#include <unordered_set>

#include "geometry/meshes/mesh_reading.hpp"

namespace geometry::mesh_reading {
namespace {

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
  /// The list of a face's corners; -1 without one.
  std::ptrdiff_t corners() const {
    for (const char* name : {"vertex_indices", "vertex_index"})
      if (const std::ptrdiff_t at = find(name); at >= 0) return properties[std::size_t(at)].count ? at : -1;
    return -1;
  }
};

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::i8:
    case PlyType::u8:
      return 1;
    case PlyType::i16:
    case PlyType::u16:
      return 2;
    case PlyType::f64:
      return 8;
    default:
      return 4;
  }
}

/// Values of a text body: an element a line, or values on whatever line they are.
struct PlyText {
  Lines& lines;
  By by;
  bool words = by == By::words;
  void begin(const PlyElement& element, std::uint64_t done) {
    if (words ? lines.at_end() : !lines.next())
      lines.fail_layout("the file ends after " + std::to_string(done) + " of " + std::to_string(element.count) + " '" +
                        element.name + "'; it is truncated");
  }
  double real(PlyType) { return lines.real(); }
  std::int64_t integer(PlyType) { return lines.integer("an integer"); }
  /// Values that are not used may hold anything: "-1.#IND".
  void skip(PlyType, std::uint64_t count) {
    for (std::uint64_t k = 0; k < count; ++k)
      if (lines.word().empty()) lines.fail_layout("a value is missing");
  }
  bool skip_all(const PlyElement&) { return false; }
  void end() {
    if (!words && !lines.at_end()) lines.fail_layout("more values than the header announces");
  }
  std::string place() const { return lines.place(); }
  [[noreturn]] void fail(const std::string& what) const { lines.fail(what); }
  void finish(Builder& out) {
    while (words ? !lines.at_end() : lines.next()) {
      if (by != By::lines_and_rest) lines.fail_layout("the file goes on after what its header announces", true);
      out.note("line after what the header announces left out", "lines after what the header announces left out",
               lines);
    }
  }
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
  void skip(PlyType type, std::uint64_t count) { in.skip(size_of(type) * count, what); }
  /// Elements of which nothing is used, at once where they are all of one size.
  bool skip_all(const PlyElement& element) {
    std::uint64_t size = 0;
    for (const PlyProperty& property : element.properties) {
      if (property.count) return false;
      size += size_of(property.type);
    }
    begin(element, 0);
    in.skip(size * element.count, what);
    return true;
  }
  void end() {}
  std::string place() const { return ": byte " + std::to_string(start); }
  [[noreturn]] void fail(const std::string& text) const { in.fail(text); }
  void finish(Builder& out) {
    if (in.left() > 0)
      out.note("byte after what the header announces left out", "bytes after what the header announces left out", in,
               in.left());
  }
};

template <class Values>
std::int64_t list_size(Values& values, const PlyProperty& property) {
  const std::int64_t size = values.integer(*property.count);
  if (size < 0) values.fail("a list must have 0 or more entries, not " + std::to_string(size));
  return size;
}

template <class Values>
Mesh parse_ply_body(Values values, const std::vector<PlyElement>& elements, Builder& out, const std::string& name) {
  std::uint64_t vertices = 0;
  for (const PlyElement& element : elements)
    if (element.name == "vertex") vertices = element.count;
  std::vector<std::uint32_t> corners;
  for (const PlyElement& element : elements) {
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    if (!is_vertex && !is_face && values.skip_all(element)) continue;
    const std::ptrdiff_t x = element.find("x"), y = element.find("y"), z = element.find("z");
    const std::ptrdiff_t list = element.corners();
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values.begin(element, i);
      Vec3 v = Vec3::Zero();
      for (std::ptrdiff_t p = 0; p < std::ptrdiff_t(element.properties.size()); ++p) {
        const PlyProperty& property = element.properties[std::size_t(p)];
        if (is_vertex && (p == x || p == y || p == z)) {
          v[p == x ? 0 : p == y ? 1 : 2] = values.real(property.type);
        } else if (is_face && p == list) {
          const std::int64_t size = list_size(values, property);
          corners.clear();
          for (std::int64_t k = 0; k < size; ++k) {
            const std::int64_t index = values.integer(property.type);
            if (index < 0 || std::uint64_t(index) >= vertices)
              values.fail("index " + std::to_string(index) + " is out of range, the file has " +
                          std::to_string(vertices) + " vertices, counted from 0");
            corners.push_back(static_cast<std::uint32_t>(index));
          }
          out.add_polygon(corners, values);
        } else {
          values.skip(property.type, property.count ? std::uint64_t(list_size(values, property)) : 1);
        }
      }
      values.end();
      if (is_vertex) out.add_vertex(v, values);
    }
  }
  values.finish(out);
  return out.finished(name);
}

/// The header's elements; `format` becomes ascii, binary_little_endian or binary_big_endian.
std::vector<PlyElement> parse_ply_header(Lines& lines, Builder& out, std::string& format) {
  if (!lines.next() || lines.word() != "ply") lines.fail("is not a PLY file: it does not begin with 'ply'");
  std::vector<PlyElement> elements;
  std::unordered_set<std::string> names;
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
      if (!names.insert(element.name).second) lines.fail("a second element " + quoted(element.name));
      elements.push_back(std::move(element));
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
      elements.back().properties.push_back(std::move(property));
    } else if (keyword == "end_header") {
      ended = true;
    } else if (keyword != "comment" && keyword != "obj_info") {
      out.note("line of the header left out, which begins with no word of PLY",
               "lines of the header left out, which begin with no word of PLY", lines);
    }
  }
  if (!ended) lines.fail("the header does not end; the file is truncated");
  bool has_vertices = false, has_faces = false;
  for (const PlyElement& element : elements) {
    const auto plain = [&](const char* p) {
      const std::ptrdiff_t at = element.find(p);
      return at >= 0 && !element.properties[std::size_t(at)].count;
    };
    if (element.properties.empty() && element.count > 0)
      lines.fail("element " + quoted(element.name) + " has no properties");
    if (element.name == "vertex") has_vertices = plain("x") && plain("y") && plain("z");
    if (element.name == "face") has_faces = element.corners() >= 0;
  }
  if (!has_vertices || !has_faces)
    lines.fail("the header must announce vertices with x, y, z and faces with a list vertex_indices");
  return elements;
}

}  // namespace

Mesh parse_ply(std::string_view bytes, Builder& out, const std::string& name) {
  Lines lines(bytes, out, 0);
  std::string format;
  const std::vector<PlyElement> elements = parse_ply_header(lines, out, format);
  if (format == "ascii")
    return by_lines_or_words(out, [&](By by) {
      Lines body = lines;
      if (by == By::words) body.read_words();
      return parse_ply_body(PlyText{body, by}, elements, out, name);
    });
  if (format != "binary_little_endian" && format != "binary_big_endian")
    lines.fail("format " + quoted(format) + " is not ascii, binary_little_endian or binary_big_endian");
  const std::size_t body = bytes.size() - lines.left();
  return parse_ply_body(PlyBinary{Bytes(bytes, body, format == "binary_little_endian", out), {}, 0}, elements, out,
                        name);
}

}  // namespace geometry::mesh_reading
