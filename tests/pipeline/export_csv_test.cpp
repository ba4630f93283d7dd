#include "pipeline/commands/export_csv.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "geometry/meshes/mesh_file.hpp"
#include "pipeline/scene/poses_csv.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"

using namespace pipeline;

namespace {

/// Doubles that short texts would spoil, and the least and greatest that a mesh file takes.
constexpr double kHard[] = {0.1, 1.0 / 3, 6.02214076e14, -2.2250738585072014e-308, 4.9406564584124654e-324, -0.0};

Result three() {
  Result result;
  geometry::Mesh mesh;
  mesh.name = "odd";
  mesh.vertices = {{kHard[0], kHard[1], kHard[2]}, {kHard[3], kHard[4], kHard[5]}, {1, 2, 3}, {4, 5, 7}};
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  result.bodies.meshes = {mesh};
  result.bodies.name = {"hero", "late", "wall"};
  result.bodies.mesh = {0, 0, 0};
  result.bodies.fixed = {0, 0, 1};
  result.first_step = {0, 1, 0};
  result.motion.assign(2, std::vector<geometry::Pose>(3));
  result.motion[0][1] = geometry::unborn();
  result.motion[1][0].t = {kHard[1], kHard[2], -kHard[0]};
  result.motion[1][0].q = geometry::normalised({0.1, 0.7, -0.3, 0.9});
  return result;
}

}  // namespace

TEST(ExportCsv, MeshesReadBackAsTheSameDoublesInTheSameOrder) {
  const geometry::Mesh mesh = three().bodies.meshes[0];
  const geometry::Mesh back = geometry::parse_mesh(obj_text(mesh), "odd.obj", "odd");
  ASSERT_EQ(back.vertices.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_EQ(back.vertices[v], mesh.vertices[v]);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(std::signbit(back.vertices[v][axis]), std::signbit(mesh.vertices[v][axis]));
  }
  EXPECT_EQ(back.triangles, mesh.triangles);
}

TEST(ExportCsv, PosesReadBackAsAReplayTakesThem) {
  const Result result = three();
  const CsvMotion motion =
      parse_poses(poses_text(result), "poses.csv", {{"hero"}, {"late"}, {"wall", CsvBody::first_step}});
  const auto back = poses_of(motion, motion.steps);
  ASSERT_EQ(back.size(), 2u);
  EXPECT_FALSE(geometry::is_born(back[0][1]));
  for (std::size_t step = 0; step < 2; ++step)
    for (std::size_t body = 0; body < 3; ++body) {
      const geometry::Pose &was = result.motion[step][body], &is = back[step][body];
      if (!geometry::is_born(was)) continue;
      EXPECT_EQ(is.t, was.t);
      EXPECT_TRUE(is.q.w == was.q.w && is.q.x == was.q.x && is.q.y == was.q.y && is.q.z == was.q.z);
    }
}

TEST(ExportCsv, TellsOfEveryBody) {
  Result result = three();
  EXPECT_EQ(bodies_text(result),
            "number,body,mesh,fixed,chosen,first_step\n0,hero,odd,0,1,0\n1,late,odd,0,1,1\n2,wall,odd,1,1,0\n");
  result.bodies.chosen = {1, 0, 0};
  EXPECT_EQ(bodies_text(result),
            "number,body,mesh,fixed,chosen,first_step\n0,hero,odd,0,1,0\n1,late,odd,0,0,1\n2,wall,odd,1,0,0\n");
}

TEST(ExportCsv, RefusesNamesThatWouldBreakTheFiles) {
  for (const char* name : {"a,b", "a\nb", "..", "a/b", ""}) {
    Result result = three();
    result.bodies.name[1] = name;
    const std::string line = tests::refusal_of([&] { write_csv(result, {"/nonexistent/folder"}); }, kFile);
    EXPECT_NE(line.find("cannot stand in CSV"), std::string::npos) << name;
  }
}
