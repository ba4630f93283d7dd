#include "geometry/meshes/mesh_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <string>
#include <vector>

#include "geometry/decision/contain.hpp"
#include "geometry/meshes/shapes.hpp"

namespace {

using geometry::Facet;
using geometry::Mesh;
using geometry::parse_mesh;
using geometry::Vec3;

const std::vector<Vec3> kCorners{{0, 0, 0}, {1.5, 0, 0}, {1.5, 1, 0}, {0, 1, -2e-3}};
const std::vector<Facet> kFan{{0, 1, 2}, {0, 2, 3}};

void expect_square(const Mesh& mesh) {
  EXPECT_EQ(mesh.name, "square");
  EXPECT_EQ(mesh.vertices, kCorners);
  EXPECT_EQ(mesh.triangles, kFan);
}

/// What parse_mesh throws; empty when it does not.
std::string error_of(const std::string& bytes, const std::string& file) {
  try {
    parse_mesh(bytes, file, "square");
  } catch (const geometry::MeshFileError& error) {
    return error.what();
  }
  return "";
}

const std::string kObj = "v 0 0 0\nv 1.5 0 0\nv 1.5 1 0\nv 0 1 -2e-3\nf 1 2 3 4\n";
const std::string kOff = "OFF\n4 1 0\n0 0 0\n1.5 0 0\n1.5 1 0\n0 1 -2e-3\n4 0 1 2 3\n";
const std::string kPlyHead =
    "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty double x\nproperty double y\n"
    "property double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPly = kPlyHead + "0 0 0\n1.5 0 0\n1.5 1 0\n0 1 -2e-3\n4 0 1 2 3\n";

std::string with_crlf(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? "\r\n" : std::string(1, c);
  return out;
}

/// Bytes of values, in either order.
template <typename T>
void put(std::string& out, T value, bool big = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (big) std::reverse(raw, raw + sizeof(T));
  out.append(raw, sizeof(T));
}

std::string binary_ply(bool big) {
  std::string out = std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
                    " 1.0\nelement vertex 4\nproperty double x\nproperty uchar colour\nproperty double y\n"
                    "property double z\nelement face 1\nproperty list uchar float weights\n"
                    "property list uint8 int32 vertex_index\nend_header\n";
  for (const Vec3& v : kCorners) {
    put(out, v.x(), big);
    put<std::uint8_t>(out, 200);
    put(out, v.y(), big);
    put(out, v.z(), big);
  }
  put<std::uint8_t>(out, 1);
  put(out, 0.5f, big);
  put<std::uint8_t>(out, 4);
  for (std::int32_t i = 0; i < 4; ++i) put(out, i, big);
  return out;
}

std::string binary_stl(const std::vector<std::array<float, 9>>& facets, const std::string& head = "") {
  std::string out = head;
  out.resize(80);
  put<std::uint32_t>(out, static_cast<std::uint32_t>(facets.size()));
  for (const auto& facet : facets) {
    for (int k = 0; k < 3; ++k) put(out, 0.0f);
    for (const float x : facet) put(out, x);
    put<std::uint16_t>(out, 0);
  }
  return out;
}

const std::string kStl =
    "solid square\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n"
    " endfacet\nendsolid square\n";

}  // namespace

TEST(MeshFile, KeepsVerticesAndFansPolygonsFromTheirFirstCorner) {
  expect_square(parse_mesh(kObj, "a.obj", "square"));
  expect_square(parse_mesh(kOff, "a.off", "square"));
  expect_square(parse_mesh(kPly, "a.ply", "square"));
  expect_square(parse_mesh(binary_ply(false), "a.ply", "square"));
  expect_square(parse_mesh(binary_ply(true), "a.ply", "square"));
  expect_square(parse_mesh(kObj, "folder.d/A.OBJ", "square"));
}

TEST(MeshFile, AcceptsByteOrderMarkAndCrLf) {
  const std::string mark = "\xEF\xBB\xBF";
  expect_square(parse_mesh(mark + with_crlf(kObj), "a.obj", "square"));
  expect_square(parse_mesh(mark + with_crlf(kOff), "a.off", "square"));
  expect_square(parse_mesh(mark + with_crlf(kPly), "a.ply", "square"));
  EXPECT_EQ(parse_mesh(mark + with_crlf(kStl), "a.stl", "s").triangles.size(), 1u);
}

TEST(MeshFile, WeldsAndDropsNothing) {
  // A doubled vertex, one that no face uses, and a face without area.
  const Mesh mesh = parse_mesh("v 0 0 0\nv 0 0 0\nv 1 0 0\nv 9 9 9\nv 0 1 0\nf 2 3 5\nf 1 2 3\n", "a.obj", "m");
  EXPECT_EQ(mesh.vertices.size(), 5u);
  EXPECT_EQ(mesh.triangles, (std::vector<Facet>{{1, 2, 4}, {0, 1, 2}}));
}

TEST(MeshFile, ReadsObjsOtherNotations) {
  // Negative indices, textures and normals, colours behind vertices, a face before its vertices, a line that goes on.
  const std::string text =
      "mtllib x.mtl\no thing\nf 1//1 2/5 3/5/1 4 # a face\nv 0 0 0 1 0 0\nv +1.5 0 0\nvn 0 0 1\nv 1.5 \\\n 1 0\n"
      "v 0 1 -.002\nf -4 -3 -2\n";
  const Mesh mesh = parse_mesh(text, "a.obj", "m");
  EXPECT_EQ(mesh.vertices, kCorners);
  EXPECT_EQ(mesh.triangles, (std::vector<Facet>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
}

TEST(MeshFile, ReadsOffsOtherNotations) {
  // Counts on the first line, without a space as ModelNet writes them, colours, comments and blank lines.
  const std::string body = "\n# corners\n0 0 0\n1.5 0 0 # second\n1.5 1 0\n\n0 1 -2e-3\n4 0 1 2 3 255 0 0\n";
  expect_square(parse_mesh("OFF 4 1 0" + body, "a.off", "square"));
  expect_square(parse_mesh("OFF4 1 0" + body, "a.off", "square"));
  expect_square(parse_mesh("COFF\n4 1 0" + body, "a.off", "square"));
}

TEST(MeshFile, StlHasThreeVerticesPerFacetAndIsNeverClosedByIndex) {
  const Mesh box = geometry::box("box", {1, 2, 3});
  std::vector<std::array<float, 9>> facets;
  for (const Facet& f : box.triangles) {
    std::array<float, 9> facet;
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) facet[3 * c + k] = static_cast<float>(box.vertices[f[c]][k]);
    facets.push_back(facet);
  }
  // A header that begins with "solid", as some writers make it, is no text file.
  for (const char* head : {"", "solid box"}) {
    const Mesh mesh = parse_mesh(binary_stl(facets, head), "a.stl", "box");
    ASSERT_EQ(mesh.vertices.size(), 36u);
    ASSERT_EQ(mesh.triangles.size(), 12u);
    for (std::uint32_t i = 0; i < 12; ++i) {
      EXPECT_EQ(mesh.triangles[i], (Facet{3 * i, 3 * i + 1, 3 * i + 2}));
      for (int c = 0; c < 3; ++c) EXPECT_EQ(mesh.vertices[3 * i + c], box.vertices[box.triangles[i][c]]);
    }
    EXPECT_FALSE(geometry::is_closed(mesh));
    EXPECT_TRUE(geometry::solid_of(mesh, geometry::kClosedWithin).closed);  // as a set of points it is
  }
}

TEST(MeshFile, ReadsTextStlOfSeveralSolids) {
  const Mesh mesh = parse_mesh(kStl + kStl, "a.stl", "m");
  EXPECT_EQ(mesh.vertices.size(), 6u);
  EXPECT_EQ(mesh.triangles, (std::vector<Facet>{{0, 1, 2}, {3, 4, 5}}));
}

namespace {

const std::vector<Vec3> kFour{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Facet> kTetrahedron{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

/// The tetrahedron is read from the file, and that is said of it.
void expect_tetrahedron(const std::string& bytes, const std::string& file, const std::string& said) {
  SCOPED_TRACE(bytes);
  std::string line = "?";
  const Mesh mesh = parse_mesh(bytes, file, "m", &line);
  EXPECT_EQ(line, said.empty() ? "" : file + ": " + said);
  if (file.ends_with("stl")) {
    ASSERT_EQ(mesh.triangles.size(), 4u);
    for (std::uint32_t f = 0; f < 4; ++f)
      for (std::uint32_t c = 0; c < 3; ++c) EXPECT_EQ(mesh.vertices[mesh.triangles[f][c]], kFour[kTetrahedron[f][c]]);
  } else {
    EXPECT_EQ(mesh.vertices, kFour);
    EXPECT_EQ(mesh.triangles, kTetrahedron);
  }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t at = 0;
  while ((at = text.find(from, at)) != std::string::npos) {
    text.replace(at, from.size(), to);
    at += to.size();
  }
  return text;
}

const std::string kFourObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
const std::string kFourOff = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
const std::string kFourPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kFourPly = kFourPlyHead + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

std::string four_stl() {
  std::string out = "solid x\n";
  for (const Facet& f : kTetrahedron) {
    out += " facet normal 0 0 0\n  outer loop\n";
    for (const std::uint32_t c : f) {
      out += "   vertex";
      for (int k = 0; k < 3; ++k) out += " " + std::to_string(int(kFour[c][k]));
      out += "\n";
    }
    out += "  endloop\n endfacet\n";
  }
  return out + "endsolid x\n";
}

std::string four_binary_ply() {
  std::string out = replaced(kFourPlyHead, "ascii", "binary_little_endian");
  for (const Vec3& v : kFour)
    for (int k = 0; k < 3; ++k) put(out, static_cast<float>(v[k]));
  for (const Facet& f : kTetrahedron) {
    put<std::uint8_t>(out, 3);
    for (const std::uint32_t i : f) put(out, i);
  }
  return out;
}

}  // namespace

TEST(MeshFile, LinesMayEndWithCarriageReturnsAlone) {
  expect_tetrahedron("# mac\r" + replaced(kFourObj, "\n", "\r"), "a.obj", "");
  expect_tetrahedron(replaced(kFourOff, "\n", "\r"), "a.off", "");
  expect_tetrahedron(replaced(kFourPly, "\n", "\r"), "a.ply", "");
  expect_tetrahedron(replaced(four_stl(), "\n", "\r"), "a.stl", "");
  // Some lines so, others not, as pasted files have them; and the lines of messages are still right.
  expect_tetrahedron(replaced(kFourObj, "\nf", "\rf"), "a.obj", "");
  EXPECT_EQ(error_of("v 0 0 0\rv 0 0 x\r", "a.obj"), "a.obj:2: 'x' is not a number");
}

// The body of a binary file begins right after the header's last line end: the byte 10 that follows is data.
TEST(MeshFile, ACarriageReturnAloneEndsABinaryPlysHeader) {
  std::string ply =
      "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty uchar x\rproperty uchar y\r"
      "property uchar z\relement face 1\rproperty list uchar uchar vertex_indices\rend_header\r";
  ply += std::string("\x0A\x00\x00", 3) + std::string("\x00\x0D\x00", 3) + std::string("\x00\x00\x0A", 3);
  ply += std::string("\x03\x00\x01\x02", 4);
  EXPECT_EQ(parse_mesh(ply, "a.ply", "m").vertices, (std::vector<Vec3>{{10, 0, 0}, {0, 13, 0}, {0, 0, 10}}));
}

TEST(MeshFile, WordsCountInOffAndPlyWhereLinesDoNot) {
  // An index a line; two vertices a line; all counts apart; colours of vertices, as the header announces them.
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n",
                    faces = "3 0\n2\n1\n\n3 0 1\n3\n3 1 2 3 255 0 0\n3\n0 3 2\n";
  expect_tetrahedron("OFF\n4 4 0\n" + corners + faces, "a.off", "");
  expect_tetrahedron("OFF 4 4\n" + corners + faces, "a.off", "");
  expect_tetrahedron("OFF\n4\n4\n6\n" + corners + faces, "a.off", "");
  expect_tetrahedron("OFF\n4 4 0\n0 0 0 1 0 0\n0 1 0 0 0 1\n" + faces, "a.off", "");
  expect_tetrahedron("COFF\n4 4 0\n0 0 0\n1 1 1 1\n1 0 0\n1 1 1 1\n0 1 0\n1 1 1 1\n0 0 1\n1 1 1 1\n" + faces, "a.off",
                     "");
  // By lines, colours need no announcement.
  expect_tetrahedron(replaced(replaced(kFourOff, "0 0 0\n", "0 0 0 9 9 9\n"), "1 0 0\n", "1 0 0 9 9 9\n"), "a.off", "");

  const std::string normals = replaced(kFourPlyHead, "z\n", "z\nproperty float nx\nproperty float ny\n");
  expect_tetrahedron(normals + "0 0 0\n0 0\n1 0 0\n0 0\n0 1 0\n0 0\n0 0 1\n0 0\n" +
                         faces.substr(0, faces.find(" 255")) + "\n3 0 3 2\n",
                     "a.ply", "");
  expect_tetrahedron(kFourPlyHead + "0 0 0 1 0 0 0 1 0 0 0 1 3 0 2 1 3 0 1 3 3 1 2 3 3 0 3 2", "a.ply", "");
}

// What is wrong in a file that does not come out by lines is said for both ways of reading.
TEST(MeshFile, WordsThatDoNotComeOutEitherAreRefused) {
  const std::string head = "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  EXPECT_EQ(
      error_of(head + "3 0\n2\n1\n3 0 1\n9\n", "a.off"),
      "a.off:7: the index of a vertex is missing; nor can it be read without regard to lines: a.off:11: index 9 is "
      "out of range, the file has 4 vertices, counted from 0");
  EXPECT_EQ(error_of(kFourPlyHead + "0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n", "a.ply")
                .substr(0, 55),
            "a.ply:10: more values than the header announces; nor ca");
}

TEST(MeshFile, FacesOfFewerThanThreeCornersAreLeftOutAndCounted) {
  expect_tetrahedron(kFourObj + "f 1 2\nf 3\nf\n", "a.obj",
                     "3 faces of fewer than 3 corners left out (the first at line 9)");
  expect_tetrahedron(replaced(kFourOff, "4 4 0", "4 6 0") + "2 0 1\n0\n", "a.off",
                     "2 faces of fewer than 3 corners left out (the first at line 11)");
  expect_tetrahedron(replaced(kFourPly, "face 4", "face 5") + "2 0 1\n", "a.ply",
                     "1 face of fewer than 3 corners left out (line 18)");
  std::string binary = replaced(four_binary_ply(), "face 4", "face 5");
  const std::size_t end = binary.size();
  put<std::uint8_t>(binary, 1);
  put<std::int32_t>(binary, 2);
  expect_tetrahedron(binary, "a.ply", "1 face of fewer than 3 corners left out (byte " + std::to_string(end) + ")");
  expect_tetrahedron(
      replaced(four_stl(), "endsolid", "facet normal 0 0 1\nouter loop\nvertex 1 2 3\nendloop\nendfacet\nendsolid"),
      "a.stl", "1 face of fewer than 3 corners left out (line 34)");
}

// A corner that is named twice makes a triangle without area, which is kept, as a facet of three corners would be.
TEST(MeshFile, CornersMayRepeat) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  EXPECT_EQ(parse_mesh(vertices + "f 1 2 2 3\n", "a.obj", "m").triangles, (std::vector<Facet>{{0, 1, 1}, {0, 1, 2}}));
  EXPECT_EQ(parse_mesh(vertices + "f 1 1 2\n", "a.obj", "m").triangles, (std::vector<Facet>{{0, 0, 1}}));
}

TEST(MeshFile, WhatIsNotUsedMayHoldAnything) {
  const std::string head = replaced(kFourPlyHead, "z\n", "z\nproperty float nx\nproperty list uchar int tags\n");
  expect_tetrahedron(
      head + "0 0 0 -1.#IND 0\n1 0 0 nan 2 x y\n0 1 0 -nan(ind) 0\n0 0 1 1,5 1 ?\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n",
      "a.ply", "");
  expect_tetrahedron(replaced(four_stl(), "normal 0 0 0", "normal -1.#IND nan"), "a.stl", "");
  expect_tetrahedron(replaced(four_stl(), "normal 0 0 0", ""), "a.stl", "");
  expect_tetrahedron(kFourObj + "vn -1.#IND 0 0\nvt x\ns off\n", "a.obj", "");
}

TEST(MeshFile, UnknownWordsOfAHeaderAreLeftOutAndCounted) {
  expect_tetrahedron(replaced(kFourPly, "element vertex", "Created by me\nelement vertex"), "a.ply",
                     "1 line of the header left out, which begins with no word of PLY (line 3)");
  expect_tetrahedron(replaced(four_stl(), " facet", "color 1 0 0\n facet"), "a.stl",
                     "4 lines between the facets left out (the first at line 2)");
  expect_tetrahedron(kFourOff.substr(4), "a.off", "1 word OFF missing at the start (line 1)");
}

TEST(MeshFile, AnElementOfNoneNeedsNoProperties) {
  expect_tetrahedron(replaced(kFourPly, "element vertex", "element material 0\nelement vertex"), "a.ply", "");
}

TEST(MeshFile, WhatFollowsTheAnnouncedIsLeftOutAndCounted) {
  expect_tetrahedron(
      four_binary_ply() + "\n", "a.ply",
      "1 byte after what the header announces left out (byte " + std::to_string(four_binary_ply().size()) + ")");
  expect_tetrahedron(kFourPly + "3 0 1 2\n\nend\n", "a.ply",
                     "2 lines after what the header announces left out (the first at line 18)");
  expect_tetrahedron(kFourOff + "3 0 1 2\n", "a.off", "1 line after the announced faces left out (line 11)");
  const std::string stl = binary_stl({{0, 0, 0, 1, 0, 0, 0, 1, 0}});
  std::string said;
  EXPECT_EQ(parse_mesh(stl + "xyz", "a.stl", "m", &said).triangles.size(), 1u);
  EXPECT_EQ(said, "a.stl: 3 bytes after the announced triangles left out (the first at byte 134)");
}

TEST(MeshFile, WordsOfStlMayBePartedByBlanks) {
  const std::string parted = replaced(replaced(four_stl(), "endloop", "end loop"), "endfacet", "end facet");
  expect_tetrahedron(replaced(parted, "endsolid", "END SOLID"), "a.stl", "");
  // All in one line, but for the names, which end with theirs.
  const std::size_t name = parted.find('\n') + 1, end = parted.find("endsolid");
  expect_tetrahedron(parted.substr(0, name) + replaced(parted.substr(name, end - name), "\n", " ") + parted.substr(end),
                     "a.stl", "");
  // A name may be any word.
  expect_tetrahedron(replaced(replaced(four_stl(), "endsolid x", "endsolid facet"), "solid x", "solid vertex loop"),
                     "a.stl", "");
}

TEST(MeshFile, FacetsOfTextStlMayHaveMoreCorners) {
  const Mesh mesh = parse_mesh(
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 1 1 0\nvertex 3 0 0\nvertex 0 3 0\nvertex 0 0 0\nendloop\n"
      "endfacet\nendsolid\n",
      "a.stl", "m");
  // (1, 1) is no notch but the first corner of a convex one.
  EXPECT_EQ(mesh.triangles, (std::vector<Facet>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(MeshFile, CurvesBesidePolygonsAreLeftOutAndCounted) {
  expect_tetrahedron(
      "vp 0.1 0.2\n" + kFourObj + "l 1 2 3\np 1\ncstype bspline\ndeg 3\ncurv 0 1 1 2 3\nparm u 0 1\nend\n", "a.obj",
      "3 lines, points or curves left out (the first at line 10)");
  expect_tetrahedron(kFourObj + "surf 0 1 0 1 1 2 3\n", "a.obj",
                     "1 free-form surface left out, as only polygons are read (line 9)");
}

TEST(MeshFile, ABackslashContinuesVerticesAndFacesOnly) {
  for (const std::string eol : {"\n", "\r\n", "\r"}) {
    const std::string text = "# exported from C:\\models\\\no C:\\\nmtllib a\\\n" + kFourObj;
    expect_tetrahedron(replaced(text, "\n", eol), "a.obj", "");
    expect_tetrahedron(replaced(replaced(kFourObj, "f 2 3 4", "f 2 \\\n 3\\\n4 # here\\"), "\n", eol), "a.obj", "");
    expect_tetrahedron(replaced(replaced(kFourObj, "v 1 0 0", "v 1 0 \\\n0"), "\n", eol), "a.obj", "");
  }
}

// 100,000 elements took 27 s when the name of each was compared with all before it.
TEST(MeshFile, AHeaderIsReadInLinearTime) {
  std::string elements, properties;
  for (int i = 0; i < 100000; ++i) {
    elements += "element e" + std::to_string(i) + " 0\n";
    if (i % 10 == 0) properties += "property uchar p" + std::to_string(i) + "\n";
  }
  const auto start = std::chrono::steady_clock::now();
  expect_tetrahedron(
      replaced(kFourPly, "element vertex", elements + "element none 0\n" + properties + "element vertex"), "a.ply", "");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

// What is announced and not used takes no time of its own: four billion elements that are not there.
TEST(MeshFile, AnnouncedElementsThatAreNotThereAreFoundOutAtOnce) {
  EXPECT_NE(error_of(replaced(four_binary_ply(), "element vertex",
                              "element dust 4000000000\nproperty char size\nelement vertex"),
                     "a.ply")
                .find("the file ends within the data of 'dust'"),
            std::string::npos);
}

TEST(MeshFile, NumbersNearZeroAreTheirNearestDoubles) {
  const auto x = [](const std::string& number) {
    return parse_mesh("v " + number + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj", "m").vertices[0].x();
  };
  EXPECT_EQ(x("1E-330"), 0);
  EXPECT_EQ(x("3e-324"), std::numeric_limits<double>::denorm_min());  // nearer to 4.94e-324 than to 0
  EXPECT_EQ(x("2e-324"), 0);
  EXPECT_EQ(x("-1.5e-320"), -1.5e-320);
  EXPECT_EQ(x("0." + std::string(400, '0') + "1"), 0);
}

TEST(MeshFile, TooSmallNumbersAreZeroAndTooGreatOnesRefused) {
  EXPECT_EQ(parse_mesh("v 1e-400 -1e-400 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj", "m").vertices[0], Vec3(0, 0, 0));
  EXPECT_EQ(error_of("v 0 0 0\nv 1e400 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj"),
            "a.obj:2: a coordinate must be a finite number between -1e15 and 1e15");
}

TEST(MeshFile, RefusesWithFileAndLine) {
  struct Case {
    std::string bytes, file, message;
  };
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::string coordinate = "a coordinate must be a finite number between -1e15 and 1e15";
  std::string nan_ply = binary_ply(false);
  const std::size_t body = nan_ply.find("end_header\n") + 11;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::memcpy(nan_ply.data() + body + 25, &nan, sizeof nan);  // the second vertex
  std::string far_ply = binary_ply(false);
  const std::int32_t far = 4;
  std::memcpy(far_ply.data() + far_ply.size() - 4, &far, sizeof far);
  const std::string stl = binary_stl({{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 0, 0, 1, 0, 0, 0, 1, 0}});
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<Case> cases{
      {vertices + "f 1 2 4\n", "a.obj", "a.obj:4: index 4 is out of range, the file has 3 vertices, counted from 1"},
      {vertices + "f 1 2 0\n", "a.obj", "a.obj:4: index 0 is out of range, the file has 3 vertices, counted from 1"},
      {vertices + "f 1 2 -4\n", "a.obj", "a.obj:4: index -4 is out of range, the file has 3 vertices, counted from 1"},
      {vertices + "f 1 2\n", "a.obj",
       "a.obj: has no triangle; a body needs a surface (1 face of fewer than 3 corners left out)"},
      {vertices + "f 1 2 x\n", "a.obj", "a.obj:4: 'x' is not the index of a vertex"},
      {vertices + "f 1 2 3.5\n", "a.obj", "a.obj:4: '3.5' is not the index of a vertex"},
      {"v 0 nan 0\n", "a.obj", "a.obj:1: " + coordinate},
      {"v 0 0 0\r\nv 0 -inf 0\r\n", "a.obj", "a.obj:2: " + coordinate},
      {"v 0 0\n", "a.obj", "a.obj:1: a number is missing"},
      {"v 0,5 0 0\n", "a.obj", "a.obj:1: '0,5' is not a number"},
      {vertices, "a.obj", "a.obj: has no triangle; a body needs a surface"},
      {"", "a.obj", "a.obj: has no triangle; a body needs a surface"},
      {vertices + "surf 0 1 0 1 1 2 3\n", "a.obj",
       "a.obj: has no triangle; a body needs a surface (1 free-form surface left out, as only polygons are read)"},
      {"", "a.off", "a.off:1: is empty"},
      {"4OFF\n1 1 1\n", "a.off", "a.off:1: '4OFF' announces vertices of another number of coordinates than 3"},
      {kOff.substr(0, kOff.find("1.5 1 0")), "a.off", "a.off:4: the file ends after 2 of 4 vertices"},
      {kOff.substr(0, kOff.size() - 10), "a.off", "a.off:6: the file ends after 0 of 1 faces"},
      {"off\n1 1 1\n", "a.off", "a.off:1: 'off' is not the start of an OFF file with vertices of 3 coordinates"},
      {"OFF BINARY\n", "a.off", "a.off:1: 'BINARY' is not the number of vertices or faces (OFF BINARY is not read)"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off",
       "a.off:6: index 3 is out of range, the file has 3 vertices, counted from 0"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-2 0 1\n", "a.off", "a.off:6: a number of corners must be 0 or more, not -2"},
      {"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "a.off", "a.off: has no triangle; a body needs a surface"},
      {"OFF\n-3 1 0\n", "a.off", "a.off:2: the numbers of vertices and faces must be 0 or more and below 2^32"},
      {"OFF\n4000000000 4000000000 0\n0 0 0\n", "a.off", "a.off:3: the file ends after 1 of 4000000000 vertices"},
      {kStl.substr(0, kStl.find("  endloop")), "a.stl", "a.stl:6: the file ends before 'endsolid'; it is truncated"},
      {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n", "a.stl",
       "a.stl: has no triangle; a body needs a surface (1 face of fewer than 3 corners left out)"},
      {"solid\nfacet normal 0 0 1\nouter loop\nwhat\n", "a.stl", "a.stl:4: 'what' is not a word of STL"},
      {"facet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "a.stl",
       "a.stl:1: begins with 'facet': it is text STL without its first line 'solid NAME'; add it"},
      {"<html>not found</html>\n", "a.stl",
       "a.stl:1: begins with '<html>not': text STL begins with 'solid', and as binary STL it is too short"},
      {"solid\nvertex 0 0 0\n", "a.stl", "a.stl:2: a vertex outside of a facet"},
      {stl.substr(0, stl.size() - 1), "a.stl",
       "a.stl: byte 134: the file ends after 1 of 2 triangles; it is truncated"},
      {std::string(84, '\0') + "12345", "a.stl", "a.stl: byte 80: announces 0 triangles, though 5 bytes follow"},
      {std::string("\0\0\0", 3), "a.stl",
       "a.stl: byte 0: the file ends within the header of a binary STL file; it is truncated"},
      {binary_stl({{0, 0, 0, 1, 0, 0, 0, inf, 0}}), "a.stl", "a.stl: byte 120: " + coordinate},
      {binary_stl({}), "a.stl", "a.stl: has no triangle; a body needs a surface"},
      {"plx\n", "a.ply", "a.ply:1: is not a PLY file: it does not begin with 'ply'"},
      {kPlyHead + "0 0 0\n1 0 0\n", "a.ply", "a.ply:12: the file ends after 2 of 4 'vertex'; it is truncated"},
      {kPlyHead.substr(0, kPlyHead.find("element")), "a.ply",
       "a.ply:3: the header does not end; the file is truncated"},
      {kPlyHead + "0 0 0\n1 0 0 5\n", "a.ply", "a.ply:12: more values than the header announces"},
      {kPlyHead + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n-4 0 1 2 3\n", "a.ply",
       "a.ply:15: a list must have 0 or more entries, not -4"},
      {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nelement dot 3\nend_header\n", "a.ply",
       "a.ply:6: element 'dot' has no properties"},
      {nan_ply, "a.ply", "a.ply: byte " + std::to_string(body + 25) + ": " + coordinate},
      {far_ply, "a.ply",
       "a.ply: byte " + std::to_string(far_ply.size()) +
           ": index 4 is out of range, the file has 4 vertices, counted from 0"},
      {binary_ply(true).substr(0, body + 30), "a.ply", "the data of 'vertex'; it is truncated"},
      {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n", "a.ply",
       "a.ply:5: the header must announce vertices with x, y, z and faces with a list vertex_indices"},
      {"ply\nformat ascii 1.0\nelement vertex 3\nproperty real x\n", "a.ply", "a.ply:4: 'real' is not a type of PLY"},
      {std::string("\xFF\xFEv\0 \0", 6), "a.obj", "a.obj:1: is text in UTF-16; save it as ASCII or UTF-8"},
      {kObj, "a.fbx", "a.fbx: is no kind of mesh file that is read; name a file .obj, .off, .stl or .ply"},
      {kObj, "mesh", "mesh: is no kind of mesh file that is read; name a file .obj, .off, .stl or .ply"},
  };
  for (const Case& c : cases) {
    const std::string message = error_of(c.bytes, c.file);
    EXPECT_NE(message.find(c.message), std::string::npos) << "wanted: " << c.message << "\n   got: " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

// No prefix of a file, and no single changed byte, does worse than an error.
TEST(MeshFile, DamagedFilesAreRefusedOrRead) {
  const std::string stl = binary_stl({{0, 0, 0, 1, 0, 0, 0, 1, 0}});
  const std::pair<std::string, std::string> files[] = {
      {kObj, "a.obj"}, {kOff, "a.off"}, {kPly, "a.ply"}, {binary_ply(false), "a.ply"}, {kStl, "a.stl"}, {stl, "a.stl"}};
  for (const auto& [bytes, file] : files)
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      error_of(bytes.substr(0, i), file);
      for (const char c : {'\0', '\xFF', '9', '-', '\n'}) {
        std::string changed = bytes;
        changed[i] = c;
        const std::string message = error_of(changed, file);
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      }
    }
}
