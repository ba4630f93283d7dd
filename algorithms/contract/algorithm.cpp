// Words of the table and the rules of its knobs: the same messages for a configuration file and a command line.
#include "algorithms/contract/algorithm.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace algorithms {
namespace {

/// The shortest text that reads back as the same number, without an exponent where that is readable.
std::string number(double value) {
  std::array<char, 64> buffer;
  const bool plain = value == 0 || (std::abs(value) >= 1e-4 && std::abs(value) < 1e15);
  const auto format = plain ? std::chars_format::fixed : std::chars_format::general;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format).ptr;
  return {buffer.data(), end};
}

[[noreturn]] void refuse(const std::string& rule) { throw std::invalid_argument("must " + rule); }

void check_range(const Knob& knob, double value) {
  if (value >= knob.least && value <= knob.most) return;
  const bool low = std::isfinite(knob.least), high = std::isfinite(knob.most);
  if (low && high) refuse("be between " + number(knob.least) + " and " + number(knob.most));
  if (low) refuse("be at least " + number(knob.least));
  refuse("be at most " + number(knob.most));
}

std::string listed(const std::vector<std::string>& choices) {
  std::string text;
  for (const std::string& choice : choices) text += (text.empty() ? "" : ", ") + choice;
  return text;
}

}  // namespace

std::string_view text(Promise promise) {
  switch (promise) {
    case Promise::conservative:
      return "conservative";
    case Promise::exact:
      return "exact";
    case Promise::none:
      break;
  }
  return "none";
}

std::string_view text(Scope scope) { return scope == Scope::scene ? "scene" : "pair"; }

Memory memory(const Algorithm& row, const Bodies& bodies, const Knobs& knobs) {
  if (row.memory) return row.memory(bodies, knobs);
  std::uint64_t bytes = 0;
  for (const geometry::Mesh& mesh : bodies.meshes)
    bytes += sizeof(geometry::Vec3) * mesh.vertices.size() + sizeof(geometry::Facet) * mesh.triangles.size();
  return {bytes, bytes};
}

std::string remedy(const Algorithm& row) {
  return row.library.name + "; scripts/peers installs it (" + row.library.package + ") and builds anew";
}

Promise promise(const Algorithm& row, const Knobs& knobs) {
  for (const Knob& knob : row.knobs)
    if (knob.role == Role::then)
      if (const Algorithm* last = find(value_of<std::string>(knobs, knob.name))) return promise(*last, presets(*last));
  return row.promise;
}

bool samples_facets(const Algorithm& row, const Knobs& knobs) {
  for (const Knob& knob : row.knobs) {
    if (knob.role == Role::density) return true;
    if (knob.role != Role::prefilter && knob.role != Role::then) continue;
    const Algorithm* other = find(value_of<std::string>(knobs, knob.name));
    if (other && samples_facets(*other, presets(*other))) return true;
  }
  return false;
}

Knobs presets(const Algorithm& algorithm) {
  Knobs knobs;
  for (const Knob& knob : algorithm.knobs) knobs.emplace(knob.name, knob.preset);
  return knobs;
}

Value checked(const Knob& knob, const Value& value) {
  Value out = value;
  if (std::holds_alternative<bool>(knob.preset)) {
    if (!std::holds_alternative<bool>(value)) refuse("be true or false");
  } else if (std::holds_alternative<std::int64_t>(knob.preset)) {
    if (!std::holds_alternative<std::int64_t>(value)) refuse("be an integer");
    check_range(knob, static_cast<double>(std::get<std::int64_t>(value)));
  } else if (std::holds_alternative<double>(knob.preset)) {
    if (const auto* whole = std::get_if<std::int64_t>(&value)) out = static_cast<double>(*whole);
    if (!std::holds_alternative<double>(out)) refuse("be a number");
    if (!std::isfinite(std::get<double>(out))) refuse("be finite");
    check_range(knob, std::get<double>(out));
  } else if (knob.role == Role::files) {
    if (!std::holds_alternative<std::string>(value)) refuse("name a file for each mesh: \"mesh=file;mesh=file\"");
  } else {
    const auto* choice = std::get_if<std::string>(&value);
    bool known = false;
    for (const std::string& allowed : knob.choices) known = known || (choice && *choice == allowed);
    if (!known) refuse("be one of " + listed(knob.choices));
  }
  if (knob.valid && !knob.valid(out)) refuse(knob.rule);
  return out;
}

}  // namespace algorithms
