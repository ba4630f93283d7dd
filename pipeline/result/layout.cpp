// The file's contents as pipeline/FILE.md lists them, group by group.
#include "pipeline/result/layout.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "pipeline/result/attributes.hpp"
#include "pipeline/result/product.hpp"

namespace pipeline {
namespace {

void add_texts(Group& group, const auto& texts, const auto& row) {
  for (const auto& [name, member, kind] : texts)
    if (kind != Text::optional || !(row.*member).empty()) group.attributes.push_back({name, row.*member});
}

Dataset config(const Result& result) {
  Dataset out = texts("/config", {result.config_text}, {}, "the configuration as read, TOML");
  out.attributes.push_back({"effective", result.config_effective});
  return out;
}

Group root(const Result& result, const Sizes& n) {
  Group group{"/", {{"schema_version", std::int64_t{kSchemaVersion}}, {"title", result.title}}, {}, true};
  add_texts(group, kOriginTexts, result.provenance);
  auto& datasets = group.datasets;
  if (stands_alone(result)) {
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

/// A dataset of some reals of every pose, as `put` copies them out of it. The motion is most of a large result and is
/// not laid out a second time.
Dataset of_poses(const Result& result, std::string path, const std::vector<Dimension>& dims, std::string units,
                 std::string long_name, void (*put)(const geometry::Pose& pose, double* to)) {
  Dataset dataset = described(std::move(path), Type::f64, dims, std::move(units), std::move(long_name));
  const std::size_t size = dims.back().size;
  dataset.rows = [&result, size, put](std::uint64_t first, std::uint64_t last) {
    const std::size_t bodies = result.bodies.size();
    std::vector<std::byte> bytes((last - first) * bodies * size * sizeof(double));
    auto* to = reinterpret_cast<double*>(bytes.data());
    for (std::uint64_t step = first; step < last; ++step) {
      assert(result.motion[step].size() == bodies && "a pose for every body at every step");
      for (const geometry::Pose& pose : result.motion[step]) put(pose, std::exchange(to, to + size));
    }
    return bytes;
  };
  return dataset;
}

Group motion(const Result& result, const Sizes& n) {
  Group group{"/motion", {}, {}, true};
  group.datasets.push_back(of_poses(result, "/motion/position", {n.step, n.body, n.axis}, "m",
                                    "positions of the bodies' frames; NaN: not born, or the integration failed",
                                    [](const geometry::Pose& pose, double* to) { std::copy_n(pose.t.data(), 3, to); }));
  group.datasets.push_back(of_poses(result, "/motion/orientation", {n.step, n.body, n.component}, "1",
                                    "unit quaternions, scalar first; NaN: not born, or the integration failed",
                                    [](const geometry::Pose& pose, double* to) {
                                      std::ranges::copy(std::array{pose.q.w, pose.q.x, pose.q.y, pose.q.z}, to);
                                    }));
  return group;
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
  Group group{"/answers/" + answers.label, {}, {}, true};
  add_texts(group, kAnswerTexts, answers);
  add_texts(group, kMachineTexts, answers.machine);
  if (const auto& foreign = answers.foreign) {
    add_texts(group, kForeignTexts, *foreign);
    group.attributes.push_back({"threads", foreign->threads});
    group.attributes.push_back({"status", std::string(failed(answers) ? "failed" : "complete")});
    group.attributes.push_back({"steps_done", foreign->steps_done});
  }
  if (answers.machine.pinned >= 0) group.attributes.push_back({"pinned", answers.machine.pinned});
  for (const auto& [name, cost, column] : kCosts)
    if (const double value = answers.costs.*cost; !std::isnan(value))
      group.attributes.push_back({name, static_cast<std::int64_t>(value)});
  add_pairs(group, answers.hits, "pairs of bodies that the algorithm reported", n);
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

Group run(const Provenance& from) {
  Group group{"/run", {}, {}};
  add_texts(group, kRunTexts, from);
  group.attributes.push_back({"wall_time_s", from.wall_time_s});
  return group;
}

}  // namespace

std::vector<Group> layout(const Result& result) {
  const Sizes n(result);
  std::vector<Group> groups;
  const auto add_products = [&](Product::Place place) {
    for (const Product& product : products())
      if (product.place == place && product.has(result)) product.lay(result, n, groups);
  };
  groups.push_back(root(result, n));
  if (stands_alone(result)) {
    add_products(Product::Place::alone);
    groups.push_back(run(result.provenance));
    return groups;
  }
  groups.push_back(bodies(result, n));
  const std::vector<double>& within = result.truth.closed_within;
  for (std::size_t i = 0; i < result.bodies.meshes.size(); ++i)
    groups.push_back(mesh(result.bodies.meshes[i], within.empty() ? std::nullopt : std::optional(within[i])));
  groups.push_back(motion(result, n));
  add_products(Product::Place::after_motion);
  groups.push_back(truth(result.truth, result.bodies.closed_within, n));
  add_products(Product::Place::in_truth);
  if (!result.answers.empty()) {
    groups.push_back(results(result, n));
    for (const Answers& one : result.answers) groups.push_back(answers(one, n));
    groups.push_back(summary(result, n));
  }
  add_products(Product::Place::at_end);
  groups.push_back(run(result.provenance));
  return groups;
}

}  // namespace pipeline
