#include "algorithms/beyond/proxy.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "algorithms/beyond/solids.hpp"

namespace algorithms {
namespace {

using geometry::Mesh;
using ByMesh = std::vector<std::vector<Mesh>>;  // one list a distinct mesh

ByMesh themselves(const Bodies& bodies) {
  ByMesh out;
  for (const Mesh& mesh : bodies.meshes) out.push_back(components(mesh));
  return out;
}

ByMesh chosen(const Bodies& bodies, const std::map<std::string, std::vector<Mesh>>& solids) {
  for (const auto& [name, parts] : solids)
    if (std::ranges::find(bodies.meshes, name, &Mesh::name) == bodies.meshes.end())
      throw std::invalid_argument("a file is named for mesh '" + name + "', which the scene has not; it has " + [&] {
        std::string names;
        constexpr std::size_t kMost = 10;
        for (std::size_t i = 0; i < std::min(kMost, bodies.meshes.size()); ++i)
          names += (i ? ", " : "") + bodies.meshes[i].name;
        return names + (bodies.meshes.size() > kMost ? ", …" : "");
      }());
  ByMesh out;
  for (const Mesh& mesh : bodies.meshes) {
    const auto found = solids.find(mesh.name);
    if (found == solids.end())
      throw std::invalid_argument("no file is named for mesh '" + mesh.name + "'; add " + mesh.name + " = \"....obj\"");
    out.push_back(found->second);
  }
  return out;
}

/// From what gives the solids of the bodies' meshes.
template <class Give>
Algorithm row(Give give) {
  return {
      .name = "proxy",
      .what = "solids from files, in place of the meshes, share a point: exactly",
      .operations_unit = "pairs of nodes and of triangles, and supports",
      .scope = Scope::scene,
      .knobs = {{.name = "file",
                 .preset = std::string(),
                 .unit = "1",
                 .what =
                     "for each mesh the file of its closed components, {mesh = \"file\"}; none: the meshes themselves",
                 .role = Role::files}},
      .make = [give](const Bodies& bodies, const Knobs&) { return make_solids(bodies, give(bodies)); },
      .memory = [give](const Bodies& bodies, const Knobs&) { return solids_memory(bodies, give(bodies)); },
      .proxies =
          [give](const Bodies& bodies, const Knobs&) {
            std::vector<Proxy> out;
            for (std::vector<Mesh>& solids : give(bodies))
              out.push_back({.kind = Proxy::Kind::solids, .balls = {}, .solids = std::move(solids)});
            return out;
          }};
}

}  // namespace

Algorithm proxy() { return row(themselves); }

Algorithm proxy_of(std::map<std::string, std::vector<Mesh>> solids) {
  return row([solids = std::move(solids)](const Bodies& bodies) { return chosen(bodies, solids); });
}

}  // namespace algorithms
