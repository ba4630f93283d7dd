#include "algorithms/contract/plugin_rows.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "algorithms/plugin.h"

namespace algorithms {
namespace {

// What a library is given is what we have, without a copy.
static_assert(sizeof(collision_pose) == sizeof(Pose) &&
              offsetof(collision_pose, position) == sizeof(geometry::Quaternion));
static_assert(sizeof(collision_run) == sizeof(PairRun) && sizeof(collision_pair) == sizeof(Pair));
static_assert(sizeof(geometry::Vec3) == 3 * sizeof(double) && sizeof(geometry::Facet) == 3 * sizeof(std::uint32_t));

constexpr std::uint64_t kMostRows = 1000, kMostKnobs = 100, kMostChoices = 1000;
constexpr std::size_t kMostText = 1000;  // bytes

[[noreturn]] void refuse(const std::string& text) { throw std::invalid_argument(text); }

// ---- Its table -----------------------------------------------------------------------------------------------------

std::string text_of(const char* text, const std::string& whose) {
  if (!text) refuse(whose + " is NULL; it must be a text");
  const std::string out(text, strnlen(text, kMostText + 1));
  if (out.size() > kMostText) refuse(whose + " must have at most " + std::to_string(kMostText) + " bytes; shorten it");
  return out;
}

std::string name_of(const char* text, const std::string& whose, const std::string& marks) {
  const std::string name = text_of(text, whose);
  const bool allowed = std::ranges::all_of(name, [&](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || marks.find(c) != marks.npos;
  });
  if (name.empty() || name.size() > 64 || !allowed || name == "." || name == "..") {
    std::string spaced;
    for (const char mark : marks) spaced += std::string(" ") + mark;
    refuse(whose + " must be 1 to 64 characters of A-Z a-z 0-9" + spaced + ", not '" + name + "'; rename it");
  }
  return name;
}

constexpr char kNameMarks[] = "_.+-";  // of methods and choices
constexpr char kKnobMarks[] = "_-";    // what needs no quotes as a key
constexpr std::string_view kReserved[] = {"name",        "label",       "optional",
                                          "step_budget", "time_budget", "memory_budget"};  // keys of every algorithm

Knob knob_of(const collision_knob& from, const std::string& row) {
  Knob knob;
  knob.name = name_of(from.name, row + ": the name of a knob", kKnobMarks);
  const std::string whose = row + ": knob '" + knob.name + "': ";
  if (std::ranges::find(kReserved, knob.name) != std::end(kReserved))
    refuse(whose + "the name is taken by every algorithm; rename it");
  knob.unit = text_of(from.unit, whose + "unit");
  knob.what = text_of(from.what, whose + "what");
  switch (from.type) {
    case COLLISION_FLAG:
      if (from.preset.integer != 0 && from.preset.integer != 1)
        refuse(whose + "the preset of a flag must be 0 or 1, not " + std::to_string(from.preset.integer));
      knob.preset = from.preset.integer == 1;
      if (knob.name == "containment") knob.role = Role::containment;
      break;
    case COLLISION_INTEGER:
      knob.preset = from.preset.integer;
      break;
    case COLLISION_REAL:
      knob.preset = from.preset.real;
      break;
    case COLLISION_CHOICE: {
      if (!from.choices) refuse(whose + "choices is NULL; it must list what is allowed, and end with NULL");
      for (std::uint64_t i = 0; from.choices[i]; ++i) {
        if (i == kMostChoices) refuse(whose + "more than " + std::to_string(i) + " choices; end them with NULL");
        knob.choices.push_back(name_of(from.choices[i], whose + "a choice", kNameMarks));
      }
      if (knob.choices.empty()) refuse(whose + "choices are none; list what is allowed");
      knob.preset = text_of(from.preset.text, whose + "preset");
      break;
    }
    default:
      refuse(whose + "type must be 0 to 3, not " + std::to_string(from.type));
  }
  if (from.type == COLLISION_INTEGER || from.type == COLLISION_REAL) {
    if (!(from.least <= from.most)) refuse(whose + "least must be at most most; -HUGE_VAL and HUGE_VAL mean no bound");
    knob.least = from.least;
    knob.most = from.most;
  }
  try {
    checked(knob, knob.preset);
  } catch (const std::invalid_argument& error) {
    refuse(whose + "the preset " + error.what());
  }
  return knob;
}

// ---- A method ------------------------------------------------------------------------------------------------------

/// Calls the library. Throws what it says went wrong.
template <class Call>
void call(const char* function, Call work) {
  char error[COLLISION_ERROR_SIZE];
  error[0] = '\0';
  std::string thrown;
  try {
    if (work(error) == 0) return;
  } catch (const std::exception& failure) {
    thrown = failure.what();
  } catch (...) {
    thrown = "not a std::exception";
  }
  if (!thrown.empty()) throw std::runtime_error(std::string(function) + " let an exception out: " + thrown);
  error[COLLISION_ERROR_SIZE - 1] = '\0';
  throw std::runtime_error(std::string(function) + " failed: " + (error[0] ? error : "it gives no reason"));
}

class PluginMethod final : public Method {
 public:
  PluginMethod(const collision_row& row, const Bodies& bodies, const Knobs& knobs) : row_(row) {
    for (const geometry::Mesh& mesh : bodies.meshes)
      meshes_.push_back({.name = mesh.name.c_str(),
                         .vertices = reinterpret_cast<const double*>(mesh.vertices.data()),
                         .vertex_count = mesh.vertices.size(),
                         .triangles = reinterpret_cast<const std::uint32_t*>(mesh.triangles.data()),
                         .triangle_count = mesh.triangles.size(),
                         .sphere_radius = mesh.sphere_radius,
                         .shape = mesh.shape.c_str()});
    for (const std::string& name : bodies.name) names_.push_back(name.c_str());
    bodies_ = {.body_count = static_cast<std::uint32_t>(bodies.size()),
               .mesh_count = static_cast<std::uint32_t>(meshes_.size()),
               .mesh = meshes_.data(),
               .name = names_.data(),
               .body_mesh = bodies.mesh.data(),
               .fixed = bodies.fixed.data(),
               .chosen = bodies.chosen.empty() ? nullptr : bodies.chosen.data(),
               .closed_within = bodies.closed_within};
    std::vector<collision_value> values;
    for (std::uint64_t i = 0; i < row.knob_count; ++i) {
      const Value& value = knobs.find(row.knobs[i].name)->second;
      collision_value& out = values.emplace_back();
      if (const auto* flag = std::get_if<bool>(&value)) out.integer = *flag;
      if (const auto* whole = std::get_if<std::int64_t>(&value)) out.integer = *whole;
      if (const auto* real = std::get_if<double>(&value)) out.real = *real;
      if (const auto* text = std::get_if<std::string>(&value)) out.text = text->c_str();
    }
    bool unfit = false;
    try {
      call("create", [&](char* error) {
        method_ = row.create(&bodies_, values.data(), error);
        unfit = !method_;
        return unfit;
      });
    } catch (const std::runtime_error& error) {
      if (unfit) throw std::invalid_argument(error.what());  // as own methods refuse bodies and knobs
      throw;
    }
  }

  ~PluginMethod() override {
    if (method_) row_.destroy(method_);
  }

  void prepare(std::span<const Pose> poses, double enlarge) override {
    call("prepare", [&](char* error) {
      return row_.prepare(method_, reinterpret_cast<const collision_pose*>(poses.data()), enlarge, error);
    });
  }

  void answer(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    collision_hits found = empty();
    call("answer", [&](char* error) { return row_.answer(method_, first(runs), runs.size(), &found, error); });
    append(found, hits);
  }

  std::uint64_t count(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    if (!row_.count) {
      answer(runs, hits);
      return 0;
    }
    std::uint64_t operations = 0;
    collision_hits found = empty();
    call("count",
         [&](char* error) { return row_.count(method_, first(runs), runs.size(), &found, &operations, error); });
    append(found, hits);
    return operations;
  }

  void remember() override {
    if (row_.remember)
      call("remember", [&](char*) {
        row_.remember(method_);
        return 0;
      });
  }

  void forget() override {
    if (row_.forget)
      call("forget", [&](char*) {
        row_.forget(method_);
        return 0;
      });
  }

 private:
  static const collision_run* first(std::span<const PairRun> runs) {
    return reinterpret_cast<const collision_run*>(runs.data());
  }

  static int grow(collision_hits* hits, std::uint64_t more) {
    auto& buffer = static_cast<PluginMethod*>(hits->owner)->buffer_;
    if (more > buffer.max_size() - hits->size) return 1;
    try {
      buffer.resize(std::max<std::uint64_t>({2 * buffer.size(), hits->size + more, 1024}));
    } catch (const std::bad_alloc&) {
      return 1;
    }
    hits->pair = buffer.data();
    hits->capacity = buffer.size();
    return 0;
  }

  /// The buffer keeps its size from step to step, so that only the first ones grow it.
  collision_hits empty() { return {buffer_.data(), 0, buffer_.size(), grow, this}; }

  void append(const collision_hits& found, std::vector<Pair>& hits) const {
    if (found.size > buffer_.size())
      throw std::runtime_error("reports " + std::to_string(found.size) + " pairs in a buffer of " +
                               std::to_string(buffer_.size()) + "; grow it before");
    const auto* pairs = reinterpret_cast<const Pair*>(buffer_.data());
    hits.insert(hits.end(), pairs, pairs + found.size);
  }

  const collision_row& row_;
  std::vector<collision_mesh> meshes_;
  std::vector<const char*> names_;
  collision_bodies bodies_ = {};
  std::vector<collision_pair> buffer_;
  collision_method* method_ = nullptr;
};

Algorithm row_of(const collision_row* from, std::uint64_t number) {
  const std::string place = "row " + std::to_string(number);
  if (!from) refuse(place + " is NULL; each must be a row");
  Algorithm row;
  row.name = name_of(from->name, place + ": name", kNameMarks);
  const std::string whose = "row '" + row.name + "'";
  row.what = text_of(from->what, whose + ": what");
  if (from->count) row.operations_unit = text_of(from->unit, whose + ": unit");
  row.precision = text_of(from->precision, whose + ": precision");
  if (from->promise > COLLISION_EXACT) refuse(whose + ": promise must be 0 to 2, not " + std::to_string(from->promise));
  if (from->scope > COLLISION_SCENE) refuse(whose + ": scope must be 0 or 1, not " + std::to_string(from->scope));
  row.promise = static_cast<Promise>(from->promise);
  row.scope = static_cast<Scope>(from->scope);
  const char* missing = !from->create    ? "create"
                        : !from->prepare ? "prepare"
                        : !from->answer  ? "answer"
                        : !from->destroy ? "destroy"
                                         : nullptr;
  if (missing) refuse(whose + ": " + missing + " is NULL; it must be a function");
  if (from->knob_count > kMostKnobs)
    refuse(whose + ": knob_count must be at most " + std::to_string(kMostKnobs) + ", not " +
           std::to_string(from->knob_count));
  if (from->knob_count > 0 && !from->knobs)
    refuse(whose + ": knobs is NULL; it must be " + std::to_string(from->knob_count) + " knobs");
  std::set<std::string> taken;
  for (std::uint64_t i = 0; i < from->knob_count; ++i) {
    row.knobs.push_back(knob_of(from->knobs[i], whose));
    if (!taken.insert(row.knobs.back().name).second)
      refuse(whose + ": two knobs are named '" + row.knobs.back().name + "'; rename one");
  }
  row.make = [from](const Bodies& bodies, const Knobs& knobs) -> std::unique_ptr<Method> {
    return std::make_unique<PluginMethod>(*from, bodies, knobs);
  };
  return row;
}

static_assert(COLLISION_NONE == int(Promise::none) && COLLISION_CONSERVATIVE == int(Promise::conservative) &&
              COLLISION_EXACT == int(Promise::exact));
static_assert(COLLISION_PAIR == int(Scope::pair) && COLLISION_SCENE == int(Scope::scene));

}  // namespace

std::vector<Algorithm> plugin_rows(const std::string& path) {
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    std::string why = dlerror();
    if (why.starts_with(path + ": ")) why.erase(0, path.size() + 2);
    refuse("cannot be loaded (" + why + "); build it for this machine, with all that it needs");
  }
  using Entry = const collision_table*();
  auto* const entry = reinterpret_cast<Entry*>(dlsym(library, "collision_plugin"));
  if (!entry) refuse("exports no function collision_plugin; write one, marked COLLISION_EXPORT (algorithms/plugin.h)");
  const collision_table* table = entry();
  if (!table) refuse("collision_plugin() gives NULL; it must give a table");
  if (table->abi != COLLISION_ABI)
    refuse("has ABI version " + std::to_string(table->abi) + ", must have " + std::to_string(COLLISION_ABI) +
           "; build it with the plugin.h of this version");
  if (table->row_count < 1 || table->row_count > kMostRows)
    refuse("row_count must be 1 to " + std::to_string(kMostRows) + ", not " + std::to_string(table->row_count));
  if (!table->row) refuse("row is NULL; it must be " + std::to_string(table->row_count) + " rows");
  const std::string version = table->version ? text_of(table->version, "version") : "";
  std::vector<Algorithm> rows;
  std::set<std::string> taken;
  for (std::uint32_t i = 0; i < table->row_count; ++i) {
    rows.push_back(row_of(table->row[i], i + 1));
    rows.back().library.version = version;
    if (!taken.insert(rows.back().name).second) refuse("two rows are named '" + rows.back().name + "'; rename one");
  }
  return rows;
}

}  // namespace algorithms
