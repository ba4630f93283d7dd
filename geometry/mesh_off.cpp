// OFF: Geomview's object file format, as text.
#include "geometry/mesh_reading.hpp"

namespace geometry::mesh_reading {

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

}  // namespace geometry::mesh_reading
