// Configurations: keys and defaults, --set, --algorithm, and the way back to TOML.
#include "pipeline/config.hpp"

#include <gtest/gtest.h>

#include <random>

#include "pipeline/scene/kinds/box.hpp"
#include "pipeline/scene/kinds/extremes.hpp"
#include "pipeline/scene/kinds/falling.hpp"
#include "pipeline/scene/kinds/playground.hpp"
#include "pipeline/scene/kinds/replay.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"
#include "tests/support/refusal.hpp"

namespace pipeline {
namespace {

const FallingScene& falling_of(const Config& config) { return config.keys<FallingScene>(); }

namespace fs = std::filesystem;

const std::string kScene = "[scene]\nkind = \"falling\"\n";

fs::path configs() { return fs::path(TREE) / "configs"; }

std::string error_in(const std::string& text, const std::vector<std::string>& sets = {}) {
  return tests::coded_refusal_of([&] { parse_config(text, "a/f.toml", sets); });
}

Config with(const std::vector<std::string>& sets) { return parse_config(kScene, "f.toml", sets); }

void expect_same_scene(const FallingScene& a, const FallingScene& b) {
  EXPECT_EQ(a.segments, b.segments);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_EQ(a.density, b.density);
  EXPECT_EQ(a.plate, b.plate);
  EXPECT_EQ(a.shift, b.shift);
  EXPECT_EQ(a.jitter, b.jitter);
  ASSERT_EQ(a.sets.size(), b.sets.size());
  for (std::size_t i = 0; i < a.sets.size(); ++i) {
    const FallingSet &s = a.sets[i], &t = b.sets[i];
    EXPECT_TRUE(s.lying == t.lying && s.above == t.above && s.corner == t.corner) << i;
    EXPECT_TRUE(s.spacing == t.spacing && s.height == t.height) << i;
  }
}

void expect_same_scene(const ReplayScene& a, const ReplayScene& b) {
  EXPECT_EQ(a.poses, b.poses);
  EXPECT_EQ(a.motion, b.motion);
  EXPECT_EQ(a.only, b.only);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const ReplayBody &s = a.bodies[i], &t = b.bodies[i];
    EXPECT_TRUE(s.name == t.name && s.mesh == t.mesh && s.shape.has_value() == t.shape.has_value()) << i;
    EXPECT_TRUE(s.fixed == t.fixed && s.position == t.position && s.orientation == t.orientation) << i;
  }
}

void expect_same_scene(const BoxScene& a, const BoxScene& b) {
  EXPECT_EQ(a.segments, b.segments);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_EQ(a.density, b.density);
  EXPECT_EQ(a.half_width, b.half_width);
  EXPECT_EQ(a.thickness, b.thickness);
  EXPECT_EQ(a.births.count, b.births.count);
  EXPECT_EQ(a.births.from, b.births.from);
  EXPECT_EQ(a.births.every, b.births.every);
  EXPECT_EQ(a.push.from, b.push.from);
  EXPECT_EQ(a.push.every, b.push.every);
  EXPECT_EQ(a.push.speed, b.push.speed);
  EXPECT_EQ(a.push.directions, b.push.directions);
}

std::string written(const Shape& shape) {
  TomlText out;
  write_shape(shape, out);
  return out.text;
}

void expect_same_turn(const geometry::Quaternion& a, const geometry::Quaternion& b) {
  EXPECT_TRUE(a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z);
}

void expect_same_scene(const PlaygroundScene& a, const PlaygroundScene& b) {
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(written(a.hero), written(b.hero));
  ASSERT_EQ(a.obstacles.size(), b.obstacles.size());
  for (std::size_t i = 0; i < a.obstacles.size(); ++i) {
    EXPECT_EQ(a.obstacles[i].name, b.obstacles[i].name);
    EXPECT_EQ(written(a.obstacles[i].shape), written(b.obstacles[i].shape));
    expect_same_turn(a.obstacles[i].orientation, b.obstacles[i].orientation);
  }
  ASSERT_EQ(a.paths.size(), b.paths.size());
  for (std::size_t i = 0; i < a.paths.size(); ++i) {
    const PlaygroundPath &p = a.paths[i], &q = b.paths[i];
    EXPECT_TRUE(p.name == q.name && p.targets == q.targets && p.axis == q.axis && p.offset == q.offset) << i;
    EXPECT_TRUE(p.from == q.from && p.to == q.to && p.hero == q.hero) << i;
    expect_same_turn(p.orientation, q.orientation);
  }
}

void expect_same_scene(const ExtremesScene& a, const ExtremesScene& b) {
  EXPECT_EQ(a.pairs, b.pairs);
  EXPECT_EQ(a.scales, b.scales);
  EXPECT_EQ(a.offsets, b.offsets);
  EXPECT_EQ(a.orientations, b.orientations);
}

void expect_same(const Config& a, const Config& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.rate, b.rate);
  ASSERT_EQ(a.scene_kind, b.scene_kind);
  const auto compare = [&]<class Keys>(const Keys*) {
    const Keys* keys = std::any_cast<Keys>(&a.scene);
    if (keys) expect_same_scene(*keys, b.keys<Keys>());
    return keys != nullptr;
  };
  EXPECT_TRUE(a.study || compare((FallingScene*)nullptr) || compare((BoxScene*)nullptr) ||
              compare((PlaygroundScene*)nullptr) || compare((ReplayScene*)nullptr) || compare((ExtremesScene*)nullptr));
  const Physics &p = a.physics, &q = b.physics;
  EXPECT_EQ(p.integrator, q.integrator);
  EXPECT_EQ(p.accuracy, q.accuracy);
  EXPECT_EQ(p.gravity, q.gravity);
  EXPECT_EQ(p.linear_damping, q.linear_damping);
  EXPECT_EQ(p.angular_damping, q.angular_damping);
  EXPECT_EQ(p.material.stiffness, q.material.stiffness);
  EXPECT_EQ(p.material.dissipation, q.material.dissipation);
  EXPECT_EQ(p.material.static_friction, q.material.static_friction);
  EXPECT_EQ(p.material.dynamic_friction, q.material.dynamic_friction);
  EXPECT_EQ(p.material.viscous_friction, q.material.viscous_friction);
  EXPECT_EQ(p.bodies, q.bodies);
  EXPECT_EQ(p.material.transition_velocity, q.material.transition_velocity);
  EXPECT_EQ(p.step_budget, q.step_budget);
  EXPECT_EQ(p.time_budget, q.time_budget);
  EXPECT_EQ(p.energy_bound, q.energy_bound);
  EXPECT_EQ(a.contact_radius, b.contact_radius);
  EXPECT_EQ(a.containment, b.containment);
  EXPECT_EQ(a.closed_within, b.closed_within);
  EXPECT_EQ(a.gap_margin, b.gap_margin);
  EXPECT_EQ(a.repeats, b.repeats);
  ASSERT_EQ(a.algorithms.size(), b.algorithms.size());
  for (std::size_t i = 0; i < a.algorithms.size(); ++i) {
    EXPECT_EQ(a.algorithms[i].name, b.algorithms[i].name);
    EXPECT_EQ(a.algorithms[i].label, b.algorithms[i].label);
    EXPECT_EQ(a.algorithms[i].knobs, b.algorithms[i].knobs);
  }
}

/// Reads what `config` is after defaults and expects the same again.
void expect_idempotent(const Config& config) {
  const Config again = parse_config(config.effective, "elsewhere.toml");
  expect_same(config, again);
  EXPECT_EQ(config.effective, again.effective);
}

TEST(Config, NeedsOnlyTheKindOfScene) {
  const Config c = parse_config(kScene, "configs/some.name.toml");
  EXPECT_EQ(c.path, "configs/some.name.toml");
  EXPECT_EQ(c.text, kScene);
  EXPECT_EQ(c.title, "some.name");
  EXPECT_EQ(c.seed, 1);
  EXPECT_EQ(c.steps, 600);
  EXPECT_EQ(c.rate, 60);
  EXPECT_EQ(c.repeats, 3);
  EXPECT_EQ(c.contact_radius, ContactRadius::inscribed);
  EXPECT_EQ(c.physics.linear_damping, 0.1);
  EXPECT_EQ(c.physics.angular_damping, 0.8);
  EXPECT_EQ(c.physics.material.stiffness, 1e8);
  expect_idempotent(c);
}

// 274 spheres: facts of the thesis, not of the code.
TEST(Config, WithoutSetsIsTheSceneOfTheThesis) {
  const Config c = parse_config(kScene, "f.toml");
  ASSERT_EQ(falling_of(c).sets.size(), 3u);
  std::int64_t spheres = 0;
  for (const FallingSet& s : falling_of(c).sets)
    spheres += s.lying[0] * s.lying[1] + s.above[0] * s.above[1] * s.above[2];
  EXPECT_EQ(spheres, 1 + 1 + 10 + 10 + 36 + 216);
  EXPECT_EQ(falling_of(c).sets[0].corner, (std::array<double, 2>{-14, -20}));
  EXPECT_EQ(falling_of(c).sets[1].spacing, 2.5);
  EXPECT_EQ(falling_of(c).sets[2].height, 75);
}

TEST(Config, WithoutAlgorithmsAsksThoseOfTheThesis) {
  const Config c = parse_config(kScene, "f.toml");
  std::vector<std::string> expected, got;
  for (const auto& a : algorithms::all())
    if (!a.thesis_key.empty()) expected.push_back(a.name);
  for (const auto& a : c.algorithms) {
    got.push_back(a.label);
    EXPECT_EQ(a.name, a.label);
    EXPECT_EQ(a.knobs, algorithms::presets(*algorithms::find(a.name)));
  }
  EXPECT_EQ(got, expected);
  EXPECT_FALSE(got.empty());
}

TEST(Config, ReadsEveryKey) {
  const Config c = parse_config(R"(
title = "Šest koulí"
seed = 9223372036854775807
steps = 10_000_000
rate = 1e6
[scene]
kind = 'falling'
segments = 1024
radius = 0.5
density = 7800.5
plate = [1, 2.5, 3]
shift = -0.25
jitter = 0.125
[[scene.set]]
lying = [2, 0]
above = [1, 2, 3]
corner = [-1.5, 4]
spacing = 1
height = 0x10
[[scene.set]]
[physics]
bodies = "tree"
integrator = "Verlet"
accuracy = 1e-9
gravity = [0, 0, -1.62]
linear_damping = 0
angular_damping = 2
stiffness = 5e6
dissipation = 0
static_friction = 0.9
dynamic_friction = 0.7
viscous_friction = 0.01
transition_velocity = 0.05
contact_radius = "nominal"
step_budget = 1
time_budget = 0
energy_bound = 1.5
[truth]
containment = "ignore"
closed_within = 1e-9
[timing]
repeats = 1000
[[algorithm]]
name = "facet_triangles"
label = "A-1+b_.c"
stride = 5
inflate = 2
triangles = "strip"
densify = true
[[algorithm]]
name = "obb_sat"
)",
                                "f.toml");
  EXPECT_EQ(c.title, "Šest koulí");
  EXPECT_EQ(c.seed, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(c.steps, 10000000);
  EXPECT_EQ(c.rate, 1e6);
  EXPECT_EQ(falling_of(c).segments, 1024);
  EXPECT_EQ(falling_of(c).radius, 0.5);
  EXPECT_EQ(falling_of(c).density, 7800.5);
  EXPECT_EQ(falling_of(c).plate, (std::array<double, 3>{1, 2.5, 3}));
  EXPECT_EQ(falling_of(c).shift, -0.25);
  EXPECT_EQ(falling_of(c).jitter, 0.125);
  ASSERT_EQ(falling_of(c).sets.size(), 2u);
  EXPECT_EQ(falling_of(c).sets[0].lying, (std::array<std::int64_t, 2>{2, 0}));
  EXPECT_EQ(falling_of(c).sets[0].above, (std::array<std::int64_t, 3>{1, 2, 3}));
  EXPECT_EQ(falling_of(c).sets[0].corner, (std::array<double, 2>{-1.5, 4}));
  EXPECT_EQ(falling_of(c).sets[0].spacing, 1);
  EXPECT_EQ(falling_of(c).sets[0].height, 16);
  EXPECT_EQ(c.physics.bodies, pipeline::BodyModel::tree);
  EXPECT_EQ(c.physics.integrator, "Verlet");
  EXPECT_EQ(c.physics.accuracy, 1e-9);
  EXPECT_EQ(c.physics.gravity, (std::array<double, 3>{0, 0, -1.62}));
  EXPECT_EQ(c.physics.linear_damping, 0);
  EXPECT_EQ(c.physics.angular_damping, 2);
  EXPECT_EQ(c.physics.material.stiffness, 5e6);
  EXPECT_EQ(c.physics.material.dissipation, 0);
  EXPECT_EQ(c.physics.material.static_friction, 0.9);
  EXPECT_EQ(c.physics.material.dynamic_friction, 0.7);
  EXPECT_EQ(c.physics.material.viscous_friction, 0.01);
  EXPECT_EQ(c.physics.material.transition_velocity, 0.05);
  EXPECT_EQ(c.contact_radius, ContactRadius::nominal);
  EXPECT_EQ(c.physics.step_budget, 1);
  EXPECT_EQ(c.physics.time_budget, 0);
  EXPECT_EQ(c.physics.energy_bound, 1.5);
  EXPECT_EQ(c.repeats, 1000);
  ASSERT_EQ(c.algorithms.size(), 2u);
  EXPECT_EQ(c.algorithms[0].label, "A-1+b_.c");
  EXPECT_EQ(std::get<std::int64_t>(c.algorithms[0].knobs.at("stride")), 5);
  EXPECT_EQ(std::get<double>(c.algorithms[0].knobs.at("inflate")), 2.0);
  EXPECT_EQ(std::get<std::string>(c.algorithms[0].knobs.at("triangles")), "strip");
  EXPECT_EQ(std::get<bool>(c.algorithms[0].knobs.at("densify")), true);
  EXPECT_EQ(std::get<std::string>(c.algorithms[0].knobs.at("prefilter")), "rotated_aabb");
  EXPECT_EQ(c.algorithms[1].label, "obb_sat");
  expect_idempotent(c);
}

TEST(Config, AcceptsMarksAndLineEndsOfWindows) {
  const Config c = parse_config("\xEF\xBB\xBFsteps = 7\r\n[scene]\r\nkind = \"falling\"\r\n", "f.toml");
  EXPECT_EQ(c.steps, 7);
  EXPECT_NE(error_in("\xEF\xBB\xBFsteps = 0\r\n").find("a/f.toml:1:9:"), std::string::npos);
}

TEST(Config, DotsInTextAndCommentsAreNoKeys) {
  const std::string dots(100, '.');
  const Config c = parse_config(
      "title = \"a\\\"" + dots + "\" # " + dots + "\n" + kScene + "plate = [1.0, 2.0, 3.0] # '\n", "f.toml");
  EXPECT_EQ(c.title, "a\"" + dots);
}

TEST(Config, TitlesOfOddFileNamesAreText) {
  EXPECT_EQ(parse_config(kScene, "a\xff\nb.toml").title, "a??b");
  expect_idempotent(parse_config(kScene, "a\xff\n\"b\\.toml"));
  EXPECT_EQ(tests::coded_refusal_of([] { parse_config("x", "a\nb.toml"); }).find("3 a?b.toml:1:"), 0u);
}

TEST(Config, CountsCharactersOfTitlesNotBytes) {
  std::string title;
  for (int i = 0; i < 1024; ++i) title += "č";
  EXPECT_EQ(parse_config("title = \"" + title + "\"\n" + kScene, "f.toml").title, title);
  EXPECT_NE(error_in("title = \"" + title + "č\"\n" + kScene), "");
}

TEST(Set, ChangesValuesOfAnyDepth) {
  const std::string text =
      kScene + "[[scene.set]]\n[[scene.set]]\nheight = 4\n[[algorithm]]\nname = \"facet_vectors\"\n";
  const Config c =
      parse_config(text, "f.toml",
                   {"steps=5", "rate = 2.5", "title=Two words", "scene.set.1.height=3", "algorithm.0.stride=5",
                    "physics.gravity=[0, -1, 0]", "physics.gravity.1=-2", "timing.repeats=7",
                    "physics.integrator=Verlet", "algorithm.0.label=a=b", "algorithm.0.label='x'"});
  EXPECT_EQ(c.steps, 5);
  EXPECT_EQ(c.rate, 2.5);
  EXPECT_EQ(c.title, "Two words");
  EXPECT_EQ(falling_of(c).sets[0].height, 5);
  EXPECT_EQ(falling_of(c).sets[1].height, 3);
  EXPECT_EQ(c.physics.gravity, (std::array<double, 3>{0, -2, 0}));
  EXPECT_EQ(c.repeats, 7);
  EXPECT_EQ(c.physics.integrator, "Verlet");
  EXPECT_EQ(std::get<std::int64_t>(c.algorithms[0].knobs.at("stride")), 5);
  EXPECT_EQ(c.algorithms[0].label, "x");
  EXPECT_EQ(c.text, text);
  expect_idempotent(c);
}

TEST(Set, MakesTablesAndReplacesLists) {
  const Config c =
      parse_config("", "f.toml", {"scene.kind=falling", "scene.set=[{lying=[2,2]}]", "algorithm=[{name='obb_sat'}]"});
  EXPECT_EQ(falling_of(c).sets.size(), 1u);
  EXPECT_EQ(c.algorithms.size(), 1u);
  EXPECT_EQ(with({"title=7th", "title="}).title, "");
  EXPECT_EQ(with({"title=C:\\x #1"}).title, "C:\\x #1");
}

TEST(Set, NamesItselfInErrors) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"steps", "2 --set steps: must be KEY=VALUE, e.g. --set steps=100"},
      {"", "2 --set : must be KEY=VALUE"},
      {"=5", "2 --set =5: must be KEY=VALUE, e.g. --set steps=100, not without a key"},
      {"  =5", "2 --set   =5: must be KEY=VALUE"},
      {"steps=-1", "3 --set steps=-1: 'steps' must be an integer between 1 and 10000000, not -1"},
      {"steps=5 x", "3 --set steps=5 x: 'steps' must be an integer between 1 and 10000000, not \"5 x\""},
      {"steps=5\nseed=2", "3 --set steps=5?seed=2: must be one value, not several lines"},
      {"title=\"a", "3 --set title=\"a: not a TOML value: "},
      {"title=\xff", "3 --set title=?: not valid UTF-8"},
      {"step=5", "3 --set step=5: unknown key 'step'; did you mean 'steps'?"},
      {"scne.segments=5", "3 --set scne.segments=5: unknown key 'scne'; did you mean 'scene'?"},
      {"timing.repeat=5", "3 --set timing.repeat=5: unknown key 'timing.repeat'; did you mean 'repeats'?"},
      {"scene.set.0.height=3",
       "3 --set scene.set.0.height=3: 'scene.set' must be in the configuration before its entry 0"},
      {"algorithm.1.stride=5",
       "3 --set algorithm.1.stride=5: 'algorithm' must be followed by a number below its 1 entries, not '1'"},
      {"algorithm.name=obb_sat", "must be followed by a number below its 1 entries, not 'name'"},
      {"algorithm.0.stride=0", "3 --set algorithm.0.stride=0: 'algorithm.0.stride' must be "},
      {"algorithm.0.name=aabb", "3 f.toml:7:1: unknown key 'algorithm.0.stride'; known: name, label"},
      {"steps.a=1", "3 --set steps.a=1: 'steps' is 9 and has no key 'a'"},
      {"scene..kind=1", "3 --set scene..kind=1: must have no empty part in the key"},
      {".=1", "must have no empty part"},
      {"scene.plate=[1,2]", "3 --set scene.plate=[1,2]: 'scene.plate' must be an array of 3 numbers, not [1, 2]"},
      {"physics={accuracy=0}", "3 --set physics={accuracy=0}: 'physics.accuracy' must be"},
      {"scene={}", "3 --set scene={}: missing key 'scene.kind'"},
  };
  const std::string text =
      "steps = 9\n[scene]\nkind = \"falling\"\n\n[[algorithm]]\nname = \"facet_vectors\"\nstride = 5\n";
  for (const auto& [set, message] : cases) {
    const std::string got = tests::coded_refusal_of([&] { parse_config(text, "f.toml", {set}); });
    EXPECT_NE(got.find(message), std::string::npos) << one_line(set) << " gave: " << got << "\nexpected: " << message;
    EXPECT_EQ(got.find('\n'), std::string::npos) << got;
  }
  // The last to write a place owns it.
  EXPECT_EQ(error_in(kScene, {"physics.accuracy=0", "physics={accuracy=2}"}).find("3 --set physics={accuracy=2}:"), 0u);
  EXPECT_EQ(error_in(kScene, {"physics={accuracy=2}", "physics.accuracy=0"}).find("3 --set physics.accuracy=0:"), 0u);
}

// Random values of every key: what is written back reads as the same, to the last bit.
TEST(Effective, ReadsBackAsTheSame) {
  std::mt19937_64 random(20240517);
  SCOPED_TRACE("seed 20240517");
  const auto integer = [&](std::int64_t least, std::int64_t most) {
    return std::to_string(std::uniform_int_distribution<std::int64_t>(least, most)(random));
  };
  const auto real = [&](double least, double most) {
    return real_text(std::uniform_real_distribution<double>(least, most)(random));
  };
  const auto maybe = [&] { return random() % 2 == 0; };
  const char* base =
      "[scene]\nkind='falling'\n[[scene.set]]\n[[scene.set]]\n[[algorithm]]\nname='facet_triangles'\n"
      "[[algorithm]]\nname='obb_sat'\n";
  for (int i = 0; i < 100; ++i) {
    const std::vector<std::string> all = {
        "seed=" + integer(0, std::numeric_limits<std::int64_t>::max()),
        "steps=" + integer(1, 10000000),
        "rate=" + real(1e-3, 1e6),
        "title=\"\\\"\\\\ ľ " + integer(0, 99) + "\"",
        "scene.segments=" + integer(1, 1024),
        "scene.radius=" + real(1e-6, 2),
        "scene.density=" + integer(1, 10000),
        "scene.plate=[" + real(1, 2) + "," + integer(1, 9) + "," + real(1, 1e6) + "]",
        "scene.shift=" + real(-1, 1),
        "scene.jitter=" + real(0, 1),
        "scene.set.0.lying=[" + integer(0, 100) + "," + integer(0, 100) + "]",
        "scene.set.1.above=[" + integer(0, 20) + "," + integer(0, 20) + "," + integer(0, 20) + "]",
        "scene.set.1.corner=[" + real(-1e6, 1e6) + "," + real(-1e-5, 1e-5) + "]",
        "scene.set.0.spacing=" + real(1e-6, 1e6),
        "scene.set.1.height=" + real(-1e6, 1e6),
        "physics.bodies=tree",
        "physics.accuracy=" + real(0, 1e-8),
        "physics.gravity=[" + real(-1, 1) + ",-0.0," + real(-1e300, 1e300) + "]",
        "physics.stiffness=" + real(0, 1e12),
        "physics.time_budget=" + real(0, 1e-300),
        "physics.step_budget=" + integer(1, std::numeric_limits<std::int64_t>::max()),
        "physics.contact_radius=nominal",
        "timing.repeats=" + integer(1, 1000),
        "algorithm.0.stride=" + integer(1, 100),
        "algorithm.0.inflate=" + real(0.5, 2),
        "algorithm.0.label=l" + integer(0, 99),
        "algorithm.1.label=m+" + integer(0, 99)};
    std::vector<std::string> sets;
    for (const std::string& set : all)
      if (maybe()) sets.push_back(set);
    const Config c = parse_config(base, "f.toml", sets);
    expect_idempotent(c);
    if (HasFailure()) FAIL() << "case " << i;
  }
}

TEST(Effective, KeepsTheOrderOfAlgorithms) {
  const Config c = with({"algorithm=[{name='rotated_aabb'}, {name='obb_sat'}, {name='bounding_sphere'}]"});
  const auto at = [&](const char* text) { return c.effective.find(text); };
  EXPECT_LT(at("name = \"rotated_aabb\""), at("name = \"obb_sat\""));
  EXPECT_LT(at("name = \"obb_sat\""), at("name = \"bounding_sphere\""));
  EXPECT_NE(at("name = \"bounding_sphere\""), std::string::npos);
  expect_idempotent(c);
}

TEST(ParseAlgorithm, TakesNameKnobsAndLabel) {
  EXPECT_EQ(parse_algorithm("obb_sat").label, "obb_sat");
  EXPECT_EQ(parse_algorithm("obb_sat@mine").label, "mine");
  const AlgorithmChoice c = parse_algorithm("facet_triangles:stride=5,inflate=2,triangles=strip,densify=true@ft_5");
  EXPECT_EQ(c.name, "facet_triangles");
  EXPECT_EQ(c.label, "ft_5");
  EXPECT_EQ(std::get<std::int64_t>(c.knobs.at("stride")), 5);
  EXPECT_EQ(std::get<double>(c.knobs.at("inflate")), 2.0);
  EXPECT_EQ(std::get<std::string>(c.knobs.at("triangles")), "strip");
  EXPECT_EQ(std::get<bool>(c.knobs.at("densify")), true);
  EXPECT_EQ(c.knobs.size(), algorithms::find("facet_triangles")->knobs.size());
}

// An exact method is judged on the truth that scores: without a word of its own it answers for that truth.
TEST(Containment, OfAnExactMethodFollowsTheTruthUnlessGiven) {
  const auto wanted = [](const AlgorithmChoice& choice) { return std::get<bool>(choice.knobs.at("containment")); };
  for (const char* truth : {"ignore", "record", "meet"}) {
    SCOPED_TRACE(truth);
    const Config c = with({"truth.containment=" + std::string(truth),
                           "algorithm=[{name='exact'}, {name='exact_cold', containment=true}, {name='exact', "
                           "containment=false, label='surface'}]"});
    EXPECT_EQ(wanted(c.algorithms[0]), c.containment == Containment::meet);
    EXPECT_TRUE(wanted(c.algorithms[1]));
    EXPECT_FALSE(wanted(c.algorithms[2]));
    expect_idempotent(c);
  }
  EXPECT_FALSE(wanted(parse_algorithm("exact")));
  EXPECT_TRUE(wanted(parse_algorithm("exact", Containment::meet)));
  EXPECT_FALSE(wanted(parse_algorithm("exact:containment=false", Containment::meet)));
}

TEST(ParseAlgorithm, NamesItselfInErrors) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "3 --algorithm : 'name' must be the name of an algorithm, not \"\"; known: obb_sat"},
      {"obb_sta",
       "3 --algorithm obb_sta: 'name' must be the name of an algorithm, not \"obb_sta\"; did you mean 'obb_sat'?"},
      {"obb_sat:", "3 --algorithm obb_sat:: must be NAME[:knob=value,...][@LABEL], not with ''"},
      {"obb_sat@", "3 --algorithm obb_sat@: 'label' must be 1 to 64 characters"},
      {"obb_sat@a/b", "'label' must be 1 to 64 characters"},
      {"obb_sat:stride=5", "3 --algorithm obb_sat:stride=5: unknown key 'stride'; known: name, label"},
      {"facet_vectors:strid=5", "unknown key 'strid'; did you mean 'stride'?"},
      {"facet_vectors:stride", "must be NAME[:knob=value,...][@LABEL], not with 'stride' in it"},
      {"facet_vectors:stride=5,", "not with '' in it"},
      {"facet_vectors:=5", "not with '=5' in it"},
      {"facet_vectors:name=obb_sat", "not with 'name=obb_sat' in it"},
      {"facet_vectors:stride=5,stride=6", "'stride' must be given once, not again"},
      {"facet_vectors:stride=0", "3 --algorithm facet_vectors:stride=0: 'stride' must be "},
      {"facet_vectors:stride=x", "'stride' must be an integer, not \"x\""},
      {"facet_vectors:stride=", "'stride' must be an integer, not \"\""},
      {"facet_vectors:stride=\xff", "not valid UTF-8"},
      {"facet_vectors:stride=1\nlabel=2", "must be one value, not several lines"},
  };
  for (const auto& [argument, message] : cases) {
    const std::string got = tests::coded_refusal_of([&] { parse_algorithm(argument); });
    EXPECT_NE(got.find(message), std::string::npos)
        << one_line(argument) << " gave: " << got << "\nexpected: " << message;
    EXPECT_EQ(got.find('\n'), std::string::npos) << got;
  }
}

TEST(KnobsJson, HasSortedKeysAndShortNumbers) {
  EXPECT_EQ(knobs_json({}), "{}");
  EXPECT_EQ(knobs_json({{"b", 0.1}, {"a", std::int64_t{5}}, {"d", std::string("x\"\n")}, {"c", true}, {"e", 2.0}}),
            R"({"a":5,"b":0.1,"c":true,"d":"x\"\u000A","e":2.0})");
}

TEST(Configs, EveryFileIsValidAndReadsBackAsTheSame) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(configs())) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path().filename());
    ++files;
    expect_idempotent(read_config(entry.path()));
  }
  EXPECT_GE(files, 2);
}

// The file shows to a student what the defaults are: leaving it out changes nothing but the list of algorithms.
TEST(Configs, PadaniIsTheDefaults) {
  Config padani = read_config(configs() / "padani.toml");
  Config defaults = with({"title=Falling spheres"});
  padani.algorithms.clear();
  defaults.algorithms.clear();
  expect_same(padani, defaults);
}

// As above; what is asked of each scene differs in the algorithms. K stands there in the thesis's own procedure too.
TEST(Configs, KostkaIsTheDefaultsWithTheNineAndWhatIsBesideThem) {
  Config kostka = read_config(configs() / "kostka.toml");
  std::vector<std::string> names;
  for (const AlgorithmChoice& choice : kostka.algorithms) {
    if (choice.label == "facet_distance_exhaustive") continue;
    EXPECT_EQ(choice.label, choice.name);
    EXPECT_EQ(choice.knobs, algorithms::presets(*algorithms::find(choice.name)));
    names.push_back(choice.name);
  }
  std::vector<std::string> expected = {"obb_sat",         "bounding_sphere", "rotated_aabb",  "facet_distance",
                                       "obb_corners",     "facet_vectors",   "obb_triangles", "facet_triangles",
                                       "facet_rotations", "cannon_naive",    "cannon_sap",    "exact",
                                       "exact_cold"};
  if (algorithms::find("fcl_bvh")) expected.push_back("fcl_bvh");
  EXPECT_EQ(names, expected);
  EXPECT_EQ(kostka.algorithms.size(), names.size() + 1);

  Config defaults = parse_config("[scene]\nkind = \"box\"\n", "f.toml", {"title=Spheres in a cube"});
  kostka.algorithms.clear();
  defaults.algorithms.clear();
  expect_same(kostka, defaults);
  const BoxScene& box = kostka.keys<BoxScene>();
  EXPECT_EQ(box.births.count, 80);
  EXPECT_EQ(box.push.directions, (std::vector<std::string>{"+x", "-x", "+z", "-z"}));
}

TEST(Config, GapsAreOffAndHaveAMargin) {
  const auto with = [](const std::string& keys) { return parse_config(kScene + "[truth]\n" + keys, "f.toml"); };
  EXPECT_FALSE(with("").gap_margin);
  EXPECT_FALSE(with("gap = false\n").gap_margin);
  EXPECT_EQ(with("gap = true\n").gap_margin, 0.1);
  EXPECT_EQ(with("gap = true\ngap_margin = 0\n").gap_margin, 0);
  expect_idempotent(with("gap = true\ngap_margin = 2.5\n"));
  expect_idempotent(with(""));
}

TEST(Config, AProgramOfOthersHasACommandBudgetsAndKnobsOfItsOwn) {
  const auto with = [](const std::string& keys) {
    return parse_config(kScene + "[[algorithm]]\nname = \"program\"\n" + keys, "a/f.toml");
  };
  const Config config = with(
      "command = [\"node\", \"my engine.mjs\"]\nlabel = \"mine\"\nreach = 2\nfast = true\nstep_budget = 5\n"
      "memory_budget = 64\n");
  const AlgorithmChoice& choice = config.algorithms.front();
  ASSERT_TRUE(choice.foreign);
  EXPECT_EQ(choice.label, "mine");
  EXPECT_EQ(choice.foreign->command.words, (std::vector<std::string>{"node", "my engine.mjs"}));
  EXPECT_EQ(choice.foreign->command.folder, "a") << "relative to the configuration";
  EXPECT_EQ(choice.foreign->budget.step, 5);
  EXPECT_EQ(choice.foreign->budget.all, 3600);
  EXPECT_EQ(choice.foreign->budget.memory, std::uint64_t{64} << 20);
  EXPECT_EQ(choice.knobs, (algorithms::Knobs{{"reach", std::int64_t{2}}, {"fast", true}}));
  expect_idempotent(config);

  EXPECT_EQ(with("command = \"python3  mine.py\"").algorithms[0].foreign->command.words,
            (std::vector<std::string>{"python3", "mine.py"}))
      << "one text is parted at blanks";
  const AlgorithmChoice argument = parse_algorithm("program:command=python3 mine.py,reach=1.5@mine");
  EXPECT_EQ(argument.foreign->command.words, (std::vector<std::string>{"python3", "mine.py"}));
  EXPECT_EQ(argument.foreign->command.folder, "") << "the current one";
  EXPECT_EQ(argument.label, "mine");
  EXPECT_EQ(argument.knobs, (algorithms::Knobs{{"reach", 1.5}}));
}

// Anybody may have made a file: what it names is not run by looking at it or timing its methods again.
TEST(Config, AResultStartsNoProgram) {
  const Config config = parse_config(
      kScene + "[[algorithm]]\nname = \"program\"\ncommand = [\"x\"]\n[[algorithm]]\nname = \"aabb\"\n", "f.toml");
  const Config recorded = recorded_config(config.effective, "f.h5");
  ASSERT_EQ(recorded.algorithms.size(), 1u);
  EXPECT_EQ(recorded.algorithms[0].name, "aabb");
  ASSERT_EQ(recorded.notes.size(), 1u);
  EXPECT_NE(recorded.notes[0].find("algorithm 'program' is left out: it needs its program"), std::string::npos);
}

}  // namespace
}  // namespace pipeline
