// Every key of a configuration with its rule and default, and the way back to TOML. Source of the keys: README,
// "Configuration".
#include "pipeline/config.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <set>

#include "pipeline/document.hpp"
#include "pipeline/error.hpp"
#include "pipeline/words.hpp"

namespace pipeline {
namespace {

constexpr std::size_t kMostBytes = 16 << 20;
constexpr std::size_t kMostTitle = 1024;       // characters
constexpr std::int64_t kMostSteps = 10000000;  // at 274 bodies 120 GB of motion: further is a mistake
constexpr double kMostRate = 1e6;              // samples per second
constexpr std::int64_t kMostSegments = 1024;   // 4 million triangles per sphere
constexpr std::int64_t kMostBodies = 1000000;  // spheres of a scene: 5e11 pairs per step
constexpr double kMostLength = 1e6;            // m: beyond, a double's last digit is no longer below a nanometre
constexpr double kLeastLength = 1e-6;          // m
constexpr std::int64_t kMostRepeats = 1000;
constexpr Range kFinite{};
constexpr Range kNotNegative{.least = 0};
constexpr Range kPositive{.least = 0, .above = true};
constexpr Range kLength{.least = kLeastLength, .most = kMostLength};
constexpr Range kDensity{.least = 1e-6, .most = 1e6};  // kg/m^3
constexpr Range kCoordinate{.least = -kMostLength, .most = kMostLength};

// ---- Sections ----------------------------------------------------------------------------------------------------

std::string title(const Section& root, const std::string& preset) {
  const std::string value = root.text("title", preset);
  // Continuation bytes of UTF-8 start no character.
  const auto characters = std::ranges::count_if(value, [](char c) { return (c & 0xC0) != 0x80; });
  const bool control = std::ranges::any_of(value, [](char c) { return (c >= 0 && c < 0x20) || c == 0x7F; });
  if (control || static_cast<std::size_t>(characters) > kMostTitle)
    root.refuse("title", "be one line of at most " + std::to_string(kMostTitle) + " characters");
  return value;
}

/// The thesis's scene: one sphere onto another, ten onto ten, and a block of 6 x 6 x 6 onto 6 x 6.
std::vector<FallingSet> thesis_sets() {
  return {{.lying = {1, 1}, .above = {1, 1, 1}, .corner = {-14, -20}, .spacing = 2.1, .height = 5},
          {.lying = {10, 1}, .above = {10, 1, 1}, .corner = {-10, -18}, .spacing = 2.5, .height = 26},
          {.lying = {6, 6}, .above = {6, 6, 6}, .corner = {-5, -3}, .spacing = 2.1, .height = 75}};
}

FallingScene falling_scene(const Section& s) {
  s.only({"kind", "segments", "radius", "density", "plate", "shift", "set"});
  FallingScene scene;
  scene.segments = s.integer("segments", scene.segments, 1, kMostSegments);
  scene.radius = s.real("radius", scene.radius, kLength);
  scene.density = s.real("density", scene.density, kDensity);
  s.reals("plate", scene.plate, kLength);
  scene.shift = s.real("shift", scene.shift, kCoordinate);
  if (!s.has("set")) scene.sets = thesis_sets();
  std::int64_t spheres = 0;
  for (const Section& t : s.sections("set")) {
    t.only({"lying", "above", "corner", "spacing", "height"});
    FallingSet set;
    t.integers("lying", set.lying, 0, kMostBodies);
    t.integers("above", set.above, 0, kMostBodies);
    t.reals("corner", set.corner, kCoordinate);
    set.spacing = t.real("spacing", set.spacing, kLength);
    set.height = t.real("height", set.height, kCoordinate);
    // At most 1e6 + 1e12 + 1e18: no overflow.
    spheres += set.lying[0] * set.lying[1] + set.above[0] * set.above[1] * set.above[2];
    if (spheres > kMostBodies)
      t.fail("'scene.set' must hold at most " + std::to_string(kMostBodies) + " spheres, not " +
             std::to_string(spheres) + "; lower 'lying' or 'above'");
    scene.sets.push_back(set);
  }
  if (s.has("set") && spheres == 0) s.fail("'scene.set' must hold at least 1 sphere, not 0; raise 'lying' or 'above'");
  return scene;
}

/// The scene by its kind.
FallingScene scene(const Section& root) {
  const Section s = root.section("scene");
  if (!s.exists()) root.fail("missing table [scene]; write [scene] and below it kind = \"falling\"");
  if (!s.has("kind")) s.fail("missing key 'scene.kind'; write kind = \"falling\"");
  s.choice("kind", "", {"falling"});
  return falling_scene(s);
}

void read_physics(const Section& s, Config& config) {
  s.only({"integrator", "accuracy", "gravity", "linear_damping", "angular_damping", "stiffness", "dissipation",
          "static_friction", "dynamic_friction", "viscous_friction", "transition_velocity", "contact_radius",
          "step_budget", "time_budget", "energy_bound"});
  Physics& p = config.physics;
  Material& m = p.material;
  p.integrator = s.choice("integrator", p.integrator, integrator_names());
  p.accuracy = s.real("accuracy", p.accuracy, {.least = 0, .most = 1, .above = true, .below = true});
  s.reals("gravity", p.gravity, kFinite);
  p.linear_damping = s.real("linear_damping", p.linear_damping, kNotNegative);
  p.angular_damping = s.real("angular_damping", p.angular_damping, kNotNegative);
  m.stiffness = s.real("stiffness", m.stiffness, kPositive);
  m.dissipation = s.real("dissipation", m.dissipation, kNotNegative);
  m.static_friction = s.real("static_friction", m.static_friction, kNotNegative);
  m.dynamic_friction = s.real("dynamic_friction", m.dynamic_friction, kNotNegative);
  m.viscous_friction = s.real("viscous_friction", m.viscous_friction, kNotNegative);
  m.transition_velocity = s.real("transition_velocity", m.transition_velocity, kPositive);
  const bool nominal = s.choice("contact_radius", "inscribed", {"inscribed", "nominal"}) == "nominal";
  config.contact_radius = nominal ? ContactRadius::nominal : ContactRadius::inscribed;
  p.step_budget = s.integer("step_budget", p.step_budget, 1);
  p.time_budget = s.real("time_budget", p.time_budget, kNotNegative);
  p.energy_bound = s.real("energy_bound", p.energy_bound, {.least = 1, .above = true});
}

Containment containment(const Section& s) {
  s.only({"containment"});
  if (s.choice("containment", "ignore", {"ignore", "record", "meet"}) != "ignore")
    s.refuse("containment", "be \"ignore\"", "this version does not look for bodies inside others");
  return Containment::ignore;
}

// ---- Algorithms --------------------------------------------------------------------------------------------------

bool valid_label(std::string_view label) {
  constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.+-";
  // A label names a group of the file and a folder of the run: "." and ".." mean something else there.
  return !label.empty() && label.size() <= 64 && label.find_first_not_of(kAllowed) == std::string_view::npos &&
         label != "." && label != "..";
}

algorithms::Value knob_value(const Section& s, const algorithms::Knob& knob) {
  // What is no knob's type (a date, an array) becomes a wrong type, so that `checked` states the rule.
  const algorithms::Value wrong = std::holds_alternative<bool>(knob.preset) ? algorithms::Value(0.0) : false;
  const algorithms::Value value = s.scalar(knob.name).value_or(wrong);
  try {
    return algorithms::checked(knob, value);
  } catch (const std::invalid_argument& error) {
    std::string rule = error.what();
    if (rule.starts_with("must ")) rule.erase(0, std::strlen("must "));
    const auto* text = std::get_if<std::string>(&value);
    const std::string meant = text ? nearest(*text, knob.choices) : "";
    s.refuse(knob.name, rule, meant.empty() ? "" : "did you mean '" + meant + "'?");
  }
}

/// One algorithm from a table with name, label and knobs.
AlgorithmChoice algorithm_choice(const Section& s) {
  std::vector<std::string> names;
  for (const algorithms::Algorithm& a : algorithms::all()) names.push_back(a.name);
  if (!s.has("name")) s.fail("missing key '" + s.full("name") + "'; " + hint("", names));
  const std::string name = s.text("name", "");
  const algorithms::Algorithm* row = algorithms::find(name);
  if (!row) s.refuse("name", "be the name of an algorithm", hint(name, names));

  std::vector<std::string> known{"name", "label"};
  for (const algorithms::Knob& knob : row->knobs) known.push_back(knob.name);
  s.only(known);
  AlgorithmChoice choice{.name = name, .label = s.text("label", name), .knobs = algorithms::presets(*row)};
  if (!valid_label(choice.label))
    s.refuse("label", "be 1 to 64 characters of A-Z a-z 0-9 _ . + - and neither '.' nor '..'");
  for (const algorithms::Knob& knob : row->knobs)
    if (s.has(knob.name)) choice.knobs[knob.name] = knob_value(s, knob);
  return choice;
}

std::vector<AlgorithmChoice> algorithm_choices(const Section& root) {
  std::vector<AlgorithmChoice> out;
  if (!root.has("algorithm")) {
    for (const algorithms::Algorithm& a : algorithms::all())
      if (!a.thesis_key.empty()) out.push_back({a.name, a.name, algorithms::presets(a)});
    return out;
  }
  std::set<std::string> taken;
  for (const Section& s : root.sections("algorithm")) {
    out.push_back(algorithm_choice(s));
    if (taken.insert(out.back().label).second) continue;
    const std::string rule = "be the only one of its label";
    if (s.has("label")) s.refuse("label", rule, "give each algorithm a label of its own");
    s.refuse("name", rule, "add a label, e.g. label = \"" + out.back().label + "_2\"");
  }
  if (out.empty()) root.refuse("algorithm", "hold at least one algorithm", "leave the key out for the thesis's nine");
  return out;
}

// ---- Back to TOML ------------------------------------------------------------------------------------------------

/// A knob's value in the notation that TOML and JSON share.
std::string value_text(const algorithms::Value& value) {
  if (const auto* v = std::get_if<bool>(&value)) return *v ? "true" : "false";
  if (const auto* v = std::get_if<std::int64_t>(&value)) return std::to_string(*v);
  if (const auto* v = std::get_if<double>(&value)) return real_text(*v);
  return in_quotes(std::get<std::string>(value));
}

template <class Values>
std::string list_text(const Values& values) {
  std::string out;
  for (const auto& value : values) out += (out.empty() ? "[" : ", ") + value_text(value);
  return out + ']';
}

/// Every key with its value, in a fixed order.
std::string effective(const Config& c) {
  std::string out;
  const auto line = [&](std::string_view key, const algorithms::Value& value) {
    out += std::string(key) + " = " + value_text(value) + '\n';
  };
  const auto list = [&](std::string_view key, const auto& values) {
    out += std::string(key) + " = " + list_text(values) + '\n';
  };
  line("title", c.title);
  line("seed", c.seed);
  line("steps", c.steps);
  line("rate", c.rate);

  out += "\n[scene]\n";
  line("kind", std::string("falling"));
  line("segments", c.scene.segments);
  line("radius", c.scene.radius);
  line("density", c.scene.density);
  list("plate", c.scene.plate);
  line("shift", c.scene.shift);
  for (const FallingSet& set : c.scene.sets) {
    out += "\n[[scene.set]]\n";
    list("lying", set.lying);
    list("above", set.above);
    list("corner", set.corner);
    line("spacing", set.spacing);
    line("height", set.height);
  }

  const Physics& p = c.physics;
  out += "\n[physics]\n";
  line("integrator", p.integrator);
  line("accuracy", p.accuracy);
  list("gravity", p.gravity);
  line("linear_damping", p.linear_damping);
  line("angular_damping", p.angular_damping);
  line("stiffness", p.material.stiffness);
  line("dissipation", p.material.dissipation);
  line("static_friction", p.material.static_friction);
  line("dynamic_friction", p.material.dynamic_friction);
  line("viscous_friction", p.material.viscous_friction);
  line("transition_velocity", p.material.transition_velocity);
  line("contact_radius", std::string(c.contact_radius == ContactRadius::nominal ? "nominal" : "inscribed"));
  line("step_budget", p.step_budget);
  line("time_budget", p.time_budget);
  line("energy_bound", p.energy_bound);

  out += "\n[truth]\n";
  line("containment", std::string("ignore"));
  out += "\n[timing]\n";
  line("repeats", c.repeats);
  for (const AlgorithmChoice& a : c.algorithms) {
    out += "\n[[algorithm]]\n";
    line("name", a.name);
    line("label", a.label);
    for (const auto& [knob, value] : a.knobs) line(knob, value);
  }
  return out;
}

/// The file's bytes, at most kMostBytes + 1 of them.
std::string bytes_of(const std::filesystem::path& path) {
  const std::string file = one_line(path.string(), 4096);
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!stream) throw Error(kInput, file + ": the configuration cannot be opened: " + std::strerror(errno));
  std::string text;
  char block[1 << 16];
  while (text.size() <= kMostBytes) {
    const std::size_t got = std::fread(block, 1, sizeof block, stream.get());
    if (got == 0) break;
    text.append(block, got);
  }
  // fopen opens folders; reading them fails.
  if (std::ferror(stream.get()))
    throw Error(kInput, file + ": the configuration cannot be read: " + std::strerror(errno));
  return text;
}

}  // namespace

Config parse_config(const std::string& text, const std::filesystem::path& path, const std::vector<std::string>& sets) {
  const std::string file = one_line(path.string(), 4096);
  if (text.size() > kMostBytes) throw Error(kInput, file + ": a configuration must be at most 16 MiB long, not more");
  Document document(text, file);
  for (const std::string& set : sets) document.set(set);

  const Section root(document);
  root.only({"title", "seed", "steps", "rate", "scene", "physics", "truth", "timing", "algorithm"});
  Config config;
  config.path = path;
  config.text = text;
  config.title = title(root, one_line(path.stem().string(), kMostTitle));
  config.seed = root.integer("seed", config.seed, 0);
  config.steps = root.integer("steps", config.steps, 1, kMostSteps);
  config.rate = root.real("rate", config.rate, {.least = 0, .most = kMostRate, .above = true});
  config.scene = scene(root);
  read_physics(root.section("physics"), config);
  config.containment = containment(root.section("truth"));
  config.repeats = root.section("timing").only({"repeats"}).integer("repeats", config.repeats, 1, kMostRepeats);
  config.algorithms = algorithm_choices(root);
  config.effective = effective(config);
  return config;
}

Config read_config(const std::filesystem::path& path, const std::vector<std::string>& sets) {
  return parse_config(bytes_of(path), path, sets);
}

AlgorithmChoice parse_algorithm(const std::string& argument) {
  const std::string place = "--algorithm " + one_line(argument);
  if (const auto flaw = first_flaw(argument)) throw Error(kInput, place + ": " + flaw->what);
  std::map<std::string, std::string> texts, knobs;
  std::string rest = argument;
  if (const std::size_t at = rest.rfind('@'); at != std::string::npos) {
    texts["label"] = rest.substr(at + 1);
    rest.erase(at);
  }
  const std::size_t colon = std::min(rest.find(':'), rest.size());
  texts["name"] = rest.substr(0, colon);
  for (std::size_t begin = colon + 1; begin <= rest.size();) {
    const std::size_t end = std::min(rest.find(',', begin), rest.size());
    const std::string setting = rest.substr(begin, end - begin);
    const std::size_t equals = setting.find('=');
    const std::string knob = setting.substr(0, equals);
    if (equals == std::string::npos || knob.empty() || texts.contains(knob))
      throw Error(kInput,
                  place + ": must be NAME[:knob=value,...][@LABEL], not with '" + one_line(setting) + "' in it");
    if (!knobs.emplace(knob, setting.substr(equals + 1)).second)
      throw Error(kInput, place + ": '" + one_line(knob) + "' must be given once, not again");
    begin = end + 1;
  }
  const Document document(texts, knobs, place);
  return algorithm_choice(Section(document));
}

std::string knobs_json(const algorithms::Knobs& knobs) {
  std::string out = "{";
  for (const auto& [knob, value] : knobs) {
    if (out.size() > 1) out += ',';
    out += in_quotes(knob) + ':' + value_text(value);
  }
  return out + '}';
}

}  // namespace pipeline
