#include "pipeline/imported.hpp"

#include <fcntl.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "pipeline/amended.hpp"
#include "pipeline/config.hpp"
#include "pipeline/result/columns.hpp"
#include "pipeline/result/products/extremes.hpp"
#include "pipeline/result/products/passes.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/scene/answers_csv.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/stages/passes.hpp"
#include "pipeline/stages/summary.hpp"
#include "pipeline/system/file_bytes.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace fs = std::filesystem;
namespace {

/// A CSV, and what it is called in messages.
struct Csv {
  std::string name, bytes;
};

Csv read(const fs::path& path, const std::string& what) {
  const std::string name = one_line(path.string(), 4096);
  try {
    return {name, read_regular(AT_FDCWD, path)};
  } catch (const FileFailure& failure) {
    throw Error(kInput, name + ": " + failure.what() + "; name a CSV of " + what);
  }
}

/// Where and when it was timed: here, by the user's word, or anywhere.
Machine machine_of(const ImportOptions& options) {
  const Machine here = machine();
  if (options.language.empty() || options.times.empty()) return {"elsewhere", "not known", "not known", here.date};
  return {here.host, here.processor, here.build, here.date};
}

}  // namespace

Result import_answers(const fs::path& file, const ImportOptions& options) {
  if (!valid_label(options.label)) throw Error(kInput, "--label: '" + one_line(options.label) + "' must " + kLabelRule);
  const Csv csv = read(options.answers, "answers, step,a,b");
  const Csv times = options.times.empty() ? Csv{} : read(options.times, "times, step,ns");
  Amended amended(file, options.unsealed);
  Result& result = amended.result;
  if (result.products.find<Extremes>())
    throw Error(kFile, file.string() +
                           ": is of extremes, whose cases are also asked in the other order and moved, which a "
                           "list of answers does not tell; name a result of another scene");
  if (!options.force && place_of(options.label, result) < result.answers.size())
    throw Error(kFile, file.string() + ": has answers labelled '" + options.label +
                           "' already; --force replaces them, or give another label with --label");

  const std::size_t steps = result.steps();
  const PairLists lists = parse_answers(csv.bytes, csv.name, result.bodies, result.motion);
  Answers answers;
  answers.label = answers.name = options.label;
  answers.knobs = "{}";
  answers.promise = options.promise;
  answers.scope = options.scope;
  answers.machine = machine_of(options);
  nlohmann::json files = {{options.answers.filename().string(), sha256(csv.bytes)}};
  answers.time_ns.assign(steps, 0);
  if (!options.times.empty()) {
    answers.time_ns = parse_times(times.bytes, times.name, steps);
    files[options.times.filename().string()] = sha256(times.bytes);
  }
  ForeignFacts& facts = answers.foreign.emplace();
  facts.transport = "imported";
  facts.files = files.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  facts.language = options.language;
  facts.steps_done = std::int64_t(steps);
  answers.time_median_ns = answers.time_ns;
  for (const auto column : {&Answers::operations, &Answers::rounding_miss}) (answers.*column).assign(steps, 0);
  answers.prepare_ns.assign(steps, 0);
  for (std::size_t step = 0; step < steps; ++step) judge(lists.at(step), result.truth, step, answers);

  Evaluation found;
  if (const Passes* before = result.products.find<Passes>()) {
    const Scene scene = recorded_scene(result, recorded_config(result.config_effective, file.string()), file.string());
    found.products.put(
        Passes{.rows = {}, .answers = {sampled_pass_answers(scene.passes, result.truth, before->rows, answers)}});
  }
  add_inputs(files, result);
  found.summary = {summarise(answers, judged_pairs(result.bodies, result.motion, result.truth))};
  found.answers = {std::move(answers)};
  add(std::move(found), result);
  write_result(result, amended.target);
  return std::move(result);
}

}  // namespace pipeline
