// Facet points: sampling, densifying and placing (facets.hpp says what for).
#include "algorithms/parts/facets.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace geometry {

Vec3 facet_point(const Mesh& mesh, const Facet& facet) {
  const Vec3 &a = mesh.vertices[facet[0]], &b = mesh.vertices[facet[1]], &c = mesh.vertices[facet[2]];
  return {((a.x() + b.x()) + c.x()) / 3.0, ((a.y() + b.y()) + c.y()) / 3.0, ((a.z() + b.z()) + c.z()) / 3.0};
}

std::size_t point_count(std::size_t facets, std::size_t stride) { return facets == 0 ? 0 : 1 + (facets - 1) / stride; }

Points facet_points(const Mesh& mesh, std::size_t stride) {
  assert(stride >= 1 && "a stride is at least 1");
  Points points;
  const std::size_t size = point_count(mesh.triangles.size(), stride);
  for (auto* column : {&points.x, &points.y, &points.z}) column->reserve(size);
  // Counted by what is left, so that a huge stride cannot overflow the index.
  for (std::size_t i = 0; i < mesh.triangles.size();) {
    points.add(facet_point(mesh, mesh.triangles[i]));
    if (stride >= mesh.triangles.size() - i) break;
    i += stride;
  }
  return points;
}

Points inflated(Points points, double factor) {
  for (auto* column : {&points.x, &points.y, &points.z})
    for (double& value : *column) value *= factor;
  return points;
}

double box_surface(const Mesh& mesh) {
  const Box box = local_box(mesh);
  const double a = box.max.x() - box.min.x(), b = box.max.y() - box.min.y(), c = box.max.z() - box.min.z();
  return 2 * ((a * b + b * c) + c * a);
}

std::uint32_t parts_of_density(const Mesh& mesh, double facets_per_area) {
  const auto facets = static_cast<double>(mesh.triangles.size());
  if (mesh.triangles.empty()) return 1;
  const double wanted = facets_per_area * box_surface(mesh);
  if (!(facets < wanted)) return 1;
  // Asked first: the search below is then short, also for a surface beyond all numbers.
  const auto refuse = [&mesh] {
    throw std::invalid_argument("mesh '" + mesh.name + "' would be made denser than " + std::to_string(kMostFacets) +
                                " facets: scale it down, or ask for fewer facets per area or for none (densify)");
  };
  if (!(wanted <= kMostFacets)) refuse();
  double parts = std::ceil(std::sqrt(wanted / facets));
  // The root is rounded, and the smallest number of parts is asked for.
  while (parts > 1 && facets * (parts - 1) * (parts - 1) >= wanted) --parts;
  while (facets * parts * parts < wanted) ++parts;
  if (facets * parts * parts > kMostFacets) refuse();
  return static_cast<std::uint32_t>(parts);
}

std::uint64_t dense_bytes(const Mesh& mesh, std::uint64_t parts) {
  const std::uint64_t facets = mesh.triangles.size();
  const std::uint64_t vertices = parts == 1 ? mesh.vertices.size() : facets * (parts + 1) * (parts + 2) / 2;
  return sizeof(Vec3) * vertices + sizeof(Facet) * facets * parts * parts;
}

Mesh densified(const Mesh& mesh, double facets_per_area) {
  const std::uint32_t m = parts_of_density(mesh, facets_per_area);
  if (m == 1) return mesh;
  const double parts = m;

  Mesh dense = mesh;
  dense.vertices.clear();
  dense.triangles.clear();
  dense.vertices.reserve(mesh.triangles.size() * (m + 1) * (m + 2) / 2);
  dense.triangles.reserve(mesh.triangles.size() * m * m);
  for (const Facet& facet : mesh.triangles) {
    const auto base = static_cast<std::uint32_t>(dense.vertices.size());
    const Vec3 &first = mesh.vertices[facet[0]], &second = mesh.vertices[facet[1]], &third = mesh.vertices[facet[2]];
    for (std::uint32_t k = 0; k <= m; ++k)
      for (std::uint32_t j = 0; j <= k; ++j) {
        if (k == 0)
          dense.vertices.push_back(first);
        else if (k == m && j == 0)
          dense.vertices.push_back(second);
        else if (k == m && j == m)
          dense.vertices.push_back(third);
        else
          dense.vertices.push_back((double(m - k) * first + double(k - j) * second + double(j) * third) / parts);
      }
    const auto at = [base](std::uint32_t k, std::uint32_t j) { return base + k * (k + 1) / 2 + j; };
    for (std::uint32_t k = 0; k < m; ++k)
      for (std::uint32_t j = 0; j <= k; ++j) {
        dense.triangles.push_back({at(k, j), at(k + 1, j), at(k + 1, j + 1)});
        if (j < k) dense.triangles.push_back({at(k, j), at(k + 1, j + 1), at(k, j + 1)});
      }
  }
  return dense;
}

Points sampled_points(const Mesh& mesh, std::size_t stride, bool dense) {
  return facet_points(dense ? densified(mesh, kFacetsPerArea) : mesh, stride);
}

std::size_t stride_of_density(std::size_t facets, double facets_per_area, double surface) {
  const double wanted = facets_per_area * surface;
  if (!(wanted > 0)) return 1;
  const double stride = std::floor(static_cast<double>(facets) / wanted);
  if (!(stride > 1)) return 1;
  // A quotient beyond the number of facets samples facet 0 alone, as that number does.
  return static_cast<std::size_t>(std::min(stride, static_cast<double>(facets)));
}

std::size_t triangle_count(std::size_t points, Triangulation triangulation) {
  return points < 3 ? 0 : triangulation == Triangulation::disjoint ? points / 3 : points - 2;
}

std::vector<std::uint32_t> sampled_triangles(std::size_t points, Triangulation triangulation) {
  std::vector<std::uint32_t> first;
  const std::size_t step = triangulation == Triangulation::disjoint ? 3 : 1;
  first.reserve(triangle_count(points, triangulation));
  for (std::size_t i = 0; i + 3 <= points; i += step) first.push_back(static_cast<std::uint32_t>(i));
  return first;
}

Ball ball_around(const Points& points) {
  const auto [x0, x1] = std::minmax_element(points.x.begin(), points.x.end());
  const auto [y0, y1] = std::minmax_element(points.y.begin(), points.y.end());
  const auto [z0, z1] = std::minmax_element(points.z.begin(), points.z.end());
  Ball ball{.centre = {0.5 * (*x0 + *x1), 0.5 * (*y0 + *y1), 0.5 * (*z0 + *z1)}, .radius = 0};
  double squared = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points.x[i] - ball.centre.x(), y = points.y[i] - ball.centre.y(),
                 z = points.z[i] - ball.centre.z();
    squared = std::max(squared, (x * x + y * y) + z * z);
  }
  // 1e-12 stands for some ten roundings of 1.1e-16 each, 1e-150 for squares that underflow.
  ball.radius = std::sqrt(squared) * (1 + 1e-12) + 1e-150;
  return ball;
}

PlacedPoints::PlacedPoints(const Bodies& bodies, std::vector<Points> local)
    : mesh_(bodies.mesh), local_(std::move(local)), poses_(bodies.size()), placed_(bodies.size()) {
  assert(local_.size() == bodies.meshes.size() && "points of every distinct mesh");
  world_.resize(mesh_.size());
  for (std::size_t body = 0; body < mesh_.size(); ++body) world_[body].resize(local_[mesh_[body]].size());
}

void PlacedPoints::prepare(std::span<const Pose> poses) {
  assert(poses.size() == poses_.size() && "one pose per body");
  std::copy(poses.begin(), poses.end(), poses_.begin());
  std::fill(placed_.begin(), placed_.end(), std::uint8_t{0});
}

bool PlacedPoints::place(std::uint32_t body) {
  if (placed_[body]) return false;
  placed_[body] = 1;
  const Points& local = local_[mesh_[body]];
  const Mat3 r = rotation(poses_[body].q);
  const Vec3& t = poses_[body].t;
  for (std::size_t i = 0; i < local.size(); ++i) world_[body].set(i, to_world(r, t, local.at(i)));
  return true;
}

std::uint64_t PlacedPoints::bytes(const Bodies& bodies, std::span<const std::size_t> points) {
  std::uint64_t sum = bodies.size() * (sizeof(std::uint32_t) + sizeof(Points) + sizeof(Pose) + sizeof(std::uint8_t));
  for (const std::size_t count : points) sum += sizeof(Points) + sizeof(Vec3) * count;
  for (const std::uint32_t mesh : bodies.mesh) sum += sizeof(Vec3) * points[mesh];
  return sum;
}

std::size_t PlacedPoints::most() const {
  std::size_t most = 0;
  for (const Points& points : world_) most = std::max(most, points.size());
  return most;
}

}  // namespace geometry
