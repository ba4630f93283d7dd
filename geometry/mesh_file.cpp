#include "geometry/mesh_file.hpp"

#include "geometry/mesh_reading.hpp"

namespace geometry {

Mesh parse_mesh(std::string_view bytes, const std::string& file, const std::string& name) {
  using namespace mesh_reading;
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
