// Mass properties of a closed mesh: integrals over the volume that its facets enclose.
#pragma once
#include <array>
#include <span>

#include "geometry/mesh.hpp"

namespace geometry {

/// Of a solid of density 1 kg/m^3.
struct MassProperties {
  double volume = 0;  // m^3; negative when the facets face inward
  Vec3 centre = Vec3::Zero();
  // About the centre, along the axes of the mesh's frame: xx, yy, zz, xy, xz, yz in kg m^2, as entries of the matrix
  // (products with their minus).
  std::array<double, 6> inertia{};
};

/// Of what closed facets enclose that face one way. Sums in the order of the facets: the same bits everywhere.
MassProperties mass_properties(std::span<const Vec3> vertices, std::span<const Facet> facets);

/// Whether the facets, corners being one where their numbers are, face one way: along every edge as many run one way as
/// the other. Then they enclose a volume, whichever point it is measured from.
bool face_one_way(std::span<const Facet> facets);

}  // namespace geometry
