// Wavefront OBJ: the lines v and f.
#include "geometry/meshes/mesh_reading.hpp"

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
  while (lines.next()) {
    const std::string_view keyword = lines.word();
    if (keyword == "v") {
      lines.continues();
      out.add_vertex(lines.point(), lines);
    } else if (keyword == "f" || keyword == "fo") {  // fo: its name in old files
      lines.continues();
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
      out.add_polygon(corners, lines);
    } else if (keyword == "l" || keyword == "p" || keyword == "curv" || keyword == "curv2") {
      out.note("line, point or curve left out", "lines, points or curves left out", lines);
    } else if (keyword == "surf" || keyword == "bzp" || keyword == "bsp") {
      out.note("free-form surface left out, as only polygons are read",
               "free-form surfaces left out, as only polygons are read", lines);
    }
  }
  for (const auto& [index, line] : ahead)
    if (index > static_cast<std::int64_t>(out.mesh.vertices.size())) out_of_range(index, line);
  return out.finished(name);
}

}  // namespace geometry::mesh_reading
