// Every key of a configuration with its rule and default, and the way back to TOML. Source of the keys:
// configs/README.md.
#include "pipeline/config.hpp"

#include <fcntl.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <set>
#include <sstream>

#include "algorithms/contract/proxy_files.hpp"
#include "pipeline/foreign/foreign.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/scene/document.hpp"
#include "pipeline/scene/mesh_input.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/study/study.hpp"
#include "pipeline/system/file_bytes.hpp"
#include "pipeline/system/pinned.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

constexpr std::size_t kMostBytes = 16 << 20;
constexpr std::size_t kMostTitle = 1024;       // characters
constexpr std::int64_t kMostSteps = 10000000;  // at 274 bodies 120 GB of motion: further is a mistake
constexpr std::int64_t kMostRepeats = 1000;
constexpr double kGapMargin = 0.1;          // m
constexpr double kMostClosedWithin = 1e-3;  // of a mesh's size: more is no hair, but the mesh
constexpr Range kFinite{};
constexpr Range kNotNegative{.least = 0};
constexpr Range kPositive{.least = 0, .above = true};

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

/// The scene by its kind; sets config.scene and, when the kind is integrated, the presets of config.physics.
void read_scene(const Section& root, Config& config) {
  const Section s = root.section("scene");
  if (!s.exists()) root.fail("missing table [scene]; write [scene] and below it kind = \"falling\"");
  std::vector<std::string> names;
  for (const SceneKind& kind : scene_kinds()) names.push_back(kind.name);
  if (!s.has("kind")) s.fail("missing key 'scene.kind'; write kind = \"falling\" or another of `pipeline list scenes`");
  const std::string name = s.choice("kind", "", names);
  config.scene_kind = std::ranges::find(scene_kinds(), name, &SceneKind::name).operator->();
  config.scene_kind->read(s, config);
}

void read_physics(const Section& s, Config& config) {
  if (!config.scene_kind->integrated) {
    if (s.exists()) s.fail("'physics' is not for this kind of scene: nothing is integrated; remove the table");
    return;
  }
  s.only({"bodies", "integrator", "accuracy", "gravity", "linear_damping", "angular_damping", "stiffness",
          "dissipation", "static_friction", "dynamic_friction", "viscous_friction", "transition_velocity",
          "contact_radius", "step_budget", "time_budget", "energy_bound"});
  Physics& p = config.physics;
  Material& m = p.material;
  p.bodies = s.choice("bodies", "free", {"free", "tree"}) == "tree" ? BodyModel::tree : BodyModel::free;
  p.integrator = s.choice("integrator", p.integrator, integrator_names());
  p.accuracy = s.real("accuracy", p.accuracy, {.least = 0, .most = 1, .above = true, .below = true});
  s.reals("gravity", p.gravity, kFinite);
  p.linear_damping = s.real("linear_damping", p.linear_damping, kNotNegative);
  p.angular_damping = s.real("angular_damping", p.angular_damping, kNotNegative);
  m.stiffness = s.real("stiffness", m.stiffness, kPositive);
  m.dissipation = s.real("dissipation", m.dissipation, kNotNegative);
  m.static_friction = s.real("static_friction", m.static_friction, kNotNegative);
  m.dynamic_friction = s.real("dynamic_friction", m.dynamic_friction, kNotNegative);
  if (m.static_friction < m.dynamic_friction)
    s.fail("'physics.static_friction' must be at least physics.dynamic_friction, not " + real_text(m.static_friction) +
           " below " + real_text(m.dynamic_friction));
  m.viscous_friction = s.real("viscous_friction", m.viscous_friction, kNotNegative);
  m.transition_velocity = s.real("transition_velocity", m.transition_velocity, kPositive);
  const bool nominal = s.choice("contact_radius", "inscribed", {"inscribed", "nominal"}) == "nominal";
  config.contact_radius = nominal ? ContactRadius::nominal : ContactRadius::inscribed;
  p.step_budget = s.integer("step_budget", p.step_budget, 1);
  p.time_budget = s.real("time_budget", p.time_budget, kNotNegative);
  p.energy_bound = s.real("energy_bound", p.energy_bound, {.least = 1, .above = true});
}

void read_truth(const Section& s, Config& config) {
  s.only({"containment", "closed_within", "gap", "gap_margin"});
  config.containment = *containment_of(s.choice("containment", "ignore", {"ignore", "record", "meet"}));
  config.closed_within = s.real("closed_within", config.closed_within, {.least = 0, .most = kMostClosedWithin});
  if (s.boolean("gap", false))
    config.gap_margin = s.real("gap_margin", kGapMargin, {.least = 0, .most = kMostLength});
  else if (s.has("gap_margin"))
    s.refuse("gap_margin", "be absent where 'truth.gap' is not true", "write gap = true, or remove it");
}

// ---- Algorithms --------------------------------------------------------------------------------------------------

algorithms::Value knob_value(const Section& s, const algorithms::Knob& knob) {
  // What is no knob's type (a date, an array) becomes a wrong type, so that `checked` states the rule.
  algorithms::Value wrong = false;
  if (std::holds_alternative<bool>(knob.preset)) wrong = 0.0;
  const algorithms::Value value = s.scalar(knob.name).value_or(wrong);
  try {
    return algorithms::checked(knob, value);
  } catch (const std::invalid_argument& error) {
    std::string rule = error.what();
    if (rule.starts_with("must ")) rule.erase(0, std::strlen("must "));
    const auto* text = std::get_if<std::string>(&value);
    std::string remedy;
    const bool other = knob.role == algorithms::Role::prefilter || knob.role == algorithms::Role::then;
    if (const algorithms::Algorithm* named = text && other ? algorithms::find(*text) : nullptr)
      remedy = named->scope == algorithms::Scope::scene
                   ? "it has a broad phase of its own"
                   : "a method of a library answers in a process of its own and cannot stand beside another";
    else if (const std::string meant = text ? nearest(*text, knob.choices) : ""; !meant.empty())
      remedy = "did you mean '" + meant + "'?";
    s.refuse(knob.name, rule, remedy);
  }
}

/// What every method of others may take: keys of its [[algorithm]] that are no knobs.
constexpr std::array<std::string_view, 3> kBudgetKeys = {"step_budget", "time_budget", "memory_budget"};

Budget read_budget(const Section& s) {
  constexpr std::int64_t kLeastMemory = 16, kMostMemory = 1 << 24;  // MiB
  Budget out;
  out.step = s.real("step_budget", out.step, kPositive);
  out.all = s.real("time_budget", out.all, kPositive);
  out.memory =
      static_cast<std::uint64_t>(s.integer("memory_budget", std::int64_t(out.memory >> 20), kLeastMemory, kMostMemory))
      << 20;
  return out;
}

/// The words of a command: an array of texts, or one text that is parted at blanks.
std::vector<std::string> command_words(const Section& s) {
  std::vector<std::string> words;
  const std::string rule = "be a program and its words, e.g. [\"python3\", \"mine.py\"]";
  if (!s.has("command")) s.fail("missing key '" + s.full("command") + "'; write command = [\"python3\", \"mine.py\"]");
  if (const auto value = s.scalar("command")) {
    if (!std::holds_alternative<std::string>(*value)) s.refuse("command", rule);
    std::istringstream text(std::get<std::string>(*value));
    for (std::string word; text >> word;) words.push_back(word);
  } else {
    words = s.texts("command");
  }
  if (words.empty() || words.front().empty()) s.refuse("command", rule);
  for (const std::string& word : words)
    if (word.find('\0') != std::string::npos) s.refuse("command", rule);
  return words;
}

/// A program of others: every key that is not one of ours is handed on to it.
AlgorithmChoice program_choice(const Section& s, const std::filesystem::path& folder) {
  AlgorithmChoice choice{.name = "program", .label = s.text("label", "program"), .knobs = {}};
  choice.foreign = std::make_shared<Foreign>(program({command_words(s), folder}, read_budget(s)));
  choice.optional = s.boolean("optional", false);
  for (const std::string& key : s.keys()) {
    if (key == "name" || key == "label" || key == "command" || key == "optional" ||
        std::ranges::count(kBudgetKeys, key))
      continue;
    const bool plain = key.size() <= 64 && std::ranges::all_of(key, [](unsigned char c) {
                         return std::isalnum(c) || c == '_' || c == '-';
                       });
    const auto value = s.scalar(key);
    if (!plain || !value)
      s.refuse(key, "be handed on to a program as a number, a text or a flag under a name of A-Z a-z 0-9 _ -");
    if (const auto* real = std::get_if<double>(&*value); real && !std::isfinite(*real)) s.refuse(key, "be finite");
    choice.knobs[key] = *value;
  }
  return choice;
}

/// The files of a knob of Role::files: a table {mesh = "file"}, or the same as one text "mesh=file;mesh=file", as which
/// the knob is kept.
void read_files(const Section& s, const std::string& knob, const std::filesystem::path& folder,
                AlgorithmChoice& choice) {
  const std::string rule = "name a file for each mesh, e.g. {hero = \"hero_hull.obj\"}";
  if (!s.has(knob) || s.scalar(knob) == Document::Scalar(std::string())) return;  // the preset: no file
  choice.place = s.place(knob);
  choice.folder = folder;
  if (const auto value = s.scalar(knob)) {
    if (!std::holds_alternative<std::string>(*value)) s.refuse(knob, rule);
    std::istringstream text(std::get<std::string>(*value));
    for (std::string one; std::getline(text, one, ';');) {
      const std::size_t equals = one.find('=');
      if (equals == 0 || equals == std::string::npos || equals + 1 == one.size()) s.refuse(knob, rule);
      choice.files.push_back({one.substr(0, equals), one.substr(equals + 1),
                              choice.place + ": '" + s.full(knob) + "." + one.substr(0, equals) + "'"});
    }
  } else {
    const Section table = s.section(knob);
    for (const std::string& mesh : table.keys())
      choice.files.push_back({mesh, table.text(mesh, ""), place_of(table, mesh.c_str())});
  }
  if (choice.files.empty()) s.refuse(knob, rule);
  std::string text;
  std::set<std::string> taken;
  for (const FileOfMesh& file : choice.files) {
    if (file.written.empty() || file.written.find_first_of(";\n") != std::string::npos || !valid_label(file.mesh) ||
        !taken.insert(file.mesh).second)
      throw Error(kInput, file.place + " must name one file, without a semicolon in its name, for one mesh");
    text += (text.empty() ? "" : ";") + file.mesh + "=" + file.written;
  }
  choice.knobs[knob] = text;
}

/// One algorithm from a table with name, label and knobs. Where nobody says whether bodies inside others are hits, it
/// follows the truth: an exact method then keeps its promise, which is judged on the truth that scores.
AlgorithmChoice algorithm_choice(const Section& s, Containment containment, const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const algorithms::Algorithm& a : algorithms::all()) names.push_back(a.name);
  for (const algorithms::Algorithm& a : algorithms::added()) names.push_back(a.name);
  names.push_back(program_row().name);
  if (!s.has("name")) s.fail("missing key '" + s.full("name") + "'; " + hint("", names));
  const std::string name = s.text("name", "");
  if (name == program_row().name) {
    AlgorithmChoice choice = program_choice(s, folder);
    if (!valid_label(choice.label)) s.refuse("label", kLabelRule);
    return choice;
  }
  if (const algorithms::Algorithm* missing = algorithms::find_missing(name))
    if (const std::string needed = lacking(*missing); !needed.empty())
      s.refuse("name", "be an algorithm of this build", "it needs " + needed);
  const algorithms::Algorithm* row = algorithms::find(name);
  if (!row) s.refuse("name", "be the name of an algorithm", hint(name, names));

  std::vector<std::string> known{"name", "label", "optional"};
  for (const algorithms::Knob& knob : row->knobs) known.push_back(knob.name);
  const bool foreign = !row->library.sha256.empty();
  if (foreign) known.insert(known.end(), kBudgetKeys.begin(), kBudgetKeys.end());
  s.only(known);
  AlgorithmChoice choice{.name = name, .label = s.text("label", name), .knobs = algorithms::presets(*row)};
  if (!valid_label(choice.label)) s.refuse("label", kLabelRule);
  for (const algorithms::Knob& knob : row->knobs) {
    if (knob.role == algorithms::Role::files) {
      read_files(s, knob.name, folder, choice);
      continue;
    }
    if (knob.role == algorithms::Role::containment) choice.knobs[knob.name] = containment == Containment::meet;
    if (s.has(knob.name)) choice.knobs[knob.name] = knob_value(s, knob);
  }
  if (foreign) choice.foreign = std::make_shared<Foreign>(library(*row, choice.knobs, read_budget(s)));
  choice.optional = foreign && s.boolean("optional", false);
  return choice;
}

/// What a table needs that is not here, where it may be left out for it; else empty. That is so with optional = true,
/// or where a result was read that another build made or that names programs and libraries: they may be anybody's, and
/// it starts none.
std::string lacks(const Section& s, const Config& config, bool recorded) {
  const std::string name = s.text("name", "");
  if (recorded && name == program_row().name)
    return "its program, which no result starts by itself; give it with --algorithm program:command=...";
  const algorithms::Algorithm* missing = algorithms::find_missing(name);
  if (const bool may_go = s.boolean("optional", false); missing && (may_go || recorded))
    if (const std::string needed = lacking(*missing); !needed.empty()) return needed;
  if (!recorded || config.plugins.empty() || algorithms::find(name)) return "";
  std::string libraries;
  for (const Plugin& plugin : config.plugins)
    libraries += (libraries.empty() ? "" : " or ") + one_line(plugin.written, 200);
  return "its library, which no result starts by itself; give it with --plugin (" + libraries + ")";
}

/// The libraries, whose rows join the table unless `recorded`.
std::vector<Plugin> read_plugins(const Section& root, const std::filesystem::path& folder, bool recorded) {
  std::vector<Plugin> out;
  if (!root.has("plugin")) return out;
  for (const Section& s : root.sections("plugin")) {
    s.only({"path"});
    if (!s.has("path")) s.fail("missing key '" + s.full("path") + "'; write path = \"libmine.so\"");
    const std::string path = s.text("path", "");
    if (path.empty()) s.refuse("path", "name a shared library");
    out.push_back(recorded ? Plugin{path, {}, {}} : add_plugin(path, folder, s.place("path")));
  }
  return out;
}

/// `recorded`: of a result.
std::vector<AlgorithmChoice> algorithm_choices(const Section& root, Config& config, bool recorded) {
  std::vector<AlgorithmChoice> out;
  if (!root.has("algorithm")) {
    for (const algorithms::Algorithm& a : algorithms::all())
      if (!a.thesis_key.empty()) out.push_back({a.name, a.name, algorithms::presets(a), nullptr});
    return out;
  }
  std::set<std::string> taken;
  std::vector<std::string> missing;
  for (const Section& s : root.sections("algorithm")) {
    if (const std::string lacking = lacks(s, config, recorded); !lacking.empty()) {
      missing.push_back("algorithm '" + s.text("label", s.text("name", "")) + "' is left out: it needs " + lacking);
      continue;
    }
    out.push_back(algorithm_choice(s, config.containment, config.path.parent_path()));
    if (taken.insert(out.back().label).second) continue;
    const std::string rule = "be the only one of its label";
    if (s.has("label")) s.refuse("label", rule, "give each algorithm a label of its own");
    s.refuse("name", rule, "add a label, e.g. label = \"" + out.back().label + "_2\"");
  }
  if (out.empty() && !recorded)
    root.refuse("algorithm", "hold at least one algorithm" + std::string(missing.empty() ? "" : " of this build"),
                "leave the key out for the thesis's nine");
  config.notes.insert(config.notes.end(), missing.begin(), missing.end());
  return out;
}

// ---- Back to TOML ------------------------------------------------------------------------------------------------

void write_foreign(const Foreign& foreign, TomlText& out) {
  if (!foreign.command.words.empty()) out.list("command", foreign.command.words);
  out.line("step_budget", foreign.budget.step);
  out.line("time_budget", foreign.budget.all);
  out.line("memory_budget", std::int64_t(foreign.budget.memory >> 20));
}

/// Every key with its value, in a fixed order.
std::string effective(const Config& c) {
  TomlText out;
  out.line("title", c.title);
  if (c.study) {
    write_study(*c.study, out);
    return out.text;
  }
  out.line("seed", c.seed);
  out.line("steps", c.steps);
  out.line("rate", c.rate);

  out.table("[scene]");
  out.line("kind", c.scene_kind->name);
  c.scene_kind->write(c, out);

  if (c.scene_kind->integrated) {
    const Physics& p = c.physics;
    out.table("[physics]");
    out.line("bodies", std::string(p.bodies == BodyModel::tree ? "tree" : "free"));
    out.line("integrator", p.integrator);
    out.line("accuracy", p.accuracy);
    out.list("gravity", p.gravity);
    out.line("linear_damping", p.linear_damping);
    out.line("angular_damping", p.angular_damping);
    out.line("stiffness", p.material.stiffness);
    out.line("dissipation", p.material.dissipation);
    out.line("static_friction", p.material.static_friction);
    out.line("dynamic_friction", p.material.dynamic_friction);
    out.line("viscous_friction", p.material.viscous_friction);
    out.line("transition_velocity", p.material.transition_velocity);
    out.line("contact_radius", std::string(c.contact_radius == ContactRadius::nominal ? "nominal" : "inscribed"));
    out.line("step_budget", p.step_budget);
    out.line("time_budget", p.time_budget);
    out.line("energy_bound", p.energy_bound);
  }

  out.table("[truth]");
  out.line("containment", std::string(text_of(c.containment)));
  out.line("closed_within", c.closed_within);
  out.line("gap", c.gap_margin.has_value());
  if (c.gap_margin) out.line("gap_margin", *c.gap_margin);
  out.table("[timing]");
  out.line("repeats", c.repeats);
  out.line("noise", c.noise);
  if (c.pin) out.line("pin", *c.pin);
  for (const Plugin& plugin : c.plugins) {
    out.table("[[plugin]]");
    out.line("path", plugin.written);
  }
  for (const AlgorithmChoice& a : c.algorithms) {
    out.table("[[algorithm]]");
    out.line("name", a.name);
    out.line("label", a.label);
    if (a.foreign) write_foreign(*a.foreign, out);
    for (const auto& [knob, value] : a.knobs) out.line(knob, value);
  }
  return out.text;
}

/// Of a recorded configuration the processor may be another machine's.
void read_timing(const Section& timing, Config& config, bool recorded) {
  timing.only({"repeats", "noise", "pin"});
  config.repeats = timing.integer("repeats", config.repeats, 1, kMostRepeats);
  config.noise = timing.boolean("noise", config.noise);
  const std::int64_t pin = timing.integer("pin", -1, 0);
  if (pin < 0) return;
  config.pin = pin;
  if (!recorded && !has_processor(*config.pin))
    timing.refuse("pin", "be a processor that this program may use (" + processors_text() + ")", "or leave it out");
}

/// A seed from which nothing is drawn must not look as if it made a run of its own. The preset only says what is so
/// anyway, and stands in many a file: it is noted.
void refuse_idle_seed(Config& config) {
  const SceneKind& kind = *config.scene_kind;
  if (config.seed_place.empty() || (kind.draws && kind.draws(config))) return;
  const std::string remedy = kind.draw_by.empty() ? "remove it" : "remove it, or set " + kind.draw_by;
  const std::string where = config.seed_place + ": 'seed' ";
  const std::string why = ": nothing is drawn at random in this " + kind.name + " scene; " + remedy;
  if (config.seed != kSeed) throw Error(kInput, where + "must be left out, not " + std::to_string(config.seed) + why);
  config.notes.push_back(where + "changes nothing" + why);
}

std::string bytes_of(const std::filesystem::path& path) {
  try {
    return read_regular(AT_FDCWD, path, /*follow_links=*/true, kMostBytes);
  } catch (const FileFailure& failure) {
    throw Error(kInput, one_line(path.string(), 4096) + ": the configuration " + failure.what() + "; name a TOML file");
  }
}

/// What a configuration is read from: a file, whose libraries are looked at; a text; or a result.
enum class From { file, text, result };

Config read_document(const Document& document, const std::filesystem::path& path, From from,
                     std::vector<Plugin> plugins = {}) {
  const Section root(document);
  Config config;
  config.path = path;
  config.title = title(root, one_line(path.stem().string(), kMostTitle));
  if (root.has("study")) {
    config.study = read_study(root);
    config.effective = effective(config);
    return config;
  }
  root.only({"title", "seed", "steps", "rate", "scene", "physics", "truth", "timing", "plugin", "algorithm"});
  config.seed = root.integer("seed", config.seed, 0);
  if (root.has("seed")) config.seed_place = root.place("seed");
  config.steps = root.integer("steps", config.steps, 1, kMostSteps);
  config.rate = root.real("rate", config.rate, {.least = kLeastRate, .most = kMostRate});
  if (root.has("steps")) config.steps_place = root.place("steps");
  config.rate_given = root.has("rate");
  read_scene(root, config);
  if (config.scene_kind->steps) {
    const std::int64_t all = config.scene_kind->steps(config);
    config.steps = root.integer("steps", all, 1, all);
  }
  read_physics(root.section("physics"), config);
  read_truth(root.section("truth"), config);
  read_timing(root.section("timing"), config, from == From::result);
  config.plugins = std::move(plugins);
  for (Plugin& plugin : read_plugins(root, path.parent_path(), from != From::file))
    if (from != From::file || std::ranges::find(config.plugins, plugin.path, &Plugin::path) == config.plugins.end())
      config.plugins.push_back(std::move(plugin));
  config.algorithms = algorithm_choices(root, config, from == From::result);
  config.effective = effective(config);
  return config;
}

Config parsed(const std::string& text, const std::filesystem::path& path, const std::vector<std::string>& sets,
              From from, std::vector<Plugin> plugins = {}) {
  const std::string file = one_line(path.string(), 4096);
  if (text.size() > kMostBytes) throw Error(kInput, file + ": a configuration must be at most 16 MiB long, not more");
  Document document(text, file);
  for (const std::string& set : sets) document.set(set);
  Config config = read_document(document, path, from, std::move(plugins));
  config.text = text;
  return config;
}

}  // namespace

std::vector<AskedKey> asked_keys(const std::string& text) {
  std::vector<AskedKey> keys;
  Document document(text, "example");
  document.listen([&](const AskedKey& key) { keys.push_back(key); });
  read_document(document, "example.toml", From::text);
  return keys;
}

Config parse_config(const std::string& text, const std::filesystem::path& path, const std::vector<std::string>& sets) {
  return parsed(text, path, sets, From::text);
}

Config recorded_config(const std::string& effective, const std::string& file) {
  try {
    return parsed(effective, file + ": /config@effective", {}, From::result);
  } catch (const Error& error) {
    throw Error(kFile, error.what());  // nobody wrote it: it is part of the file
  }
}

namespace {

/// Reads what the files of a choice hold, and binds its row to it.
void read_solids(AlgorithmChoice& choice, double closed_within, std::vector<std::string>& notes) {
  SceneConfig reading;  // which knows where its files lie, and keeps their hashes
  reading.path = choice.folder / "configuration";
  NodeFiles nodes;
  std::map<std::string, std::vector<geometry::Mesh>> solids;
  for (const FileOfMesh& file : choice.files) {
    const MeshInput input = read_mesh(reading, {.file = file.written, .place = file.place}, file.mesh, nodes);
    try {
      solids[file.mesh] = algorithms::closed_components(input.mesh, closed_within);
    } catch (const std::invalid_argument& error) {
      throw Error(kInput, file.place + " must name closed surfaces, not " + in_quotes(one_line(file.written)) + ": " +
                              error.what() + "; close it");
    }
  }
  choice.inputs = reading.inputs;
  choice.bound = std::make_shared<algorithms::Algorithm>(algorithms::proxy_of(std::move(solids)));
  notes.insert(notes.end(), reading.notes.begin(), reading.notes.end());
}

/// The files of methods of others; what is optional and not here is left out.
void find_methods(Config& config) {
  const auto missing = find_files(config.algorithms);
  for (const std::string& note : read_proxies(config.algorithms, config.closed_within)) config.notes.push_back(note);
  for (const Plugin& plugin : config.plugins) config.inputs[plugin.written] = plugin.sha256;
  for (const AlgorithmChoice& choice : config.algorithms) {
    config.inputs.insert(choice.inputs.begin(), choice.inputs.end());
    if (choice.foreign) config.inputs.insert(choice.foreign->files.begin(), choice.foreign->files.end());
  }
  for (const std::string& note : leave_out(missing, config)) config.notes.push_back(note);
}

}  // namespace

Config kept_config(const std::string& effective, const std::filesystem::path& from, const std::string& part) {
  Config config = parsed(effective, from, {}, From::result);
  if (!config.notes.empty() || !config.plugins.empty())
    throw Error(kInput, part + ": " + (config.notes.empty() ? "names a library" : config.notes.front()) +
                            "; a part starts nothing by itself: name its configuration with --config");
  if (config.scene_kind->complete) config.scene_kind->complete(config);
  find_methods(config);
  return config;
}

Config read_config(const std::filesystem::path& path, const std::vector<std::string>& sets,
                   const std::vector<std::string>& plugins) {
  Config config = parsed(bytes_of(path), path, sets, From::file, add_plugins(plugins));
  if (config.study) return config;
  refuse_idle_seed(config);
  if (config.scene_kind->complete) {
    config.scene_kind->complete(config);
    config.effective = effective(config);
  }
  find_methods(config);
  return config;
}

std::vector<std::string> leave_out(const std::map<std::string, std::string>& missing, Config& config) {
  std::vector<std::string> notes;
  if (missing.empty()) return notes;
  std::set<std::string> files, kept;
  for (const AlgorithmChoice& choice : config.algorithms) {
    const auto found = missing.find(choice.label);
    if (found != missing.end())
      notes.push_back("algorithm '" + choice.label + "' is left out: " + one_line(found->second, 1000));
    if (choice.foreign)
      for (const auto& [file, hash] : choice.foreign->files) (found != missing.end() ? files : kept).insert(file);
  }
  for (const std::string& file : files)
    if (!kept.contains(file)) config.inputs.erase(file);
  std::erase_if(config.algorithms, [&](const AlgorithmChoice& choice) { return missing.contains(choice.label); });
  if (config.algorithms.empty()) throw Error(kInput, config.path.string() + ": " + notes.front() + "; so are all");
  config.effective = effective(config);
  return notes;
}

std::vector<std::string> read_proxies(std::vector<AlgorithmChoice>& choices, double closed_within) {
  std::vector<std::string> notes;
  for (AlgorithmChoice& choice : choices)
    if (!choice.files.empty() && !choice.bound) read_solids(choice, closed_within, notes);
  return notes;
}

std::map<std::string, std::string> find_files(std::vector<AlgorithmChoice>& choices) {
  std::map<std::string, std::string> missing;
  for (AlgorithmChoice& choice : choices) {
    if (!choice.foreign || choice.foreign->command.words.empty()) continue;
    Foreign found = *choice.foreign;
    const std::string& program = found.command.words.front();
    if (program_of(found.command).empty()) {
      const std::string none = "there is no program '" + one_line(program) + "' " +
                               (program.find('/') == std::string::npos ? "along PATH" : "that can be executed");
      if (choice.optional) {
        missing[choice.label] = none;
        continue;
      }
      throw Error(kInput,
                  "algorithm '" + choice.label + "': command \"" + text_of(found.command) + "\": " + none +
                      "; give its path, relative to the configuration, or to the current folder after --algorithm");
    }
    for (const auto& [word, file] : files_of(found.command)) {
      try {
        found.files[word] = sha256(read_regular(AT_FDCWD, file));
      } catch (const FileFailure&) {  // a program that may be executed and not read
      }
    }
    choice.foreign = std::make_shared<Foreign>(std::move(found));
  }
  return missing;
}

AlgorithmChoice parse_algorithm(const std::string& argument, Containment containment) {
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
    if (equals == std::string::npos || knob.empty() || knob == "optional" || texts.contains(knob))
      throw Error(kInput,
                  place + ": must be NAME[:knob=value,...][@LABEL], not with '" + one_line(setting) + "' in it");
    if (!knobs.emplace(knob, setting.substr(equals + 1)).second)
      throw Error(kInput, place + ": '" + one_line(knob) + "' must be given once, not again");
    begin = end + 1;
  }
  const Document document(texts, knobs, place);
  return algorithm_choice(Section(document), containment, {});
}

}  // namespace pipeline
