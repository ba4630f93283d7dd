// Wavefront OBJ: the lines v and f.
#include "geometry/mesh_reading.hpp"

namespace geometry::mesh_reading {

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

}  // namespace geometry::mesh_reading
