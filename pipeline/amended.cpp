#include "pipeline/amended.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "pipeline/result/product.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/summary.hpp"
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

}  // namespace

Amended::Amended(const fs::path& file, bool unsealed)
    : file(file),
      target(real_path(file, unsealed), Existing::update),
      result(read_result(real_path(file, unsealed), unsealed)) {
  if (!result.foreign.empty())
    throw Error(
        kFile, file.string() + ": holds '" + one_line(result.foreign.front()) +
                   "', which is not this program's and would be lost; take it out first, or work on a copy without it");
  if (const Product* product = stands_alone(result))
    throw Error(kFile, file.string() + ": is " + product->what + ", without poses to answer; name a result of a scene");
}

std::size_t Amended::place_of(const std::string& label) const {
  const auto same = [&](const Answers& answers) { return answers.label == label; };
  return std::size_t(std::ranges::find_if(result.answers, same) - result.answers.begin());
}

void Amended::refuse_label(const std::string& label, const std::string& option) const {
  if (place_of(label) < result.answers.size())
    throw Error(kFile, file.string() + ": has answers labelled '" + label +
                           "' already; --force replaces them, or give another label with " + option);
}

std::vector<Pass> Amended::passes(const Config& config, const std::vector<PassRow>& rows) const {
  std::vector<Pass> passes = config.scene_kind->make(config).passes;
  const auto same = [&](const Pass& pass, const PassRow& row) {
    return std::uint64_t(pass.first_step) == row.first_step && std::uint64_t(pass.samples) == row.samples &&
           row.samples <= result.steps() && row.first_step <= result.steps() - row.samples;
  };
  if (!std::ranges::equal(passes, rows, same))
    throw Error(kFile, file.string() + ": its passes are not those of its configuration; run again with --force");
  return passes;
}

void Amended::put(Answers answers, Products& products_of_them, std::size_t i) {
  if (!pairs_) pairs_ = judged_pairs(result);
  const std::size_t at = place_of(answers.label);
  if (at == result.answers.size()) {
    result.answers.emplace_back();
    result.summary.emplace_back();
  }
  for (const Product& product : products())
    if (product.take && product.has(result)) product.take(products_of_them, i, result.products, at);
  result.summary[at] = summarise(answers, *pairs_);
  result.answers[at] = std::move(answers);
}

void Amended::add_inputs(const std::string& files) {
  nlohmann::json inputs = nlohmann::json::parse(result.provenance.inputs_sha256);
  inputs.update(nlohmann::json::parse(files));
  result.provenance.inputs_sha256 = inputs.dump();
}

void make_products(Result& result) {
  for (const Product& product : products())
    if (product.make) product.make(result);
}

}  // namespace pipeline
