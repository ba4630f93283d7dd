// The file's contents as pipeline/FILE.md lists them, group by group.
#include "pipeline/result/layout.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <concepts>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "pipeline/result/store.hpp"

namespace pipeline {
namespace {

static_assert(std::endian::native == std::endian::little, "values are stored as they lie in memory");
static_assert(sizeof(Pair) == 8 && sizeof(geometry::Facet) == 12 && sizeof(geometry::Vec3) == 24,
              "pairs, facets and vertices are stored as they lie in memory");

/// A dimension: its size and the path of its scale.
struct Dimension {
  std::string scale;
  std::uint64_t size;
};

Dataset described(std::string path, Type type, const std::vector<Dimension>& dims, std::string units,
                  std::string long_name) {
  Dataset dataset;
  dataset.path = std::move(path);
  dataset.type = type;
  for (const Dimension& dim : dims) {
    dataset.shape.push_back(dim.size);
    dataset.dims.push_back(dim.scale);
  }
  dataset.units = std::move(units);
  dataset.long_name = std::move(long_name);
  return dataset;
}

/// A dataset of what lies in memory elsewhere, row by row.
template <typename T>
Dataset viewed(std::string path, std::span<const T> values, const std::vector<Dimension>& dims, std::string units,
               std::string long_name, Type type = type_of<T>()) {
  Dataset dataset = described(std::move(path), type, dims, std::move(units), std::move(long_name));
  dataset.bytes = std::as_bytes(values);
  assert(dataset.bytes.size() == dataset.elements() * size_of(type) && "values fill the shape");
  return dataset;
}

/// A dataset of values made here.
template <typename T>
Dataset owning(std::string path, const std::vector<T>& values, const std::vector<Dimension>& dims, std::string units,
               std::string long_name) {
  Dataset dataset = described(std::move(path), type_of<T>(), dims, std::move(units), std::move(long_name));
  const auto bytes = std::as_bytes(std::span(values));
  dataset.owned.assign(bytes.begin(), bytes.end());
  dataset.bytes = dataset.owned;
  assert(dataset.bytes.size() == dataset.elements() * size_of(dataset.type) && "values fill the shape");
  return dataset;
}

Dataset texts(std::string path, std::vector<std::string> values, const std::vector<Dimension>& dims,
              std::string long_name) {
  Dataset dataset = described(std::move(path), Type::text, dims, "1", std::move(long_name));
  dataset.text = std::move(values);
  assert(dataset.text.size() == dataset.elements() && "texts fill the shape");
  return dataset;
}

/// What stands for a value that a row does not have.
template <typename T>
constexpr T kAbsent{};
template <>
constexpr double kAbsent<double> = std::numeric_limits<double>::quiet_NaN();

/// A column of rows.
template <typename Row, typename T, typename Stored>
Dataset of_rows(const std::string& group, const Column<Row, T, Stored>& column, const std::vector<Row>& rows,
                const Dimension& row) {
  std::vector<Stored> values;
  for (const Row& one : rows) {
    if constexpr (is_optional<T>)
      values.push_back(static_cast<Stored>((one.*column.member).value_or(kAbsent<Stored>)));
    else
      values.push_back(static_cast<Stored>(one.*column.member));
  }
  const std::string path = group + "/" + column.name;
  if constexpr (std::same_as<Stored, std::string>)
    return texts(path, std::move(values), {row}, column.long_name);
  else
    return owning(path, values, {row}, column.units, column.long_name);
}

/// Whether the file has the column: not an optional one of which nobody has values.
template <typename Row, typename T, typename Stored>
bool is_there(const Column<Row, T, Stored>& column, const std::vector<Row>& rows) {
  if constexpr (is_optional<T>)
    return std::ranges::any_of(rows, [&](const Row& row) { return (row.*column.member).has_value(); });
  else if constexpr (std::ranges::range<T> && !std::same_as<T, std::string>)
    return !column.optional || std::ranges::any_of(rows, [&](const Row& row) { return !(row.*column.member).empty(); });
  else
    return true;
}

/// A table of rows x algorithms from a column of every algorithm's answers.
template <typename Answer, typename T>
Dataset of_answers(const std::string& group, const Column<Answer, std::vector<T>>& column,
                   const std::vector<Answer>& answers, const Dimension& row, const Dimension& algorithm) {
  std::vector<T> table(row.size * answers.size());
  for (std::size_t a = 0; a < answers.size(); ++a) {
    const std::vector<T>& values = answers[a].*column.member;
    if (column.optional && values.empty()) continue;
    assert(values.size() == row.size && "a value for every row");
    for (std::size_t r = 0; r < row.size; ++r) table[r * answers.size() + a] = values[r];
  }
  return owning(group + "/" + column.name, table, {row, algorithm}, column.units, column.long_name);
}

Dataset scale(Dataset dataset, bool grows = false) {
  dataset.scale = Scale::values;
  dataset.grows = grows;
  return dataset;
}

Dataset bare_scale(const Dimension& dim, std::string long_name, bool grows = false) {
  Dataset dataset = described(dim.scale, Type::i64, {dim}, "1", std::move(long_name) + " (a dimension without values)");
  dataset.scale = Scale::bare;
  dataset.grows = grows;
  return dataset;
}

/// Sizes that the groups share.
struct Sizes {
  explicit Sizes(const Result& result)
      : step{"/step", result.steps()},
        boundary{"/boundary", result.steps() + 1},
        body{"/body", result.bodies.size()},
        algorithm{"/algorithm", result.answers.size()} {}

  Dimension step, boundary, body, algorithm;
  Dimension axis{"/axis", 3}, component{"/component", 4}, side{"/side", 2};
};

Dataset config(const Result& result) {
  Dataset out = texts("/config", {result.config_text}, {}, "the configuration as read, TOML");
  out.attributes.push_back({"effective", result.config_effective});
  return out;
}

Group root(const Result& result, const Sizes& n) {
  const Provenance& from = result.provenance;
  Group group{"/",
              {{"schema_version", std::int64_t{kSchemaVersion}},
               {"title", result.title},
               {"creator", from.creator},
               {"git_commit", from.git_commit},
               {"build_type", from.build_type},
               {"compiler", from.compiler},
               {"flags", from.flags},
               {"library_versions", from.library_versions},
               {"config_sha256", from.config_sha256},
               {"inputs_sha256", from.inputs_sha256}},
              {},
              true};
  auto& datasets = group.datasets;
  if (result.study) {
    datasets.push_back(config(result));
    return group;
  }
  std::vector<std::int64_t> step(result.steps());
  std::iota(step.begin(), step.end(), 0);
  std::vector<double> time(result.steps());
  for (std::size_t s = 0; s < time.size(); ++s) time[s] = static_cast<double>(s) / result.rate;
  std::vector<std::string> labels;
  for (const Answers& answers : result.answers) labels.push_back(answers.label);

  datasets.push_back(scale(owning("/step", step, {n.step}, "1", "samples of time, from 0"), true));
  datasets.push_back(scale(texts("/body", result.bodies.name, {n.body}, "names of the bodies")));
  if (!labels.empty())
    datasets.push_back(scale(texts("/algorithm", std::move(labels), {n.algorithm}, "labels of the algorithms")));
  datasets.push_back(bare_scale(n.boundary, "first entries of the steps, and the end", true));
  datasets.push_back(scale(texts("/side", {"a", "b"}, {n.side}, "bodies of a pair, a < b")));
  datasets.push_back(scale(texts("/axis", {"x", "y", "z"}, {n.axis}, "coordinates")));
  datasets.push_back(scale(texts("/component", {"w", "x", "y", "z"}, {n.component}, "parts of a quaternion")));

  datasets.push_back(owning("/time", time, {n.step}, "s", "time of the step"));
  datasets.back().attributes.push_back({"rate", result.rate});
  datasets.push_back(config(result));
  return group;
}

Group bodies(const Result& result, const Sizes& n) {
  const geometry::Bodies& all = result.bodies;
  Group group{"/bodies", {}, {}};
  std::vector<std::string> mesh;
  for (std::uint32_t body = 0; body < all.size(); ++body) mesh.push_back(all.mesh_of(body).name);
  group.datasets.push_back(texts("/bodies/mesh", std::move(mesh), {n.body}, "name of the body's mesh in /meshes"));
  group.datasets.push_back(viewed("/bodies/fixed", std::span(all.fixed), {n.body}, "1", "1 when the body never moves"));
  group.datasets.push_back(viewed("/bodies/first_step", std::span(result.first_step), {n.body}, "1",
                                  "step at which the body is born; -1: never"));
  std::vector<std::uint64_t> born;
  for (const auto& poses : result.motion)
    born.push_back(static_cast<std::uint64_t>(std::ranges::count_if(poses, geometry::is_born)));
  group.datasets.push_back(owning("/bodies/born", born, {n.step}, "1", "bodies that are there, fixed ones included"));
  if (!all.chosen.empty())
    group.datasets.push_back(viewed("/bodies/chosen", std::span(all.chosen), {n.body}, "1",
                                    "only pairs with a body that has 1 here were asked about"));
  return group;
}

/// `closed_within` as in Truth, where it is known.
Group mesh(const geometry::Mesh& mesh, std::optional<double> closed_within) {
  const std::string path = "/meshes/" + mesh.name;
  const Dimension vertex{path + "/vertex", mesh.vertices.size()};
  const Dimension triangle{path + "/triangle", mesh.triangles.size()};
  const Dimension corner{path + "/corner", 3};
  // Not the root's: a scale can serve about 4000 datasets (its list of them is an attribute of at most 64 KiB), and
  // there may be as many meshes as bodies.
  const Dimension axis{path + "/axis", 3};
  Group group{path,
              {{"shape", mesh.shape},
               {"closed", std::uint8_t{geometry::is_closed(mesh)}},
               {"surface_deviation", mesh.surface_deviation}},
              {}};
  if (closed_within) group.attributes.push_back({"closed_within", *closed_within});
  if (!mesh.contact_spheres.empty()) group.attributes.push_back({"contact_deviation", mesh.contact_deviation});
  auto& datasets = group.datasets;
  datasets.push_back(bare_scale(vertex, "vertices of the mesh"));
  datasets.push_back(bare_scale(triangle, "triangles of the mesh"));
  datasets.push_back(bare_scale(corner, "corners of a triangle"));
  datasets.push_back(scale(texts(axis.scale, {"x", "y", "z"}, {axis}, "coordinates")));
  datasets.push_back(viewed(path + "/vertices", std::span(mesh.vertices), {vertex, axis}, "m",
                            "vertices in the mesh's own frame", Type::f64));
  datasets.push_back(viewed(path + "/triangles", std::span(mesh.triangles), {triangle, corner}, "1",
                            "vertices of the triangles, counter-clockwise seen from outside", Type::u32));
  if (mesh.contact_spheres.empty()) return group;
  const Dimension sphere{path + "/sphere", mesh.contact_spheres.size()};
  const Dimension part{path + "/part", 4};
  datasets.push_back(bare_scale(sphere, "contact spheres of the mesh"));
  datasets.push_back(scale(texts(part.scale, {"x", "y", "z", "radius"}, {part}, "centre and radius of a sphere")));
  std::vector<double> spheres;
  for (const geometry::ContactBall& ball : mesh.contact_spheres)
    spheres.insert(spheres.end(), {ball.centre.x(), ball.centre.y(), ball.centre.z(), ball.radius});
  datasets.push_back(owning(path + "/contact_spheres", spheres, {sphere, part}, "m",
                            "spheres inside the mesh by which its bodies touched others"));
  return group;
}

Group motion(const Result& result, const Sizes& n) {
  std::vector<double> position, orientation;
  position.reserve(n.step.size * n.body.size * 3);
  orientation.reserve(n.step.size * n.body.size * 4);
  for (const auto& poses : result.motion) {
    assert(poses.size() == n.body.size && "a pose for every body at every step");
    for (const geometry::Pose& pose : poses) {
      position.insert(position.end(), {pose.t.x(), pose.t.y(), pose.t.z()});
      orientation.insert(orientation.end(), {pose.q.w, pose.q.x, pose.q.y, pose.q.z});
    }
  }
  Group group{"/motion", {}, {}, true};
  group.datasets.push_back(owning("/motion/position", position, {n.step, n.body, n.axis}, "m",
                                  "positions of the bodies' frames; NaN: not born, or the integration failed"));
  group.datasets.push_back(owning("/motion/orientation", orientation, {n.step, n.body, n.component}, "1",
                                  "unit quaternions, scalar first; NaN: not born, or the integration failed"));
  return group;
}

Group physics(const PhysicsRows& physics, const Sizes& n) {
  Group group{"/physics", {{"status", physics.status}}, {}};
  if (!std::isnan(physics.quaternion_drift)) group.attributes.push_back({"quaternion_drift", physics.quaternion_drift});
  assert(physics.rows.size() == n.step.size && "a row for every step");
  const auto add = [&](const auto& columns) {
    for (const auto& column : columns) group.datasets.push_back(of_rows("/physics", column, physics.rows, n.step));
  };
  add(kPhysicsReals);
  add(kPhysicsCounts);
  add(kPhysicsTimes);
  return group;
}

/// The datasets of lists of pairs, with the scale of the ragged dimension.
void add_pairs(Group& group, const PairLists& hits, const std::string& what, const Sizes& n,
               const std::string& prefix = "") {
  const Dimension entry{group.path + "/" + prefix + "entry", hits.pair.size()};
  const std::string offset = prefix.empty() ? "pair_offset" : prefix + "offset";
  group.datasets.push_back(bare_scale(entry, "pairs of all steps, one step after another", true));
  group.datasets.push_back(viewed(group.path + "/" + offset, std::span(hits.offset), {n.boundary}, "1",
                                  "the pairs of step s are entries " + offset + "[s] to " + offset + "[s + 1] - 1"));
  group.datasets.push_back(
      viewed(group.path + "/" + prefix + "pair", std::span(hits.pair), {entry, n.side}, "1", what, Type::u32));
}

Group truth(const Truth& truth, double closed_within, const Sizes& n) {
  Group group{"/truth", {}, {}, true};
  std::vector<std::uint64_t> scoring;
  for (std::size_t s = 0; s < truth.hits.steps(); ++s)
    scoring.push_back(truth.hits.at(s).size() +
                      (truth.containment == Containment::meet ? truth.contained.at(s).size() : 0));
  group.datasets.push_back(
      owning("/truth/hits", scoring, {n.step}, "1", "pairs that meet, by which answers are scored"));
  group.datasets.push_back(
      viewed("/truth/time_ns", std::span(truth.time_ns), {n.step}, "ns", "time of the exact answer"));
  add_pairs(group, truth.hits, "pairs of bodies whose surfaces meet", n);
  if (truth.lists_contained()) {
    group.attributes.push_back({"containment", std::string(text_of(truth.containment))});
    group.attributes.push_back({"closed_within", closed_within});
    add_pairs(group, truth.contained, "pairs of bodies of which one lies wholly inside the other", n, "contained_");
    if (truth.contained_inside) {
      const Dimension entry{"/truth/contained_entry", truth.contained.pair.size()};
      group.datasets.push_back(viewed("/truth/contained_inside", std::span(*truth.contained_inside), {entry}, "1",
                                      "the body of the pair that lies inside the other", Type::u32));
    }
  }
  if (truth.gaps) {
    const GapLists& gaps = *truth.gaps;
    group.attributes.push_back({"gap_margin", gaps.margin});
    add_pairs(group, gaps.pairs, "pairs of bodies that do not meet and are within gap_margin", n, "gap_");
    const Dimension entry{"/truth/gap_entry", gaps.pairs.pair.size()};
    for (const auto& column : kGapReals)
      group.datasets.push_back(viewed(std::string("/truth/") + column.name, std::span(gaps.*column.member), {entry},
                                      column.units, column.long_name));
  }
  return group;
}

Group results(const Result& result, const Sizes& n) {
  Group group{"/results", {}, {}};
  const auto add = [&](const auto& column) {
    if (is_there(column, result.answers))
      group.datasets.push_back(of_answers("/results", column, result.answers, n.step, n.algorithm));
  };
  each_answer_time(add);
  std::vector<std::uint64_t> hits;
  for (std::size_t s = 0; s < n.step.size; ++s)
    for (const Answers& one : result.answers) hits.push_back(one.hits.at(s).size());
  group.datasets.push_back(owning("/results/hits", hits, {n.step, n.algorithm}, "1", "pairs reported"));
  each_answer_count(add);
  return group;
}

Group answers(const Answers& answers, const Sizes& n) {
  Group group{"/answers/" + answers.label,
              {{"name", answers.name},
               {"knobs", answers.knobs},
               {"promise", answers.promise},
               {"thesis_key", answers.thesis_key},
               {"operations_unit", answers.operations_unit},
               {"scope", answers.scope},
               {"host", answers.machine.host},
               {"processor", answers.machine.processor},
               {"build", answers.machine.build},
               {"date", answers.machine.date}},
              {},
              true};
  if (!answers.library.empty()) group.attributes.push_back({"library", answers.library});
  if (const auto& foreign = answers.foreign)
    group.attributes.insert(group.attributes.end(), {{"transport", foreign->transport},
                                                     {"command", foreign->command},
                                                     {"files_sha256", foreign->files},
                                                     {"version", foreign->version},
                                                     {"language", foreign->language},
                                                     {"precision", foreign->precision},
                                                     {"threads", foreign->threads},
                                                     {"status", std::string(failed(answers) ? "failed" : "complete")},
                                                     {"reason", foreign->reason},
                                                     {"steps_done", foreign->steps_done}});
  if (answers.machine.pinned >= 0) group.attributes.push_back({"pinned", answers.machine.pinned});
  const auto cost = [&](const char* name, double value) {
    if (!std::isnan(value)) group.attributes.push_back({name, static_cast<std::int64_t>(value)});
  };
  cost("setup_ns", answers.costs.setup_ns);
  cost("memory_bytes", answers.costs.memory_bytes);
  cost("memory_greatest_bytes", answers.costs.memory_greatest_bytes);
  add_pairs(group, answers.hits, "pairs of bodies that the algorithm reported", n);
  return group;
}

Group noise(const Noise& noise, const Sizes& n) {
  Group group{"/noise",
              {{"label", noise.label}, {"ratio", noise.ratio}, {"ratio_low", noise.low}, {"ratio_high", noise.high}},
              {}};
  group.datasets.push_back(viewed("/noise/time_ns", std::span(noise.time_ns), {n.step}, "ns",
                                  "fastest repeat of the step of the label, timed a second time"));
  return group;
}

Group summary(const Result& result, const Sizes& n) {
  Group group{"/summary", {}, {}};
  assert(result.summary.size() == n.algorithm.size && "a row for every algorithm");
  each_summary_column([&](const auto& column) {
    if (is_there(column, result.summary))
      group.datasets.push_back(of_rows("/summary", column, result.summary, n.algorithm));
  });
  return group;
}

Group passes(const Passes& passes, const Sizes& n) {
  const Dimension pass{"/passes/pass", passes.rows.size()};
  Group group{"/passes", {}, {}};
  auto& datasets = group.datasets;
  datasets.push_back(bare_scale(pass, "straight passes of the hero through an obstacle"));
  const auto add_rows = [&](const auto& columns) {
    for (const auto& column : columns) datasets.push_back(of_rows("/passes", column, passes.rows, pass));
  };
  const auto add_table = [&](const auto& columns) {
    for (const auto& column : columns)
      datasets.push_back(of_answers("/passes", column, passes.answers, pass, n.algorithm));
  };
  add_rows(kPassTexts);
  add_rows(kPassCounts);
  add_rows(kPassReals);
  if (passes.answers.empty()) return group;
  add_table(kPassAnswerReals);
  add_table(kPassAnswerCounts);
  return group;
}

Group extremes(const Extremes& extremes, const Sizes& n) {
  Group group{"/extremes", {}, {}};
  auto& datasets = group.datasets;
  assert(extremes.rows.size() == n.step.size && "a row for every step");
  const auto add = [&](const auto& columns) {
    for (const auto& column : columns) datasets.push_back(of_rows("/extremes", column, extremes.rows, n.step));
  };
  add(kCaseTexts);
  add(kCaseReals);
  add(kCaseIntegers);
  add(kCaseCounts);
  add(kCaseFlags);
  if (extremes.answers.empty()) return group;
  each_case_answer_column([&](const auto& column) {
    datasets.push_back(of_answers("/extremes", column, extremes.answers, n.step, n.algorithm));
  });
  datasets.push_back(of_rows("/extremes", kCaseReason, extremes.answers, n.algorithm));
  return group;
}

Group study(const std::vector<StudyRow>& rows) {
  const Dimension cases{"/study/case", rows.size()};
  Group group{"/study", {}, {}};
  auto& datasets = group.datasets;
  std::vector<std::int64_t> number(rows.size());
  std::iota(number.begin(), number.end(), 0);
  datasets.push_back(scale(owning(cases.scale, number, {cases}, "1", "number of the case, from 0")));
  each_study_column([&](const auto& column) { datasets.push_back(of_rows("/study", column, rows, cases)); });
  return group;
}

Group run(const Provenance& from) {
  return {"/run",
          {{"date", from.date}, {"host", from.host}, {"processor", from.processor}, {"wall_time_s", from.wall_time_s}},
          {}};
}

}  // namespace

std::size_t size_of(Type type) {
  switch (type) {
    case Type::f64:
    case Type::i64:
    case Type::u64:
      return 8;
    case Type::u32:
      return 4;
    case Type::u8:
      return 1;
    case Type::text:
      return 0;
  }
  return 0;
}

std::uint64_t Dataset::elements() const {
  return std::accumulate(shape.begin(), shape.end(), std::uint64_t{1}, std::multiplies<>());
}

std::string_view base_name(std::string_view path) { return path.substr(path.rfind('/') + 1); }

std::vector<Group> layout(const Result& result) {
  const Sizes n(result);
  std::vector<Group> groups;
  groups.push_back(root(result, n));
  if (result.study) {
    groups.push_back(study(*result.study));
    groups.push_back(run(result.provenance));
    return groups;
  }
  groups.push_back(bodies(result, n));
  const std::vector<double>& within = result.truth.closed_within;
  for (std::size_t i = 0; i < result.bodies.meshes.size(); ++i)
    groups.push_back(mesh(result.bodies.meshes[i], within.empty() ? std::nullopt : std::optional(within[i])));
  groups.push_back(motion(result, n));
  if (result.physics) groups.push_back(physics(*result.physics, n));
  groups.push_back(truth(result.truth, result.bodies.closed_within, n));
  if (!result.answers.empty()) {
    groups.push_back(results(result, n));
    for (const Answers& one : result.answers) groups.push_back(answers(one, n));
    groups.push_back(summary(result, n));
  }
  if (result.noise) groups.push_back(noise(*result.noise, n));
  if (result.passes) groups.push_back(passes(*result.passes, n));
  if (result.extremes) groups.push_back(extremes(*result.extremes, n));
  groups.push_back(run(result.provenance));
  return groups;
}

}  // namespace pipeline
