// The built-in shapes as meshes.
#pragma once
#include <cstdint>
#include <string>

#include "geometry/mesh.hpp"

namespace geometry {

// Every function documents its vertex formula, pole axis and order of triangles; a test pins each by a digest.
Mesh sphere(const std::string& name, double radius, std::int64_t segments);
Mesh box(const std::string& name, const Vec3& size);
Mesh capsule(const std::string& name, double height, double radius_bottom, double radius_top, std::int64_t segments);
Mesh torus(const std::string& name, double diameter, double thickness, std::int64_t segments);
Mesh torus_knot(const std::string& name, double radius, double tube, std::int64_t radial_segments,
                std::int64_t tubular_segments, std::int64_t p, std::int64_t q);

}  // namespace geometry
