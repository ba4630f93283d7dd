// What methods test in place of meshes, as the file keeps it and `export` writes it.
#include "pipeline/stages/proxies.hpp"

#include <gtest/gtest.h>

#include "algorithms/contract/proxy_files.hpp"
#include "geometry/decision/contain.hpp"
#include "geometry/meshes/mesh_file.hpp"
#include "geometry/meshes/shapes.hpp"
#include "pipeline/commands/export_csv.hpp"
#include "pipeline/config.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"

namespace pipeline {
namespace {

geometry::Bodies two_meshes() {
  geometry::Bodies bodies;
  bodies.meshes = {geometry::box("box", {2, 2, 2}), geometry::torus("ring", 3, 0.6, 12)};
  bodies.add("a", 0);
  bodies.add("b", 1);
  return bodies;
}

Proxies made(const std::string& argument) { return proxies_of(two_meshes(), {parse_algorithm(argument)}); }

geometry::Mesh read_back(const MeshProxy& row) { return geometry::parse_mesh(proxy_text(row), "x.obj", "x"); }

TEST(Proxies, AreThereForEveryMeshOfMethodsThatHaveSome) {
  const Proxies found = proxies_of(
      two_meshes(), {parse_algorithm("exact"), parse_algorithm("spheres:count=4@four"), parse_algorithm("capsule")});
  ASSERT_EQ(found.rows.size(), 4u);
  EXPECT_EQ(found.rows[0].label, "four");
  EXPECT_EQ(found.rows[1].mesh, "ring");
  EXPECT_EQ(found.rows[3].kind, "capsule");
  EXPECT_EQ(found.rows[3].balls.size(), 2u);
  EXPECT_EQ(found.rows[3].parts, 1u);
  for (const MeshProxy& row : found.rows) EXPECT_EQ(row.outside_share, 0) << row.label << ' ' << row.mesh;
}

TEST(Proxies, OfSolidsAreParted) {
  const MeshProxy ring = made("hulls:count=6").rows.at(1);
  ASSERT_EQ(ring.parts, 6u);
  ASSERT_EQ(ring.solid_offset.size(), 7u);
  const std::vector<geometry::Mesh> solids = solids_of(ring);
  ASSERT_EQ(solids.size(), 6u);
  std::size_t vertices = 0;
  for (const geometry::Mesh& solid : solids) {
    EXPECT_TRUE(geometry::is_closed(solid));
    vertices += solid.vertices.size();
  }
  EXPECT_EQ(vertices, ring.vertices.size());
}

TEST(Proxies, OfALabelBindItsRowAgain) {
  Proxies recorded = made("hulls:count=6@mine");
  AlgorithmChoice choice = parse_algorithm("proxy@mine");
  ASSERT_TRUE(bind_recorded(choice, recorded));
  const Proxies again = proxies_of(two_meshes(), {choice});
  ASSERT_EQ(again.rows.size(), 2u);
  EXPECT_EQ(again.rows[1].triangles, recorded.rows[1].triangles);
  EXPECT_EQ(again.rows[1].solid_offset, recorded.rows[1].solid_offset);
  AlgorithmChoice other = parse_algorithm("proxy@other");
  EXPECT_FALSE(bind_recorded(other, recorded));
}

TEST(Proxies, AreWrittenAsMeshesThatReadBack) {
  const MeshProxy hulls = made("hulls:count=6").rows.at(1);
  const geometry::Mesh back = read_back(hulls);
  EXPECT_EQ(back.vertices, hulls.vertices);
  EXPECT_EQ(back.triangles, hulls.triangles);
  EXPECT_EQ(algorithms::closed_components(back, 0).size(), 6u) << "each with vertices of its own";
}

// Balls become meshes whose corners are on them.
TEST(Proxies, OfBallsAndCapsulesAreWrittenAsSurfaces) {
  for (const std::string argument : {"spheres:count=4", "capsule"}) {
    const MeshProxy row = made(argument).rows.at(1);
    const geometry::Mesh back = read_back(row);
    EXPECT_TRUE(geometry::solid_of(back, 0).closed) << argument;
    for (const geometry::Vec3& v : back.vertices) {
      double least = 1e9;
      for (const geometry::ContactBall& ball : row.balls)
        least = std::min(least, std::fabs((v - ball.centre).norm() - ball.radius));
      ASSERT_LT(least, 1e-12) << argument;
    }
  }
}

TEST(Proxies, FilesAreReadFromATableOrAText) {
  const std::string head = "[scene]\nkind = 'falling'\n[[algorithm]]\nname = 'proxy'\n";
  for (const std::string file : {"{a = 'x.obj', b = 'y.obj'}", "'a=x.obj;b=y.obj'"}) {
    const Config config = parse_config(head + "file = " + file + "\n", "c.toml");
    const AlgorithmChoice& choice = config.algorithms.at(0);
    ASSERT_EQ(choice.files.size(), 2u);
    EXPECT_EQ(choice.files[1].mesh, "b");
    EXPECT_EQ(choice.files[1].written, "y.obj");
    EXPECT_EQ(std::get<std::string>(choice.knobs.at("file")), "a=x.obj;b=y.obj");
    EXPECT_EQ(choice.place, "c.toml:5:8");
    EXPECT_NE(config.effective.find("file = \"a=x.obj;b=y.obj\"\n"), std::string::npos);
  }
}

TEST(Proxies, FilesThatAreNoneAreRefused) {
  const std::string head = "[scene]\nkind = 'falling'\n[[algorithm]]\nname = 'proxy'\nfile = ";
  for (const std::string file : {"'x.obj'", "'=x.obj'", "'a='", "{a = ''}", "{a = 'x;y.obj'}", "'a=x.obj;a=y.obj'",
                                 "{'a b' = 'x.obj'}", "3", "[]", "{}"}) {
    EXPECT_EQ(tests::refusal_of([&] { parse_config(head + file + "\n", "c.toml"); }).rfind("c.toml:5:", 0), 0u) << file;
  }
}

}  // namespace
}  // namespace pipeline
