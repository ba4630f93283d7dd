// Triangle meshes in their own frame, and what can be known of them without a pose.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "geometry/box.hpp"
#include "geometry/pose.hpp"

namespace geometry {

/// Three indices into a mesh's vertices.
using Facet = std::array<std::uint32_t, 3>;

/// A ball in the frame of a mesh, metres.
struct ContactBall {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
};

/// A mesh. Facets are counted from 0 in this order: algorithms that sample facets depend on it.
struct Mesh {
  std::string name;              // [A-Za-z0-9_.+-]{1,64}, unique in a run
  std::vector<Vec3> vertices;    // metres
  std::vector<Facet> triangles;  // counter-clockwise seen from outside
  std::string shape;             // JSON: kind and parameters of a built-in shape, or the file
  // Greatest distance of a surface point of the mesh from the surface of the shape it approximates, in metres;
  // NaN where there is no such shape (mesh files).
  double surface_deviation = std::numeric_limits<double>::quiet_NaN();
  double sphere_radius = 0;  // metres; the nominal radius when the shape is a sphere, else 0
  // Of bodies that touch others by several balls inside their mesh: those balls, and how far the surface is from them
  // at most, in metres; else none and NaN.
  std::vector<ContactBall> contact_spheres;
  double contact_deviation = std::numeric_limits<double>::quiet_NaN();
};

/// The smallest box around the vertices.
Box local_box(const Mesh& mesh);

/// Per axis the larger of |min| and |max| of the vertices: half a box centred on the body's position, metres.
Vec3 half_extents(const Mesh& mesh);

/// True when every edge belongs to exactly two facets, which run along it in opposite directions. Edges are pairs of
/// vertex indices: doubled vertices are not welded. False for a facet that names a vertex twice, and without facets.
bool is_closed(const Mesh& mesh);

/// The number of facets without area (exactly: their corners lie on one line).
std::size_t degenerate_facets(const Mesh& mesh);

/// Radius of a ball about the local origin that holds no surface point: the least distance of the origin behind the
/// plane of a facet, rounded down by at most 1e-13 of it for facets of good shape, more for slivers, never up. 0 when
/// the origin is in front of or on some plane, when a facet has no area, and without facets. Where it is positive, a
/// closed mesh holds the ball inside; for a convex one no greater ball fits. Metres.
double inscribed_radius(const Mesh& mesh);

}  // namespace geometry
