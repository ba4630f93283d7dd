#include "algorithms/parts/spheres.hpp"

#include <cmath>

#include "geometry/processor_clones.hpp"

namespace geometry {
namespace {

PROCESSOR_CLONES void overlap_columns(const double* x, const double* y, const double* z, const double* r,
                                      std::uint32_t i, std::uint32_t first, std::uint32_t last, std::uint8_t* hit) {
  const double ix = x[i], iy = y[i], iz = z[i], ir = r[i];
  for (std::uint32_t k = first; k < last; ++k) {
    const double dx = ix - x[k], dy = iy - y[k], dz = iz - z[k], reach = ir + r[k];
    hit[k - first] = dx * dx + dy * dy + dz * dz < reach * reach;
  }
}

}  // namespace

void overlap_row(const Spheres& s, std::uint32_t i, std::uint32_t first, std::uint32_t last, std::uint8_t* hit) {
  overlap_columns(s.x.data(), s.y.data(), s.z.data(), s.r.data(), i, first, last, hit);
}

std::vector<double> nominal_radii(const Bodies& bodies) {
  std::vector<double> radii;
  for (std::uint32_t body = 0; body < bodies.size(); ++body) {
    const Mesh& mesh = bodies.mesh_of(body);
    const Vec3 h = half_extents(mesh);
    radii.push_back(mesh.sphere_radius > 0 ? mesh.sphere_radius
                                           : std::sqrt(h.x() * h.x() + h.y() * h.y() + h.z() * h.z()));
  }
  return radii;
}

double enlarged(double radius, const Vec3& t, double enlarge) {
  return enlarge > 0 ? radius + enlarge * (radius + t.norm()) : radius;
}

}  // namespace geometry
