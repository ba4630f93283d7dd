#include "pipeline/commands/score.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/commands/command.hpp"
#include "pipeline/result/columns.hpp"
#include "pipeline/result/output_file.hpp"
#include "pipeline/result/product.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/system/input_file.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using Json = nlohmann::json;  // objects are sorted by key

constexpr char kKind[] = "collision benchmark baseline";
constexpr char kTimeRatio[] = "time_ratio", kSetupRatio[] = "setup_ratio", kMemory[] = "memory_bytes";
/// What --times records beside the rest; never compared exactly.
constexpr const char* kCosts[] = {kTimeRatio, kSetupRatio, kMemory};
constexpr char kRemedy[] = "name a file that `pipeline score --write` made";

double median_of(std::vector<double> values) {
  std::ranges::sort(values);
  return median(values);
}

bool is_cost(std::string_view key) {
  return std::ranges::any_of(kCosts, [&](const char* cost) { return key == cost; });
}

/// Of the values that are known; NaN when none is.
double median_of_known(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !(value > 0); });
  return values.empty() ? Costs::kUnknown : median_of(std::move(values));
}

/// Three digits: a fourth would be noise, and change at every recording.
double rounded(double value) { return std::strtod(print("%.3g", value).c_str(), nullptr); }

Json baseline_of(const Result& result, bool times) {
  const auto digest = digests(result);
  Json json = {{"kind", kKind},
               {"schema_version", kBaselineSchema},
               {"steps", result.steps()},
               {"bodies", result.bodies.size()},
               {"motion", digest.at("/motion")},
               {"truth",
                {{"digest", digest.at("/truth")},
                 {"hits", result.truth.hits.pair.size()},
                 {"containment", std::string(text_of(result.truth.containment))}}},
               {"algorithms", Json::object()}};
  if (result.truth.lists_contained()) json["truth"]["contained"] = result.truth.contained.pair.size();
  for (const Product& product : products())
    if (product.figures && product.has(result)) product.figures(result, json["truth"]);
  std::vector<double> means, setups;
  for (const Summary& row : result.summary) {
    means.push_back(row.time_mean_ns);
    setups.push_back(row.setup_ns.value_or(Costs::kUnknown));
  }
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    const Answers& answers = result.answers[a];
    const Summary& row = result.summary[a];
    Json& of = json["algorithms"][answers.label];
    of = {{"name", answers.name},
          {"knobs", answers.knobs},
          {"answers", digest.at("/answers/" + answers.label)},
          {"hits", row.hits},
          {"true_positive", row.true_positive},
          {"false_positive", row.false_positive},
          {"false_negative", row.false_negative},
          {"rounding_miss", total(answers.rounding_miss)},
          {"operations", row.operations},
          {"operations_unit", answers.operations_unit}};
    if (answers.foreign) of["status"] = failed(answers) ? "failed" : "complete";
    if (row.contained_hit) of["contained_hit"] = *row.contained_hit;
    for (const Product& product : products())
      if (product.label_figures && product.has(result)) product.label_figures(result, a, of);
    if (!times) continue;
    const auto put = [&](const char* key, double value) {
      if (value > 0) of[key] = rounded(value);  // else it is not known
    };
    put(kTimeRatio, means[a] / median_of_known(means));
    put(kSetupRatio, setups[a] / median_of_known(setups));
    put(kMemory, row.memory_greatest_bytes.value_or(Costs::kUnknown));
  }
  return json;
}

Error bad(const std::string& place, const std::string& what) { return {kFile, place + ": " + what + "; " + kRemedy}; }

/// Sections and figures must be of the kinds that baseline_of makes.
void check(const Json& json, const std::string& place) {
  if (!json.is_object() || json.value("kind", Json()) != kKind) throw bad(place, "is no baseline");
  const Json version = json.value("schema_version", Json());
  if (version != kBaselineSchema)
    throw Error(kFile, place + ": has baseline schema " + one_line(version.dump()) + ", this program reads " +
                           std::to_string(kBaselineSchema) + "; record it again with --write at another place");
  constexpr const char* kTexts[] = {"containment", "name", "knobs", "answers", "operations_unit", "status"};
  const auto figures = [&](const Json& object, const std::string& of, std::initializer_list<const char*> required) {
    if (!object.is_object()) throw bad(place, one_line(of) + " is no object");
    for (const auto& [key, value] : object.items()) {
      const bool text =
          key.ends_with("digest") || std::ranges::any_of(kTexts, [&](const char* name) { return key == name; });
      if (is_cost(key) ? !(value.is_number() && value > 0) : text ? !value.is_string() : !value.is_number_unsigned())
        throw bad(place, one_line(of + "." + key) + " has a value of another kind");
    }
    for (const char* key : required)
      if (!object.contains(key)) throw bad(place, one_line(of) + " lacks '" + key + "'");
  };
  for (const char* key : {"steps", "bodies"})
    if (!json.contains(key) || !json[key].is_number_unsigned())
      throw bad(place, std::string("lacks the number ") + key);
  if (!json.contains("motion") || !json["motion"].is_string()) throw bad(place, "lacks the digest of motion");
  figures(json.value("truth", Json()), "truth", {"digest", "containment", "hits"});
  const Json algorithms = json.value("algorithms", Json());
  if (!algorithms.is_object()) throw bad(place, "lacks algorithms");
  for (const auto& [label, row] : algorithms.items())
    figures(row, label,
            {"name", "knobs", "answers", "operations_unit", "hits", "true_positive", "false_positive", "false_negative",
             "rounding_miss", "operations"});
}

std::optional<Json> read_baseline(const std::filesystem::path& path, bool may_miss) {
  const std::string place = path.string();
  std::error_code none;
  if (!std::filesystem::exists(path, none)) {
    if (may_miss) return std::nullopt;
    throw Error(kFile, place + ": does not exist; record it with --write");
  }
  constexpr std::uint64_t kMostBytes = 16 << 20;  // ours have 500 bytes a label
  const std::string text = text_of_file(path, kMostBytes, kRemedy);
  if (!is_shallow(text)) throw bad(place, "is JSON nested too deep");
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw bad(place, "is not JSON");
  check(json, place);
  return json;
}

/// Whether it is a result itself, which can stand for the baseline that it would make.
bool is_result(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return false;
  std::array<char, 4> start{};
  std::ifstream(path, std::ios::binary).read(start.data(), start.size());
  return std::string_view(start.data(), start.size()) == "\x89HDF";
}

std::string as_text(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

void compare(const std::string& of, const Json& before, const Json& now, std::vector<Change>& out) {
  const auto add = [&](const std::string& key, const Json* old, const Json* fresh) {
    if (is_cost(key) || (old && fresh && *old == *fresh)) return;
    Change change{of, key, old ? as_text(*old) : "", fresh ? as_text(*fresh) : "", std::nullopt};
    if (old && fresh && old->is_number() && fresh->is_number())
      change.by = std::int64_t(fresh->get<std::uint64_t>() - old->get<std::uint64_t>());
    out.push_back(std::move(change));
  };
  for (const auto& [key, value] : before.items()) add(key, &value, now.contains(key) ? &now[key] : nullptr);
  for (const auto& [key, value] : now.items())
    if (!before.contains(key)) add(key, nullptr, &value);
}

void compare_times(const Json& before, const Json& now, const std::string& place, const ScoreOptions& options,
                   Score& out) {
  for (const auto& [label, figures] : before.items()) {
    if (!now.contains(label)) continue;
    if (!now[label].contains(kTimeRatio) || figures.value("status", "") == "failed") continue;
    if (!figures.contains(kTimeRatio))
      throw Error(kFile, place + ": has no times of '" + one_line(label) + "'; record them with --write --times");
    out.times.push_back({label, figures[kTimeRatio].get<double>(), now[label][kTimeRatio].get<double>()});
    const auto factor = [&](const char* key) {
      const bool both = figures.contains(key) && now[label].contains(key);
      return both ? now[label][key].get<double>() / figures[key].get<double>() : Costs::kUnknown;
    };
    out.times.back().setup = factor(kSetupRatio);
    out.times.back().memory = factor(kMemory);
  }
  if (out.times.empty()) return;
  // Each over the median of those that both have: a new label does not shift the others.
  std::vector<double> old_ratios, new_ratios;
  for (const TimeChange& time : out.times) old_ratios.push_back(time.before), new_ratios.push_back(time.now);
  const double old_median = median_of(old_ratios), new_median = median_of(new_ratios);
  for (TimeChange& time : out.times) {
    time.before /= old_median;
    time.now /= new_median;
    const double factor = time.now / time.before;
    if (options.tolerance && !(factor <= *options.tolerance && factor >= 1 / *options.tolerance))
      out.beyond_tolerance.push_back(time.label);
  }
}

/// Digests are cut to what tells them apart.
std::string short_text(const std::string& text) {
  const bool digest = text.size() == 32 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
  return text.empty() ? "none" : digest ? text.substr(0, 8) : one_line(text);
}

}  // namespace

Score score(const Result& result, const std::filesystem::path& path, const ScoreOptions& options) {
  const std::string place = path.string();
  std::optional<OutputFile> target;
  if (options.write) target.emplace(path, Existing::update);
  const std::optional<Json> before = !options.write && is_result(path) ? baseline_of(read_result(path), options.times)
                                                                       : read_baseline(path, options.write);
  const Json now = baseline_of(result, options.times);

  Score out;
  if (options.times)
    for (const Answers& answers : result.answers)
      if (timed_on_unlike(answers)) out.unlike.push_back(answers.label);
  out.had_baseline = before.has_value();
  if (before) {
    const auto top = [](const Json& json) { return Json{{"steps", json["steps"]}, {"bodies", json["bodies"]}}; };
    compare("scene", top(*before), top(now), out.changes);
    compare("motion", {{"digest", (*before)["motion"]}}, {{"digest", now["motion"]}}, out.changes);
    compare("truth", (*before)["truth"], now["truth"], out.changes);
    const Json &old_rows = (*before)["algorithms"], &new_rows = now["algorithms"];
    for (const auto& [label, figures] : old_rows.items()) {
      if (!new_rows.contains(label)) {
        out.missing.push_back(label);
        continue;
      }
      ++out.algorithms;
      compare(label, figures, new_rows[label], out.changes);
    }
    for (const auto& [label, figures] : new_rows.items())
      if (!old_rows.contains(label)) out.fresh.push_back(label);
    if (options.times && !options.write) compare_times(old_rows, new_rows, place, options, out);
  }
  if (options.write && (!before || *before != now)) {
    const std::string text = dumped(now);
    target->write(std::as_bytes(std::span(text)));
    out.written = true;
  }
  return out;
}

std::string score_text(const Score& score, const std::string& baseline) {
  std::string text;
  for (const std::string& label : score.unlike)
    text += label + ": was timed on unlike processors: its time is neither compared nor recorded\n";
  if (!score.had_baseline) return text + baseline + ": recorded\n";
  std::string of;
  for (const Change& change : score.changes) {
    if (change.of == of) {
      text += ", ";
    } else {
      if (!text.empty() && text.back() != '\n') text += '\n';
      text += change.of + ": ";
    }
    of = change.of;
    text += change.key + " " + short_text(change.before) + " -> " + short_text(change.now);
    if (!change.by) continue;
    text += *change.by > 0 ? " (+" : " (";
    text += std::to_string(*change.by) + ")";
  }
  if (!text.empty() && text.back() != '\n') text += "\n";
  for (const std::string& label : score.fresh) text += label + ": new, not in the baseline\n";
  for (const std::string& label : score.missing) text += label + ": missing, only in the baseline\n";
  for (const TimeChange& time : score.times) {
    text += print("%s: time %.3g -> %.3g of the median (x %.2f)", time.label.c_str(), time.before, time.now,
                  time.now / time.before);
    const bool beyond = std::ranges::find(score.beyond_tolerance, time.label) != score.beyond_tolerance.end();
    if (!std::isnan(time.setup)) text += print(", set-up x %.2f", time.setup);
    if (!std::isnan(time.memory)) text += print(", memory x %.2f", time.memory);
    text += beyond ? ", beyond the tolerance\n" : "\n";
  }
  if (score.written) return text + baseline + ": recorded\n";
  if (score.same()) text += "same as " + baseline + ": " + std::to_string(score.algorithms) + " algorithms\n";
  return text;
}

std::string score_json(const Score& score, const std::string& file, const std::string& baseline) {
  using Ordered = nlohmann::ordered_json;
  Ordered json = {{"file", file},
                  {"baseline", baseline},
                  {"same", score.had_baseline && score.same()},
                  {"written", score.written},
                  {"algorithms", score.algorithms},
                  {"changes", Ordered::array()},
                  {"new", score.fresh},
                  {"missing", score.missing}};
  for (const Change& change : score.changes) {
    Ordered entry = {{"of", change.of}, {"key", change.key}, {"before", change.before}, {"now", change.now}};
    if (change.by) entry["by"] = *change.by;
    json["changes"].push_back(entry);
  }
  if (!score.times.empty()) json["times"] = Ordered::array();
  for (const TimeChange& time : score.times)
    json["times"].push_back({{"label", time.label},
                             {"before", time.before},
                             {"now", time.now},
                             {"factor", time.now / time.before},
                             {"setup_factor", time.setup},
                             {"memory_factor", time.memory}});
  if (!score.times.empty()) json["beyond_tolerance"] = score.beyond_tolerance;
  if (!score.unlike.empty()) json["unlike_processors"] = score.unlike;
  return dumped(json);
}

void add_score(CLI::App& program, int& code) {
  struct Options : ScoreOptions {
    std::string file, baseline;
    bool unsealed = false, json = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command = *program.add_subcommand("score", "Compare a result with a recorded baseline, or record one");
  add_file(command, o->file);
  command.add_option("--against", o->baseline, "Baseline, a JSON file; or another result")->required();
  command.add_flag("--write", o->write, "Record: make or replace the baseline");
  CLI::Option* times = command.add_flag("--times", o->times, "Compare (or record) times too, as ratios within the run");
  command.add_option("--tolerance", o->tolerance, "A time ratio changed by more than this factor is a difference")
      ->option_text("FACTOR")
      ->check(CLI::Validator(
          [](std::string& text) {
            double factor = 0;
            const bool holds = CLI::detail::lexical_cast(text, factor) && factor >= 1 && factor <= 1e6;  // not nan
            return holds ? std::string() : "must be a factor from 1 to 1000000, not " + text;
          },
          ""))
      ->needs(times);
  add_unsealed(command, o->unsealed);
  add_json(command, o->json);
  command.callback([o, &code] {
    const Score scored = score(whole_result(o->file, o->unsealed), o->baseline, *o);
    put(o->json ? score_json(scored, o->file, o->baseline) : score_text(scored, o->baseline));
    code = o->write || scored.same() ? kDone : kFailed;
    if (code == kFailed)
      complain(o->file, "differs from " + o->baseline +
                            (is_result(o->baseline) ? "" : "; if that is meant, record it with --write"));
  });
}

}  // namespace pipeline
