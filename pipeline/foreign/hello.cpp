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

std::string number_text(double value) { return real_text(value); }
std::string number_text(std::uint32_t value) { return std::to_string(value); }

/// Values one after another, as members of a JSON array. Meshes are long: nothing but the text is made.
template <class Values, class Add>
void add_array(const Values& values, std::string& out, Add add) {
  out += '[';
  bool first = true;
  for (const auto& value : values) {
    if (!first) out += ',';
    first = false;
    add(value);
  }
  out += ']';
}

template <class Rows>
void add_rows(const Rows& rows, std::string& out) {
  add_array(rows, out, [&](const auto& row) { add_array(row, out, [&](auto x) { out += number_text(x); }); });
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
  std::string text = "{\"protocol\":" + std::to_string(kProtocol) + ",\"label\":" + in_quotes(label) +
                     ",\"knobs\":" + knobs + ",\"bodies\":";
  std::size_t body = 0;
  add_array(bodies.name, text, [&](const std::string& name) {
    text += "{\"name\":" + in_quotes(name) + ",\"mesh\":" + std::to_string(bodies.mesh[body]) +
            ",\"fixed\":" + (bodies.fixed[body] ? "true" : "false") + '}';
    ++body;
  });
  text += ",\"meshes\":";
  add_array(bodies.meshes, text, [&](const geometry::Mesh& mesh) {
    text += "{\"name\":" + in_quotes(mesh.name) + ",\"vertices\":";
    add_rows(mesh.vertices, text);
    text += ",\"triangles\":";
    add_rows(mesh.triangles, text);
    text += '}';
  });
  text += '}';
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
  for (const auto& [key, value] : {std::pair{"operations_unit", about.operations_unit}, std::pair{"tests", about.tests},
                                   std::pair{"licence", about.licence}, std::pair{"refuses", about.refuses}})
    if (!value.empty()) out[key] = value;
  if (about.memory_bytes >= 0) out["memory_bytes"] = about.memory_bytes;
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

About about_in(std::string_view text_said) {
  json hello;
  if (is_shallow(text_said)) hello = json::parse(text_said, nullptr, /*allow_exceptions=*/false);
  if (!hello.is_object()) throw Fault("its hello is no JSON object");
  static const std::set<std::string> known = {"protocol", "name",         "version",   "language",        "precision",
                                              "promise",  "scope",        "remembers", "operations_unit", "threads",
                                              "setup_ns", "memory_bytes", "tests",     "licence",         "refuses"};
  for (const auto& [key, value] : hello.items())
    if (!known.contains(key))
      throw Fault("its hello: unknown key '" + one_line(key) + "'; " + hint(key, {known.begin(), known.end()}));
  if (!hello.contains("protocol") || hello["protocol"] != kProtocol)
    refuse("protocol", std::to_string(kProtocol) + ", the version spoken here");
  About out;
  out.name = text(hello, "name", "");
  if (!valid_label(out.name)) refuse("name", std::string("there and ") + kLabelRule);
  out.version = text(hello, "version", "");
  out.language = text(hello, "language", "");
  out.precision = text(hello, "precision", out.precision);
  out.tests = text(hello, "tests", "");
  out.licence = text(hello, "licence", "");
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
  out.refuses = text(hello, "refuses", "");
  return out;
}

void About::takes_them() const {
  if (!refuses.empty()) throw Fault("it cannot take these bodies: " + refuses);
}

}  // namespace pipeline
