// STL, as text or binary: three vertices per facet.
#include "geometry/meshes/mesh_reading.hpp"

namespace geometry::mesh_reading {
namespace {

constexpr std::size_t kStlHead = 84, kStlFacet = 50;

void add_facet(Builder& out) {
  const auto last = static_cast<std::uint32_t>(out.mesh.vertices.size());
  out.mesh.triangles.push_back({last - 3, last - 2, last - 1});
}

/// Words, whatever line they are on; only names end with their line.
Mesh parse_stl_text(std::string_view text, Builder& out, const std::string& name) {
  Lines lines(text, out, 0);
  lines.read_words();
  bool solid = false, facet = false;
  std::size_t first = 0;  // vertex of the open facet
  std::vector<std::uint32_t> corners;
  while (!lines.at_end()) {
    const std::string_view word = lines.word();
    // "endloop" or "end loop".
    const bool ends = word.size() >= 3 && same_word(word.substr(0, 3), "end");
    const std::string_view keyword = !ends ? word : word.size() > 3 ? word.substr(3) : lines.word();
    if (!ends && same_word(word, "vertex")) {
      if (!facet) lines.fail("a vertex outside of a facet");
      out.add_vertex(lines.point(), lines);
    } else if (!ends && same_word(word, "facet")) {
      if (!solid || facet) lines.fail("a facet within another, or outside of a solid");
      facet = true;
      first = out.mesh.vertices.size();
      // The normal is not used and may hold anything.
      for (Lines ahead = lines; !ahead.at_end() && !same_word(ahead.word(), "outer");) lines = ahead;
    } else if (ends && same_word(keyword, "facet")) {
      if (!facet) lines.fail("the end of a facet that did not begin");
      facet = false;
      corners.clear();
      for (std::size_t i = first; i < out.mesh.vertices.size(); ++i) corners.push_back(static_cast<std::uint32_t>(i));
      out.add_polygon(corners, lines);
      if (corners.size() < 3) out.mesh.vertices.resize(first);
    } else if (same_word(keyword, "solid")) {
      if (facet) lines.fail("a facet is not finished");
      solid = !ends;
      lines.skip_line();  // its name
    } else if (ends ? same_word(keyword, "loop") : same_word(word, "outer")) {
      if (!facet) lines.fail("a loop outside of a facet");
      if (!ends && !same_word(lines.word(), "loop")) lines.fail("'loop' is missing after 'outer'");
    } else if (facet) {
      lines.fail(quoted(word) + " is not a word of STL");
    } else {
      out.note("line between the facets left out", "lines between the facets left out", lines);
      lines.skip_line();
    }
  }
  if (facet || solid) lines.fail("the file ends before 'endsolid'; it is truncated");
  return out.finished(name);
}

}  // namespace

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

  if (!fits && !nul && !start.empty()) {
    const std::string_view word = start.substr(0, std::min(start.find_first_of(" \t\r\n"), start.size()));
    for (const char* keyword : {"facet", "outer", "vertex", "endsolid"})
      if (same_word(word, keyword))
        out.fail(":1", "begins with " + quoted(word) + ": it is text STL without its first line 'solid NAME'; add it");
    if (std::ranges::all_of(start, [](char c) { return c >= ' ' || is_blank(c); }))
      out.fail(":1", "begins with " + quoted(word) + ": text STL begins with 'solid', and as binary STL " +
                         (has_head ? "it would announce " + std::to_string(facets) + " triangles" : "it is too short"));
  }

  Bytes in(bytes, 0, true, out);
  in.skip(kStlHead, "the header of a binary STL file");
  if (const std::uint64_t there = in.left() / kStlFacet; there < facets)
    out.fail(": byte " + std::to_string(kStlHead + there * kStlFacet), "the file ends after " + std::to_string(there) +
                                                                           " of " + std::to_string(facets) +
                                                                           " triangles; it is truncated");
  if (facets == 0 && in.left() > 0)
    out.fail(": byte 80", "announces 0 triangles, though " + std::to_string(in.left()) +
                              " bytes follow; whoever wrote it did not finish it");
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
  if (in.left() > 0)
    out.note("byte after the announced triangles left out", "bytes after the announced triangles left out", in,
             in.left());
  return out.finished(name);
}

}  // namespace geometry::mesh_reading
