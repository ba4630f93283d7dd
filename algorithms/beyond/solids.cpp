#include "algorithms/beyond/solids.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "algorithms/parts/deciding.hpp"
#include "geometry/decision/contain.hpp"

namespace algorithms {
namespace {

using geometry::Facet;
using geometry::Mesh;

/// A body for every solid of every body.
class Solids final : public Method {
 public:
  Solids(const Bodies& bodies, const std::vector<std::vector<Mesh>>& solids) : first_(bodies.size() + 1) {
    parts_.closed_within = bodies.closed_within;
    std::vector<std::uint32_t> of_mesh{0};
    bool closed = false;
    for (const std::vector<Mesh>& of : solids) {
      for (const Mesh& solid : of) {
        parts_.meshes.push_back(solid);
        closed = closed || geometry::solid_of(solid, bodies.closed_within).closed;
      }
      of_mesh.push_back(std::uint32_t(parts_.meshes.size()));
    }
    for (std::uint32_t body = 0; body < bodies.size(); ++body) {
      for (std::uint32_t k = of_mesh[bodies.mesh[body]]; k < of_mesh[bodies.mesh[body] + 1]; ++k) {
        parts_.add("", k, bodies.fixed[body]);
        body_of_.push_back(body);
      }
      first_[body + 1] = std::uint32_t(body_of_.size());
    }
    poses_.resize(parts_.size());
    deciding_ = make_deciding(parts_, {{"containment", closed}}, /*remembers=*/true);
  }

  void prepare(std::span<const Pose> poses, double /*enlarge*/) override {
    for (std::size_t part = 0; part < body_of_.size(); ++part) poses_[part] = poses[body_of_[part]];
    deciding_->prepare(poses_);
  }

  void answer(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    spread(runs);
    found_.clear();
    deciding_->answer(runs_, found_);
    gather(hits);
  }

  std::uint64_t count(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    spread(runs);
    found_.clear();
    const std::uint64_t operations = deciding_->count(runs_, found_);
    gather(hits);
    return operations;
  }

  void remember() override { deciding_->remember(); }
  void forget() override { deciding_->forget(); }

 private:
  void spread(std::span<const PairRun> runs) {
    runs_.clear();
    for (std::size_t i = 0, end = 0; i < runs.size(); i = end) {  // the runs of one body, part by part: sorted
      while (end < runs.size() && runs[end].a == runs[i].a) ++end;
      for (std::uint32_t part = first_[runs[i].a]; part < first_[runs[i].a + 1]; ++part)
        for (std::size_t k = i; k < end; ++k)
          if (first_[runs[k].first] < first_[runs[k].last])
            runs_.push_back({part, first_[runs[k].first], first_[runs[k].last]});
    }
  }

  void gather(std::vector<Pair>& hits) {
    for (Pair& pair : found_) pair = {body_of_[pair.a], body_of_[pair.b]};
    std::ranges::sort(found_);
    const auto [same, end] = std::ranges::unique(found_);
    hits.insert(hits.end(), found_.begin(), same);
  }

  Bodies parts_;
  std::vector<std::uint32_t> first_;    // #bodies + 1: its parts
  std::vector<std::uint32_t> body_of_;  // #parts
  std::vector<Pose> poses_;             // #parts
  std::vector<PairRun> runs_;
  std::vector<Pair> found_;
  std::unique_ptr<Method> deciding_;  // refers to parts_
};

/// The facets as meshes of their own, those of one group together, groups in the order of their first facets.
std::vector<Mesh> parted(const Mesh& mesh, std::span<const std::uint32_t> group) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(mesh.vertices.size(), kNone);  // of a group
  std::vector<std::vector<std::uint32_t>> facets;
  for (std::uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    std::uint32_t& at = place[group[f]];
    if (at == kNone) at = std::uint32_t(facets.size()), facets.emplace_back();
    facets[at].push_back(f);
  }
  std::vector<Mesh> out;
  std::vector<std::uint32_t> number(mesh.vertices.size());
  for (const std::vector<std::uint32_t>& of : facets) {
    Mesh& part = out.emplace_back();
    std::vector<std::uint32_t> used;
    for (const std::uint32_t f : of) used.insert(used.end(), mesh.triangles[f].begin(), mesh.triangles[f].end());
    std::ranges::sort(used);
    const auto [same, end] = std::ranges::unique(used);
    used.erase(same, end);
    for (std::uint32_t i = 0; i < used.size(); ++i) {
      number[used[i]] = i;
      part.vertices.push_back(mesh.vertices[used[i]]);
    }
    for (const std::uint32_t f : of) {
      const auto& [a, b, c] = mesh.triangles[f];
      part.triangles.push_back({number[a], number[b], number[c]});
    }
  }
  return out;
}

/// Components when vertices are the same whose `alike` is.
std::vector<Mesh> components(const Mesh& mesh, std::span<const std::uint32_t> alike) {
  std::vector<std::uint32_t> parent(alike.begin(), alike.end());
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Facet& facet : mesh.triangles)
    for (const std::uint32_t v : facet) {
      const std::uint32_t a = root(facet[0]), b = root(v);
      parent[std::max(a, b)] = std::min(a, b);
    }
  std::vector<std::uint32_t> group;
  for (const Facet& facet : mesh.triangles) group.push_back(root(facet[0]));
  return parted(mesh, group);
}

}  // namespace

std::unique_ptr<Method> make_solids(const Bodies& bodies, const std::vector<std::vector<Mesh>>& solids) {
  return std::make_unique<Solids>(bodies, solids);
}

Memory solids_memory(const Bodies& bodies, const std::vector<std::vector<Mesh>>& solids) {
  Bodies parts;
  std::vector<std::uint32_t> of_mesh{0};
  std::uint64_t meshes = 0;
  for (const std::vector<Mesh>& of : solids) {
    for (const Mesh& solid : of) {
      parts.meshes.push_back(solid);
      meshes += sizeof(Mesh) + solid.vertices.size() * sizeof(geometry::Vec3) + solid.triangles.size() * sizeof(Facet);
    }
    of_mesh.push_back(std::uint32_t(parts.meshes.size()));
  }
  for (std::uint32_t body = 0; body < bodies.size(); ++body)
    for (std::uint32_t k = of_mesh[bodies.mesh[body]]; k < of_mesh[bodies.mesh[body] + 1]; ++k) parts.add("", k);
  const Memory deciding = deciding_memory(parts, {});
  const std::uint64_t held =
      meshes + parts.size() * (sizeof(Pose) + 2 * sizeof(std::uint32_t) + 1 + sizeof(std::string));
  return {held + deciding.held, held + deciding.greatest};
}

Mesh without_unused(const Mesh& mesh) {
  return parted(mesh, std::vector<std::uint32_t>(mesh.triangles.size(), 0)).at(0);
}

std::vector<Mesh> components(const Mesh& mesh) {
  std::vector<std::uint32_t> itself(mesh.vertices.size());
  std::iota(itself.begin(), itself.end(), 0u);
  return components(mesh, itself);
}

std::vector<Mesh> closed_components(const Mesh& mesh, double closed_within) {
  const auto all_closed = [&](const std::vector<Mesh>& parts) {
    return std::ranges::all_of(parts, [&](const Mesh& part) { return geometry::solid_of(part, closed_within).closed; });
  };
  std::vector<Mesh> parts = components(mesh);
  if (all_closed(parts)) return parts;
  parts = components(mesh, geometry::joined_by_coordinates(mesh.vertices));
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (const geometry::Solid solid = geometry::solid_of(parts[i], closed_within); !solid.closed)
      throw std::invalid_argument(
          (parts.size() > 1 ? "component " + std::to_string(i + 1) + " of " + std::to_string(parts.size()) : "it") +
          " is open, " + geometry::open_text(solid));
  return parts;
}

}  // namespace algorithms
