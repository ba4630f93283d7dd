#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "geometry/contain.hpp"
#include "geometry/mesh_file.hpp"
#include "geometry/shapes.hpp"

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
      {vertices + "f 1 2\n", "a.obj", "a.obj:4: a face must have at least 3 corners"},
      {vertices + "f 1 2 x\n", "a.obj", "a.obj:4: 'x' is not the index of a vertex"},
      {vertices + "f 1 2 3.5\n", "a.obj", "a.obj:4: '3.5' is not the index of a vertex"},
      {"v 0 nan 0\n", "a.obj", "a.obj:1: " + coordinate},
      {"v 0 0 0\r\nv 0 -inf 0\r\n", "a.obj", "a.obj:2: " + coordinate},
      {"v 0 0\n", "a.obj", "a.obj:1: a number is missing"},
      {"v 0,5 0 0\n", "a.obj", "a.obj:1: '0,5' is not a number"},
      {vertices, "a.obj", "a.obj: has no triangle; a body needs a surface"},
      {"", "a.obj", "a.obj: has no triangle; a body needs a surface"},
      {vertices + "surf 0 1 0 1 1 2 3\n", "a.obj",
       "a.obj:4: free-form curves and surfaces are not read; save the mesh as polygons"},
      {"", "a.off", "a.off:1: is empty"},
      {"4OFF\n1 1 1\n", "a.off", "a.off:1: '4OFF' is not the start of an OFF file with vertices of 3 coordinates"},
      {kOff.substr(0, kOff.find("1.5 1 0")), "a.off", "a.off:4: the file ends after 2 of 4 vertices"},
      {kOff.substr(0, kOff.size() - 10), "a.off", "a.off:6: the file ends after 0 of 1 faces"},
      {kOff + "3 0 1 2\n", "a.off", "a.off:8: goes on after the 1 faces that it announces"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off",
       "a.off:6: index 3 is out of range, the file has 3 vertices, counted from 0"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "a.off", "a.off:6: a face must have at least 3 corners, not 2"},
      {"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "a.off", "a.off: has no triangle; a body needs a surface"},
      {"OFF\n-3 1 0\n", "a.off", "a.off:2: the numbers of vertices and faces must be 0 or more and below 2^32"},
      {"OFF\n4000000000 4000000000 0\n0 0 0\n", "a.off", "a.off:3: the file ends after 1 of 4000000000 vertices"},
      {kStl.substr(0, kStl.find("  endloop")), "a.stl", "a.stl:6: the file ends before 'endsolid'; it is truncated"},
      {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n", "a.stl",
       "a.stl:7: a facet must have 3 vertices, not 2"},
      {"solid\nwhat\n", "a.stl", "a.stl:2: 'what' is not a word of STL"},
      {"solid\nvertex 0 0 0\n", "a.stl", "a.stl:2: a vertex outside of a facet"},
      {stl.substr(0, stl.size() - 1), "a.stl",
       "a.stl: byte 134: the file ends after 1 of 2 triangles; it is truncated"},
      {stl + "x", "a.stl", "a.stl: byte 184: the file goes on after the 2 triangles that byte 80 announces"},
      {std::string("\0\0\0", 3), "a.stl",
       "a.stl: byte 0: the file ends within the header of a binary STL file; it is truncated"},
      {binary_stl({{0, 0, 0, 1, 0, 0, 0, inf, 0}}), "a.stl", "a.stl: byte 120: " + coordinate},
      {binary_stl({}), "a.stl", "a.stl: has no triangle; a body needs a surface"},
      {"plx\n", "a.ply", "a.ply:1: is not a PLY file: it does not begin with 'ply'"},
      {kPlyHead + "0 0 0\n1 0 0\n", "a.ply", "a.ply:12: the file ends after 2 of 4 'vertex'; it is truncated"},
      {kPlyHead.substr(0, kPlyHead.find("element")), "a.ply", "a.ply:3: the header does not end; the file is truncated"},
      {kPlyHead + "0 0 0\n1 0 0 5\n", "a.ply", "a.ply:12: more values than the header announces"},
      {kPly + "1 2 3\n", "a.ply", "a.ply:16: the file goes on after what its header announces"},
      {nan_ply, "a.ply", "a.ply: byte " + std::to_string(body + 25) + ": " + coordinate},
      {far_ply, "a.ply",
       "a.ply: byte " + std::to_string(far_ply.size()) +
           ": index 4 is out of range, the file has 4 vertices, counted from 0"},
      {binary_ply(true).substr(0, body + 30), "a.ply", "the data of 'vertex'; it is truncated"},
      {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n", "a.ply",
       "a.ply:5: the header must announce vertices with x, y, z and faces with a list vertex_indices"},
      {"ply\nformat ascii 1.0\nelement vertex 3\nproperty real x\n", "a.ply", "a.ply:4: 'real' is not a type of PLY"},
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
