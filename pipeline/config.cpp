// TOML to values: every key of a configuration with its rule and default, and the way back to TOML. The only file that
// sees toml++. Source of the keys: README, "Configuration".
#include "pipeline/config.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <set>
#include <sstream>

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
constexpr const char* kLabelRule = "must be 1 to 64 characters of A-Z a-z 0-9 _ . + - (not '.' or '..' alone)";

// ---- Values and places -------------------------------------------------------------------------------------------

/// What the user wrote, for a message.
std::string text_of(const toml::node& node) {
  if (const auto* value = node.as_string()) return one_line(quoted(one_line(value->get())));
  if (const auto* value = node.as_integer()) return std::to_string(value->get());
  if (const auto* value = node.as_floating_point()) return real_text(value->get());
  if (const auto* value = node.as_boolean()) return value->get() ? "true" : "false";
  if (node.is_table()) return "a table";
  if (const auto* values = node.as_array()) {
    std::string out = "[";
    for (const toml::node& value : *values) {
      if (out.size() > 60) break;
      out += (out.size() > 1 ? ", " : "") + text_of(value);
    }
    return one_line(out + "]");
  }
  std::ostringstream out;
  if (const auto* value = node.as_date()) out << "the date " << value->get();
  if (const auto* value = node.as_time()) out << "the time " << value->get();
  if (const auto* value = node.as_date_time()) out << "the date " << value->get();
  return out.str();
}

std::string at(const std::string& file, const toml::source_region& source) {
  if (source.begin.line == 0) return file;
  return file + ':' + std::to_string(source.begin.line) + ':' + std::to_string(source.begin.column);
}

/// "a", "a or b", "a, b or c".
std::string alternatives(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i)
    out += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + quoted(words[i]);
  return out;
}

/// TOML text as a tree; `place` is what messages call it. With `lines`, line and column follow the place.
toml::table parsed(std::string_view text, const std::string& place, bool lines) {
  const auto where = [&](std::size_t line, std::size_t column) {
    return lines ? place + ':' + std::to_string(line) + ':' + std::to_string(column) : place;
  };
  // Before toml++, whose places of bad bytes are those of the character before, and whose depth is unlimited.
  if (const auto flaw = first_flaw(text)) throw Error(kInput, where(flaw->line, flaw->column) + ": " + flaw->what);
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    std::string why(error.description());
    if (why.starts_with("Error while parsing ")) why.replace(0, std::strlen("Error while parsing"), "in");
    if (why.find("could not determine value type") != std::string::npos) why += "; text stands in quotes";
    const auto& from = error.source().begin;
    throw Error(kInput, where(from.line, from.column) + ": not valid TOML: " + one_line(why, 200));
  }
}

/// VALUE of --set KEY=VALUE and of --algorithm's knob=VALUE as the only member "value" of a table: TOML, or a bare word
/// as text.
toml::table parsed_value(const std::string& value, const std::string& place) {
  if (const auto flaw = first_flaw(value)) throw Error(kInput, place + ": " + flaw->what);
  const std::size_t first = value.find_first_not_of(" \t");
  const bool bare = first == std::string::npos || std::strchr("\"'[{", value[first]) == nullptr;
  try {
    toml::table table = toml::parse("value = " + value);
    if (table.size() == 1) return table;
    throw Error(kInput, place + ": must be one value on one line");  // "5\nseed = 2"
  } catch (const toml::parse_error& error) {
    if (bare) return toml::table{{"value", value}};
    throw Error(kInput, place + ": not a TOML value: " + one_line(error.description(), 200));
  }
}

bool is_index(std::string_view part) {
  return !part.empty() && part.size() < 10 && part.find_first_not_of("0123456789") == std::string_view::npos;
}

/// The tree of a configuration, and where each part of it was written.
class Document {
 public:
  Document(const std::string& text, const std::string& file) : file_(file), root_(parsed(text, file, true)) {}

  const toml::table& root() const { return root_; }

  /// file:line:column of what stands under the dotted `path`, or the --set that put it there.
  std::string place(std::string path, const toml::source_region& source) const {
    while (true) {
      if (const auto set = set_places_.find(path); set != set_places_.end()) return set->second;
      const std::size_t dot = path.rfind('.');
      if (dot == std::string::npos) return at(file_, source);
      path.erase(dot);
    }
  }

  [[noreturn]] void fail(const std::string& path, const toml::source_region& source, const std::string& text) const {
    throw Error(kInput, place(path, source) + ": " + text);
  }

  /// Applies one "KEY=VALUE": tables that are missing are made, entries of arrays must exist.
  void set(const std::string& argument) {
    const std::string place = "--set " + one_line(argument);
    const std::size_t equals = argument.find('=');
    if (equals == std::string::npos) throw Error(kUsage, place + ": must be KEY=VALUE, e.g. --set steps=100");
    std::string key = argument.substr(0, equals);
    key.erase(key.find_last_not_of(" \t") + 1);
    key.erase(0, std::min(key.find_first_not_of(" \t"), key.size()));
    if (key.empty()) throw Error(kUsage, place + ": must be KEY=VALUE, e.g. --set steps=100; the key is empty");
    if (const auto flaw = first_flaw(key)) throw Error(kInput, place + ": " + flaw->what);

    toml::table value = parsed_value(argument.substr(equals + 1), place);
    toml::node* node = &root_;
    std::string path;  // of `node`
    for (std::size_t begin = 0; begin <= key.size();) {
      const std::size_t end = std::min(key.find('.', begin), key.size());
      const std::string part = key.substr(begin, end - begin);
      const bool last = end == key.size();
      if (part.empty()) throw Error(kInput, place + ": the key has an empty part; write TABLE.KEY=VALUE");
      const std::string outer = path;
      path += (path.empty() ? "" : ".") + part;
      if (toml::table* table = node->as_table()) {
        if (last) {
          value.get("value")->visit([&](auto& v) { table->insert_or_assign(part, std::move(v)); });
        } else if (!table->contains(part)) {
          const std::string next = key.substr(end + 1, key.find('.', end + 1) - end - 1);
          if (is_index(next))
            throw Error(kInput, place + ": '" + one_line(path) + "' is not in the configuration, so there is no entry " +
                                    next + " to change; write it there first, or set all of '" + one_line(path) + "'");
          table->insert(part, toml::table{});
          set_places_[path] = place;
        }
        node = table->get(part);
      } else if (toml::array* array = node->as_array()) {
        const std::size_t index = is_index(part) ? std::stoul(part) : array->size();
        if (index >= array->size())
          throw Error(kInput, place + ": '" + outer + "' has entries 0 to " + std::to_string(array->size()) +
                                  " (the last excluded), not '" + one_line(part) + "'");
        if (last) {
          array->erase(array->begin() + static_cast<std::ptrdiff_t>(index));
          value.get("value")->visit(
              [&](auto& v) { array->insert(array->begin() + static_cast<std::ptrdiff_t>(index), std::move(v)); });
        }
        node = array->get(index);
      } else {
        throw Error(kInput, place + ": '" + outer + "' is " + text_of(*node) + ", it has no key '" + one_line(part) + "'");
      }
      begin = end + 1;
    }
    // What an earlier --set put below is gone.
    std::erase_if(set_places_, [&](const auto& entry) { return entry.first.starts_with(path + '.'); });
    set_places_[path] = place;
  }

 private:
  std::string file_;
  toml::table root_;
  std::map<std::string, std::string> set_places_;  // dotted path → "--set ..."
};

// ---- Rules -------------------------------------------------------------------------------------------------------

/// Which reals are allowed.
struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool above = false;  // `least` itself is not allowed
  bool below = false;  // `most` itself is not allowed

  bool holds(double x) const {
    return std::isfinite(x) && (above ? x > least : x >= least) && (below ? x < most : x <= most);
  }
  std::string rule() const {
    std::string out = std::isinf(most) ? "a finite number" : "a number";
    if (!std::isinf(least)) out += (above ? " above " : " of at least ") + brief(least);
    if (!std::isinf(most)) out += (std::isinf(least) ? "" : " and") + std::string(below ? " below " : " at most ") + brief(most);
    return out;
  }

 private:
  static std::string brief(double x) {
    const std::string text = real_text(x);
    return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
  }
};
constexpr Range kFinite{};
constexpr Range kNotNegative{.least = 0};
constexpr Range kPositive{.least = 0, .above = true};
constexpr Range kLength{.least = kLeastLength, .most = kMostLength};
constexpr Range kCoordinate{.least = -kMostLength, .most = kMostLength};

bool valid_label(std::string_view label) {
  constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.+-";
  // A label names a group of the file and a folder of the run: "." and ".." mean something else there.
  return !label.empty() && label.size() <= 64 && label.find_first_not_of(kAllowed) == std::string_view::npos &&
         label != "." && label != "..";
}

/// One table of the configuration. A key that is absent gives its preset; whatever breaks a rule is thrown.
class Section {
 public:
  /// `table` may be absent (nullptr); `path` is its dotted key, empty for the root; keys other than `known` are refused.
  Section(const Document& document, const toml::table* table, const std::string& path,
          const std::vector<std::string>& known)
      : document_(document), table_(table), path_(path) {
    if (!table) return;
    const toml::key* unknown = nullptr;  // the first in the file
    for (const auto& [key, node] : *table) {
      if (std::ranges::find(known, key.str()) != known.end()) continue;
      const auto& from = key.source().begin;
      if (!unknown || std::pair(from.line, from.column) <
                          std::pair(unknown->source().begin.line, unknown->source().begin.column))
        unknown = &key;
    }
    if (unknown)
      document.fail(full(unknown->str()), unknown->source(),
                    "unknown key '" + one_line(full(unknown->str())) + "'; " + hint(unknown->str(), known));
  }

  std::string full(std::string_view key) const { return (path_.empty() ? "" : path_ + '.') + std::string(key); }

  const toml::node* node(std::string_view key) const { return table_ ? table_->get(key) : nullptr; }

  /// Throws "'key' must be RULE, not VALUE; REMEDY".
  [[noreturn]] void refuse(std::string_view key, const toml::node& node, const std::string& rule,
                           const std::string& remedy = "") const {
    document_.fail(full(key), node.source(), "'" + full(key) + "' must be " + rule + ", not " + text_of(node) +
                                                 (remedy.empty() ? "" : "; " + remedy));
  }

  /// Throws with the place of the table itself.
  [[noreturn]] void refuse_table(const std::string& text) const {
    document_.fail(path_, table_ ? table_->source() : toml::source_region{}, text);
  }

  const toml::table* table(std::string_view key) const {
    const toml::node* node = this->node(key);
    if (node && !node->is_table()) refuse(key, *node, "a table", "write [" + full(key) + "] on a line of its own");
    return node ? node->as_table() : nullptr;
  }

  /// The tables of [[key]]; none when it is absent.
  std::vector<const toml::table*> tables(std::string_view key) const {
    std::vector<const toml::table*> out;
    const toml::node* node = this->node(key);
    if (!node) return out;
    const std::string remedy = "write [[" + full(key) + "]] above each of them";
    if (!node->is_array()) refuse(key, *node, "an array of tables", remedy);
    for (const toml::node& entry : *node->as_array()) {
      if (!entry.is_table()) refuse(key, entry, "an array of tables", remedy);
      out.push_back(entry.as_table());
    }
    return out;
  }

  std::string text(std::string_view key, const std::string& preset) const {
    const toml::node* node = this->node(key);
    if (!node) return preset;
    if (!node->is_string()) refuse(key, *node, "text", "text stands in quotes");
    return node->as_string()->get();
  }

  std::string choice(std::string_view key, const std::string& preset, const std::vector<std::string>& known) const {
    const std::string value = text(key, preset);
    if (std::ranges::find(known, value) != known.end()) return value;
    const std::string meant = nearest(value, known);
    refuse(key, *node(key), alternatives(known), meant.empty() ? "" : "did you mean '" + meant + "'?");
  }

  std::int64_t integer(std::string_view key, std::int64_t preset, std::int64_t least,
                       std::int64_t most = std::numeric_limits<std::int64_t>::max()) const {
    const toml::node* node = this->node(key);
    return node ? integer_of(key, *node, least, most) : preset;
  }

  double real(std::string_view key, double preset, const Range& range) const {
    const toml::node* node = this->node(key);
    return node ? real_of(key, *node, range) : preset;
  }

  template <std::size_t N>
  std::array<std::int64_t, N> integers(std::string_view key, std::array<std::int64_t, N> values, std::int64_t least,
                                       std::int64_t most) const {
    each(key, values, "integers", [&](const std::string& k, const toml::node& n) { return integer_of(k, n, least, most); });
    return values;
  }

  template <std::size_t N>
  std::array<double, N> reals(std::string_view key, std::array<double, N> values, const Range& range) const {
    each(key, values, "numbers", [&](const std::string& k, const toml::node& n) { return real_of(k, n, range); });
    return values;
  }

 private:
  std::int64_t integer_of(std::string_view key, const toml::node& node, std::int64_t least, std::int64_t most) const {
    const auto* value = node.as_integer();
    if (value && least <= value->get() && value->get() <= most) return value->get();
    const bool open = most == std::numeric_limits<std::int64_t>::max();
    refuse(key, node, open ? "an integer of at least " + std::to_string(least)
                           : "an integer between " + std::to_string(least) + " and " + std::to_string(most));
  }

  double real_of(std::string_view key, const toml::node& node, const Range& range) const {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (const auto* real = node.as_floating_point()) value = real->get();
    if (const auto* integer = node.as_integer()) value = static_cast<double>(integer->get());
    if (!range.holds(value)) refuse(key, node, range.rule());
    return value;
  }

  template <class Values, class Read>
  void each(std::string_view key, Values& values, const std::string& what, const Read& read) const {
    const toml::node* node = this->node(key);
    if (!node) return;
    const toml::array* array = node->as_array();
    if (!array || array->size() != values.size())
      refuse(key, *node, "an array of " + std::to_string(values.size()) + ' ' + what);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = read(std::string(key) + '.' + std::to_string(i), *array->get(i));
  }

  const Document& document_;
  const toml::table* table_;
  std::string path_;
};

// ---- Sections ----------------------------------------------------------------------------------------------------

std::string title(const Section& root, const std::string& preset) {
  const std::string value = root.text("title", preset);
  // Continuation bytes of UTF-8 start no character.
  const auto characters = std::ranges::count_if(value, [](char c) { return (c & 0xC0) != 0x80; });
  const bool control = std::ranges::any_of(value, [](char c) { return (c >= 0 && c < 0x20) || c == 0x7F; });
  if (control || static_cast<std::size_t>(characters) > kMostTitle)
    root.refuse("title", *root.node("title"),
                "one line of at most " + std::to_string(kMostTitle) + " characters");
  return value;
}

/// The thesis's scene: one sphere onto another, ten onto ten, and a block of 6 x 6 x 6 onto 6 x 6.
std::vector<FallingSet> thesis_sets() {
  return {{.lying = {1, 1}, .above = {1, 1, 1}, .corner = {-14, -20}, .spacing = 2.1, .height = 5},
          {.lying = {10, 1}, .above = {10, 1, 1}, .corner = {-10, -18}, .spacing = 2.5, .height = 26},
          {.lying = {6, 6}, .above = {6, 6, 6}, .corner = {-5, -3}, .spacing = 2.1, .height = 75}};
}

FallingScene falling_scene(const Document& document, const Section& root) {
  const toml::table* table = root.table("scene");
  if (!table) root.refuse_table("missing table [scene]; write [scene] and kind = \"falling\"");
  const Section s(document, table, "scene",
                  {"kind", "segments", "radius", "density", "plate", "shift", "set"});
  if (!s.node("kind")) s.refuse_table("missing key 'scene.kind'; write kind = \"falling\"");
  s.choice("kind", "", {"falling"});

  FallingScene scene;
  scene.segments = s.integer("segments", scene.segments, 1, kMostSegments);
  scene.radius = s.real("radius", scene.radius, kLength);
  scene.density = s.real("density", scene.density, {.least = 1e-6, .most = 1e6});
  scene.plate = s.reals("plate", scene.plate, kLength);
  scene.shift = s.real("shift", scene.shift, kCoordinate);
  const auto tables = s.tables("set");
  if (!s.node("set")) scene.sets = thesis_sets();
  std::int64_t spheres = 0;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const Section t(document, tables[i], "scene.set." + std::to_string(i),
                    {"lying", "above", "corner", "spacing", "height"});
    FallingSet set;
    set.lying = t.integers("lying", set.lying, 0, kMostBodies);
    set.above = t.integers("above", set.above, 0, kMostBodies);
    set.corner = t.reals("corner", set.corner, kCoordinate);
    set.spacing = t.real("spacing", set.spacing, kLength);
    set.height = t.real("height", set.height, kCoordinate);
    // At most 1e12 + 1e18: no overflow.
    spheres += set.lying[0] * set.lying[1] + set.above[0] * set.above[1] * set.above[2];
    if (spheres > kMostBodies)
      t.refuse_table("'scene.set' must hold at most " + std::to_string(kMostBodies) + " spheres, not " +
                     std::to_string(spheres) + " up to this set; lower its 'lying' or 'above'");
    scene.sets.push_back(set);
  }
  if (s.node("set") && spheres == 0) s.refuse_table("'scene.set' must hold at least 1 sphere, not 0; raise 'lying' or 'above'");
  return scene;
}

const std::vector<std::string> kContactRadii{"inscribed", "nominal"};

void read_physics(const Document& document, const Section& root, Config& config) {
  const Section s(document, root.table("physics"), "physics",
                  {"integrator", "accuracy", "gravity", "linear_damping", "angular_damping", "stiffness", "dissipation",
                   "static_friction", "dynamic_friction", "viscous_friction", "transition_velocity", "contact_radius",
                   "step_budget", "time_budget", "energy_bound"});
  Physics& p = config.physics;
  Material& m = p.material;
  p.integrator = s.choice("integrator", p.integrator, integrator_names());
  p.accuracy = s.real("accuracy", p.accuracy, {.least = 0, .most = 1, .above = true, .below = true});
  p.gravity = s.reals("gravity", p.gravity, kFinite);
  p.linear_damping = s.real("linear_damping", p.linear_damping, kNotNegative);
  p.angular_damping = s.real("angular_damping", p.angular_damping, kNotNegative);
  m.stiffness = s.real("stiffness", m.stiffness, kPositive);
  m.dissipation = s.real("dissipation", m.dissipation, kNotNegative);
  m.static_friction = s.real("static_friction", m.static_friction, kNotNegative);
  m.dynamic_friction = s.real("dynamic_friction", m.dynamic_friction, kNotNegative);
  m.viscous_friction = s.real("viscous_friction", m.viscous_friction, kNotNegative);
  m.transition_velocity = s.real("transition_velocity", m.transition_velocity, kPositive);
  config.contact_radius = s.choice("contact_radius", "inscribed", kContactRadii) == "nominal" ? ContactRadius::nominal
                                                                                               : ContactRadius::inscribed;
  p.step_budget = s.integer("step_budget", p.step_budget, 1);
  p.time_budget = s.real("time_budget", p.time_budget, kNotNegative);
  p.energy_bound = s.real("energy_bound", p.energy_bound, {.least = 1, .above = true});
}

Containment containment(const Document& document, const Section& root) {
  const Section s(document, root.table("truth"), "truth", {"containment"});
  const std::string value = s.choice("containment", "ignore", {"ignore", "record", "meet"});
  if (value != "ignore")
    s.refuse("containment", *s.node("containment"), "\"ignore\"",
             "this version does not look for bodies inside others");
  return Containment::ignore;
}

std::vector<std::string> algorithm_names() {
  std::vector<std::string> out;
  for (const algorithms::Algorithm& a : algorithms::all()) out.push_back(a.name);
  return out;
}

/// The knob's value from what the user wrote; refused through `s` with the knob's rule.
algorithms::Value knob_value(const Section& s, const algorithms::Knob& knob, const toml::node& node) {
  std::optional<algorithms::Value> value;
  if (const auto* v = node.as_boolean()) value = v->get();
  if (const auto* v = node.as_integer()) value = v->get();
  if (const auto* v = node.as_string()) value = v->get();
  if (const auto* v = node.as_floating_point(); v && std::isfinite(v->get())) value = v->get();
  if (!value) s.refuse(knob.name, node, knob.choices.empty() ? "a finite number, an integer or true or false" : "text");
  try {
    return algorithms::checked(knob, *value);
  } catch (const std::invalid_argument& error) {
    std::string rule = error.what();
    if (rule.starts_with("must be ")) rule.erase(0, std::strlen("must be "));
    const std::string meant = node.is_string() ? nearest(node.as_string()->get(), knob.choices) : "";
    s.refuse(knob.name, node, rule, meant.empty() ? "" : "did you mean '" + meant + "'?");
  }
}

/// One algorithm from a table with name, label and knobs.
AlgorithmChoice algorithm_choice(const Document& document, const toml::table& table, const std::string& path) {
  std::vector<std::string> known{"name", "label"};
  const toml::node* name = table.get("name");
  const algorithms::Algorithm* row =
      name && name->is_string() ? algorithms::find(name->as_string()->get()) : nullptr;
  if (row)
    for (const algorithms::Knob& knob : row->knobs) known.push_back(knob.name);
  if (!name)
    document.fail(path, table.source(), "missing key 'name' of [[algorithm]]; " + hint("", algorithm_names()));
  if (!row) {
    const Section s(document, &table, path, {});
    if (!name->is_string()) s.refuse("name", *name, "text", "text stands in quotes");
    s.refuse("name", *name, "an algorithm", hint(name->as_string()->get(), algorithm_names()));
  }

  const Section s(document, &table, path, known);
  AlgorithmChoice choice{.name = row->name, .label = s.text("label", row->name), .knobs = algorithms::presets(*row)};
  if (!valid_label(choice.label)) s.refuse("label", *s.node("label"), std::string(kLabelRule).substr(8));
  for (const algorithms::Knob& knob : row->knobs)
    if (const toml::node* node = s.node(knob.name)) choice.knobs[knob.name] = knob_value(s, knob, *node);
  return choice;
}

std::vector<AlgorithmChoice> algorithm_choices(const Document& document, const Section& root) {
  std::vector<AlgorithmChoice> out;
  if (!root.node("algorithm")) {
    for (const algorithms::Algorithm& a : algorithms::all())
      if (!a.thesis_key.empty()) out.push_back({a.name, a.name, algorithms::presets(a)});
    return out;
  }
  const auto tables = root.tables("algorithm");
  if (tables.empty())
    root.refuse("algorithm", *root.node("algorithm"), "at least one [[algorithm]]",
                "leave the key out for the thesis's nine");
  std::set<std::string> taken;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string path = "algorithm." + std::to_string(i);
    out.push_back(algorithm_choice(document, *tables[i], path));
    if (taken.insert(out.back().label).second) continue;
    const toml::node* label = tables[i]->get("label");
    document.fail(label ? path + ".label" : path, label ? label->source() : tables[i]->source(),
                  "'" + path + ".label' must be unique, not " + quoted(out.back().label) +
                      " again; give it a label of its own");
  }
  return out;
}

// ---- Back to TOML ------------------------------------------------------------------------------------------------

/// A knob's value in the notation that TOML and JSON share.
std::string value_text(const algorithms::Value& value) {
  if (const auto* v = std::get_if<bool>(&value)) return *v ? "true" : "false";
  if (const auto* v = std::get_if<std::int64_t>(&value)) return std::to_string(*v);
  if (const auto* v = std::get_if<double>(&value)) return real_text(*v);
  return quoted(std::get<std::string>(value));
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
  if (std::ferror(stream.get())) throw Error(kInput, file + ": the configuration cannot be read: " + std::strerror(errno));
  return text;
}

}  // namespace

Config parse_config(const std::string& text, const std::filesystem::path& path, const std::vector<std::string>& sets) {
  const std::string file = one_line(path.string(), 4096);
  if (text.size() > kMostBytes)
    throw Error(kInput, file + ": the configuration must be at most 16 MiB of text, not more");
  Document document(text, file);
  for (const std::string& set : sets) document.set(set);

  const Section root(document, &document.root(), "",
                     {"title", "seed", "steps", "rate", "scene", "physics", "truth", "timing", "algorithm"});
  Config config;
  config.path = path;
  config.text = text;
  config.title = title(root, one_line(path.stem().string(), kMostTitle));
  config.seed = root.integer("seed", config.seed, 0);
  config.steps = root.integer("steps", config.steps, 1, kMostSteps);
  config.rate = root.real("rate", config.rate, {.least = 0, .most = kMostRate, .above = true});
  config.scene = falling_scene(document, root);
  read_physics(document, root, config);
  config.containment = containment(document, root);
  config.repeats = Section(document, root.table("timing"), "timing", {"repeats"})
                       .integer("repeats", config.repeats, 1, kMostRepeats);
  config.algorithms = algorithm_choices(document, root);
  config.effective = effective(config);
  return config;
}

Config read_config(const std::filesystem::path& path, const std::vector<std::string>& sets) {
  return parse_config(bytes_of(path), path, sets);
}

AlgorithmChoice parse_algorithm(const std::string& argument) {
  throw Error(kInput, argument);
}

std::string knobs_json(const algorithms::Knobs& knobs) {
  std::string out;
  for (const auto& [knob, value] : knobs) out += (out.empty() ? "{" : ",") + quoted(knob) + ':' + value_text(value);
  return out.empty() ? "{}" : out + '}';
}

}  // namespace pipeline
