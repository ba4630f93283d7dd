#include "pipeline/stages/proxies.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "algorithms/contract/proxy_files.hpp"
#include "geometry/decision/wrapping.hpp"

namespace pipeline {
namespace {

using algorithms::Proxy;
using geometry::Mesh;

geometry::Wrapping wrapping_of(const Mesh& mesh, const Proxy& proxy, double closed_within) {
  switch (proxy.kind) {
    case Proxy::Kind::balls:
      return geometry::outside_balls(mesh, proxy.balls);
    case Proxy::Kind::capsule:
      return geometry::outside_capsule(mesh, proxy.balls[0], proxy.balls[1]);
    case Proxy::Kind::solids:
      break;
  }
  return geometry::outside_solids(mesh, proxy.solids, closed_within);
}

const char* text_of(Proxy::Kind kind) {
  switch (kind) {
    case Proxy::Kind::balls:
      return "balls";
    case Proxy::Kind::capsule:
      return "capsule";
    case Proxy::Kind::solids:
      break;
  }
  return "solids";
}

MeshProxy row_of(const std::string& label, const Mesh& mesh, Proxy proxy, double closed_within) {
  MeshProxy out;
  out.label = label;
  out.mesh = mesh.name;
  out.kind = text_of(proxy.kind);
  const geometry::Wrapping found = wrapping_of(mesh, proxy, closed_within);
  out.outside_share = found.outside_share;
  out.outside_greatest = found.outside_greatest;
  out.parts = proxy.kind == Proxy::Kind::balls     ? proxy.balls.size()
              : proxy.kind == Proxy::Kind::capsule ? 1
                                                   : proxy.solids.size();
  out.balls = std::move(proxy.balls);
  if (proxy.kind != Proxy::Kind::solids) return out;
  out.solid_offset.push_back(0);
  for (const Mesh& solid : proxy.solids) {
    const auto first = std::uint32_t(out.vertices.size());
    out.vertices.insert(out.vertices.end(), solid.vertices.begin(), solid.vertices.end());
    for (const auto& [a, b, c] : solid.triangles) out.triangles.push_back({a + first, b + first, c + first});
    out.solid_offset.push_back(out.triangles.size());
  }
  return out;
}

}  // namespace

Proxies proxies_of(const geometry::Bodies& bodies, const std::vector<AlgorithmChoice>& choices) {
  Proxies out;
  for (const AlgorithmChoice& choice : choices) {
    const algorithms::Algorithm& row = row_of(choice);
    if (!row.proxies) continue;
    try {
      std::vector<Proxy> proxies = row.proxies(bodies, choice.knobs);
      for (std::size_t i = 0; i < proxies.size(); ++i)
        out.rows.push_back(row_of(choice.label, bodies.meshes[i], std::move(proxies[i]), bodies.closed_within));
    } catch (const std::invalid_argument& error) {  // of extremes a refusal is an answer
      for (const Mesh& mesh : bodies.meshes) {
        MeshProxy& none = out.rows.emplace_back();
        none.label = choice.label;
        none.mesh = mesh.name;
        none.reason = error.what();
        none.outside_share = none.outside_greatest = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
  return out;
}

std::vector<Mesh> solids_of(const MeshProxy& row) {
  std::vector<Mesh> out;
  for (std::size_t i = 0; i + 1 < row.solid_offset.size(); ++i) {
    Mesh all;
    all.vertices = row.vertices;
    all.triangles.assign(row.triangles.begin() + std::ptrdiff_t(row.solid_offset[i]),
                         row.triangles.begin() + std::ptrdiff_t(row.solid_offset[i + 1]));
    out.push_back(algorithms::without_unused(all));
  }
  return out;
}

bool bind_recorded(AlgorithmChoice& choice, const Proxies& recorded) {
  std::map<std::string, std::vector<Mesh>> solids;
  for (const MeshProxy& row : recorded.rows)
    if (row.label == choice.label && row.kind == "solids") solids[row.mesh] = solids_of(row);
  if (solids.empty()) return false;
  choice.bound = std::make_shared<algorithms::Algorithm>(algorithms::proxy_of(std::move(solids)));
  return true;
}

}  // namespace pipeline
