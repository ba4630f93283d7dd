// STL, as text or binary: three vertices per facet.
#include "geometry/mesh_reading.hpp"

namespace geometry::mesh_reading {
namespace {

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

}  // namespace geometry::mesh_reading
