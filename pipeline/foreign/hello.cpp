#include "pipeline/foreign/hello.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/foreign/frames.hpp"
#include "pipeline/system/input_file.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using nlohmann::json;

constexpr std::size_t kMostText = 200;            // characters of a name, version, ...
constexpr double kMostNumber = 9007199254740992;  // 2^53
constexpr std::int64_t kMostThreads = 4096;

template <class Rows>
json rows_of(const Rows& rows) {
  json out = json::array();
  for (const auto& row : rows) out.push_back({row[0], row[1], row[2]});
  return out;
}

[[noreturn]] void refuse(const std::string& key, const std::string& rule) {
  throw Fault("its hello: '" + key + "' must be " + rule);
}

std::string text(const json& hello, const std::string& key, const std::string& preset) {
  if (!hello.contains(key)) return preset;
  const std::string rule = "one line of at most " + std::to_string(kMostText) + " characters";
  if (!hello[key].is_string()) refuse(key, rule);
  const std::string value = hello[key];
  if (one_line(value, kMostText) != value) refuse(key, rule);
  return value;
}

std::string choice(const json& hello, const std::string& key, std::initializer_list<std::string_view> known) {
  const std::string value = text(hello, key, std::string(*known.begin()));
  std::string rule;
  for (const std::string_view one : known) {
    if (value == one) return value;
    rule += (rule.empty() ? "" : one == *(known.end() - 1) ? " or " : ", ") + in_quotes(one);
  }
  refuse(key, rule);
}

std::int64_t number(const json& hello, const std::string& key, std::int64_t preset, double least, double most) {
  if (!hello.contains(key)) return preset;
  const double value = hello[key].is_number() ? hello[key].get<double>() : std::nan("");
  if (!(value >= least && value <= most))
    refuse(key, "a number from " + value_text(std::int64_t(least)) + " to " + value_text(std::int64_t(most)));
  return static_cast<std::int64_t>(value);
}

}  // namespace

std::string hello_text(const std::string& label, const geometry::Bodies& bodies, const std::string& knobs) {
  json out = {{"protocol", kProtocol}, {"label", label}, {"knobs", json::parse(knobs)}};
  out["bodies"] = out["meshes"] = json::array();
  for (std::size_t body = 0; body < bodies.size(); ++body)
    out["bodies"].push_back(
        {{"name", bodies.name[body]}, {"mesh", bodies.mesh[body]}, {"fixed", bodies.fixed[body] != 0}});
  for (const geometry::Mesh& mesh : bodies.meshes)
    out["meshes"].push_back(
        {{"name", mesh.name}, {"vertices", rows_of(mesh.vertices)}, {"triangles", rows_of(mesh.triangles)}});
  std::string text = out.dump();
  if (text.size() > kMostContent)
    throw Error(kInput, "algorithm '" + label + "': the meshes take " + std::to_string(text.size()) +
                            " bytes of JSON, at most 4 GiB can be told; take smaller meshes");
  return text;
}

std::string text_of(const About& about) {
  json out = {{"protocol", kProtocol},
              {"name", about.name},
              {"version", about.version},
              {"language", about.language},
              {"precision", about.precision},
              {"promise", algorithms::text(about.promise)},
              {"scope", algorithms::text(about.scope)},
              {"remembers", about.remembers},
              {"threads", about.threads},
              {"setup_ns", about.setup_ns}};
  if (!about.operations_unit.empty()) out["operations_unit"] = about.operations_unit;
  if (about.memory_bytes >= 0) out["memory_bytes"] = about.memory_bytes;
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

About about_in(std::string_view text_said) {
  json hello;
  if (is_shallow(text_said)) hello = json::parse(text_said, nullptr, /*allow_exceptions=*/false);
  if (!hello.is_object()) throw Fault("its hello is no JSON object");
  static const std::set<std::string> known = {"protocol",        "name",    "version",  "language",
                                              "precision",       "promise", "scope",    "remembers",
                                              "operations_unit", "threads", "setup_ns", "memory_bytes"};
  for (const auto& [key, value] : hello.items())
    if (!known.contains(key))
      throw Fault("its hello: unknown key '" + one_line(key) + "'; " + hint(key, {known.begin(), known.end()}));
  if (!hello.contains("protocol") || hello["protocol"] != kProtocol)
    refuse("protocol", std::to_string(kProtocol) + ", the version spoken here");
  About out;
  out.name = text(hello, "name", "");
  if (out.name.empty()) refuse("name", "there");
  out.version = text(hello, "version", "");
  out.language = text(hello, "language", "");
  out.precision = text(hello, "precision", out.precision);
  const std::string promise = choice(hello, "promise", {"none", "conservative", "exact"});
  out.promise = promise == "exact"          ? algorithms::Promise::exact
                : promise == "conservative" ? algorithms::Promise::conservative
                                            : algorithms::Promise::none;
  out.scope = choice(hello, "scope", {"pair", "scene"}) == "scene" ? algorithms::Scope::scene : algorithms::Scope::pair;
  out.operations_unit = text(hello, "operations_unit", "");
  if (hello.contains("remembers")) {
    if (!hello["remembers"].is_boolean()) refuse("remembers", "true or false");
    out.remembers = hello["remembers"];
  }
  out.threads = number(hello, "threads", 1, 1, kMostThreads);
  out.setup_ns = number(hello, "setup_ns", 0, 0, kMostNumber);
  out.memory_bytes = number(hello, "memory_bytes", -1, 0, kMostNumber);
  return out;
}

}  // namespace pipeline
