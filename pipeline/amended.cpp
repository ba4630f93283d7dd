#include "pipeline/amended.hpp"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "pipeline/result/product.hpp"
#include "pipeline/result/products/extremes.hpp"
#include "pipeline/result/products/noise.hpp"
#include "pipeline/result/products/passes.hpp"
#include "pipeline/result/products/proxies.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace fs = std::filesystem;
namespace {

/// A link stays one.
fs::path real_path(const fs::path& file, bool unsealed) {
  std::error_code missing;
  const fs::path real = fs::canonical(file, missing);
  if (missing) read_result(file, unsealed);  // throws what is wrong
  return real;
}

/// What stands in place of meshes, as a run with all these labels has it.
void add_proxies(Proxies* found, const std::set<std::string>& answered, Result& result) {
  Proxies all;
  if (Proxies* before = result.products.find<Proxies>()) all = std::move(*before);
  std::erase_if(all.rows, [&](const MeshProxy& row) { return answered.contains(row.label); });
  if (found) std::ranges::move(found->rows, std::back_inserter(all.rows));
  std::ranges::stable_sort(all.rows, {}, [&](const MeshProxy& row) { return place_of(row.label, result); });
  if (all.rows.empty())
    result.products.drop<Proxies>();
  else
    result.products.put(std::move(all));
}

}  // namespace

Amended::Amended(const fs::path& file, bool unsealed)
    : target(real_path(file, unsealed), Existing::update), result(read_result(real_path(file, unsealed), unsealed)) {
  if (!result.foreign.empty())
    throw Error(
        kFile, file.string() + ": holds '" + one_line(result.foreign.front()) +
                   "', which is not this program's and would be lost; take it out first, or work on a copy without it");
  if (const Product* product = stands_alone(result))
    throw Error(kFile, file.string() + ": is " + product->what + ", without poses to answer; name a result of a scene");
}

std::size_t place_of(const std::string& label, const Result& result) {
  return std::size_t(std::ranges::find(result.answers, label, &Answers::label) - result.answers.begin());
}

Scene recorded_scene(const Result& result, const Config& config, const std::string& file) {
  const Passes* passes = result.products.find<Passes>();
  const bool cases = result.products.find<Extremes>() != nullptr;
  if (!passes && !cases) return {};
  Scene scene = config.scene_kind->make(config);
  const auto& sets = scene.case_sets;
  if (cases && (sets.empty() || std::size_t(sets.back().first_step + sets.back().steps) != result.steps()))
    throw Error(kFile, file + ": its cases are not those of its configuration; run again with --force");
  const auto same = [&](const Pass& pass, const PassRow& row) {
    return std::uint64_t(pass.first_step) == row.first_step && std::uint64_t(pass.samples) == row.samples &&
           row.samples <= result.steps() && row.first_step <= result.steps() - row.samples;
  };
  if (passes && !std::ranges::equal(scene.passes, passes->rows, same))
    throw Error(kFile, file + ": its passes are not those of its configuration; run again with --force");
  return scene;
}

void add(Evaluation found, Result& result) {
  std::set<std::string> answered;
  for (const Answers& answers : found.answers) answered.insert(answers.label);
  for (std::size_t i = 0; i < found.answers.size(); ++i) {
    const std::size_t at = place_of(found.answers[i].label, result);
    for (const Product& product : products())
      if (product.take && product.has(result)) product.take(found.products, i, result.products, at);
    if (at == result.answers.size()) {
      result.answers.emplace_back();
      result.summary.emplace_back();
    }
    result.summary[at] = std::move(found.summary[i]);
    result.answers[at] = std::move(found.answers[i]);
  }
  if (Noise* noise = found.products.find<Noise>()) result.products.put(std::move(*noise));
  add_proxies(found.products.find<Proxies>(), answered, result);
  make_products(result);
}

void add_inputs(const nlohmann::json& files, Result& result) {
  nlohmann::json inputs = nlohmann::json::parse(result.provenance.inputs_sha256);
  inputs.update(files);
  result.provenance.inputs_sha256 = inputs.dump();
}

void make_products(Result& result) {
  for (const Product& product : products())
    if (product.make) product.make(result);
}

}  // namespace pipeline
