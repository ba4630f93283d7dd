// The knobs that the methods on sampled facets share (thesis 4.1), and the points that they choose.
#pragma once
#include <algorithm>
#include <vector>

#include "algorithms/contract/algorithm.hpp"
#include "algorithms/parts/facets.hpp"

namespace algorithms {

inline Knob stride_knob() {
  return {.name = "stride",
          .preset = std::int64_t{20},  // thesis 4.1: every twentieth facet
          .unit = "1",
          .what = "every stride-th facet is sampled",
          .least = 1,
          .most = 1e9};
}

inline Knob inflate_knob() {
  return {.name = "inflate",
          .preset = 1.1,
          .unit = "1",
          .what = "factor on the sampled points, about the body's origin",
          .least = 1e-3,
          .most = 1e3};
}

inline Knob triangles_knob() {
  return {.name = "triangles",
          .preset = std::string("disjoint"),
          .unit = "1",
          .what = "triangles of consecutive points: (0,1,2), (3,4,5), ... or (0,1,2), (1,2,3), ...",
          .choices = {"disjoint", "strip"}};
}

/// Off: the mesh's own facets, as published. On: as many as facet_distance has by its presets.
inline Knob densify_knob() {
  return {.name = "densify",
          .preset = false,
          .unit = "1",
          .what = "cut the facets of a mesh that has fewer than 8 per m^2 of its box",
          .role = Role::density};
}

/// The points that `stride` and `densify` choose: one entry per mesh, in its own frame.
inline std::vector<geometry::Points> sampled_points(const Bodies& bodies, const Knobs& knobs) {
  const auto stride = static_cast<std::size_t>(value_of<std::int64_t>(knobs, "stride"));
  std::vector<geometry::Points> local;
  for (const geometry::Mesh& mesh : bodies.meshes)
    local.push_back(geometry::sampled_points(mesh, stride, value_of<bool>(knobs, "densify")));
  return local;
}

/// How many points sampled_points gives of each mesh, and what they take at most while they are made, as Memory.
struct SampledSize {
  std::vector<std::size_t> points;  // #meshes
  std::uint64_t made = 0;           // bytes
};
inline SampledSize sampled_size(const Bodies& bodies, const Knobs& knobs) {
  const auto stride = static_cast<std::size_t>(value_of<std::int64_t>(knobs, "stride"));
  SampledSize out;
  std::uint64_t before = 0;
  for (const geometry::Mesh& mesh : bodies.meshes) {
    const std::uint64_t parts =
        value_of<bool>(knobs, "densify") ? geometry::parts_of_density(mesh, geometry::kFacetsPerArea) : 1;
    out.points.push_back(geometry::point_count(mesh.triangles.size() * parts * parts, stride));
    before += sizeof(geometry::Vec3) * out.points.back();
    out.made = std::max(out.made, before + geometry::dense_bytes(mesh, parts));
  }
  return out;
}

/// Memory of a method that keeps those points of every body, and more of each body by its number of points.
template <class MoreBytes>
Memory sampled_memory(const Bodies& bodies, const Knobs& knobs, MoreBytes more) {
  const SampledSize size = sampled_size(bodies, knobs);
  std::uint64_t held = geometry::PlacedPoints::bytes(bodies, size.points);
  for (const std::uint32_t mesh : bodies.mesh) held += more(size.points[mesh]);
  return {held, std::max(held, size.made)};
}

/// The same, inflated.
inline std::vector<geometry::Points> inflated_points(const Bodies& bodies, const Knobs& knobs) {
  std::vector<geometry::Points> local = sampled_points(bodies, knobs);
  for (geometry::Points& points : local)
    points = geometry::inflated(std::move(points), value_of<double>(knobs, "inflate"));
  return local;
}

inline geometry::Triangulation triangulation(const Knobs& knobs) {
  return value_of<std::string>(knobs, "triangles") == "strip" ? geometry::Triangulation::strip
                                                              : geometry::Triangulation::disjoint;
}

}  // namespace algorithms
