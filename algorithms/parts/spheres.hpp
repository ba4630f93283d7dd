// Bounding spheres of bodies as columns, by Cannon.js's rule: the sphere of a sphere shape is the shape (nominal
// radius); of any other body it is as long as the half diagonal, about the body's position.
#pragma once
#include <cstdint>
#include <vector>

#include "geometry/bodies.hpp"

namespace geometry {

/// Bounding spheres by coordinate, metres.
struct Spheres {
  std::vector<double> x, y, z, r;

  void resize(std::size_t size) {
    for (auto* column : {&x, &y, &z, &r}) column->resize(size);
  }
  void set(std::size_t i, const Vec3& centre, double radius) {
    x[i] = centre.x();
    y[i] = centre.y();
    z[i] = centre.z();
    r[i] = radius;
  }
  bool overlap(std::size_t i, std::size_t k) const {
    const double dx = x[i] - x[k], dy = y[i] - y[k], dz = z[i] - z[k], reach = r[i] + r[k];
    return dx * dx + dy * dy + dz * dz < reach * reach;
  }
};

/// Spheres::overlap of sphere i with first ... last - 1: hit[k - first] is 0 or 1.
void overlap_row(const Spheres& spheres, std::uint32_t i, std::uint32_t first, std::uint32_t last, std::uint8_t* hit);

/// One radius per body, metres.
std::vector<double> nominal_radii(const Bodies& bodies);

/// radius + enlarge (radius + |t|); the radius itself, bit for bit, where enlarge is 0.
double enlarged(double radius, const Vec3& t, double enlarge);

}  // namespace geometry
