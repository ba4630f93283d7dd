#include "pipeline/result/products/noise.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/result/dataset.hpp"
#include "pipeline/result/hdf5/reader.hpp"
#include "pipeline/result/products/all.hpp"
#include "pipeline/terminal/print.hpp"

namespace pipeline {
namespace {

void lay(const Result& result, const Sizes& n, std::vector<Group>& groups) {
  const Noise& noise = *result.products.find<Noise>();
  Group group{"/noise",
              {{"label", noise.label}, {"ratio", noise.ratio}, {"ratio_low", noise.low}, {"ratio_high", noise.high}},
              {}};
  group.datasets.push_back(viewed("/noise/time_ns", std::span(noise.time_ns), {n.step}, "ns",
                                  "fastest repeat of the step of the label, timed a second time"));
  groups.push_back(std::move(group));
}

void read(const Reader& from, Result& result) {
  Noise noise;
  noise.label = from.attribute<std::string>("/noise", "label");
  noise.ratio = from.attribute<double>("/noise", "ratio");
  noise.low = from.attribute<double>("/noise", "ratio_low");
  noise.high = from.attribute<double>("/noise", "ratio_high");
  noise.time_ns = from.values<std::int64_t>("/noise/time_ns", {result.steps()});
  result.products.put(std::move(noise));
}

std::string line(const Result& result) {
  const Noise& noise = *result.products.find<Noise>();
  const std::string twice = "noise floor: " + noise.label + " timed twice has a ratio of " + print("%.3f", noise.ratio);
  if (std::isnan(noise.low)) return twice + "; too few steps for its interval\n";
  return twice + print(" (%.3f to %.3f); no smaller one is a difference\n", noise.low, noise.high);
}

void json(const Result& result, OrderedJson& out) {
  const Noise* noise = result.products.find<Noise>();
  if (!noise) return;
  out["noise"] = {
      {"label", noise->label}, {"ratio", noise->ratio}, {"ratio_low", noise->low}, {"ratio_high", noise->high}};
}

}  // namespace

Product noise_product() {
  return {.name = "noise",
          .place = Product::Place::at_end,
          .sign = "/noise",
          .has = [](const Result& result) { return result.products.find<Noise>() != nullptr; },
          .lay = lay,
          .read = read,
          .when = "[timing] noise = true",
          .sample =
              [](Result& result) {
                result.products.put(Noise{}).time_ns = {0, 0};
              },
          .line = line,
          .json = json};
}

}  // namespace pipeline
