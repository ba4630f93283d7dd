#include "pipeline/stages/plugin.hpp"

#include <elf.h>
#include <fcntl.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "algorithms/contract/algorithm.hpp"
#include "algorithms/contract/plugin_rows.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/system/file_bytes.hpp"
#include "pipeline/system/heap.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using algorithms::Algorithm;
using algorithms::Bodies;
using algorithms::Knob;
using algorithms::Knobs;
using algorithms::Method;
using Json = nlohmann::json;

constexpr std::uint64_t kMostBytes = 4ull << 30;  // of a library
constexpr std::size_t kMostWhat = 1000;           // characters

// ---- What can be told without running it ---------------------------------------------------------------------------

#if defined(__x86_64__)
constexpr int kMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr int kMachine = EM_AARCH64;
#else
constexpr int kMachine = EM_NONE;  // the loader judges
#endif

std::string machine_name(int machine) {
  switch (machine) {
    case EM_X86_64:
      return "x86-64";
    case EM_AARCH64:
      return "aarch64";
    case EM_386:
      return "i386";
    case EM_ARM:
      return "arm";
    case EM_RISCV:
      return "riscv";
    case EM_PPC64:
      return "ppc64";
    default:
      return "processor " + std::to_string(machine) + " of ELF";
  }
}

void check_kind(const std::string& bytes) {
  Elf64_Ehdr head;  // type and machine lie alike in files of 32 bits
  if (bytes.size() < sizeof head || bytes.compare(0, SELFMAG, ELFMAG) != 0)
    throw std::invalid_argument("is no shared library; build one as algorithms/README.md says");
  std::memcpy(&head, bytes.data(), sizeof head);
  if (kMachine != EM_NONE && (head.e_machine != kMachine || head.e_ident[EI_CLASS] != ELFCLASS64))
    throw std::invalid_argument("is for " + machine_name(head.e_machine) + ", must be for " + machine_name(kMachine) +
                                "; build it for this processor");
  if (head.e_type != ET_DYN) throw std::invalid_argument("is no shared library; link it with -shared");
}

// ---- Its table, from a child process -------------------------------------------------------------------------------

/// JSON has neither infinities nor NaN.
Json real_json(double value) { return std::isfinite(value) ? Json(value) : Json(value > 0 ? "+" : "-"); }

double real_of(const Json& json) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  if (json.is_string()) return json.get<std::string>() == "+" ? kInfinite : -kInfinite;
  return json.get<double>();
}

Json json_of(const Algorithm& row) {
  Json knobs = Json::array();
  for (const Knob& knob : row.knobs)
    knobs.push_back({{"name", knob.name},
                     {"preset", std::visit([](const auto& value) { return Json(value); }, knob.preset)},
                     {"unit", knob.unit},
                     {"what", knob.what},
                     {"least", real_json(knob.least)},
                     {"most", real_json(knob.most)},
                     {"choices", knob.choices},
                     {"containment", knob.role == algorithms::Role::containment}});
  return {{"name", row.name},
          {"what", row.what},
          {"operations_unit", row.operations_unit},
          {"precision", row.precision},
          {"version", row.library.version},
          {"promise", static_cast<int>(row.promise)},
          {"scope", static_cast<int>(row.scope)},
          {"knobs", knobs}};
}

std::string text_of(const Json& json) { return one_line(json.get<std::string>(), kMostWhat); }

Algorithm row_of(const Json& json) {
  Algorithm row;
  row.name = text_of(json.at("name"));
  row.what = text_of(json.at("what"));
  row.operations_unit = text_of(json.at("operations_unit"));
  row.precision = text_of(json.at("precision"));
  row.library.version = text_of(json.at("version"));
  row.promise = static_cast<algorithms::Promise>(json.at("promise").get<int>());
  row.scope = static_cast<algorithms::Scope>(json.at("scope").get<int>());
  for (const Json& one : json.at("knobs")) {
    Knob knob;
    knob.name = text_of(one.at("name"));
    const Json& preset = one.at("preset");
    if (preset.is_boolean()) knob.preset = preset.get<bool>();
    if (preset.is_number_integer()) knob.preset = preset.get<std::int64_t>();
    if (preset.is_number_float()) knob.preset = preset.get<double>();
    if (preset.is_string()) knob.preset = text_of(preset);
    knob.unit = text_of(one.at("unit"));
    knob.what = text_of(one.at("what"));
    knob.least = real_of(one.at("least"));
    knob.most = real_of(one.at("most"));
    knob.choices = one.at("choices").get<std::vector<std::string>>();
    if (one.at("containment").get<bool>()) knob.role = algorithms::Role::containment;
    row.knobs.push_back(std::move(knob));
  }
  return row;
}

/// In the child: the rows, or what is wrong with them.
std::string table_text(const std::string& path) {
  constexpr rlimit memory{4ull << 30, 4ull << 30};
  if (counts_heap()) setrlimit(RLIMIT_DATA, &memory);  // else a sanitizer's, whose shadow is data
  Json json;
  try {
    json["rows"] = Json::array();
    for (const Algorithm& row : algorithms::plugin_rows(path)) json["rows"].push_back(json_of(row));
  } catch (const std::invalid_argument& error) {
    json["refused"] = error.what();
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// The rows of the library. Throws std::invalid_argument.
std::vector<Algorithm> rows_of(const std::string& path, const ChildLimits& limits) {
  std::string answer, failed;
  in_children(
      1, 1, limits, [&](std::size_t) { return table_text(path); },
      [&](std::size_t, const std::string& bytes, const std::string& failure) {
        answer = bytes;
        failed = failure;
      });
  if (!failed.empty())
    throw std::invalid_argument("its table cannot be read: " + failed +
                                "; nothing may go wrong when it is loaded and collision_plugin() is called");
  std::vector<Algorithm> rows;
  try {
    const Json json = Json::parse(answer);
    if (json.contains("refused")) throw std::invalid_argument(json.at("refused").get<std::string>());
    for (const Json& row : json.at("rows")) rows.push_back(row_of(row));
  } catch (const Json::exception&) {  // it wrote where it must not
    throw std::invalid_argument("its table cannot be read; it must leave files alone that it did not open");
  }
  return rows;
}

/// `make` of a row, for a child process.
std::unique_ptr<Method> made(const Plugin& plugin, const std::string& name, const Bodies& bodies, const Knobs& knobs) {
  if (sha256(read_regular(AT_FDCWD, plugin.path, /*follow_links=*/true, kMostBytes)) != plugin.sha256)
    throw std::runtime_error(plugin.written + " is another file than when its table was read");
  for (const Algorithm& row : algorithms::plugin_rows(plugin.path.string()))
    if (row.name == name) return row.make(bodies, knobs);
  throw std::runtime_error(plugin.written + " has no row '" + name + "' any more");
}

/// The libraries whose rows are in the table, by path.
std::map<std::string, Plugin>& loaded() {
  static std::map<std::string, Plugin> plugins;
  return plugins;
}

/// Where the plug-in of a peer is, if anywhere: beside the program where it was built, or where it is installed.
std::filesystem::path beside_the_program(const std::string& name) {
  std::error_code none;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", none).parent_path();
  for (const char* folder : {"plugins", "../lib/collision_benchmark"}) {
    const std::filesystem::path file = (program / folder / ("lib" + name + ".so")).lexically_normal();
    if (std::filesystem::exists(file, none)) return file;
  }
  return {};
}

/// The row of missing() whose plug-in this is, or nullptr.
const Algorithm* peer_of(const std::string& name, const std::filesystem::path& file) {
  const Algorithm* peer = algorithms::find_missing(name);
  std::error_code none;
  return peer && peer->library.plugin && std::filesystem::equivalent(file, beside_the_program(name), none) ? peer
                                                                                                           : nullptr;
}

}  // namespace

Plugin add_plugin(const std::string& written, const std::filesystem::path& folder, const std::string& place,
                  const ChildLimits& limits) {
  const std::string whose = place + ": plugin '" + one_line(written, 4096) + "': ";
  Plugin plugin{
      .written = written, .path = std::filesystem::absolute(folder / written).lexically_normal(), .sha256 = ""};
  try {
    const std::string bytes = read_regular(AT_FDCWD, plugin.path, /*follow_links=*/true, kMostBytes);
    check_kind(bytes);
    plugin.sha256 = sha256(bytes);
    const auto [known, fresh] = loaded().try_emplace(plugin.path.string(), plugin);
    if (!fresh && known->second.sha256 == plugin.sha256) return plugin;

    std::vector<Algorithm> rows = rows_of(plugin.path.string(), limits);
    for (const Algorithm& row : rows)
      if (algorithms::find(row.name) || row.name == "program" || row.name == "none" ||
          (algorithms::find_missing(row.name) && !peer_of(row.name, plugin.path)))
        throw std::invalid_argument("has a row '" + row.name + "', a name that another method has; rename it");
    for (Algorithm& row : rows) {
      const std::string version = std::move(row.library.version);
      const Algorithm* peer = peer_of(row.name, plugin.path);
      row.library = peer ? peer->library : algorithms::Library{.name = plugin.path.filename().string()};
      row.library.version = version;
      row.library.sha256 = plugin.sha256;
      row.make = [plugin, name = row.name](const Bodies& bodies, const Knobs& knobs) {
        return made(plugin, name, bodies, knobs);
      };
      algorithms::add(std::move(row));
    }
  } catch (const FileFailure& failure) {
    throw Error(kInput, whose + failure.what() + "; name a shared library");
  } catch (const std::invalid_argument& error) {
    loaded().erase(plugin.path.string());
    throw Error(kInput, whose + error.what());
  }
  return plugin;
}

std::string lacking(const Algorithm& missing) {
  const std::filesystem::path file = missing.library.plugin ? beside_the_program(missing.name) : "";
  if (file.empty()) return algorithms::remedy(missing);
  try {
    add_plugin(file.filename().string(), file.parent_path(), "here");
    return "";
  } catch (const Error& error) {
    const std::string why = error.what();
    return algorithms::remedy(missing) + "; as it is" + why.substr(why.find("': ") + 2);
  }
}

std::vector<Plugin> add_plugins(const std::vector<std::string>& libraries) {
  std::vector<Plugin> out;
  for (const std::string& library : libraries) out.push_back(add_plugin(library, "", "--plugin"));
  return out;
}

Foreign library(const Algorithm& row, const Knobs& knobs, const Budget& budget) {
  const auto known =
      std::ranges::find_if(loaded(), [&](const auto& one) { return one.second.sha256 == row.library.sha256; });
  Foreign out;
  out.row = row;
  out.transport = "library";
  out.budget = budget;
  out.files = {{known->second.written, known->second.sha256}};
  out.start = [row, knobs, budget](const Bodies& bodies, const std::string&, const std::string&) {
    const auto make = [&] {
      return Hosted{{.name = row.name,
                     .version = row.library.version,
                     .language = row.library.language,
                     .tests = row.library.tests,
                     .licence = row.library.licence,
                     .precision = row.precision,
                     .promise = row.promise,
                     .scope = row.scope,
                     .operations_unit = row.operations_unit,
                     .remembers = true},  // a method without a memory is asked to keep and to lose it all the same
                    row.make(bodies, knobs)};
    };
    return isolated(make, bodies.size(), budget);
  };
  return out;
}

}  // namespace pipeline
