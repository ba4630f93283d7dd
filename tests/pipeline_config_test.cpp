// Configurations: every rule with its message and place, --set, --algorithm, and the way back to TOML.
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <random>

#include "pipeline/config.hpp"
#include "pipeline/error.hpp"
#include "pipeline/words.hpp"

namespace pipeline {
namespace {

namespace fs = std::filesystem;

const std::string kScene = "[scene]\nkind = \"falling\"\n";

fs::path configs() { return fs::path(__FILE__).parent_path().parent_path() / "configs"; }

/// The user's error that `act` throws, "CODE text"; "" when it throws none.
std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return std::to_string(error.code()) + ' ' + error.what();
  }
  return "";
}

std::string error_in(const std::string& text, const std::vector<std::string>& sets = {}) {
  return error_of([&] { parse_config(text, "a/f.toml", sets); });
}

Config with(const std::vector<std::string>& sets) { return parse_config(kScene, "f.toml", sets); }

void expect_same(const Config& a, const Config& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.rate, b.rate);
  EXPECT_EQ(a.scene.segments, b.scene.segments);
  EXPECT_EQ(a.scene.radius, b.scene.radius);
  EXPECT_EQ(a.scene.density, b.scene.density);
  EXPECT_EQ(a.scene.plate, b.scene.plate);
  EXPECT_EQ(a.scene.shift, b.scene.shift);
  ASSERT_EQ(a.scene.sets.size(), b.scene.sets.size());
  for (std::size_t i = 0; i < a.scene.sets.size(); ++i) {
    const FallingSet &s = a.scene.sets[i], &t = b.scene.sets[i];
    EXPECT_TRUE(s.lying == t.lying && s.above == t.above && s.corner == t.corner) << i;
    EXPECT_TRUE(s.spacing == t.spacing && s.height == t.height) << i;
  }
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
  EXPECT_EQ(p.material.transition_velocity, q.material.transition_velocity);
  EXPECT_EQ(p.step_budget, q.step_budget);
  EXPECT_EQ(p.time_budget, q.time_budget);
  EXPECT_EQ(p.energy_bound, q.energy_bound);
  EXPECT_EQ(a.contact_radius, b.contact_radius);
  EXPECT_EQ(a.containment, b.containment);
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
  ASSERT_EQ(c.scene.sets.size(), 3u);
  std::int64_t spheres = 0;
  for (const FallingSet& s : c.scene.sets) spheres += s.lying[0] * s.lying[1] + s.above[0] * s.above[1] * s.above[2];
  EXPECT_EQ(spheres, 1 + 1 + 10 + 10 + 36 + 216);
  EXPECT_EQ(c.scene.sets[0].corner, (std::array<double, 2>{-14, -20}));
  EXPECT_EQ(c.scene.sets[1].spacing, 2.5);
  EXPECT_EQ(c.scene.sets[2].height, 75);
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
[[scene.set]]
lying = [2, 0]
above = [1, 2, 3]
corner = [-1.5, 4]
spacing = 1
height = 0x10
[[scene.set]]
[physics]
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
  EXPECT_EQ(c.scene.segments, 1024);
  EXPECT_EQ(c.scene.radius, 0.5);
  EXPECT_EQ(c.scene.density, 7800.5);
  EXPECT_EQ(c.scene.plate, (std::array<double, 3>{1, 2.5, 3}));
  EXPECT_EQ(c.scene.shift, -0.25);
  ASSERT_EQ(c.scene.sets.size(), 2u);
  EXPECT_EQ(c.scene.sets[0].lying, (std::array<std::int64_t, 2>{2, 0}));
  EXPECT_EQ(c.scene.sets[0].above, (std::array<std::int64_t, 3>{1, 2, 3}));
  EXPECT_EQ(c.scene.sets[0].corner, (std::array<double, 2>{-1.5, 4}));
  EXPECT_EQ(c.scene.sets[0].spacing, 1);
  EXPECT_EQ(c.scene.sets[0].height, 16);
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

/// A text and what its error says, from the place on.
struct Refusal {
  std::string text;
  std::string message;
};

// One line each: place, key, rule, value, remedy.
TEST(Config, RefusesWithPlaceRuleValueAndRemedy) {
  const std::string set = kScene + "[[scene.set]]\n";                                    // lines 1 to 3
  const std::string physics = kScene + "[physics]\n";                                    // lines 1 to 3
  const std::string algorithm = kScene + "[[algorithm]]\nname = \"facet_triangles\"\n";  // lines 1 to 4
  const std::vector<Refusal> refusals = {
      // Root
      {"", "a/f.toml: missing table [scene]; write [scene] and below it kind = \"falling\""},
      {"\xEF\xBB\xBF", "a/f.toml: missing table [scene]"},
      {"step = 3\n" + kScene, "a/f.toml:1:1: unknown key 'step'; did you mean 'steps'?"},
      {"seed=1\n  whatsoever = 3\n" + kScene,
       "a/f.toml:2:3: unknown key 'whatsoever'; known: title, seed, steps, rate, scene, physics, truth, timing, "
       "algorithm"},
      {"zzz=1\naaa=2\n" + kScene, "a/f.toml:1:1: unknown key 'zzz'"},  // the first in the file, not in the alphabet
      {"\"ti\\ntle\" = 3\n" + kScene, "a/f.toml:1:1: unknown key 'ti?tle'; did you mean 'title'?"},
      {"\"a.b\" = 3\n" + kScene, "a/f.toml:1:1: unknown key 'a.b'"},
      {"steps = -1\n" + kScene, "a/f.toml:1:9: 'steps' must be an integer between 1 and 10000000, not -1"},
      {"steps = 0\n" + kScene, "'steps' must be an integer between 1 and 10000000, not 0"},
      {"steps = 10000001\n" + kScene, "not 10000001"},
      {"steps = 600.0\n" + kScene, "'steps' must be an integer between 1 and 10000000, not 600.0"},
      {"steps = \"6\"\n" + kScene, "a/f.toml:1:9: 'steps' must be an integer between 1 and 10000000, not \"6\""},
      {"steps = 99999999999999999999\n" + kScene, "not valid TOML: in decimal integer: '99999999999999999999' is not"},
      {"seed = -1\n" + kScene, "a/f.toml:1:8: 'seed' must be an integer of at least 0, not -1"},
      {"rate = 0\n" + kScene, "a/f.toml:1:8: 'rate' must be a number above 0 and at most 1000000, not 0"},
      {"rate = 1000001\n" + kScene, "'rate' must be a number above 0 and at most 1000000, not 1000001"},
      {"rate = nan\n" + kScene, "not nan"},
      {"rate = inf\n" + kScene, "not inf"},
      {"rate = 1979-05-27\n" + kScene, "at most 1000000, not the date 1979-05-27"},
      {"rate = 1979-05-27T07:32:00Z\n" + kScene, "not the date 1979-05-27T07:32:00Z"},
      {"rate = 07:32:00\n" + kScene, "not the time 07:32:00"},
      {"title = 3\n" + kScene, "a/f.toml:1:9: 'title' must be text, not 3; text stands in quotes"},
      {"title = \"a\\nb\"\n" + kScene, "'title' must be one line of at most 1024 characters, not \"a?b\""},
      {"title = \"a\\u0000b\"\n" + kScene, "'title' must be one line"},
      {"title = \"" + std::string(1025, 'x') + "\"\n" + kScene, "at most 1024 characters, not \"xxxxxxxx"},
      // Scene
      {"scene = 5\n", "a/f.toml:1:9: 'scene' must be a table, not 5; write [scene] on a line of its own"},
      {"\n[scene]\n", "a/f.toml:2:1: missing key 'scene.kind'; write kind = \"falling\""},
      {"[scene]\nkind = \"faling\"\n",
       "a/f.toml:2:8: 'scene.kind' must be \"falling\", not \"faling\"; did you mean 'falling'?"},
      {"[scene]\nkind = \"box\"\n", "a/f.toml:2:8: 'scene.kind' must be \"falling\", not \"box\""},
      {"[scene]\nkind = 1\n", "a/f.toml:2:8: 'scene.kind' must be \"falling\", not 1"},
      {kScene + "sedgments = 3\n", "a/f.toml:3:1: unknown key 'scene.sedgments'; did you mean 'segments'?"},
      {kScene + "segments = 0\n", "'scene.segments' must be an integer between 1 and 1024, not 0"},
      {kScene + "segments = 1e9\n", "a/f.toml:3:12: 'scene.segments' must be an integer between 1 and 1024, not 1e9"},
      {kScene + "segments = 1000000000\n", "not 1000000000"},
      {kScene + "radius = 0\n",
       "a/f.toml:3:10: 'scene.radius' must be a number of at least 1e-6 and at most 1000000, not 0"},
      {kScene + "density = -1\n", "a/f.toml:3:11: 'scene.density' must be a number of at least"},
      {kScene + "plate = 3\n", "a/f.toml:3:9: 'scene.plate' must be an array of 3 numbers, not 3"},
      {kScene + "plate = [1, 2]\n", "'scene.plate' must be an array of 3 numbers, not [1, 2]"},
      {kScene + "plate = [1, -2, 3]\n", "a/f.toml:3:13: 'scene.plate.1' must be a number of at least 1e-6 and"},
      {kScene + "plate = [1, \"2\", 3]\n", "a/f.toml:3:13: 'scene.plate.1' must be a number"},
      {kScene + "shift = nan\n",
       "a/f.toml:3:9: 'scene.shift' must be a number of at least -1000000 and at most 1000000, not nan"},
      {kScene + "[scene.set]\nheight = 3\n",
       "a/f.toml:3:1: 'scene.set' must be an array of tables, not a table; write [[scene.set]]"},
      {kScene + "set = [1]\n", "a/f.toml:3:8: 'scene.set.0' must be a table, not 1; write [[scene.set]] above each"},
      {kScene + "set = []\n", "'scene.set' must hold at least 1 sphere, not 0; raise 'lying' or 'above'"},
      {set + "lying = [0, 3]\nabove = [0, 0, 0]\n", "'scene.set' must hold at least 1 sphere, not 0"},
      {set + "lying = [1, -1]\n",
       "a/f.toml:4:13: 'scene.set.0.lying.1' must be an integer between 0 and 1000000, not -1"},
      {set + "lying = [1.5, 1]\n", "'scene.set.0.lying.0' must be an integer"},
      {set + "above = [1, 1]\n", "a/f.toml:4:9: 'scene.set.0.above' must be an array of 3 integers, not [1, 1]"},
      {set + "above = [1000000, 1000000, 1000000]\n",
       "a/f.toml:3:1: 'scene.set' must hold at most 1000000 spheres, not 1000000000000000001; lower"},
      {set + "lying = [1000, 1000]\nabove = [0, 0, 0]\n[[scene.set]]\n",
       "a/f.toml:6:1: 'scene.set' must hold at most 1000000 spheres, not 1000002"},
      {set + "corner = [1, 2e6]\n", "a/f.toml:4:14: 'scene.set.0.corner.1' must be a number"},
      {set + "spacing = 0\n", "a/f.toml:4:11: 'scene.set.0.spacing' must be a number of at least"},
      {set + "height = inf\n", "a/f.toml:4:10: 'scene.set.0.height' must be a number"},
      {set + "heigth = 3\n", "a/f.toml:4:1: unknown key 'scene.set.0.heigth'; did you mean 'height'?"},
      // Physics
      {physics + "integrator = \"rungekutamerson\"\n", "not \"rungekutamerson\"; did you mean 'RungeKuttaMerson'?"},
      {physics + "integrator = \"Euler1768\"\n", "a/f.toml:4:14: 'physics.integrator' must be \"RungeKuttaMerson\", "},
      {physics + "accuracy = 0\n", "a/f.toml:4:12: 'physics.accuracy' must be a number above 0 and below 1, not 0"},
      {physics + "accuracy = 1\n", "'physics.accuracy' must be a number above 0 and below 1, not 1"},
      {physics + "gravity = [0, inf, 0]\n", "a/f.toml:4:15: 'physics.gravity.1' must be a finite number, not inf"},
      {physics + "gravity = 9.81\n", "'physics.gravity' must be an array of 3 numbers, not 9.81"},
      {physics + "linear_damping = -0.1\n", "'physics.linear_damping' must be a finite number of at least 0, not -0.1"},
      {physics + "angular_damping = -1\n", "'physics.angular_damping' must be a finite number of at least 0, not -1"},
      {physics + "stiffness = 0\n", "'physics.stiffness' must be a finite number above 0, not 0"},
      {physics + "dissipation = -1\n", "'physics.dissipation' must be a finite number of at least 0, not -1"},
      {physics + "static_friction = -1\n", "'physics.static_friction' must be"},
      {physics + "dynamic_friction = -1\n", "'physics.dynamic_friction' must be"},
      {physics + "viscous_friction = true\n",
       "'physics.viscous_friction' must be a finite number of at least 0, not true"},
      {physics + "transition_velocity = 0\n", "'physics.transition_velocity' must be a finite number above 0, not 0"},
      {physics + "contact_radius = \"outer\"\n",
       "'physics.contact_radius' must be \"inscribed\" or \"nominal\", not \"outer\""},
      {physics + "step_budget = 0\n", "'physics.step_budget' must be an integer of at least 1, not 0"},
      {physics + "time_budget = -1\n", "'physics.time_budget' must be a finite number of at least 0, not -1"},
      {physics + "energy_bound = 1\n", "'physics.energy_bound' must be a finite number above 1, not 1"},
      {physics + "acuracy = 1\n", "a/f.toml:4:1: unknown key 'physics.acuracy'; did you mean 'accuracy'?"},
      {"physics = []\n" + kScene, "a/f.toml:1:11: 'physics' must be a table, not []; write [physics]"},
      // Truth, timing
      {kScene + "[truth]\ncontainment = \"record\"\n",
       "a/f.toml:4:15: 'truth.containment' must be \"ignore\", not \"record\"; this version does not look for bodies "
       "inside"},
      {kScene + "[truth]\ncontainment = \"meet\"\n", "not \"meet\"; this version"},
      {kScene + "[truth]\ncontainment = \"maet\"\n",
       "must be \"ignore\", \"record\" or \"meet\", not \"maet\"; did you mean 'meet'?"},
      {kScene + "[truth]\nx = 1\n", "a/f.toml:4:1: unknown key 'truth.x'; known: containment"},
      {kScene + "[timing]\nrepeats = 0\n",
       "a/f.toml:4:11: 'timing.repeats' must be an integer between 1 and 1000, not 0"},
      {kScene + "[timing]\nrepeats = 1001\n", "not 1001"},
      {kScene + "[timing]\nrepeat = 1\n", "a/f.toml:4:1: unknown key 'timing.repeat'; did you mean 'repeats'?"},
      // Algorithms
      {kScene + "[[algorithm]]\n", "a/f.toml:3:1: missing key 'algorithm.0.name'; known: obb_sat, bounding_sphere, "},
      {kScene + "[[algorithm]]\nname = 1\n", "a/f.toml:4:8: 'algorithm.0.name' must be text, not 1"},
      {kScene + "[[algorithm]]\nname = \"obb_sta\"\n",
       "a/f.toml:4:8: 'algorithm.0.name' must be the name of an algorithm, not \"obb_sta\"; did you mean 'obb_sat'?"},
      {kScene + "[[algorithm]]\nname = \"x\"\n", "not \"x\"; known: obb_sat, bounding_sphere, rotated_aabb"},
      {kScene + "[algorithm]\nname = \"obb_sat\"\n",
       "a/f.toml:3:1: 'algorithm' must be an array of tables, not a table; write [[algorithm]]"},
      {"algorithm = []\n" + kScene, "a/f.toml:1:13: 'algorithm' must hold at least one algorithm, not []; leave"},
      {algorithm + "strid = 3\n", "a/f.toml:5:1: unknown key 'algorithm.0.strid'; did you mean 'stride'?"},
      {algorithm + "stride = 0\n", "a/f.toml:5:10: 'algorithm.0.stride' must be "},
      {algorithm + "stride = 2.5\n", "a/f.toml:5:10: 'algorithm.0.stride' must be an integer, not 2.5"},
      {algorithm + "stride = [2]\n", "'algorithm.0.stride' must be an integer, not [2]"},
      {algorithm + "inflate = nan\n", "'algorithm.0.inflate' must be finite, not nan"},
      {algorithm + "inflate = 1979-05-27\n", "'algorithm.0.inflate' must be a number, not the date 1979-05-27"},
      {algorithm + "densify = 1\n", "'algorithm.0.densify' must be true or false, not 1"},
      {algorithm + "densify = {}\n", "'algorithm.0.densify' must be true or false, not a table"},
      {algorithm + "triangles = \"stripe\"\n",
       "'algorithm.0.triangles' must be one of disjoint, strip, not \"stripe\"; did you mean 'strip'?"},
      {algorithm + "label = \"\"\n",
       "a/f.toml:5:9: 'algorithm.0.label' must be 1 to 64 characters of A-Z a-z 0-9 _ . + -"},
      {algorithm + "label = \"a b\"\n", "not \"a b\""},
      {algorithm + "label = \"á\"\n", "not \"á\""},
      {algorithm + "label = \"..\"\n", "and neither '.' nor '..', not \"..\""},
      {algorithm + "label = \"" + std::string(65, 'x') + "\"\n", "'algorithm.0.label' must be 1 to 64 characters"},
      {algorithm + "[[algorithm]]\nname = \"facet_triangles\"\n",
       "a/f.toml:6:8: 'algorithm.1.name' must be the only one of its label, not \"facet_triangles\"; add a label, e.g. "
       "label = \"facet_triangles_2\""},
      {algorithm + "[[algorithm]]\nname = \"obb_sat\"\nlabel = \"facet_triangles\"\n",
       "a/f.toml:7:9: 'algorithm.1.label' must be the only one of its label, not \"facet_triangles\"; give each"},
      // TOML itself
      {"steps = \n", "a/f.toml:1:9: not valid TOML: in"},
      {"a = 1\r\nb = x\r\n",
       "a/f.toml:2:5: not valid TOML: in value: could not determine value type; text stands in quotes"},
      {"steps = 1\nsteps = 2\n", "a/f.toml:2:7: not valid TOML: in key-value pair: cannot redefine"},
      {"[scene\n", "a/f.toml:1:7: not valid TOML"},
      {"rate = 1e999\n", "not valid TOML"},
      {"title = \"\xff\"\n", "a/f.toml:1:10: not valid UTF-8; save the file in UTF-8"},
      {"seed = 1\n\xEF\xBB\xBF", "a/f.toml:2:1: not valid TOML"},
      {"# á\xC0\x80\n", "a/f.toml:1:4: not valid UTF-8"},
      {"seed = 1\n# \xed\xa0\x80", "a/f.toml:2:3: not valid UTF-8"},
      {"# \xe2\x82", "a/f.toml:1:3: not valid UTF-8"},
      {std::string("seed = 1\n \0", 11), "a/f.toml:2:2: a NUL byte; the file must be text"},
      {std::string("\xff\xfes\0e\0", 6), "a/f.toml:1:1: not valid UTF-8"},  // UTF-16 as Windows writes it
      {"x = " + std::string(300, '[') + std::string(300, ']') + "\n", "a/f.toml:1:26"},
  };
  for (const Refusal& refusal : refusals) {
    SCOPED_TRACE(one_line(refusal.text, 200));
    const std::string got = error_in(refusal.text);
    EXPECT_EQ(got.substr(0, 10), "3 a/f.toml") << got;
    EXPECT_NE(got.find(refusal.message), std::string::npos) << got << "\nexpected: " << refusal.message;
    EXPECT_EQ(got.find('\n'), std::string::npos) << got;
    EXPECT_LT(got.size(), 700u) << got;
  }
}

// A value of another type in the place of each key in turn.
TEST(Config, RefusesWrongTypesEverywhere) {
  const std::vector<std::string> reals{"rate",
                                       "scene.radius",
                                       "scene.density",
                                       "scene.shift",
                                       "scene.set.0.spacing",
                                       "scene.set.0.height",
                                       "physics.accuracy",
                                       "physics.stiffness",
                                       "physics.dissipation",
                                       "physics.time_budget",
                                       "physics.energy_bound"};
  const std::vector<std::string> integers{"seed", "steps", "scene.segments", "physics.step_budget", "timing.repeats"};
  const std::vector<std::string> arrays{"scene.plate", "scene.set.0.lying", "scene.set.0.above", "scene.set.0.corner",
                                        "physics.gravity"};
  const std::vector<std::string> texts{"title",
                                       "scene.kind",
                                       "physics.integrator",
                                       "physics.contact_radius",
                                       "truth.containment",
                                       "algorithm.0.name",
                                       "algorithm.0.label"};
  const std::vector<std::string> tables{"scene", "physics", "truth", "timing", "algorithm", "scene.set"};
  const auto refused = [](const std::vector<std::string>& keys, const std::vector<std::string>& values) {
    for (const std::string& key : keys) {
      for (const std::string& value : values) {
        const std::string set = key + '=' + value;
        const std::string got = error_in(kScene + "[[scene.set]]\n[[algorithm]]\nname = \"obb_sat\"\n", {set});
        EXPECT_EQ(got.find("3 --set " + set + ": '" + key), 0u) << set << " gave: " << got;
      }
    }
  };
  refused(reals, {"true", "text", "[1]", "{}", "1979-05-27", "07:32:00", "nan", "-inf"});
  refused(integers, {"true", "text", "[1]", "{}", "1979-05-27", "1.0", "nan", "9223372036854775808.0"});
  refused(arrays, {"true", "text", "{}", "1979-05-27", "1", "[]", "[[], [], []]", "[1, 1, 1, 1]"});
  refused(texts, {"true", "[1]", "{}", "1979-05-27", "1", "1.5"});
  refused(tables, {"true", "text", "[1]", "1979-05-27", "1"});
}

TEST(Config, AcceptsMarksAndLineEndsOfWindows) {
  const Config c = parse_config("\xEF\xBB\xBFsteps = 7\r\n[scene]\r\nkind = \"falling\"\r\n", "f.toml");
  EXPECT_EQ(c.steps, 7);
  EXPECT_NE(error_in("\xEF\xBB\xBFsteps = 0\r\n").find("a/f.toml:1:9:"), std::string::npos);
}

// toml++ 3.3 makes a table of each part of a key and crashed on 100000 of them when they were destroyed.
TEST(Config, SurvivesDeepKeys) {
  std::string key = "a";
  for (int i = 0; i < 200000; ++i) key += ".a";
  for (const std::string& text : {key + " = 1\n", "[" + key + "]\n", "[[" + key + "]]\n", "x = {" + key + " = 1}\n",
                                  "t = \"\"\"a\"\"\"\"\n" + key + " = 1\n", "t = '#' # \"\n" + key + " = 1"})
    EXPECT_NE(error_in(text).find("a key of more than 32 parts"), std::string::npos) << text.substr(0, 30);
  EXPECT_EQ(error_in(kScene, {key + "=1"}).find("3 --set a.a.a"), 0u);
  EXPECT_EQ(error_in(kScene, {"title={" + key + "=1}"}).find("3 --set title={a.a"), 0u);

  // The deepest that passes the check: 250 inline tables of 32 parts each.
  std::string deep = "x = ", close;
  for (int i = 0; i < 250; ++i) {
    deep += "{ a";
    for (int j = 0; j < 31; ++j) deep += ".a";
    deep += " = ";
    close += "}";
  }
  EXPECT_NE(error_in(deep + "1" + close + "\n"), "");
}

TEST(Config, DotsInTextAndCommentsAreNoKeys) {
  const std::string dots(100, '.');
  const Config c = parse_config(
      "title = \"a\\\"" + dots + "\" # " + dots + "\n" + kScene + "plate = [1.0, 2.0, 3.0] # '\n", "f.toml");
  EXPECT_EQ(c.title, "a\"" + dots);
}

TEST(Config, RefusesFilesThatAreNoText) {
  const fs::path folder = fs::temp_directory_path() / ("config_test_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const auto error = [](const fs::path& path) { return error_of([&] { read_config(path); }); };
  EXPECT_EQ(error(folder / "none.toml"),
            "3 " + (folder / "none.toml").string() + ": the configuration cannot be opened: No such file or directory");
  EXPECT_EQ(error(folder), "3 " + folder.string() + ": the configuration cannot be read: Is a directory");

  const fs::path big = folder / "big.toml";
  std::ofstream(big) << kScene;
  EXPECT_EQ(read_config(big).steps, 600);
  fs::resize_file(big, (16 << 20) + 1);
  EXPECT_EQ(error(big), "3 " + big.string() + ": a configuration must be at most 16 MiB long, not more");

  if (::geteuid() != 0) {  // root may read everything
    fs::permissions(big, fs::perms::none);
    EXPECT_NE(error(big).find("cannot be opened: Permission denied"), std::string::npos);
  }
  fs::remove_all(folder);
}

TEST(Config, TitlesOfOddFileNamesAreText) {
  EXPECT_EQ(parse_config(kScene, "a\xff\nb.toml").title, "a??b");
  expect_idempotent(parse_config(kScene, "a\xff\n\"b\\.toml"));
  EXPECT_EQ(error_of([] { parse_config("x", "a\nb.toml"); }).find("3 a?b.toml:1:"), 0u);
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
  EXPECT_EQ(c.scene.sets[0].height, 5);
  EXPECT_EQ(c.scene.sets[1].height, 3);
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
  EXPECT_EQ(c.scene.sets.size(), 1u);
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
    const std::string got = error_of([&] { parse_config(text, "f.toml", {set}); });
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
        "scene.set.0.lying=[" + integer(0, 100) + "," + integer(0, 100) + "]",
        "scene.set.1.above=[" + integer(0, 20) + "," + integer(0, 20) + "," + integer(0, 20) + "]",
        "scene.set.1.corner=[" + real(-1e6, 1e6) + "," + real(-1e-5, 1e-5) + "]",
        "scene.set.0.spacing=" + real(1e-6, 1e6),
        "scene.set.1.height=" + real(-1e6, 1e6),
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
    const std::string got = error_of([&] { parse_algorithm(argument); });
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

TEST(Words, RealsAreShortAndRoundTrip) {
  EXPECT_EQ(real_text(60), "60.0");
  EXPECT_EQ(real_text(0.1), "0.1");
  EXPECT_EQ(real_text(1e8), "1e8");
  EXPECT_EQ(real_text(1e-5), "1e-5");
  EXPECT_EQ(real_text(-0.0), "-0.0");
  EXPECT_EQ(real_text(5e-324), "5e-324");
  EXPECT_EQ(real_text(-1.7976931348623157e308), "-1.7976931348623157e308");
  EXPECT_EQ(real_text(1e100), "1e100");
  EXPECT_EQ(real_text(1e-10), "1e-10");
  std::mt19937_64 random(7);
  for (int i = 0; i < 10000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (std::isfinite(value))
      ASSERT_EQ(std::stod("0" + real_text(std::abs(value))), std::abs(value)) << "seed 7, case " << i;
  }
}

TEST(Words, OneLineHasNoControlCharacters) {
  EXPECT_EQ(one_line("a\x1b[31m\n\x7f"), "a?[31m??");
  EXPECT_EQ(one_line("á\xff\xC2"), "á??");
  EXPECT_EQ(one_line("\xC2\x9B"), "?");  // CSI in one character
  EXPECT_EQ(one_line("ááá", 2), "áá...");
  EXPECT_EQ(one_line("ááá", 3), "ááá");
}

TEST(Words, NearestForgivesOneEditInThree) {
  const std::vector<std::string> known{"steps", "seed", "rate", "RungeKuttaMerson"};
  EXPECT_EQ(nearest("step", known), "steps");
  EXPECT_EQ(nearest("setps", known), "steps");  // neighbours swapped
  EXPECT_EQ(nearest("SEED", known), "seed");
  EXPECT_EQ(nearest("runge_kutta_merson", known), "RungeKuttaMerson");
  EXPECT_EQ(nearest("", known), "");
  EXPECT_EQ(nearest("x", known), "");
  EXPECT_EQ(nearest("threshold", known), "");
  EXPECT_EQ(nearest(std::string(10000000, 'x'), known), "");
  EXPECT_EQ(nearest("steps", {}), "");
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

}  // namespace
}  // namespace pipeline
