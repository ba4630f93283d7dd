#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "pipeline/config.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace pipeline;
using geometry::Vec3;

namespace {

const std::string kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string kPoses =
    "step,body,px,py,pz,qw,qx,qy,qz\n0,hero,0,0,0,1,0,0,0\n1,hero,1,0,0,1,0,0,0\n2,hero,2,0,0,1,0,0,0\n";
const std::string kScene = "[scene]\nkind = \"replay\"\nposes = \"poses.csv\"\n";
const std::string kHero = "[[scene.body]]\nname = \"hero\"\nmesh = \"hero.obj\"\n";
const std::string kWall =
    "[[scene.body]]\nname = \"wall\"\nshape = \"box\"\nsize = [1, 2, 3]\nfixed = true\nposition = [5, 0, 0]\n";

class Replay : public testing::Test {
 protected:
  void SetUp() override {
    write("hero.obj", kTetrahedron);
    write("poses.csv", kPoses);
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  Config config(const std::string& text, const std::vector<std::string>& sets = {}) const {
    write("c.toml", text);
    return read_config(folder_ / "c.toml", sets);
  }
  std::string error_of(const std::string& text, const std::vector<std::string>& sets = {}) const {
    std::string line = tests::refusal_of([&] { config(text, sets); });
    const std::string path = (folder_ / "").string();  // of the machine that tests
    for (std::size_t at; (at = line.find(path)) != std::string::npos;) line.erase(at, path.size());
    return line;
  }

  TemporaryFolder folder_;
};

}  // namespace

TEST_F(Replay, MakesBodiesAndPosesOfTheFiles) {
  const Config c = config(kScene + kHero + kWall);
  EXPECT_EQ(c.steps, 3);
  EXPECT_EQ(c.rate, 60);
  const Scene scene = c.scene_kind->make(c);
  EXPECT_EQ(scene.bodies.name, (std::vector<std::string>{"hero", "wall"}));
  EXPECT_EQ(scene.bodies.fixed, (std::vector<std::uint8_t>{0, 1}));
  EXPECT_TRUE(scene.bodies.chosen.empty());
  EXPECT_EQ(scene.bodies.mesh_of(0).vertices[3], Vec3(0, 0, 1));
  EXPECT_EQ(scene.bodies.mesh_of(0).shape, "{\"file\": \"hero.obj\"}");
  ASSERT_EQ(scene.script.size(), 3u);
  EXPECT_EQ(scene.script[2][0].t, Vec3(2, 0, 0));
  EXPECT_EQ(scene.script[2][1].t, Vec3(5, 0, 0));
  const SceneSize size = c.scene_kind->size(c);
  EXPECT_EQ(size.bodies, 2u);
  EXPECT_EQ(size.mesh_triangles, 4u + 12u);
  EXPECT_EQ(size.body_vertices, 4u + 8u);
  EXPECT_EQ(c.inputs.size(), 2u);
  EXPECT_TRUE(c.notes.empty());
}

TEST_F(Replay, FewerStepsMayBeAskedForAndMoreNot) {
  const Config c = config("steps = 2\n" + kScene + kHero);
  EXPECT_EQ(c.scene_kind->make(c).script.size(), 2u);
  EXPECT_EQ(error_of("steps = 4\n" + kScene + kHero),
            "c.toml:1:9: 'steps' must be at most 3, the steps of poses.csv, not 4");
  EXPECT_EQ(error_of(kScene + kHero, {"steps=4"}),
            "--set steps=4: 'steps' must be at most 3, the steps of poses.csv, not 4");
}

TEST_F(Replay, IsRefusedWhenAFileWasChangedSinceItWasRead) {
  const Config c = config(kScene + kHero);
  c.scene_kind->make(c);
  write("poses.csv", kPoses + "3,hero,3,0,0,1,0,0,0\n");
  const std::string line = tests::refusal_of([&] { c.scene_kind->make(c); });
  EXPECT_NE(line.find("poses.csv: was changed since the configuration was read; run again"), std::string::npos) << line;
}

TEST_F(Replay, BirthsThatFewerStepsLeaveOutAreSaid) {
  write("poses.csv", kPoses + "2,late,2,5,0,1,0,0,0\n");
  std::string late = kHero;
  late.replace(late.find("hero"), 4, "late");
  EXPECT_NE(left_out(config("steps = 2\n" + kScene + kHero + late)).find("2 steps leave out 1 of 2 births (step 2)"),
            std::string::npos);
  EXPECT_EQ(left_out(config(kScene + kHero + late)), "");
}

TEST_F(Replay, OnlyChoosesBodies) {
  const Config c = config(kScene + "only = [\"wall\"]\n" + kHero + kWall);
  EXPECT_EQ(c.scene_kind->make(c).bodies.chosen, (std::vector<std::uint8_t>{0, 1}));
}

TEST_F(Replay, BodiesOfOneFileOrShapeShareAMesh) {
  write("poses.csv", kPoses + "");
  const std::string second =
      "[[scene.body]]\nname = \"twin\"\nmesh = \"hero.obj\"\nfixed = true\nposition = [1, 2, 3]\n"
      "orientation = [0, 1, 0, 0]\n";
  std::string other = kWall;
  other.replace(other.find("wall"), 4, "gate");
  const Config c = config(kScene + kHero + second + kWall + other);
  const Scene scene = c.scene_kind->make(c);
  EXPECT_EQ(scene.bodies.meshes.size(), 2u);
  EXPECT_EQ(scene.bodies.mesh, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  EXPECT_EQ(scene.bodies.meshes[1].name, "wall");
  EXPECT_EQ(scene.script[1][1].q.x, 1);
}

TEST_F(Replay, ABodyMayHaveAFileOfItsOwn) {
  write("late.txt", "# time tx ty tz qx qy qz qw\n10 0 5 0 0 0 0 1\n10.1 1 5 0 0 0 0 1\n10.2 2 5 0 0 0 0 1\n");
  std::string late = kHero;
  late.replace(late.find("hero"), 4, "late");
  const Config c = config(kScene + kHero + late + "poses = \"late.txt\"\n");
  const Scene scene = make_scene(c);
  ASSERT_EQ(scene.script.size(), 3u);
  EXPECT_EQ(scene.script[2][0].t, Vec3(2, 0, 0));
  EXPECT_EQ(scene.script[2][1].t, Vec3(2, 5, 0));
  EXPECT_NEAR(c.rate, 10, 1e-12);
  ASSERT_EQ(c.understood.size(), 2u);
  EXPECT_NE(c.understood[0].find("late.txt: time in s, position in m (tx, ty, tz)"), std::string::npos);
  EXPECT_EQ(c.inputs.count("late.txt"), 1u);
  EXPECT_EQ(parse_config(c.effective, "x").effective, c.effective);
  // No file for all is needed where every moving body has one.
  const Config own = config("rate = 25\n[scene]\nkind = \"replay\"\n" + late + "poses = \"late.txt\"\n" + kWall);
  EXPECT_EQ(own.steps, 3);
  EXPECT_EQ(own.rate, 25);
  EXPECT_EQ(error_of("[scene]\nkind = \"replay\"\n" + kHero + late + "poses = \"late.txt\"\n")
                .find("c.toml:1:1: missing key 'scene.poses'"),
            0u);
  EXPECT_NE(error_of(kScene + kHero + kWall + "poses = \"late.txt\"\n")
                .find("'scene.body.1.poses' must be given for moving bodies only"),
            std::string::npos);
  write("poses.csv", kPoses + "0,late,0,0,0,1,0,0,0\n");
  EXPECT_NE(error_of(kScene + kHero + late + "poses = \"late.txt\"\n").find("steps do not go back"), std::string::npos);
  write("poses.csv", kPoses + "3,hero,2,0,0,1,0,0,0\n");
  EXPECT_NE(
      error_of(kScene + kHero + late + "poses = \"late.txt\"\n").find("late.txt: has 3 steps, the poses before it 4"),
      std::string::npos);
}

TEST_F(Replay, AnglesAndToleranceAreKeys) {
  write("poses.csv", "step,body,px,py,pz,rx_deg,ry_deg,rz_deg\n0,hero,0,0,0,0,0,90\n");
  const Config c = config(kScene + "euler = \"ZYX\"\n" + kHero);
  EXPECT_NEAR(make_scene(c).script[0][0].q.z, std::sqrt(0.5), 1e-15);
  EXPECT_NE(c.effective.find("euler = \"ZYX\""), std::string::npos);
  EXPECT_NE(
      error_of(kScene + "euler = \"zyX\"\n" + kHero).find("c.toml:4:9: 'scene.euler' must be the order of three axes"),
      std::string::npos);
  write("poses.csv", "step,body,px,py,pz,qw,qx,qy,qz\n0,hero,0,0,0,1.0001,0,0,0\n");
  EXPECT_NE(error_of(kScene + kHero).find("poses.csv:2: the quaternion must be of length 1 within 1e-6, not 1.0001"),
            std::string::npos);
  EXPECT_NE(config(kScene + "quaternion_tolerance = 1e-3\n" + kHero).effective.find("quaternion_tolerance = 0.001\n"),
            std::string::npos);
}

// A result's own configuration is read when its files may be gone.
TEST_F(Replay, ItsEffectiveConfigurationIsReadWithoutItsFiles) {
  const Config c = config(kScene + "only = [\"hero\"]\n" + kHero + kWall);
  EXPECT_NE(c.effective.find("steps = 3\n"), std::string::npos);
  std::filesystem::remove(folder_ / "hero.obj");
  std::filesystem::remove(folder_ / "poses.csv");
  const Config again = parse_config(c.effective, "x.h5:/config@effective");
  EXPECT_EQ(again.effective, c.effective);
  EXPECT_EQ(again.steps, 3);
}

TEST_F(Replay, AChangedFileChangesTheInputs) {
  const Config before = config(kScene + kHero);
  write("poses.csv", kPoses + "3,hero,3,0,0,1,0,0,0\n");
  const Config after = config(kScene + kHero);
  EXPECT_NE(before.inputs.at("poses.csv"), after.inputs.at("poses.csv"));
  EXPECT_EQ(before.inputs.at("hero.obj"), after.inputs.at("hero.obj"));
}

TEST_F(Replay, OpenAndDegenerateMeshesAreUsedAndSaid) {
  write("hero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n");
  const Config c = config(kScene + kHero);
  ASSERT_EQ(c.notes.size(), 2u);
  EXPECT_NE(c.notes[0].find("hero.obj: the surface is open"), std::string::npos);
  EXPECT_NE(c.notes[1].find("hero.obj: 1 triangle has no area"), std::string::npos);
  EXPECT_EQ(error_of(kScene + kHero + "[truth]\ncontainment = \"meet\"\n")
                .find("c.toml:6:8: 'scene.body.0.mesh' of body 'hero': mesh 'hero' is open, the edge from ("),
            0u);
}

// One open body takes nothing from the others: it is named once, with its edge and the width.
TEST_F(Replay, AnOpenMeshIsNamedOnceWhereContainmentCounts) {
  write("hero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\n");
  const Config c = config(kScene + kHero + kWall + "[truth]\ncontainment = \"meet\"\n");
  ASSERT_EQ(c.notes.size(), 1u);
  EXPECT_NE(c.notes[0].find("hero.obj: the surface is open, the edge from (0, 0, 0) to (1, 0, 0) belongs to 1 facet, "
                            "also with corners within 9.54e-07 m taken as one; it is used as it is, and "
                            "nothing can be inside it"),
            std::string::npos)
      << c.notes[0];
}

TEST_F(Replay, HairsCloseAndTheWidthCanBeTurnedOff) {
  const std::string closed = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1e-12 0 0\nf 5 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  write("hero.obj", closed);
  const std::string record = "[truth]\ncontainment = \"record\"\n";
  EXPECT_TRUE(config(kScene + kHero + record).notes.empty());
  EXPECT_EQ(make_scene(config(kScene + kHero + record + "closed_within = 1e-9\n")).bodies.closed_within, 1e-9);
  EXPECT_NE(error_of(kScene + kHero + record + "closed_within = 0\n").find("corners being one where their"),
            std::string::npos);
}

TEST_F(Replay, HollowMeshesAreSaidWhereContainmentCounts) {
  const std::string once = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  write("hero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" + once + once);
  EXPECT_TRUE(config(kScene + kHero).notes.empty());
  const Config c = config(kScene + kHero + "[truth]\ncontainment = \"record\"\n");
  ASSERT_EQ(c.notes.size(), 1u);
  EXPECT_EQ(c.notes[0].substr(c.notes[0].find("hero.obj")),
            "hero.obj: 4 facets stand where another stands already; what lies in two shells counts as outside");
}

TEST_F(Replay, RefusesWhatTheUserWrote) {
  write("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n");
  const auto body = [](const std::string& keys) { return "[[scene.body]]\nname = \"b\"\n" + keys; };
  const std::pair<std::string, std::string> cases[] = {
      {"[scene]\nkind = \"replay\"\n", "c.toml:1:1: missing key 'scene.poses', a CSV file; or 'motion'"},
      {kScene, "c.toml:1:1: missing [[scene.body]]"},
      {"[scene]\nkind = \"replay\"\nmotion = \"a.h5\"\nposes = \"poses.csv\"\n",
       "c.toml:4:9: 'scene.poses' must be absent where 'motion' is given, not \"poses.csv\""},
      {"[scene]\nkind = \"replay\"\nmotion = \"a.h5\"\nhalf_turns = true\n",
       "c.toml:4:14: 'scene.half_turns' must be absent where 'motion' is given, not true"},
      {"[scene]\nkind = \"replay\"\nmotion = \"a.h5\"\n",
       "c.toml:3:10: 'scene.motion' must name a file that can be read, not \"a.h5\": a.h5: cannot be read (No such "
       "file"},
      {kScene + body("mesh = \"none.obj\"\n"),
       "c.toml:6:8: 'scene.body.0.mesh' must name a file that can be read, not \"none.obj\": none.obj: cannot be read "
       "(No such file"},
      {kScene + body("mesh = \".\"\n"),
       "c.toml:6:8: 'scene.body.0.mesh' must name a file that can be read, not \".\": .: is a folder"},
      {kScene + body("mesh = \"far.obj\"\n"), "far.obj:4: index 7 is out of range"},
      {kScene + body("mesh = \"hero.obj\"\nshape = \"box\"\n"),
       "c.toml:7:9: 'scene.body.0.shape' must be absent where 'mesh' is given"},
      {kScene + body(""), "c.toml:4:1: missing key 'scene.body.0.mesh', or 'shape'"},
      {kScene + body("mesh = \"hero.obj\"\nmas = 3\n"), "c.toml:7:1: unknown key 'scene.body.0.mas'"},
      {kScene + body("shape = \"box\"\nsize = [1, 0, 1]\n"), "c.toml:7:12: 'scene.body.0.size.1' must be"},
      {kScene + body("mesh = \"hero.obj\"\nposition = [0, 0, 0]\n"),
       "c.toml:7:12: 'scene.body.0.position' must be given for fixed bodies only"},
      {kScene + body("mesh = \"hero.obj\"\nfixed = true\norientation = [1, 0, 0, 0]\n"),
       "c.toml:4:1: missing key 'scene.body.0.position'"},
      {kScene + body("mesh = \"hero.obj\"\nfixed = true\nposition = [0, 0, 0]\norientation = [1, 0, 0, 0.01]\n"),
       "c.toml:9:15: 'scene.body.0.orientation' must be a quaternion"},
      {kScene + body("mesh = \"hero.obj\"\nfixed = 1\n"), "c.toml:7:9: 'scene.body.0.fixed' must be true or false"},
      {kScene + "[[scene.body]]\nname = \"a b\"\nmesh = \"hero.obj\"\n",
       "c.toml:5:8: 'scene.body.0.name' must be 1 to 64 characters"},
      {kScene + kHero + kHero, "c.toml:8:8: 'scene.body.1.name' must be the only one of its name"},
      {kScene + "only = [\"heroo\"]\n" + kHero,
       "c.toml:4:8: 'scene.only' must hold names of bodies, not [\"heroo\"]; did you mean 'hero'?"},
      {kScene + "only = []\n" + kHero, "c.toml:4:8: 'scene.only' must name at least one body"},
      {kScene + body("mesh = \"hero.obj\"\n"), "poses.csv:2: there is no body \"hero\" in the configuration"},
      {kScene + kHero + "[physics]\n", "c.toml:7:1: 'physics' is not for this kind of scene"},
  };
  for (const auto& [text, message] : cases) {
    const std::string got = error_of(text);
    EXPECT_EQ(got.substr(0, message.size()), message);
    EXPECT_EQ(got.find('\n'), std::string::npos);
  }
}
