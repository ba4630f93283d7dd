#include "pipeline/result/products/gaps.hpp"

#include <nlohmann/json.hpp>

#include "pipeline/result/dataset.hpp"
#include "pipeline/result/hdf5/reader.hpp"
#include "pipeline/result/products/all.hpp"
#include "pipeline/terminal/print.hpp"

namespace pipeline {
namespace {

void lay(const Result& result, const Sizes& n, std::vector<Group>& groups) {
  const GapLists& gaps = *result.truth.gaps;
  Group& truth = groups.back();
  truth.attributes.push_back({"gap_margin", gaps.margin});
  add_pairs(truth, gaps.pairs, "pairs of bodies that do not meet and are within gap_margin", n, "gap_");
  const Dimension entry{"/truth/gap_entry", gaps.pairs.pair.size()};
  each_gap_column([&](const auto& column) {
    truth.datasets.push_back(viewed(std::string("/truth/") + column.name, std::span(gaps.*column.member), {entry},
                                    column.units, column.long_name));
  });
}

void read(const Reader& from, Result& result) {
  GapLists& gaps = result.truth.gaps.emplace();
  gaps.margin = from.attribute<double>("/truth", "gap_margin");
  gaps.pairs = from.pairs("/truth", result.steps(), result.bodies.size(), "gap_");
  each_gap_column([&](const auto& column) {
    gaps.*column.member = from.values<double>(std::string("/truth/") + column.name, {gaps.pairs.pair.size()});
  });
}

std::string line(const Result& result) {
  return print("%zu distances of pairs within %g m that do not meet\n", result.truth.gaps->pairs.pair.size(),
               result.truth.gaps->margin);
}

void json(const Result& result, OrderedJson& out) {
  if (!result.truth.gaps) return;
  out["gaps"] = result.truth.gaps->pairs.pair.size();
  out["gap_margin"] = result.truth.gaps->margin;
}

std::string plan(const OrderedJson& asked) {
  if (!asked.contains("gap_margin")) return "gaps        not asked for, so no distance is computed\n";
  return print("gaps        a lower and an upper bound on the distance of pairs within %g m that do not meet\n",
               asked["gap_margin"].get<double>());
}

Cost cost(const OrderedJson& asked, const Extent& run) {
  constexpr double kGap = 12;  // bytes of two reals; about a pair a body
  return asked.contains("gap_margin") ? Cost{.objects = 5, .bytes = kGap * run.moving} : Cost{};
}

}  // namespace

Product gaps_product() {
  return {.name = "gaps",
          .place = Product::Place::in_truth,
          .sign = "/truth/gap_pair",
          .has = [](const Result& result) { return result.truth.gaps.has_value(); },
          .lay = lay,
          .read = read,
          .when = "[truth] gap = true",
          .sample =
              [](Result& result) {
                GapLists& gaps = result.truth.gaps.emplace();
                for (int step = 0; step < 2; ++step) gaps.pairs.append({});
              },
          .line = line,
          .json = json,
          .plan = plan,
          .cost = cost};
}

}  // namespace pipeline
