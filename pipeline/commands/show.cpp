#include "pipeline/commands/show.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/commands/choice.hpp"
#include "pipeline/commands/command.hpp"
#include "pipeline/config.hpp"
#include "pipeline/result/attributes.hpp"
#include "pipeline/result/columns.hpp"
#include "pipeline/result/product.hpp"
#include "pipeline/result/products/machines.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using Json = nlohmann::ordered_json;

/// What methods of others are, and how they ended.
std::string foreign_text(const Result& result) {
  std::string text;
  for (const Answers& answers : result.answers) {
    if (!answers.foreign) continue;
    const ForeignFacts& facts = *answers.foreign;
    text += answers.label + ": " + facts.transport;
    if (!facts.command.empty()) text += " " + one_line(facts.command, 200);
    text += "; " + answers.name;
    if (!facts.version.empty()) text += " " + one_line(facts.version, 200);
    if (!facts.language.empty()) text += ", " + one_line(facts.language, 200);
    if (!facts.precision.empty()) text += ", " + one_line(facts.precision, 200) + " precision";
    if (!facts.tests.empty()) text += ", tests " + one_line(facts.tests, 200);
    if (!facts.licence.empty()) text += ", " + one_line(facts.licence, 200);
    if (facts.threads != 1) text += ", " + std::to_string(facts.threads) + " threads";
    text += '\n';
    if (failed(answers))
      text += "    failed after " + std::to_string(facts.steps_done) + " of " + std::to_string(result.steps()) +
              " steps, whose sums these are: " + one_line(facts.reason, 1000) + "\n";
  }
  return text.empty() ? text : text + "\n";
}

/// "66.1 us to 70.3 us", or "-" where there is none.
std::string interval_text(const std::optional<double>& low, const std::optional<double>& high) {
  if (!low || !high || std::isnan(*low) || std::isnan(*high)) return "-";
  return time_text(*low) + " to " + time_text(*high);
}

std::string heap_text(const std::optional<double>& bytes) {
  return bytes && *bytes >= 0 ? bytes_text(std::uint64_t(*bytes)) : "-";
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// What makes times doubtful; a line each.
std::string times_text(const Result& result) {
  constexpr double kDisturbed = 1.02;  // of the processor's time: more wall time than that was not the algorithm's
  std::string text, disturbed, few;
  std::set<std::int64_t> pinned;
  const auto add = [](std::string& list, const std::string& label) { list += (list.empty() ? "" : ", ") + label; };
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    const Summary& row = result.summary[a];
    const std::string& label = result.answers[a].label;
    const double share = row.time_mean_ns / row.processor_mean_ns.value_or(row.time_mean_ns);
    if (share > kDisturbed) add(disturbed, label + print(" by %.1f %%", 100 * (share - 1)));
    if (row.time_mean_ns > row.time_p95_ns) add(few, label);
    if (const std::int64_t number = result.answers[a].machine.pinned; number >= 0) pinned.insert(number);
  }
  for (const Answers& answers : result.answers) {
    if (!timed_on_unlike(answers)) continue;
    text += answers.label + " was TIMED ON UNLIKE PROCESSORS, and has no time of the run:\n";
    for (const TimesOf& of : times_by_processor(answers))
      text += print("    %s a step, mean of %zu steps, on ", time_text(of.mean_ns).c_str(), of.steps) + of.processor +
              " (" + joined(of.hosts) + ")\n";
  }
  for (const std::int64_t number : pinned) text += "timed on processor " + std::to_string(number) + " alone\n";
  if (!disturbed.empty())
    text +=
        "DISTURBED: the wall time is above the processor's own, of " + disturbed + "; time again on an idle machine\n";
  if (!few.empty())
    text +=
        "the mean time lies above its 95th percentile, of " + few + ": a few steps or a disturbance take most of it\n";
  return text.empty() ? "" : text + "\n";
}

void add_texts(Json& json, const auto& texts, const auto& row) {
  for (const auto& [name, member, kind] : texts)
    json[name] = kind == Text::json ? Json::parse(row.*member) : Json(row.*member);
}

Json foreign_json(const Answers& answers) {
  Json json;
  add_texts(json, kForeignTexts, *answers.foreign);
  json["threads"] = answers.foreign->threads;
  json["status"] = failed(answers) ? "failed" : "complete";
  json["steps_done"] = answers.foreign->steps_done;
  return json;
}

std::string provenance_text(const Result& result, bool all_digests) {
  const Provenance& from = result.provenance;
  std::string text = "made by   " + from.creator + ", commit " + from.git_commit + ", " + from.build_type + ", " +
                     from.compiler + "\n";
  text += print("run       %s on %s (%s), %.1f s\n", from.date.c_str(), from.host.c_str(), from.processor.c_str(),
                from.wall_time_s);
  for (const auto& [group, digest] : digests(result))
    if (all_digests || group == "/") text += "digest    " + digest + "  " + group + "\n";
  return text;
}

Json provenance_json(const Provenance& from) {
  Json json;
  add_texts(json, kOriginTexts, from);
  add_texts(json, kRunTexts, from);
  json["wall_time_s"] = from.wall_time_s;
  return json;
}

/// The bodies that lie inside others, and in how many pairs and steps: the most first, then in their order.
std::vector<std::pair<std::string, std::size_t>> contained_names(const Result& result) {
  std::map<std::uint32_t, std::size_t> pairs;
  if (result.truth.contained_inside)
    for (const std::uint32_t body : *result.truth.contained_inside) ++pairs[body];
  std::vector<std::pair<std::string, std::size_t>> out;
  for (const auto& [body, count] : pairs) out.emplace_back(result.bodies.name[body], count);
  std::ranges::stable_sort(out, std::greater(), [](const auto& one) { return one.second; });
  return out;
}

/// What only results of scenes have.
void add_scene(const Result& result, const std::string& path, Json& json) {
  json.update({{"steps", result.steps()},
               {"bodies", result.bodies.size()},
               {"rate", result.rate},
               {"repeats", recorded_config(result.config_effective, path).repeats},
               {"truth_hits", result.truth.hits.pair.size()},
               {"containment", text_of(result.truth.containment)},
               {"contained", result.truth.contained.pair.size()},
               {"contained_inside", Json(nullptr)}});
  if (result.truth.contained_inside) {
    json["contained_inside"] = Json::object();
    for (const auto& [name, pairs] : contained_names(result)) json["contained_inside"][name] = pairs;
  }
  json["algorithms"] = Json::array();
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    const Answers& answers = result.answers[a];
    const Summary& row = result.summary[a];
    Json& of = json["algorithms"].emplace_back(Json{{"label", answers.label}});
    add_texts(of, kAnswerTexts, answers);
    if (answers.foreign) of["foreign"] = foreign_json(answers);
    add_texts(of["timed_on"], kMachineTexts, answers.machine);
    if (answers.machine.pinned >= 0) of["pinned"] = answers.machine.pinned;
    if (timed_on_unlike(answers))
      for (const TimesOf& times : times_by_processor(answers))
        of["unlike_processors"].push_back({{"processor", times.processor},
                                           {"hosts", times.hosts},
                                           {"steps", times.steps},
                                           {"time_mean_ns", times.mean_ns}});
    each_summary_column([&]<class T, class Stored>(const Column<Summary, T, Stored>& column) {
      if constexpr (!is_optional<T>)
        of[column.name] = row.*column.member;
      else if (row.*column.member)
        of[column.name] = *(row.*column.member);
    });
  }
  json["which_one"] = Json::parse(advice_json(result));
}

}  // namespace

std::string result_text(const Result& result, bool digests) {
  std::string text = result.title + "\n";
  if (const Product* product = stands_alone(result))
    return text + product->text(result) + provenance_text(result, digests);
  text += print("%zu steps of %zu bodies at %g per second; %zu pairs meet over all steps\n", result.steps(),
                result.bodies.size(), result.rate, result.truth.hits.pair.size());
  if (result.truth.lists_contained())
    text += print("%zu pairs of which one lies inside the other: ", result.truth.contained.pair.size()) +
            (result.truth.containment == Containment::meet ? "they count as meeting\n"
                                                           : "hits on them are counted apart\n");
  if (const auto inside = contained_names(result); !inside.empty()) {
    constexpr std::size_t kMost = 5;
    text += "inside others lie:";
    for (std::size_t i = 0; i < inside.size() && i < kMost; ++i)
      text += print("%s %s (%zu)", i ? "," : "", inside[i].first.c_str(), inside[i].second);
    text += inside.size() > kMost ? print(" and %zu more\n", inside.size() - kMost) : "\n";
  }
  for (const Product& product : products())
    if (product.line && product.has(result)) text += product.line(result);
  text += "\n";

  std::vector<std::vector<std::string>> rows = {{"algorithm", "key", "scope", "error", "false positive",
                                                 "false negative", "hits", "mean time", "95 % interval", "p95 time",
                                                 "set-up", "memory", "operations", "promise"}};
  const bool counts_contained = result.truth.containment == Containment::record;
  if (counts_contained) rows[0].push_back("contained hits");
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    const Answers& answers = result.answers[a];
    const Summary& row = result.summary[a];
    rows.push_back({answers.label, answers.thesis_key, answers.scope, share_text(row.error),
                    std::to_string(row.false_positive), std::to_string(row.false_negative), std::to_string(row.hits),
                    time_text(row.time_mean_ns), interval_text(row.time_mean_low_ns, row.time_mean_high_ns),
                    time_text(row.time_p95_ns), time_text(row.setup_ns.value_or(Costs::kUnknown)),
                    heap_text(row.memory_greatest_bytes), std::to_string(row.operations),
                    answers.promise == "none" ? "-" : answers.promise + (row.promise_kept ? " kept" : " BROKEN")});
    if (counts_contained) rows.back().push_back(std::to_string(row.contained_hit.value_or(0)));
  }
  text += aligned(rows);
  text +=
      "\nerror = (false positive + false negative) / (true positive + false positive + false negative); times are "
      "per step, set-up is once; memory is heap at the most\n\n";
  text += advice_text(result);
  text += times_text(result);
  text += foreign_text(result);

  for (const Product& product : products())
    if (product.text && product.has(result)) text += product.text(result);

  text += provenance_text(result, digests);
  return text;
}

std::string result_json(const Result& result, const std::string& path) {
  Json json = {{"file", path}, {"complete", true}, {"title", result.title}, {"schema_version", kSchemaVersion}};
  json["digest"] = result.digest;
  for (const auto& [group, digest] : digests(result)) json["digests"][group] = digest;
  if (!stands_alone(result)) add_scene(result, path, json);
  for (const Product& product : products())
    if (product.json && (product.place == Product::Place::alone) == (stands_alone(result) != nullptr))
      product.json(result, json);
  json["provenance"] = provenance_json(result.provenance);
  return dumped(json);
}

std::string checkpoint_text(const CheckpointStatus& status, const std::string& path) {
  if (status.alone)
    return status.title + "\n" + path + ": an unfinished " + status.alone->name +
           "; the same `pipeline run` resumes it\n" +
           print("%lld of %lld cases\n", static_cast<long long>(status.cases), static_cast<long long>(status.steps));
  const auto line = [&](const char* stage, std::int64_t steps) {
    return print("%-8s %lld of %lld steps\n", stage, static_cast<long long>(steps),
                 static_cast<long long>(status.steps));
  };
  std::string text = status.title + "\n" + path + ": an unfinished run; the same `pipeline run` resumes it" +
                     (status.moved ? ", `pipeline work` fills it beside others\n" : "\n") +
                     line("motion", status.moved ? status.steps : status.motion_steps) +
                     line("truth", status.truth_steps) + line("detect", status.answered_steps);
  for (const std::string& held : status.held) text += "being made: " + held + "\n";
  return text;
}

std::string checkpoint_json(const CheckpointStatus& status, const std::string& path) {
  if (status.alone)
    return dumped(Json{{"file", path},
                       {"complete", false},
                       {"title", status.title},
                       {"cases", status.steps},
                       {"finished_cases", status.cases}});
  const Json json = {{"file", path},
                     {"complete", false},
                     {"title", status.title},
                     {"steps", status.steps},
                     {"motion_steps", status.moved ? status.steps : status.motion_steps},
                     {"truth_steps", status.truth_steps},
                     {"answered_steps", status.answered_steps},
                     {"held", status.held}};
  return dumped(json);
}

void add_show(CLI::App& program, int& code) {
  struct Options {
    std::string file;
    bool digests = false, unsealed = false, json = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command = *program.add_subcommand("show", "Summary, provenance and digest of a result");
  add_file(command, o->file, "Result file, or the FILE.part of an unfinished run");
  add_digests(command, o->digests);
  add_unsealed(command, o->unsealed);
  add_json(command, o->json);
  command.callback([o, &code] {
    if (std::filesystem::is_directory(o->file)) {
      put((o->json ? checkpoint_json : checkpoint_text)(checkpoint_status(o->file), o->file));
    } else {
      const Result result = read_result(o->file, o->unsealed);
      put(o->json ? result_json(result, o->file) : result_text(result, o->digests));
    }
    code = 0;
  });
}

}  // namespace pipeline
