#include "pipeline/plan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/config.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/trial.hpp"

namespace {

using pipeline::Config;
using pipeline::parse_config;

Config falling(std::int64_t steps) {
  return parse_config(
      "steps = " + std::to_string(steps) +
          "\n[scene]\nkind = \"falling\"\nsegments = 6\nshift = 0\n[[scene.set]]\nlying = [1, 1]\nabove = [2, 3, 2]\n"
          "height = 13\n[[scene.set]]\nlying = [0, 0]\nabove = [1, 1, 1]\nheight = 41\n"
          "[physics]\nlinear_damping = 0\n",
      "made.toml");
}

// From 13 m onto a sphere whose middle is at 1 m: 10 m; from 41 m onto the plate: 40 m. At 60 a second
// 60 sqrt(2 h / 9.81) is 85.7 and 171.3.
TEST(LeftOut, NamesTheLandingsOfTheFallingScene) {
  EXPECT_EQ(pipeline::left_out(falling(60)),
            "made.toml: 60 steps leave out the landing of set 1, 12 spheres (step 86), the landing of set 2, 1 sphere "
            "(step 172): what remains is another scene");
  EXPECT_NE(pipeline::left_out(falling(86)).find("set 1"), std::string::npos);
  EXPECT_EQ(pipeline::left_out(falling(87)).find("set 1"), std::string::npos);
  EXPECT_EQ(pipeline::left_out(falling(173)), "");
}

// With damping c a body falls g / c (t - (1 - exp(-c t)) / c): of 10 m at c = 0.5 it takes 1.5579 s, found by hand.
TEST(LeftOut, CountsDamping) {
  Config config = falling(60);
  config.physics.linear_damping = 0.5;
  const double t =
      pipeline::left_out(config).find("(step ") == std::string::npos
          ? 0
          : std::stod(pipeline::left_out(config).substr(pipeline::left_out(config).find("(step ") + 6)) / 60;
  const double c = 0.5, fallen = 9.81 / c * (t - (1 - std::exp(-c * t)) / c);
  EXPECT_NEAR(fallen, 10, 9.81 * 1.5 / 60);  // within a step
  EXPECT_GE(fallen, 10);
}

TEST(LeftOut, CountsBirthsAndTheFirstPush) {
  const auto cube = [](std::int64_t steps) {
    return parse_config(
        "steps = " + std::to_string(steps) +
            "\n[scene]\nkind = \"box\"\n[scene.births]\ncount = 10\nevery = 4\n[scene.push]\nfrom = 50\n",
        "made.toml");
  };
  EXPECT_EQ(pipeline::left_out(cube(20)),
            "made.toml: 20 steps leave out 5 of 10 births (step 20 to 36), the first push (step 50): what remains is "
            "another scene");
  EXPECT_EQ(pipeline::left_out(cube(51)), "");
}

TEST(LeftOut, CountsPasses) {
  const auto playground = [](const std::string& steps) {
    return parse_config(steps + "[scene]\nkind = \"playground\"\n", "made.toml");
  };
  const Config whole = playground("");
  EXPECT_EQ(pipeline::left_out(whole), "");
  const std::string left = pipeline::left_out(playground("steps = 1\n"));
  EXPECT_NE(left.find("132 of 132 passes"), std::string::npos) << left;
}

// The plan counts what a method samples: cubes of 600 m need 8 facets a square metre.
TEST(Plan, CountsWhatMethodsTake) {
  const Config config = parse_config(
      "steps = 2\n[scene]\nkind = \"playground\"\nstep = 1000\n[scene.hero]\nshape = \"box\"\nsize = [600, 600, 600]\n"
      "[[scene.obstacle]]\nname = \"cube\"\nshape = \"box\"\nsize = [600, 600, 600]\n"
      "[[algorithm]]\nname = \"facet_distance\"\n",
      "made.toml");
  const pipeline::Scene scene = config.scene_kind->make(config);
  const pipeline::Plan plan = pipeline::plan(config, scene, 1);
  ASSERT_EQ(plan.labels.size(), 1u);
  EXPECT_GT(plan.memory_bytes, std::uint64_t{1} << 30);
  EXPECT_GT(plan.labels[0].memory.greatest, plan.memory_bytes / 2);
  // Recorded rates stand for what would take long to try.
  double seconds = 0;
  for (const pipeline::Stage& stage : pipeline::foreseen_stages(config, scene, plan, 1, 0.1))
    seconds += stage.seconds();
  EXPECT_GT(seconds, 1);
  EXPECT_LT(seconds, 100);
}

// A stage of a forecast has an entry for every item, and the motion of the falling scene is foreseen to be livelier
// when all has landed.
TEST(Trial, ForeseesALivelyHalf) {
  const Config config = falling(400);
  const pipeline::Scene scene = config.scene_kind->make(config);
  const auto stages = pipeline::foreseen_stages(config, scene, pipeline::plan(config, scene, 1), 1, 0.3);
  ASSERT_EQ(stages.size(), 4u);
  const std::vector<double>& motion = stages[0].until;
  ASSERT_EQ(motion.size(), 401u);
  EXPECT_GT(motion[150] - motion[100], motion[70] - motion[20]);
}

}  // namespace
