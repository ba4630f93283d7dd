#include "pipeline/result/products/proxies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/result/dataset.hpp"
#include "pipeline/result/hdf5/reader.hpp"
#include "pipeline/result/products/all.hpp"
#include "pipeline/terminal/print.hpp"

namespace pipeline {
namespace {

inline constexpr Column<MeshProxy, std::string> kTexts[] = {
    {"label", &MeshProxy::label, "1", "label of the algorithm"},
    {"mesh", &MeshProxy::mesh, "1", "mesh in place of which it is tested"},
    {"kind", &MeshProxy::kind, "1", "balls, capsule, solids, or none"},
    {"reason", &MeshProxy::reason, "1", "why there is none"}};
inline constexpr Column<MeshProxy, std::uint64_t> kCounts[] = {
    {"parts", &MeshProxy::parts, "1", "balls, or closed surfaces"}};
inline constexpr Column<MeshProxy, double> kReals[] = {
    {"outside_share", &MeshProxy::outside_share, "1", "vertices of the mesh outside the proxy, of all"},
    {"outside_greatest", &MeshProxy::outside_greatest, "m",
     "no vertex of the mesh is farther outside the proxy, certified; 0: none is outside"}};

template <typename Each>
void each_column(const Each& each) {
  for (const auto& column : kTexts) each(column);
  for (const auto& column : kCounts) each(column);
  for (const auto& column : kReals) each(column);
}

std::string path_of(const MeshProxy& row) { return "/meshes/" + row.mesh + "/proxies/" + row.label; }

Group shape(const MeshProxy& row) {
  const std::string path = path_of(row);
  Group group{
      path, {{"kind", row.kind}, {"outside_share", row.outside_share}, {"outside_greatest", row.outside_greatest}}, {}};
  auto& datasets = group.datasets;
  if (!row.balls.empty()) {
    const Dimension ball{path + "/ball", row.balls.size()}, part{path + "/part", 4};
    std::vector<double> balls;
    for (const geometry::ContactBall& one : row.balls)
      balls.insert(balls.end(), {one.centre.x(), one.centre.y(), one.centre.z(), one.radius});
    datasets.push_back(bare_scale(ball, "balls of the proxy"));
    datasets.push_back(scale(texts(part.scale, {"x", "y", "z", "radius"}, {part}, "centre and radius of a ball")));
    datasets.push_back(
        owning(path + "/balls", balls, {ball, part}, "m", "balls in the mesh's own frame; of a capsule its two ends"));
  }
  if (row.vertices.empty()) return group;
  const Dimension vertex{path + "/vertex", row.vertices.size()}, triangle{path + "/triangle", row.triangles.size()},
      corner{path + "/corner", 3}, axis{path + "/axis", 3}, boundary{path + "/solid_boundary", row.solid_offset.size()};
  datasets.push_back(bare_scale(vertex, "vertices of the solids"));
  datasets.push_back(bare_scale(triangle, "triangles of the solids"));
  datasets.push_back(bare_scale(corner, "corners of a triangle"));
  datasets.push_back(scale(texts(axis.scale, {"x", "y", "z"}, {axis}, "coordinates")));
  datasets.push_back(bare_scale(boundary, "first triangles of the solids, and the end"));
  datasets.push_back(viewed(path + "/vertices", std::span(row.vertices), {vertex, axis}, "m",
                            "vertices in the mesh's own frame", Type::f64));
  datasets.push_back(viewed(path + "/triangles", std::span(row.triangles), {triangle, corner}, "1",
                            "vertices of the triangles, counter-clockwise seen from outside", Type::u32));
  datasets.push_back(viewed(path + "/solid_offset", std::span(row.solid_offset), {boundary}, "1",
                            "solid i has the triangles solid_offset[i] to solid_offset[i + 1] - 1", Type::offset));
  return group;
}

void lay(const Result& result, const Sizes&, std::vector<Group>& groups) {
  const std::vector<MeshProxy>& rows = result.products.find<Proxies>()->rows;
  const Dimension row{"/proxies/proxy", rows.size()};
  Group group{"/proxies", {}, {}};
  group.datasets.push_back(bare_scale(row, "labels that test something in place of a mesh, and each mesh"));
  each_column([&](const auto& column) { group.datasets.push_back(of_rows(group.path, column, rows, row)); });
  groups.push_back(std::move(group));
  for (const MeshProxy& one : rows)
    if (one.kind != "none") groups.push_back(shape(one));
}

void read_shape(const Reader& from, MeshProxy& row) {
  const std::string path = path_of(row);
  const auto attribute = [&](const char* name, double value) {
    if (from.attribute<double>(path, name) != value)
      throw h5::Failure(path + ": its " + name + " is not that of /proxies");
  };
  if (from.attribute<std::string>(path, "kind") != row.kind)
    throw h5::Failure(path + ": its kind is not that of /proxies");
  attribute("outside_share", row.outside_share);
  attribute("outside_greatest", row.outside_greatest);
  if (from.has(path + "/balls"))
    for (const auto& [x, y, z, radius] : from.values<std::array<double, 4>>(path + "/balls", Type::f64, {kAny, 4}))
      row.balls.push_back({{x, y, z}, radius});
  if (row.kind == "capsule" ? row.balls.size() != 2 : row.kind == "balls" && row.balls.empty())
    throw h5::Failure(path + "/balls: not as many as its kind has");
  if (row.kind != "solids") return;
  row.vertices = from.values<geometry::Vec3>(path + "/vertices", Type::f64, {kAny, 3});
  row.triangles = from.values<geometry::Facet>(path + "/triangles", Type::u32, {kAny, 3});
  row.solid_offset = from.values<std::uint64_t>(path + "/solid_offset", Type::offset, {kAny});
  for (const geometry::Facet& facet : row.triangles)
    if (std::ranges::any_of(facet, [&](std::uint32_t corner) { return corner >= row.vertices.size(); }))
      throw h5::Failure(path + ": a triangle has no such vertex");
  const auto& offset = row.solid_offset;
  if (offset.size() < 2 || offset.front() != 0 || offset.back() != row.triangles.size() ||
      !std::ranges::is_sorted(offset))
    throw h5::Failure(path + "/solid_offset: is not in order");
}

void read(const Reader& from, Result& result) {
  Proxies proxies;
  proxies.rows.resize(from.texts("/proxies/label", {kAny}).size());
  each_column([&](const auto& column) { from.rows("/proxies", column, proxies.rows); });
  for (MeshProxy& row : proxies.rows) {
    if (std::ranges::find(result.answers, row.label, &Answers::label) == result.answers.end() ||
        std::ranges::find(result.bodies.meshes, row.mesh, &geometry::Mesh::name) == result.bodies.meshes.end())
      throw h5::Failure("/proxies: names a label or a mesh that is not there");
    constexpr std::array<std::string_view, 4> kKinds = {"none", "balls", "capsule", "solids"};
    if (std::ranges::find(kKinds, row.kind) == kKinds.end()) throw h5::Failure("/proxies: its kind is not known");
    if (row.kind != "none") read_shape(from, row);
  }
  result.products.put(std::move(proxies));
}

/// One line a label: what it takes for meshes, and whether that wraps them.
std::string text(const Result& result) {
  const std::vector<MeshProxy>& all = result.products.find<Proxies>()->rows;
  std::vector<std::vector<std::string>> lines = {
      {"in place of meshes", "meshes", "what", "vertices outside", "at most"}};
  std::string reasons;
  for (const Answers& answers : result.answers) {
    std::size_t meshes = 0, out = 0;
    std::uint64_t least = 0, most = 0;
    const MeshProxy* worst = nullptr;
    std::string kind;
    for (const MeshProxy& row : all) {
      if (row.label != answers.label) continue;
      if (row.kind == "none") {
        reasons += row.label + ": nothing in place of mesh " + row.mesh + ": " + row.reason + "\n";
        continue;
      }
      least = meshes ? std::min(least, row.parts) : row.parts;
      most = std::max(most, row.parts);
      ++meshes;
      kind = row.kind;
      out += row.outside_share > 0;
      if (!worst || row.outside_greatest > worst->outside_greatest) worst = &row;
    }
    if (!worst) continue;
    const std::string parts = least == most ? print("%llu ", static_cast<unsigned long long>(most))
                                            : print("%llu to %llu ", static_cast<unsigned long long>(least),
                                                    static_cast<unsigned long long>(most));
    lines.push_back(
        {answers.label, std::to_string(meshes), kind == "capsule" ? "a capsule" : parts + kind,
         out ? print("of %zu meshes; %.3g %% of %s", out, 100 * worst->outside_share, worst->mesh.c_str()) : "none",
         out ? print("%.3g m (%s)", worst->outside_greatest, worst->mesh.c_str()) : "-"});
  }
  return (lines.size() > 1 ? aligned(lines) + "\n" : "") + (reasons.empty() ? "" : reasons + "\n");
}

void json(const Result& result, OrderedJson& out) {
  const Proxies* found = result.products.find<Proxies>();
  if (!found) return;
  OrderedJson& json = out["proxies"] = OrderedJson::array();
  for (const MeshProxy& row : found->rows) {
    json.push_back({{"label", row.label}, {"mesh", row.mesh}, {"kind", row.kind}, {"parts", row.parts}});
    if (row.kind == "none") {
      json.back()["reason"] = row.reason;
    } else {
      json.back()["outside_share"] = row.outside_share;
      json.back()["outside_greatest"] = row.outside_greatest;
    }
  }
}

}  // namespace

Product proxies_product() {
  return {.name = "proxies",
          .place = Product::Place::at_end,
          .sign = "/proxies",
          .has = [](const Result& result) { return result.products.find<Proxies>() != nullptr; },
          .lay = lay,
          .read = read,
          .when = "a method tests something in place of meshes",
          .sample =
              [](Result& result) {
                MeshProxy row;
                row.label = result.answers[0].label;
                row.mesh = result.bodies.meshes[0].name;
                row.kind = "solids";
                row.balls.resize(1);
                row.vertices.resize(3);
                row.triangles = {{0, 1, 2}};
                row.solid_offset = {0, 1};
                result.products.put(Proxies{{row}});
              },
          .text = text,
          .json = json};
}

}  // namespace pipeline
