#include "geometry/meshes/soundness.hpp"

#include <tinyxml2.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "geometry/meshes/mesh_reading.hpp"

namespace geometry {
namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& place, const std::string& what) { throw MeshFileError(place + ": " + what); }

// ---- glTF

constexpr double kUnit = 1e-4;  // of a quaternion's length: single precision explains 1e-6

/// Needed to know where vertices are, or harmless; a file that requires another cannot be read without it.
bool is_known_extension(std::string_view name) {
  for (const char* harmless :
       {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_technique", "KHR_draco_mesh_"})
    if (name.starts_with(harmless)) return true;
  return name == "KHR_mesh_quantization";  // the types of positions are asked below
}

class Gltf {
 public:
  Gltf(std::string_view bytes, const std::string& file, bool binary) : file_(file) {
    std::size_t from = 0;
    if (binary) {
      from = json_of(bytes);
      bytes = bytes.substr(from, number_at(bytes, 12));
    }
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    try {
      document_ = json::parse(bytes);
    } catch (const json::parse_error& error) {
      const std::size_t at = std::min(bytes.size(), std::max<std::size_t>(error.byte, 1) - 1);
      const std::string_view before = bytes.substr(0, at);
      const auto line = std::ranges::count(before, '\n');
      const std::size_t begin = before.find_last_of('\n') + 1;  // npos + 1 is 0
      fail(binary ? file_ + ": byte " + std::to_string(from + at)
                  : file_ + ":" + std::to_string(line + 1) + ":" + std::to_string(at - begin + 1),
           at == bytes.size() ? "the JSON ends too early; the file is truncated" : "is no JSON");
    }
    if (!document_.is_object() || !document_.contains("asset")) fail(file_, "is no glTF: it has no 'asset'");
  }

  void check() const {
    const json& asset = document_["asset"];
    const json version = asset.is_object() ? asset.value("version", json()) : json();
    if (!version.is_string() || !version.get<std::string>().starts_with("2.")) return;  // assimp says which it reads
    for (const json& name : list("extensionsRequired"))
      if (name.is_string() && !is_known_extension(name.get<std::string>()))
        fail(file_ + ": extensionsRequired",
             mesh_reading::quoted(name.get<std::string>()) + " is not known here; write the file without it");
    check_nodes();
    std::size_t m = 0;
    for (const json& mesh : list("meshes")) {
      std::size_t p = 0;
      for (const json& primitive : list("primitives", mesh))
        check_primitive(primitive, "meshes[" + std::to_string(m) + "].primitives[" + std::to_string(p++) + "]");
      ++m;
    }
  }

 private:
  static std::uint32_t number_at(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  }

  /// Where the JSON of a GLB begins.
  std::size_t json_of(std::string_view bytes) const {
    const auto at = [&](std::size_t byte) { return file_ + ": byte " + std::to_string(byte); };
    const std::string has = "there are " + std::to_string(bytes.size()) + " bytes";
    if (!bytes.starts_with("glTF")) fail(at(0), "a GLB must begin with 'glTF'");
    if (bytes.size() < 20) fail(at(bytes.size()), "a GLB has a header of 20 bytes; the file is truncated");
    if (const auto version = number_at(bytes, 4); version != 2)
      fail(at(4), "the container must be of version 1 or 2, not " + std::to_string(version));
    const std::size_t length = number_at(bytes, 8);
    if (length > bytes.size())
      fail(at(8), "its length is " + std::to_string(length) + ", " + has + "; the file is truncated");
    if (std::memcmp(bytes.data() + 16, "JSON", 4) != 0) fail(at(16), "the first chunk must be JSON");
    for (std::size_t chunk = 12; chunk < length;) {
      if (length - chunk < 8) fail(at(chunk), "a chunk has a header of 8 bytes, " + has);
      const std::size_t size = number_at(bytes, chunk);
      if (size > length - chunk - 8)
        fail(at(chunk), "a chunk of " + std::to_string(size) + " bytes does not fit, " + has);
      chunk += 8 + size;
    }
    return 20;
  }

  const json& list(const char* name) const { return list(name, document_); }
  static const json& list(const char* name, const json& of) {
    static const json none = json::array();
    return of.is_object() && of.contains(name) && of[name].is_array() ? of[name]
                                                                      : none;  // of what is no list assimp says
  }

  void numbers(const json& node, const char* name, std::size_t count, const std::string& place) const {
    if (!node.contains(name)) return;
    const json& value = node[name];
    const bool fits = value.is_array() && value.size() == count &&
                      std::ranges::all_of(value, [](const json& one) { return one.is_number(); });
    if (!fits) fail(place + "." + name, "must be " + std::to_string(count) + " numbers");
  }

  void check_nodes() const {
    std::map<std::uint64_t, std::size_t> parent;
    const json& nodes = list("nodes");
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const json& node = nodes[i];
      const std::string place = file_ + ": nodes[" + std::to_string(i) + "]";
      if (!node.is_object()) fail(place, "must be an object");
      numbers(node, "matrix", 16, place);
      numbers(node, "translation", 3, place);
      numbers(node, "scale", 3, place);
      numbers(node, "rotation", 4, place);
      if (node.contains("rotation")) {
        double square = 0;
        for (const json& one : node["rotation"]) square += one.get<double>() * one.get<double>();
        if (!(std::abs(std::sqrt(square) - 1) <= kUnit)) fail(place + ".rotation", "must be a quaternion of length 1");
      }
      for (const json& child : list("children", node)) {
        if (!child.is_number_unsigned()) continue;
        const auto [above, first] = parent.emplace(child.get<std::uint64_t>(), i);
        if (!first)
          fail(place + ".children", "nodes[" + std::to_string(child.get<std::uint64_t>()) + "] is under nodes[" +
                                        std::to_string(above->second) + "] already; nodes are a tree");
      }
    }
  }

  /// The accessor of that number, or null where there is none, which assimp says.
  const json* accessor(const json& number) const {
    const json& all = list("accessors");
    if (!number.is_number_unsigned() || number.get<std::uint64_t>() >= all.size()) return nullptr;
    const json& one = all[number.get<std::size_t>()];
    return one.is_object() ? &one : nullptr;
  }

  void check_primitive(const json& primitive, const std::string& name) const {
    const std::string place = file_ + ": " + name;
    if (!primitive.is_object()) fail(place, "must be an object");
    const json mode = primitive.value("mode", json(4U));
    if (!mode.is_number_unsigned() || mode.get<std::uint64_t>() > 6) fail(place + ".mode", "must be 0 to 6");
    const json attributes = primitive.value("attributes", json::object());
    if (!attributes.is_object() || !attributes.contains("POSITION")) return;
    const json* position = accessor(attributes["POSITION"]);
    const json* indices = primitive.contains("indices") ? accessor(primitive["indices"]) : nullptr;
    if (!position) return;
    if (position->value("type", json()) != "VEC3" || position->value("componentType", json()) != 5126)
      fail(place, "positions must be three floats (VEC3 of 5126); write the file without quantization");
    if (const json view = position->value("bufferView", json()); view.is_number_unsigned())
      if (const json& views = list("bufferViews"); view.get<std::uint64_t>() < views.size())
        if (const json& of = views[view.get<std::size_t>()]; of.is_object())
          if (const json stride = of.value("byteStride", json()); stride.is_number() && stride.get<double>() < 12)
            fail(file_ + ": bufferViews[" + std::to_string(view.get<std::uint64_t>()) + "].byteStride",
                 "must be at least the 12 bytes of a position");
    if (indices) {
      const json type = indices->value("componentType", json());
      if (indices->value("type", json()) != "SCALAR" || (type != 5121 && type != 5123 && type != 5125))
        fail(place, "indices must be whole numbers (SCALAR of 5121, 5123 or 5125)");
    }
    const json count = (indices ? *indices : *position).value("count", json());
    if (mode == 4 && count.is_number_unsigned() && count.get<std::uint64_t>() % 3 != 0)
      fail(place, "triangles must have three corners each, there are " + std::to_string(count.get<std::uint64_t>()));
  }

  const std::string& file_;
  json document_;
};

// ---- DAE and 3MF

using tinyxml2::XMLElement;

class Xml {
 public:
  Xml(std::string_view text, const std::string& file, const char* root) : file_(file) {
    if (document_.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      fail(file_ + ":" + std::to_string(std::max(1, document_.ErrorLineNum())),
           std::string("is no well-formed XML (") + document_.ErrorName() + "); is it truncated?");
    if (!document_.RootElement() || std::strcmp(document_.RootElement()->Name(), root) != 0)
      fail(file_ + ":1", std::string("must begin with <") + root + ">");
  }

  const XMLElement& root() const { return *document_.RootElement(); }

  [[noreturn]] void fail_at(const XMLElement& e, const std::string& what) const {
    fail(file_ + ":" + std::to_string(e.GetLineNum()), what);
  }

  /// All below an element, itself too.
  template <class Visit>
  static void each(const XMLElement& e, const Visit& visit) {
    visit(e);
    for (const XMLElement* below = e.FirstChildElement(); below; below = below->NextSiblingElement())
      each(*below, visit);
  }

  /// The numbers of a text; it fails at a word that is none. `whole`: indices.
  std::vector<double> numbers(const XMLElement& e, const char* text, const char* what, bool whole) const {
    std::vector<double> out;
    std::string_view rest = text ? text : "";
    while (true) {
      rest.remove_prefix(std::size_t(std::ranges::find_if_not(rest, mesh_reading::is_blank) - rest.begin()));
      if (rest.empty()) return out;
      const auto size = std::size_t(std::ranges::find_if(rest, mesh_reading::is_blank) - rest.begin());
      const std::string_view word = rest.substr(0, size);
      rest.remove_prefix(size);
      double value = 0;
      const auto [stop, error] = nearest_double(word.data(), word.data() + word.size(), value);
      const bool is_whole =
          value >= 0 && value <= std::numeric_limits<std::uint32_t>::max() && value == std::floor(value);
      if (error != std::errc() || stop != word.data() + word.size() || !std::isfinite(value) || (whole && !is_whole))
        fail_at(e, std::string(what) + ": " + mesh_reading::quoted(word) + " is no " +
                       (whole ? "whole number of at least 0" : "finite number"));
      out.push_back(value);
    }
  }

  void so_many(const XMLElement& e, const char* text, const char* what, std::size_t count) const {
    if (const std::size_t there = numbers(e, text, what, false).size(); there != count)
      fail_at(e, std::string(what) + " must be " + std::to_string(count) + " numbers, not " + std::to_string(there));
  }

  double whole(const XMLElement& e, const char* attribute, double preset) const {
    const char* text = e.Attribute(attribute);
    if (!text) return preset;
    const std::vector<double> value = numbers(e, text, attribute, true);
    if (value.size() != 1) fail_at(e, std::string(attribute) + " must be a whole number");
    return value[0];
  }

 private:
  const std::string& file_;
  tinyxml2::XMLDocument document_;
};

/// The array behind a source of positions: that many numbers, three or more a place.
void check_positions(const Xml& xml, const XMLElement& source) {
  const XMLElement* array = source.FirstChildElement("float_array");
  const XMLElement* common = source.FirstChildElement("technique_common");
  const XMLElement* accessor = common ? common->FirstChildElement("accessor") : nullptr;
  if (!array) return;  // which assimp says
  const std::size_t there = xml.numbers(*array, array->GetText(), "positions", false).size();
  const double said = xml.whole(*array, "count", double(there));
  if (said > double(there))
    xml.fail_at(*array,
                "there must be " + std::to_string(std::uint64_t(said)) + " numbers, not " + std::to_string(there));
  if (!accessor) return;
  const double stride = xml.whole(*accessor, "stride", 1), count = xml.whole(*accessor, "count", 0);
  if (stride < 3) xml.fail_at(*accessor, "'stride' of positions must be at least 3");
  if (xml.whole(*accessor, "offset", 0) + stride * count > double(there))
    xml.fail_at(*accessor, "goes beyond the " + std::to_string(there) + " numbers of its array");
}

void check_dae(std::string_view bytes, const std::string& file) {
  if (bytes.starts_with("\xFE\xFF") || bytes.starts_with("\xFF\xFE")) return;  // UTF-16, which assimp reads
  const Xml xml(bytes, file, "COLLADA");
  const std::map<std::string_view, std::size_t> of_nodes = {{"matrix", 16}, {"translate", 3}, {"rotate", 4},
                                                            {"scale", 3},   {"lookat", 9},    {"skew", 7}};
  std::set<std::string> positions;
  Xml::each(xml.root(), [&](const XMLElement& e) {
    const std::string_view name = e.Name(), above = e.Parent()->ToElement() ? e.Parent()->ToElement()->Name() : "";
    if (name == "unit" && e.Attribute("meter")) {
      const std::vector<double> meter = xml.numbers(e, e.Attribute("meter"), "'meter' of <unit>", false);
      if (meter.size() != 1 || !(meter[0] > 0)) xml.fail_at(e, "'meter' of <unit> must be a number above 0");
    } else if (above == "node" && of_nodes.contains(name)) {
      xml.so_many(e, e.GetText(), e.Name(), of_nodes.at(name));
    } else if (name == "p" || name == "vcount") {
      xml.numbers(e, e.GetText(), "indices", true);
    } else if (name == "input" && above == "vertices" && e.Attribute("semantic", "POSITION") && e.Attribute("source")) {
      positions.insert(e.Attribute("source"));
    }
  });
  Xml::each(xml.root(), [&](const XMLElement& e) {
    if (std::string_view(e.Name()) == "source" && e.Attribute("id") &&
        positions.contains(std::string("#") + e.Attribute("id")))
      check_positions(xml, e);
  });
}

void check_model(std::string_view model, const std::string& file) {
  const Xml xml(model, file, "model");
  Xml::each(xml.root(), [&](const XMLElement& e) {
    const std::string_view name = e.Name();
    const auto each_of = [&](std::initializer_list<const char*> attributes, bool whole) {
      for (const char* attribute : attributes)
        if (xml.numbers(e, e.Attribute(attribute), attribute, whole).size() != 1)
          xml.fail_at(e, "<" + std::string(name) + "> must have one number as '" + attribute + "'");
    };
    if (name == "vertex") each_of({"x", "y", "z"}, false);
    if (name == "triangle") each_of({"v1", "v2", "v3"}, true);
    if (e.Attribute("transform") && (name == "item" || name == "component"))
      xml.so_many(e, e.Attribute("transform"), "'transform'", 12);
  });
}

// The archive of a 3MF: its list of entries at the end, and of those what a 3MF may have, plain or deflated.

class Archive {
 public:
  Archive(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  /// The models in it, by name.
  std::map<std::string, std::string> models() const {
    std::map<std::string, std::string> out;
    const std::size_t end = bytes_.rfind("PK\5\6");
    if (end == bytes_.npos) fail(file_, "is no archive, or is truncated: its list of entries is missing");
    std::size_t at = number<4>(end + 16);
    for (std::size_t count = number<2>(end + 10); count > 0; --count) {
      if (part(at, 4) != "PK\1\2") fail_at(at, "must be an entry of the list; the archive is damaged");
      std::string name(part(at + 46, number<2>(at + 28)));
      for (char& c : name)
        if ((c >= 0 && c < ' ') || c == 0x7F) c = '?';
      if (name.ends_with(".model")) out.emplace(name, unpacked(at, name));
      at += 46 + number<2>(at + 28) + number<2>(at + 30) + number<2>(at + 32);
    }
    if (out.empty()) fail(file_, "has no .model");
    return out;
  }

 private:
  [[noreturn]] void fail_at(std::size_t at, const std::string& what) const {
    fail(file_ + ": byte " + std::to_string(at), what);
  }

  std::string_view part(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) fail_at(bytes_.size(), "the archive ends too early");
    return bytes_.substr(at, size);
  }

  template <std::size_t N>
  std::size_t number(std::size_t at) const {
    std::size_t value = 0;
    std::memcpy(&value, part(at, N).data(), N);
    return value;
  }

  std::string unpacked(std::size_t entry, const std::string& name) const {
    const std::size_t method = number<2>(entry + 10), packed = number<4>(entry + 20), size = number<4>(entry + 24);
    const std::size_t local = number<4>(entry + 42);
    const std::string_view data = part(local + 30 + number<2>(local + 26) + number<2>(local + 28), packed);
    const std::string place = file_ + ": " + name;
    if (method != 0 && method != 8) fail(place, "is packed in another way than by deflate");
    // Nothing deflates better than to a thousandth or so.
    if (size > 1100 * packed + 100) fail(place, "is damaged: nothing can be packed like that");
    std::string out(method == 0 ? data : std::string_view());
    if (method == 8) {
      out.resize(size);
      z_stream stream{};
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));
      stream.avail_in = uInt(data.size());
      stream.next_out = reinterpret_cast<Bytef*>(out.data());
      stream.avail_out = uInt(size);
      const bool done = inflateInit2(&stream, -MAX_WBITS) == Z_OK && inflate(&stream, Z_FINISH) == Z_STREAM_END;
      inflateEnd(&stream);
      if (!done || stream.avail_out > 0) fail(place, "cannot be unpacked; the archive is damaged");
    }
    if (crc32(0, reinterpret_cast<const Bytef*>(out.data()), uInt(out.size())) != number<4>(entry + 16))
      fail(place, "does not have its checksum; the archive is damaged");
    return out;
  }

  std::string_view bytes_;
  const std::string& file_;
};

}  // namespace

void refuse_unsound(std::string_view bytes, const std::string& file, std::string_view extension) {
  using mesh_reading::same_word;
  if (same_word(extension, "gltf")) Gltf(bytes, file, false).check();
  const bool first = bytes.starts_with(std::string_view("glTF\1\0\0\0", 8));  // of version 1, another container
  if (same_word(extension, "glb") && !first) Gltf(bytes, file, true).check();
  if (same_word(extension, "dae")) check_dae(bytes, file);
  if (same_word(extension, "3mf"))
    for (const auto& [name, model] : Archive(bytes, file).models()) check_model(model, file + ": " + name);
}

}  // namespace geometry
