#include "algorithms/parts/balls_and_boxes.hpp"

#include "geometry/processor_clones.hpp"

namespace geometry {
namespace {

PROCESSOR_CLONES void row(const double* x, const double* y, const double* z, const double* r, const double* low_x,
                          const double* low_y, const double* low_z, const double* high_x, const double* high_y,
                          const double* high_z, std::uint32_t a, std::uint32_t first, std::uint32_t last,
                          std::uint8_t* hit) {
  const double ax = x[a], ay = y[a], az = z[a], ar = r[a];
  const double alx = low_x[a], aly = low_y[a], alz = low_z[a], ahx = high_x[a], ahy = high_y[a], ahz = high_z[a];
  for (std::uint32_t b = first; b < last; ++b) {
    const double dx = x[b] - ax, dy = y[b] - ay, dz = z[b] - az, reach = ar + r[b];
    hit[b - first] = (reach * reach >= dx * dx + dy * dy + dz * dz) & (alx <= high_x[b]) & (low_x[b] <= ahx) &
                     (aly <= high_y[b]) & (low_y[b] <= ahy) & (alz <= high_z[b]) & (low_z[b] <= ahz);
  }
}

}  // namespace

void BallsAndBoxes::resize(std::size_t bodies) {
  for (auto* column : {&x, &y, &z, &r, &low_x, &low_y, &low_z, &high_x, &high_y, &high_z}) column->resize(bodies);
}

void BallsAndBoxes::set(std::size_t body, const Vec3& centre, double radius, const Box& box) {
  x[body] = centre.x();
  y[body] = centre.y();
  z[body] = centre.z();
  r[body] = radius;
  low_x[body] = box.min.x();
  low_y[body] = box.min.y();
  low_z[body] = box.min.z();
  high_x[body] = box.max.x();
  high_y[body] = box.max.y();
  high_z[body] = box.max.z();
}

void BallsAndBoxes::touch_row(std::uint32_t a, std::uint32_t first, std::uint32_t last, std::uint8_t* hit) const {
  row(x.data(), y.data(), z.data(), r.data(), low_x.data(), low_y.data(), low_z.data(), high_x.data(), high_y.data(),
      high_z.data(), a, first, last, hit);
}

}  // namespace geometry
