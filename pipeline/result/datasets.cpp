#include "pipeline/result/datasets.hpp"

#include <algorithm>
#include <map>

#include "pipeline/result/columns.hpp"
#include "pipeline/result/layout.hpp"
#include "pipeline/result/product.hpp"

namespace pipeline {
namespace {

/// Two bodies of one mesh, at two steps.
Result small() {
  Result out;
  out.bodies.meshes.emplace_back();
  out.bodies.meshes[0].name = "<mesh>";
  out.bodies.meshes[0].shape = "{}";
  for (const char* name : {"a", "b"}) out.bodies.add(name, 0);
  out.first_step = {0, 0};
  out.motion.assign(2, std::vector<geometry::Pose>(2));
  for (int step = 0; step < 2; ++step) out.truth.hits.append({});
  out.truth.time_ns = {0, 0};
  return out;
}

Result answered() {
  Result out = small();
  Answers& answers = out.answers.emplace_back();
  answers.label = "<label>";
  for (int step = 0; step < 2; ++step) answers.hits.append({});
  each_answer_column([&](const auto& column) { (answers.*column.member).resize(2); });
  answers.contained_hit.clear();
  Summary& row = out.summary.emplace_back();
  each_summary_column([&](const auto& column) {
    using Value = std::remove_reference_t<decltype(row.*column.member)>;
    if constexpr (is_optional<Value>) (row.*column.member).emplace();
  });
  row.contained_hit.reset();
  return out;
}

void touch_by_spheres(Result& result) { result.bodies.meshes[0].contact_spheres.resize(1); }

void list_contained(Result& result) {
  result.truth.containment = Containment::meet;
  for (int step = 0; step < 2; ++step) result.truth.contained.append({});
  result.truth.contained_inside.emplace();
  result.truth.closed_within = {0};
}

void count_contained(Result& result) {
  list_contained(result);
  result.truth.containment = Containment::record;
  result.answers[0].contained_hit = {0, 0};
  result.summary[0].contained_hit = 0;
}

/// What makes a result hold more than the truth and the answers, besides products.
struct Feature {
  const char* when;
  void (*add)(Result& result);
};
constexpr Feature kFeatures[] = {
    {"always", [](Result&) {}},
    {"bodies that are no spheres touch others", touch_by_spheres},
    {"only chosen bodies count",
     [](Result& result) {
       result.bodies.chosen = {1, 0};
     }},
    {"containment = \"record\" or \"meet\"", list_contained},
    {"containment = \"record\"", count_contained},
};

const char* type_text(Type type) {
  switch (type) {
    case Type::f64:
      return "float64";
    case Type::i64:
    case Type::offset:
      return "int64";
    case Type::u64:
      return "uint64";
    case Type::u32:
      return "uint32";
    case Type::u8:
      return "uint8";
    case Type::text:
      break;
  }
  return "text";
}

/// A dimension by the name of its scale; those that are always the same by their size.
std::string size_text(std::string_view scale, std::uint64_t size) {
  static const std::map<std::string_view, const char*> letters = {
      {"step", "S"},   {"boundary", "S + 1"},      {"body", "B"},  {"algorithm", "A"},
      {"vertex", "V"}, {"triangle", "T"},          {"pass", "P"},  {"sphere", "K"},
      {"case", "C"},   {"machine", "M"},           {"chunk", "N"}, {"ball", "K"},
      {"proxy", "X"},  {"solid_boundary", "N + 1"}};
  const std::string_view name = base_name(scale);
  if (const auto found = letters.find(name); found != letters.end()) return found->second;
  return name.ends_with("entry") ? "E" : std::to_string(size);
}

DatasetFacts facts_of(const Dataset& dataset, const char* when) {
  std::string shape;
  for (std::size_t i = 0; i < dataset.dims.size(); ++i)
    shape += (shape.empty() ? "" : ", ") + size_text(dataset.dims[i], dataset.shape[i]);
  return {dataset.path, shape, type_text(dataset.type), dataset.units, dataset.long_name, when};
}

}  // namespace

std::vector<DatasetFacts> dataset_facts() {
  std::vector<DatasetFacts> all;
  // What a result has more than those before it stands after its predecessor.
  const auto add = [&](const Result& result, const char* when) {
    std::size_t after = 0;
    for (const Group& group : layout(result))
      for (const Dataset& dataset : group.datasets) {
        const auto found = std::ranges::find(all, dataset.path, &DatasetFacts::path);
        if (found == all.end()) all.insert(all.begin() + std::ptrdiff_t(after), facts_of(dataset, when));
        after = std::size_t(std::ranges::find(all, dataset.path, &DatasetFacts::path) - all.begin()) + 1;
      }
  };
  for (const Feature& feature : kFeatures) {
    Result result = answered();
    feature.add(result);
    add(result, feature.when);
  }
  Result alone;
  for (const Product& product : products()) {
    Result result = product.place == Product::Place::alone ? Result() : answered();
    product.sample(result);
    add(result, product.when);
    if (product.place == Product::Place::alone) alone = std::move(result);
  }
  // What takes more than "always" although no feature adds it: a scene, which what stands alone has not.
  std::vector<std::string> in_alone;
  for (const Group& group : layout(alone))
    for (const Dataset& dataset : group.datasets) in_alone.push_back(dataset.path);
  Result unanswered = small();
  std::vector<std::string> in_unanswered;
  for (const Group& group : layout(unanswered))
    for (const Dataset& dataset : group.datasets) in_unanswered.push_back(dataset.path);
  for (DatasetFacts& facts : all) {
    if (facts.when != std::string("always")) continue;
    const bool of_alone = std::ranges::find(in_alone, facts.path) != in_alone.end();
    const bool of_motion = std::ranges::find(in_unanswered, facts.path) != in_unanswered.end();
    facts.when = of_alone ? "always" : of_motion ? "a scene" : "a scene with algorithms";
  }
  // Group by group, those of a group as they came.
  std::vector<std::string> groups;
  for (const DatasetFacts& facts : all) groups.push_back(facts.path.substr(0, facts.path.rfind('/')));
  std::ranges::stable_sort(all, {}, [&](const DatasetFacts& facts) {
    return std::ranges::find(groups, facts.path.substr(0, facts.path.rfind('/'))) - groups.begin();
  });
  return all;
}

}  // namespace pipeline
