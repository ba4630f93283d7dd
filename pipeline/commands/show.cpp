#include "pipeline/commands/show.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "pipeline/commands/command.hpp"
#include "pipeline/config.hpp"
#include "pipeline/result/columns.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/stages/extremes.hpp"
#include "pipeline/stages/passes.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using Json = nlohmann::ordered_json;

/// Rows as aligned columns; the first is flush left, the rest flush right.
std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> width;
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (width.size() <= c) width.push_back(0);
      width[c] = std::max(width[c], row[c].size());
    }
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string pad(width[c] - row[c].size(), ' ');
      text += c == 0 ? row[c] + pad : "  " + pad + row[c];
    }
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

std::string time_text(double ns) {
  if (std::isnan(ns)) return "-";
  if (ns < 1e3) return print("%.0f ns", ns);
  if (ns < 1e6) return print("%.2f us", ns * 1e-3);
  if (ns < 1e9) return print("%.3f ms", ns * 1e-6);
  return print("%.3f s", ns * 1e-9);
}

/// "66.1 us to 70.3 us", or "-" where there is none.
std::string interval_text(const std::optional<double>& low, const std::optional<double>& high) {
  if (!low || !high || std::isnan(*low) || std::isnan(*high)) return "-";
  return time_text(*low) + " to " + time_text(*high);
}

std::string heap_text(const std::optional<double>& bytes) {
  return bytes && *bytes >= 0 ? bytes_text(std::uint64_t(*bytes)) : "-";
}

/// What makes times doubtful, and what they differ by anyway; a line each.
std::string times_text(const Result& result) {
  constexpr double kDisturbed = 1.02;  // of the processor's time: more wall time than that was not the algorithm's
  std::string text, disturbed, few, pinned;
  const auto add = [](std::string& list, const std::string& label) { list += (list.empty() ? "" : ", ") + label; };
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    const Summary& row = result.summary[a];
    const std::string& label = result.answers[a].label;
    const double share = row.time_mean_ns / row.processor_mean_ns.value_or(row.time_mean_ns);
    if (share > kDisturbed) add(disturbed, label + print(" by %.1f %%", 100 * (share - 1)));
    if (row.time_mean_ns > row.time_p95_ns) add(few, label);
    const std::string number = std::to_string(result.answers[a].machine.pinned);
    if (result.answers[a].machine.pinned >= 0 && pinned.find(number) == std::string::npos) add(pinned, number);
  }
  if (!pinned.empty()) text += "timed on processor " + pinned + " alone\n";
  if (result.noise)
    text +=
        std::isnan(result.noise->low)
            ? print("noise floor: %s timed twice has a ratio of %.3f; too few steps for its interval\n",
                    result.noise->label.c_str(), result.noise->ratio)
            : print("noise floor: %s timed twice has a ratio of %.3f (%.3f to %.3f); no smaller one is a difference\n",
                    result.noise->label.c_str(), result.noise->ratio, result.noise->low, result.noise->high);
  if (!disturbed.empty())
    text +=
        "DISTURBED: the wall time is above the processor's own, of " + disturbed + "; time again on an idle machine\n";
  if (!few.empty())
    text +=
        "the mean time lies above its 95th percentile, of " + few + ": a few steps or a disturbance take most of it\n";
  return text.empty() ? "" : text + "\n";
}

std::string share_text(double value) { return std::isnan(value) ? "-" : print("%.4f", value); }

/// Targets across, algorithms down: when each first reports, and what it never or wrongly does.
std::string passes_text(const Result& result) {
  const Passes& passes = *result.passes;
  const std::vector<std::string> names = targets(passes.rows);
  std::vector<std::vector<std::string>> first = {{"first report"}}, wrong = {{"missed + false positives"}};
  for (const std::string& name : names) {
    first[0].push_back(name);
    wrong[0].push_back(name);
  }
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    first.push_back({result.answers[a].label});
    wrong.push_back({result.answers[a].label});
    for (const std::string& name : names) {
      const TargetSummary row = summarise(passes.rows, passes.answers[a], name);
      // Positions are found to 1e-6 m: less than half a millimetre is nothing, and has no sign.
      first.back().push_back(std::isnan(row.median)           ? "-"
                             : std::fabs(row.median) < 0.5e-3 ? "0.000"
                                                              : print("%+.3f", row.median));
      wrong.back().push_back(print("%llu + %llu", static_cast<unsigned long long>(row.missed),
                                   static_cast<unsigned long long>(row.false_positives)));
    }
  }
  std::vector<std::string> met = {"passes that meet"};
  for (const std::string& name : names) {
    std::size_t all = 0, meet = 0;
    for (const PassRow& row : passes.rows) {
      all += row.target == name;
      meet += row.target == name && row.truth_hits > 0;
    }
    met.push_back(print("%zu of %zu", meet, all));
  }
  first.push_back(met);
  return aligned(first) +
         "\nfirst report: metres before (+) or after (-) the exact first contact, the median over the passes that meet "
         "and are reported\n\n" +
         aligned(wrong) +
         "\nmissed: passes that meet and are never reported; false positives: passes that never meet and are "
         "reported\n\n";
}

Json passes_json(const Result& result) {
  const Passes& passes = *result.passes;
  Json json = Json::array();
  for (const std::string& name : targets(passes.rows))
    for (std::size_t a = 0; a < result.answers.size(); ++a) {
      const TargetSummary row = summarise(passes.rows, passes.answers[a], name);
      json.push_back({{"target", name},
                      {"algorithm", result.answers[a].label},
                      {"passes", row.passes},
                      {"met", row.met},
                      {"missed", row.missed},
                      {"false_positives", row.false_positives},
                      {"flicker", row.flicker},
                      {"first_median", row.median},
                      {"first_earliest", row.earliest},
                      {"first_latest", row.latest}});
    }
  return json;
}

/// The different values of a column, ascending.
std::vector<double> distinct(const Extremes& extremes, double ExtremeCase::*column) {
  std::vector<double> out;
  for (const ExtremeCase& row : extremes.rows) out.push_back(row.*column);
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// How often algorithms err near touching and clear of it, by scale and by offset, and how often they contradict
/// themselves.
std::string extremes_text(const Result& result) {
  const Extremes& extremes = *result.extremes;
  std::vector<std::vector<std::string>> rows = {
      {"cases", "error clear", "error near", "failed", "swap changes", "move changes"}};
  std::vector<std::vector<std::string>> places = {{"error clear of touching"}};
  const std::vector<double> scales = distinct(extremes, &ExtremeCase::scale),
                            offsets = distinct(extremes, &ExtremeCase::offset);
  for (const double scale : scales) places[0].push_back(print("scale %g", scale));
  for (const double offset : offsets) places[0].push_back(print("offset %g", offset));
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    const auto error = [&](auto chosen) { return share_text(count(extremes, a, chosen).error()); };
    const auto clear = [](const ExtremeCase& row) { return !row.near_touching; };
    const ExtremesInstability unsure = instability(extremes, a);
    rows.push_back({result.answers[a].label, error(clear),
                    error([](const ExtremeCase& row) { return row.near_touching; }),
                    std::to_string(count(extremes, a, [](const ExtremeCase&) { return true; }).failed),
                    std::to_string(unsure.swapped), std::to_string(unsure.moved)});
    places.push_back({result.answers[a].label});
    for (const double scale : scales)
      places.back().push_back(error([&](const ExtremeCase& row) { return clear(row) && row.scale == scale; }));
    for (const double offset : offsets)
      places.back().push_back(error([&](const ExtremeCase& row) { return clear(row) && row.offset == offset; }));
  }
  const auto near = std::ranges::count_if(extremes.rows, [](const ExtremeCase& row) { return row.near_touching; });
  std::string text =
      aligned(rows) +
      print(
          "\nof %zu cases %td are near touching: the truth changes within %lld ulps; failed: refused the bodies or "
          "threw, no part of these errors\n\n",
          extremes.rows.size(), near, static_cast<long long>(kNearUlps)) +
      aligned(places) +
      "\nfar offsets lack small scales and small gaps, which rounding would swallow: like is compared with like by\n"
      "analysis.tables.extremes, error_by_offset(run, like=True)\n\n";
  for (std::size_t a = 0; a < result.answers.size(); ++a)
    if (!extremes.answers[a].reason.empty())
      text += result.answers[a].label + " failed first: " + one_line(extremes.answers[a].reason, 200) + "\n";
  return text + "\n";
}

Json extremes_json(const Result& result) {
  const Extremes& extremes = *result.extremes;
  Json json = Json::array();
  for (std::size_t a = 0; a < result.answers.size(); ++a)
    for (const bool near : {false, true}) {
      const ExtremesCount row =
          count(extremes, a, [&](const ExtremeCase& row) { return bool(row.near_touching) == near; });
      json.push_back({{"algorithm", result.answers[a].label},
                      {"near_touching", near},
                      {"cases", row.cases},
                      {"true_positive", row.true_positive},
                      {"false_positive", row.false_positive},
                      {"false_negative", row.false_negative},
                      {"failed", row.failed},
                      {"error", row.error()}});
    }
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
  return {{"creator", from.creator},
          {"git_commit", from.git_commit},
          {"build_type", from.build_type},
          {"compiler", from.compiler},
          {"flags", from.flags},
          {"library_versions", Json::parse(from.library_versions)},
          {"config_sha256", from.config_sha256},
          {"inputs_sha256", Json::parse(from.inputs_sha256)},
          {"date", from.date},
          {"host", from.host},
          {"processor", from.processor},
          {"wall_time_s", from.wall_time_s}};
}

/// What an integrator did in a sweep.
struct SweepSummary {
  std::string sweep, integrator;
  std::string statuses = {};  // of those that did not finish: "2 energy, 1 aborted"
  std::size_t cases = 0, finished = 0;
  double least_error = StudyRow::kNone, worst_energy = 0, time_ns = 0;  // of the finished; total
  std::uint64_t evaluations = 0;
};

std::vector<SweepSummary> summarise(const std::vector<StudyRow>& rows) {
  std::vector<SweepSummary> out;
  std::vector<std::map<std::string, int>> failed;
  for (const StudyRow& row : rows) {
    if (out.empty() || out.back().sweep != row.sweep || out.back().integrator != row.integrator) {
      out.push_back({.sweep = row.sweep, .integrator = row.integrator});
      failed.emplace_back();
    }
    SweepSummary& s = out.back();
    ++s.cases;
    s.time_ns += double(row.time_ns);
    s.evaluations += row.force_evaluations;
    if (row.finished) {
      ++s.finished;
      s.least_error = std::fmin(s.least_error, row.error);
      if (std::fabs(row.energy_error) > std::fabs(s.worst_energy)) s.worst_energy = row.energy_error;
    } else {
      ++failed.back()[row.status];
    }
  }
  for (std::size_t i = 0; i < out.size(); ++i)
    for (const auto& [status, count] : failed[i])
      out[i].statuses += (out[i].statuses.empty() ? "" : ", ") + std::to_string(count) + " " + status;
  return out;
}

std::string study_text(const Result& result, bool digests) {
  std::vector<std::vector<std::string>> table = {{"sweep", "integrator", "cases", "finished", "least error",
                                                  "worst energy", "evaluations", "time", "not finished"}};
  std::size_t finished = 0;
  for (const SweepSummary& s : summarise(*result.study)) {
    finished += s.finished;
    table.push_back({s.sweep, s.integrator, std::to_string(s.cases), std::to_string(s.finished),
                     std::isnan(s.least_error) ? "-" : print("%.1e", s.least_error), print("%+.1e", s.worst_energy),
                     std::to_string(s.evaluations), time_text(s.time_ns), s.statuses});
  }
  return result.title + "\n" +
         print("a study of integrators: %zu cases, %zu finished\n\n", result.study->size(), finished) + aligned(table) +
         "\nleast error: relative or rad, over the cases that finished; worst energy: greatest error of its balance "
         "there; time: of processor, all cases\n\n" +
         provenance_text(result, digests);
}

std::string study_json(const Result& result, const std::string& path) {
  Json json = {{"file", path},
               {"complete", true},
               {"title", result.title},
               {"schema_version", kSchemaVersion},
               {"study", "integration"},
               {"cases", result.study->size()},
               {"finished", std::ranges::count_if(*result.study, &StudyRow::finished)},
               {"digest", result.digest}};
  for (const auto& [group, digest] : digests(result)) json["digests"][group] = digest;
  json["sweeps"] = Json::array();
  for (const SweepSummary& s : summarise(*result.study))
    json["sweeps"].push_back({{"sweep", s.sweep},
                              {"integrator", s.integrator},
                              {"cases", s.cases},
                              {"finished", s.finished},
                              {"not_finished", s.statuses},
                              {"least_error", s.least_error},
                              {"worst_energy_error", s.worst_energy},
                              {"force_evaluations", s.evaluations},
                              {"time_ns", s.time_ns}});
  json["provenance"] = provenance_json(result.provenance);
  return dumped(json);
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

}  // namespace

std::string result_text(const Result& result, bool digests) {
  if (result.study) return study_text(result, digests);
  std::string text = result.title + "\n";
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
  if (result.truth.gaps)
    text += print("%zu distances of pairs within %g m that do not meet\n", result.truth.gaps->pairs.pair.size(),
                  result.truth.gaps->margin);
  if (result.physics) text += "integration " + result.physics->status + "\n";
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
  text += times_text(result);

  if (result.passes && !result.answers.empty()) text += passes_text(result);
  if (result.extremes && !result.answers.empty()) text += extremes_text(result);

  text += provenance_text(result, digests);
  return text;
}

std::string result_json(const Result& result, const std::string& path) {
  if (result.study) return study_json(result, path);
  Json json = {{"file", path},
               {"complete", true},
               {"title", result.title},
               {"schema_version", kSchemaVersion},
               {"steps", result.steps()},
               {"bodies", result.bodies.size()},
               {"rate", result.rate},
               {"repeats", recorded_config(result.config_effective, path).repeats},
               {"truth_hits", result.truth.hits.pair.size()},
               {"containment", text_of(result.truth.containment)},
               {"contained", result.truth.contained.pair.size()},
               {"contained_inside", Json(nullptr)},
               {"digest", result.digest}};
  if (result.truth.contained_inside) {
    json["contained_inside"] = Json::object();
    for (const auto& [name, pairs] : contained_names(result)) json["contained_inside"][name] = pairs;
  }
  if (result.truth.gaps) {
    json["gaps"] = result.truth.gaps->pairs.pair.size();
    json["gap_margin"] = result.truth.gaps->margin;
  }
  json["integration"] = result.physics ? Json(result.physics->status) : Json(nullptr);
  for (const auto& [group, digest] : digests(result)) json["digests"][group] = digest;
  json["algorithms"] = Json::array();
  for (std::size_t a = 0; a < result.answers.size(); ++a) {
    const Answers& answers = result.answers[a];
    const Summary& row = result.summary[a];
    json["algorithms"].push_back({{"label", answers.label},
                                  {"name", answers.name},
                                  {"thesis_key", answers.thesis_key},
                                  {"knobs", Json::parse(answers.knobs)},
                                  {"promise", answers.promise},
                                  {"scope", answers.scope},
                                  {"operations_unit", answers.operations_unit},
                                  {"library", answers.library}});
    if (answers.foreign) json["algorithms"].back()["transport"] = answers.foreign->transport;
    if (answers.machine.pinned >= 0) json["algorithms"].back()["pinned"] = answers.machine.pinned;
    each_summary_column([&]<class T, class Stored>(const Column<Summary, T, Stored>& column) {
      if constexpr (!is_optional<T>)
        json["algorithms"].back()[column.name] = row.*column.member;
      else if (row.*column.member)
        json["algorithms"].back()[column.name] = *(row.*column.member);
    });
  }
  if (result.noise)
    json["noise"] = {{"label", result.noise->label},
                     {"ratio", result.noise->ratio},
                     {"ratio_low", result.noise->low},
                     {"ratio_high", result.noise->high}};
  if (result.passes) json["passes"] = passes_json(result);
  if (result.extremes) json["extremes"] = extremes_json(result);
  json["provenance"] = provenance_json(result.provenance);
  return dumped(json);
}

std::string checkpoint_text(const CheckpointStatus& status, const std::string& path) {
  if (status.study)
    return status.title + "\n" + path + ": an unfinished study; the same `pipeline run` resumes it\n" +
           print("%lld of %lld cases\n", static_cast<long long>(status.cases), static_cast<long long>(status.steps));
  const auto line = [&](const char* stage, std::int64_t steps) {
    return print("%-8s %lld of %lld steps\n", stage, static_cast<long long>(steps),
                 static_cast<long long>(status.steps));
  };
  return status.title + "\n" + path + ": an unfinished run; the same `pipeline run` resumes it\n" +
         line("motion", status.motion_steps) + line("truth", status.truth_steps) +
         line("detect", status.answered_steps);
}

std::string checkpoint_json(const CheckpointStatus& status, const std::string& path) {
  if (status.study)
    return dumped(Json{{"file", path},
                       {"complete", false},
                       {"title", status.title},
                       {"cases", status.steps},
                       {"finished_cases", status.cases}});
  const Json json = {{"file", path},
                     {"complete", false},
                     {"title", status.title},
                     {"steps", status.steps},
                     {"motion_steps", status.motion_steps},
                     {"truth_steps", status.truth_steps},
                     {"answered_steps", status.answered_steps}};
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
