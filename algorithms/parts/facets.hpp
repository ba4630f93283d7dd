// Facet points: what the algorithms that sample facets see of a body.
//
// A facet is one triangle, its point is the barycentre. Points are chosen in the mesh's own frame, once per mesh, and
// moved by the pose, once per body and step and only for the bodies that are asked about.
// Source: Příbyl 2022, sections 3.1 and 4.1 ("FaceT"); the rule of density is its "increaseFacets".
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/bodies.hpp"

namespace geometry {

/// Points as three columns of equal length, metres, so that a loop over them reads memory in order.
struct Points {
  std::vector<double> x, y, z;

  std::size_t size() const { return x.size(); }
  Vec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
  void set(std::size_t i, const Vec3& p) {
    x[i] = p.x();
    y[i] = p.y();
    z[i] = p.z();
  }
  void add(const Vec3& p) {
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
  }
  void resize(std::size_t n) {
    x.resize(n);
    y.resize(n);
    z.resize(n);
  }
};

/// The barycentre ((v0 + v1) + v2) / 3 of a facet, mesh frame.
Vec3 facet_point(const Mesh& mesh, const Facet& facet);

/// The points of the facets 0, stride, 2 stride, ...: a stride beyond the last facet leaves facet 0. stride >= 1.
Points facet_points(const Mesh& mesh, std::size_t stride);

/// How many points that are.
std::size_t point_count(std::size_t facets, std::size_t stride);

/// Every point times `factor`: larger (factor > 1) about the body's origin, not about the points' middle.
Points inflated(Points points, double factor);

/// The surface 2 (ab + bc + ca) of the local vertex box, m^2: the thesis's measure of a body's surface.
double box_surface(const Mesh& mesh);

/// The mesh with at least facets_per_area * box_surface facets: each edge is cut into n + 1 equal parts and each facet
/// into (n + 1)^2, n being the smallest that suffices (0: the mesh as it is). Facet by facet in the mesh's order;
/// within one, rows from its first corner downwards, in row k alternately (k,j)(k+1,j)(k+1,j+1) and
/// (k,j)(k+1,j+1)(k,j+1), where (k,j) = ((n+1-k) first + (k-j) second + j third) / (n+1). Corners stay bit for bit, and
/// facets that share an edge share its new points bit for bit. A mesh whose box has no surface is dense enough. Throws
/// std::invalid_argument when more than kMostFacets would be needed.
Mesh densified(const Mesh& mesh, double facets_per_area);
inline constexpr std::size_t kMostFacets = 20'000'000;  // about a gigabyte of points and indices

/// How many parts `densified` cuts each edge into, without doing it; throws the same.
std::uint32_t parts_of_density(const Mesh& mesh, double facets_per_area);

/// Bytes of the mesh whose edges are cut into `parts`.
std::uint64_t dense_bytes(const Mesh& mesh, std::uint64_t parts);

/// The thesis's density, facets per m^2 of box_surface: "at least eight times greater than the surface" (3.1).
inline constexpr double kFacetsPerArea = 8;

/// facet_points of the mesh, or of the mesh densified to kFacetsPerArea.
Points sampled_points(const Mesh& mesh, std::size_t stride, bool dense);

/// max(1, floor(F / (facets_per_area * surface))) for F facets: the stride that leaves about facets_per_area facets per
/// m^2. Where the surface is 0 the quotient has no value and the stride is 1: no facet is given up.
std::size_t stride_of_density(std::size_t facets, double facets_per_area, double surface);

/// How triangles are made of consecutive points.
enum class Triangulation {
  disjoint,  // (0,1,2), (3,4,5), ...; one or two last points may be left over
  strip      // (0,1,2), (1,2,3), ...
};

/// How many triangles that many points make.
std::size_t triangle_count(std::size_t points, Triangulation triangulation);

/// The first point of each triangle; triangle i is first[i], first[i] + 1, first[i] + 2. None for fewer than 3 points.
std::vector<std::uint32_t> sampled_triangles(std::size_t points, Triangulation triangulation);

/// A ball that surely holds some points.
struct Ball {
  Vec3 centre = Vec3::Zero();
  double radius = 0;  // metres, rounded up by far more than the rounding of the sums behind it
};

/// The ball about the middle of the points' box. Not for zero points.
Ball ball_around(const Points& points);

/// The points of bodies in the world. A body is placed when it is first asked for after `prepare`, so a step pays only
/// for bodies that some pair needs. All memory is taken by the constructor.
class PlacedPoints {
 public:
  /// `local` has one entry per distinct mesh of `bodies`.
  PlacedPoints(const Bodies& bodies, std::vector<Points> local);

  /// Forgets where the bodies were. One pose per body; that of an unborn body is never used unless asked for.
  void prepare(std::span<const Pose> poses);

  /// Places the body if it is not yet; true when it was placed by this call: what is derived from its points is stale.
  bool place(std::uint32_t body);

  /// The points of a placed body, each by `to_world`.
  const Points& operator[](std::uint32_t body) const { return world_[body]; }

  /// The most points any body has.
  std::size_t most() const;

  /// Bytes of it, for that many points of each distinct mesh.
  static std::uint64_t bytes(const Bodies& bodies, std::span<const std::size_t> points);

 private:
  std::vector<std::uint32_t> mesh_;   // #bodies
  std::vector<Points> local_;         // #meshes
  std::vector<Points> world_;         // #bodies
  std::vector<Pose> poses_;           // #bodies
  std::vector<std::uint8_t> placed_;  // #bodies
};

}  // namespace geometry
