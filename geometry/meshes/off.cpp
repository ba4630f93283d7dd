// OFF: Geomview's object file format, as text.
#include "geometry/meshes/mesh_reading.hpp"

namespace geometry::mesh_reading {
namespace {

/// By lines what follows a vertex on its line is not looked at; by words a vertex is followed by what the header's
/// letters announce. Colours behind a face go to the end of the line.
Mesh read_off(std::string_view text, Builder& out, const std::string& name, By by) {
  const bool words = by == By::words;
  Lines lines(text, out, '#');
  if (!lines.next()) lines.fail("is empty");
  const std::string_view header = lines.word();
  const bool headless = header.find_first_not_of("0123456789") == std::string_view::npos;
  const std::size_t off = headless ? 0 : header.find("OFF");
  const std::string_view letters = header.substr(0, off);
  if (off != std::string_view::npos && !letters.empty() &&
      letters.find_first_not_of("STCN4n") == std::string_view::npos &&
      letters.find_first_of("4n") != std::string_view::npos)
    lines.fail(quoted(header) + " announces vertices of another number of coordinates than 3");
  if (off == std::string_view::npos || letters.find_first_not_of("STCN") != std::string_view::npos)
    lines.fail(quoted(header) + " is not the start of an OFF file with vertices of 3 coordinates");
  if (headless) out.note("word OFF missing at the start", "", lines);
  const auto announces = [&](const char* letter) { return letters.find(letter) != std::string_view::npos; };
  const int more = (announces("N") ? 3 : 0) + (announces("C") ? 4 : 0) + (announces("ST") ? 2 : 0);

  // The counts may follow the word on its line, and in the files of ModelNet do so without a space.
  std::int64_t counts[2];
  const std::string_view glued = headless ? header : header.substr(off + 3);
  int read = 0;
  if (words) lines.read_words();
  if (!glued.empty()) {
    const auto [stop, error] = std::from_chars(glued.data(), glued.data() + glued.size(), counts[0]);
    if (error != std::errc() || stop != glued.data() + glued.size())
      lines.fail(quoted(header) + " is not the start of an OFF file");
    read = 1;
  } else if (!words && lines.at_end() && !lines.next()) {
    lines.fail("the numbers of vertices and faces are missing");
  }
  for (; read < 2; ++read) counts[read] = lines.integer("the number of vertices or faces (OFF BINARY is not read)");
  const auto [vertices, faces] = counts;
  if (vertices < 0 || faces < 0 || vertices > std::int64_t{kMostVertices})
    lines.fail("the numbers of vertices and faces must be 0 or more and below 2^32");
  // The number of edges is not used: by words it is on the same line, or alone on the next.
  if (words && !lines.line_ends())
    lines.skip_line();
  else if (words && !lines.at_end() && lines.words_of_line() == 1)
    lines.word();

  const auto next = [&](const char* what, std::int64_t done, std::int64_t all) {
    if (words ? lines.at_end() : !lines.next())
      lines.fail_layout("the file ends after " + std::to_string(done) + " of " + std::to_string(all) + " " + what);
  };
  // Announced, not yet seen: memory is reserved for no more than the file can hold.
  out.mesh.vertices.reserve(std::min<std::size_t>(static_cast<std::size_t>(vertices), text.size() / 6));
  for (std::int64_t i = 0; i < vertices; ++i) {
    next("vertices", i, vertices);
    out.add_vertex(lines.point(), lines);
    for (int k = 0; words && k < more; ++k) lines.word();
  }
  std::vector<std::uint32_t> corners;
  for (std::int64_t i = 0; i < faces; ++i) {
    next("faces", i, faces);
    const std::int64_t size = lines.integer("the number of corners");
    if (size < 0) lines.fail("a number of corners must be 0 or more, not " + std::to_string(size));
    corners.clear();
    for (std::int64_t k = 0; k < size; ++k) {
      const std::int64_t index = lines.integer("the index of a vertex");
      if (index < 0 || index >= vertices)
        lines.fail("index " + std::to_string(index) + " is out of range, the file has " + std::to_string(vertices) +
                   " vertices, counted from 0");
      corners.push_back(static_cast<std::uint32_t>(index));
    }
    out.add_polygon(corners, lines);
    if (words) lines.skip_line();
  }
  while (words ? !lines.at_end() : lines.next()) {
    if (by != By::lines_and_rest)
      lines.fail_layout("goes on after the " + std::to_string(faces) + " announced faces", true);
    out.note("line after the announced faces left out", "lines after the announced faces left out", lines);
  }
  return out.finished(name);
}

}  // namespace

Mesh parse_off(std::string_view text, Builder& out, const std::string& name) {
  return by_lines_or_words(out, [&](By by) { return read_off(text, out, name, by); });
}

}  // namespace geometry::mesh_reading
