#include "algorithms/beyond/cells.hpp"

#include <algorithm>

namespace algorithms {

using geometry::Mesh;
using geometry::Vec3;

void Polygons::close() {
  if (points.size() > (ends.empty() ? 0 : ends.back())) ends.push_back(std::uint32_t(points.size()));
}

Polygons polygons_of(const Mesh& mesh, std::span<const Vec3> at) {
  Polygons out;
  out.points.reserve(3 * mesh.triangles.size());
  std::vector<std::uint8_t> used(at.size());
  for (const geometry::Facet& facet : mesh.triangles) {
    for (const std::uint32_t v : facet) out.points.push_back(at[v]), used[v] = 1;
    out.close();
  }
  for (std::size_t v = 0; v < at.size(); ++v)
    if (!used[v]) out.points.push_back(at[v]), out.close();
  return out;
}

namespace {

/// One of the polygons, clipped, after those of `out`.
void clip(std::span<const Vec3> polygon, int k, double at, double side, Polygons& out) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const double from = side * (p[k] - at), to = side * (q[k] - at);
    if (from <= 0) out.points.push_back(p);
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) {
      Vec3 x = p + ((at - p[k]) / (q[k] - p[k])) * (q - p);
      x[k] = at;
      out.points.push_back(x);
    }
  }
  out.close();
}

template <class Each>
void each_polygon(const Polygons& polygons, Each each) {
  std::uint32_t first = 0;
  for (const std::uint32_t end : polygons.ends) {
    each(std::span(polygons.points).subspan(first, end - first));
    first = end;
  }
}

}  // namespace

Polygons clipped(const Polygons& polygons, int k, double at, double side) {
  Polygons out;
  each_polygon(polygons, [&](std::span<const Vec3> polygon) { clip(polygon, k, at, side, out); });
  return out;
}

Polygons parted(const Polygons& polygons, int k, double at, double side, double margin, bool takes_flat) {
  Polygons out;
  each_polygon(polygons, [&](std::span<const Vec3> polygon) {
    const auto beyond = [&](const Vec3& p) { return side * (p[k] - at); };
    const bool here = std::ranges::all_of(polygon, [&](const Vec3& p) { return beyond(p) <= margin; });
    const bool there = std::ranges::all_of(polygon, [&](const Vec3& p) { return beyond(p) >= -margin; });
    if (here && (!there || takes_flat)) {
      out.points.insert(out.points.end(), polygon.begin(), polygon.end());
      out.close();
    } else if (!here && !there) {
      clip(polygon, k, at + side * margin, side, out);
    }
  });
  return out;
}

Inside::Inside(const Mesh& mesh, const geometry::Solid& solid, std::vector<Vec3> at) {
  if (!solid.closed) return;
  mesh_.triangles = solid.surface ? solid.surface->mesh.triangles : mesh.triangles;
  mesh_.vertices = std::move(at);
  bvh_ = geometry::build_bvh(mesh_);
  boxes_.resize(bvh_.nodes.size());
  geometry::refit(bvh_, mesh_, mesh_.vertices, boxes_);
}

bool Inside::operator()(const Vec3& point) const {
  return !boxes_.empty() && geometry::is_inside(point, mesh_, bvh_, mesh_.vertices, boxes_);
}

std::vector<Vec3> points_in(const geometry::Box& box, const Polygons& facets, const Inside& inside) {
  std::vector<Vec3> out = facets.points;
  for (int i = 0; i < 8; ++i)
    if (const Vec3 at = corner(box, i); inside(at)) out.push_back(at);
  return out;
}

std::uint64_t cutting_bytes(const Mesh& mesh) {
  const std::uint64_t facets = mesh.triangles.size();
  return facets * 3 * (6 * sizeof(Vec3)) + std::uint64_t(geometry::kBuildingBvh * double(geometry::bvh_bytes(facets))) +
         mesh.vertices.size() * 2 * sizeof(Vec3);
}

}  // namespace algorithms
