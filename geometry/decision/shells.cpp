#include "geometry/decision/shells.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "geometry/decision/meet.hpp"

namespace geometry {
namespace {

/// 1 when the facets face outwards, -1 when inwards, 0 when their volume cancels out.
int facing(const Mesh& mesh) {
  const Vec3& origin = mesh.vertices[mesh.triangles[0][0]];
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 p = mesh.vertices[a] - origin, q = mesh.vertices[b] - origin, r = mesh.vertices[c] - origin;
    volume += (p.x() * (q.y() * r.z() - q.z() * r.y()) + p.y() * (q.z() * r.x() - q.x() * r.z())) +
              p.z() * (q.x() * r.y() - q.y() * r.x());
  }
  return (volume > 0) - (volume < 0);
}

/// Every connected component of the facets as a mesh of its own. Each facet has three different corners.
std::vector<Mesh> parts(const Mesh& mesh, std::span<const Facet> facets) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  for (std::uint32_t v = 0; v < parent.size(); ++v) parent[v] = v;
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Facet& f : facets)
    for (const std::uint32_t v : {f[1], f[2]}) {
      const std::uint32_t a = root(f[0]), b = root(v);
      parent[std::max(a, b)] = std::min(a, b);
    }
  std::map<std::uint32_t, std::uint32_t> part_of;  // by root
  std::vector<std::uint32_t> local(mesh.vertices.size(), std::uint32_t(-1));
  std::vector<Mesh> out;
  for (const Facet& f : facets) {
    const auto part = part_of.emplace(root(f[0]), std::uint32_t(out.size())).first->second;
    if (part == out.size()) out.emplace_back();
    Facet own;
    for (std::size_t k = 0; k < 3; ++k) {
      if (local[f[k]] == std::uint32_t(-1)) {
        local[f[k]] = std::uint32_t(out[part].vertices.size());
        out[part].vertices.push_back(mesh.vertices[f[k]]);
      }
      own[k] = local[f[k]];
    }
    out[part].triangles.push_back(own);
  }
  return out;
}

}  // namespace

Shells shells_of(const Mesh& mesh, const Solid& solid) {
  const Mesh& surface = solid.surface ? solid.surface->mesh : mesh;
  const std::vector<std::uint32_t> joined = joined_by_coordinates(surface.vertices);
  std::vector<Facet> facets;
  for (const Facet& f : surface.triangles) {
    const Facet own{joined[f[0]], joined[f[1]], joined[f[2]]};
    if (own[0] != own[1] && own[1] != own[2] && own[2] != own[0]) facets.push_back(own);
  }
  Shells out;
  std::vector<Facet> sorted = facets;
  for (Facet& f : sorted) std::ranges::sort(f);
  std::ranges::sort(sorted);
  out.repeated_facets = std::size_t(std::ranges::unique(sorted).size());
  if (!solid.closed) return out;

  Bodies shells;
  shells.meshes = parts(surface, facets);
  out.shells = shells.meshes.size();
  if (out.shells == 1) return out;
  std::vector<Solid> solids(out.shells);
  for (std::uint32_t i = 0; i < out.shells; ++i) {
    shells.add(std::to_string(i), i);
    solids[i].closed = true;
    solids[i].components = {0};
  }
  const std::vector<Pose> as_they_are(out.shells);
  const std::vector<Bvh> bvhs = build_bvhs(shells);
  std::vector<Contained> contained;
  std::set<std::uint32_t> meeting;
  for (const Pair& pair : Decision(shells, bvhs, solids).hits(as_they_are, pair_runs(shells, as_they_are), &contained))
    meeting.insert({pair.a, pair.b});
  out.meeting = meeting.size();

  std::vector<std::vector<std::uint32_t>> around(out.shells);  // the shells that a shell lies in
  for (const auto& [pair, inside] : contained) around[inside].push_back(inside == pair.a ? pair.b : pair.a);
  for (std::uint32_t i = 0; i < out.shells; ++i) {
    if (around[i].empty()) continue;
    // The innermost lies in the most others itself.
    const std::uint32_t next = *std::ranges::max_element(around[i], {}, [&](auto s) { return around[s].size(); });
    out.nested_alike += facing(shells.meshes[i]) * facing(shells.meshes[next]) > 0;
  }
  return out;
}

}  // namespace geometry
