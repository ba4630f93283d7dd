#include "pipeline/commands/list.hpp"

#include <CLI/App.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "algorithms/contract/algorithm.hpp"
#include "pipeline/commands/command.hpp"
#include "pipeline/keys.hpp"
#include "pipeline/result/datasets.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/plugin.hpp"
#include "pipeline/study/problem.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json value_json(const algorithms::Value& value) {
  return std::visit([](const auto& v) { return Json(v); }, value);
}

const char* type_name(const algorithms::Value& value) {
  constexpr const char* kNames[] = {"boolean", "integer", "real", "text"};
  return kNames[value.index()];
}

std::string range_text(const algorithms::Knob& knob) {
  if (!knob.choices.empty()) {
    std::string text;
    for (const std::string& choice : knob.choices) text += (text.empty() ? "" : " | ") + choice;
    return text;
  }
  std::string text;
  if (std::isfinite(knob.least) && std::isfinite(knob.most))
    text = print("%.15g to %.15g", knob.least, knob.most);
  else if (std::isfinite(knob.least))
    text = print("at least %.15g", knob.least);
  else if (std::isfinite(knob.most))
    text = print("at most %.15g", knob.most);
  if (!knob.rule.empty()) text += (text.empty() ? "" : ", ") + knob.rule;
  return text;
}

struct NamedText {
  const char* name;
  const char* what;
};
constexpr NamedText kShapes[] = {
    {"sphere", "radius, segments (32): segments + 2 rows of twice as many columns, pole axis y"},
    {"box", "size [x, y, z]: 12 facets"},
    {"capsule", "height, radius (or radius_bottom and radius_top), segments (8): axis y"},
    {"torus", "diameter of the centre circle, thickness of the tube, segments (16): axis y"},
    {"torus_knot", "radius, tube, radial_segments (32), tubular_segments (32), p (2), q (3): axis z"},
};

std::vector<NamedText> rows_of(const std::string& what) {
  if (what == "shapes") return {std::begin(kShapes), std::end(kShapes)};
  std::vector<NamedText> rows;
  if (what == "scenes")
    for (const SceneKind& kind : scene_kinds()) rows.push_back({kind.name.c_str(), kind.what.c_str()});
  else if (what == "problems")
    for (const Problem& problem : problems()) rows.push_back({problem.name.c_str(), problem.what.c_str()});
  else
    for (const IntegratorFacts& facts : integrators()) rows.push_back({facts.name, facts.what});
  return rows;
}

std::string algorithm_text(const algorithms::Algorithm& row) {
  std::string text = row.name + (row.thesis_key.empty() ? "" : " (" + row.thesis_key + ")") + ": " + row.what + "\n";
  text += "    promise " + std::string(algorithms::text(row.promise)) + ", scope " +
          std::string(algorithms::text(row.scope)) + ", " +
          (row.operations_unit.empty() ? "operations are not counted" : "operations are " + row.operations_unit) + "\n";
  if (!row.library.version.empty() || !row.library.sha256.empty())
    text += "    of the library " + row.library.name + (row.library.version.empty() ? "" : " " + row.library.version) +
            (row.library.sha256.empty() ? "" : ", precision " + row.precision) +
            (row.library.tests.empty() ? "" : ", tests " + row.library.tests) +
            (row.library.licence.empty() ? "" : ", " + row.library.licence) + "\n";
  for (const algorithms::Knob& knob : row.knobs) {
    text += "    " + knob.name + " = " + value_text(knob.preset) + (knob.unit == "1" ? "" : " " + knob.unit);
    const std::string range = range_text(knob);
    text +=
        std::string("  (") + type_name(knob.preset) + (range.empty() ? "" : ": " + range) + ")  " + knob.what + "\n";
  }
  return text;
}

Json algorithm_json(const algorithms::Algorithm& row) {
  Json knobs = Json::array();
  for (const algorithms::Knob& knob : row.knobs) {
    Json entry = {{"name", knob.name},
                  {"type", type_name(knob.preset)},
                  {"preset", value_json(knob.preset)},
                  {"unit", knob.unit},
                  {"what", knob.what}};
    if (std::isfinite(knob.least)) entry["least"] = knob.least;
    if (std::isfinite(knob.most)) entry["most"] = knob.most;
    if (!knob.choices.empty()) entry["choices"] = knob.choices;
    if (!knob.rule.empty()) entry["rule"] = knob.rule;
    knobs.push_back(entry);
  }
  const algorithms::Library& library = row.library;
  Json of_whom;  // null: of this project
  if (!library.name.empty()) of_whom = {{"name", library.name}, {"version", library.version}};
  for (const auto& [key, value] : {std::pair{"package", library.package}, std::pair{"tests", library.tests},
                                   std::pair{"licence", library.licence}, std::pair{"language", library.language}})
    if (!value.empty()) of_whom[key] = value;
  if (!library.sha256.empty()) of_whom["sha256"] = library.sha256;
  return {{"name", row.name},
          {"thesis_key", row.thesis_key},
          {"what", row.what},
          {"promise", algorithms::text(row.promise)},
          {"scope", algorithms::text(row.scope)},
          {"operations_unit", row.operations_unit},
          {"precision", row.precision},
          {"library", of_whom},
          {"knobs", knobs}};
}

/// "falling, box", or "every scene" and "every study" for what all of them have.
std::string where_text(const std::vector<std::string>& where) {
  std::vector<std::string> left = where;
  std::string text;
  const auto take = [&](const std::vector<NamedText>& all, const char* word) {
    const auto has = [&](const NamedText& row) { return std::ranges::find(left, row.name) != left.end(); };
    if (!std::ranges::all_of(all, has)) return;
    for (const NamedText& row : all) std::erase(left, row.name);
    text += (text.empty() ? "" : ", ") + std::string(word);
  };
  take(rows_of("scenes"), "every scene");
  take(rows_of("problems"), "every study");
  take(rows_of("shapes"), "every shape");
  for (const std::string& name : left) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string keys_text() {
  std::string text;
  for (const KeyFacts& facts : key_facts()) {
    text += facts.key.path + (facts.key.preset.empty() ? "" : " = " + facts.key.preset) +
            (facts.unit == "1" ? "" : " " + facts.unit) + "\n    " + facts.what + "\n    " + facts.key.rule + "; in " +
            where_text(facts.where) + "\n";
  }
  return text;
}

Json keys_json() {
  Json json = Json::array();
  for (const KeyFacts& facts : key_facts())
    json.push_back({{"name", facts.key.path},
                    {"type", facts.key.type},
                    {"preset", facts.key.preset.empty() ? Json() : Json(facts.key.preset)},
                    {"rule", facts.key.rule},
                    {"unit", facts.unit},
                    {"what", facts.what},
                    {"where", where_text(facts.where)}});
  return json;
}

std::string datasets_text() {
  std::string text;
  for (const DatasetFacts& facts : dataset_facts())
    text += facts.path + (facts.shape.empty() ? "" : " (" + facts.shape + ")") + " " + facts.type +
            (facts.unit == "1" ? "" : " " + facts.unit) + "\n    " + facts.long_name + "\n    present: " + facts.when +
            "\n";
  return text;
}

Json datasets_json() {
  Json json = Json::array();
  for (const DatasetFacts& facts : dataset_facts())
    json.push_back({{"name", facts.path},
                    {"shape", facts.shape},
                    {"type", facts.type},
                    {"unit", facts.unit},
                    {"what", facts.long_name},
                    {"when", facts.when}});
  return json;
}

/// Rows that this build is without, each with what it needs; plug-ins that it has are added on the way.
std::vector<std::pair<const algorithms::Algorithm*, std::string>> lacking_rows() {
  std::vector<std::pair<const algorithms::Algorithm*, std::string>> out;
  for (const algorithms::Algorithm& row : algorithms::missing())
    if (const algorithms::Algorithm* missing = algorithms::find_missing(row.name))
      if (const std::string needed = lacking(*missing); !needed.empty()) out.emplace_back(missing, needed);
  return out;
}

}  // namespace

std::string list_text(const std::string& what) {
  if (what == "keys") return keys_text();
  if (what == "datasets") return datasets_text();
  std::string text;
  if (what != "algorithms") {
    for (const NamedText& row : rows_of(what)) text += print("%-20s %s", row.name, row.what) + "\n";
    return text;
  }
  const auto lacking = lacking_rows();
  for (const algorithms::Algorithm& row : algorithms::all()) text += algorithm_text(row);
  for (const algorithms::Algorithm& row : algorithms::added()) text += algorithm_text(row);
  for (const auto& [row, needed] : lacking)
    text += algorithm_text(*row) + "    not in this build: it needs " + needed + "\n";
  return text;
}

std::string list_json(const std::string& what) {
  if (what == "keys") return dumped(keys_json());
  if (what == "datasets") return dumped(datasets_json());
  Json json = Json::array();
  if (what != "algorithms") {
    for (const NamedText& row : rows_of(what)) json.push_back({{"name", row.name}, {"what", row.what}});
    return dumped(json);
  }
  const auto lacking = lacking_rows();
  for (const algorithms::Algorithm& row : algorithms::all()) json.push_back(algorithm_json(row));
  for (const auto& [row, needed] : lacking) {
    json.push_back(algorithm_json(*row));
    json.back()["missing"] = needed;
  }
  for (const algorithms::Algorithm& row : algorithms::added()) json.push_back(algorithm_json(row));
  return dumped(json);
}

void add_list(CLI::App& program, int& code) {
  struct Options {
    std::string what;
    std::vector<std::string> plugins;
    bool json = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command = *program.add_subcommand("list", "List what configurations can name and results hold");
  command.add_option("WHAT", o->what, "algorithms, scenes, shapes, integrators, problems, keys or datasets")
      ->required()
      ->check(CLI::IsMember({"algorithms", "scenes", "shapes", "integrators", "problems", "keys", "datasets"}));
  add_plugin_option(command, o->plugins);
  add_json(command, o->json);
  command.callback([o, &code] {
    add_plugins(o->plugins);
    put((o->json ? list_json : list_text)(o->what));
    code = 0;
  });
}

}  // namespace pipeline
