// What a configuration refuses: every rule with its message and place, wrong types, hostile texts and files.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "pipeline/config.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"
#include "tests/support/refusal.hpp"

namespace pipeline {
namespace {

namespace fs = std::filesystem;

const std::string kScene = "[scene]\nkind = \"falling\"\n";

std::string error_in(const std::string& text, const std::vector<std::string>& sets = {}) {
  return tests::coded_refusal_of([&] { parse_config(text, "a/f.toml", sets); });
}

// With or without the library: an algorithm that is asked for by name is there or refused, one that is optional is
// there or noted, and a recorded one that is missing keeps nobody from the result.
TEST(Config, AlgorithmsOfLibrariesAreThereOrSaidToBeMissing) {
  const std::string named = kScene + "[[algorithm]]\nname = \"aabb\"\n[[algorithm]]\nname = \"fcl_bvh\"\n";
  const std::string optional = named + "optional = true\n";
  if (const algorithms::Algorithm* row = algorithms::find_missing("fcl_bvh")) {
    EXPECT_EQ(error_in(named),
              "3 a/f.toml:6:8: 'algorithm.1.name' must be an algorithm of this build, not \"fcl_bvh\"; "
              "it needs " +
                  algorithms::remedy(*row));
    const Config config = parse_config(optional, "a/f.toml", {});
    EXPECT_EQ(config.algorithms.size(), 1u);
    EXPECT_EQ(config.notes,
              (std::vector<std::string>{"algorithm 'fcl_bvh' is left out: it needs " + algorithms::remedy(*row)}));
    EXPECT_EQ(recorded_config(named, "f.h5").algorithms.size(), 1u);
  } else {
    EXPECT_EQ(parse_config(named, "a/f.toml", {}).algorithms.size(), 2u);
    const Config config = parse_config(optional, "a/f.toml", {});
    EXPECT_EQ(config.algorithms.size(), 2u);
    EXPECT_TRUE(config.notes.empty());
    EXPECT_EQ(config.effective.find("optional"), std::string::npos) << "what runs is decided";
  }
  EXPECT_EQ(error_in(named + "optional = 1\n"), "3 a/f.toml:7:12: 'algorithm.1.optional' must be true or false, not 1");
  EXPECT_EQ(tests::coded_refusal_of([] { parse_algorithm("aabb:optional=true"); }),
            "3 --algorithm aabb:optional=true: must be NAME[:knob=value,...][@LABEL], not with 'optional=true' in it");
}

/// A text and what its error says, from the place on.
struct Refusal {
  std::string text;
  std::string message;
};

// One line each: place, key, rule, value, remedy.
TEST(ConfigErrors, RefusesWithPlaceRuleValueAndRemedy) {
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
       "plugin, algorithm"},
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
      {"rate = 0\n" + kScene, "a/f.toml:1:8: 'rate' must be a number of at least 1e-6 and at most 1e6, not 0"},
      {"rate = 1000001\n" + kScene, "'rate' must be a number of at least 1e-6 and at most 1e6, not 1000001"},
      {"rate = nan\n" + kScene, "not nan"},
      {"rate = inf\n" + kScene, "not inf"},
      {"rate = 1979-05-27\n" + kScene, "at most 1e6, not the date 1979-05-27"},
      {"rate = 1979-05-27T07:32:00Z\n" + kScene, "not the date 1979-05-27T07:32:00Z"},
      {"rate = 07:32:00\n" + kScene, "not the time 07:32:00"},
      {"title = 3\n" + kScene, "a/f.toml:1:9: 'title' must be text, not 3; text stands in quotes"},
      {"title = \"a\\nb\"\n" + kScene, "'title' must be one line of at most 1024 characters, not \"a?b\""},
      {"title = \"a\\u0000b\"\n" + kScene, "'title' must be one line"},
      {"title = \"" + std::string(1025, 'x') + "\"\n" + kScene, "at most 1024 characters, not \"xxxxxxxx"},
      // Scene
      {"scene = 5\n", "a/f.toml:1:9: 'scene' must be a table, not 5; write [scene] on a line of its own"},
      {"\n[scene]\n", "a/f.toml:2:1: missing key 'scene.kind'; write kind = \"falling\""},
      {"[scene]\nkind = \"faling\"\n", ", not \"faling\"; did you mean 'falling'?"},
      {"[scene]\nkind = \"kostka\"\n", "a/f.toml:2:8: 'scene.kind' must be \"falling\""},
      {"[scene]\nkind = 1\n", ", not 1"},
      {kScene + "sedgments = 3\n", "a/f.toml:3:1: unknown key 'scene.sedgments'; did you mean 'segments'?"},
      {kScene + "segments = 0\n", "'scene.segments' must be an integer between 1 and 1024, not 0"},
      {kScene + "segments = 1e9\n", "a/f.toml:3:12: 'scene.segments' must be an integer between 1 and 1024, not 1e9"},
      {kScene + "segments = 1000000000\n", "not 1000000000"},
      {kScene + "radius = 0\n",
       "a/f.toml:3:10: 'scene.radius' must be a number of at least 1e-6 and at most 1e6, not 0"},
      {kScene + "density = -1\n", "a/f.toml:3:11: 'scene.density' must be a number of at least"},
      {kScene + "plate = 3\n", "a/f.toml:3:9: 'scene.plate' must be an array of 3 numbers, not 3"},
      {kScene + "plate = [1, 2]\n", "'scene.plate' must be an array of 3 numbers, not [1, 2]"},
      {kScene + "plate = [1, -2, 3]\n", "a/f.toml:3:13: 'scene.plate.1' must be a number of at least 1e-6 and"},
      {kScene + "plate = [1, \"2\", 3]\n", "a/f.toml:3:13: 'scene.plate.1' must be a number"},
      {kScene + "shift = nan\n",
       "a/f.toml:3:9: 'scene.shift' must be a number of at least -1e6 and at most 1e6, not nan"},
      {kScene + "jitter = -0.1\n",
       "a/f.toml:3:10: 'scene.jitter' must be a number of at least 0 and at most 1e6, not -0.1"},
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
       "a/f.toml:3:1: 'scene.set' must hold at most 1000000 bodies, not 1000000000000000001; lower"},
      {set + "lying = [1000, 1000]\nabove = [0, 0, 0]\n[[scene.set]]\n",
       "a/f.toml:6:1: 'scene.set' must hold at most 1000000 bodies, not 1000002"},
      {set + "corner = [1, 2e6]\n", "a/f.toml:4:14: 'scene.set.0.corner.1' must be a number"},
      {set + "spacing = 0\n", "a/f.toml:4:11: 'scene.set.0.spacing' must be a number of at least"},
      {set + "height = inf\n", "a/f.toml:4:10: 'scene.set.0.height' must be a number"},
      {set + "heigth = 3\n", "a/f.toml:4:1: unknown key 'scene.set.0.heigth'; did you mean 'height'?"},
      // Physics
      {physics + "integrator = \"rungekutamerson\"\n", "not \"rungekutamerson\"; did you mean 'RungeKuttaMerson'?"},
      {physics + "integrator = \"Euler1768\"\n", "a/f.toml:4:14: 'physics.integrator' must be \"RungeKuttaMerson\", "},
      {physics + "bodies = \"fre\"\n",
       "a/f.toml:4:10: 'physics.bodies' must be \"free\" or \"tree\", not \"fre\"; did you mean 'free'?"},
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
      {kScene + "[truth]\ncontainment = \"maet\"\n",
       "must be \"ignore\", \"record\" or \"meet\", not \"maet\"; did you mean 'meet'?"},
      {kScene + "[truth]\nx = 1\n",
       "a/f.toml:4:1: unknown key 'truth.x'; known: containment, closed_within, gap, gap_margin"},
      {kScene + "[truth]\nclosed_within = 0.002\n",
       "a/f.toml:4:17: 'truth.closed_within' must be a number of at least 0 and at most 0.001, not 0.002"},
      {kScene + "[truth]\ngap = 1\n", "a/f.toml:4:7: 'truth.gap' must be true or false, not 1"},
      {kScene + "[truth]\ngap = true\ngap_margin = -1\n",
       "a/f.toml:5:14: 'truth.gap_margin' must be a number of at least 0 and at most 1e6, not -1"},
      {kScene + "[truth]\ngap = true\ngap_margin = 2e6\n", "'truth.gap_margin' must be"},
      {kScene + "[truth]\ngap_margin = 1\n",
       "a/f.toml:4:14: 'truth.gap_margin' must be absent where 'truth.gap' is not true, not 1; write gap = true"},
      {kScene + "[timing]\nrepeats = 0\n",
       "a/f.toml:4:11: 'timing.repeats' must be an integer between 1 and 1000, not 0"},
      {kScene + "[timing]\nrepeats = 1001\n", "not 1001"},
      {kScene + "[timing]\nrepeat = 1\n", "a/f.toml:4:1: unknown key 'timing.repeat'; did you mean 'repeats'?"},
      {kScene + "[timing]\nnoise = 1\n", "a/f.toml:4:9: 'timing.noise' must be"},
      {kScene + "[timing]\npin = -1\n", "a/f.toml:4:7: 'timing.pin' must be an integer of at least 0, not -1"},
      {kScene + "[timing]\npin = 5000\n", "a/f.toml:4:7: 'timing.pin' must be a processor that this program may use ("},
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
      {"steps = 1\nsteps = 2\n", "a/f.toml:2:9: not valid TOML: in key-value pair: cannot redefine"},
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
TEST(ConfigErrors, RefusesWrongTypesEverywhere) {
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

// toml++ 3.3 makes a table of each part of a key and crashed on 100000 of them when they were destroyed.
TEST(ConfigErrors, SurvivesDeepKeys) {
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

TEST(ConfigErrors, RefusesFilesThatAreNoText) {
  const fs::path folder = fs::temp_directory_path() / ("config_test_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const auto error = [](const fs::path& path) { return tests::coded_refusal_of([&] { read_config(path); }); };
  EXPECT_EQ(error(folder / "none.toml"),
            "3 " + (folder / "none.toml").string() +
                ": the configuration cannot be read (No such file or directory); name a TOML file");
  EXPECT_EQ(error(folder),
            "3 " + folder.string() + ": the configuration is a folder, not a regular file; name a TOML file");

  const fs::path big = folder / "big.toml";
  std::ofstream(big) << kScene;
  EXPECT_EQ(read_config(big).steps, 600);
  fs::resize_file(big, (16 << 20) + 1);
  EXPECT_EQ(error(big),
            "3 " + big.string() +
                ": the configuration has 16777217 bytes; such a file has at most 16777216; name a TOML file");

  if (::geteuid() != 0) {  // root may read everything
    fs::permissions(big, fs::perms::none);
    EXPECT_NE(error(big).find("cannot be read (Permission denied)"), std::string::npos);
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace pipeline
