#include "geometry/meshes/mesh_file.hpp"

#include "geometry/meshes/mesh_reading.hpp"

namespace geometry {

Mesh parse_mesh(std::string_view bytes, const std::string& file, const std::string& name, std::string* said) {
  using namespace mesh_reading;
  Builder builder(file);
  const std::size_t dot = file.rfind('.');
  const std::string extension = dot == std::string::npos ? "" : file.substr(dot + 1);
  constexpr std::pair<std::string_view, Mesh (*)(std::string_view, Builder&, const std::string&)> kFormats[] = {
      {"obj", parse_obj}, {"off", parse_off}, {"stl", parse_stl}, {"ply", parse_ply}};
  for (const auto& [format, parse] : kFormats) {
    if (!same_word(extension, format)) continue;
    Mesh mesh = parse(bytes, builder, name);
    if (said) *said = builder.said();
    return mesh;
  }
  builder.fail("", "is no kind of mesh file that is read; name a file .obj, .off, .stl or .ply");
}

}  // namespace geometry
