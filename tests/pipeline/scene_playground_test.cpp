#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "pipeline/config.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/passes.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/scene_size.hpp"

using namespace pipeline;
using geometry::Vec3;

namespace {

const std::string kScene = "[scene]\nkind = \"playground\"\n";

Config playground(const std::string& keys = "", const std::string& root = "") {
  return parse_config(root + kScene + keys, "t.toml");
}

Scene made(const Config& config) { return config.scene_kind->make(config); }

std::string refusal(const std::string& keys, const std::string& root = "") {
  return tests::refusal_of([&] { playground(keys, root); });
}

std::uint32_t body(const Scene& scene, const std::string& name) {
  return std::uint32_t(std::ranges::find(scene.bodies.name, name) - scene.bodies.name.begin());
}

Vec3 turned(const geometry::Quaternion& q, const Vec3& v) { return geometry::rotation(q) * v; }

const std::string kBall =
    "[scene.hero]\nshape = 'sphere'\nradius = 1\nsegments = 6\n"
    "[[scene.obstacle]]\nname = 'ball'\nshape = 'sphere'\nradius = 2\nsegments = 6\n"
    "[[scene.obstacle]]\nname = 'cube'\nshape = 'box'\nsize = [2, 2, 2]\n";

}  // namespace

TEST(Playground, HasTheThesissObstaclesAndOnlyPairsWithTheHeroCount) {
  const Scene scene = made(playground());
  EXPECT_EQ(scene.bodies.name,
            (std::vector<std::string>{"hero", "slab", "slab_45_xz", "slab_90_xz", "slab_45_y", "torus", "torus_45_x",
                                      "torus_90_x", "sphere", "capsule", "torus_knot", "cube"}));
  EXPECT_EQ(scene.bodies.meshes.size(), 7u);  // slabs and rings share theirs
  EXPECT_EQ(scene.bodies.mesh_of(0).shape,
            R"({"kind":"capsule","height":3,"radius_bottom":0.6,"radius_top":0.6,"segments":8})");
  EXPECT_EQ(geometry::half_extents(scene.bodies.mesh_of(body(scene, "slab_45_y"))), Vec3(3, 3, 0.5));
  EXPECT_EQ(geometry::half_extents(scene.bodies.mesh_of(body(scene, "cube"))), Vec3(3.5, 3.5, 3.5));

  const auto runs = geometry::pair_runs(scene.bodies, scene.script[0]);
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].a, 0u);
  EXPECT_EQ(geometry::pair_count(runs), 11u);
}

TEST(Playground, ObstaclesAreTurnedAsTheThesissAre) {
  const Scene scene = made(playground());
  const auto turn = [&](const char* name, const Vec3& v) { return turned(scene.script[0][body(scene, name)].q, v); };
  const double h = std::sqrt(0.5);
  const auto expect_near = [](const Vec3& a, const Vec3& b) { EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-15) << a; };
  expect_near(turn("slab", {1, 0, 0}), {1, 0, 0});
  expect_near(turn("slab_45_xz", {1, 0, 0}), {h, 0.5, 0.5});  // about z: (h, h, 0), then about x
  expect_near(turn("slab_45_xz", {0, 0, 1}), {0, -h, h});
  expect_near(turn("slab_90_xz", {1, 0, 0}), {0, 0, 1});
  expect_near(turn("slab_90_xz", {0, 0, 1}), {0, -1, 0});
  expect_near(turn("slab_45_y", {1, 0, 0}), {h, 0, -h});
  expect_near(turn("torus_45_x", {0, 1, 0}), {0, h, h});
  expect_near(turn("torus_90_x", {0, 1, 0}), {0, 0, 1});
}

TEST(Playground, TwelvePassesThroughEachObstacle) {
  const Scene scene = made(playground());
  ASSERT_EQ(scene.passes.size(), 132u);
  // |(0.6, 1.5, 0.6)|, the hero, and |(3, 3, 0.5)|, the slab.
  const double reach = std::sqrt(2.97) + std::sqrt(18.25) + 1;
  const auto expect_pass = [&](std::size_t p, int axis, double offset, int lies_along) {
    const Pass& pass = scene.passes[p];
    EXPECT_EQ(scene.bodies.name[pass.target], "slab");
    EXPECT_EQ(pass.path, std::string(1, char('x' + axis)));
    EXPECT_EQ(pass.offset, offset);
    EXPECT_EQ(pass.orientation, lies_along == axis ? "along" : "across");
    Vec3 from = Vec3::Zero(), to = Vec3::Zero(), lies = Vec3::Zero();
    from[axis] = -reach;
    to[axis] = reach;
    from[(axis + 1) % 3] = to[(axis + 1) % 3] = offset;
    lies[lies_along] = 1;
    EXPECT_LT((pass.from - from).cwiseAbs().maxCoeff(), 1e-14) << p;
    EXPECT_LT((pass.to - to).cwiseAbs().maxCoeff(), 1e-14) << p;
    EXPECT_LT((turned(pass.q, {0, 1, 0}) - lies).cwiseAbs().maxCoeff(), 1e-15) << p;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 4; ++k) expect_pass(std::size_t(4 * axis + k), axis, k < 2 ? 0 : 1.7, (axis + (k % 2) * 2) % 3);
}

TEST(Playground, SamplesHaveEqualStepsAndBothEnds) {
  for (const char* keys : {"", "step = 0.1\n"}) {
    const Config config = playground(keys);
    const Scene scene = made(config);
    const double most = *keys ? 0.1 : 0.25;
    std::int64_t step = 0;
    for (const Pass& pass : scene.passes) {
      ASSERT_EQ(pass.first_step, step);
      step += pass.samples;
      const double each = length(pass) / double(pass.samples - 1);
      EXPECT_LE(each, most);
      for (std::int64_t i = 0; i < pass.samples; ++i) {
        const geometry::Pose& pose = scene.script[std::size_t(pass.first_step + i)][0];
        EXPECT_NEAR((pose.t - pass.from).norm(), each * double(i), 1e-12);
      }
      const auto last = std::size_t(pass.first_step + pass.samples - 1);
      EXPECT_EQ(scene.script[std::size_t(pass.first_step)][0].t, pass.from);
      EXPECT_LT((scene.script[last][0].t - pass.to).norm(), 1e-13);
    }
    EXPECT_EQ(config.steps, step);
    EXPECT_EQ(std::int64_t(scene.script.size()), step);
  }
}

// At every step, also for paths of the user's own that go far.
TEST(Playground, APassMeetsItsTargetAlone) {
  const std::string far = "[[scene.path]]\nfrom = [0, 40, 0]\nto = [3, -45, 2]\n";
  for (const std::string& keys : {std::string(), kBall + far, std::string("step = 2\n") + far}) {
    const Scene scene = made(playground(keys));
    const auto radius = [&](std::uint32_t b) { return geometry::half_extents(scene.bodies.mesh_of(b)).norm(); };
    std::size_t met = 0;
    for (const Pass& pass : scene.passes)
      for (std::int64_t i = 0; i < pass.samples; ++i) {
        const auto& poses = scene.script[std::size_t(pass.first_step + i)];
        for (std::uint32_t other = 1; other < scene.bodies.size(); ++other) {
          const bool touches = (poses[0].t - poses[other].t).norm() <= radius(0) + radius(other);
          if (other == pass.target)
            met += touches;
          else
            ASSERT_FALSE(touches) << scene.bodies.name[other] << " on the way to " << scene.bodies.name[pass.target];
        }
      }
    EXPECT_GT(met, 0u);
  }
}

TEST(Playground, StepsFollowFromThePathsAndMayBeFewer) {
  const std::int64_t all = playground().steps;
  EXPECT_EQ(playground("", "steps = " + std::to_string(all) + "\n").steps, all);
  const std::string message = refusal("", "steps = " + std::to_string(all + 1) + "\n");
  EXPECT_EQ(message, "t.toml:1:9: 'steps' must be an integer between 1 and " + std::to_string(all) + ", not " +
                         std::to_string(all + 1));

  // Only passes that are there from end to end are kept.
  const Scene whole = made(playground());
  const auto end = whole.passes[2].first_step + whole.passes[2].samples;
  EXPECT_EQ(made(playground("", "steps = " + std::to_string(end) + "\n")).passes.size(), 3u);
  const Scene cut = made(playground("", "steps = " + std::to_string(end - 1) + "\n"));
  EXPECT_EQ(cut.passes.size(), 2u);
  EXPECT_EQ(std::int64_t(cut.script.size()), end - 1);
}

TEST(Playground, TheEffectiveConfigurationGivesTheSameScene) {
  const std::string own =
      "[[scene.path]]\naxis = 'z'\noffset = -0.3\ntargets = ['ball']\nrotation = [['x', 30], ['y', -12.5]]\n"
      "[[scene.path]]\nname = 'up'\nfrom = [1, -9, 0]\nto = [1, 9, 0.5]\norientation = [0.6, 0, 0.8, 0]\n";
  for (const std::string& keys : {std::string(), kBall + own}) {
    const Config config = playground(keys);
    const Config again = parse_config(config.effective, "t.toml");
    EXPECT_EQ(again.effective, config.effective);
    const Scene a = made(config), b = made(again);
    EXPECT_EQ(a.bodies.name, b.bodies.name);
    ASSERT_EQ(a.script.size(), b.script.size());
    for (std::size_t s = 0; s < a.script.size(); ++s)
      for (std::size_t i = 0; i < a.script[s].size(); ++i) {
        ASSERT_EQ(a.script[s][i].t, b.script[s][i].t);
        ASSERT_EQ(a.script[s][i].q.x, b.script[s][i].q.x);
        ASSERT_EQ(a.script[s][i].q.w, b.script[s][i].q.w);
      }
  }
}

TEST(Playground, HristeIsTheThesissList) {
  const std::filesystem::path file = std::filesystem::path(TREE) / "configs/hriste.toml";
  const auto scene_of = [](const Config& config) {
    const std::size_t begin = config.effective.find("[scene]");
    return config.effective.substr(begin, config.effective.find("[truth]") - begin);
  };
  EXPECT_EQ(scene_of(read_config(file)), scene_of(playground("step = 0.1\n")));
}

TEST(Playground, PathsOfTheUsersOwn) {
  const Scene scene = made(playground(kBall + "[[scene.path]]\nname = 'up'\nfrom = [3, -8, 4]\nto = [3, 8, 4]\n"
                                              "rotation = [['z', 90]]\n"
                                              "[[scene.path]]\naxis = 'y'\ntargets = ['cube']\n"));
  ASSERT_EQ(scene.passes.size(), 3u);
  EXPECT_EQ(scene.bodies.name[scene.passes[0].target], "ball");
  EXPECT_EQ(scene.passes[0].path, "up");
  EXPECT_EQ(scene.passes[0].orientation, "given");
  EXPECT_DOUBLE_EQ(scene.passes[0].offset, 5);  // |(3, 4)|
  const Vec3 ball = scene.script[0][1].t;
  EXPECT_EQ(scene.passes[0].from, ball + Vec3(3, -8, 4));
  EXPECT_LT((turned(scene.passes[0].q, {1, 0, 0}) - Vec3(0, 1, 0)).norm(), 1e-15);
  EXPECT_EQ(scene.bodies.name[scene.passes[1].target], "cube");
  EXPECT_EQ(scene.passes[1].path, "up");
  EXPECT_EQ(scene.bodies.name[scene.passes[2].target], "cube");
  EXPECT_EQ(scene.passes[2].path, "y");
}

TEST(Playground, SizeIsKnownWithoutMakingIt) {
  for (const std::string& keys : {std::string(), kBall}) {
    const Config config = playground(keys);
    const SceneSize size = config.scene_kind->size(config);
    const Scene scene = made(config);
    tests::expect_size(size, scene);
    EXPECT_EQ(size.asked.at("passes"), scene.passes.size());
    EXPECT_EQ(size.pairs, geometry::pair_count(geometry::pair_runs(scene.bodies, scene.script[0])));
  }
}

TEST(Playground, BadKeysAreRefusedWithPlaceAndRule) {
  const auto refused = [](const std::string& keys, const std::string& place, const std::string& words) {
    const std::string message = refusal(keys);
    EXPECT_EQ(message.substr(0, place.size()), place) << keys;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  const std::string obstacle = "[[scene.obstacle]]\nname = 'a'\nshape = 'sphere'\n";  // lines 3 to 5
  const std::string path = "[[scene.path]]\n";                                        // line 3
  refused("step = 0\n", "t.toml:3:8: ", "'scene.step' must be a number of at least 0.001");
  refused("stepp = 1\n", "t.toml:3:1: ", "did you mean 'step'?");
  refused("step = 1e-3\n[scene.hero]\nshape = 'sphere'\nradius = 1e5\n", "t.toml:1:1: ", "at most 1e7 samples");
  refused("[scene.hero]\nshape = 'sphere'\nradius = 0\n", "t.toml:5:10: ", "must be a number of at least 1e-6");
  refused("[[scene.obstacle]]\nname = 'a'\nshape = 'box'\nsize = [1, 0, 1]\n", "t.toml:6:12: ", "at least 1e-6");
  refused("obstacle = []\n", "t.toml:3:12: ", "the thesis's eleven");
  refused("[[scene.obstacle]]\nshape = 'sphere'\nradius = 1\n", "t.toml:3:1: ", "missing key 'scene.obstacle.0.name'");
  refused(obstacle + "radius = 1\n" + obstacle + "radius = 1\n", "t.toml:8:8: ", "be the only one of its name");
  refused("[[scene.obstacle]]\nname = 'hero'\nshape = 'sphere'\nradius = 1\n", "t.toml:4:8: ", "the only one");
  refused("[[scene.obstacle]]\nname = 'a b'\nshape = 'sphere'\nradius = 1\n", "t.toml:4:8: ", "1 to 64 characters");
  // Would name a group of the file: /meshes/.
  refused("[[scene.obstacle]]\nname = '.'\nshape = 'sphere'\nradius = 1\n", "t.toml:4:8: ", "neither '.' nor '..'");
  refused(obstacle + "radius = 1\nrotation = [['w', 3]]\n", "t.toml:7:14: ", "be \"x\", \"y\" or \"z\"");
  refused(obstacle + "radius = 1\nrotation = [['x', nan]]\n", "t.toml:7:19: ", "a number of at least -360");
  refused(obstacle + "radius = 1\nrotation = ['x', 3]\n", "t.toml:7:13: ", "be [\"x\", \"y\" or \"z\", number]");
  refused(obstacle + "radius = 1\norientation = [1, 1, 0, 0]\n", "t.toml:7:15: ", "of length 1");
  refused(obstacle + "radius = 1\norientation = [1, 0, 0, 0]\nrotation = []\n", "t.toml:8:12: ", "be absent where");
  refused("path = []\n", "t.toml:3:8: ", "the thesis's twelve");
  refused(path + "axis = 'w'\n", "t.toml:4:8: ", "be \"x\", \"y\" or \"z\"");
  refused(path + "axis = 'x'\nto = [1, 2, 3]\n", "t.toml:5:1: ", "unknown key 'scene.path.0.to'");
  refused(path + "axis = 'x'\ntargets = ['nobody']\n", "t.toml:5:12: ", "\"slab\"");
  refused(path + "axis = 'x'\nhero = 'across'\nrotation = []\n", "t.toml:5:8: ", "be absent where a rotation");
  refused(path + "from = [1, 2, 3]\n", "t.toml:3:1: ", "missing key 'scene.path.0.to'");
  refused(path + "from = [1, 2, 3]\nto = [1, 2, 3]\n", "t.toml:5:6: ", "a path without steps");
  refused(path + "from = [-9e5, 0, 0]\nto = [9e5, 0, 0]\n", "t.toml:1:1: ", "at most 1e7 samples");
  refused("step = 1e5\n" + path + "from = [-9e5, 0, 0]\nto = [9e5, 0, 0]\n", "t.toml:1:1: ", "within 1e6 m");
  refused("\n[physics]\naccuracy = 1\n", "t.toml:4:1: ", "'physics' is not for this kind of scene");
}
